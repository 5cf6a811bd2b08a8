//! A pen that bumps about a desk in front of two lights, one behind a pawn, one above a letter
//! rack: its shadow cuts the glow of both into sheets that sweep through the fog.
//!
//! Made in centimetres: x to the right, y up from the desk, z towards the camera.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::props::{CM, ball, in_centimetres, leaned, smooth, turned};
use super::solids::{arc, circle, cuboid, curve, lathe, merged, moved, placed, sweep, torus};
use super::tessellate::{Fineness, Part, objects};
use super::{MAX_TRIANGLES, MIN_TRIANGLES, matte};
use crate::scene::animation::{Motion, Target, Track, Value};
use crate::scene::{Material, Mesh, Scene};
use crate::{Camera, Light, Medium, Phase, PointLight};

/// Triangles of the scene where nobody asks for a number.
pub const DEFAULT_TRIANGLES: u32 = 14_785;

/// From so many triangles on there are a letter rack, a notebook's rings and a pencil.
const FURNISHED_FROM: u32 = 4_000;

/// Name of all objects that make up the pen.
pub(super) const PEN: &str = "pen";
/// Where the pen's tip is in the middle of a hop \[cm\].
const TIP: Vec3 = Vec3::new(-1.5, 1.6, 0.0);
/// Height of a hop over its middle \[cm\].
const HOP: f32 = 1.3;
/// Lean of the pen in the middle of its swing, and how far it swings to both sides \[rad\].
const LEAN: [f32; 2] = [0.52, 0.62];
/// What the pen leans about: nearly the direction of view.
const LEAN_AXIS: Vec3 = Vec3::new(-0.28, 0.0, 0.96);

/// A pen that hops on its tip and tips over and back, with a pawn, an inkwell, a notebook and a letter
/// rack on a desk, of about `triangles` triangles (brought into [`MIN_TRIANGLES`] to [`MAX_TRIANGLES`]).
/// Of its two lights, a pawn hides one from the camera; the other is above the picture.
pub fn pen(triangles: u32) -> Scene {
    let triangles = triangles.clamp(MIN_TRIANGLES, MAX_TRIANGLES);
    let axis = Quat::from_axis_angle(LEAN_AXIS.normalize(), LEAN[0]) * Vec3::Y;
    let turn = |axis, motion| Track {
        target: Target::ObjectRotation { object: PEN.into(), centre: CM * TIP, axis },
        motion,
    };
    let shift = |amplitude: Vec3, period| Track {
        target: Target::ObjectTranslation { object: PEN.into() },
        motion: Motion::Oscillate { amplitude: Value::Vector(CM * amplitude), period },
    };
    Scene {
        objects: objects(triangles, |fineness| in_centimetres(parts(fineness, triangles >= FURNISHED_FROM))),
        materials: materials(),
        lights: vec![
            Light::Point(PointLight {
                position: CM * Vec3::new(-0.9, 2.85, -6.8),
                intensity: Vec3::new(0.055, 0.042, 0.026),
            }),
            Light::Point(PointLight {
                position: CM * Vec3::new(-10.3, 24.1, -12.7),
                intensity: Vec3::new(0.027, 0.037, 0.056),
            }),
        ],
        medium: Medium::grey(2.4, 0.9, Phase::isotropic()),
        camera: Camera {
            eye: CM * Vec3::new(4.0, 12.0, 46.0),
            target: CM * Vec3::new(-1.0, 6.8, 0.0),
            up: Vec3::Y,
            fov_y: 0.5,
        },
        animation: vec![
            turn(axis, Motion::Orbit { centre: Vec3::ZERO, axis: Vec3::Y, period: 7.0 }),
            turn(LEAN_AXIS, Motion::Oscillate { amplitude: Value::Scalar(LEAN[1]), period: 3.0 }),
            shift(Vec3::new(0.0, HOP, 0.0), 0.75),
            shift(Vec3::new(1.6, 0.0, 0.6), 6.0),
        ],
        ..Scene::empty("pen")
    }
}

const DESK: u32 = 0;
const WALL: u32 = 1;
const LACQUER: u32 = 2;
const METAL: u32 = 3;
const GLASS: u32 = 4;
const PAPER: u32 = 5;
const CARD: u32 = 6;
const PENCIL: u32 = 7;
const PIECE: u32 = 8;

fn materials() -> Vec<Material> {
    let polished = |material: Material, k_s: f32, exponent: f32| Material {
        k_s: Vec3::splat(k_s),
        exponent,
        ..material
    };
    vec![
        polished(matte("desk", Vec3::new(0.20, 0.12, 0.075)), 0.05, 25.0),
        matte("wall", Vec3::new(0.11, 0.105, 0.10)),
        polished(matte("lacquer", Vec3::new(0.45, 0.06, 0.05)), 0.15, 40.0),
        polished(matte("metal", Vec3::new(0.45, 0.36, 0.20)), 0.30, 30.0),
        polished(matte("glass", Vec3::new(0.05, 0.08, 0.16)), 0.20, 60.0),
        matte("paper", Vec3::new(0.72, 0.70, 0.64)),
        matte("card", Vec3::new(0.10, 0.24, 0.26)),
        matte("pencil", Vec3::new(0.65, 0.45, 0.08)),
        polished(matte("piece", Vec3::new(0.30, 0.17, 0.09)), 0.10, 40.0),
    ]
}

fn parts(fineness: Fineness, furnished: bool) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    let mut parts = vec![
        part("desk", DESK, cuboid(Vec3::new(-62.0, -4.0, -46.0), Vec3::new(62.0, 0.0, 37.0))),
        part("wall", WALL, cuboid(Vec3::new(-75.0, -31.0, -49.0), Vec3::new(75.0, 58.0, -43.0))),
        part(PEN, LACQUER, in_place(body(fineness))),
        part(PEN, LACQUER, in_place(cap(fineness))),
        part(PEN, METAL, in_place(tip(fineness))),
        part(PEN, METAL, in_place(clip(fineness))),
        part(PEN, METAL, in_place(band(fineness))),
        part("pawn", PIECE, moved(pawn(fineness), PAWN)),
        part("inkwell", GLASS, moved(inkwell(fineness), INKWELL)),
        part("lid", METAL, moved(lid(fineness), INKWELL)),
        part("covers", CARD, notebook(covers())),
        part("pages", PAPER, notebook(pages())),
    ];
    if furnished {
        parts.extend([
            part("rings", METAL, notebook(rings(fineness))),
            part("rack", DESK, rack(cuboid(Vec3::new(-6.2, -0.3, -5.0), Vec3::new(6.2, 0.9, 5.0)))),
            part("wires", METAL, rack(wires(fineness))),
            part("pencil", PENCIL, in_hand(pencil())),
            part("lead", GLASS, in_hand(lead(fineness))),
            part("marble", GLASS, moved(ball(1.1, fineness), Vec3::new(-8.3, 1.02, 9.4))),
        ]);
    }
    parts
}

fn point(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

/// From upright on the origin to where the pen is in the middle of its swing.
fn in_place(mesh: Mesh) -> Mesh {
    let turn = Quat::from_axis_angle(LEAN_AXIS.normalize(), LEAN[0]);
    // The clip is on the side that the camera sees half of.
    let stout = placed(mesh, Affine3A::from_scale(Vec3::new(1.25, 1.0, 1.25)));
    moved(placed(turned(stout, 0.6, Vec3::ZERO), Affine3A::from_quat(turn)), TIP)
}

fn body(fineness: Fineness) -> Mesh {
    let line = [(0.17, 0.85), (0.30, 1.5), (0.42, 2.3), (0.52, 3.6), (0.58, 5.5), (0.60, 7.4), (0.60, 9.3)];
    lathe(&smooth(&line, fineness.cuts(0.3, 1)), fineness.segments(0.6, TAU, 6))
}

fn tip(fineness: Fineness) -> Mesh {
    let profile = [(0.0, 0.0), (0.05, 0.06), (0.08, 0.45), (0.15, 0.75), (0.15, 1.1)].map(Vec2::from);
    lathe(&profile, fineness.segments(0.2, TAU, 4))
}

fn cap(fineness: Fineness) -> Mesh {
    let mut profile = vec![point(0.70, 8.55), point(0.72, 8.8), point(0.71, 11.0), point(0.66, 13.2)];
    profile.extend(curve(point(0.66, 13.2), point(0.62, 13.75), point(0.24, 13.8), fineness.cuts(0.8, 1)));
    profile.extend(curve(point(0.24, 13.8), point(0.44, 14.3), point(0.0, 14.35), fineness.cuts(0.8, 1)));
    lathe(&profile, fineness.segments(0.7, TAU, 6))
}

/// A roll around the cap's mouth.
fn band(fineness: Fineness) -> Mesh {
    let ring = torus(0.68, 0.11, fineness.segments(0.7, TAU, 6), fineness.segments(0.11, TAU, 3));
    moved(ring, Vec3::Y * 8.72)
}

/// A strip that starts inside the cap and runs down beside it, with a gap between.
fn clip(fineness: Fineness) -> Mesh {
    let line =
        [(0.4, 13.1), (0.95, 13.22), (1.16, 12.8), (1.13, 11.4), (1.04, 9.9), (0.95, 9.4), (1.12, 9.0)];
    let path: Vec<Vec3> = smooth(&line, fineness.cuts(0.5, 1)).iter().map(|p| p.extend(0.0)).collect();
    let section: Vec<Vec2> =
        circle(1.0, fineness.segments(0.2, TAU, 4)).iter().map(|p| point(0.19 * p.x, 0.07 * p.y)).collect();
    sweep(&path, &section, Vec3::Z, false)
}

/// Where the inkwell stands.
const INKWELL: Vec3 = Vec3::new(14.2, -0.2, -10.3);
/// Where the pawn stands: it is on the line from the camera to the light behind it.
const PAWN: Vec3 = Vec3::new(-0.7, -0.1, -4.6);

fn pawn(fineness: Fineness) -> Mesh {
    let cuts = fineness.cuts(0.9, 1);
    let mut profile = vec![point(1.9, 0.0)];
    for (control, to) in [
        ((2.1, 0.6), (1.7, 0.9)),
        ((1.5, 1.3), (1.35, 1.5)),
        ((0.65, 2.4), (0.58, 5.2)),
        ((1.25, 5.25), (0.7, 5.6)),
        ((1.3, 5.75), (1.3, 6.6)),
        ((1.3, 7.9), (0.0, 7.9)),
    ] {
        let last = profile[profile.len() - 1];
        profile.extend(curve(last, Vec2::from(control), Vec2::from(to), cuts));
    }
    // Exactly on the axis.
    let last = profile.len() - 1;
    profile[last].x = 0.0;
    let tall = lathe(&profile, fineness.segments(4.0, TAU, 6));
    placed(tall, Affine3A::from_scale(Vec3::splat(0.55)))
}

fn inkwell(fineness: Fineness) -> Mesh {
    let mut profile = vec![point(0.0, 0.0), point(2.5, 0.0)];
    let cuts = fineness.cuts(0.8, 1);
    profile.extend(curve(point(2.5, 0.0), point(2.9, 0.1), point(2.9, 0.8), cuts));
    profile.push(point(2.8, 3.6));
    profile.extend(curve(point(2.8, 3.6), point(2.8, 4.8), point(1.8, 4.9), cuts));
    profile.extend([point(1.7, 5.2), point(1.7, 6.0)]);
    lathe(&profile, fineness.segments(4.0, TAU, 8))
}

fn lid(fineness: Fineness) -> Mesh {
    let cuts = fineness.cuts(0.6, 1);
    let mut profile = vec![point(2.2, 5.4), point(2.25, 7.1)];
    profile.extend(curve(point(2.25, 7.1), point(2.2, 7.6), point(0.6, 7.7), cuts));
    profile.extend(curve(point(0.6, 7.7), point(1.3, 8.8), point(0.0, 8.9), cuts));
    lathe(&profile, fineness.segments(4.0, TAU, 8))
}

/// To where the notebook lies; made along z, its spine at x = 0.
fn notebook(mesh: Mesh) -> Mesh {
    turned(mesh, 0.38, Vec3::new(9.6, 0.0, 8.3))
}

fn covers() -> Mesh {
    let cover = |low: f32, high: f32| cuboid(Vec3::new(0.0, low, -7.5), Vec3::new(10.6, high, 7.5));
    merged([cover(-0.08, 0.16), cover(1.14, 1.3)])
}

fn pages() -> Mesh {
    cuboid(Vec3::new(0.25, 0.1, -7.2), Vec3::new(10.3, 1.2, 7.2))
}

fn rings(fineness: Fineness) -> Mesh {
    let ring = torus(0.86, 0.1, fineness.segments(0.6, TAU, 6), fineness.segments(0.04, TAU, 3));
    let upright = placed(ring, Affine3A::from_rotation_x(0.5 * PI));
    merged((0..12).map(|i| moved(upright.clone(), Vec3::new(0.28, 0.72, 1.15 * i as f32 - 6.4))))
}

/// To where the letter rack stands.
fn rack(mesh: Mesh) -> Mesh {
    turned(mesh, -0.45, Vec3::new(-11.8, 0.0, -12.6))
}

/// Arches of wire, one behind the other.
fn wires(fineness: Fineness) -> Mesh {
    let round = circle(0.2, fineness.segments(0.06, TAU, 3));
    let arch = |x: f32, half: f32, top: f32| {
        let mut line = vec![point(half, 0.4)];
        line.extend(arc(point(0.0, top - half), half, 0.0, PI, fineness.segments(half, PI, 3)));
        line.push(point(-half, 0.4));
        let path: Vec<Vec3> = line.iter().map(|p| Vec3::new(x, p.y, p.x)).collect();
        sweep(&path, &round, Vec3::X, false)
    };
    let pairs = (0..6).flat_map(|i| {
        let x = 2.1 * i as f32 - 5.3;
        [arch(x, 4.1, 10.0 - 0.5 * i as f32), arch(x, 2.0, 7.2 - 0.4 * i as f32)]
    });
    merged(pairs)
}

/// To where the pencil lies on the notebook; made upright.
fn in_hand(mesh: Mesh) -> Mesh {
    leaned(mesh, Vec3::new(-0.42, 0.0, -1.0), Vec3::new(17.6, 1.62, 12.4))
}

/// A hexagon, however fine the rest.
fn pencil() -> Mesh {
    lathe(&[(0.36, 0.0), (0.36, 10.5), (0.1, 12.1)].map(Vec2::from), 6)
}

fn lead(fineness: Fineness) -> Mesh {
    lathe(&[(0.08, 11.5), (0.08, 12.2), (0.0, 12.8)].map(Vec2::from), fineness.segments(0.08, TAU, 4))
}
