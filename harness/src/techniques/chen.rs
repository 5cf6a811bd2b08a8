//! Adapter of the sampling planes.

use std::sync::Arc;

use chen_planes::{Accumulation, Factor, Inputs, Options, Placement, Renderer, Visibility, reach};
use common::gpu::PassTimer;
use serde_json::Value;

use super::settings::{merged, written};
use super::{ANY, Frame, Recipe, Technique};

/// Changes to the paper's setting, one at a time: name, what it is, and the setting.
pub(super) fn improvements() -> [(&'static str, &'static str, Options); 10] {
    let paper = Options::paper(ANY);
    [
        (
            "equi-angular",
            "paper + equi-angular planes",
            Options { placement: Placement::EquiAngular, ..paper },
        ),
        (
            "transmittance",
            "paper + planes by transmittance",
            Options { placement: Placement::Transmittance, ..paper },
        ),
        (
            "integrand",
            "paper + planes by the integrand",
            Options { placement: Placement::Integrand, ..paper },
        ),
        ("attenuation", "paper + 1/r² per fragment", Options { factor: Factor::Attenuation, ..paper }),
        ("integrated", "paper + slabs integrated", Options { factor: Factor::Integrated, ..paper }),
        (
            "lattice-shadows",
            "paper + shadows per lattice point",
            Options { visibility: Visibility::PerLatticePoint, ..paper },
        ),
        (
            "samples",
            "paper + 8 places a slab",
            Options { visibility: Visibility::PerFragment { samples: 8 }, ..paper },
        ),
        ("offset", "paper + offset per pixel", Options { offset: true, ..paper }),
        ("early-end", "paper + early end", Options { early_end: true, ..paper }),
        ("f32", "paper + 32-bit sum", Options { accumulation: Accumulation::F32, ..paper }),
    ]
}

/// The paper's setting with so many planes.
pub(super) fn paper(planes: u32) -> Options {
    Options { planes, ..Options::paper(ANY) }
}

/// The best setting with so many planes and places where shadows are looked up.
pub(super) fn best(planes: u32, samples: u32) -> Options {
    Options { planes, visibility: Visibility::PerFragment { samples }, ..Options::best(ANY) }
}

/// Planes and places of the default setting.
pub(super) fn default_setting() -> Options {
    Options::best(ANY)
}

/// The crate's renderer, driven by the harness.
struct Chen(Renderer);

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
        Ok(Box::new(Chen(renderer)))
    }

    fn options(&self) -> Value {
        written(self)
    }

    fn with(&self, options: &Value) -> Result<Arc<dyn Recipe>, String> {
        Ok(Arc::new(Self { target_format: ANY, ..merged(self, options)? }))
    }
}

impl Technique for Chen {
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        let scene = frame.scene;
        let inputs = Inputs {
            view: frame.view,
            medium: &scene.medium,
            lights: frame.lights,
            depth: frame.depth,
            reach: reach(frame.view, scene.bounds(), &scene.lights, &scene.medium),
        };
        self.0.prepare(frame.device, frame.queue, &inputs).map_err(|error| error.to_string())
    }

    fn warnings(&self) -> Vec<String> {
        self.0.warnings().iter().map(ToString::to_string).collect()
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer) {
        self.0.encode(encoder, target, timer);
    }
}
