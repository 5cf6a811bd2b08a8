// ray-march on shadow maps of 1024² texels: {"steps":192}. It is no technique's crate; its shaders are in harness/src/peers.

/// How much of the scene's fog is drawn: which lights are handed to the renderer, and in which medium.
pub fn model() -> common::need::Model {
    use common::need::*;
    Model { lights: vec![Shaft::Shadowed, Shaft::Shadowed], grey: false, phase: PhaseModel::Own }
}
