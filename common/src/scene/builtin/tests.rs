//! What every built-in scene promises.

use glam::{DVec3, Vec3};

use super::*;
use crate::Light;
use crate::scene::Object;

mod spots;

const CHOICES: [(&str, u32); 9] = [
    ("cathedral", CATHEDRAL_TRIANGLES),
    ("amphora", AMPHORA_TRIANGLES),
    ("pen", PEN_TRIANGLES),
    ("complex", COMPLEX_TRIANGLES),
    ("complex-camera", COMPLEX_CAMERA_TRIANGLES),
    ("still-life", STILL_LIFE_TRIANGLES),
    ("window", WINDOW_TRIANGLES),
    ("hall", HALL_TRIANGLES),
    ("grating", GRATING_TRIANGLES),
];

fn all() -> impl Iterator<Item = Scene> {
    NAMES.iter().map(|(name, _)| build(name, None).expect("a name of the list"))
}

/// Distances \[in lengths of `direction`\] at which the line from `from` crosses triangles, and
/// whether it comes out of the solid there.
fn crossings(scene: &Scene, from: Vec3, direction: Vec3) -> Vec<(f64, bool)> {
    let (from, direction) = (from.as_dvec3(), direction.as_dvec3());
    let mut found = Vec::new();
    for triangle in scene.world_triangles() {
        let [a, b, c] = triangle.positions.map(|p| p.as_dvec3() - from);
        // Volumes of the three tetrahedra that the line spans with the edges.
        let volumes = [b.cross(c), c.cross(a), a.cross(b)].map(|n: DVec3| direction.dot(n));
        let all = |sign: f64| volumes.iter().all(|v| v * sign >= 0.0);
        let sum: f64 = volumes.iter().sum();
        if sum != 0.0 && (all(1.0) || all(-1.0)) {
            let at = (a * volumes[0] + b * volumes[1] + c * volumes[2]) / sum;
            let distance = at.dot(direction) / direction.length_squared();
            if distance > 0.0 {
                found.push((distance, sum > 0.0));
            }
        }
    }
    found
}

#[test]
fn every_object_is_a_closed_solid() {
    let check = |scene: &Scene| {
        for object in &scene.objects {
            let (mesh, topology) = (&object.mesh, object.mesh.topology());
            assert_eq!(mesh.validate(), Ok(()), "{} of {}", object.name, scene.name);
            assert!(topology.is_closed_manifold(), "{} of {}: {topology}", object.name, scene.name);
            assert!(mesh.signed_volume() > 0.0, "{} of {}", object.name, scene.name);
            assert!(mesh.materials.iter().all(|&material| (material as usize) < scene.materials.len()));
            assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-4));
        }
        assert!(scene.objects.len() < 100);
    };
    all().for_each(|scene| check(&scene));
    for (name, _) in CHOICES {
        for triangles in [1_000, 1_777, 5_999, 6_000, 12_000, 250_000] {
            check(&build(name, Some(triangles)).expect("in range"));
        }
    }
}

#[test]
fn triangle_counts_are_met() {
    for (name, default) in CHOICES {
        for wanted in [1_000, 1_001, 5_000, 9_999, default, 1_000_000] {
            // Unoptimised, the largest takes long.
            if wanted > 250_000 && cfg!(debug_assertions) {
                continue;
            }
            let found = build(name, Some(wanted)).expect("in range").triangle_count();
            let error = (found as f64 - f64::from(wanted)).abs() / f64::from(wanted);
            assert!(error <= 0.005, "{name}: {found} triangles for {wanted}");
        }
    }
}

#[test]
fn shape_hardly_depends_on_the_count() {
    // The furnished cathedral and the jug converge: their volumes settle.
    for (name, default) in CHOICES {
        let volume = |triangles| -> f64 {
            let scene = build(name, Some(triangles)).expect("in range");
            // The floor does not count, where there is one: it would hide the rest.
            let floor = usize::from(scene.objects.len() > 1);
            scene.objects.iter().skip(floor).map(|object| object.mesh.signed_volume()).sum()
        };
        let finest = volume(250_000);
        for (triangles, tolerance) in [(default, 0.01), (5_000, 0.1), (1_000, 0.25)] {
            let found = volume(triangles);
            assert!(
                (found - finest).abs() < tolerance * finest,
                "{name} of {triangles}: {found} m³, {finest} m³"
            );
        }
    }
}

#[test]
fn scenes_are_sound_at_all_times() {
    for scene in all() {
        assert_eq!(scene.problem(), None, "{}", scene.name);
        for track in &scene.animation {
            assert_eq!(track.problem(&scene), None, "{}", scene.name);
        }
        let start = scene.at(0.0);
        assert_eq!((start.camera, &start.lights), (scene.camera, &scene.lights), "{}", scene.name);
        for step in 0..6 {
            let now = scene.at(1.3 * step as f32);
            assert_eq!(now.problem(), None, "{}", scene.name);
            // Nothing within 5 cm of the eye, and the eye in no solid.
            let eye = now.camera.eye;
            for direction in [Vec3::new(0.31, 0.83, 0.47), Vec3::new(-0.67, 0.21, -0.71)] {
                let hits = crossings(&now, eye, direction);
                let depth: i32 = hits.iter().map(|&(_, leaves)| if leaves { 1 } else { -1 }).sum();
                assert_eq!(depth, 0, "the camera of {} is inside a solid at step {step}", scene.name);
            }
            for triangle in now.world_triangles() {
                let near = closest_point(triangle.positions, eye).distance(eye);
                assert!(near > 0.05, "{}: geometry {near} m from the eye", scene.name);
            }
        }
    }
}

fn closest_point([a, b, c]: [Vec3; 3], p: Vec3) -> Vec3 {
    let on_segment = |a: Vec3, b: Vec3| {
        let along = (p - a).dot(b - a) / (b - a).length_squared();
        a.lerp(b, along.clamp(0.0, 1.0))
    };
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let flat = p - normal * normal.dot(p - a);
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(a, b)| (b - a).cross(flat - a).dot(normal) >= 0.0);
    let mut best = [on_segment(a, b), on_segment(b, c), on_segment(c, a)];
    best.sort_by(|x, y| x.distance(p).total_cmp(&y.distance(p)));
    if inside { flat } else { best[0] }
}

#[test]
fn no_light_of_the_large_scenes_is_in_sight() {
    // A pixel that looks into a point light is singular.
    for (name, default) in CHOICES {
        for triangles in [1_000, default] {
            let scene = build(name, Some(triangles)).expect("in range");
            for step in 0..12 {
                let now = scene.at(0.9 * step as f32);
                for light in now.lights.iter().filter(|light| matches!(light, Light::Point(_))) {
                    let position = light.position().expect("a point light has one");
                    let hits = crossings(&now, now.camera.eye, position - now.camera.eye);
                    let hidden = hits.iter().any(|&(distance, _)| distance < 1.0);
                    assert!(
                        hidden || !in_picture(&now, position),
                        "{name} of {triangles} shows its light at step {step}"
                    );
                }
            }
        }
    }
}

/// Whether the camera has the point in a picture that is up to twice as wide as high, or nearly so.
fn in_picture(scene: &Scene, point: Vec3) -> bool {
    let camera = scene.camera;
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let to = point - camera.eye;
    let reach = 1.03 * (0.5 * camera.fov_y).tan() * to.dot(forward);
    reach > 0.0 && to.dot(right.cross(forward)).abs() < reach && to.dot(right).abs() < 2.0 * reach
}

/// Whether two triangles in one plane overlap by more than a hair: no edge of either has the other
/// on its outer side.
fn overlap(a: [Vec3; 3], b: [Vec3; 3], normal: Vec3) -> bool {
    let apart = |a: [Vec3; 3], b: [Vec3; 3]| {
        (0..3).any(|i| {
            let out = (a[(i + 1) % 3] - a[i]).cross(normal).normalize_or_zero();
            // `out` points away from the third corner, whichever way the triangle runs.
            let out = if out.dot(a[(i + 2) % 3] - a[i]) > 0.0 { -out } else { out };
            b.iter().all(|p| out.dot(*p - a[i]) > -1e-5)
        })
    };
    !apart(a, b) && !apart(b, a)
}

#[test]
fn no_faces_of_different_objects_coincide() {
    use std::collections::HashMap;
    let [a, b, c, d] = [Vec3::ZERO, Vec3::X, Vec3::Z, Vec3::new(1.0, 0.0, 1.0)];
    assert!(overlap([a, b, c], [b, a, d], Vec3::Y) && !overlap([a, b, c], [d, c, b], Vec3::Y));
    for (name, triangles) in
        CHOICES[2..].iter().flat_map(|(name, _)| [1_000, 6_000, 45_000].map(|n| (name, n)))
    {
        let scene = build(name, Some(triangles)).expect("in range");
        // By plane, to a thousandth in direction and a tenth of a millimetre in place.
        let mut planes: HashMap<[i32; 4], Vec<(usize, [Vec3; 3])>> = HashMap::new();
        for (index, object) in scene.objects.iter().enumerate() {
            for corners in &object.mesh.triangles {
                let at = corners.map(|v| object.mesh.positions[v as usize]);
                let normal = (at[1] - at[0]).cross(at[2] - at[0]).normalize_or_zero();
                let first = normal.to_array().into_iter().find(|x| x.abs() > 1e-3).unwrap_or(1.0);
                let normal = normal * first.signum();
                let key = (normal * 1e3).round().extend((normal.dot(at[0]) * 1e4).round());
                planes.entry(key.to_array().map(|x| x as i32)).or_default().push((index, at));
            }
        }
        for (key, faces) in planes {
            let normal = Vec3::new(key[0] as f32, key[1] as f32, key[2] as f32).normalize_or_zero();
            let several = faces.iter().any(|(index, _)| *index != faces[0].0);
            let pairs = faces.iter().enumerate().flat_map(|(i, a)| faces[..i].iter().map(move |b| (a, b)));
            for ((i, a), (j, b)) in pairs.filter(|(a, b)| several && a.0 != b.0) {
                let [i, j] = [i, j].map(|&object| &scene.objects[object].name);
                assert!(!overlap(*a, *b, normal), "{name}: {i} and {j} share a plane at {}", a[0]);
            }
        }
    }
}

#[test]
fn lights_are_in_no_solid() {
    for scene in all() {
        for step in 0..12 {
            let now = scene.at(0.9 * step as f32);
            for position in now.lights.iter().filter_map(Light::position) {
                let hits = crossings(&now, position, Vec3::new(0.31, 0.83, 0.47));
                let depth: i32 = hits.iter().map(|&(_, leaves)| if leaves { 1 } else { -1 }).sum();
                assert_eq!(depth, 0, "a light of {} is inside a solid at step {step}", scene.name);
                let near = |corners| closest_point(corners, position).distance(position);
                let nearest =
                    now.world_triangles().iter().map(|t| near(t.positions)).fold(f32::MAX, f32::min);
                assert!(nearest > 0.01, "{}: geometry {nearest} m from a light", scene.name);
            }
        }
    }
}

#[test]
fn the_walk_keeps_its_distance() {
    let scene = build("complex-camera", None).expect("built-in");
    let triangles = scene.world_triangles();
    for step in 0..80 {
        let eye = scene.at(1.0 * step as f32).camera.eye;
        let near = |corners| closest_point(corners, eye).distance(eye);
        let nearest = triangles.iter().map(|t| near(t.positions)).fold(f32::MAX, f32::min);
        assert!(nearest > 0.2, "geometry {nearest} m from the eye at {step} s");
    }
}

#[test]
fn the_pen_stays_above_the_desk_and_clear_of_the_rest() {
    let scene = build("pen", None).expect("built-in");
    let points = |object: &Object| -> Vec<Vec3> {
        object.mesh.positions.iter().map(|p| object.world_from_object.transform_point3(*p)).collect()
    };
    let (moving, still): (Vec<_>, Vec<_>) =
        (0..scene.objects.len()).partition(|&i| scene.objects[i].name == "pen");
    assert_eq!(moving.len(), 5);
    let boxes: Vec<(&str, Vec3, Vec3)> = still
        .iter()
        .map(|&i| {
            let points = points(&scene.objects[i]);
            let low = points.iter().copied().reduce(Vec3::min).expect("not empty");
            let high = points.iter().copied().reduce(Vec3::max).expect("not empty");
            (scene.objects[i].name.as_str(), low, high)
        })
        .collect();
    let (mut lowest, mut highest) = (f32::MAX, 0.0_f32);
    for step in 0..420 {
        let time = 0.1 * step as f32;
        let now = scene.at(time);
        for point in moving.iter().flat_map(|&i| points(&now.objects[i])) {
            (lowest, highest) = (lowest.min(point.y), highest.max(point.y));
            for (name, low, high) in &boxes {
                let outside = point.cmplt(*low) | point.cmpgt(*high);
                assert!(outside.any(), "the pen is in the {name} at {time} s");
            }
        }
    }
    assert!(lowest > 0.001 && lowest < 0.01, "{lowest} m above the desk");
    assert!(highest > 0.15, "{highest} m above the desk");
}

#[test]
fn sealed_room_is_closed_and_open_room_is_not() {
    let lit = |scene: &Scene| {
        let mut lit = 0;
        for i in 0..200 {
            // Points all over the inside.
            let part = |step: f32| (0.5 + step * i as f32).fract();
            let at =
                Vec3::new(3.9 * part(0.618_03) - 1.95, 2.95 * part(0.754_88), 5.9 * part(0.569_84) - 2.95);
            for light in &scene.lights {
                let free = match light {
                    Light::Directional(sun) => crossings(scene, at, -sun.direction).is_empty(),
                    light => {
                        let to = light.position().expect("not directional") - at;
                        crossings(scene, at, to).iter().all(|&(distance, _)| distance > 1.0)
                    }
                };
                lit += u32::from(free);
            }
        }
        lit
    };
    assert_eq!(lit(&sealed_room()), 0);
    assert!(lit(&open_room()) > 100);
}

#[test]
fn knife_edge_is_where_it_says() {
    let scene = knife_edge();
    for i in 0..100 {
        let (x, z) = (1.1 + 0.05 * i as f32, -3.0 + 0.06 * i as f32);
        for (offset, lit) in [(1e-4, true), (-1e-4, false)] {
            let at = Vec3::new(x, KnifeEdge::LIGHT.y + KnifeEdge::SLOPE * x + offset, z);
            let hits = crossings(&scene, at, KnifeEdge::LIGHT - at);
            assert_eq!(hits.iter().all(|&(distance, _)| distance > 1.0), lit, "at {at}");
        }
    }
}

#[test]
fn wrong_requests_are_named() {
    let message = |name, triangles| build(name, triangles).expect_err("wrong on purpose").to_string();
    assert!(message("cathedrale", None).contains("cathedral, amphora, pen"));
    assert!(message("cathedral", Some(999)).contains("from 1000 to 1000000"));
    assert!(message("amphora", Some(1_000_001)).contains("from 1000 to 1000000"));
    assert!(message("empty", Some(5_000)).contains("no choice of triangle count"));
}

#[test]
fn cathedral_is_light_tight_but_for_its_windows() {
    use super::cathedral::{AISLE_WINDOW, AISLE_X, CLERESTORY, NAVE_X, bays};
    let mut out = 0;
    for triangles in [1_000, 6_000] {
        let scene = cathedral(triangles);
        for i in 0..600 {
            let part = |step: f32| (0.5 + step * i as f32).fract();
            let (height, length) = (0.3 + 9.0 * part(0.618_03), 27.0 * part(0.754_88) - 13.5);
            let from = Vec3::new(7.8 * part(0.569_84) - 3.9, height, length);
            let (sin, cos) = (6.3 * part(0.380_17)).sin_cos();
            let up = 2.0 * part(0.819_17) - 1.0;
            let towards = Vec3::new(cos, up, sin);
            if !crossings(&scene, from, towards).is_empty() {
                continue;
            }
            let through = |plane: f32, [half, sill, spring]: [f32; 3]| {
                let at = from + towards * ((plane * cos.signum() - from.x) / cos);
                bays().any(|z| (at.z - z).abs() < half) && at.y > sill && at.y < spring + half
            };
            let window = through(NAVE_X, CLERESTORY) || through(AISLE_X + 0.45, AISLE_WINDOW);
            assert!(window, "light from {from} gets out towards {towards} of {triangles} triangles");
            out += 1;
        }
    }
    assert!(out > 5, "only {out} rays get out at all");
}
