//! Triangles and their BVH, and the two questions that a ray asks of them, in f64.

use glam::{DVec3, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;
use std::time::Duration;

use crate::scene::WorldTriangle;

/// A box of the BVH. Inner nodes (`count = 0`) have their children at `first` and `first + 1`,
/// leaves `count` triangles from `first` on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) centre: Vec3,
    pub(super) first: u32,
    /// Half the extent, rounded up so that the box encloses its triangles for certain.
    pub(super) half: Vec3,
    pub(super) count: u32,
}

/// The nearest triangle along a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hit {
    /// Distance \[m\] for a unit direction.
    pub(super) distance: f64,
    pub(super) triangle: u32,
    /// Weights of the corners; they add up to 1.
    pub(super) weights: [f64; 3],
}

/// All triangles of a scene, in the order of the BVH's leaves.
pub(super) struct Geometry {
    pub(super) nodes: Vec<Node>,
    pub(super) triangles: Vec<WorldTriangle>,
    /// Largest coordinate \[m\]; what rounding errors are measured by.
    pub(super) scale: f64,
    depth: usize,
}

impl Geometry {
    pub(super) fn new(triangles: Vec<WorldTriangle>) -> Self {
        let scale = triangles
            .iter()
            .flat_map(|triangle| triangle.positions)
            .fold(0.0_f32, |scale, p| scale.max(p.abs().max_element()));
        if triangles.is_empty() {
            return Self { nodes: Vec::new(), triangles, scale: 0.0, depth: 0 };
        }
        let corners: Vec<Triangle> = triangles
            .iter()
            .map(|triangle| {
                let [v0, v1, v2] = triangle.positions.map(Vec3A::from);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let parameters = BvhBuildParams { max_prims_per_leaf: 4, ..BvhBuildParams::medium_build() };
        let bvh = build_bvh2_from_tris(&corners, parameters, &mut Duration::default());
        let nodes = bvh
            .nodes
            .iter()
            .map(|node| {
                let (low, high) = (Vec3::from(node.aabb().min), Vec3::from(node.aabb().max));
                let centre = 0.5 * (low + high);
                let half = (high - centre).max(centre - low);
                let pad = 1e-6 * (centre.abs() + half) + f32::MIN_POSITIVE;
                Node { centre, first: node.first_index, half: half + pad, count: node.prim_count }
            })
            .collect();
        let triangles = bvh.primitive_indices.iter().map(|&index| triangles[index as usize]).collect();
        Self { nodes, triangles, scale: f64::from(scale), depth: bvh.max_depth }
    }

    /// A stack that no traversal outgrows by much.
    pub(super) fn stack(&self) -> Vec<u32> {
        Vec::with_capacity(self.depth + 2)
    }

    /// The nearest triangle in [`from`, `to`] along the unit `direction`.
    pub(super) fn nearest(
        &self,
        stack: &mut Vec<u32>,
        origin: DVec3,
        direction: DVec3,
        [from, to]: [f64; 2],
    ) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        self.visit(stack, origin, direction, from, to, |hit, limit| {
            if hit.distance < *limit || nearest.is_none() {
                *limit = hit.distance;
                nearest = Some(hit);
            }
            true
        });
        nearest
    }

    /// Whether any triangle lies in [`from`, `to`] along the unit `direction`.
    pub(super) fn occluded(
        &self,
        stack: &mut Vec<u32>,
        origin: DVec3,
        direction: DVec3,
        [from, to]: [f64; 2],
    ) -> bool {
        let mut occluded = false;
        self.visit(stack, origin, direction, from, to, |_, _| {
            occluded = true;
            false
        });
        occluded
    }

    /// Calls `found` for triangles within the limit, which it may lower; it says whether to go on.
    fn visit(
        &self,
        stack: &mut Vec<u32>,
        origin: DVec3,
        direction: DVec3,
        from: f64,
        mut limit: f64,
        mut found: impl FnMut(Hit, &mut f64) -> bool,
    ) {
        if self.nodes.is_empty() || from > limit {
            return;
        }
        // A zero becomes tiny, so that no 0 · ∞ arises where the ray lies in a box's face.
        let inverse = DVec3::from_array(
            direction.to_array().map(|d| if d.abs() < 1e-300 { 1e300_f64.copysign(d) } else { 1.0 / d }),
        );
        // Distance at which the ray enters a box, infinite if it misses.
        let entry = |node: &Node, limit: f64| {
            let (centre, half) = (node.centre.as_dvec3() - origin, node.half.as_dvec3());
            let (a, b) = ((centre - half) * inverse, (centre + half) * inverse);
            let (enter, leave) = (a.min(b).max_element().max(from), a.max(b).min_element().min(limit));
            if enter <= leave { enter } else { f64::INFINITY }
        };
        stack.clear();
        stack.push(0);
        while let Some(index) = stack.pop() {
            let node = self.nodes[index as usize];
            if entry(&node, limit) == f64::INFINITY {
                continue;
            }
            if node.count == 0 {
                let [a, b] = [node.first, node.first + 1];
                let [near, far] = [a, b].map(|child| entry(&self.nodes[child as usize], limit));
                let ((first, d1), (second, d2)) =
                    if near <= far { ((a, near), (b, far)) } else { ((b, far), (a, near)) };
                // The nearer child on top.
                if d2 < f64::INFINITY {
                    stack.push(second);
                }
                if d1 < f64::INFINITY {
                    stack.push(first);
                }
                continue;
            }
            for triangle in node.first..node.first + node.count {
                if let Some(hit) = self.intersect(triangle, origin, direction)
                    && from <= hit.distance
                    && hit.distance <= limit
                    && !found(hit, &mut limit)
                {
                    return;
                }
            }
        }
    }

    /// Where a ray's line meets a triangle. Two triangles compute exactly opposite numbers for a
    /// shared edge, so that no ray slips between them.
    fn intersect(&self, triangle: u32, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let [a, b, c] =
            self.triangles[triangle as usize].positions.map(|position| position.as_dvec3() - origin);
        let weights = [b.cross(c), c.cross(a), a.cross(b)].map(|edge| edge.dot(direction));
        let outside = weights.iter().any(|w| *w < 0.0) && weights.iter().any(|w| *w > 0.0);
        let total: f64 = weights.iter().sum();
        if outside || total == 0.0 {
            return None;
        }
        let weights = weights.map(|weight| weight / total);
        let normal = (b - a).cross(c - a);
        let slope = normal.dot(direction);
        // Through the plane where the ray crosses it well, through the corners where it grazes.
        let distance = if slope.abs() > 1e-9 * normal.length() {
            normal.dot(a) / slope
        } else {
            (weights[0] * a + weights[1] * b + weights[2] * c).dot(direction)
        };
        distance.is_finite().then_some(Hit { distance, triangle, weights })
    }
}
