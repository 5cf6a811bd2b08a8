// froxels on shadow maps of 256² texels: {"samples":4,"slices":128,"tile":4}. It is no technique's crate; its shaders are in harness/src/peers.

/// How much of the scene's fog is drawn: which lights are handed to the renderer, and in which medium.
pub fn model() -> common::need::Model {
    use common::need::*;
    Model { lights: vec![Shaft::Off, Shaft::Shadowed], grey: false, phase: PhaseModel::Own }
}
