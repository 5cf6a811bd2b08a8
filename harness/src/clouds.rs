//! A cloud on the device, frame by frame.

use std::collections::BTreeMap;
use std::time::Instant;

use common::gpu::{Context, Ground, PassTimer, Targets, read_floats, read_image};
use common::image::Image;
use common::{Cloud, Scene};
use szk_network::{Inputs, Options, Particles, Renderer, Sampling};

use crate::failure::Failure;
use crate::interrupt;

/// Where a solution counts as found.
pub(crate) const RESIDUAL: f32 = 1e-3;
const MOST_STEPS: u32 = 400;

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
