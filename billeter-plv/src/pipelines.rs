//! Render pipelines and the layouts of what they bind.

use common::gpu::light_layout;
use common::gpu::passes::{AdditivePipeline, binding, group_layout, pipeline_layout, shader_module};

use crate::{Evaluation, Options, shaders};

/// Layouts of bind groups 0 and 2; 1 is the light's.
pub(crate) struct Layouts {
    /// View, medium, depth, tables.
    pub(crate) frame: wgpu::BindGroupLayout,
    /// One `Draw` block, at a dynamic offset.
    pub(crate) draw: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let frame = [binding::UNIFORM, binding::UNIFORM, binding::DEPTH, binding::TABLES];
        Self {
            frame: group_layout(device, "billeter-plv: frame", &frame),
            draw: group_layout(device, "billeter-plv: draw", &[binding::UNIFORM_AT_OFFSET]),
        }
    }
}

/// Pipelines that draw faces.
pub(crate) struct FacePipelines {
    pub(crate) strips: wgpu::RenderPipeline,
    pub(crate) indexed: wgpu::RenderPipeline,
    pub(crate) closure: wgpu::RenderPipeline,
    pub(crate) everywhere: wgpu::RenderPipeline,
}

impl FacePipelines {
    pub(crate) fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        options: &Options,
        accumulation: wgpu::TextureFormat,
    ) -> Self {
        let module = shader_module(device, "billeter-plv: volumes", shaders::volume());
        let groups = [&layouts.frame, &light_layout(device), &layouts.draw];
        let layout = pipeline_layout(device, "billeter-plv: volumes", &groups);
        let use_table = f64::from(u8::from(matches!(options.evaluation, Evaluation::Table { .. })));
        let upright = f64::from(u8::from(options.upright_walls));
        let constants = [("use_table", use_table), ("upright_walls", upright)];
        let face = |entries, topology| {
            let pipeline = AdditivePipeline {
                layout: Some(&layout),
                module: &module,
                entries,
                constants: &constants,
                topology,
                buffers: &[],
                depth_stencil: None,
                target: Some(accumulation),
                adds: true,
            };
            pipeline.build(device)
        };
        let (list, strip) = (wgpu::PrimitiveTopology::TriangleList, wgpu::PrimitiveTopology::TriangleStrip);
        Self {
            strips: face(["vs_strip", "fs_face"], strip),
            indexed: face(["vs_indexed", "fs_face"], list),
            closure: face(["vs_closure", "fs_face"], list),
            everywhere: face(["vs_everywhere", "fs_everywhere"], list),
        }
    }
}
