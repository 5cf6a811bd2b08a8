//! A cloud in the evening sun: the crate by itself, 60 lines, `minimal.png`.
//!
//! `cargo run --release -p szk-network --example szk-network-minimal`

use common::cloud::Cumulus;
use common::gpu::{Context, ContextOptions, Ground, PassTimer, Targets, read_image};
use common::{Camera, Cloud, Density, DirectionalLight, Light, Lobe, Scene, Sky};
use glam::Vec3;
use szk_network::{Inputs, Options, Particles, Renderer, Sampling};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A cumulus a hundred metres wide, 20 optical depths through, under a blue sky.
    let cloud = Cloud {
        density: Density::Cumulus(Cumulus::new(Vec3::ZERO, 100.0, 1)),
        sigma_t: 0.4,
        albedo: Vec3::splat(0.99),
        phase: Lobe::HenyeyGreenstein { g: 0.5 }.into(),
        emission: Vec3::ZERO,
    };
    let mut scene = Scene::empty("cloud");
    let direction = Vec3::new(1.0, -0.5, -0.4).normalize();
    scene
        .lights
        .push(Light::Directional(DirectionalLight { direction, irradiance: Vec3::new(5.0, 4.0, 2.5) }));
    scene.sky = Sky::Constant(Vec3::new(0.15, 0.22, 0.4));
    let (eye, target) = (Vec3::new(0.0, 12.0, 130.0), Vec3::new(0.0, 28.0, 0.0));
    scene.camera = Camera { eye, target, up: Vec3::Y, fov_y: 0.8 };
    let view = scene.camera.view(640, 480);

    // Depth and shadow maps: what a program of your own has already.
    let context = Context::new(&ContextOptions::default())?;
    let (device, queue) = (&context.device, &context.queue);
    let format = context.radiance_format();
    let targets = Targets::new(device, view.width, view.height, format);
    let mut ground = Ground::new(device, queue, &scene, format, 64)?;
    ground.prepare(device, queue, &scene, &view)?;

    // The technique: a cloud loaded once, some steps in every frame.
    let particles = Particles::sample(&cloud, 4096, Sampling::Even)?;
    let mut network = Renderer::new(device, &Options { target_format: format, ..Options::default() })?;
    network.load(device, queue, &particles)?;
    for warning in network.warnings() {
        println!("note: {warning}");
    }
    let (lights, depth) = (ground.lights(), &targets.depth);
    let inputs =
        Inputs { view: &view, lights, sky: &scene.sky, depth, relight: true, steps: 200, residual: 1e-3 };
    network.prepare(device, queue, &inputs)?;

    let mut encoder = device.create_command_encoder(&Default::default());
    let mut timer = PassTimer::off();
    targets.encode_clear(&mut encoder);
    ground.encode_shadows(&mut encoder, &mut timer);
    ground.encode_depth(&mut encoder, &targets, &mut timer);
    network.encode(&mut encoder, &targets.radiance_view, &mut timer);
    queue.submit([encoder.finish()]);

    let image = read_image(device, queue, &targets.radiance).ok_or("the device was lost")?;
    image.write_png("minimal.png".as_ref(), image.auto_exposure())?;
    println!("minimal.png, drawn by {}", context.adapter);
    Ok(())
}
