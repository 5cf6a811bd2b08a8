//! One cube, one light, fog: the crate by itself, 60 lines, `minimal.png`.
//!
//! `cargo run --release -p chen-planes --example chen-planes-minimal`

use std::sync::Arc;

use chen_planes::{Inputs, Options, Renderer, reach};
use common::gpu::{Context, ContextOptions, Ground, PassTimer, Targets, read_image};
use common::scene::{Mesh, Object};
use common::{Camera, Light, Medium, Phase, PointLight, Scene};
use glam::{Affine3A, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A cube in front of a light, in fog that takes away a tenth of the light on every metre.
    let corner = |i: u8| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5;
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let cube = Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect(),
        ..Mesh::default()
    };
    let mut scene = Scene::empty("cube");
    let world_from_object = Affine3A::from_rotation_y(0.6);
    scene.objects.push(Object { name: "cube".into(), mesh: Arc::new(cube), world_from_object });
    let lamp = PointLight { position: Vec3::new(0.4, 0.9, -1.3), intensity: Vec3::new(12.0, 9.0, 5.0) };
    scene.lights.push(Light::Point(lamp));
    scene.medium = Medium::grey(0.1, 0.9, Phase::isotropic());
    scene.camera = Camera { eye: Vec3::new(0.0, 0.5, 4.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.9 };
    let view = scene.camera.view(640, 480);

    // Depth, shadow maps and lit surfaces: what a program of your own has already.
    let context = Context::new(&ContextOptions::default())?;
    let (device, queue) = (&context.device, &context.queue);
    let format = context.radiance_format();
    let targets = Targets::new(device, view.width, view.height, format);
    let mut ground = Ground::new(device, queue, &scene, format, 1024)?;
    ground.prepare(device, queue, &scene, &view)?;

    // The technique: made once, prepared and encoded for every frame.
    let mut planes = Renderer::new(device, queue, &Options { target_format: format, ..Options::default() })?;
    let depth = &targets.depth;
    let reach = reach(&view, scene.bounds(), &scene.lights, &scene.medium);
    planes.prepare(
        device,
        queue,
        &Inputs { view: &view, medium: &scene.medium, lights: ground.lights(), depth, reach },
    )?;

    let mut encoder = device.create_command_encoder(&Default::default());
    let mut timer = PassTimer::off();
    targets.encode_clear(&mut encoder);
    ground.encode_shadows(&mut encoder, &mut timer);
    ground.encode_depth(&mut encoder, &targets, &mut timer);
    ground.encode_surfaces(&mut encoder, &targets, &mut timer);
    planes.encode(&mut encoder, &targets.radiance_view, &mut timer);
    queue.submit([encoder.finish()]);

    let image = read_image(device, queue, &targets.radiance).ok_or("the device was lost")?;
    image.write_png("minimal.png".as_ref(), image.auto_exposure())?;
    println!("minimal.png, drawn by {}", context.adapter);
    Ok(())
}
