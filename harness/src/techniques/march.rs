//! Adapter of the ray march.

use common::gpu::PassTimer;
use serde_json::{Map, Value};

use super::{Frame, Technique};
use crate::peers::raymarch::RayMarch;

/// A ray march, driven by the harness.
pub(super) struct March(RayMarch);

impl March {
    pub(super) fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        steps: u32,
        equiangular: bool,
    ) -> Self {
        Self(RayMarch::new(device, format, steps, equiangular))
    }
}

impl Technique for March {
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        let Frame { device, queue, scene, view, lights, depth } = frame;
        self.0.prepare(device, queue, scene, view, lights, depth);
        Ok(())
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer) {
        self.0.encode(encoder, target, timer);
    }
}

/// Settings by name.
pub(super) fn settings(steps: u32, equiangular: bool) -> Map<String, Value> {
    let spacing = if equiangular { "equi-angular" } else { "uniform" };
    Map::from_iter([("steps".into(), steps.into()), ("spacing".into(), spacing.into())])
}
