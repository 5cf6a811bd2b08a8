//! One light: its shadow planes, and what the GPU has of them.

use std::ops::Range;
use std::sync::Arc;

use common::gpu::passes::bind_group;
use common::gpu::{LightUniform, Projection, Uniform, fill_buffer};
use common::scene::Object;
use common::{DepthRange, Light, View};
use encase::ShaderType;
use glam::{Mat4, Vec3, Vec4};

use crate::bsp::Piece;
use crate::connectivity::Connectivity;
use crate::pipelines::Pipelines;
use crate::shadows::Shadows;
use crate::silhouette::Origin;
use crate::{Counting, Error, Options};

/// Twin of WGSL `Volume`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct VolumeUniform {
    clip_from_world: Mat4,
    eye: Vec3,
    panels: u32,
    ambient: Vec3,
    share: f32,
    column: Vec3,
}

/// What all lights have in common.
pub(crate) struct Volume {
    pub(crate) panels: u32,
    pub(crate) ambient: Vec3,
    pub(crate) share: f32,
    pub(crate) column: Vec3,
}

/// A WGSL `Plane`: three vectors, each padded to four numbers.
type Plane = [[f32; 4]; 3];

/// A light from frame to frame.
pub(crate) struct LightState {
    pub(crate) shadows: Shadows,
    pub(crate) eye_depth: u32,
    pub(crate) pipelines: Option<Pipelines>,
    /// The eye, off all planes, and how near to it planes are drawn \[m\].
    eye: Vec3,
    near: f32,
    /// Planes to draw, each as often as it counts: in order, and behind these what depth-fail counts.
    order: Vec<u32>,
    ordered: u32,
    caps: Vec<f32>,
    changed: bool,
    light: Uniform<LightUniform>,
    volume: Uniform<VolumeUniform>,
    planes: Option<wgpu::Buffer>,
    numbers: Option<wgpu::Buffer>,
    cap_corners: Option<wgpu::Buffer>,
    group: Option<wgpu::BindGroup>,
}

impl LightState {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        Self {
            shadows: Shadows::default(),
            eye_depth: 0,
            pipelines: None,
            eye: Vec3::ZERO,
            near: 0.0,
            order: Vec::new(),
            ordered: 0,
            caps: Vec::new(),
            changed: true,
            light: Uniform::new(device, "biri-ss: light"),
            volume: Uniform::new(device, "biri-ss: volume"),
            planes: None,
            numbers: None,
            cap_corners: None,
            group: None,
        }
    }

    /// Finds what moved: silhouettes, order, and in how many shadows the eye is.
    pub(crate) fn find(
        &mut self,
        origin: Origin,
        casters: &[Object],
        meshes: &[Arc<Connectivity>],
        view: &View,
        options: &Options,
        reach: f64,
    ) {
        let changed = self.shadows.update(origin, casters, meshes, options.order, reach);
        let eye = view.camera.eye;
        // A few roundings of the coordinates that planes are placed with.
        let tolerance = 1e-6 * (f64::from(eye.abs().max_element()) + origin.from(eye.as_dvec3()).length());
        let tolerance = tolerance.max(1e-6 * f64::from(view.depth.near));
        let walk = self.shadows.walk(eye, tolerance);
        self.eye_depth = walk.depth;
        self.eye = walk.eye;
        self.near = (0.5 * tolerance) as f32;
        let clip = self.clip_from_world(view);
        let pieces = self.shadows.pieces();
        self.order.clear();
        for index in walk.order {
            let piece = &pieces[index as usize];
            if !options.cull || is_in_view(&clip, origin, piece) {
                self.order.extend(std::iter::repeat_n(index, piece.weight as usize));
            }
        }
        if options.counting == Counting::DepthFail {
            self.order.reverse();
        }
        self.ordered = self.order.len() as u32;
        if options.counting == Counting::DepthFail {
            // Whole planes lie behind the pieces in their buffer.
            for (index, piece) in (pieces.len() as u32..).zip(self.shadows.whole()) {
                self.order.extend(std::iter::repeat_n(index, piece.weight as usize));
            }
            if changed {
                self.caps = self.shadows.caps().iter().flatten().flat_map(|p| p.to_array()).collect();
            }
        }
        self.changed |= changed;
    }

    fn clip_from_world(&self, view: &View) -> Mat4 {
        let mut view = View { depth: DepthRange::reversed(self.near), ..*view };
        let away = self.eye - view.camera.eye;
        if away != Vec3::ZERO {
            view.camera.eye += away;
            view.camera.target += away;
        }
        view.clip_from_world()
    }

    /// Brings the GPU up to date.
    pub(crate) fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        layout: &wgpu::BindGroupLayout,
        light: &Light,
        view: &View,
        volume: &Volume,
    ) -> Result<(), Error> {
        // What light-from-ray distances are measured by; any length of the scene's size.
        let far = 1000.0 * view.camera.eye.distance(view.camera.target);
        let none = Projection { size: 2, near: 0.0, far, range: 0.0, layers: Vec::new() };
        self.light.write(queue, &LightUniform::new(light, &none));
        self.volume.write(
            queue,
            &VolumeUniform {
                clip_from_world: self.clip_from_world(view),
                eye: self.eye,
                panels: volume.panels,
                ambient: volume.ambient,
                share: volume.share,
                column: volume.column,
            },
        );
        let mut moved = self.group.is_none();
        if self.changed {
            let planes: Vec<Plane> = self
                .shadows
                .pieces()
                .iter()
                .chain(self.shadows.whole().iter().filter(|_| self.ordered < self.order.len() as u32))
                .map(|piece| [piece.from, piece.to, piece.normal].map(|v| v.extend(0.0).to_array()))
                .collect();
            let storage = wgpu::BufferUsages::STORAGE;
            moved |= fill_buffer(device, queue, &mut self.planes, "biri-ss: planes", storage, &planes)?;
            moved |= fill_buffer(device, queue, &mut self.cap_corners, "biri-ss: caps", storage, &self.caps)?;
            self.changed = false;
        }
        fill_buffer(
            device,
            queue,
            &mut self.numbers,
            "biri-ss: order",
            wgpu::BufferUsages::VERTEX,
            &self.order,
        )?;
        if let (true, Some(planes), Some(caps)) = (moved, &self.planes, &self.cap_corners) {
            let buffers = [&self.light.buffer, &self.volume.buffer, planes, caps];
            let resources = buffers.map(wgpu::Buffer::as_entire_binding);
            self.group = Some(bind_group(device, "biri-ss: light", layout, resources));
        }
        Ok(())
    }

    pub(crate) fn group(&self) -> Option<&wgpu::BindGroup> {
        self.group.as_ref()
    }

    /// Planes that are drawn, each as often as it counts.
    pub(crate) fn drawn(&self) -> u32 {
        self.ordered
    }

    /// All planes in one call, in order.
    pub(crate) fn draw_planes(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        self.draw(pass, pipeline, 0..self.ordered);
    }

    /// The planes that depth-fail counts.
    pub(crate) fn draw_whole(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        self.draw(pass, pipeline, self.ordered..self.order.len() as u32);
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline, which: Range<u32>) {
        if let Some(numbers) = self.numbers.as_ref().filter(|_| !which.is_empty()) {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, numbers.slice(..));
            pass.draw(0..4, which);
        }
    }

    /// The caps of the shadow volumes; those of parallel light meet in a point, infinitely far away.
    pub(crate) fn draw_caps(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        let corners = self.caps.len() as u32 / 3;
        if corners > 0 {
            pass.set_pipeline(pipeline);
            pass.draw(0..corners, 0..if self.shadows.is_directional() { 1 } else { 2 });
        }
    }
}

/// Whether any part of a plane may be in the view.
fn is_in_view(clip_from_world: &Mat4, origin: Origin, piece: &Piece) -> bool {
    let away = |p: Vec3| (-origin.from(p.as_dvec3())).as_vec3().extend(0.0);
    let corners = [piece.from.extend(1.0), piece.to.extend(1.0), away(piece.from), away(piece.to)];
    let clip = corners.map(|corner| *clip_from_world * corner);
    // All corners on the wrong side of one of the view's planes: a little more, for rounding.
    let all = |outside: fn(Vec4) -> bool| clip.iter().all(|&p| outside(p));
    !(all(|p| p.x > p.w + 1e-4 * p.w.abs())
        || all(|p| -p.x > p.w + 1e-4 * p.w.abs())
        || all(|p| p.y > p.w + 1e-4 * p.w.abs())
        || all(|p| -p.y > p.w + 1e-4 * p.w.abs())
        || all(|p| p.w < 0.0))
}

#[cfg(test)]
mod tests {
    use common::gpu::bench::check_uniform_layout;
    use common::gpu::uniform_bytes;

    use super::*;

    #[test]
    fn volume_lies_as_wgsl_has_it() {
        let block = VolumeUniform {
            clip_from_world: Mat4::from_diagonal(Vec4::splat(1.0)),
            eye: Vec3::splat(2.0),
            panels: 3,
            ambient: Vec3::splat(4.0),
            share: 5.0,
            column: Vec3::splat(6.0),
        };
        let expect = [
            ("clip_from_world", 1f32.to_bits()),
            ("eye", 2f32.to_bits()),
            ("panels", 3),
            ("ambient", 4f32.to_bits()),
            ("share", 5f32.to_bits()),
            ("column", 6f32.to_bits()),
        ];
        let source = crate::shaders::planes();
        check_uniform_layout(&source, "Volume", &uniform_bytes(&block), &expect).unwrap();
        assert_eq!(size_of::<Plane>(), 48, "three vectors of WGSL");
    }
}
