/// Options of `billeter_plv::Renderer` for targets of a format.
pub fn options(target_format: wgpu::TextureFormat) -> billeter_plv::Options {
    use billeter_plv::*;
    Options {
        target_format,
        accumulation: common::gpu::Accumulation::F32,
        clamp_negative: true,
        evaluation: Evaluation::Quadrature { panels: 1 },
        tessellation: Tessellation::Full,
        upright_walls: true,
        volume: Volume::Rays,
    }
}

/// How much of the scene's fog is drawn: which lights are handed to the renderer, and in which medium.
pub fn model() -> common::need::Model {
    use common::need::*;
    Model { lights: vec![Shaft::Shadowed, Shaft::Off], grey: true, phase: PhaseModel::Isotropic }
}
