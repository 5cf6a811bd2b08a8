//! Adapter of the polygonal light volumes.

use billeter_plv::{Inputs, Options, Renderer};
use common::gpu::PassTimer;
use serde_json::{Map, Value};

use super::{Frame, Technique};

/// The crate's renderer, driven by the harness.
pub(super) struct Billeter(Renderer);

impl Billeter {
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        paper: bool,
        (width, height): (u32, u32),
    ) -> Result<Self, String> {
        let mut renderer =
            Renderer::new(device, queue, &options(paper, format)).map_err(|e| e.to_string())?;
        renderer.resize(device, width, height);
        Ok(Self(renderer))
    }
}

fn options(paper: bool, format: wgpu::TextureFormat) -> Options {
    if paper { Options::paper(format) } else { Options::best(format) }
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

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer) {
        self.0.encode(encoder, target, timer);
    }
}

/// Settings by name, as the crate spells them.
pub(super) fn settings(paper: bool) -> Map<String, Value> {
    let options = options(paper, wgpu::TextureFormat::Rgba32Float);
    let text = |value: &dyn std::fmt::Debug| Value::from(format!("{value:?}"));
    Map::from_iter([
        ("evaluation".into(), text(&options.evaluation)),
        ("tessellation".into(), text(&options.tessellation)),
        ("accumulation".into(), text(&options.accumulation)),
        ("clamp_negative".into(), options.clamp_negative.into()),
    ])
}
