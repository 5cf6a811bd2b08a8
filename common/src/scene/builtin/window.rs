//! A room with one tall window, through which a light throws a picture of stained glass: the scene
//! of Chen, Li and Wang 2006, Figure 4.
//!
//! x is across (the window at −x), z along the room (the camera at +z), y up. The parts are closed solids
//! that end inside each other or stay apart.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

use super::props::{smooth, turned, vessel};
use super::solids::{across_x, circle, cuboid, curve, extrude, lathe, merged, moved};
use super::stained_glass::{LANCETS, PANEL, ROSE, SILL, pointed, projector};
use super::tessellate::{Fineness, Part, objects};
use super::{MAX_TRIANGLES, MIN_TRIANGLES, matte};
use crate::scene::animation::{Motion, Target, Track, Value};
use crate::scene::{Material, Mesh, Scene};
use crate::{Camera, Lobe, Medium, Phase};

/// Triangles of the scene where nobody asks for a number.
pub const DEFAULT_TRIANGLES: u32 = 4_000;

/// Texels on a side of the light map where nobody asks for a number.
const MAP_SIZE: u32 = 256;

/// Half the window's width and the height where its arch springs \[m\].
const HALF: f32 = 1.3;
const SPRING: f32 = 3.3;
/// Where the window is along the room \[m\].
pub(super) const WINDOW_Z: f32 = -1.2;
/// Middle plane of the window's tracery \[m\].
pub(super) const TRACERY_X: f32 = -4.16;

/// A room of about `triangles` triangles (brought into [`MIN_TRIANGLES`] to [`MAX_TRIANGLES`]) with a
/// traceried window, through which a spot light with a light map of 256² texels throws coloured shafts
/// across the view. The light and the camera sway.
pub fn window(triangles: u32) -> Scene {
    window_with_map(triangles, MAP_SIZE)
}

/// The same with a light map of `map_size` texels on a side (see
/// [`stained_glass`](super::stained_glass())).
pub fn window_with_map(triangles: u32, map_size: u32) -> Scene {
    let triangles = triangles.clamp(MIN_TRIANGLES, MAX_TRIANGLES);
    let sway = |target, amplitude, period| Track {
        target,
        motion: Motion::Oscillate { amplitude: Value::Vector(amplitude), period },
    };
    Scene {
        objects: objects(triangles, parts),
        materials: materials(),
        lights: vec![projector(
            Vec3::new(TRACERY_X, 3.417, WINDOW_Z),
            Vec3::new(0.883, -0.469, 0.0),
            [16.0, 2.083 * HALF],
            Vec3::new(40_000.0, 38_000.0, 34_000.0),
            map_size,
        )],
        medium: Medium::grey(0.07, 0.95, haze()),
        camera: Camera {
            eye: Vec3::new(-0.45, 1.75, 4.4),
            target: Vec3::new(-0.85, 2.0, -1.2),
            up: Vec3::Y,
            fov_y: 1.05,
        },
        animation: vec![
            sway(Target::LightPosition { light: 0 }, Vec3::new(0.0, 0.0, 0.15), 7.0),
            sway(Target::CameraEye, Vec3::new(0.35, 0.1, 0.25), 12.0),
        ],
        ..Scene::empty("window")
    }
}

/// Air and haze: Rayleigh's phase function and Mie's for a hazy atmosphere, each weighted by its
/// scattering coefficient in every colour.
pub(super) fn haze() -> Phase {
    Phase::mixture(vec![
        (Vec3::new(5.8, 13.5, 33.1), Lobe::Rayleigh),
        (Vec3::new(20.0, 20.0, 20.0), Lobe::MieHazy),
    ])
}

const STONE: u32 = 0;
const FLOOR: u32 = 1;
const PLASTER: u32 = 2;
const WOOD: u32 = 3;
const IRON: u32 = 4;
const CLAY: u32 = 5;

fn materials() -> Vec<Material> {
    vec![
        matte("stone", Vec3::new(0.40, 0.38, 0.34)),
        matte("floor", Vec3::new(0.32, 0.30, 0.28)),
        matte("plaster", Vec3::new(0.42, 0.40, 0.37)),
        matte("wood", Vec3::new(0.40, 0.27, 0.17)),
        matte("iron", Vec3::new(0.09, 0.09, 0.10)),
        matte("clay", Vec3::new(0.58, 0.40, 0.30)),
    ]
}

fn point(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

fn parts(fineness: Fineness) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    let floor = cuboid(Vec3::new(-4.9, -0.4, -6.2), Vec3::new(2.9, 0.0, 6.2));
    let ceiling = cuboid(Vec3::new(-4.8, 6.5, -6.1), Vec3::new(2.8, 6.9, 6.1));
    let end = |z: f32| cuboid(Vec3::new(-4.25, -0.25, z - 0.2), Vec3::new(2.25, 6.75, z + 0.2));
    let beam = |z: f32| cuboid(Vec3::new(-4.1, 6.12, z - 0.14), Vec3::new(2.1, 6.6, z + 0.14));
    let sill = SPRING + HALF * SILL;
    vec![
        part("floor", FLOOR, floor),
        part("ceiling", PLASTER, ceiling),
        part("window wall", PLASTER, window_wall(fineness)),
        part("side wall", PLASTER, cuboid(Vec3::new(2.0, -0.15, -5.75), Vec3::new(2.35, 6.65, 5.75))),
        part("end walls", PLASTER, merged([end(-5.7), end(5.7)])),
        part("beams", WOOD, merged([-3.9, -1.3, 1.3, 3.9].map(beam))),
        part("tracery", STONE, tracery(fineness)),
        part("saddle bars", IRON, merged(saddle_bars())),
        part(
            "sill",
            STONE,
            cuboid(
                Vec3::new(-4.2, sill - 0.13, WINDOW_Z - 1.5),
                Vec3::new(-3.86, sill - 0.004, WINDOW_Z + 1.5),
            ),
        ),
        part("column", STONE, moved(column(fineness), COLUMN)),
        part("plinth", STONE, block(COLUMN, 0.37, [-0.1, 0.22])),
        part("abacus", STONE, block(COLUMN, 0.36, [5.86, 6.55])),
        part(
            "benches",
            WOOD,
            merged(BENCHES.map(|[x, z, angle]| turned(bench(), angle, Vec3::new(x, 0.0, z)))),
        ),
        part("pedestal", STONE, moved(pedestal(fineness), PEDESTAL)),
        part("urn", CLAY, moved(urn(fineness), PEDESTAL + Vec3::Y * 0.98)),
    ]
}

/// A point of the window \[half widths\] on its wall: (z, y) \[m\].
pub(super) fn on_wall(p: Vec2) -> Vec2 {
    HALF * p + point(WINDOW_Z, SPRING)
}

fn window_wall(fineness: Fineness) -> Mesh {
    let outline = [point(-5.8, -0.2), point(5.8, -0.2), point(5.8, 6.7), point(-5.8, 6.7)];
    let opening = pointed([0.0, 1.0, SILL, 0.0], fineness).into_iter().map(on_wall).collect();
    across_x(extrude(&outline, &[opening], 0.3), -4.3)
}

/// A plate of stone whose edge is inside the wall, with the lancets and the rose cut out.
fn tracery(fineness: Fineness) -> Mesh {
    let outline: Vec<Vec2> =
        pointed([0.0, 1.06, SILL - 0.06, 0.0], fineness).into_iter().map(on_wall).collect();
    let mut holes: Vec<Vec<Vec2>> = LANCETS.map(|lancet| pointed(lancet, fineness)).into();
    let rim = circle(ROSE[1], fineness.segments(ROSE[1], TAU, 8));
    holes.push(rim.iter().map(|p| *p + Vec2::Y * ROSE[0]).collect());
    let holes: Vec<Vec<Vec2>> =
        holes.into_iter().map(|hole| hole.into_iter().map(on_wall).collect()).collect();
    across_x(extrude(&outline, &holes, 0.12), TRACERY_X - 0.06)
}

/// Bars across the lancets between their panels, and a cross in the rose, their ends in the stone.
fn saddle_bars() -> Vec<Mesh> {
    let bar = |low: Vec2, high: Vec2, thick: f32| {
        let (low, high) = (on_wall(low), on_wall(high));
        let shift = Vec3::new(TRACERY_X, 0.0, 0.0);
        cuboid(
            shift + Vec3::new(-thick, low.y - thick, low.x - thick),
            shift + Vec3::new(thick, high.y + thick, high.x + thick),
        )
    };
    let [middle, radius] = ROSE;
    let mut bars: Vec<Mesh> = LANCETS
        .iter()
        .flat_map(|&[x, half, sill, _]| {
            [1.0, 2.0].map(|panel| {
                let y = sill + PANEL * panel;
                bar(point(x - half, y), point(x + half, y), 0.022)
            })
        })
        .collect();
    bars.push(bar(point(-radius, middle), point(radius, middle), 0.020));
    bars.push(bar(point(0.0, middle - radius), point(0.0, middle + radius), 0.017));
    bars
}

/// A box about a place on the floor that is square seen from above.
fn block(place: Vec3, half: f32, [low, high]: [f32; 2]) -> Mesh {
    cuboid(place + Vec3::new(-half, low, -half), place + Vec3::new(half, high, half))
}

/// Where the column and the pedestal stand.
const COLUMN: Vec3 = Vec3::new(0.75, 0.0, -2.75);
const PEDESTAL: Vec3 = Vec3::new(-0.55, 0.0, -0.65);

/// A column up to the ceiling.
fn column(fineness: Fineness) -> Mesh {
    let cuts = fineness.cuts(0.5, 1);
    let mut profile = vec![point(0.33, 0.18)];
    for (control, to) in [
        ((0.40, 0.28), (0.30, 0.36)),
        ((0.25, 0.40), (0.27, 0.48)),
        ((0.27, 3.00), (0.22, 5.40)),
        ((0.27, 5.44), (0.22, 5.48)),
        ((0.23, 5.72), (0.34, 5.80)),
    ] {
        let last = profile[profile.len() - 1];
        profile.extend(curve(last, Vec2::from(control), Vec2::from(to), cuts));
    }
    profile.push(point(0.34, 5.92));
    lathe(&profile, fineness.segments(0.3, TAU, 6))
}

/// Where benches stand (x, z), and how they are turned.
const BENCHES: [[f32; 3]; 2] = [[-0.75, -2.05, 1.62], [1.15, 0.1, 0.13]];

/// A bench with a back, which is at +x.
fn bench() -> Mesh {
    let outline = [
        (-0.28, -0.05),
        (-0.20, -0.05),
        (-0.20, 0.38),
        (0.16, 0.36),
        (0.20, -0.05),
        (0.28, -0.05),
        (0.36, 0.92),
        (0.30, 0.92),
        (0.22, 0.43),
        (-0.28, 0.45),
    ]
    .map(Vec2::from);
    moved(extrude(&outline, &[], 1.7), Vec3::Z * -0.85)
}

fn pedestal(fineness: Fineness) -> Mesh {
    let line = [(0.24, 0.12), (0.17, 0.22), (0.14, 0.55), (0.17, 0.82), (0.25, 0.90), (0.25, 1.0)];
    let mut profile = vec![point(0.31, -0.05), point(0.31, 0.12)];
    profile.extend(smooth(&line, fineness.cuts(0.3, 1)));
    lathe(&profile, fineness.segments(0.25, TAU, 6))
}

fn urn(fineness: Fineness) -> Mesh {
    let outside =
        [(0.11, 0.0), (0.12, 0.05), (0.24, 0.26), (0.25, 0.40), (0.13, 0.58), (0.11, 0.66), (0.18, 0.76)];
    let inside = [(0.165, 0.765), (0.09, 0.66), (0.11, 0.57), (0.225, 0.39), (0.21, 0.26), (0.08, 0.08)];
    lathe(&vessel(&outside, &inside, fineness.cuts(0.2, 1)), fineness.segments(0.25, TAU, 6))
}
