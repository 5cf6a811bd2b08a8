//! Pipelines of the ground: depth, shadow maps, surfaces.

use super::SceneBuffers;
use super::shadow::light_layout;
use super::surface::{DEPTH_FORMAT, Ground, SurfaceData};
use crate::shader;

fn buffer_entry(binding: u32, ty: wgpu::BufferBindingType, dynamic: bool) -> wgpu::BindGroupLayoutEntry {
    wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: dynamic, min_binding_size: None },
        count: None,
    }
}

const READ_ONLY: wgpu::BufferBindingType = wgpu::BufferBindingType::Storage { read_only: true };

pub(super) fn shadow_pass_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("common: shadow pass"),
        entries: &[
            buffer_entry(0, wgpu::BufferBindingType::Uniform, true),
            buffer_entry(1, READ_ONLY, false),
        ],
    })
}

pub(super) fn surface_pass_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("common: surface pass"),
        entries: &[
            buffer_entry(0, wgpu::BufferBindingType::Uniform, false),
            buffer_entry(1, READ_ONLY, false),
            buffer_entry(2, READ_ONLY, false),
            buffer_entry(3, wgpu::BufferBindingType::Uniform, false),
        ],
    })
}

pub(super) struct Pipelines {
    pub(super) depth: wgpu::RenderPipeline,
    pub(super) shadow: wgpu::RenderPipeline,
    pub(super) surface: wgpu::RenderPipeline,
    pub(super) surface_data: wgpu::RenderPipeline,
}

/// Composed text of the surface pass.
pub(super) fn surface_source() -> String {
    const SURFACE: &str = include_str!("../../shaders/surface.wgsl");
    shader::compose(&[
        shader::VIEW,
        shader::PHASE,
        shader::MEDIUM,
        shader::LIGHT,
        shader::ARRIVAL,
        shader::SHADOW,
        SURFACE,
    ])
}

/// Text of the shadow map pass.
pub(super) const DEPTH_SOURCE: &str = include_str!("../../shaders/depth.wgsl");

impl Pipelines {
    pub(super) fn new(
        device: &wgpu::Device,
        shadow_layout: &wgpu::BindGroupLayout,
        surface_layout: &wgpu::BindGroupLayout,
        format: wgpu::TextureFormat,
    ) -> Self {
        let module = |label, source: String| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        };
        let shadow_module = module("common: draw shadow maps", DEPTH_SOURCE.to_owned());
        let surface_module = module("common: light surfaces", surface_source());
        let light_layout = light_layout(device);
        let build =
            |label, layouts: &[Option<&wgpu::BindGroupLayout>], module, entry, write, compare, fragment| {
                let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(label),
                    bind_group_layouts: layouts,
                    immediate_size: 0,
                });
                device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some(label),
                    layout: Some(&layout),
                    vertex: wgpu::VertexState {
                        module,
                        entry_point: Some(entry),
                        compilation_options: Default::default(),
                        buffers: &[Some(SceneBuffers::vertex_layout())],
                    },
                    primitive: wgpu::PrimitiveState::default(),
                    depth_stencil: Some(wgpu::DepthStencilState {
                        format: DEPTH_FORMAT,
                        depth_write_enabled: Some(write),
                        depth_compare: Some(compare),
                        stencil: Default::default(),
                        bias: Default::default(),
                    }),
                    multisample: Default::default(),
                    fragment,
                    multiview_mask: None,
                    cache: None,
                })
            };
        let (greater, equal) = (wgpu::CompareFunction::Greater, wgpu::CompareFunction::Equal);
        let surface = [Some(surface_layout), Some(&light_layout)];
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let target = [Some(wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState { color: add, alpha: add }),
            write_mask: wgpu::ColorWrites::ALL,
        })];
        let stored = || {
            let format = SurfaceData::FORMAT;
            Some(wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::ALL })
        };
        let stored = [stored(), stored(), stored()];
        let data = wgpu::FragmentState {
            module: &surface_module,
            entry_point: Some("fs_surface_data"),
            compilation_options: Default::default(),
            targets: &stored,
        };
        let lit = wgpu::FragmentState {
            module: &surface_module,
            entry_point: Some("fs_surface"),
            compilation_options: Default::default(),
            targets: &target,
        };
        let shadow =
            build(Ground::PASSES[0], &[Some(shadow_layout)], &shadow_module, "vs_depth", true, greater, None);
        let depth =
            build(Ground::PASSES[1], &surface[..1], &surface_module, "vs_surface", true, greater, None);
        // Only the surface that the depth pass kept: the same vertex function gives the same depth.
        let surface_data =
            build(Ground::PASSES[3], &surface[..1], &surface_module, "vs_surface", false, equal, Some(data));
        let surface =
            build(Ground::PASSES[2], &surface, &surface_module, "vs_surface", false, equal, Some(lit));
        Self { depth, shadow, surface, surface_data }
    }
}
