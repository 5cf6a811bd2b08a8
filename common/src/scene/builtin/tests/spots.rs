//! What the scenes with light through stained glass promise.

use glam::{Vec2, Vec3};

use super::*;

/// The intensity \[W/sr\] of the scene's spot light towards a point, 0 in shadow.
fn spot_towards(scene: &Scene, at: Vec3) -> Vec3 {
    let [Light::Spot(spot)] = &scene.lights[..] else { panic!("{} has one spot light", scene.name) };
    let to = spot.position - at;
    let free = crossings(scene, at, to).iter().all(|&(distance, _)| distance > 1.0);
    if free { spot.intensity_towards(-to.normalize()) } else { Vec3::ZERO }
}

#[test]
fn the_window_is_well_inside_the_cone_and_throws_its_picture_into_the_room() {
    use crate::scene::builtin::stained_glass::{LANCETS, ROSE};
    use crate::scene::builtin::window::{TRACERY_X, WINDOW_Z, on_wall};
    let scene = window(1_000);
    let [Light::Spot(spot)] = &scene.lights[..] else { panic!("one spot light") };
    for step in 0..8 {
        let now = scene.at(0.9 * step as f32);
        let [Light::Spot(spot)] = &now.lights[..] else { panic!("one spot light") };
        for corner in [Vec2::new(-1.0, -1.55), Vec2::new(1.0, -1.55), Vec2::new(0.0, 1.732)] {
            let at = on_wall(corner);
            let to = (Vec3::new(TRACERY_X, at.y, at.x) - spot.position).normalize();
            let angle = to.angle_between(spot.direction);
            assert!(angle < spot.inner_angle, "{corner} is {angle} from the axis at step {step}");
        }
        assert_eq!(spot_towards(&now, now.camera.eye), Vec3::ZERO, "the eye is in a shaft at step {step}");
    }
    // Behind each opening, beside its bars, there is a shaft that goes on into the room.
    let openings = LANCETS.map(|[x, ..]| Vec2::new(x - 0.2, -0.75));
    for opening in openings.into_iter().chain([Vec2::new(0.15, ROSE[0] + 0.2)]) {
        let at = on_wall(opening);
        let glass = Vec3::new(TRACERY_X, at.y, at.x);
        let beyond = glass + 2.0 * (glass - spot.position).normalize();
        assert!(beyond.x > -2.6 && (beyond.z - WINDOW_Z).abs() < 2.0);
        assert!(spot_towards(&scene, beyond).max_element() > 0.0, "no light at {beyond}");
    }
    // Between the lancets there is none.
    let mullion = on_wall(Vec2::new(0.0, -0.6));
    let stone = Vec3::new(TRACERY_X, mullion.y, mullion.x);
    let behind = stone + 1.5 * (stone - spot.position).normalize();
    assert_eq!(spot_towards(&scene, behind), Vec3::ZERO);
}

#[test]
fn the_light_map_of_the_window_is_as_large_as_wanted() {
    for size in [64, 128, 256] {
        let scene = window_with_map(1_000, size);
        let [Light::Spot(spot)] = &scene.lights[..] else { panic!("one spot light") };
        let map = spot.light_map.as_ref().expect("it carries one");
        assert_eq!((map.width, map.height), (size, size));
    }
    assert_eq!(window(1_000).lights, window_with_map(1_000, 256).lights);
}

#[test]
fn the_eye_of_the_hall_is_in_a_shaft_and_looks_along_it() {
    for triangles in [1_000, HALL_TRIANGLES] {
        let scene = hall(triangles);
        let mut lit = 0;
        for step in 0..24 {
            let now = scene.at(0.5 * step as f32);
            lit += u32::from(spot_towards(&now, now.camera.eye).max_element() > 0.0);
        }
        assert!(lit > 12, "the eye is in the light at {lit} of 24 times");
        let eye = scene.camera.eye;
        let forward = (scene.camera.target - eye).normalize();
        let part = (0..80).filter(|i| {
            let at = eye + forward * (0.1 * *i as f32 + 0.05);
            spot_towards(&scene, at).max_element() > 0.0
        });
        let part = part.count();
        assert!((8..80).contains(&part), "{part} tenths of a metre of the way ahead are lit");
    }
}
