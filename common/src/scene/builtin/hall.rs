//! The hall of [`complex`](super::complex()) in the light of windows: the scene of Chen, Li and Wang
//! 2006, Figure 5. A light with a picture of stained glass shines through four windows in the left outer
//! wall and the arcade before it, and the eye is in one of the shafts and looks along the hall.

use std::f32::consts::PI;

use glam::{Affine3A, Vec2, Vec3};

use super::complex::{self, HALF_LENGTH, PLASTER, point};
use super::solids::{across_x, cuboid, extrude, merged, moved, placed};
use super::stained_glass::{pointed, projector};
use super::tessellate::{Fineness, Part, objects};
use super::window::haze;
use super::{MAX_TRIANGLES, MIN_TRIANGLES};
use crate::scene::animation::{Motion, Target, Track, Value};
use crate::scene::{Mesh, Scene};
use crate::{Camera, Medium};

/// Triangles of the scene where nobody asks for a number: as many as the paper's has.
pub const DEFAULT_TRIANGLES: u32 = 43_000;

/// Texels on a side of the light map where nobody asks for a number.
const MAP_SIZE: u32 = 256;

/// Where the light is \[m\].
const LIGHT: Vec3 = Vec3::new(-16.5, 6.2, -2.8);
/// Middle of the window wall, and half its thickness \[m\].
const WALL: [f32; 2] = [-5.5, 0.2];
/// Half a window's width, its sill and where its arch springs \[m\].
const WINDOW: [f32; 3] = [0.78, 1.0, 2.75];

/// The hall of about `triangles` triangles (brought into [`MIN_TRIANGLES`] to [`MAX_TRIANGLES`]), seen
/// from within a shaft of coloured light. Below 40 000 triangles the small things are left out, below
/// 6 000 all but the building. The light and the camera sway.
pub fn hall(triangles: u32) -> Scene {
    hall_with_map(triangles, MAP_SIZE)
}

/// The same with a light map of `map_size` texels on a side (see
/// [`stained_glass`](super::stained_glass())).
pub fn hall_with_map(triangles: u32, map_size: u32) -> Scene {
    let triangles = triangles.clamp(MIN_TRIANGLES, MAX_TRIANGLES);
    let through = Vec3::new(WALL[0], 2.35, on_wall(1.2));
    let sway = |target, amplitude, period| Track {
        target,
        motion: Motion::Oscillate { amplitude: Value::Vector(amplitude), period },
    };
    Scene {
        objects: objects(triangles, |fineness| {
            let mut parts = complex::parts(fineness, triangles, outer_walls());
            parts.push(Part { name: "window wall", material: PLASTER, mesh: window_wall(fineness) });
            parts.push(Part { name: "window bars", material: complex::IRON, mesh: merged(bars()) });
            parts
        }),
        materials: complex::materials(),
        lights: vec![projector(
            through,
            through - LIGHT,
            [through.distance(LIGHT), 5.2],
            Vec3::new(20_000.0, 19_000.0, 17_000.0),
            map_size,
        )],
        medium: Medium::grey(0.07, 0.95, haze()),
        camera: Camera {
            eye: Vec3::new(0.1, 1.45, 4.1),
            target: Vec3::new(-0.4, 1.5, -3.0),
            up: Vec3::Y,
            fov_y: 0.95,
        },
        animation: vec![
            sway(Target::LightPosition { light: 0 }, Vec3::new(0.0, 0.1, 0.2), 7.0),
            sway(Target::CameraEye, Vec3::new(0.15, 0.08, 0.2), 12.0),
        ],
        ..Scene::empty("hall")
    }
}

/// Middles of the windows on their wall: as the light sees them, in the middles of arches \[m\].
fn windows() -> impl Iterator<Item = f32> {
    complex::bays().skip(1).map(on_wall)
}

/// Where light to the point `z` of the arcade passes the window wall \[m\].
fn on_wall(z: f32) -> f32 {
    LIGHT.z + (WALL[0] - LIGHT.x) / (-complex::ARCADE[0] - LIGHT.x) * (z - LIGHT.z)
}

fn window_wall(fineness: Fineness) -> Mesh {
    let [half, sill, spring] = WINDOW;
    let rectangle = [point(-9.2, -0.12), point(6.2, -0.12), point(6.2, 5.12), point(-9.2, 5.12)];
    let openings: Vec<Vec<Vec2>> = windows().map(|z| pointed([z, half, sill, spring], fineness)).collect();
    across_x(extrude(&rectangle, &openings, 2.0 * WALL[1]), WALL[0] - WALL[1])
}

/// A mullion and two cross bars in each window.
fn bars() -> impl Iterator<Item = Mesh> {
    let [half, sill, spring] = WINDOW;
    let apex = spring + 3.0_f32.sqrt() * half;
    let bar = move |z: f32, [low, high]: [Vec2; 2], thick: f32| {
        let shift = Vec3::new(WALL[0], 0.0, z);
        cuboid(shift + Vec3::new(-thick, low.y, low.x), shift + Vec3::new(thick, high.y, high.x))
    };
    windows().flat_map(move |z| {
        let across = |y: f32| [point(-half - 0.05, y - 0.02), point(half + 0.05, y + 0.02)];
        [
            bar(z, [point(-0.04, sill - 0.06), point(0.04, apex + 0.06)], 0.05),
            bar(z, across(sill + 0.85), 0.02),
            bar(z, across(spring), 0.021),
        ]
    })
}

/// The other three outer walls, made flat and set upright.
fn outer_walls() -> Mesh {
    let (back, front) = (-9.4, HALF_LENGTH + 0.4);
    let outline = [
        point(-5.4, -front),
        point(5.7, -front),
        point(5.7, -back),
        point(-5.4, -back),
        point(-5.4, 9.0),
        point(5.3, 9.0),
        point(5.3, -HALF_LENGTH),
        point(-5.4, -HALF_LENGTH),
    ];
    let flat = extrude(&outline, &[], 5.3);
    moved(placed(flat, Affine3A::from_rotation_x(-0.5 * PI)), Vec3::Y * -0.15)
}
