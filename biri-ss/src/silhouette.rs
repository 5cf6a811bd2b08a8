//! Silhouettes: the edges of a mesh that bound its shadow, for one light.
//!
//! Of a closed component the triangles that face the light throw the shadow (the classical rule). Of
//! anything else **every** triangle does, turned towards the light: each edge then takes the signed sum over
//! its triangles, and where that is not zero it bounds the shadow, with that multiplicity. For any soup of
//! triangles the planes so found bound a volume in which a point is counted once for every triangle between
//! it and the light: exactly its shadow. A closed component with the light inside of it is treated so, too.

use common::Light;
use glam::{DAffine3, DVec3, DVec4};

use crate::connectivity::{BLOCK, Component, Connectivity};

/// Where light comes from, in homogeneous coordinates: a point's position and 1, or the direction to the
/// sun and 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Origin(pub DVec4);

impl Origin {
    /// Of a light.
    pub fn of(light: &Light) -> Self {
        match light {
            Light::Directional(sun) => Self((-sun.direction.as_dvec3()).extend(0.0)),
            Light::Point(point) => Self(point.position.as_dvec3().extend(1.0)),
            Light::Spot(spot) => Self(spot.position.as_dvec3().extend(1.0)),
        }
    }

    /// In another space.
    pub(crate) fn seen_from(self, object_from_world: &DAffine3) -> Self {
        let Self(o) = self;
        let moved = object_from_world.matrix3 * o.truncate() + object_from_world.translation * o.w;
        Self(moved.extend(o.w))
    }

    /// From `point` towards the light; its length is the distance of a point light.
    pub(crate) fn from(self, point: DVec3) -> DVec3 {
        self.0.truncate() - self.0.w * point
    }
}

/// An edge that bounds a shadow: seen from the light, the caster lies to its left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SilhouetteEdge {
    /// Welded vertex that it starts from.
    pub from: u32,
    /// Welded vertex that it ends at.
    pub to: u32,
    /// How many times it counts, at least 1.
    pub weight: u32,
}

/// The silhouette of one mesh for one light.
#[derive(Clone, Debug, Default)]
pub struct Silhouette {
    /// The edges.
    pub edges: Vec<SilhouetteEdge>,
    /// Whether each triangle faces the light.
    pub(crate) facing: Vec<bool>,
    /// Whether each component casts by its light-facing triangles alone.
    pub(crate) classical: Vec<bool>,
}

impl Silhouette {
    /// Finds it. `origin` is in object space.
    pub fn new(mesh: &Connectivity, origin: Origin) -> Self {
        let facing: Vec<bool> = mesh.planes.iter().map(|plane| plane.dot(origin.0) > 0.0).collect();
        let classical: Vec<bool> = mesh
            .components
            .iter()
            .map(|c| c.closed && winding_number(mesh, c, &facing, origin) == 0)
            .collect();
        let mut edges = Vec::new();
        let mut push = |low: u32, high: u32, sum: i32| {
            let (from, to) = if sum > 0 { (low, high) } else { (high, low) };
            edges.push(SilhouetteEdge { from, to, weight: sum.unsigned_abs() });
        };
        for edge in &mesh.simple {
            let (forward, backward) = (facing[edge.forward as usize], facing[edge.backward as usize]);
            if forward != backward {
                let once = classical[mesh.component_of[edge.forward as usize] as usize];
                let sum = if forward { 1 } else { -1 };
                push(edge.low, edge.high, if once { sum } else { 2 * sum });
            }
        }
        for edge in &mesh.general {
            let incidents = &mesh.incidents[edge.first as usize..][..edge.count as usize];
            let sum =
                incidents.iter().map(|&(t, forward)| if facing[t as usize] == forward { 1 } else { -1 });
            let sum: i32 = sum.sum();
            if sum != 0 {
                push(edge.low, edge.high, sum);
            }
        }
        Self { edges, facing, classical }
    }

    /// Whether a triangle throws a shadow.
    pub(crate) fn casts(&self, mesh: &Connectivity, triangle: u32) -> bool {
        self.facing[triangle as usize] || !self.classical[mesh.component_of[triangle as usize] as usize]
    }

    /// How many casting triangles lie between `point` (object space) and the light.
    pub(crate) fn depth_at(&self, mesh: &Connectivity, origin: Origin, point: DVec3) -> u32 {
        let direction = origin.from(point);
        let mut count = 0;
        for (index, block) in mesh.blocks.iter().enumerate() {
            let end = if origin.0.w == 0.0 { f64::INFINITY } else { 1.0 };
            if !crosses_box(point, direction, end, block.low, block.high) {
                continue;
            }
            let first = index * BLOCK;
            for t in first..(first + BLOCK).min(mesh.triangles.len()) {
                let point_side = mesh.planes[t].dot(point.extend(1.0)) > 0.0;
                let between = point_side != self.facing[t];
                if between && self.casts(mesh, t as u32) && pierced(mesh, t, point, direction).is_some() {
                    count += 1;
                }
            }
        }
        count
    }

    /// The edges linked to closed loops: each starts where the one before it ends. An edge is in as many
    /// loops as its weight. For the tests.
    #[cfg(test)]
    pub(crate) fn loops(&self) -> Vec<Vec<SilhouetteEdge>> {
        let mut leaving = std::collections::HashMap::<u32, Vec<SilhouetteEdge>>::new();
        for edge in self.edges.iter().rev() {
            let once = SilhouetteEdge { weight: 1, ..*edge };
            leaving.entry(edge.from).or_default().extend(std::iter::repeat_n(once, edge.weight as usize));
        }
        let mut take = |vertex: u32| leaving.get_mut(&vertex).and_then(Vec::pop);
        let mut loops = Vec::new();
        for &SilhouetteEdge { from: start, .. } in &self.edges {
            while let Some(first) = take(start) {
                let mut chain = vec![first];
                while let Some(last) = chain.last().filter(|last| last.to != start) {
                    let Some(next) = take(last.to) else { break };
                    chain.push(next);
                }
                loops.push(chain);
            }
        }
        loops
    }
}

/// How often a closed component winds around the light: 0 where that is outside.
fn winding_number(mesh: &Connectivity, component: &Component, facing: &[bool], origin: Origin) -> i32 {
    let at = origin.0.truncate();
    if origin.0.w == 0.0 || at.cmplt(component.low).any() || at.cmpgt(component.high).any() {
        return 0;
    }
    // Any line out of the box; this one is along no axis.
    let direction = DVec3::new(0.61, 0.36, 0.71) * (component.high - component.low).length();
    let crossings = component.triangles.iter().map(|&t| {
        // The light looks at the side that it is on; the line leaves through the other one.
        match pierced(mesh, t as usize, at, direction) {
            Some(leaves) if leaves && !facing[t as usize] => 1,
            Some(leaves) if !leaves && facing[t as usize] => -1,
            _ => 0,
        }
    });
    crossings.sum()
}

/// Whether the line through `point` along `direction` runs through a triangle, and if so, whether it leaves
/// the side that the triangle's back is on. A line through an edge of two triangles runs through one.
fn pierced(mesh: &Connectivity, triangle: usize, point: DVec3, direction: DVec3) -> Option<bool> {
    let corners = mesh.triangles[triangle];
    let at = |v: u32| mesh.positions[v as usize].as_dvec3() - point;
    let side = |a: u32, b: u32| {
        // The same bits for both triangles of an edge.
        let (low, high) = (a.min(b), a.max(b));
        (direction.dot(at(low).cross(at(high))) >= 0.0) == (a < b)
    };
    let [a, b, c] = corners;
    let first = side(a, b);
    (side(b, c) == first && side(c, a) == first).then_some(first)
}

/// Whether `from + s · direction` for s in [0, `end`] meets a box.
fn crosses_box(from: DVec3, direction: DVec3, end: f64, low: DVec3, high: DVec3) -> bool {
    let (mut near, mut far) = (0.0, end);
    for axis in 0..3 {
        let d = direction[axis];
        if d == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return false;
            }
            continue;
        }
        let (a, b) = ((low[axis] - from[axis]) / d, (high[axis] - from[axis]) / d);
        near = f64::max(near, a.min(b) - 1e-9 * a.abs().min(b.abs()));
        far = f64::min(far, a.max(b) + 1e-9 * a.abs().max(b.abs()));
    }
    near <= far
}
