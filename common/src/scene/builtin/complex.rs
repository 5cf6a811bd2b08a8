//! A hall between two aisles, 12 m long and 5 m high, full of small things: balusters, grilles,
//! chains, a spiral stair. One light is behind a tie beam, one in a chamber behind a grille, higher
//! than the opening, so that neither is seen from below.
//!
//! x is across, z along the hall (the grille at −z), y up. The parts are closed solids that end
//! inside each other or stay apart.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Vec2, Vec3};

use super::solids::{self, across_x, arc, cuboid, curve, extrude, lathe, merged, moved, placed};
use super::tessellate::{Fineness, Part, objects};
use super::{MAX_TRIANGLES, MIN_TRIANGLES, clutter, matte};
use crate::scene::animation::{Motion, Target, Track, Value};
use crate::scene::{Material, Mesh, Scene};
use crate::{Camera, Light, Lobe, Medium, Phase, PointLight};

/// Triangles of [`complex`] where nobody asks for a number.
pub const COMPLEX_TRIANGLES: u32 = 110_014;
/// Triangles of [`complex_camera`] where nobody asks for a number.
pub const COMPLEX_CAMERA_TRIANGLES: u32 = 136_266;

/// From so many triangles on there are large things, and from so many on small ones.
const FURNISHED_FROM: [u32; 2] = [6_000, 40_000];

const BAYS: u32 = 5;
/// Length of a bay along the hall \[m\].
const BAY: f32 = 2.4;
/// Half the length of the hall \[m\].
pub(super) const HALF_LENGTH: f32 = 0.5 * BAY * BAYS as f32;
/// Middle plane of the arcades, and half their thickness \[m\].
pub(super) const ARCADE: [f32; 2] = [3.2, 0.25];
/// Where the arches spring, and their radius \[m\].
pub(super) const ARCH: [f32; 2] = [2.05, 0.98];
/// The opening to the chamber: middle, half width, sill and spring of its arch \[m\].
pub(super) const OPENING: [f32; 4] = [0.31, 1.32, 0.33, 1.76];
/// Middle plane of the wall with that opening \[m\].
pub(super) const END_Z: f32 = -HALF_LENGTH - 0.2;

/// Materials, in the order of the scenes' list.
pub(super) const STONE: u32 = 0;
const FLOOR: u32 = 1;
pub(super) const PLASTER: u32 = 2;
pub(super) const WOOD: u32 = 3;
pub(super) const BRASS: u32 = 4;
pub(super) const IRON: u32 = 5;
pub(super) const CLAY: u32 = 6;
pub(super) const GLAZE: u32 = 7;

/// The hall of about `triangles` triangles (brought into [`MIN_TRIANGLES`] to [`MAX_TRIANGLES`]) from
/// a camera at rest; the light behind the grille moves to and fro. Below 40 000 triangles the small
/// things are left out, below 6 000 all but the building.
pub fn complex(triangles: u32) -> Scene {
    let mut scene = hall(triangles, false);
    scene.name = "complex".into();
    scene.animation.push(Track {
        target: Target::LightPosition { light: 1 },
        motion: Motion::Oscillate { amplitude: Value::Vector(Vec3::new(0.6, -0.06, -0.15)), period: 8.0 },
    });
    scene
}

/// The hall with yet more things, of about `triangles` triangles (as for [`complex`]). The camera
/// walks to and fro through light and shadow, and the fog, which scatters forwards, thickens and
/// thins out.
pub fn complex_camera(triangles: u32) -> Scene {
    let mut scene = hall(triangles, true);
    scene.name = "complex-camera".into();
    scene.medium = Medium::grey(0.09, 0.9, Phase::from(Lobe::MieHazy));
    scene.camera.eye = Vec3::new(0.07, 1.78, 3.3);
    let sway = |target, amplitude, period| Track {
        target,
        motion: Motion::Oscillate { amplitude: Value::Vector(amplitude), period },
    };
    scene.animation.extend([
        sway(Target::CameraEye, Vec3::new(0.0, 0.08, 1.9), 16.0),
        sway(Target::CameraEye, Vec3::new(0.5, 0.0, 0.0), 10.0),
        sway(Target::CameraTarget, Vec3::new(0.8, 0.2, 0.0), 12.0),
        Track {
            target: Target::MediumDensity,
            motion: Motion::Oscillate { amplitude: Value::Scalar(0.5), period: 9.0 },
        },
    ]);
    scene
}

fn hall(triangles: u32, more: bool) -> Scene {
    let triangles = triangles.clamp(MIN_TRIANGLES, MAX_TRIANGLES);
    Scene {
        objects: objects(triangles, |fineness| {
            let mut parts = parts(fineness, triangles, outer_walls());
            if more && triangles >= FURNISHED_FROM[1] {
                parts.extend(clutter::more(fineness));
            }
            parts
        }),
        materials: materials(),
        lights: vec![
            Light::Point(PointLight {
                position: Vec3::new(0.73, 3.301, -2.907),
                intensity: Vec3::new(42.0, 32.0, 20.0),
            }),
            Light::Point(PointLight {
                position: Vec3::new(0.47, 3.71, -7.63),
                intensity: Vec3::new(270.0, 350.0, 480.0),
            }),
        ],
        medium: Medium::grey(0.11, 0.9, Phase::isotropic()),
        camera: Camera {
            eye: Vec3::new(0.47, 1.73, 5.31),
            target: Vec3::new(-0.35, 1.62, -3.0),
            up: Vec3::Y,
            fov_y: 0.95,
        },
        ..Scene::empty("hall")
    }
}

/// The building with the given outer walls and what fills it in a scene of so many triangles.
pub(super) fn parts(fineness: Fineness, triangles: u32, outer_walls: Mesh) -> Vec<Part> {
    let mut parts = building(fineness, triangles >= FURNISHED_FROM[0], outer_walls);
    if triangles >= FURNISHED_FROM[0] {
        parts.extend(clutter::large(fineness));
    }
    if triangles >= FURNISHED_FROM[1] {
        parts.extend(clutter::small(fineness));
    }
    parts
}

pub(super) fn materials() -> Vec<Material> {
    let polished = |material: Material, k_s: f32, exponent: f32| Material {
        k_s: Vec3::splat(k_s),
        exponent,
        ..material
    };
    vec![
        matte("stone", Vec3::new(0.48, 0.44, 0.38)),
        polished(matte("floor", Vec3::new(0.34, 0.30, 0.27)), 0.05, 30.0),
        matte("plaster", Vec3::new(0.50, 0.46, 0.40)),
        matte("wood", Vec3::new(0.32, 0.19, 0.10)),
        polished(matte("brass", Vec3::new(0.45, 0.32, 0.12)), 0.25, 40.0),
        polished(matte("iron", Vec3::new(0.09, 0.09, 0.10)), 0.15, 20.0),
        matte("clay", Vec3::new(0.50, 0.27, 0.17)),
        polished(matte("glaze", Vec3::new(0.12, 0.26, 0.34)), 0.15, 50.0),
    ]
}

/// −1 for the left of the hall, 1 for the right.
pub(super) const SIDES: [f32; 2] = [-1.0, 1.0];

/// Middle of each bay along the hall \[m\].
pub(super) fn bays() -> impl Iterator<Item = f32> + Clone {
    (0..BAYS).map(|bay| (bay as f32 + 0.5) * BAY - HALF_LENGTH)
}

/// A solid for each column, of its place (x, z) \[m\].
pub(super) fn columns_of(solid: impl Fn(f32, f32) -> Mesh) -> Mesh {
    let along = (1..BAYS).map(|column| column as f32 * BAY - HALF_LENGTH);
    let places = SIDES.iter().flat_map(|side| along.clone().map(move |z| (side * ARCADE[0], z)));
    merged(places.map(|(x, z)| solid(x, z)))
}

pub(super) fn point(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

fn building(fineness: Fineness, furnished: bool, outer_walls: Mesh) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    let end = HALF_LENGTH;
    let floor = cuboid(Vec3::new(-5.9, -0.3, -9.6), Vec3::new(5.9, 0.0, end + 0.6));
    let ceiling = cuboid(Vec3::new(-5.8, 5.0, -9.5), Vec3::new(5.8, 5.3, end + 0.5));
    vec![
        part("floor", FLOOR, floor),
        part("beam", WOOD, clutter::beam()),
        part("ceiling", PLASTER, ceiling),
        part("outer walls", PLASTER, outer_walls),
        part("arcades", PLASTER, merged(SIDES.map(|side| arcade(side, fineness)))),
        part("end wall", PLASTER, end_wall(fineness)),
        part("columns", STONE, columns_of(|x, z| column(x, z, fineness, furnished))),
    ]
}

/// A ring of four walls, made flat and set upright.
fn outer_walls() -> Mesh {
    let ring = |x: f32, back: f32, front: f32| {
        vec![point(-x, -front), point(x, -front), point(x, -back), point(-x, -back)]
    };
    let flat = extrude(&ring(5.7, -9.4, HALF_LENGTH + 0.4), &[ring(5.3, -9.0, HALF_LENGTH)], 5.3);
    let upright = Affine3A::from_rotation_x(-0.5 * PI);
    moved(placed(flat, upright), Vec3::Y * -0.15)
}

fn arcade(side: f32, fineness: Fineness) -> Mesh {
    let ([x, half], [spring, radius]) = (ARCADE, ARCH);
    let out = HALF_LENGTH + 0.2;
    let mut outline = vec![point(out, spring), point(out, 5.1), point(-out, 5.1), point(-out, spring)];
    let segments = fineness.segments(radius, PI, 2);
    for z in bays() {
        outline.extend(arc(point(z, spring), radius, PI, 0.0, segments));
    }
    across_x(extrude(&outline, &[], 2.0 * half), side * x - half)
}

fn end_wall(fineness: Fineness) -> Mesh {
    let [middle, half, sill, spring] = OPENING;
    let mut hole = vec![point(middle - half, sill), point(middle + half, sill)];
    hole.extend(arc(point(middle, spring), half, 0.0, PI, fineness.segments(half, PI, 2)));
    let outline = [point(-5.5, -0.1), point(5.5, -0.1), point(5.5, 5.2), point(-5.5, 5.2)];
    moved(extrude(&outline, &[hole], 0.4), Vec3::Z * (END_Z - 0.2))
}

fn column(x: f32, z: f32, fineness: Fineness, furnished: bool) -> Mesh {
    let mut profile;
    if furnished {
        let cuts = fineness.cuts(0.5, 1);
        profile = vec![point(0.26, 0.14)];
        for (control, to) in [
            ((0.34, 0.21), (0.25, 0.27)),
            ((0.20, 0.30), (0.22, 0.36)),
            ((0.22, 1.10), (0.175, 1.66)),
            ((0.22, 1.69), (0.18, 1.72)),
            ((0.19, 1.84), (0.29, 1.90)),
        ] {
            let last = profile[profile.len() - 1];
            profile.extend(curve(last, Vec2::from(control), Vec2::from(to), cuts));
        }
        profile.push(point(0.29, 1.96));
    } else {
        profile = [(0.22, -0.1), (0.19, 1.8), (0.29, ARCH[0] + 0.1)].map(Vec2::from).into();
    }
    moved(lathe(&profile, fineness.segments(0.25, TAU, 6)), Vec3::new(x, 0.0, z))
}

/// A box about (x, z) that is square seen from above.
pub(super) fn block(x: f32, z: f32, half: f32, [low, high]: [f32; 2]) -> Mesh {
    solids::cuboid(Vec3::new(x - half, low, z - half), Vec3::new(x + half, high, z + half))
}
