//! The renderer: pipelines at creation, planes and bindings by frame, passes into the caller's encoder.

use std::collections::HashMap;

use common::gpu::passes::{Attachments, begin_pass, bind_group};
use common::gpu::{
    Accumulator, LightBinding, MediumUniform, PassTimer, Uniform, Variant, ViewUniform, coarse_map,
    fill_buffer,
};
use common::{DepthRange, Medium, Phase, View, Warning};
use encase::ShaderType;
use glam::{Vec2, Vec3};

use crate::pipelines::{DepthTest, Layouts, planes_pipeline};
use crate::{Error, Factor, Options, lattice, phase, placement};

/// Mean cosine beyond which a peak of the phase function is as narrow as the steps of the default.
const MOST_PEAKED: f64 = 0.9;

/// What a frame is drawn from; borrowed.
pub struct Inputs<'a> {
    /// The eye. [`View::from_matrices`] makes it of your own matrices.
    pub view: &'a View,
    /// The medium.
    pub medium: &'a Medium,
    /// The lights, with their shadow maps: those of [`common::gpu::Ground`], or your own by
    /// [`common::gpu::ForeignMap`].
    pub lights: &'a [LightBinding],
    /// Depth of the scene from the eye: any depth format, standard or reversed, as [`View::depth`] says; see the crate's
    /// contract.
    pub depth: &'a wgpu::TextureView,
    /// Depth along the viewing direction \[m\] up to which planes are placed: that of the farthest surface, as
    /// [`reach`](crate::reach) finds it. Lit air behind it counts with [`Factor::Integrated`] only, as lit.
    pub reach: f32,
}

/// Draws airlight by sampling planes.
pub struct Renderer {
    options: Options,
    layouts: Layouts,
    /// Draw planes, made once there is a light of that kind and a depth of that test.
    pipelines: HashMap<(Variant, Option<DepthTest>), wgpu::RenderPipeline>,
    accumulator: Accumulator,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    sampling: Uniform<SamplingUniform>,
    pattern: Pattern,
    phase: Option<(Phase, wgpu::TextureView)>,
    /// Planes of all lights, one light after the other.
    planes: Option<wgpu::Buffer>,
    frame: Option<Frame>,
    warnings: Vec<Warning>,
}

/// The refinement pattern on the device.
struct Pattern {
    points: wgpu::Buffer,
    triangles: wgpu::Buffer,
    indices: u32,
}

/// What `encode` needs of a frame.
struct Frame {
    group: wgpu::BindGroup,
    lights: Vec<(wgpu::RenderPipeline, wgpu::BindGroup)>,
    /// What ends rays early.
    depth: Option<wgpu::TextureView>,
}

/// Twin of WGSL `Sampling`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct SamplingUniform {
    last_phase_texel: f32,
    most: f32,
    nearest: f32,
    reach: f32,
}

/// Instance data of a plane: V0, V1, V3, each with one of the slab's front, back and the plane's own depth \[m\].
pub(crate) type PlaneData = [[f32; 4]; 3];

/// Stands for infinitely far \[m\].
const INFINITE: f32 = 1e18;

impl Renderer {
    /// Names of the passes, in order; the second comes once for each light.
    pub const PASSES: &'static [&'static str] =
        &["chen-planes: clear", "chen-planes: draw planes", "chen-planes: add airlight"];

    /// Builds pipelines and all that no frame changes.
    ///
    /// # Errors
    /// [`Error::Option`] for an option out of its range, [`Error::Target`] for a format that can't be added to.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, options: &Options) -> Result<Self, Error> {
        options.check()?;
        // No plane takes light away: no sum is negative.
        let accumulator = Accumulator::new(device, options.target_format, options.accumulation, false)?;
        let layouts = Layouts::new(device);
        let buffer = |label, bytes: &[u8], usage| {
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes.len() as u64,
                usage: usage | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let points = lattice::points(options.lattice);
        let triangles = lattice::triangles(options.lattice);
        let pattern = Pattern {
            points: buffer("chen-planes: lattice", bytemuck::cast_slice(&points), wgpu::BufferUsages::VERTEX),
            triangles: buffer(
                "chen-planes: lattice's triangles",
                bytemuck::cast_slice(&triangles),
                wgpu::BufferUsages::INDEX,
            ),
            indices: triangles.len() as u32,
        };
        Ok(Self {
            options: *options,
            pipelines: HashMap::new(),
            layouts,
            accumulator,
            view: Uniform::new(device, "chen-planes: view"),
            medium: Uniform::new(device, "chen-planes: medium"),
            sampling: Uniform::new(device, "chen-planes: sampling"),
            pattern,
            phase: None,
            planes: None,
            frame: None,
            warnings: Vec::new(),
        })
    }

    /// Allocates what depends on the size of the view \[pixels\]; [`Renderer::prepare`] calls it when the
    /// view has another size.
    pub fn resize(&mut self, device: &wgpu::Device, width: u32, height: u32) {
        self.accumulator.resize(device, "chen-planes: accumulated airlight", (width, height));
    }

    /// Places the planes and uploads what this frame needs; once per submit.
    ///
    /// # Errors
    /// [`Error::Reach`] for a reach out of its range, [`Error::Target`] for a view without pixels or too large,
    /// [`Error::LimitExceeded`] where the device has no room. Nothing is drawn of a frame that is refused.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        inputs: &Inputs<'_>,
    ) -> Result<(), Error> {
        // Nothing is drawn of a frame that is refused.
        self.frame = None;
        let View { width, height, depth: DepthRange { near, .. }, .. } = *inputs.view;
        Accumulator::check_size(device, (width, height))?;
        if !(inputs.reach > near && inputs.reach < INFINITE) {
            return Err(Error::Reach { reach: inputs.reach, near });
        }
        if !self.accumulator.has_size((width, height)) {
            self.resize(device, width, height);
        }
        let peak =
            || Warning::peak(inputs.medium, inputs.lights.iter().map(|light| &light.light), MOST_PEAKED);
        let told =
            [Warning::far_from_the_origin(inputs.view), coarse_map(inputs.lights, inputs.view), peak()];
        self.warnings = told.into_iter().flatten().collect();
        self.prepare_planes(device, queue, inputs)?;
        if self.phase.as_ref().is_none_or(|(built, _)| *built != inputs.medium.phase) {
            let texture = phase::upload(device, queue, &inputs.medium.phase, self.options.phase_texels);
            self.phase = Some((inputs.medium.phase.clone(), texture));
        }
        self.view.write(queue, &ViewUniform::from(inputs.view));
        self.medium.write(queue, &MediumUniform::from(inputs.medium));
        let most = match self.accumulator.format() {
            wgpu::TextureFormat::Rgba16Float => 6e4,
            _ => 1e37,
        };
        let contributions = self.options.planes as usize * inputs.lights.len().max(1);
        self.sampling.write(
            queue,
            &SamplingUniform {
                last_phase_texel: (self.options.phase_texels - 1) as f32,
                most: most / contributions as f32,
                nearest: 1e-6 * inputs.reach,
                reach: inputs.reach,
            },
        );
        let Self { layouts, options, accumulator, pipelines, .. } = self;
        let test = DepthTest::of(inputs.depth, inputs.view.depth).filter(|_| options.early_end);
        let with_pipeline = |light: &LightBinding| {
            let variant = Variant::new(&light.light, inputs.medium);
            let make = || planes_pipeline(device, layouts, options, accumulator.format(), variant, test);
            (pipelines.entry((variant, test)).or_insert_with(make).clone(), light.bind_group.clone())
        };
        let lights = inputs.lights.iter().map(with_pipeline).collect();
        use wgpu::BindingResource::TextureView;
        self.frame = self.phase.as_ref().map(|(_, phase)| Frame {
            group: bind_group(
                device,
                "chen-planes: frame",
                &self.layouts.frame,
                [
                    self.view.buffer.as_entire_binding(),
                    self.medium.buffer.as_entire_binding(),
                    self.sampling.buffer.as_entire_binding(),
                    TextureView(inputs.depth),
                    TextureView(phase),
                ],
            ),
            lights,
            depth: test.map(|_| inputs.depth.clone()),
        });
        Ok(())
    }

    /// What of the frame prepared last is drawn, but not well.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    fn prepare_planes(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        inputs: &Inputs<'_>,
    ) -> Result<(), Error> {
        let Options { planes, placement, factor, .. } = self.options;
        let Inputs { view, medium, reach, .. } = *inputs;
        let mut data: Vec<PlaneData> = Vec::with_capacity(planes as usize * inputs.lights.len());
        for light in inputs.lights {
            let mut slabs = placement::slabs(placement, planes, reach, view, medium, &light.light);
            if let (Factor::Integrated, Some(last)) = (factor, slabs.last_mut()) {
                *last = INFINITE;
            }
            data.extend(slabs.windows(2).map(|ends| plane(view, ends[0], ends[1], reach)));
        }
        let usage = wgpu::BufferUsages::VERTEX;
        fill_buffer(device, queue, &mut self.planes, "planes", usage, &data)?;
        Ok(())
    }

    /// Encodes all passes; airlight is added to `target`. Nothing without a [`Renderer::prepare`].
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        let (Some(view), Some(frame), Some(planes)) = (self.accumulator.view(), &self.frame, &self.planes)
        else {
            return;
        };
        self.accumulator.encode_clear(encoder, Self::PASSES[0], timer);
        let count = self.options.planes;
        for ((pipeline, light), first) in frame.lights.iter().zip((0..).step_by(count as usize)) {
            let attachments = Attachments {
                color: Some((view, wgpu::LoadOp::Load)),
                depth_stencil: frame.depth.as_ref().map(|view| wgpu::RenderPassDepthStencilAttachment {
                    view,
                    depth_ops: None,
                    stencil_ops: None,
                }),
            };
            let mut pass = begin_pass(encoder, attachments, Self::PASSES[1], timer);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &frame.group, &[]);
            pass.set_bind_group(1, light, &[]);
            pass.set_vertex_buffer(0, self.pattern.points.slice(..));
            pass.set_vertex_buffer(1, planes.slice(..));
            pass.set_index_buffer(self.pattern.triangles.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..self.pattern.indices, 0, first..first + count);
        }
        self.accumulator.encode_add(encoder, target, Self::PASSES[2], timer);
    }
}

/// The plane in the middle of a slab between two depths \[m\], and the corners of what the view shows of it.
fn plane(view: &View, front: f32, back: f32, reach: f32) -> PlaneData {
    let depth = 0.5 * (front + back.min(reach));
    let (right, up, forward) = view.camera.basis();
    let half = view.half_extent() * depth;
    let corner =
        |at: Vec2| view.camera.eye + forward * depth + right * (at.x * half.x) + up * (at.y * half.y);
    let with = |corner: Vec3, w: f32| corner.extend(w).to_array();
    [
        with(corner(Vec2::new(-1.0, -1.0)), front),
        with(corner(Vec2::new(1.0, -1.0)), back),
        with(corner(Vec2::new(-1.0, 1.0)), depth),
    ]
}

#[cfg(test)]
mod tests {
    use common::gpu::bench::check_uniform_layout;
    use common::gpu::uniform_bytes;

    use super::*;

    #[test]
    fn sampling_lies_as_wgsl_has_it() {
        let block = SamplingUniform { last_phase_texel: 1.0, most: 3.0, nearest: 4.0, reach: 5.0 };
        let expect = [
            ("last_phase_texel", 1f32.to_bits()),
            ("most", 3f32.to_bits()),
            ("nearest", 4f32.to_bits()),
            ("reach", 5f32.to_bits()),
        ];
        check_uniform_layout(&crate::shaders::planes(), "Sampling", &uniform_bytes(&block), &expect).unwrap();
    }
}
