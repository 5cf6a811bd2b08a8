//! Adapter of the sorted shadow planes.

use std::sync::Arc;

use biri_ss::{Accumulation, Airlight, Counting, Inputs, Options, Order, Outputs, Renderer};
use common::gpu::PassTimer;
use glam::Vec3;
use serde_json::Value;

use super::settings::{merged, written};
use super::{ANY, Frame, Recipe, Technique};

/// Changes to the paper's setting, one at a time: name, what it is, and the setting.
pub(super) fn improvements() -> [(&'static str, &'static str, Options); 6] {
    let paper = Options::paper(ANY);
    let rest = best(256, 512).airlight;
    [
        ("order", "paper + exact order", Options { order: Order::Exact, ..paper }),
        ("from-eye", "paper + counting from the eye", Options { counting: Counting::FromEye, ..paper }),
        (
            "quadrature",
            "paper + quadrature",
            Options { airlight: Airlight::Quadrature { panels: 1 }, ..paper },
        ),
        ("gamma-rest", "paper + well-conditioned table", Options { airlight: rest, ..paper }),
        ("cull", "paper + culling", Options { cull: true, faintest: 1e-5, ..paper }),
        ("f32", "paper + 32-bit sum", Options { accumulation: Accumulation::F32, ..paper }),
    ]
}

/// The default with a table of another size.
pub(super) fn best(width: u32, height: u32) -> Options {
    let airlight = Airlight::GammaRest { width, height, format: common::gpu::TableFormat::F32 };
    Options { airlight, ..Options::best(ANY) }
}

/// The crate's renderer, driven by the harness.
struct Biri(Renderer);

impl Recipe for Options {
    fn make(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        target_format: wgpu::TextureFormat,
        (width, height): (u32, u32),
    ) -> Result<Box<dyn Technique>, String> {
        let options = Self { target_format, ..*self };
        let mut renderer = Renderer::new(device, queue, &options).map_err(|error| error.to_string())?;
        renderer.resize(device, width, height);
        Ok(Box::new(Biri(renderer)))
    }

    fn options(&self) -> Value {
        written(self)
    }

    fn with(&self, options: &Value) -> Result<Arc<dyn Recipe>, String> {
        Ok(Arc::new(Self { target_format: ANY, ..merged(self, options)? }))
    }

    fn shadow_planes(&self) -> Option<Options> {
        Some(*self)
    }
}

impl Technique for Biri {
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        let inputs = Inputs {
            view: frame.view,
            medium: &frame.scene.medium,
            lights: &frame.scene.lights,
            casters: &frame.scene.objects,
            depth: frame.depth,
            surfaces: None,
            ambient: Vec3::ZERO,
        };
        self.0.prepare(frame.device, frame.queue, &inputs).map_err(|error| error.to_string())
    }

    fn warnings(&self) -> Vec<String> {
        self.0.warnings().iter().map(ToString::to_string).collect()
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer) {
        let outputs = Outputs { airlight: target, surfaces: None, indirect: None };
        self.0.encode(encoder, &outputs, timer);
    }

    fn silhouette_edges(&self) -> Option<u64> {
        Some(self.0.statistics().silhouette_edges as u64)
    }
}
