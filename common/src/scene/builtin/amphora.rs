//! A pierced jug on a floor: light shafts from a light inside it, and the jug's shadow in the cone
//! of a spot light outside.
//!
//! The jug is one closed surface: outside, lip, inside, and through each hole a short tunnel that
//! joins the two sides. Around it run `AROUND` patches in `ROWS` rows, every other one with a hole.

use std::collections::HashMap;
use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::solids::{around, join_rings};
use super::tessellate::{Fineness, Part, objects};
use super::{MAX_TRIANGLES, MIN_TRIANGLES, matte, solids};
use crate::scene::animation::{Motion, Target, Track, Value};
use crate::scene::{Mesh, Scene};
use crate::{Camera, Light, Medium, Phase, PointLight, SpotLight};

/// Triangles of the scene where nobody asks for a number.
pub const DEFAULT_TRIANGLES: u32 = 20_000;

const AROUND: u32 = 12;
const ROWS: u32 = 4;
/// Thickness of the wall \[m\].
const WALL: f32 = 0.045;
/// Half axes of a hole over those of its patch.
const HOLE: f32 = 0.7;
/// The outside (radius, height) \[m\], bottom to top; see [`outside`].
const OUTLINE: [Vec2; 11] = [
    Vec2::new(0.25, -0.01),
    Vec2::new(0.27, 0.05),
    Vec2::new(0.15, 0.13),
    Vec2::new(0.30, 0.34),
    Vec2::new(0.48, 0.62),
    Vec2::new(0.55, 0.95),
    Vec2::new(0.44, 1.28),
    Vec2::new(0.25, 1.46),
    Vec2::new(0.165, 1.62),
    Vec2::new(0.17, 1.78),
    Vec2::new(0.24, 1.90),
];
/// Where along the outline the patches begin and end.
const BAND: [f32; 2] = [3.25, 6.35];

/// A jug of two metres with a pierced wall on a floor, of about `triangles` triangles (brought into
/// [`MIN_TRIANGLES`] to [`MAX_TRIANGLES`]). A point light inside shines through the holes and the
/// neck; a spot light shines on the jug from outside. Both sway, and the camera drifts.
pub fn amphora(triangles: u32) -> Scene {
    let triangles = triangles.clamp(MIN_TRIANGLES, MAX_TRIANGLES);
    let spot_position = Vec3::new(-0.6, 2.6, 3.4);
    let sway = |target, amplitude, period| Track {
        target,
        motion: Motion::Oscillate { amplitude: Value::Vector(amplitude), period },
    };
    Scene {
        objects: objects(triangles, parts),
        materials: vec![
            matte("clay", Vec3::new(0.60, 0.36, 0.24)),
            matte("floor", Vec3::new(0.45, 0.44, 0.42)),
        ],
        lights: vec![
            Light::Point(PointLight {
                position: Vec3::new(0.0, 0.94, 0.0),
                intensity: Vec3::new(20.0, 16.0, 11.0),
            }),
            Light::Spot(SpotLight {
                position: spot_position,
                direction: (Vec3::new(0.0, 1.0, 0.0) - spot_position).normalize(),
                up: Vec3::Y,
                intensity: Vec3::new(25.0, 32.0, 45.0),
                inner_angle: 0.22,
                outer_angle: 0.22,
                light_map: None,
            }),
        ],
        medium: Medium::grey(0.3, 0.9, Phase::isotropic()),
        camera: Camera {
            eye: Vec3::new(2.6, 1.55, 2.6),
            target: Vec3::new(0.0, 0.95, 0.0),
            up: Vec3::Y,
            fov_y: 0.75,
        },
        animation: vec![
            sway(Target::LightPosition { light: 0 }, Vec3::new(0.05, 0.03, -0.05), 4.0),
            sway(Target::LightDirection { light: 1 }, Vec3::new(0.0, 0.05, 0.08), 6.0),
            sway(Target::CameraEye, Vec3::new(0.15, 0.05, -0.15), 10.0),
        ],
        ..Scene::empty("amphora")
    }
}

fn parts(fineness: Fineness) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    let floor = solids::cuboid(Vec3::new(-3.5, -0.2, -3.5), Vec3::new(3.5, 0.0, 3.5));
    vec![
        part("floor", 1, floor),
        part("jug", 0, jug(fineness)),
        // Across the light's way to the camera's left and right.
        part("handles", 0, solids::merged([handle(fineness, 4), handle(fineness, 10)])),
    ]
}

/// Point of the outside at `t` along the outline (a Catmull-Rom spline), and its tangent.
fn outside(t: f32) -> (Vec2, Vec2) {
    let last = OUTLINE.len() - 1;
    let knot = (t as usize).min(last - 1);
    let x = t - knot as f32;
    let at = |step: usize| OUTLINE[(knot + step).saturating_sub(1).min(last)];
    let (p, q, r, s) = (at(0), at(1), at(2), at(3));
    let (linear, square, cube) = (r - p, 2.0 * p - 5.0 * q + 4.0 * r - s, 3.0 * (q - r) + s - p);
    let point = q + 0.5 * x * (linear + x * (square + x * cube));
    (point, linear + x * (2.0 * square + 3.0 * x * cube))
}

/// Point of the inside at `t` along the outline.
fn inside(t: f32) -> Vec2 {
    let (point, tangent) = outside(t);
    // Outwards is to the right of the way up.
    point + WALL * tangent.perp().normalize_or_zero()
}

/// The jug's surface while it grows.
struct Jug {
    mesh: Mesh,
    /// Cuts of a patch's side.
    cuts: u32,
    /// Vertices on the lattice that patches share: side (0 outside, 1 inside), around, up.
    lattice: HashMap<(usize, u32, u32), u32>,
}

impl Jug {
    fn sides(&self) -> u32 {
        AROUND * self.cuts
    }

    /// Point of the band at `uv`, in cuts around and up from its lower edge.
    fn band_point(&self, side: usize, uv: Vec2) -> Vec3 {
        let t = BAND[0] + (BAND[1] - BAND[0]) * uv.y / (ROWS * self.cuts) as f32;
        let point = if side == 0 { outside(t).0 } else { inside(t) };
        let (sin, cos) = (TAU * uv.x / self.sides() as f32).sin_cos();
        Vec3::new(point.x * cos, point.y, point.x * sin)
    }

    fn push(&mut self, position: Vec3) -> u32 {
        self.mesh.positions.push(position);
        self.mesh.positions.len() as u32 - 1
    }

    fn shared(&mut self, side: usize, u: u32, v: u32) -> u32 {
        let key = (side, u % self.sides(), v);
        if let Some(&vertex) = self.lattice.get(&key) {
            return vertex;
        }
        let vertex = self.push(self.band_point(side, Vec2::new(key.1 as f32, v as f32)));
        self.lattice.insert(key, vertex);
        vertex
    }

    /// A quad whose corners run counter-clockwise in (around, up).
    fn quad(&mut self, side: usize, [a, b, c, d]: [u32; 4]) {
        let faces = if side == 0 { [[a, d, c], [a, c, b]] } else { [[a, c, d], [a, b, c]] };
        self.mesh.triangles.extend(faces);
    }

    fn solid_patch(&mut self, side: usize, u: u32, v: u32) {
        let cuts = self.cuts;
        for (i, j) in (0..cuts).flat_map(|i| (0..cuts).map(move |j| (u + i, v + j))) {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let corners = corners.map(|(i, j)| self.shared(side, i, j));
            self.quad(side, corners);
        }
    }

    /// Rings of quads from the patch's border to its hole, and the hole's tunnel.
    fn pierced_patch(&mut self, u: u32, v: u32) {
        let cuts = self.cuts;
        let count = 4 * cuts;
        let rings = cuts.div_ceil(2);
        let border = move |i: u32| {
            let along = i % cuts;
            match i / cuts {
                0 => (along, 0),
                1 => (cuts, along),
                2 => (cuts - along, cuts),
                _ => (0, cuts - along),
            }
        };
        // A polygon of few sides gets the area of the ellipse that it stands for.
        let half = 0.5 * cuts as f32;
        let grown = (TAU / count as f32 / (TAU / count as f32).sin()).sqrt() * HOLE * half;
        let rims = [0, 1].map(|side| {
            let mut outer: Vec<u32> = (0..count)
                .map(|i| {
                    let (x, y) = border(i);
                    self.shared(side, u + x, v + y)
                })
                .collect();
            for ring in 1..=rings {
                let inner: Vec<u32> = (0..count)
                    .map(|i| {
                        let (x, y) = border(i);
                        let from = Vec2::new(x as f32, y as f32) - half;
                        let to = from.normalize() * grown;
                        let at = from.lerp(to, ring as f32 / rings as f32) + half;
                        self.push(self.band_point(side, at + Vec2::new(u as f32, v as f32)))
                    })
                    .collect();
                for i in 0..count as usize {
                    let next = (i + 1) % count as usize;
                    self.quad(side, [outer[i], outer[next], inner[next], inner[i]]);
                }
                outer = inner;
            }
            outer
        });
        for i in 0..count as usize {
            let next = (i + 1) % count as usize;
            let [[a, b], [d, c]] = [0, 1].map(|side| [rims[side][next], rims[side][i]]);
            self.mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }

    /// Rings of revolution through the points, from the shared ring at the lower (`v` = 0) or upper
    /// edge of the band on one side to that of the other, or to the axis.
    fn revolve(&mut self, from: Option<(usize, u32)>, points: &[Vec2], to: Option<(usize, u32)>) {
        let sides = self.sides();
        let mut rings: Vec<Vec<u32>> = Vec::new();
        let edge =
            |jug: &mut Self, (side, v): (usize, u32)| (0..sides).map(|u| jug.shared(side, u, v)).collect();
        rings.extend(from.map(|from| edge(self, from)));
        for point in points {
            let ring = if point.x == 0.0 { 1 } else { sides };
            rings.push((0..ring).map(|side| self.push(around(*point, side, sides))).collect());
        }
        rings.extend(to.map(|to| edge(self, to)));
        for pair in rings.windows(2) {
            // Joined as if the rings were numbered through, then given their own numbers.
            let (low, high) = (pair[0].len() as u32, pair[1].len() as u32);
            let mut faces = Vec::new();
            join_rings(&mut faces, (0, low), (low, high));
            let own = |v: u32| if v < low { pair[0][v as usize] } else { pair[1][(v - low) as usize] };
            self.mesh.triangles.extend(faces.iter().map(|face| face.map(own)));
        }
    }
}

fn jug(fineness: Fineness) -> Mesh {
    let cuts = fineness.cuts(0.55, 1);
    let mut jug = Jug { mesh: Mesh::default(), cuts, lattice: HashMap::new() };
    for (column, row) in (0..AROUND).flat_map(|i| (0..ROWS).map(move |j| (i, j))) {
        let (u, v) = (column * cuts, row * cuts);
        if (column + row) % 2 == 0 {
            jug.pierced_patch(u, v);
        } else {
            jug.solid_patch(0, u, v);
            jug.solid_patch(1, u, v);
        }
    }
    // `count` values of t from one to the other, neither included.
    let between = |from: f32, to: f32, count: u32| {
        (1..=count).map(move |i| from + (to - from) * i as f32 / (count + 1) as f32)
    };
    let top = (OUTLINE.len() - 1) as f32;
    let band_top = ROWS * cuts;
    // Foot, from the axis up to the band.
    let mut foot = vec![Vec2::new(0.0, OUTLINE[0].y), OUTLINE[0]];
    foot.extend(between(0.0, BAND[0], fineness.cuts(1.8, 1)).map(|t| outside(t).0));
    jug.revolve(None, &foot, Some((0, 0)));
    // Shoulder and neck, the rounded lip, and down again inside.
    let cuts = fineness.cuts(1.8, 1);
    let (from, to) = (outside(top).0, inside(top));
    let mut neck: Vec<Vec2> = between(BAND[1], top, cuts).map(|t| outside(t).0).collect();
    neck.push(from);
    let over = (from + to) * 0.5 + (to - from).perp() * -0.5;
    neck.extend((1..fineness.cuts(0.4, 1)).map(|i| {
        let t = i as f32 / fineness.cuts(0.4, 1) as f32;
        let middle = (from + to) * 0.5;
        let angle = PI * t;
        middle + (from - middle) * angle.cos() + (over - middle) * angle.sin()
    }));
    neck.push(to);
    let down: Vec<Vec2> = between(BAND[1], top, cuts).map(inside).collect();
    neck.extend(down.iter().rev());
    jug.revolve(Some((0, band_top)), &neck, Some((1, band_top)));
    // The bowl's bottom.
    let rim = inside(BAND[0]);
    let pole = Vec2::new(0.0, 0.31);
    let bowl = solids::curve(rim, Vec2::new(0.6 * rim.x, pole.y), pole, fineness.cuts(0.8, 1));
    jug.revolve(Some((1, 0)), &bowl, None);
    jug.mesh
}

/// A handle from shoulder to neck, at the border of patch `column`; its ends are inside the wall.
fn handle(fineness: Fineness, column: u32) -> Mesh {
    let angle = TAU * column as f32 / AROUND as f32;
    let (shoulder, tangent) = outside(6.75);
    let normal = -tangent.perp().normalize();
    let neck = outside(8.6).0;
    let from = shoulder - 0.5 * WALL * normal;
    let to = neck - Vec2::new(0.5 * WALL, 0.0);
    let (pull_from, pull_to) = (from + 0.42 * normal, to + Vec2::new(0.42, 0.06));
    let segments = fineness.cuts(2.6, 3);
    let path: Vec<Vec3> = (0..=segments)
        .map(|i| {
            let t = i as f32 / segments as f32;
            let (a, b, c) = (from.lerp(pull_from, t), pull_from.lerp(pull_to, t), pull_to.lerp(to, t));
            let point = a.lerp(b, t).lerp(b.lerp(c, t), t);
            Vec3::new(point.x * angle.cos(), point.y, point.x * angle.sin())
        })
        .collect();
    let across = Vec3::new(-angle.sin(), 0.0, angle.cos());
    solids::sweep(&path, &solids::circle(0.034, fineness.segments(0.034, 2.5 * TAU, 4)), across, false)
}
