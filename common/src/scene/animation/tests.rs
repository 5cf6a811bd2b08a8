//! Motion starts from the base scene, comes back, and bad tracks are named.

use super::*;
use crate::scene::builtin;

fn base() -> Scene {
    builtin::sealed_room()
}

fn tracks() -> Vec<Track> {
    let scene = base();
    let orbit = |period| Motion::Orbit { centre: Vec3::ONE, axis: Vec3::Y, period };
    let sway = |amplitude| Motion::Oscillate { amplitude: Value::Vector(amplitude), period: 4.0 };
    let pulse = Motion::Oscillate { amplitude: Value::Scalar(0.5), period: 4.0 };
    let object = scene.objects[0].name.clone();
    [
        (Target::LightPosition { light: 0 }, orbit(4.0)),
        (Target::LightPosition { light: 0 }, sway(Vec3::X)),
        (Target::LightDirection { light: 1 }, orbit(-4.0)),
        (Target::LightIntensity { light: 1 }, pulse.clone()),
        (Target::ObjectTranslation { object: object.clone() }, sway(Vec3::Z)),
        (Target::ObjectTranslation { object: object.clone() }, orbit(4.0)),
        (Target::ObjectRotation { object: object.clone(), centre: Vec3::X, axis: Vec3::Z }, orbit(2.0)),
        (Target::ObjectRotation { object, centre: Vec3::X, axis: Vec3::Z }, pulse.clone()),
        (Target::CameraEye, sway(Vec3::Y)),
        (Target::CameraTarget, orbit(4.0)),
        (Target::MediumDensity, pulse),
    ]
    .map(|(target, motion)| Track { target, motion })
    .into()
}

/// Largest change of anything that a track can move.
fn distance(a: &Scene, b: &Scene) -> f32 {
    let mut largest = (a.camera.eye - b.camera.eye).length();
    largest = largest.max((a.camera.target - b.camera.target).length());
    largest = largest.max((a.medium.sigma_t() - b.medium.sigma_t()).length());
    for (a, b) in a.lights.iter().zip(&b.lights) {
        largest = largest.max((a.strength() - b.strength()).length());
        if let (Some(a), Some(b)) = (a.position(), b.position()) {
            largest = largest.max((a - b).length());
        }
        if let (Light::Directional(a), Light::Directional(b)) = (a, b) {
            largest = largest.max((a.direction - b.direction).length());
        }
    }
    for (a, b) in a.objects.iter().zip(&b.objects) {
        for point in [Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)] {
            let moved =
                a.world_from_object.transform_point3(point) - b.world_from_object.transform_point3(point);
            largest = largest.max(moved.length());
        }
    }
    largest
}

#[test]
fn tracks_start_from_the_base_move_and_come_back() {
    for track in tracks() {
        let scene = Scene { animation: vec![track.clone()], ..base() };
        assert_eq!(track.problem(&scene), None, "{track:?}");
        assert_eq!(distance(&scene.at(0.0), &scene), 0.0, "{track:?}");
        assert!(distance(&scene.at(0.7), &scene) > 0.01, "{track:?}");
        assert!(distance(&scene.at(4.0), &scene) < 1e-5, "{track:?}");
        assert!(distance(&scene.at(4000.7), &scene.at(0.7)) < 2e-3, "{track:?}");
        assert_eq!(scene.at(0.7).problem(), None, "{track:?}");
    }
}

#[test]
fn orbit_keeps_its_radius_and_goes_counter_clockwise() {
    let target = Target::CameraEye;
    let motion = Motion::Orbit { centre: Vec3::ZERO, axis: Vec3::Y, period: 4.0 };
    let mut scene = base();
    scene.camera.eye = Vec3::new(2.0, 5.0, 0.0);
    Track { target, motion }.apply(&mut scene, 1.0);
    assert!((scene.camera.eye - Vec3::new(0.0, 5.0, -2.0)).length() < 1e-5, "{}", scene.camera.eye);
}

#[test]
fn keyframes_are_linear_between_and_rest_outside() {
    let key = |time, x: f32| Key { time, value: Value::Vector(Vec3::new(x, 0.0, 9.0)) };
    let motion = Motion::Keyframes { keys: vec![key(1.0, 2.0), key(2.0, 4.0), key(4.0, 0.0)] };
    let track = Track { target: Target::CameraEye, motion };
    for (time, x) in [(0.0, 2.0), (1.0, 2.0), (1.5, 3.0), (2.0, 4.0), (3.5, 1.0), (4.0, 0.0), (9.0, 0.0)] {
        let mut scene = base();
        track.apply(&mut scene, time);
        assert_eq!(scene.camera.eye, Vec3::new(x, 0.0, 9.0), "at {time} s");
    }
}

#[test]
fn problems_are_named_and_do_no_harm() {
    let scene = base();
    let sway = Motion::Oscillate { amplitude: Value::Vector(Vec3::X), period: 1.0 };
    let pulse = Motion::Oscillate { amplitude: Value::Scalar(1.0), period: 1.0 };
    let orbit = |axis| Motion::Orbit { centre: Vec3::ZERO, axis, period: 1.0 };
    let rest = |period| Motion::Oscillate { amplitude: Value::Scalar(1.0), period };
    let keys = |times: &[f32]| Motion::Keyframes {
        keys: times.iter().map(|&time| Key { time, value: Value::Vector(Vec3::X) }).collect(),
    };
    for (target, motion, expected) in [
        (Target::LightPosition { light: 7 }, sway.clone(), "light 7"),
        (Target::LightPosition { light: 1 }, sway.clone(), "directional"),
        (Target::LightDirection { light: 0 }, sway.clone(), "point light"),
        (Target::LightIntensity { light: 0 }, sway.clone(), "where one belongs"),
        (Target::MediumDensity, orbit(Vec3::Y), "factor"),
        (Target::CameraEye, pulse, "where three belong"),
        (Target::CameraEye, orbit(Vec3::ZERO), "axis"),
        (Target::CameraEye, keys(&[]), "no keys"),
        (Target::CameraEye, keys(&[1.0, 1.0]), "rise"),
        (Target::MediumDensity, rest(0.0), "period"),
        (Target::ObjectTranslation { object: "nothing".into() }, sway, "`nothing`"),
    ] {
        let track = Track { target, motion };
        let problem = track.problem(&scene).unwrap_or_else(|| panic!("no problem with {track:?}"));
        assert!(problem.contains(expected), "{problem}");
        track.apply(&mut scene.clone(), 0.3);
    }
}

#[test]
fn tracks_survive_json() {
    let text = serde_json::to_string(&tracks()).expect("tracks are plain data");
    assert_eq!(serde_json::from_str::<Vec<Track>>(&text).expect("just written"), tracks());
    let by_hand = r#"{ "target": { "light_position": { "light": 0 } },
        "motion": { "oscillate": { "amplitude": [0, 1, 0], "period": 3 } } }"#;
    assert!(serde_json::from_str::<Track>(by_hand).is_ok());
    let camera = r#"{ "target": "camera_eye", "motion": { "orbit": { "period": 3 } } }"#;
    assert!(serde_json::from_str::<Track>(camera).is_ok());
    let typo = by_hand.replace("period", "perioud");
    assert!(serde_json::from_str::<Track>(&typo).is_err());
}
