//! One cube, one light, fog, and the light that the fog throws on the cube: the crate by itself, 60 lines,
//! `minimal.png`.
//!
//! `cargo run --release -p biri-ss --example biri-ss-minimal`

use std::sync::Arc;

use biri_ss::{Inputs, Options, Outputs, Renderer, Surfaces};
use common::gpu::{Context, ContextOptions, Ground, PassTimer, SurfaceData, Targets, read_image};
use common::scene::{Object, builtin::solids};
use common::{Camera, Light, Medium, Phase, PointLight, Scene};
use glam::{Affine3A, Vec3};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A cube in front of a light, in fog that takes away a tenth of the light on every metre.
    let mut scene = Scene::empty("cube");
    let mesh = Arc::new(solids::cuboid(Vec3::splat(-0.5), Vec3::splat(0.5)));
    let world_from_object = Affine3A::from_rotation_y(0.6);
    scene.objects.push(Object { name: "cube".into(), mesh, world_from_object });
    let lamp = PointLight { position: Vec3::new(0.4, 0.9, -1.3), intensity: Vec3::new(12.0, 9.0, 5.0) };
    scene.lights.push(Light::Point(lamp));
    scene.medium = Medium::grey(0.1, 0.9, Phase::isotropic());
    scene.camera = Camera { eye: Vec3::new(0.0, 0.5, 4.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.9 };
    let view = scene.camera.view(640, 480);

    // Depth, normals and reflectances: what a program of your own has already. No shadow maps.
    let context = Context::new(&ContextOptions::default())?;
    let (device, queue) = (&context.device, &context.queue);
    let format = context.radiance_format();
    let targets = Targets::new(device, view.width, view.height, format);
    let data = SurfaceData::new(device, view.width, view.height);
    let mut ground = Ground::new(device, queue, &scene, format, 2)?;
    ground.prepare(device, queue, &scene, &view)?;

    // The technique: made once, prepared and encoded for every frame.
    let mut fog = Renderer::new(device, queue, &Options { target_format: format, ..Options::default() })?;
    let SurfaceData { normal, diffuse, specular } = &data;
    let inputs = Inputs {
        view: &view,
        medium: &scene.medium,
        lights: &scene.lights,
        casters: &scene.objects,
        depth: &targets.depth,
        surfaces: Some(Surfaces { normal, diffuse, specular, indirect: true }),
        ambient: Vec3::ZERO,
    };
    fog.prepare(device, queue, &inputs)?;

    let mut encoder = device.create_command_encoder(&Default::default());
    let mut timer = PassTimer::off();
    targets.encode_clear(&mut encoder);
    ground.encode_depth(&mut encoder, &targets, &mut timer);
    ground.encode_surface_data(&mut encoder, &targets, &data, &mut timer);
    // All terms into one target; they could go into three.
    let target = &targets.radiance_view;
    let outputs = Outputs { airlight: target, surfaces: Some(target), indirect: Some(target) };
    fog.encode(&mut encoder, &outputs, &mut timer);
    queue.submit([encoder.finish()]);

    let image = read_image(device, queue, &targets.radiance).ok_or("the device was lost")?;
    image.write_png("minimal.png".as_ref(), image.auto_exposure())?;
    println!("minimal.png, drawn by {}", context.adapter);
    Ok(())
}
