//! The lit volume met ray by ray: min-max levels of each shadow map, and one full-screen pass per light that walks
//! through them.

use std::collections::HashMap;
use std::f32::consts::FRAC_PI_2;

use common::gpu::passes::{
    AdditivePipeline, Attachments, begin_pass, bind_group, binding, group_layout, pipeline_layout,
    shader_module,
};
use common::gpu::{
    Accumulator, LightBinding, MediumUniform, PassTimer, Uniform, Variant, ViewUniform, light_layout,
};
use common::panels::panels_for;
use common::{Phase, View};
use encase::ShaderType;

use crate::levels::{self, Levels};
use crate::{Error, Evaluation, Inputs, Options, shaders};

/// Names of this module's passes; each comes once for each light.
pub(crate) const PASSES: [&str; 2] = [levels::PASS, "billeter-plv: integrate lit intervals"];

/// Widest piece of the rule for a phase function without a peak \[rad\].
const WIDEST_PIECE: f32 = 1.2;

/// Twin of WGSL `Rays`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct RaysUniform {
    piece: f32,
    coarsest: u32,
}

/// Draws airlight as lit runs of rays.
pub(crate) struct Rays {
    target_format: wgpu::TextureFormat,
    least_panels: u32,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    rays: Uniform<RaysUniform>,
    module: wgpu::ShaderModule,
    frame_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    pipelines: HashMap<Variant, wgpu::RenderPipeline>,
    level_pipelines: levels::Pipelines,
    levels: Option<Levels>,
    phase: Option<(Phase, u32)>,
    frame: Option<wgpu::BindGroup>,
    lights: Vec<(LightBinding, wgpu::RenderPipeline)>,
}

impl Rays {
    pub(crate) fn new(device: &wgpu::Device, options: &Options) -> Result<Self, Error> {
        Accumulator::check_format(device, options.target_format)?;
        let levels = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Uint,
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        };
        let frame = [binding::UNIFORM, binding::UNIFORM, binding::UNIFORM, binding::DEPTH, levels];
        let frame_layout = group_layout(device, "billeter-plv: frame", &frame);
        let label = "billeter-plv: rays";
        Ok(Self {
            target_format: options.target_format,
            least_panels: match options.evaluation {
                Evaluation::Quadrature { panels } => panels,
                Evaluation::Table { .. } => 1,
            },
            view: Uniform::new(device, "billeter-plv: view"),
            medium: Uniform::new(device, "billeter-plv: medium"),
            rays: Uniform::new(device, label),
            module: shader_module(device, label, shaders::rays()),
            layout: pipeline_layout(device, label, &[&frame_layout, &light_layout(device)]),
            frame_layout,
            pipelines: HashMap::new(),
            level_pipelines: levels::Pipelines::new(device),
            levels: None,
            phase: None,
            frame: None,
            lights: Vec::new(),
        })
    }

    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        inputs: &Inputs<'_>,
    ) -> Result<(), Error> {
        let View { width, height, .. } = *inputs.view;
        Accumulator::check_size(device, (width, height))?;
        self.lights.clear();
        for light in inputs.lights {
            let pipeline = self.pipeline(device, Variant::new(&light.light, inputs.medium));
            self.lights.push((light.clone(), pipeline));
        }
        let size = inputs.lights.iter().map(|light| light.projection.size).max().unwrap_or(1);
        let layers =
            inputs.lights.iter().map(|light| light.projection.layers.len() as u32).max().unwrap_or(1);
        if !self.levels.as_ref().is_some_and(|levels| levels.fits((size, layers))) {
            self.levels = None;
        }
        let pipelines = &self.level_pipelines;
        let levels = self.levels.get_or_insert_with(|| Levels::new(device, pipelines, (size, layers)));
        let coarsest = levels.coarsest;
        let resources = [
            self.view.buffer.as_entire_binding(),
            self.medium.buffer.as_entire_binding(),
            self.rays.buffer.as_entire_binding(),
            wgpu::BindingResource::TextureView(inputs.depth),
            wgpu::BindingResource::TextureView(&levels.view),
        ];
        self.frame = Some(bind_group(device, "billeter-plv: frame", &self.frame_layout, resources));
        self.view.write(queue, &ViewUniform::from(inputs.view));
        self.medium.write(queue, &MediumUniform::from(inputs.medium));
        let piece = (FRAC_PI_2 / self.panels(&inputs.medium.phase) as f32).min(WIDEST_PIECE);
        self.rays.write(queue, &RaysUniform { piece, coarsest });
        Ok(())
    }

    /// Panels of a quarter circle that the phase function takes.
    fn panels(&mut self, phase: &Phase) -> u32 {
        match &self.phase {
            Some((known, panels)) if known == phase => *panels,
            _ => {
                let panels = panels_for(phase, self.least_panels);
                self.phase = Some((phase.clone(), panels));
                panels
            }
        }
    }

    /// The pipeline of a variant, made when it is first asked for.
    fn pipeline(&mut self, device: &wgpu::Device, variant: Variant) -> wgpu::RenderPipeline {
        let make = |variant: &Variant| {
            let most = if self.target_format == wgpu::TextureFormat::Rgba16Float { 65504.0 } else { 1e30 };
            let mut constants = variant.constants();
            constants.push(("most_radiance", most));
            let pipeline = AdditivePipeline {
                layout: Some(&self.layout),
                module: &self.module,
                entries: ["vs_fullscreen", "fs_rays"],
                constants: &constants,
                topology: wgpu::PrimitiveTopology::TriangleList,
                buffers: &[],
                depth_stencil: None,
                target: Some(self.target_format),
                adds: true,
            };
            pipeline.build(device)
        };
        self.pipelines.entry(variant).or_insert_with_key(make).clone()
    }

    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        let (Some(levels), Some(frame)) = (&self.levels, &self.frame) else { return };
        for (light, pipeline) in &self.lights {
            self.level_pipelines.encode(encoder, levels, light, timer);
            let mut pass = begin_pass(encoder, Attachments::onto(target), PASSES[1], timer);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, frame, &[]);
            pass.set_bind_group(1, &light.bind_group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::gpu::bench::check_uniform_layout;
    use common::gpu::uniform_bytes;

    #[test]
    fn rays_lie_as_wgsl_has_them() {
        let block = RaysUniform { piece: 1.0, coarsest: 2 };
        let expect = [("piece", 1f32.to_bits()), ("coarsest", 2)];
        check_uniform_layout(&shaders::rays(), "Rays", &uniform_bytes(&block), &expect).unwrap();
    }
}
