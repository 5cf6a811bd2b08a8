//! Directions for the exact model of indirect airlight: evenly spread points of the unit square, and the
//! rings about the way to a light that they are laid on.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::source::{Source, Spot};
use super::surface::Place;
use crate::random::unit;

/// Points of [0, 1)², evenly spread, shifted by a pattern.
pub(super) struct Lattice {
    count: u32,
    next: u32,
    shift: [f64; 2],
}

impl Lattice {
    pub(super) fn new(count: u32, pattern: u64) -> Self {
        Self { count, next: 0, shift: [0, 1].map(|k| unit(2 * pattern + k)) }
    }
}

impl Iterator for Lattice {
    type Item = [f64; 2];

    fn next(&mut self) -> Option<[f64; 2]> {
        if self.next == self.count {
            return None;
        }
        let i = f64::from(self.next);
        self.next += 1;
        // The second coordinate goes round by the golden ratio.
        Some([
            (i + self.shift[0]) / f64::from(self.count),
            (i * 0.618_033_988_749_894_8 + self.shift[1]).fract(),
        ])
    }
}

/// The directions from which a light's airlight can reach a place and light it: rings about the way
/// to the light.
pub(super) struct Fan {
    /// Unit direction to the light, the direction across it nearest to the normal, and the third.
    axis: DVec3,
    x: DVec3,
    y: DVec3,
    /// Cosine and sine of the angle between axis and normal.
    normal: [f64; 2],
    /// The rings' angles from the axis.
    from: f64,
    to: f64,
    /// Azimuth of a spot's cone and half its width.
    wedge: Option<[f64; 2]>,
}

impl Fan {
    /// `None` if nothing arrives at all.
    pub(super) fn new(source: &Source, place: &Place) -> Option<Self> {
        let axis = source.arrival(place.point).to_light.try_normalize()?;
        let normal = place.shading;
        let across = normal - normal.dot(axis) * axis;
        let x = across.try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector());
        let y = axis.cross(x);
        let (cos, sin) = (normal.dot(axis), normal.dot(x));
        let angle = sin.atan2(cos);
        let (from, mut to) = ((angle - FRAC_PI_2).max(0.0), (angle + FRAC_PI_2).min(PI));
        let mut wedge = None;
        if let Source::Spot(spot) = source {
            let (reach, azimuth) = wedge_of(spot, axis, x, y);
            to = to.min(reach);
            wedge = azimuth;
        }
        (from < to).then_some(Self { axis, x, y, normal: [cos, sin], from, to, wedge })
    }

    /// The parts of a ring's azimuth, measured from `x`, that count; empty ones last.
    fn arcs(&self, ring: f64) -> [[f64; 2]; 2] {
        let (a, b) = (self.normal[0] * ring.cos(), self.normal[1] * ring.sin());
        let above = if a >= b { PI } else { (-a / b).clamp(-1.0, 1.0).acos() };
        let Some([centre, half]) = self.wedge else {
            return [[-above, above], [0.0; 2]];
        };
        // Both arcs may overlap at both of their ends.
        let overlap = |turn: f64| {
            let (from, to) = ((centre - half + turn).max(-above), (centre + half + turn).min(above));
            if from < to { [from, to] } else { [0.0; 2] }
        };
        let turned = if centre > 0.0 { -2.0 * PI } else { 2.0 * PI };
        [overlap(0.0), overlap(turned)]
    }

    /// The direction of a point of [0, 1)²; `None` if its ring is empty.
    pub(super) fn direction(&self, [u, v]: [f64; 2]) -> Option<DVec3> {
        let ring = self.from + u * (self.to - self.from);
        let arcs = self.arcs(ring);
        let [first, second] = arcs.map(|[from, to]| to - from);
        let along = v * (first + second);
        if first + second <= 0.0 {
            return None;
        }
        let azimuth = if along < first { arcs[0][0] + along } else { arcs[1][0] + along - first };
        let (sin, cos) = ring.sin_cos();
        Some((cos * self.axis + sin * (azimuth.cos() * self.x + azimuth.sin() * self.y)).normalize())
    }

    /// Directions per solid angle; 0 for what is not in the fan.
    pub(super) fn density(&self, direction: DVec3) -> f64 {
        let (cos, x, y) = (direction.dot(self.axis), direction.dot(self.x), direction.dot(self.y));
        let sin = x.hypot(y);
        let (ring, azimuth) = (sin.atan2(cos), y.atan2(x));
        // What is in the fan but for rounding belongs to it.
        const SLACK: f64 = 1e-9;
        if ring < self.from - SLACK || ring > self.to + SLACK {
            return 0.0;
        }
        let arcs = self.arcs(ring.clamp(self.from, self.to));
        let inside = |[from, to]: [f64; 2]| from < to && from - SLACK <= azimuth && azimuth <= to + SLACK;
        if !arcs.into_iter().any(inside) {
            return 0.0;
        }
        let length: f64 = arcs.iter().map(|[from, to]| to - from).sum();
        1.0 / ((self.to - self.from) * length * sin.max(1e-300))
    }
}

/// The largest angle from the way to a spot at which a ray meets its cone, and the cone's azimuth with
/// half its width, if it does not go all round.
fn wedge_of(spot: &Spot, axis: DVec3, x: DVec3, y: DVec3) -> (f64, Option<[f64; 2]>) {
    let cone = spot.cone();
    let (cos, across) = (cone.axis.dot(axis), [cone.axis.dot(x), cone.axis.dot(y)]);
    let sin = across[0].hypot(across[1]);
    let tilt = sin.atan2(cos);
    let reach = (tilt + cone.angle + 1e-6).min(PI);
    if cone.angle >= tilt.min(PI - tilt) || cone.angle >= FRAC_PI_2 {
        return (reach, None);
    }
    let half = (cone.angle.sin() / sin).min(1.0).asin() + 1e-6;
    (reach, Some([across[1].atan2(across[0]), half]))
}
