//! A cloud on the device, frame by frame, and the pictures that it is held against.

use std::collections::BTreeMap;
use std::time::Instant;

use common::gpu::{Context, Ground, PassTimer, Targets, read_floats, read_image};
use common::image::Image;
use common::reference::{Options as Settings, multiple};
use common::{Cloud, Scene, Term, Terms};
use serde::Serialize;
use szk_network::{Inputs, Options, Particles, Renderer, Sampling};

use crate::cmd::reference_with;
use crate::failure::Failure;
use crate::interrupt;

/// Where a solution counts as found.
pub(crate) const RESIDUAL: f32 = 1e-3;
const MOST_STEPS: u32 = 400;

/// Paths per pixel of each of two references.
const PATHS: u32 = 24;

/// A scene, its cloud loaded.
pub(crate) struct Lab<'a> {
    context: &'a Context,
    pub scene: Scene,
    pub renderer: Renderer,
    ground: Ground,
    targets: Targets,
    timer: PassTimer,
    size: (u32, u32),
}

/// A frame.
pub(crate) struct Frame {
    pub image: Image,
    /// From its beginning until the device is done with it, reading not counted \[ms\].
    pub ms: f64,
    /// Passes of the technique \[ms\]; empty without timestamps.
    passes: BTreeMap<&'static str, f64>,
    /// Of the last step.
    pub residual: f64,
    /// Steps of this frame.
    pub steps: f64,
}

impl Frame {
    /// Time of the iteration \[ms\], or of the frame where there are no timestamps.
    pub(crate) fn iterate_ms(&self) -> f64 {
        self.passes.get(Renderer::PASSES[2]).copied().unwrap_or(self.ms)
    }
}

fn failed(scene: &Scene, error: &dyn std::fmt::Display) -> Failure {
    Failure::Run(format!("{}: {error}", scene.name))
}

/// Particles of a scene's cloud.
pub(crate) fn particles(scene: &Scene, count: u32, sampling: Sampling) -> Result<Particles, Failure> {
    Particles::sample(cloud(scene)?, count, sampling).map_err(|error| failed(scene, &error))
}

fn cloud(scene: &Scene) -> Result<&Cloud, Failure> {
    scene.cloud.as_ref().ok_or_else(|| failed(scene, &"the scene has no cloud"))
}

impl<'a> Lab<'a> {
    /// Loads the scene's cloud, for pictures of `size`.
    pub(crate) fn new(
        context: &'a Context,
        scene: &Scene,
        particles: &Particles,
        options: &Options,
        size: (u32, u32),
    ) -> Result<Self, Failure> {
        let (device, queue) = (&context.device, &context.queue);
        let mut renderer = Renderer::new(device, options).map_err(|error| failed(scene, &error))?;
        renderer.load(device, queue, particles).map_err(|error| failed(scene, &error))?;
        // Nothing casts shadows.
        let ground = Ground::new(device, queue, scene, options.target_format, 16)
            .map_err(|error| failed(scene, &error))?;
        let targets = Targets::new(device, size.0, size.1, options.target_format);
        let timer = PassTimer::new(device, queue);
        Ok(Self { context, scene: scene.clone(), renderer, ground, targets, timer, size })
    }

    /// Moves the particles; so many directions are linked anew.
    pub(crate) fn update(&mut self, particles: &Particles, directions: u32) -> Result<(), Failure> {
        self.renderer
            .update(&self.context.queue, particles, directions)
            .map_err(|error| failed(&self.scene, &error))
    }

    /// A frame over black.
    pub(crate) fn draw(&mut self, steps: u32, residual: f32, relight: bool) -> Result<Frame, Failure> {
        interrupt::check()?;
        let context = self.context;
        let (device, queue) = (&context.device, &context.queue);
        let wrong = |error: &dyn std::fmt::Display| failed(&self.scene, error);
        let start = Instant::now();
        let view = self.scene.camera.view(self.size.0, self.size.1);
        self.ground.prepare(device, queue, &self.scene, &view).map_err(|error| wrong(&error))?;
        let inputs = Inputs {
            view: &view,
            lights: self.ground.lights(),
            sky: &self.scene.sky,
            depth: &self.targets.depth,
            relight,
            steps,
            residual,
        };
        self.renderer.prepare(device, queue, &inputs).map_err(|error| wrong(&error))?;
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut off = PassTimer::off();
        self.targets.encode_clear(&mut encoder);
        self.ground.encode_shadows(&mut encoder, &mut off);
        self.ground.encode_depth(&mut encoder, &self.targets, &mut off);
        self.renderer.encode(&mut encoder, &self.targets.radiance_view, &mut self.timer);
        self.timer.resolve(&mut encoder);
        queue.submit([encoder.finish()]);
        context.wait().map_err(|error| wrong(&error))?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let passes = self.timer.read(device, queue);
        let lost = || wrong(&"the device was lost");
        let image = read_image(device, queue, &self.targets.radiance).ok_or_else(lost)?;
        let state = self.renderer.buffers().and_then(|buffers| read_floats(device, queue, buffers.state, 4));
        let state = state.ok_or_else(lost)?;
        Ok(Frame { image, ms, passes, residual: state[0].into(), steps: state[3].into() })
    }

    /// Lights it and iterates until the solution is found.
    pub(crate) fn settle(&mut self) -> Result<Frame, Failure> {
        self.draw(MOST_STEPS, RESIDUAL, true)
    }
}

/// Two pictures of the same by independent paths: their noise cancels from products of errors.
pub(crate) struct Truth {
    halves: [Image; 2],
    mean: Image,
    /// Standard error of the mean of both, relative RMS.
    pub noise: f64,
}

/// Of a picture against the paths, over what is lit, as everywhere: relative RMSE with the noise of the paths taken
/// out, and bias.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Off {
    pub rel_rmse: f64,
    pub bias: f64,
}

impl Truth {
    /// All that a cloud scatters, in pictures of `size`; `progress` is told the finished part of either.
    pub(crate) fn of(
        scene: &Scene,
        size: (u32, u32),
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Self, Failure> {
        let still = scene.at(0.0);
        let view = still.camera.view(size.0, size.1);
        let terms = Terms::from(Term::Airlight).with(Term::Multiple);
        let half = |seed| {
            let multiple = multiple::Options { samples: PATHS, seed, ..Default::default() };
            let rendered =
                reference_with(&still, &view, terms, Settings { multiple, ..Default::default() }, progress)?;
            Ok(rendered.total())
        };
        let halves: [Image; 2] = [half(1)?, half(2)?];
        let mut mean = halves[0].plus(&halves[1]);
        mean.pixels.iter_mut().for_each(|pixel| *pixel *= 0.5);
        let mut truth = Self { halves, mean, noise: 0.0 };
        truth.noise = 0.5 * relative(&truth.halves[0], &truth.halves[1])?;
        Ok(truth)
    }

    pub(crate) fn off(&self, image: &Image) -> Result<Off, Failure> {
        let bias = errors(image, &self.mean)?.bias;
        let [a, b] = &self.halves;
        let (mut product, mut sum, mut lit) = (0.0, 0.0, 0.0);
        for (((x, a), b), mean) in image.pixels.iter().zip(&a.pixels).zip(&b.pixels).zip(&self.mean.pixels) {
            if mean.max_element() > 0.0 {
                product += (*x - *a).as_dvec3().dot((*x - *b).as_dvec3());
                sum += mean.as_dvec3().element_sum();
                lit += 3.0;
            }
        }
        let rmse = (product / f64::max(lit, 1.0)).max(0.0).sqrt();
        Ok(Off { rel_rmse: rmse / (sum / f64::max(lit, 1.0)), bias })
    }

    pub(crate) fn image(&self) -> &Image {
        &self.mean
    }
}

fn errors(image: &Image, other: &Image) -> Result<common::metrics::Errors, Failure> {
    common::metrics::compare(image, other).map_err(|error| Failure::Run(error.to_string()))
}

/// Relative RMSE of a picture against another one.
pub(crate) fn relative(image: &Image, other: &Image) -> Result<f64, Failure> {
    Ok(errors(image, other)?.rel_rmse)
}
