//! Ray marching through the same shadow maps: what most renderers do.
//!
//! One full-screen pass per light. Samples lie in the middle of equal steps, either of distance
//! along the ray or of the angle at the light (Kulla and Fajardo, *Importance Sampling Techniques
//! for Path Tracing in Participating Media*, 2012). A spot's ray is clipped to its cone first; a ray
//! that meets no surface ends where next to nothing is left of the light. Approximations: (1) the
//! sum over steps; (2) the shadow map's texels, one look-up a sample. For a directional light the
//! angle at the light says nothing, and equi-angular falls back to equal distances.

use common::gpu::{LightBinding, MediumUniform, PassTimer, Uniform, ViewUniform, light_layout};
use common::{Scene, View, shader};
use encase::ShaderType;

/// Twin of WGSL `March`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct MarchUniform {
    steps: u32,
    equiangular: u32,
    reach: f32,
}

/// The march's pipeline and per-frame data.
pub(crate) struct RayMarch {
    steps: u32,
    equiangular: bool,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    march: Uniform<MarchUniform>,
    frame: Option<Frame>,
}

/// What `prepare` leaves for `encode`.
struct Frame {
    group: wgpu::BindGroup,
    lights: Vec<wgpu::BindGroup>,
}

impl RayMarch {
    /// Name of the pass.
    pub(crate) const PASS: &'static str = "ray-march: add in-scattered radiance";

    /// A march of `steps` samples into targets of `format`.
    pub(crate) fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        steps: u32,
        equiangular: bool,
    ) -> Self {
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let depth = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let visibility = wgpu::ShaderStages::FRAGMENT;
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some(Self::PASS),
            entries: &[entry(0, uniform), entry(1, uniform), entry(2, uniform), entry(3, depth)],
        });
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(Self::PASS),
            source: wgpu::ShaderSource::Wgsl(source().into()),
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(Self::PASS),
            bind_group_layouts: &[Some(&layout), Some(&light_layout(device))],
            immediate_size: 0,
        });
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(Self::PASS),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_fullscreen"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fs_march"),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format,
                    blend: Some(wgpu::BlendState { color: add, alpha: add }),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            multiview_mask: None,
            cache: None,
        });
        Self {
            steps,
            equiangular,
            pipeline,
            layout,
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
        self.march.write(
            queue,
            &MarchUniform {
                steps: self.steps,
                equiangular: self.equiangular.into(),
                reach: reach(scene, view),
            },
        );
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(Self::PASS),
            layout: &self.layout,
            entries: &[
                entry(0, self.view.buffer.as_entire_binding()),
                entry(1, self.medium.buffer.as_entire_binding()),
                entry(2, self.march.buffer.as_entire_binding()),
                entry(3, wgpu::BindingResource::TextureView(depth)),
            ],
        });
        self.frame = Some(Frame { group, lights: lights.iter().map(|l| l.bind_group.clone()).collect() });
    }

    /// Adds the in-scattered radiance to `target`.
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        let Some(frame) = &self.frame else { return };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(Self::PASS),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            timestamp_writes: timer.render(Self::PASS),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &frame.group, &[]);
        for light in &frame.lights {
            pass.set_bind_group(1, light, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

/// Where a ray that meets no surface ends \[m\]: ten sizes of the scene behind all that is in it, or
/// where the medium has left `exp(−12)` of any colour.
fn reach(scene: &Scene, view: &View) -> f32 {
    let eye = view.camera.eye;
    let (low, high) = scene.bounds().unwrap_or((eye - 1.0, eye + 1.0));
    let (centre, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
    let lights = scene.lights.iter().filter_map(|light| light.position());
    let farthest = lights.map(|light| light.distance(centre)).fold(radius, f32::max);
    let geometric = eye.distance(centre) + 10.0 * farthest;
    let sigma = scene.medium.sigma_t().min_element();
    if sigma > 0.0 { geometric.min(12.0 / sigma) } else { geometric }
}

/// Composed text of the pass.
fn source() -> String {
    shader::compose(&[
        shader::FULLSCREEN,
        shader::VIEW,
        shader::PHASE,
        shader::MEDIUM,
        shader::LIGHT,
        shader::SHADOW,
        include_str!("raymarch.wgsl"),
    ])
}

#[cfg(test)]
mod tests {
    use common::gpu::bench::validate_wgsl;

    #[test]
    fn the_shader_is_valid() {
        validate_wgsl(&super::source()).unwrap();
    }
}
