/// Options of `biri_ss::Renderer` for targets of a format.
pub fn options(target_format: wgpu::TextureFormat) -> biri_ss::Options {
    use biri_ss::*;
    Options {
        target_format,
        accumulation: common::gpu::Accumulation::F32,
        airlight: Airlight::GammaRest { format: common::gpu::TableFormat::F32, height: 128, width: 64 },
        clamp_negative: true,
        counting: Counting::FromEye,
        cull: true,
        faintest: 0.00001,
        indirect: Indirect::Clamped,
        order: Order::Exact,
        shared_beginning: true,
    }
}

/// How much of the scene's fog is drawn: which lights are handed to the renderer, and in which medium.
pub fn model() -> common::need::Model {
    use common::need::*;
    Model { lights: vec![Shaft::Shadowed, Shaft::Off, Shaft::Unshadowed, Shaft::Off], grey: false, phase: PhaseModel::Own }
}
