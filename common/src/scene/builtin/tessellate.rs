//! From solids to the objects of a scene with a wanted number of triangles: round things get as many
//! segments as the number allows, flat ones are split at their longest edges to make up the rest,
//! and normals come last.

use std::collections::BinaryHeap;
use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::scene::{Mesh, Object};

/// A solid, or several that do not touch, of one material.
pub(super) struct Part {
    /// Name of the object.
    pub name: &'static str,
    /// Material index.
    pub material: u32,
    /// Closed 2-manifold without normals.
    pub mesh: Mesh,
}

/// How finely round things are cut: grows without bound, as does every number of segments with it.
#[derive(Clone, Copy)]
pub(super) struct Fineness(f32);

impl Fineness {
    /// Segments for an arc of `angle` \[rad\] and `radius` \[m\]: its sagitta is alike for all radii.
    pub(super) fn segments(self, radius: f32, angle: f32, least: u32) -> u32 {
        // Beyond the limit an arc looks no rounder, and triangulating its plate takes long.
        ((angle * radius.sqrt() * self.0) as u32).clamp(least, 160)
    }

    /// Number of cuts that grows in proportion to those of a unit circle, at least `least`.
    pub(super) fn cuts(self, per_unit: f32, least: u32) -> u32 {
        ((per_unit * self.0) as u32).clamp(least, 160)
    }
}

/// Part of the triangles that round things may have; the rest is left for flat ones.
const ROUND_SHARE: f64 = 0.75;
const COARSEST: f32 = 0.5;
const STEP: f32 = 1.05;
const STEPS: u32 = 110;

/// Makes the objects of a scene with `wanted` triangles, one fewer if that is odd. The coarsest
/// version must have no more.
pub(super) fn objects(wanted: u32, parts: impl Fn(Fineness) -> Vec<Part>) -> Vec<Object> {
    let wanted = wanted as usize;
    let share = (wanted as f64 * ROUND_SHARE) as usize;
    let at = |step: u32| parts(Fineness(COARSEST * STEP.powi(step as i32)));
    let count = |parts: &[Part]| parts.iter().map(|part| part.mesh.triangles.len()).sum::<usize>();
    // Gallop up from the coarse end, where trying is cheap, then bisect.
    let (mut best, mut low, mut high) = (at(0), 0, STEPS);
    let mut stride = 16;
    while high - low > 1 {
        let step = (low + stride).min((low + high) / 2).max(low + 1);
        let tried = at(step);
        if count(&tried) <= share {
            (best, low) = (tried, step);
        } else {
            (high, stride) = (step, 1.max((step - low) / 2));
        }
    }
    debug_assert!(count(&best) <= wanted, "{} triangles at the coarsest", count(&best));
    let mut meshes: Vec<&mut Mesh> = best.iter_mut().map(|part| &mut part.mesh).collect();
    split_longest(&mut meshes, wanted);
    best.into_iter()
        .map(|part| Object {
            name: part.name.into(),
            mesh: Arc::new(shaded(part.mesh, part.material)),
            world_from_object: Affine3A::IDENTITY,
        })
        .collect()
}

/// Splits the longest edges of all meshes in the middle until there are `wanted` triangles (or one
/// fewer). An edge of a closed mesh lies between two triangles, so that each split makes two more
/// and the mesh stays closed.
fn split_longest(meshes: &mut [&mut Mesh], wanted: usize) {
    let mut count: usize = meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let mut twins: Vec<Vec<u32>> = meshes.iter().map(|mesh| half_edge_twins(mesh)).collect();
    // Bits of floats that are not negative are ordered as the floats are.
    let length = |mesh: &Mesh, half: u32| {
        let [a, b] = [half, next(half)].map(|half| mesh.positions[corner(mesh, half) as usize]);
        a.distance_squared(b).to_bits()
    };
    let mut edges = Vec::new();
    for (index, (mesh, twins)) in meshes.iter().zip(&twins).enumerate() {
        let halves = (0..twins.len() as u32).filter(|&half| half < twins[half as usize]);
        edges.extend(halves.map(|half| (length(mesh, half), index, half)));
    }
    let mut longest = BinaryHeap::from(edges);
    while count + 2 <= wanted {
        let Some((was, index, half)) = longest.pop() else { return };
        let (mesh, twins) = (&mut *meshes[index], &mut twins[index]);
        // An entry whose place another edge has taken since is there again under its new place.
        if length(mesh, half) != was {
            continue;
        }
        let twin = twins[half as usize];
        let ends = [half, twin].map(|half| mesh.positions[corner(mesh, half) as usize]);
        let middle = mesh.positions.len() as u32;
        mesh.positions.push(ends[0].midpoint(ends[1]));
        // Of (from, to, apex), (from, middle, apex) stays in place and (middle, to, apex) is new.
        let [first, second] = [half, twin].map(|half| {
            let new = 3 * mesh.triangles.len() as u32;
            let (to, apex) = (next(half), next(next(half)));
            mesh.triangles.push([middle, corner(mesh, to), corner(mesh, apex)]);
            mesh.triangles[to as usize / 3][to as usize % 3] = middle;
            let beyond = twins[to as usize];
            twins[beyond as usize] = new + 1;
            twins[to as usize] = new + 2;
            twins.extend([0, beyond, to]);
            for half in [half, new, new + 1, new + 2] {
                longest.push((length(mesh, half), index, half));
            }
            new
        });
        for (a, b) in [(half, second), (twin, first)] {
            twins[a as usize] = b;
            twins[b as usize] = a;
        }
        count += 2;
    }
}

/// The half-edge after `half` in its triangle; half-edge 3 t + k runs from corner k of triangle t.
fn next(half: u32) -> u32 {
    if half % 3 == 2 { half - 2 } else { half + 1 }
}

/// The vertex that a half-edge starts from.
fn corner(mesh: &Mesh, half: u32) -> u32 {
    mesh.triangles[half as usize / 3][half as usize % 3]
}

/// For each half-edge of a closed mesh the one that runs the other way.
fn half_edge_twins(mesh: &Mesh) -> Vec<u32> {
    let count = 3 * mesh.triangles.len() as u32;
    let mut edges: Vec<(u32, u32, u32)> = (0..count)
        .map(|half| {
            let (from, to) = (corner(mesh, half), corner(mesh, next(half)));
            (from.min(to), from.max(to), half)
        })
        .collect();
    edges.sort_unstable();
    let mut twins = vec![0; count as usize];
    for pair in edges.chunks_exact(2) {
        debug_assert_eq!((pair[0].0, pair[0].1), (pair[1].0, pair[1].1), "the mesh is not closed");
        twins[pair[0].2 as usize] = pair[1].2;
        twins[pair[1].2 as usize] = pair[0].2;
    }
    twins
}

/// Cosine of the sharpest angle between faces that are shaded as one round surface: 50°.
const CREASE: f32 = 0.643;

/// The mesh with normals: a corner's is the mean of the faces around it that are turned less than
/// the crease angle from its own, each weighted by its angle there. Vertices are split accordingly.
fn shaded(mesh: Mesh, material: u32) -> Mesh {
    let at = |v: u32| mesh.positions[v as usize];
    let normal = |[a, b, c]: [u32; 3]| (at(b) - at(a)).cross(at(c) - at(a)).normalize_or_zero();
    let faces: Vec<Vec3> = mesh.triangles.iter().map(|&corners| normal(corners)).collect();
    // The corners (triangle · 3 + corner) around each vertex, one vertex after the other.
    let mut starts = vec![0_u32; mesh.positions.len() + 1];
    mesh.triangles.iter().flatten().for_each(|&v| starts[v as usize + 1] += 1);
    (0..mesh.positions.len()).for_each(|v| starts[v + 1] += starts[v]);
    let mut fill = starts.clone();
    let mut around = vec![0_u32; 3 * mesh.triangles.len()];
    for (corner, &v) in mesh.triangles.iter().flatten().enumerate() {
        around[fill[v as usize] as usize] = corner as u32;
        fill[v as usize] += 1;
    }
    let angle = |corner: u32| {
        let (corners, here) = (mesh.triangles[corner as usize / 3], corner as usize % 3);
        let origin = at(corners[here]);
        let to = |step: usize| at(corners[(here + step) % 3]) - origin;
        to(1).angle_between(to(2))
    };
    let mut out = Mesh { triangles: mesh.triangles.clone(), ..Mesh::default() };
    out.materials = vec![material; mesh.triangles.len()];
    let mut made: Vec<(Vec3, u32)> = Vec::new();
    for v in 0..mesh.positions.len() {
        made.clear();
        let corners = &around[starts[v] as usize..starts[v + 1] as usize];
        for &corner in corners {
            let own = faces[corner as usize / 3];
            let near = corners.iter().filter(|&&other| faces[other as usize / 3].dot(own) > CREASE);
            let sum: Vec3 = near.map(|&other| faces[other as usize / 3] * angle(other)).sum();
            let normal = sum.try_normalize().unwrap_or(own);
            // Corners with (nearly) one normal share a vertex.
            let same = made.iter().find(|(other, _)| other.distance_squared(normal) < 1e-8);
            let index = match same {
                Some(&(_, index)) => index,
                None => {
                    let index = out.positions.len() as u32;
                    out.positions.push(mesh.positions[v]);
                    out.normals.push(normal);
                    made.push((normal, index));
                    index
                }
            };
            out.triangles[corner as usize / 3][corner as usize % 3] = index;
        }
    }
    out
}
