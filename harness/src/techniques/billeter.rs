//! Adapter of the polygonal light volumes.

use std::sync::Arc;

use billeter_plv::{Accumulation, Inputs, Options, Renderer, Tessellation};
use common::gpu::PassTimer;
use serde_json::Value;

use super::settings::{merged, written};
use super::{ANY, Frame, Recipe, Technique};

/// Changes to the paper's setting, one at a time: name, what it is, and the setting.
pub(super) fn improvements() -> [(&'static str, &'static str, Options); 4] {
    let (paper, best) = (Options::paper(ANY), Options::best(ANY));
    [
        ("adaptive", "paper + adaptive mesh", Options { tessellation: Tessellation::ADAPTIVE, ..paper }),
        ("quadrature", "paper + quadrature", Options { evaluation: best.evaluation, ..paper }),
        ("f32", "paper + 32-bit sum", Options { accumulation: Accumulation::F32, ..paper }),
        ("upright", "paper + upright walls", Options { upright_walls: true, ..paper }),
    ]
}

/// The crate's renderer, driven by the harness.
struct Billeter(Renderer);

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
        Ok(Box::new(Billeter(renderer)))
    }

    fn options(&self) -> Value {
        written(self)
    }

    fn with(&self, options: &Value) -> Result<Arc<dyn Recipe>, String> {
        Ok(Arc::new(Self { target_format: ANY, ..merged(self, options)? }))
    }
}

impl Technique for Billeter {
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        let inputs = Inputs {
            view: frame.view,
            medium: &frame.scene.medium,
            lights: frame.lights,
            depth: frame.depth,
        };
        self.0.prepare(frame.device, frame.queue, &inputs).map_err(|error| error.to_string())
    }

    fn warnings(&self) -> Vec<String> {
        self.0.warnings().iter().map(ToString::to_string).collect()
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer) {
        self.0.encode(encoder, target, timer);
    }

    fn adaptive_triangles(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Option<u32> {
        self.0.read_adaptive_triangles(device, queue)
    }
}
