//! Ray marching through the shadow maps: what most renderers do.
//!
//! One full-screen pass per light. Samples lie in equal steps, either of distance along the ray or of the angle at the
//! light (Kulla and Fajardo, *Importance Sampling Techniques for Path Tracing in Participating Media*, 2012); in the
//! middle of each step, or at a place that differs from pixel to pixel by interleaved gradient noise (Jimenez, *Next
//! Generation Post Processing in Call of Duty: Advanced Warfare*, 2014), which makes noise of what would be bands: a
//! renderer that filters over pixels or frames then gets rid of it, and here nothing does. A spot's ray is clipped to
//! its cone first; a ray that meets no surface ends where next to nothing is left of the light. With equal distances the
//! medium's attenuation over a step is integrated (Hillaire, *Physically Based and Unified Volumetric Rendering in
//! Frostbite*, 2015). Shaders are made for the kinds of light and medium, and all that is linear along the ray is linear
//! in the loop. Approximations: (1) the sum over steps; (2) the shadow map's texels, one look-up a sample. For a
//! directional light the angle at the light says nothing, and equi-angular falls back to equal distances.

use std::collections::HashMap;

use common::gpu::passes::{
    AdditivePipeline, Attachments, begin_pass, bind_group, binding, group_layout, pipeline_layout,
    shader_module,
};
use common::gpu::{LightBinding, MediumUniform, PassTimer, Uniform, Variant, ViewUniform, light_layout};
use common::{Scene, View, shader};
use encase::ShaderType;

use super::reach;

/// How a ray is marched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Marching {
    /// Samples along a ray.
    pub steps: u32,
    /// Equal steps of the angle at the light, not of distance.
    pub equiangular: bool,
    /// Samples at a place in their steps that differs from pixel to pixel, not in the middle.
    pub offset: bool,
}

/// Twin of WGSL `March`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct MarchUniform {
    reach: f32,
}

/// The march's pipelines and per-frame data.
pub(crate) struct RayMarch {
    marching: Marching,
    format: wgpu::TextureFormat,
    module: wgpu::ShaderModule,
    group_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    pipelines: HashMap<Variant, wgpu::RenderPipeline>,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    march: Uniform<MarchUniform>,
    frame: Option<Frame>,
}

/// What `prepare` leaves for `encode`.
struct Frame {
    group: wgpu::BindGroup,
    lights: Vec<(wgpu::RenderPipeline, wgpu::BindGroup)>,
}

impl RayMarch {
    /// Name of the pass.
    pub(crate) const PASS: &'static str = "ray-march: add in-scattered radiance";

    /// A march into targets of `format`.
    pub(crate) fn new(device: &wgpu::Device, format: wgpu::TextureFormat, marching: Marching) -> Self {
        use binding::{DEPTH, UNIFORM};
        let group_layout = group_layout(device, Self::PASS, &[UNIFORM, UNIFORM, UNIFORM, DEPTH]);
        let layout = pipeline_layout(device, Self::PASS, &[&group_layout, &light_layout(device)]);
        Self {
            marching,
            format,
            module: shader_module(device, Self::PASS, source()),
            group_layout,
            layout,
            pipelines: HashMap::new(),
            view: Uniform::new(device, "ray-march: view"),
            medium: Uniform::new(device, "ray-march: medium"),
            march: Uniform::new(device, "ray-march: settings"),
            frame: None,
        }
    }

    /// Puts a frame's data in place; once per submit. `depth` is of [`common::gpu::DEPTH_FORMAT`] and the view's
    /// size, and bound as a texture.
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &Scene,
        view: &View,
        lights: &[LightBinding],
        depth: &wgpu::TextureView,
    ) {
        self.view.write(queue, &ViewUniform::from(view));
        self.medium.write(queue, &MediumUniform::from(&scene.medium));
        self.march.write(queue, &MarchUniform { reach: reach(scene, view) });
        let resources = [
            self.view.buffer.as_entire_binding(),
            self.medium.buffer.as_entire_binding(),
            self.march.buffer.as_entire_binding(),
            wgpu::BindingResource::TextureView(depth),
        ];
        let group = bind_group(device, Self::PASS, &self.group_layout, resources);
        let make = |variant: &Variant| {
            let mut constants = variant.constants();
            let Marching { steps, equiangular, offset } = self.marching;
            let [equiangular, offset] = [equiangular, offset].map(|is| u8::from(is).into());
            constants.extend([("STEPS", steps.into()), ("EQUIANGULAR", equiangular), ("OFFSET", offset)]);
            let pipeline = AdditivePipeline {
                layout: Some(&self.layout),
                module: &self.module,
                entries: ["vs_fullscreen", "fs_march"],
                constants: &constants,
                topology: wgpu::PrimitiveTopology::TriangleList,
                buffers: &[],
                depth_stencil: None,
                target: Some(self.format),
                adds: true,
            };
            pipeline.build(device)
        };
        let with_pipeline = |light: &LightBinding| {
            let variant = Variant::new(&light.light, &scene.medium);
            (self.pipelines.entry(variant).or_insert_with_key(make).clone(), light.bind_group.clone())
        };
        self.frame = Some(Frame { group, lights: lights.iter().map(with_pipeline).collect() });
    }

    /// Adds the in-scattered radiance to `target`.
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        let Some(frame) = &self.frame else { return };
        let mut pass = begin_pass(encoder, Attachments::onto(target), Self::PASS, timer);
        pass.set_bind_group(0, &frame.group, &[]);
        for (pipeline, light) in &frame.lights {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, light, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

/// Composed text of the pass.
pub(super) fn source() -> String {
    shader::compose(&[
        shader::FULLSCREEN,
        shader::VIEW,
        shader::PHASE,
        shader::MEDIUM,
        shader::LIGHT,
        shader::KIND,
        shader::RAY,
        shader::HAZE,
        include_str!("light.wgsl"),
        include_str!("raymarch.wgsl"),
    ])
}

#[cfg(test)]
mod tests {
    use common::gpu::bench::{check_uniform_layout, uniform_branches, validate_wgsl};
    use common::gpu::uniform_bytes;

    #[test]
    fn the_shader_is_valid_and_its_settings_lie_as_it_has_them() {
        validate_wgsl(&super::source()).unwrap();
        assert_eq!(uniform_branches(&super::source()).unwrap(), [""; 0]);
        let bytes = uniform_bytes(&super::MarchUniform { reach: 1.0 });
        let expect = [("reach", 1f32.to_bits())];
        check_uniform_layout(&super::source(), "March", &bytes, &expect).unwrap();
    }
}
