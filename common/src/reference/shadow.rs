//! The parts of a view ray that see a light, without sampling.
//!
//! A point light and a view ray span a plane. Whatever shades a point of the ray crosses that
//! plane between the two: there a triangle is a line segment, and its shadow on the ray is the
//! segment seen from the light. So a ray's lit intervals follow from one traversal of the BVH
//! with the part of the plane between ray and light, exactly. A directional light is the same with
//! a parallel projection.
//!
//! No crack opens between two triangles: where an edge crosses the plane depends on the edge's two
//! corners alone, taken in the order of their side of the plane, so both triangles find the same
//! bits. A triangle that lies in the plane casts no shadow; its neighbours do.

use glam::{DVec2, DVec3, Vec3, Vec4};

use super::geometry::Geometry;
use crate::airlight::LightFromRay;

/// The plane through a ray and a light, in coordinates `u` along the ray and `v` towards the
/// light, both \[m\].
pub(super) struct Plane {
    origin: DVec3,
    along: DVec3,
    towards: DVec3,
    normal: DVec3,
    light: Projection,
}

/// How the light casts a point of the plane onto the ray.
enum Projection {
    /// From a point at (`t`, `h`), h > 0.
    Point { t: f64, h: f64 },
    /// Along parallel lines; `u` grows by `slope` per `v` towards the light.
    Parallel { slope: f64 },
}

impl Plane {
    /// For a point light beside the ray, h > 0.
    pub(super) fn of_point(origin: DVec3, geometry: &LightFromRay) -> Self {
        let LightFromRay { t, h, along, across } = *geometry;
        Self::new(origin, along, -across, Projection::Point { t, h })
    }

    /// For parallel light from the unit direction `to_light`, not parallel to the ray.
    pub(super) fn of_directional(origin: DVec3, along: DVec3, to_light: DVec3) -> Self {
        // Once more, because the first difference may have lost digits.
        let towards = to_light.reject_from_normalized(along).normalize_or_zero();
        let towards = towards.reject_from_normalized(along).normalize_or_zero();
        let slope = to_light.dot(along) / to_light.dot(towards);
        Self::new(origin, along, towards, Projection::Parallel { slope })
    }

    fn new(origin: DVec3, along: DVec3, towards: DVec3, light: Projection) -> Self {
        Self { origin, along, towards, normal: along.cross(towards), light }
    }

    /// Appends the shadow of a triangle on the ray, if it casts one, as a range of distances.
    fn cast(&self, positions: &[Vec3; 3], range: [f64; 2], shadows: &mut Vec<[f64; 2]>) {
        let corners = positions.map(|position| position.as_dvec3() - self.origin);
        let side = corners.map(|corner| self.normal.dot(corner));
        let above = side.map(|distance| distance >= 0.0);
        if above[0] == above[1] && above[1] == above[2] {
            return;
        }
        // Two of the three edges cross the plane.
        let mut ends = [DVec2::ZERO; 2];
        let mut found = 0;
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            if above[i] == above[j] {
                continue;
            }
            let (low, high) = if above[j] { (i, j) } else { (j, i) };
            let fraction = side[low] / (side[low] - side[high]);
            let crossing = corners[low] + fraction * (corners[high] - corners[low]);
            ends[found.min(1)] = DVec2::new(self.along.dot(crossing), self.towards.dot(crossing));
            found += 1;
        }
        let Some([a, b]) = self.project(ends) else {
            return;
        };
        let (start, end) = (a.min(b).max(range[0]), a.max(b).min(range[1]));
        if start < end {
            shadows.push([start, end]);
        }
    }

    /// The segment's ends on the ray, seen from the light; `None` if it is not between the two.
    fn project(&self, [mut a, mut b]: [DVec2; 2]) -> Option<[f64; 2]> {
        if a.y > b.y {
            std::mem::swap(&mut a, &mut b);
        }
        if b.y <= 0.0 {
            return None;
        }
        if a.y < 0.0 {
            a = DVec2::new(a.x + (b.x - a.x) * (-a.y / (b.y - a.y)), 0.0);
        }
        match self.light {
            Projection::Parallel { slope } => Some([a.x - slope * a.y, b.x - slope * b.y]),
            Projection::Point { t, h } => {
                if a.y >= h {
                    return None;
                }
                let seen = |p: DVec2| t + (p.x - t) * (h / (h - p.y));
                let end = if b.y < h {
                    seen(b)
                } else {
                    // It reaches the light's height: its shadow goes on for ever on that side.
                    let level = a.x + (b.x - a.x) * ((h - a.y) / (b.y - a.y));
                    if level > t { f64::INFINITY } else { f64::NEG_INFINITY }
                };
                Some([seen(a), end])
            }
        }
    }

    /// The region between the part `range` of the ray and the light, for the boxes of the BVH.
    fn region(&self, range: [f64; 2], scale: f64) -> Region {
        let edge = |x: f64, sign: f64| {
            // Inward normal of the line from (x, 0) to the light; `sign` +1 where u grows inwards.
            let normal = match self.light {
                Projection::Point { t, h } => DVec2::new(h, x - t),
                Projection::Parallel { slope } => DVec2::new(1.0, -slope),
            };
            (sign * normal.normalize(), DVec2::new(x, 0.0))
        };
        let (left, left_base) = edge(range[0], 1.0);
        let (right, right_base) = match self.light {
            _ if range[1] < f64::INFINITY => edge(range[1], -1.0),
            Projection::Point { h, .. } => (DVec2::NEG_Y, DVec2::new(0.0, h)),
            Projection::Parallel { .. } => (DVec2::ZERO, DVec2::ZERO),
        };
        let world = |m: DVec2| m.x * self.along + m.y * self.towards;
        let planes = [
            (self.normal, 0.0),
            (self.towards, 0.0),
            (world(left), left.dot(left_base)),
            (world(right), right.dot(right_base)),
        ];
        let lanes = |f: &dyn Fn(&(DVec3, f64)) -> f64| {
            Vec4::new(f(&planes[0]) as f32, f(&planes[1]) as f32, f(&planes[2]) as f32, f(&planes[3]) as f32)
        };
        let normals = [lanes(&|p| p.0.x), lanes(&|p| p.0.y), lanes(&|p| p.0.z)];
        let far = planes.iter().fold(0.0_f64, |far, plane| far.max(plane.1.abs()));
        Region {
            normals,
            reach: normals.map(Vec4::abs),
            offset: lanes(&|p| p.1 + p.0.dot(self.origin)),
            // Boxes are tested in f32: widened by more than its rounding errors.
            pad: Vec4::splat((4e-6 * (scale + far + self.origin.abs().max_element())) as f32),
        }
    }
}

/// Four half spaces in f32, a little too large: two-sided about the plane (lane 0), the light's
/// side of the ray, and the two sides of the fan from the light to the ray's part.
struct Region {
    normals: [Vec4; 3],
    reach: [Vec4; 3],
    offset: Vec4,
    pad: Vec4,
}

impl Region {
    /// Whether a box may reach into the region.
    #[inline(always)]
    fn meets(&self, centre: Vec3, half: Vec3) -> bool {
        let [x, y, z] = self.normals;
        let [rx, ry, rz] = self.reach;
        let inside = x * centre.x + y * centre.y + z * centre.z - self.offset;
        let reach = rx * half.x + ry * half.y + rz * half.z;
        // Lane 0 has to be near the plane from either side.
        let inside = inside.min(inside * Vec4::new(-1.0, 1.0, 1.0, 1.0));
        (inside + reach + self.pad).cmpge(Vec4::ZERO).all()
    }
}

/// Finds the parts of `range` \[m\] of the ray that see the light; `lit` is filled in order.
/// `shadows` and `stack` are room to work in.
pub(super) fn lit_intervals(
    geometry: &Geometry,
    plane: &Plane,
    range: [f64; 2],
    stack: &mut Vec<u32>,
    shadows: &mut Vec<[f64; 2]>,
    lit: &mut Vec<[f64; 2]>,
) {
    shadows.clear();
    lit.clear();
    if range[0] >= range[1] {
        return;
    }
    if !geometry.nodes.is_empty() {
        let region = plane.region(range, geometry.scale);
        stack.clear();
        stack.push(0);
        while let Some(index) = stack.pop() {
            let node = &geometry.nodes[index as usize];
            if !region.meets(node.centre, node.half) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, node.first + 1]);
                continue;
            }
            for triangle in node.first..node.first + node.count {
                plane.cast(&geometry.triangles[triangle as usize].positions, range, shadows);
            }
        }
    }
    shadows.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    // Gaps of this length are rounding, not light.
    let far = if range[1].is_finite() { range[1].abs() } else { 0.0 };
    let tolerance = 1e-9 * (geometry.scale + far + range[0].abs());
    let mut dark_until = range[0];
    for &[start, end] in shadows.iter() {
        if start > dark_until + tolerance {
            lit.push([dark_until, start]);
        }
        dark_until = dark_until.max(end);
    }
    if range[1] > dark_until + tolerance {
        lit.push([dark_until, range[1]]);
    }
}
