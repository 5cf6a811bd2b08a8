//! A jug, a vase with dry poppies and some fruit on a table in fog, lit by one light from behind.
//!
//! Made in centimetres: x to the right, y up from the table, z towards the camera.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Vec2, Vec3};

use super::props::{CM, in_centimetres, leaned, rod, smooth, turned, vessel};
use super::solids::{circle, cuboid, lathe, merged, moved, placed, sweep};
use super::tessellate::{Fineness, Part, objects};
use super::{MAX_TRIANGLES, MIN_TRIANGLES, matte};
use crate::scene::animation::{Motion, Target, Track, Value};
use crate::scene::{Material, Mesh, Scene};
use crate::{Camera, Light, Medium, Phase, PointLight};

/// Triangles of the scene where nobody asks for a number.
pub const DEFAULT_TRIANGLES: u32 = 12_000;

/// From so many triangles on there are stalks in the vase and on the fruit.
const FURNISHED_FROM: u32 = 4_000;

/// A matte jug, a glossy vase with stalks in it and fruit, of about `triangles` triangles (brought into
/// [`MIN_TRIANGLES`] to [`MAX_TRIANGLES`]); below 4 000 without the stalks. The light is above the picture, on the left behind the
/// vase, so that the stalks' shadows come towards the camera; it sways.
pub fn still_life(triangles: u32) -> Scene {
    let triangles = triangles.clamp(MIN_TRIANGLES, MAX_TRIANGLES);
    Scene {
        objects: objects(triangles, |fineness| in_centimetres(parts(fineness, triangles >= FURNISHED_FROM))),
        materials: materials(),
        lights: vec![Light::Point(PointLight {
            position: CM * Vec3::new(-25.3, 43.1, -10.7),
            intensity: Vec3::new(0.42, 0.35, 0.26),
        })],
        medium: Medium::grey(1.3, 0.9, Phase::isotropic()),
        camera: Camera {
            eye: CM * Vec3::new(5.0, 27.0, 92.0),
            target: CM * Vec3::new(0.7, 15.0, 0.0),
            up: Vec3::Y,
            fov_y: 0.5,
        },
        animation: vec![Track {
            target: Target::LightPosition { light: 0 },
            motion: Motion::Oscillate {
                amplitude: Value::Vector(CM * Vec3::new(3.0, 0.0, 2.0)),
                period: 6.0,
            },
        }],
        ..Scene::empty("still-life")
    }
}

const TABLE: u32 = 0;
const WALL: u32 = 1;
const CLAY: u32 = 2;
const GLAZE: u32 = 3;
const STALK: u32 = 4;
const POD: u32 = 5;
const APPLE: u32 = 6;
const PEAR: u32 = 7;

fn materials() -> Vec<Material> {
    let polished = |material: Material, k_s: f32, exponent: f32| Material {
        k_s: Vec3::splat(k_s),
        exponent,
        ..material
    };
    vec![
        matte("table", Vec3::new(0.27, 0.17, 0.10)),
        matte("wall", Vec3::new(0.30, 0.29, 0.27)),
        matte("clay", Vec3::new(0.58, 0.33, 0.21)),
        polished(matte("glaze", Vec3::new(0.07, 0.17, 0.32)), 0.25, 45.0),
        matte("stalk", Vec3::new(0.26, 0.27, 0.11)),
        matte("pod", Vec3::new(0.42, 0.34, 0.20)),
        polished(matte("apple", Vec3::new(0.52, 0.07, 0.05)), 0.06, 20.0),
        polished(matte("pear", Vec3::new(0.48, 0.44, 0.10)), 0.04, 15.0),
    ]
}

/// Where jug and vase stand.
const JUG: Vec3 = Vec3::new(9.3, -0.2, -2.1);
const VASE: Vec3 = Vec3::new(-8.7, -0.2, -6.3);

fn parts(fineness: Fineness, furnished: bool) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    let mut parts = vec![
        part("table", TABLE, cuboid(Vec3::new(-58.0, -3.0, -34.0), Vec3::new(58.0, 0.0, 29.0))),
        part("wall", WALL, cuboid(Vec3::new(-80.0, -41.0, -40.0), Vec3::new(80.0, 75.0, -32.0))),
        part("jug", CLAY, turned(jug(fineness), -0.25, JUG)),
        part("handle", CLAY, turned(handle(fineness), -0.25, JUG)),
        part("vase", GLAZE, moved(vase(fineness), VASE)),
        part("apples", APPLE, at_apples(&apple(fineness))),
        part("pear", PEAR, moved(pear(fineness), PEAR_PLACE)),
    ];
    if furnished {
        parts.extend([
            part("stalks", STALK, moved(merged(STALKS.map(|stalk| stem(stalk, fineness))), VASE)),
            part("pods", POD, moved(merged(STALKS.map(|stalk| pod(stalk, fineness))), VASE)),
            part("apple stalks", STALK, at_apples(&fruit_stalk(5.4, 7.4, fineness))),
            part("pear stalk", STALK, moved(fruit_stalk(9.2, 11.2, fineness), PEAR_PLACE)),
        ]);
    }
    parts
}

fn jug(fineness: Fineness) -> Mesh {
    let outside =
        [(5.2, 0.0), (5.6, 0.7), (8.0, 5.0), (8.6, 9.5), (6.8, 15.0), (4.6, 18.5), (4.4, 21.0), (5.5, 23.5)];
    let inside = [(5.1, 23.6), (3.9, 21.0), (4.1, 18.4), (6.2, 14.8), (8.0, 9.4), (7.4, 5.0), (4.5, 1.2)];
    let profile = vessel(&outside, &inside, fineness.cuts(0.8, 1));
    let mut mesh = lathe(&profile, fineness.segments(5.0, TAU, 8));
    // The lip is pulled out to a spout on the left.
    for p in &mut mesh.positions {
        let out = Vec2::new(p.x, p.z);
        let angle = Vec2::NEG_X.angle_to(out.normalize_or(Vec2::X));
        let pull = ((p.y - 16.5) / 7.0).clamp(0.0, 1.0).powi(2) * (-(angle / 0.42).powi(2)).exp();
        p.x -= 2.8 * pull;
        p.z *= 1.0 - 0.25 * pull;
        p.y += 0.9 * pull;
    }
    mesh
}

fn handle(fineness: Fineness) -> Mesh {
    let line = [(4.25, 20.8), (6.4, 22.2), (9.6, 21.9), (11.7, 18.6), (11.6, 14.2), (9.8, 10.6), (8.3, 8.9)];
    let path: Vec<Vec3> = smooth(&line, fineness.cuts(0.8, 1)).iter().map(|p| p.extend(0.0)).collect();
    let section: Vec<Vec2> =
        circle(1.0, fineness.segments(0.4, TAU, 5)).iter().map(|p| Vec2::new(1.0 * p.x, 0.5 * p.y)).collect();
    sweep(&path, &section, Vec3::Z, false)
}

fn vase(fineness: Fineness) -> Mesh {
    let outside =
        [(4.0, 0.0), (4.4, 0.7), (6.6, 6.0), (6.9, 10.0), (4.4, 16.0), (2.4, 19.5), (2.2, 22.0), (3.4, 24.5)];
    let inside = [(3.1, 24.6), (1.75, 22.0), (1.95, 19.4), (3.9, 15.8), (6.4, 9.9), (6.0, 6.0), (3.2, 1.1)];
    lathe(&vessel(&outside, &inside, fineness.cuts(0.8, 1)), fineness.segments(3.5, TAU, 8))
}

/// Stalks in the vase: where each leans to (angle about the axis, distance from it) and its height.
const STALKS: [[f32; 3]; 6] = [
    [0.3, 8.5, 33.0],
    [1.4, 5.5, 30.5],
    [2.5, 7.0, 35.5],
    [3.5, 4.5, 32.0],
    [4.4, 3.0, 36.5],
    [5.4, 6.0, 37.5],
];

/// A stalk's line, from inside the vase's bottom to the pod.
fn line([angle, reach, height]: [f32; 3], cuts: u32) -> Vec<Vec3> {
    let bend =
        [(0.8, 0.6), (1.0, 12.0), (1.1, 22.0), (0.35 * reach + 0.7, 0.45 * (height + 22.0)), (reach, height)];
    let (sin, cos) = angle.sin_cos();
    smooth(&bend, cuts).iter().map(|p| Vec3::new(p.x * cos, p.y, p.x * sin)).collect()
}

fn stem(stalk: [f32; 3], fineness: Fineness) -> Mesh {
    let across = Vec3::new(-stalk[0].sin(), 0.0, stalk[0].cos());
    let section = circle(0.19, fineness.segments(0.06, TAU, 3));
    sweep(&line(stalk, fineness.cuts(0.3, 1)), &section, across, false)
}

/// A poppy's seed pod with its crown, around the stalk's end.
fn pod(stalk: [f32; 3], fineness: Fineness) -> Mesh {
    let mut profile = vec![Vec2::new(0.0, -0.5)];
    profile.extend(smooth(
        &[(0.3, -0.4), (1.05, 0.6), (1.35, 1.5), (1.0, 2.35), (0.75, 2.6), (1.25, 2.75)],
        fineness.cuts(0.2, 1),
    ));
    profile.extend([Vec2::new(1.2, 2.95), Vec2::new(0.0, 3.1)]);
    let path = line(stalk, 4);
    let (end, before) = (path[path.len() - 1], path[path.len() - 2]);
    leaned(lathe(&profile, fineness.segments(0.8, TAU, 5)), end - before, end)
}

/// Where apples lie (x, z), how they are turned and how large they are.
const APPLES: [[f32; 4]; 3] = [[-4.3, 8.2, 0.4, 1.0], [2.9, 11.1, 2.1, 0.92], [-0.7, 2.6, 1.2, 1.04]];

fn at_apples(mesh: &Mesh) -> Mesh {
    merged(APPLES.map(|[x, z, angle, size]| {
        let scaled = placed(mesh.clone(), Affine3A::from_scale(Vec3::splat(size)));
        turned(scaled, angle, Vec3::new(x, -0.35, z))
    }))
}

/// A solid of revolution whose line starts and ends on the axis.
fn spun(points: &[(f32, f32)], radius: f32, fineness: Fineness) -> Mesh {
    let mut profile = smooth(points, fineness.cuts(0.8, 1));
    let last = profile.len() - 1;
    (profile[0].x, profile[last].x) = (0.0, 0.0);
    lathe(&profile, fineness.segments(radius, TAU, 7))
}

fn apple(fineness: Fineness) -> Mesh {
    let line =
        [(0.0, 0.7), (1.3, 0.2), (2.8, 1.1), (3.6, 3.4), (3.2, 5.6), (1.8, 6.5), (0.6, 6.2), (0.0, 5.7)];
    spun(&line, 1.6, fineness)
}

const PEAR_PLACE: Vec3 = Vec3::new(-16.9, -0.35, 3.9);

fn pear(fineness: Fineness) -> Mesh {
    let line =
        [(0.0, 0.6), (1.2, 0.2), (2.9, 1.3), (3.5, 3.4), (2.7, 5.9), (1.6, 8.0), (1.1, 9.4), (0.0, 9.9)];
    spun(&line, 1.6, fineness)
}

fn fruit_stalk(low: f32, high: f32, fineness: Fineness) -> Mesh {
    rod(Vec3::Y * low, Vec3::new(0.35, high, 0.1), 0.13, fineness.segments(0.13, PI, 3))
}
