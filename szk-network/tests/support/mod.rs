//! Clouds that the tests draw, and drawing them.

#![allow(dead_code, reason = "each test program uses a part")]

use std::sync::Mutex;

use common::gpu::bench::context;
use common::gpu::{Ground, PassTimer, Targets, read_floats, read_image, read_u32s};
use common::image::Image;
use common::{Camera, Cloud, Density, DirectionalLight, Light, Phase, Scene};
use glam::Vec3;
use szk_network::{Error, Inputs, Options, Particles, Renderer};

/// A sphere of radius 1 m and 20 optical depths across.
pub(crate) fn sphere(albedo: f32, phase: Phase) -> Cloud {
    Cloud {
        density: Density::Sphere { centre: Vec3::ZERO, radius: 1.0 },
        sigma_t: 10.0,
        albedo: Vec3::splat(albedo),
        phase,
        emission: Vec3::ZERO,
    }
}

/// Parallel light of irradiance 1 W/m².
pub(crate) fn sun(direction: Vec3) -> Light {
    Light::Directional(DirectionalLight { direction: direction.normalize(), irradiance: Vec3::ONE })
}

/// A cloud in clear air.
pub(crate) fn scene(cloud: Cloud, light: Light) -> Scene {
    let mut scene = Scene::empty("cloud");
    scene.cloud = Some(cloud);
    scene.lights = vec![light];
    scene.camera = Camera { eye: Vec3::new(0.0, 0.0, 4.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.6 };
    scene
}

/// The default for targets of the best format here.
pub(crate) fn best() -> Options {
    Options::best(context().radiance_format())
}

/// The paper's setting for such targets.
pub(crate) fn paper() -> Options {
    Options::paper(context().radiance_format())
}

/// A scene on the device with a cloud loaded.
pub(crate) struct Stage {
    pub(crate) scene: Scene,
    renderer: Option<Renderer>,
    options: Options,
    pub(crate) ground: Ground,
    targets: Targets,
    size: (u32, u32),
}

impl Stage {
    pub(crate) fn new(
        scene: &Scene,
        particles: &Particles,
        options: &Options,
        size: (u32, u32),
    ) -> Result<Self, Error> {
        let (device, queue) = (&context().device, &context().queue);

        let kept = {
            let mut idle = idle().lock().unwrap();
            let index = idle.iter().position(|(of, _)| of == options);
            index.map(|index| idle.swap_remove(index).1)
        };
        let mut renderer = match kept {
            Some(renderer) => renderer,
            None => Renderer::new(device, options)?,
        };
        renderer.load(device, queue, particles)?;
        let format = context().radiance_format();
        let ground = Ground::new(device, queue, scene, format, 256).unwrap();
        let targets = Targets::new(device, size.0, size.1, format);

        Ok(Self { scene: scene.clone(), renderer: Some(renderer), options: *options, ground, targets, size })
    }

    /// The renderer, the cloud loaded.
    pub(crate) fn renderer(&self) -> &Renderer {
        self.renderer.as_ref().unwrap()
    }

    /// Draws a frame over black.
    pub(crate) fn draw(&mut self, steps: u32, residual: f32, relight: bool) -> Result<Image, Error> {
        let (device, queue) = (&context().device, &context().queue);
        let view = self.scene.camera.view(self.size.0, self.size.1);
        self.ground.prepare(device, queue, &self.scene, &view).unwrap();
        let inputs = Inputs {
            view: &view,
            lights: self.ground.lights(),
            sky: &self.scene.sky,
            depth: &self.targets.depth,
            relight,
            steps,
            residual,
        };
        self.renderer.as_mut().unwrap().prepare(device, queue, &inputs)?;
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut off = PassTimer::off();
        self.targets.encode_clear(&mut encoder);
        self.ground.encode_shadows(&mut encoder, &mut off);
        self.ground.encode_depth(&mut encoder, &self.targets, &mut off);
        self.ground.encode_surfaces(&mut encoder, &self.targets, &mut off);
        self.renderer().encode(&mut encoder, &self.targets.radiance_view, &mut off);
        queue.submit([encoder.finish()]);
        let image = read_image(device, queue, &self.targets.radiance).unwrap();
        if let Some(error) = context().take_error() {
            panic!("{error}");
        }
        Ok(image)
    }

    /// Moves the particles.
    pub(crate) fn update(&mut self, particles: &Particles, directions: u32) -> Result<(), Error> {
        self.renderer.as_mut().unwrap().update(&context().queue, particles, directions)
    }

    /// Floats of one of the network's buffers.
    pub(crate) fn floats(&self, buffer: &wgpu::Buffer) -> Vec<f32> {
        read_floats(&context().device, &context().queue, buffer, (buffer.size() / 4) as usize).unwrap()
    }

    /// Integers of one of the network's buffers.
    pub(crate) fn integers(&self, buffer: &wgpu::Buffer) -> Vec<u32> {
        read_u32s(&context().device, &context().queue, buffer, (buffer.size() / 4) as usize).unwrap()
    }

    /// Residual of the last step, and number of steps taken.
    pub(crate) fn state(&self) -> (f32, u32) {
        let state = self.floats(self.renderer().buffers().unwrap().state);
        (state[0], state[1] as u32)
    }
}

/// Renderers that no stage has: compiling takes longer than drawing.
fn idle() -> &'static Mutex<Vec<(Options, Renderer)>> {
    static IDLE: Mutex<Vec<(Options, Renderer)>> = Mutex::new(Vec::new());
    &IDLE
}

impl Drop for Stage {
    fn drop(&mut self) {
        if let (Some(renderer), Ok(mut idle)) = (self.renderer.take(), idle().lock()) {
            idle.push((self.options, renderer));
        }
    }
}
