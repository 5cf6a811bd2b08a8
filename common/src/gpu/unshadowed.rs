//! Airlight as if nothing threw a shadow, in one full-screen pass over all lights.
//!
//! For lights whose shadows in the air do not matter ([`crate::need`]). It is the least that any technique can cost, which add
//! shadows to just this, and it shows how much of a picture the shadows are. A directional light has a closed form; a point or spot takes one four-point Gauss-Legendre rule in a
//! parameter in which the integrand has neither the light's singularity nor a trigonometric function, and a spot with
//! a soft edge three points between each two kinks of its falloff. Approximations: (1) no shadows; (2) the
//! quadrature: about 1 % of the unshadowed airlight at most; (3) a light map counts at nine places a ray. A spot with a
//! light map is drawn by itself.

use encase::ShaderType;
use glam::Vec3;

use super::haze::Haze;
use super::passes::{
    AdditivePipeline, Attachments, begin_pass, bind_group, binding, group_layout, pipeline_layout,
    shader_module,
};
use super::{LightBinding, MediumUniform, PassTimer, Uniform, ViewUniform, light_layout};
use crate::{Light, Medium, View, shader};

/// Twin of WGSL `Source`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
struct SourceUniform {
    position: Vec3,
    cos_outer: f32,
    direction: Vec3,
    cos_inner: f32,
    strength: Vec3,
}

/// Lights of one draw.
const MOST: usize = 16;

/// Twin of WGSL `Sources`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct SourcesUniform {
    reach: f32,
    all: [SourceUniform; MOST],
}

/// How many points, spots, soft spots and directional lights a draw has, in which medium: what a pipeline is made for.
type Key = ([usize; 4], Haze);

/// What a frame is drawn from.
#[derive(Clone, Copy)]
pub struct UnshadowedInputs<'a> {
    /// The eye.
    pub view: &'a View,
    /// The medium.
    pub medium: &'a Medium,
    /// Lights; their shadow maps are not looked at.
    pub lights: &'a [LightBinding],
    /// Depth of the view's size and of [`DEPTH_FORMAT`](super::DEPTH_FORMAT); bound as a texture.
    pub depth: &'a wgpu::TextureView,
    /// Where a ray that meets no surface ends \[m\].
    pub reach: f32,
}

/// The pass's pipelines and per-frame data.
pub struct Unshadowed {
    format: wgpu::TextureFormat,
    module: wgpu::ShaderModule,
    group_layout: wgpu::BindGroupLayout,
    layout: wgpu::PipelineLayout,
    pipelines: std::collections::HashMap<Key, wgpu::RenderPipeline>,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    /// One for every sixteen lights; at least one.
    sources: Vec<Uniform<SourcesUniform>>,
    draws: Vec<Draw>,
}

/// What `prepare` leaves for `encode`: a pipeline, its group, and the light that is drawn by itself.
struct Draw {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    light: wgpu::BindGroup,
}

impl Unshadowed {
    /// Names of the passes.
    pub const PASSES: [&'static str; 1] = [Self::PASS];

    const PASS: &'static str = "unshadowed: add airlight";

    /// Airlight into targets of `format`, which the device blends.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        use binding::{DEPTH, UNIFORM};
        let group_layout = group_layout(device, Self::PASS, &[UNIFORM, UNIFORM, DEPTH, UNIFORM]);
        let layout = pipeline_layout(device, Self::PASS, &[&group_layout, &light_layout(device)]);
        Self {
            format,
            module: shader_module(device, Self::PASS, source()),
            group_layout,
            layout,
            pipelines: Default::default(),
            view: Uniform::new(device, "unshadowed: view"),
            medium: Uniform::new(device, "unshadowed: medium"),
            sources: Vec::new(),
            draws: Vec::new(),
        }
    }

    /// Puts a frame's data in place; once per submit.
    pub fn prepare(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, inputs: &UnshadowedInputs<'_>) {
        let UnshadowedInputs { view, medium, lights, depth, reach } = *inputs;
        self.view.write(queue, &ViewUniform::from(view));
        self.medium.write(queue, &MediumUniform::from(medium));
        let haze = Haze::new(medium);
        let (mapped, mut plain): (Vec<_>, Vec<_>) = lights.iter().partition(|light| has_map(&light.light));
        plain.sort_by_key(|light| kind(&light.light));
        // A uniform is needed even where there are but mapped lights.
        let chunks: Vec<_> = if plain.is_empty() { vec![&plain[..]] } else { plain.chunks(MOST).collect() };
        self.draws.clear();
        for (index, chunk) in chunks.into_iter().enumerate() {
            if index == self.sources.len() {
                self.sources.push(Uniform::new(device, "unshadowed: lights"));
            }
            let mut block = SourcesUniform { reach, all: Default::default() };
            let mut counts = [0; 4];
            for (slot, light) in block.all.iter_mut().zip(chunk) {
                *slot = source_of(&light.light);
                counts[kind(&light.light)] += 1;
            }
            self.sources[index].write(queue, &block);
            let resources = [
                self.view.buffer.as_entire_binding(),
                self.medium.buffer.as_entire_binding(),
                wgpu::BindingResource::TextureView(depth),
                self.sources[index].buffer.as_entire_binding(),
            ];
            let group = bind_group(device, Self::PASS, &self.group_layout, resources);
            if index == 0 {
                for light in &mapped {
                    // No draw but this one has no lights in it.
                    let pipeline = self.pipeline(device, ([0; 4], haze));
                    let light = light.bind_group.clone();
                    self.draws.push(Draw { pipeline, group: group.clone(), light });
                }
            }
            if let Some(first) = chunk.first() {
                let pipeline = self.pipeline(device, (counts, haze));
                self.draws.push(Draw { pipeline, group, light: first.bind_group.clone() });
            }
        }
    }

    /// The pipeline of a draw, made where there is none yet.
    fn pipeline(&mut self, device: &wgpu::Device, key: Key) -> wgpu::RenderPipeline {
        let (counts, haze) = key;
        let mapped = counts == [0; 4];
        let mut constants = haze.constants();
        constants.extend(["POINTS", "SPOTS", "SOFT_SPOTS", "SUNS"].into_iter().zip(counts.map(|n| n as f64)));
        let make = || {
            let pipeline = AdditivePipeline {
                layout: Some(&self.layout),
                module: &self.module,
                entries: ["vs_fullscreen", if mapped { "fs_mapped" } else { "fs_unshadowed" }],
                constants: &constants,
                topology: wgpu::PrimitiveTopology::TriangleList,
                buffers: &[],
                depth_stencil: None,
                target: Some(self.format),
                adds: true,
            };
            pipeline.build(device)
        };
        self.pipelines.entry(key).or_insert_with(make).clone()
    }

    /// Adds the in-scattered radiance to `target`.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        let mut pass = begin_pass(encoder, Attachments::onto(target), Self::PASS, timer);
        for draw in &self.draws {
            pass.set_pipeline(&draw.pipeline);
            pass.set_bind_group(0, &draw.group, &[]);
            pass.set_bind_group(1, &draw.light, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

/// Index among the kinds, in the order of the shader's loops.
fn kind(light: &Light) -> usize {
    match light {
        Light::Point(_) => 0,
        Light::Spot(spot) if spot.inner_angle.cos() - spot.outer_angle.cos() <= 1e-6 => 1,
        Light::Spot(_) => 2,
        Light::Directional(_) => 3,
    }
}

fn has_map(light: &Light) -> bool {
    matches!(light, Light::Spot(spot) if spot.light_map.is_some())
}

fn source_of(light: &Light) -> SourceUniform {
    let (direction, [inner, outer]) = match light {
        Light::Point(_) => (Vec3::ZERO, [0.0; 2]),
        Light::Spot(spot) => (spot.direction, [spot.inner_angle, spot.outer_angle]),
        Light::Directional(sun) => (sun.direction, [0.0; 2]),
    };
    SourceUniform {
        position: light.position().unwrap_or(Vec3::ZERO),
        cos_outer: outer.cos(),
        direction,
        cos_inner: inner.cos(),
        strength: light.strength(),
    }
}

/// Composed text of the pass.
fn source() -> String {
    shader::compose(&[
        shader::FULLSCREEN,
        shader::VIEW,
        shader::PHASE,
        shader::MEDIUM,
        shader::LIGHT,
        shader::RAY,
        shader::HAZE,
        include_str!("../../shaders/unshadowed.wgsl"),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::bench::{check_uniform_layout, uniform_branches, validate_wgsl};
    use crate::gpu::uniform_bytes;

    #[test]
    fn the_shader_is_valid_and_lights_lie_as_it_has_them() {
        validate_wgsl(&source()).unwrap();
        assert_eq!(uniform_branches(&source()).unwrap(), [""; 0]);
        let one = SourceUniform {
            position: Vec3::splat(1.0),
            cos_outer: 2.0,
            direction: Vec3::splat(3.0),
            cos_inner: 4.0,
            strength: Vec3::splat(5.0),
        };
        let f = f32::to_bits;
        let expect = [
            ("position", f(1.0)),
            ("cos_outer", f(2.0)),
            ("direction", f(3.0)),
            ("cos_inner", f(4.0)),
            ("strength", f(5.0)),
        ];
        check_uniform_layout(&source(), "Source", &uniform_bytes(&one), &expect).unwrap();
        let all = SourcesUniform { reach: 6.0, all: [one; MOST] };
        let expect = [("reach", f(6.0)), ("all", f(1.0))];
        check_uniform_layout(&source(), "Sources", &uniform_bytes(&all), &expect).unwrap();
    }
}
