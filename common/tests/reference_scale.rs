//! The reference at any scale: the same optical depths give the same picture.
#![cfg(feature = "reference")]

use std::sync::atomic::AtomicBool;

use common::image::Image;
use common::reference::Reference;
use common::terms::{Term, Terms};
use common::{Camera, Light, Medium, Phase, Scene, SpotLight};
use glam::Vec3;

/// Lengths times `s`, coefficients over `s`, intensity times `s²`; the light is in the picture.
fn airlight(s: f32) -> Image {
    let mut scene = Scene::empty("scaled");
    scene.lights = vec![Light::Spot(SpotLight {
        position: Vec3::new(0.1, 0.6, 0.0) * s,
        direction: Vec3::new(0.2, -1.0, 0.1).normalize(),
        up: Vec3::X,
        intensity: Vec3::splat(s * s),
        inner_angle: 0.2,
        outer_angle: 0.5,
        light_map: None,
    })];
    scene.medium = Medium::grey(0.3 / s, 0.9, Phase::isotropic());
    scene.camera = Camera { eye: Vec3::new(0.0, 0.3, 3.0) * s, target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.7 };
    let reference = Reference::new(&scene).expect("valid scene");
    let terms = Terms::from_iter([Term::Airlight]);
    let view = scene.camera.view(32, 24);
    let rendered = reference.render(&view, terms, &|_| {}, &AtomicBool::new(false)).expect("not cancelled");
    rendered.airlight.expect("airlight was asked for")
}

#[test]
fn scale_makes_no_difference() {
    let truth = airlight(1.0);
    for s in [1e-6, 1e-3, 1e4] {
        for (i, (a, b)) in airlight(s).pixels.iter().zip(&truth.pixels).enumerate() {
            assert!((a.x - b.x).abs() <= 1e-3 * b.x.max(1e-3), "scale {s}, pixel {i}: {a} {b}");
        }
    }
    assert!(truth.pixels.iter().any(|p| p.x > 0.01), "there is light");
}
