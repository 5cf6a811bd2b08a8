//! Closed 2-manifold building blocks: every function gives a solid whose triangles run
//! counter-clockwise seen from outside, over vertices that its triangles share, without normals.

use std::f32::consts::TAU;

use glam::{Affine3A, Mat3, Vec2, Vec3};

use super::polygon;
use crate::scene::Mesh;

/// A box between its lowest and its highest corner \[m\].
pub fn cuboid(low: Vec3, high: Vec3) -> Mesh {
    let corner = |i: u32| {
        let pick = |bit: u32, low: f32, high: f32| if i >> bit & 1 == 1 { high } else { low };
        Vec3::new(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z))
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() }
}

/// A plate: the outline in the xy-plane \[m\], minus its holes, from z = 0 to z = `depth` \[m\].
/// Outline and holes are simple polygons of either orientation; holes lie inside and apart.
pub fn extrude(outline: &[Vec2], holes: &[Vec<Vec2>], depth: f32) -> Mesh {
    let flat = polygon::triangulate(outline, holes);
    let count = flat.points.len() as u32;
    let lift = |z: f32| flat.points.iter().map(move |p| p.extend(z));
    let positions = lift(0.0).chain(lift(depth)).collect();
    let mut triangles: Vec<[u32; 3]> = flat.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    triangles.extend(flat.triangles.iter().map(|face| face.map(|v| v + count)));
    // The inside of every loop lies to its left, so its walls face to the right.
    for (a, b) in flat.loop_edges() {
        triangles.extend([[a, b, b + count], [a, b + count, a + count]]);
    }
    Mesh { positions, triangles, ..Mesh::default() }
}

/// A solid of revolution about the y axis from its profile (radius, height) \[m\]. The profile has
/// the solid to its left: bottom to top on the outside, and down again for a hollow one. Both
/// ends are closed: by a point where the radius is 0, else by a flat disc.
pub fn lathe(profile: &[Vec2], sides: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let sides = sides.max(3);
    let last = profile.len().saturating_sub(1);
    let mut previous: Option<u32> = None;
    for (index, point) in profile.iter().enumerate() {
        let start = mesh.positions.len() as u32;
        let pole = point.x == 0.0 && (index == 0 || index == last);
        let ring = if pole { 1 } else { sides };
        mesh.positions.extend((0..ring).map(|side| around(*point, side, sides)));
        if let Some(below) = previous {
            join_rings(&mut mesh.triangles, (below, start - below), (start, ring));
        } else if !pole {
            mesh.triangles.extend((1..sides - 1).map(|side| [start, start + side, start + side + 1]));
        }
        if index == last && !pole {
            mesh.triangles.extend((1..sides - 1).map(|side| [start, start + side + 1, start + side]));
        }
        previous = Some(start);
    }
    mesh
}

/// The point (radius, height) turned about the y axis to `side` of `sides`.
pub(super) fn around(point: Vec2, side: u32, sides: u32) -> Vec3 {
    let (sin, cos) = (TAU * side as f32 / sides as f32).sin_cos();
    Vec3::new(point.x * cos, point.y, point.x * sin)
}

/// Joins two rings (first vertex, number of vertices) of a lathe, the lower one first; a ring of one
/// vertex is a pole.
pub(super) fn join_rings(triangles: &mut Vec<[u32; 3]>, low: (u32, u32), high: (u32, u32)) {
    let sides = low.1.max(high.1);
    for side in 0..sides {
        let next = (side + 1) % sides;
        let at = |ring: (u32, u32), side: u32| if ring.1 == 1 { ring.0 } else { ring.0 + side };
        let (a, b, c, d) = (at(low, side), at(low, next), at(high, next), at(high, side));
        if c != d {
            triangles.push([a, d, c]);
        }
        if a != b {
            triangles.push([a, c, b]);
        }
    }
}

/// A section (convex or star-shaped about its origin, counter-clockwise) \[m\] swept along a path
/// that lies in a plane with the normal `across`. The section's x axis lies along `across` and its y
/// axis along `path × across`. The ends are closed by flat faces, or the path closes on itself.
pub fn sweep(path: &[Vec3], section: &[Vec2], across: Vec3, closed: bool) -> Mesh {
    let (count, size) = (path.len(), section.len() as u32);
    let mut mesh = Mesh::default();
    for index in 0..count {
        let neighbour = |step: isize| {
            let at = index as isize + step;
            let wrapped =
                if closed { at.rem_euclid(count as isize) } else { at.clamp(0, count as isize - 1) };
            path[wrapped as usize]
        };
        // At the ends of an open path this is the direction of its only leg.
        let before = (path[index] - neighbour(-1)).normalize_or_zero();
        let after = (neighbour(1) - path[index]).normalize_or_zero();
        let tangent = (before + after).normalize_or_zero();
        let up = tangent.cross(across);
        // A mitre keeps the thickness of both legs.
        let mitre = if before == Vec3::ZERO || after == Vec3::ZERO {
            1.0
        } else {
            1.0 / (0.5 * (1.0 + before.dot(after))).max(0.1).sqrt()
        };
        mesh.positions.extend(section.iter().map(|p| path[index] + across * p.x + up * (p.y * mitre)));
    }
    let legs = if closed { count } else { count.saturating_sub(1) };
    for leg in 0..legs as u32 {
        let (from, to) = (leg * size, (leg + 1) % count as u32 * size);
        for side in 0..size {
            let next = (side + 1) % size;
            let (a, b, c, d) = (from + side, from + next, to + next, to + side);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    if !closed && count > 1 {
        let end = (count as u32 - 1) * size;
        mesh.triangles.extend((1..size - 1).map(|side| [0, side + 1, side]));
        mesh.triangles.extend((1..size - 1).map(|side| [end, end + side, end + side + 1]));
    }
    mesh
}

/// A circle of `sides` points about the origin, counter-clockwise \[m\].
pub fn circle(radius: f32, sides: u32) -> Vec<Vec2> {
    (0..sides).map(|side| radius * Vec2::from_angle(TAU * side as f32 / sides as f32)).collect()
}

/// A rectangle about the origin, counter-clockwise \[m\].
pub fn rectangle(half_width: f32, half_height: f32) -> Vec<Vec2> {
    let (x, y) = (half_width, half_height);
    vec![Vec2::new(-x, -y), Vec2::new(x, -y), Vec2::new(x, y), Vec2::new(-x, y)]
}

/// A ring: a circle of radius `minor` swept around one of radius `major` in the xz-plane \[m\].
pub fn torus(major: f32, minor: f32, sides: u32, section_sides: u32) -> Mesh {
    let path: Vec<Vec3> = (0..sides).map(|side| around(Vec2::new(major, 0.0), side, sides)).collect();
    sweep(&path, &circle(minor, section_sides), Vec3::Y, true)
}

/// The points of an arc about `centre` from angle `from` to angle `to` \[rad\], both included.
pub fn arc(centre: Vec2, radius: f32, from: f32, to: f32, segments: u32) -> Vec<Vec2> {
    let angle = |i: u32| from + (to - from) * i as f32 / segments as f32;
    (0..=segments).map(|i| centre + radius * Vec2::from_angle(angle(i))).collect()
}

/// A curve from `a` to `b` that is pulled towards `control`, without its first point.
pub fn curve(a: Vec2, control: Vec2, b: Vec2, segments: u32) -> Vec<Vec2> {
    let point = |t: f32| a.lerp(control, t).lerp(control.lerp(b, t), t);
    (1..=segments).map(|i| point(i as f32 / segments as f32)).collect()
}

/// The solid at another place; a mirrored one is turned right side out again.
pub fn placed(mut mesh: Mesh, place: Affine3A) -> Mesh {
    mesh.positions.iter_mut().for_each(|p| *p = place.transform_point3(*p));
    if place.matrix3.determinant() < 0.0 {
        mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    }
    mesh
}

/// The solid moved by `shift` \[m\].
pub fn moved(mesh: Mesh, shift: Vec3) -> Mesh {
    placed(mesh, Affine3A::from_translation(shift))
}

/// Lays a plate whose outline is (z, y) of the world across the x axis, from `x` upwards \[m\].
pub(crate) fn across_x(mesh: Mesh, x: f32) -> Mesh {
    let turn = Mat3::from_cols(Vec3::Z, Vec3::Y, Vec3::X);
    placed(mesh, Affine3A::from_mat3_translation(turn, Vec3::X * x))
}

/// One mesh of several solids. They must not share a position, or welding would join them.
pub fn merged(solids: impl IntoIterator<Item = Mesh>) -> Mesh {
    let mut all = Mesh::default();
    for solid in solids {
        let offset = all.positions.len() as u32;
        all.positions.extend(solid.positions);
        all.triangles.extend(solid.triangles.iter().map(|corners| corners.map(|v| v + offset)));
    }
    all
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[track_caller]
    fn check(mesh: &Mesh, volume: f64, tolerance: f64) {
        assert_eq!(mesh.validate(), Ok(()));
        assert!(mesh.topology().is_closed_manifold(), "{}", mesh.topology());
        let found = mesh.signed_volume();
        assert!((found - volume).abs() <= tolerance * volume, "volume {found}, expected {volume}");
    }

    #[test]
    fn solids_are_closed_and_have_their_volume() {
        check(&cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)), 6.0, 1e-6);
        check(&torus(2.0, 0.5, 96, 48), 2.0 * PI * PI * 2.0 * 0.25, 0.01);
        let cylinder = [Vec2::new(0.5, 0.0), Vec2::new(0.5, 2.0)];
        check(&lathe(&cylinder, 96), PI * 0.5, 0.01);
        let cone = [Vec2::ZERO, Vec2::new(1.0, 0.0), Vec2::new(0.0, 3.0)];
        check(&lathe(&cone, 96), PI, 0.01);
        let rod = sweep(&[Vec3::ZERO, Vec3::Y, 3.0 * Vec3::Y], &rectangle(0.5, 0.25), Vec3::X, false);
        check(&rod, 1.5, 1e-6);
        let bent = [Vec3::ZERO, Vec3::Y, Vec3::new(0.0, 1.0, 1.0)];
        check(&sweep(&bent, &rectangle(0.1, 0.1), Vec3::X, false), 0.08, 1e-3);
    }

    #[test]
    fn plates_have_holes() {
        let outline = rectangle(2.0, 1.0);
        let hole = |x: f32, sides| circle(0.4, sides).iter().map(|p| *p + Vec2::new(x, 0.1)).collect();
        for sides in [3, 4, 6, 40] {
            let holes: Vec<Vec<Vec2>> = vec![hole(-1.3, sides), hole(0.0, sides), hole(1.2, sides)];
            let plate = extrude(&outline, &holes, 0.5);
            let of_circle = 0.5 * f64::from(sides) * (2.0 * PI / f64::from(sides)).sin() * 0.16;
            check(&plate, 0.5 * (8.0 - 3.0 * of_circle), 1e-5);
            check(&across_x(plate.clone(), 3.0), plate.signed_volume(), 1e-5);
        }
    }

    #[test]
    fn outlines_may_be_concave_and_of_either_orientation() {
        let mut outline = vec![Vec2::ZERO, Vec2::new(4.0, 0.0), Vec2::new(4.0, 3.0)];
        outline.extend(arc(Vec2::new(2.0, 3.0), 1.0, 0.0, -std::f32::consts::PI, 24));
        outline.push(Vec2::new(0.0, 3.0));
        let area = 12.0 - 0.5 * PI;
        check(&extrude(&outline, &[], 1.0), area, 0.01);
        outline.reverse();
        check(&extrude(&outline, &[], 1.0), area, 0.01);
    }
}
