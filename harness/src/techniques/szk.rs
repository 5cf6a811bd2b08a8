//! Adapter of the illumination network.

use std::sync::Arc;

use common::gpu::PassTimer;
use common::{Light, Scene, Sky};
use glam::{Affine3A, Vec3};
use serde_json::Value;
use szk_network::{Colours, Inputs, Options, Particles, Renderer, Sampling};

use super::settings::{merged, written};
use super::{ANY, Frame, Recipe, Technique};

/// Steps of the first frame: up to a residual, but no more than these.
const FIRST_STEPS: u32 = 400;
const RESIDUAL: f32 = 1e-3;

/// A cloud's particles, and what is done with them.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct Setting {
    pub particles: u32,
    pub sampling: Sampling,
    pub options: Options,
}

impl Default for Setting {
    fn default() -> Self {
        best(super::PARTICLES, super::DIRECTIONS)
    }
}

/// The paper's setting.
pub(super) fn paper() -> Setting {
    Setting { particles: 1024, sampling: Sampling::Random { seed: 1 }, options: Options::paper(ANY) }
}

/// The best setting with so many particles and directions.
pub(super) fn best(particles: u32, directions: u32) -> Setting {
    let options = Options { directions, ..Options::best(ANY) };
    Setting { particles, sampling: Sampling::Even, options }
}

/// The crate's renderer, driven by the harness.
struct Szk {
    setting: Setting,
    /// Made with the first frame, whose scene has the cloud.
    renderer: Option<Renderer>,
    lit: Option<Lit>,
}

/// What direct light depends on.
#[derive(PartialEq)]
struct Lit {
    lights: Vec<Light>,
    places: Vec<Affine3A>,
}

impl Recipe for Setting {
    fn make(
        &self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
        target_format: wgpu::TextureFormat,
        _size: (u32, u32),
    ) -> Result<Box<dyn Technique>, String> {
        let options = Options { target_format, ..self.options };
        Ok(Box::new(Szk { setting: Self { options, ..*self }, renderer: None, lit: None }))
    }

    fn options(&self) -> Value {
        written(self)
    }

    fn with(&self, options: &Value) -> Result<Arc<dyn Recipe>, String> {
        let Self { particles, sampling, options } = merged(self, options)?;
        Ok(Arc::new(Self { particles, sampling, options: Options { target_format: ANY, ..options } }))
    }

    fn cloud_setting(&self) -> Option<Self> {
        Some(*self)
    }
}

impl Szk {
    /// A renderer with the scene's cloud, dark.
    fn load(&self, frame: &Frame<'_>) -> Result<Renderer, String> {
        let Some(cloud) = &frame.scene.cloud else {
            return Err("szk-network: the scene has no cloud; it draws nothing else".into());
        };
        let Setting { particles, sampling, options } = self.setting;
        let particles = Particles::sample(cloud, particles, sampling).map_err(|error| error.to_string())?;
        let options = Options { colours: colours(frame.scene), ..options };
        let mut renderer = Renderer::new(frame.device, &options).map_err(|error| error.to_string())?;
        renderer.load(frame.device, frame.queue, &particles).map_err(|error| error.to_string())?;
        Ok(renderer)
    }
}

/// One colour where the scene has no others.
fn colours(scene: &Scene) -> Colours {
    let grey = |colour: Vec3| colour == Vec3::splat(colour.x);
    let cloud = scene.cloud.as_ref().is_none_or(|cloud| grey(cloud.albedo) && grey(cloud.emission));
    let lights = scene.lights.iter().all(|light| match light {
        Light::Point(light) => grey(light.intensity),
        Light::Spot(light) => grey(light.intensity),
        Light::Directional(light) => grey(light.irradiance),
    });
    let sky = match &scene.sky {
        Sky::Constant(radiance) => grey(*radiance),
        sky => sky.is_black(),
    };
    if cloud && lights && sky { Colours::Grey } else { Colours::Rgb }
}

impl Technique for Szk {
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        let (steps, residual) = if self.renderer.is_none() { (FIRST_STEPS, RESIDUAL) } else { (1, 0.0) };
        let renderer = match self.renderer.take() {
            Some(renderer) => renderer,
            None => self.load(frame)?,
        };
        let lit = Lit {
            lights: frame.scene.lights.clone(),
            places: frame.scene.objects.iter().map(|object| object.world_from_object).collect(),
        };
        let inputs = Inputs {
            view: frame.view,
            lights: frame.lights,
            sky: &frame.scene.sky,
            depth: frame.depth,
            relight: self.lit.as_ref() != Some(&lit),
            steps,
            residual,
        };
        self.lit = Some(lit);
        self.renderer
            .insert(renderer)
            .prepare(frame.device, frame.queue, &inputs)
            .map_err(|error| error.to_string())
    }

    fn warnings(&self) -> Vec<String> {
        let warnings = self.renderer.iter().flat_map(|renderer| renderer.warnings());
        warnings.map(ToString::to_string).collect()
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer) {
        if let Some(renderer) = &self.renderer {
            renderer.encode(encoder, target, timer);
        }
    }
}
