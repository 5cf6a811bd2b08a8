//! Pipelines of the ground: depth, shadow maps, surfaces.

use std::collections::HashMap;

use super::Variant;
use super::passes::binding::{STORAGE, UNIFORM, UNIFORM_AT_OFFSET};
use super::passes::{group_layout, pipeline_layout, shader_module};
use super::scene::SceneBuffers;
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
    pub(super) surface_data: wgpu::RenderPipeline,
    surface_module: wgpu::ShaderModule,
    surface_layout: wgpu::PipelineLayout,
    format: wgpu::TextureFormat,
    /// Lights surfaces, by kind of light and medium.
    lit: HashMap<Variant, wgpu::RenderPipeline>,
}

/// Composed text of the surface pass.
pub(super) fn surface_source() -> String {
    const SURFACE: &str = include_str!("../../shaders/surface.wgsl");
    shader::compose(&[
        shader::VIEW,
        shader::PHASE,
        shader::MEDIUM,
        shader::LIGHT,
        shader::KIND,
        shader::HAZE,
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
        let [shadow, depth, lit, data] = Ground::PASSES;
        let shadow_module = shader_module(device, shadow, DEPTH_SOURCE.to_owned());
        let surface_module = shader_module(device, lit, surface_source());
        let layout = |label, group| pipeline_layout(device, label, &[group]);
        let stored = || {
            let format = SurfaceData::FORMAT;
            Some(wgpu::ColorTargetState { format, blend: None, write_mask: wgpu::ColorWrites::ALL })
        };
        let stored = [stored(), stored(), stored()];
        let fragment = wgpu::FragmentState {
            module: &surface_module,
            entry_point: Some("fs_surface_data"),
            compilation_options: Default::default(),
            targets: &stored,
        };
        let shadow = Drawing {
            label: shadow,
            layout: &layout(shadow, shadow_layout),
            entry: "vs_depth",
            fragment: None,
        }
        .build(device, &shadow_module);
        let of_eye = layout(depth, surface_layout);
        let depth = Drawing { label: depth, layout: &of_eye, entry: "vs_surface", fragment: None }
            .build(device, &surface_module);
        let surface_data =
            Drawing { label: data, layout: &of_eye, entry: "vs_surface", fragment: Some(fragment) }
                .build(device, &surface_module);
        let surface_layout = pipeline_layout(device, lit, &[surface_layout, &light_layout(device)]);
        Self { depth, shadow, surface_data, surface_module, surface_layout, format, lit: HashMap::new() }
    }

    /// The pipeline that lights surfaces, made where there is none yet.
    pub(super) fn lit(&mut self, device: &wgpu::Device, variant: Variant) -> wgpu::RenderPipeline {
        let Self { surface_module, surface_layout, format, lit, .. } = self;
        let make = || {
            let add = wgpu::BlendComponent {
                src_factor: wgpu::BlendFactor::One,
                dst_factor: wgpu::BlendFactor::One,
                operation: wgpu::BlendOperation::Add,
            };
            let target = [Some(wgpu::ColorTargetState {
                format: *format,
                blend: Some(wgpu::BlendState { color: add, alpha: add }),
                write_mask: wgpu::ColorWrites::ALL,
            })];
            let fragment = wgpu::FragmentState {
                module: surface_module,
                entry_point: Some("fs_surface"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &variant.constants(),
                    ..Default::default()
                },
                targets: &target,
            };
            let (label, layout) = (Ground::PASSES[2], &*surface_layout);
            Drawing { label, layout, entry: "vs_surface", fragment: Some(fragment) }
                .build(device, surface_module)
        };
        lit.entry(variant).or_insert_with(make).clone()
    }
}

/// A pipeline that draws the scene's triangles: depth alone, or the surface that the depth pass kept.
struct Drawing<'a> {
    label: &'static str,
    layout: &'a wgpu::PipelineLayout,
    entry: &'static str,
    fragment: Option<wgpu::FragmentState<'a>>,
}

impl Drawing<'_> {
    fn build(self, device: &wgpu::Device, module: &wgpu::ShaderModule) -> wgpu::RenderPipeline {
        let depth_only = self.fragment.is_none();
        // The same vertex function gives the same depth.
        let compare = if depth_only { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Equal };
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.label),
            layout: Some(self.layout),
            vertex: wgpu::VertexState {
                module,
                entry_point: Some(self.entry),
                compilation_options: Default::default(),
                buffers: &[Some(SceneBuffers::vertex_layout())],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(depth_only),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: self.fragment,
            multiview_mask: None,
            cache: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::gpu::bench::uniform_branches;

    #[test]
    fn surfaces_are_lit_without_a_branch_on_a_uniform() {
        assert_eq!(uniform_branches(&super::surface_source()).unwrap(), [""; 0]);
    }
}
