/// Options of `billeter_plv::Renderer` for targets of a format.
pub fn options(target_format: wgpu::TextureFormat) -> billeter_plv::Options {
    use billeter_plv::*;
    Options {
        target_format,
        accumulation: common::gpu::Accumulation::F16,
        clamp_negative: true,
        evaluation: Evaluation::Table { format: common::gpu::TableFormat::F32, height: 512, width: 1024 },
        tessellation: Tessellation::Full,
        upright_walls: false,
        volume: Volume::Mesh,
    }
}

/// How much of the scene's fog is drawn: which lights are handed to the renderer, and in which medium.
pub fn model() -> common::need::Model {
    use common::need::*;
    Model { lights: vec![Shaft::Shadowed, Shaft::Off], grey: true, phase: PhaseModel::Isotropic }
}
