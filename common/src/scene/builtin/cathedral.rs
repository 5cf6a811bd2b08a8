//! A nave with side aisles, about 30 m by 19 m and 15 m high: the sun comes through the clerestory
//! on the left and throws shafts across the nave, a lamp in the right aisle shines between columns.
//!
//! x is across, z along the nave (the altar at −z), y up. The parts are closed solids that end inside
//! each other, so that light comes in through the windows only.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::solids::{across_x, arc, cuboid, extrude, merged, moved};
use super::tessellate::{Fineness, Part, objects};
use super::{MAX_TRIANGLES, MIN_TRIANGLES, furniture, matte, solids};
use crate::scene::animation::{Motion, Target, Track, Value};
use crate::scene::{Material, Mesh, Scene};
use crate::{Camera, DirectionalLight, Light, Medium, Phase, PointLight};

/// Triangles of the scene where nobody asks for a number.
pub const DEFAULT_TRIANGLES: u32 = 75_000;

/// From so many triangles on there are ribs, mullions, pews and the like.
const FURNISHED_FROM: u32 = 6_000;

pub(super) const BAYS: u32 = 5;
/// Length of a bay along the nave \[m\].
pub(super) const BAY: f32 = 5.6;
/// Half the inner length of the building \[m\].
pub(super) const HALF_LENGTH: f32 = 0.5 * BAY * BAYS as f32;
/// Middle plane of the nave's walls and columns \[m\].
pub(super) const NAVE_X: f32 = 4.5;
/// Half the thickness of the nave's walls \[m\].
pub(super) const NAVE_WALL: f32 = 0.45;
/// Inner face of the aisles' outer walls \[m\].
pub(super) const AISLE_X: f32 = 8.6;
/// Where the arcade's arches spring \[m\].
pub(super) const ARCADE_Y: f32 = 4.4;
/// Radius of the arcade's arches \[m\].
pub(super) const ARCADE_RADIUS: f32 = 2.35;
/// Where the vault springs \[m\].
pub(super) const VAULT_Y: f32 = 10.6;
/// Inner radius of the vault \[m\].
pub(super) const VAULT_RADIUS: f32 = 4.15;
/// Clerestory windows: half width, sill and spring of the arch \[m\].
pub(super) const CLERESTORY: [f32; 3] = [0.95, 8.1, 9.5];
/// Aisle windows: the same.
pub(super) const AISLE_WINDOW: [f32; 3] = [0.65, 1.9, 4.1];

/// Materials, in the order of the scene's list.
pub(super) const STONE: u32 = 0;
pub(super) const FLOOR: u32 = 1;
pub(super) const PLASTER: u32 = 2;
pub(super) const WOOD: u32 = 3;
pub(super) const MARBLE: u32 = 4;
pub(super) const IRON: u32 = 5;

/// A nave in the manner of the Šibenik cathedral of about `triangles` triangles (brought into
/// [`MIN_TRIANGLES`] to [`MAX_TRIANGLES`]), with the sun through its windows and a lamp in the
/// right aisle that a column hides from the camera. Below 6 000 triangles it is the bare
/// building, without ribs and furniture. The lamp sways and the camera drifts.
pub fn cathedral(triangles: u32) -> Scene {
    let triangles = triangles.clamp(MIN_TRIANGLES, MAX_TRIANGLES);
    let sway = |target, amplitude, period| Track {
        target,
        motion: Motion::Oscillate { amplitude: Value::Vector(amplitude), period },
    };
    Scene {
        objects: objects(triangles, |fineness| {
            let mut parts = building(fineness, triangles >= FURNISHED_FROM);
            if triangles >= FURNISHED_FROM {
                parts.extend(furniture::parts(fineness));
            }
            parts
        }),
        materials: materials(),
        lights: vec![
            Light::Directional(DirectionalLight {
                direction: Vec3::new(0.70, -0.62, -0.28).normalize(),
                irradiance: Vec3::new(20.0, 18.0, 15.0),
            }),
            Light::Point(PointLight {
                position: Vec3::new(6.55, 2.9, -0.58),
                intensity: Vec3::new(230.0, 200.0, 150.0),
            }),
        ],
        medium: Medium::grey(0.045, 0.9, Phase::isotropic()),
        camera: Camera {
            eye: Vec3::new(-1.7, 2.4, 13.0),
            target: Vec3::new(0.5, 5.0, -10.0),
            up: Vec3::Y,
            fov_y: 1.15,
        },
        animation: vec![
            sway(Target::LightPosition { light: 1 }, Vec3::new(0.15, 0.0, 0.2), 5.0),
            sway(Target::CameraEye, Vec3::new(0.3, 0.1, 0.4), 12.0),
        ],
        ..Scene::empty("cathedral")
    }
}

fn materials() -> Vec<Material> {
    let polished = |material: Material, k_s: f32, exponent: f32| Material {
        k_s: Vec3::splat(k_s),
        exponent,
        ..material
    };
    vec![
        matte("stone", Vec3::new(0.55, 0.51, 0.45)),
        polished(matte("floor", Vec3::new(0.36, 0.33, 0.30)), 0.05, 30.0),
        matte("plaster", Vec3::new(0.66, 0.62, 0.55)),
        matte("wood", Vec3::new(0.30, 0.18, 0.10)),
        polished(matte("marble", Vec3::new(0.70, 0.68, 0.65)), 0.10, 60.0),
        polished(matte("iron", Vec3::new(0.10, 0.10, 0.11)), 0.20, 20.0),
    ]
}

/// Middle of each bay along the nave \[m\].
pub(super) fn bays() -> impl Iterator<Item = f32> + Clone {
    (0..BAYS).map(|bay| (bay as f32 + 0.5) * BAY - HALF_LENGTH)
}

/// Place of each column along the nave \[m\].
pub(super) fn columns() -> impl Iterator<Item = f32> + Clone {
    (1..BAYS).map(|column| column as f32 * BAY - HALF_LENGTH)
}

/// −1 for the left of the nave, 1 for the right.
pub(super) const SIDES: [f32; 2] = [-1.0, 1.0];

fn point(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

/// Outline of a window with a round arch; of `segments` = 1 a rectangle of the same area.
fn window(middle: f32, [half, sill, spring]: [f32; 3], segments: u32) -> Vec<Vec2> {
    let mut outline = vec![point(middle - half, sill), point(middle + half, sill)];
    if segments == 1 {
        let top = spring + 0.25 * PI * half;
        outline.extend([point(middle + half, top), point(middle - half, top)]);
    } else {
        outline.extend(arc(point(middle, spring), half, 0.0, PI, segments));
    }
    outline
}

fn building(fineness: Fineness, furnished: bool) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    let end = |z: f32| {
        let half = [(AISLE_X + 1.0, -0.3), (AISLE_X + 1.0, 8.1), (5.5, 8.1), (5.5, 12.5), (0.0, 16.2)];
        let mut outline: Vec<Vec2> = half.map(|(x, y)| point(x, y)).into();
        outline.extend(half.iter().rev().skip(1).map(|&(x, y)| point(-x, y)));
        if !furnished {
            // A wall of four corners will do for a bare building.
            outline = solids::rectangle(AISLE_X + 1.0, 8.5).iter().map(|p| *p + point(0.0, 7.7)).collect();
        }
        moved(extrude(&outline, &[], 1.0), Vec3::Z * z)
    };
    let floor = cuboid(Vec3::new(-9.8, -0.5, -HALF_LENGTH - 1.2), Vec3::new(9.8, 0.0, HALF_LENGTH + 1.2));
    let mut parts = vec![
        part("floor", FLOOR, floor),
        part("end walls", PLASTER, merged([end(-HALF_LENGTH - 1.0), end(HALF_LENGTH)])),
        part("nave walls", PLASTER, merged(SIDES.map(|side| nave_wall(side, fineness)))),
        part("aisle walls", PLASTER, merged(SIDES.map(|side| aisle_wall(side, fineness)))),
        part("aisle roofs", WOOD, merged(SIDES.map(aisle_roof))),
        part("vault", PLASTER, vault(fineness)),
        part("columns", STONE, columns_of(|x, z| column(x, z, fineness, furnished))),
    ];
    let low = Vec3::new(-1.5, if furnished { 0.42 } else { -0.1 }, -HALF_LENGTH + 2.2);
    parts.push(part("altar", MARBLE, cuboid(low, Vec3::new(1.5, 1.55, -HALF_LENGTH + 3.3))));
    parts
}

/// A solid for each column, of its place (x, z) \[m\].
pub(super) fn columns_of(solid: impl Fn(f32, f32) -> Mesh) -> Mesh {
    let places = SIDES.iter().flat_map(|side| columns().map(move |z| (side * NAVE_X, z)));
    merged(places.map(|(x, z)| solid(x, z)))
}

/// The arcade and the clerestory above it: one plate with the arches cut from its lower edge.
fn nave_wall(side: f32, fineness: Fineness) -> Mesh {
    let out = HALF_LENGTH + 0.4;
    let mut outline = vec![point(out, ARCADE_Y), point(out, 11.3), point(-out, 11.3), point(-out, ARCADE_Y)];
    let segments = fineness.segments(ARCADE_RADIUS, PI, 2);
    for z in bays() {
        outline.extend(arc(point(z, ARCADE_Y), ARCADE_RADIUS, PI, 0.0, segments));
    }
    let cuts = fineness.segments(CLERESTORY[0], PI, 1);
    let windows: Vec<Vec<Vec2>> = bays().map(|z| window(z, CLERESTORY, cuts)).collect();
    across_x(extrude(&outline, &windows, 2.0 * NAVE_WALL), side * NAVE_X - NAVE_WALL)
}

fn aisle_wall(side: f32, fineness: Fineness) -> Mesh {
    let out = HALF_LENGTH + 0.5;
    let outline = [point(-out, -0.25), point(out, -0.25), point(out, 6.3), point(-out, 6.3)];
    let cuts = fineness.segments(AISLE_WINDOW[0], PI, 1);
    let windows: Vec<Vec<Vec2>> = bays().map(|z| window(z, AISLE_WINDOW, cuts)).collect();
    across_x(extrude(&outline, &windows, 0.9), if side > 0.0 { AISLE_X } else { -AISLE_X - 0.9 })
}

/// A slab that leans from the outer wall, inside which it ends, to the nave's wall.
fn aisle_roof(side: f32) -> Mesh {
    let out = HALF_LENGTH + 0.6;
    let (inner, outer) = (side * NAVE_X, side * (AISLE_X + 0.6));
    let outline = [point(inner, 7.1), point(outer, 5.6), point(outer, 6.0), point(inner, 7.5)];
    moved(extrude(&outline, &[], 2.0 * out), Vec3::Z * -out)
}

/// A barrel vault whose feet are inside the nave's walls.
fn vault(fineness: Fineness) -> Mesh {
    let out = HALF_LENGTH + 0.7;
    let segments = fineness.segments(VAULT_RADIUS, PI, 4);
    let centre = point(0.0, VAULT_Y);
    let mut outline = arc(centre, VAULT_RADIUS + 0.6, 0.0, PI, segments);
    outline.extend(arc(centre, VAULT_RADIUS, PI, 0.0, segments));
    moved(extrude(&outline, &[], 2.0 * out), Vec3::Z * -out)
}

fn column(x: f32, z: f32, fineness: Fineness, furnished: bool) -> Mesh {
    let mut profile;
    if furnished {
        let cuts = fineness.cuts(0.8, 1);
        profile = vec![point(0.66, 0.2)];
        let mut last = profile[0];
        // Base: a roll, a hollow, a smaller roll; the swelling shaft; astragal and echinus.
        for (control, to) in [
            ((0.80, 0.32), (0.66, 0.44)),
            ((0.56, 0.48), (0.58, 0.58)),
            ((0.66, 0.63), (0.56, 0.68)),
            ((0.52, 0.72), (0.51, 0.85)),
            ((0.53, 2.30), (0.44, 3.72)),
            ((0.53, 3.77), (0.45, 3.82)),
            ((0.46, 4.02), (0.74, 4.16)),
        ] {
            let to = Vec2::from(to);
            profile.extend(solids::curve(last, control.into(), to, cuts));
            last = to;
        }
        profile.push(point(0.74, 4.24));
    } else {
        profile = [(0.55, -0.1), (0.47, 3.8), (0.78, ARCADE_Y + 0.1)].map(Vec2::from).into();
    }
    moved(solids::lathe(&profile, fineness.segments(0.5, TAU, 6)), Vec3::new(x, 0.0, z))
}
