//! The CPU reference by itself: a cube before a lamp in fog, drawn without a GPU and without wgpu, `reference.png`.
//!
//! `cargo run --release -p common --no-default-features --features files,reference --example reference`

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use common::reference::Reference;
use common::scene::{Object, builtin::solids};
use common::{Camera, Light, Medium, Phase, PointLight, Scene, Term, Terms};
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
    let view = scene.camera.view(320, 240);

    // Which light: on surfaces, in the air, and what the air throws on surfaces.
    let terms = Terms::DIRECT.with(Term::IndirectAirlight);
    let progress = |done: f32| eprint!("\r{:3.0} %", 100.0 * done);
    let rendered = Reference::new(&scene)?.render(&view, terms, &progress, &AtomicBool::new(false))?;

    let image = rendered.total();
    image.write_png("reference.png".as_ref(), image.auto_exposure())?;
    println!("\rreference.png in {:.1} s; may be off by {:.1e}", rendered.seconds, rendered.uncertainty);
    Ok(())
}
