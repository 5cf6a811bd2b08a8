//! Render pipelines and the layouts of what they bind.

use common::gpu::passes::{AdditivePipeline, binding, group_layout, pipeline_layout, shader_module};
use common::gpu::{Variant, light_layout};
use common::{Light, Medium};
use glam::Vec3;

use crate::table::DOMAIN;
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

/// How a light's airlight is found; each has pipelines of its own, whose shaders hold nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum LightForm {
    /// In closed form.
    Directional,
    /// By table alone: no ray leaves its domain.
    Table,
    /// By table, integrated beyond its domain.
    TableOrIntegral,
    /// By quadrature.
    Integral,
    /// By quadrature, between the kinks of a soft edge.
    SoftEdge,
}

impl LightForm {
    /// Of a light seen from `eye`.
    pub(crate) fn of(light: &Light, eye: Vec3, medium: &Medium, evaluation: Evaluation) -> Self {
        if let Light::Directional(_) = light {
            return Self::Directional;
        }
        if matches!(light, Light::Spot(spot) if spot.inner_angle < spot.outer_angle) {
            return Self::SoftEdge;
        }
        if !matches!(evaluation, Evaluation::Table { .. }) {
            return Self::Integral;
        }
        // All distances that the table is asked for are at most the eye's from the light, or lie beyond the foot point;
        // and rays so near to the light that they leave it at the other end are a hundredth of a pixel.
        let distance = light.position().map_or(f32::INFINITY, |position| position.distance(eye));
        let depth = |sigma: f32| f64::from(sigma * distance);
        let thick = depth(medium.sigma_t().max_element()) > DOMAIN.1;
        let thin = depth(medium.sigma_t().min_element()) < LEAST_DEPTH;
        if thick || thin { Self::TableOrIntegral } else { Self::Table }
    }
}

/// Optical depth from eye to light below which rays leave the table that are not that near to the light.
const LEAST_DEPTH: f64 = 1e5 * DOMAIN.0;

/// Pipelines that draw faces.
#[derive(Clone)]
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
        form: LightForm,
        variant: Variant,
    ) -> Self {
        let module = shader_module(device, "billeter-plv: volumes", shaders::volume());
        let groups = [&layouts.frame, &light_layout(device), &layouts.draw];
        let layout = pipeline_layout(device, "billeter-plv: volumes", &groups);
        let upright = f64::from(u8::from(options.upright_walls));
        let mut constants = variant.constants();
        constants.extend([("light_form", f64::from(form as u8)), ("upright_walls", upright)]);
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
