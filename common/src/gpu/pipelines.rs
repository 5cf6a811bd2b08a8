//! Pipelines of the ground: depth, shadow maps, surfaces.

use super::SceneBuffers;
use super::passes::binding::{STORAGE, UNIFORM, UNIFORM_AT_OFFSET};
use super::passes::{group_layout, pipeline_layout, shader_module};
use super::shadow::light_layout;
use super::surface::{DEPTH_FORMAT, Ground, SurfaceData};
use crate::shader;

pub(super) fn shadow_pass_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    group_layout(device, "common: shadow pass", &[UNIFORM_AT_OFFSET, STORAGE])
}

pub(super) fn surface_pass_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    group_layout(device, "common: surface pass", &[UNIFORM, STORAGE, STORAGE, UNIFORM])
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
        let shadow_module = shader_module(device, "common: draw shadow maps", DEPTH_SOURCE.to_owned());
        let surface_module = shader_module(device, "common: light surfaces", surface_source());
        let light_layout = light_layout(device);
        let build = |label, layouts: &[&wgpu::BindGroupLayout], module, entry, write, compare, fragment| {
            let layout = pipeline_layout(device, label, layouts);
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
        let surface = [surface_layout, &light_layout];
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
            build(Ground::PASSES[0], &[shadow_layout], &shadow_module, "vs_depth", true, greater, None);
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
