/// Options of `chen_planes::Renderer` for targets of a format.
pub fn options(target_format: wgpu::TextureFormat) -> chen_planes::Options {
    use chen_planes::*;
    Options {
        target_format,
        accumulation: common::gpu::Accumulation::F32,
        early_end: true,
        factor: Factor::Integrated,
        lattice: [2, 2],
        offset: true,
        phase_texels: 2048,
        placement: Placement::Integrand,
        planes: 8,
        visibility: Visibility::PerFragment { samples: 64 },
    }
}

/// How much of the scene's fog is drawn: which lights are handed to the renderer, and in which medium.
pub fn model() -> common::need::Model {
    use common::need::*;
    Model { lights: vec![Shaft::Shadowed, Shaft::Off], grey: true, phase: PhaseModel::Isotropic }
}
