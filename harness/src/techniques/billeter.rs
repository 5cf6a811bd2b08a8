//! Adapter of the polygonal light volumes.

use billeter_plv::{Accumulation, Inputs, Options, Renderer, Tessellation};
use common::gpu::PassTimer;
use serde_json::{Map, Value};

use super::{Frame, Technique};

/// A setting: the crate's options for a target of some format.
pub(crate) type Setting = fn(wgpu::TextureFormat) -> Options;

/// Changes to the paper's setting, one at a time: name, what it is, and the setting.
pub(super) const IMPROVEMENTS: [(&str, &str, Setting); 4] = [
    ("adaptive", "paper + adaptive mesh", |format| Options {
        tessellation: Tessellation::ADAPTIVE,
        ..Options::paper(format)
    }),
    ("quadrature", "paper + quadrature", |format| Options {
        evaluation: Options::best(format).evaluation,
        ..Options::paper(format)
    }),
    ("f32", "paper + 32-bit sum", |format| Options {
        accumulation: Accumulation::F32,
        ..Options::paper(format)
    }),
    ("upright", "paper + upright walls", |format| Options { upright_walls: true, ..Options::paper(format) }),
];

/// The crate's renderer, driven by the harness.
pub(super) struct Billeter(Renderer);

impl Billeter {
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        setting: Setting,
        (width, height): (u32, u32),
    ) -> Result<Self, String> {
        let mut renderer =
            Renderer::new(device, queue, &setting(format)).map_err(|error| error.to_string())?;
        renderer.resize(device, width, height);
        Ok(Self(renderer))
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

/// Settings by name, as the crate spells them.
pub(super) fn settings(setting: Setting) -> Map<String, Value> {
    let options = setting(wgpu::TextureFormat::Rgba32Float);
    let text = |value: &dyn std::fmt::Debug| Value::from(format!("{value:?}"));
    Map::from_iter([
        ("volume".into(), text(&options.volume)),
        ("evaluation".into(), text(&options.evaluation)),
        ("tessellation".into(), text(&options.tessellation)),
        ("upright_walls".into(), options.upright_walls.into()),
        ("accumulation".into(), text(&options.accumulation)),
        ("clamp_negative".into(), options.clamp_negative.into()),
    ])
}
