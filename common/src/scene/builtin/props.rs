//! Small solids that several scenes share, and the scale of scenes that fit on a table.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::solids::{arc, lathe, placed};
use super::tessellate::{Fineness, Part};
use crate::scene::Mesh;

/// A centimetre \[m\].
pub(super) const CM: f32 = 0.01;

/// Parts that were made in centimetres, in metres. Numbers of segments suit things of a size about
/// one, so that small scenes are made in small units.
pub(super) fn in_centimetres(parts: Vec<Part>) -> Vec<Part> {
    let shrink = Affine3A::from_scale(Vec3::splat(CM));
    parts.into_iter().map(|part| Part { mesh: placed(part.mesh, shrink), ..part }).collect()
}

/// Turned about the y axis by `angle` \[rad\], then moved.
pub(super) fn turned(mesh: Mesh, angle: f32, shift: Vec3) -> Mesh {
    placed(mesh, Affine3A::from_rotation_translation(Quat::from_rotation_y(angle), shift))
}

/// Moved so that what points up points in `direction`, and the origin comes to `to`.
pub(super) fn leaned(mesh: Mesh, direction: Vec3, to: Vec3) -> Mesh {
    let turn = Quat::from_rotation_arc(Vec3::Y, direction.normalize());
    placed(mesh, Affine3A::from_rotation_translation(turn, to))
}

/// A straight round rod.
pub(super) fn rod(from: Vec3, to: Vec3, radius: f32, sides: u32) -> Mesh {
    let profile = [Vec2::new(radius, 0.0), Vec2::new(radius, from.distance(to))];
    leaned(lathe(&profile, sides), to - from, from)
}

/// A ball about the origin.
pub(super) fn ball(radius: f32, fineness: Fineness) -> Mesh {
    let mut profile = arc(Vec2::ZERO, radius, -0.5 * PI, 0.5 * PI, fineness.segments(radius, PI, 3));
    // Exactly on the axis.
    let last = profile.len() - 1;
    (profile[0].x, profile[last].x) = (0.0, 0.0);
    lathe(&profile, fineness.segments(radius, TAU, 5))
}

/// A smooth line through the points, `cuts` to each pair of them (a Catmull-Rom spline).
pub(super) fn smooth(points: &[(f32, f32)], cuts: u32) -> Vec<Vec2> {
    let last = points.len() - 1;
    let at = |i: usize| Vec2::from(points[i.min(last)]);
    let mut line = vec![at(0)];
    for knot in 0..last {
        let (p, q, r, s) = (at(knot.saturating_sub(1)), at(knot), at(knot + 1), at(knot + 2));
        let (linear, square, cube) = (r - p, 2.0 * p - 5.0 * q + 4.0 * r - s, 3.0 * (q - r) + s - p);
        line.extend((1..=cuts).map(|i| {
            let x = i as f32 / cuts as f32;
            q + 0.5 * x * (linear + x * (square + x * cube))
        }));
    }
    line
}

/// Profile of a vessel (radius, height): up its outside, over its lip and down its inside, both
/// smooth, each closed by a flat bottom.
pub(super) fn vessel(outside: &[(f32, f32)], inside: &[(f32, f32)], cuts: u32) -> Vec<Vec2> {
    let mut profile = vec![Vec2::new(0.0, outside[0].1)];
    profile.extend(smooth(outside, cuts));
    profile.extend(smooth(inside, cuts));
    profile.push(Vec2::new(0.0, inside[inside.len() - 1].1));
    profile
}
