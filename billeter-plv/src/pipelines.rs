//! Render pipelines and the layouts of what they bind.

use common::gpu::light_layout;

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
        let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let uniform = |has_dynamic_offset| wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset,
            min_binding_size: None,
        };
        let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        };
        let unfiltered = wgpu::TextureSampleType::Float { filterable: false };
        let frame = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("billeter-plv: frame"),
            entries: &[
                entry(0, uniform(false)),
                entry(1, uniform(false)),
                entry(2, texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2)),
                entry(3, texture(unfiltered, wgpu::TextureViewDimension::D2Array)),
            ],
        });
        let draw = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("billeter-plv: draw"),
            entries: &[entry(0, uniform(true))],
        });
        Self { frame, draw }
    }
}

/// Pipelines that draw faces and add them up.
pub(crate) struct FacePipelines {
    pub(crate) strips: wgpu::RenderPipeline,
    pub(crate) indexed: wgpu::RenderPipeline,
    pub(crate) closure: wgpu::RenderPipeline,
    pub(crate) everywhere: wgpu::RenderPipeline,
    pub(crate) add: wgpu::RenderPipeline,
}

impl FacePipelines {
    pub(crate) fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        options: &Options,
        accumulation: wgpu::TextureFormat,
    ) -> Self {
        let module = |label, source: String| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        };
        let volume = module("billeter-plv: volumes", shaders::volume());
        let light = light_layout(device);
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("billeter-plv: volumes"),
            bind_group_layouts: &[Some(&layouts.frame), Some(&light), Some(&layouts.draw)],
            immediate_size: 0,
        });
        let use_table = f64::from(u8::from(matches!(options.evaluation, Evaluation::Table { .. })));
        let upright = f64::from(u8::from(options.upright_walls));
        let constants = [("use_table", use_table), ("upright_walls", upright)];
        let face = |vertex, fragment, topology| {
            additive_pipeline(
                device,
                Some(&layout),
                &volume,
                [vertex, fragment],
                &constants,
                topology,
                accumulation,
            )
        };
        let (list, strip) = (wgpu::PrimitiveTopology::TriangleList, wgpu::PrimitiveTopology::TriangleStrip);
        let add = module("billeter-plv: add airlight", shaders::add());
        let clamp = [("clamp_negative", f64::from(u8::from(options.clamp_negative)))];
        Self {
            strips: face("vs_strip", "fs_face", strip),
            indexed: face("vs_indexed", "fs_face", list),
            closure: face("vs_closure", "fs_face", list),
            everywhere: face("vs_everywhere", "fs_everywhere", list),
            add: additive_pipeline(
                device,
                None,
                &add,
                ["vs_fullscreen", "fs_add"],
                &clamp,
                list,
                options.target_format,
            ),
        }
    }
}

/// Depth test off, both sides drawn, added to the target.
fn additive_pipeline(
    device: &wgpu::Device,
    layout: Option<&wgpu::PipelineLayout>,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    constants: &[(&str, f64)],
    topology: wgpu::PrimitiveTopology,
    format: wgpu::TextureFormat,
) -> wgpu::RenderPipeline {
    let add = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    let compilation_options = wgpu::PipelineCompilationOptions { constants, ..Default::default() };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(vertex),
        layout,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState { topology, ..Default::default() },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options,
            targets: &[Some(wgpu::ColorTargetState {
                format,
                blend: Some(wgpu::BlendState { color: add, alpha: add }),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
