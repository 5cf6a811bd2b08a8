use common::gpu::bench::context;
use common::image::Image;
use common::scene::builtin;
use common::{Light, PointLight};
use glam::Vec3;

use super::*;
use crate::measure::{Drawn, Stage};
use crate::techniques::{find_one, settings};

const SIZE: (u32, u32) = (48, 40);
const SIDE: u32 = 256;

/// A lamp behind a slab and one above it.
fn two_lamps() -> Scene {
    let mut scene = builtin::knife_edge();
    let Light::Point(lamp) = scene.lights[0].clone() else { panic!("a lamp") };
    let position = lamp.position + Vec3::new(2.0, 2.3, -1.0);
    scene.lights.push(Light::Point(PointLight { position, ..lamp }));
    scene
}

/// The scene with one of its lights.
fn alone(index: usize) -> Scene {
    let scene = two_lamps();
    Scene { lights: vec![scene.lights[index].clone()], ..scene }
}

/// The airlight that a method draws of a model, and the names of its passes.
fn drawn(scene: &Scene, method: &Method, model: &Model) -> (Image, Vec<&'static str>) {
    let mut stage = Stage::new(context(), scene, SIZE, SIDE).unwrap();
    let (device, queue) = (&context().device, &context().queue);
    let lights = (model, scene.lights.len());
    let mut technique = method.make_reduced(device, queue, stage.format(), SIZE, lights).unwrap();
    stage.picture(None, 0.0, Drawn::Airlight).unwrap();
    let (image, passes) = stage.airlight_again(technique.as_mut(), 0.0).unwrap();
    (image, passes.into_keys().collect())
}

fn model(lights: [Shaft; 2]) -> Model {
    Model { lights: lights.into(), ..Model::default() }
}

#[test]
fn a_light_that_is_off_is_as_if_it_were_not_there() {
    for name in ["lit-intervals", "biri-ss", "chen-planes-8x4", "ray-march-16", "froxels-8x64"] {
        let method = find_one(name).unwrap();
        let off = drawn(&two_lamps(), &method, &model([Shaft::Shadowed, Shaft::Off]));
        let other = drawn(&alone(0), &method, &Model::default());
        assert_eq!(off.1, other.1, "{name}");
        let error = common::metrics::compare(&off.0, &other.0).unwrap();
        // The map of a scene is laid out by all of its lights: nothing else may differ, and here nothing does.
        assert!(error.rel_rmse < 1e-6 && error.energy_ratio > 0.999_999, "{name}: {error:?}");
        let (black, passes) = drawn(&two_lamps(), &method, &model([Shaft::Off; 2]));
        assert!(
            passes.is_empty() && black.pixels.iter().all(|pixel| *pixel == Vec3::ZERO),
            "{name}: {passes:?}"
        );
    }
}

#[test]
fn a_light_without_shadows_is_drawn_by_the_pass_for_such_lights() {
    let method = find_one("lit-intervals").unwrap();
    let floor = find_one("unshadowed").unwrap();
    let (both, passes) = drawn(&two_lamps(), &method, &model([Shaft::Shadowed, Shaft::Unshadowed]));
    let first = drawn(&alone(0), &method, &Model::default()).0;
    let second = drawn(&alone(1), &floor, &Model::default()).0;
    let error = common::metrics::compare(&both, &first.plus(&second)).unwrap();
    assert!(error.rel_rmse < 1e-5, "{error:?}");
    assert!(passes.contains(&Unshadowed::PASSES[0]), "{passes:?}");
    // Without one that has shadows, the other technique has nothing to do.
    let (_, passes) = drawn(&two_lamps(), &method, &model([Shaft::Unshadowed; 2]));
    assert_eq!(passes, Unshadowed::PASSES);
}

#[test]
fn settings_from_a_file_draw_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("settings.json");
    for name in ["lit-intervals@256", "biri-ss-paper@256", "chen-planes-paper-7@256", "ray-march-24@256"] {
        let method = find_one(name).unwrap();
        let model = model([Shaft::Unshadowed, Shaft::Shadowed]);
        let text = serde_json::to_string(&settings::Settings::of(&method, &model)).unwrap();
        std::fs::write(&path, text).unwrap();
        let (read, as_read) = settings::read(&path).unwrap();
        assert_eq!(drawn(&two_lamps(), &read, &as_read), drawn(&two_lamps(), &method, &model), "{name}");
    }
}

#[test]
fn what_a_model_can_not_be_drawn_of_is_refused() {
    let (device, queue) = (&context().device, &context().queue);
    let refused = |name: &str, model: &Model| {
        let method = find_one(name).unwrap();
        let format = context().radiance_format();
        method.make_reduced(device, queue, format, SIZE, (model, 1)).err().expect("a refusal")
    };
    assert!(refused("lit-intervals", &model([Shaft::Off; 2])).contains("2 lights, and the scene has 1"));
    let unshadowed = Model { lights: vec![Shaft::Unshadowed], ..Model::default() };
    assert!(refused("szk-network", &unshadowed).contains("a cloud shadows itself"));
}
