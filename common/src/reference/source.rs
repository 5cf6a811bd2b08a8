//! Light sources in f64, and the airlight of one source on one ray.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::Scratch;
use super::geometry::Geometry;
use super::shadow::{Plane, lit_intervals};
use crate::airlight::{LightFromRay, Optics, airlight_directional, airlight_point, airlight_towards};
use crate::{Light, LightMap, SpotLight};

/// How near to a light \[m\] a ray is taken to pass at least: a millionth of the light's distance from
/// the eye, at any scale. Through the light itself the radiance is infinite.
pub(super) fn nearest(light: &LightFromRay) -> f64 {
    (1e-6 * light.t.hypot(light.h)).max(1e-18)
}

/// A light source in f64.
pub(super) enum Source {
    Point { position: DVec3, intensity: DVec3 },
    Spot(Spot),
    Directional { direction: DVec3, irradiance: DVec3 },
}

/// A spot with what its intensity is computed from; see [`SpotLight`].
pub(super) struct Spot {
    pub(super) position: DVec3,
    axis: DVec3,
    right: DVec3,
    up: DVec3,
    intensity: DVec3,
    cos_inner: f64,
    cos_outer: f64,
    tan_outer: f64,
    map: Option<Arc<LightMap>>,
}

/// One ray of light that arrives at a point.
pub(super) struct Arrival {
    /// Unit direction to the light.
    pub(super) to_light: DVec3,
    /// Distance of the light \[m\]; infinite for a directional one.
    pub(super) distance: f64,
    /// Irradiance on a facing plane, RGB \[W/m²\], before shadows and the medium.
    pub(super) irradiance: DVec3,
}

impl Source {
    pub(super) fn new(light: &Light) -> Self {
        match light {
            Light::Point(light) => {
                Self::Point { position: light.position.as_dvec3(), intensity: light.intensity.as_dvec3() }
            }
            Light::Spot(light) => Self::Spot(Spot::new(light)),
            Light::Directional(light) => Self::Directional {
                direction: light.direction.as_dvec3().normalize(),
                irradiance: light.irradiance.as_dvec3(),
            },
        }
    }

    /// What arrives at `point` if nothing is in the way.
    pub(super) fn arrival(&self, point: DVec3) -> Arrival {
        let from = |position: DVec3| {
            let distance = (position - point).length();
            let to_light = (position - point) / distance.max(f64::MIN_POSITIVE);
            (to_light, distance, 1.0 / (distance * distance).max(f64::MIN_POSITIVE))
        };
        match self {
            Self::Point { position, intensity } => {
                let (to_light, distance, inverse_square) = from(*position);
                Arrival { to_light, distance, irradiance: *intensity * inverse_square }
            }
            Self::Spot(spot) => {
                let (to_light, distance, inverse_square) = from(spot.position);
                let irradiance = spot.intensity_towards(-to_light) * inverse_square;
                Arrival { to_light, distance, irradiance }
            }
            Self::Directional { direction, irradiance } => {
                Arrival { to_light: -*direction, distance: f64::INFINITY, irradiance: *irradiance }
            }
        }
    }

    /// Airlight along [0, `end`] of the ray, with shadows \[W m⁻² sr⁻¹\]: the lit intervals of the
    /// ray, each integrated.
    pub(super) fn airlight(
        &self,
        geometry: &Geometry,
        optics: &Optics,
        [eye, direction]: [DVec3; 2],
        end: f64,
        tolerance: f64,
        scratch: &mut Scratch,
    ) -> DVec3 {
        let position = match self {
            Self::Directional { direction: travel, .. } => {
                self.find_lit_by_directional(geometry, [eye, direction], -*travel, end, scratch);
                return self.integrate(optics, [eye, direction], &scratch.lit, tolerance);
            }
            Self::Point { position, .. } => *position,
            Self::Spot(spot) => spot.position,
        };
        let light = LightFromRay::new(eye, direction, position);
        let Scratch { stack, shadows, lit } = scratch;
        lit.clear();
        if light.h < nearest(&light) {
            // The ray runs through the light. Its points see the light along the ray itself: all of
            // them, or, when there is a surface between, none.
            let hidden =
                end < light.t || light.t < 0.0 && geometry.occluded(stack, eye, -direction, [0.0, -light.t]);
            if !hidden {
                lit.push([0.0, end]);
            }
        } else {
            let range = match self {
                Self::Spot(spot) => spot.lit_range(&light, [0.0, end]),
                _ => [0.0, end],
            };
            lit_intervals(geometry, &Plane::of_point(eye, &light), range, stack, shadows, lit);
        }
        self.integrate(optics, [eye, direction], lit, tolerance)
    }

    fn find_lit_by_directional(
        &self,
        geometry: &Geometry,
        [eye, direction]: [DVec3; 2],
        to_light: DVec3,
        end: f64,
        scratch: &mut Scratch,
    ) {
        let Scratch { stack, shadows, lit } = scratch;
        if to_light.cross(direction).length() > 1e-7 {
            let plane = Plane::of_directional(eye, direction, to_light);
            return lit_intervals(geometry, &plane, [0.0, end], stack, shadows, lit);
        }
        // The light shines along the ray: from ahead on all of it unless a surface ends it, from
        // behind on all of it unless there is a surface behind the eye.
        lit.clear();
        let ahead = to_light.dot(direction) > 0.0;
        let hidden = if ahead {
            end < f64::INFINITY
        } else {
            geometry.occluded(stack, eye, -direction, [0.0, f64::INFINITY])
        };
        if !hidden {
            lit.push([0.0, end]);
        }
    }

    /// Airlight from the lit intervals of a ray.
    pub(super) fn integrate(
        &self,
        optics: &Optics,
        [eye, direction]: [DVec3; 2],
        lit: &[[f64; 2]],
        tolerance: f64,
    ) -> DVec3 {
        let Optics { sigma_t, sigma_s, phase } = *optics;
        if lit.is_empty() {
            return DVec3::ZERO;
        }
        match self {
            Self::Directional { direction: travel, irradiance } => {
                let cos_theta = -travel.dot(direction);
                lit.iter()
                    .map(|[a, b]| airlight_directional(sigma_t, sigma_s, phase, cos_theta, *a, *b))
                    .sum::<DVec3>()
                    * *irradiance
            }
            Self::Point { position, intensity } => {
                let light = LightFromRay::new(eye, direction, *position);
                let (t, h) = (light.t, light.h.max(nearest(&light)));
                lit.iter()
                    .map(|[a, b]| airlight_point(sigma_t, sigma_s, phase, t, h, *a, *b, tolerance))
                    .sum::<DVec3>()
                    * *intensity
            }
            Self::Spot(spot) => {
                let mut light = LightFromRay::new(eye, direction, spot.position);
                if light.h < nearest(&light) {
                    light.h = nearest(&light);
                    light.across = direction.any_orthonormal_vector();
                }
                let breaks = spot.breaks(&light);
                lit.iter()
                    .map(|range| {
                        airlight_towards(optics, &light, *range, &breaks, tolerance, |d| {
                            spot.intensity_towards(d)
                        })
                    })
                    .sum()
            }
        }
    }
}

/// The cone that a spot lights.
pub(super) struct Cone {
    pub(super) axis: DVec3,
    /// Between axis and edge.
    pub(super) angle: f64,
}

impl Spot {
    pub(super) fn cone(&self) -> Cone {
        Cone { axis: self.axis, angle: self.cos_outer.acos() }
    }

    fn new(light: &SpotLight) -> Self {
        let axis = light.direction.as_dvec3().normalize();
        let right = axis.cross(light.up.as_dvec3()).normalize_or_zero();
        let (inner, outer) = (f64::from(light.inner_angle), f64::from(light.outer_angle));
        Self {
            position: light.position.as_dvec3(),
            axis,
            right,
            up: right.cross(axis),
            intensity: light.intensity.as_dvec3(),
            cos_inner: inner.cos(),
            cos_outer: outer.cos(),
            tan_outer: outer.tan(),
            map: light.light_map.clone(),
        }
    }

    /// Radiant intensity \[W/sr\] towards a unit direction: [`SpotLight::intensity_towards`] in f64.
    pub(super) fn intensity_towards(&self, direction: DVec3) -> DVec3 {
        let cos_angle = self.axis.dot(direction);
        // The cone itself belongs to it, whatever rounding says.
        if cos_angle < self.cos_outer - 1e-12 {
            return DVec3::ZERO;
        }
        let width = self.cos_inner - self.cos_outer;
        let falloff =
            if width < 1e-6 { 1.0 } else { ((cos_angle - self.cos_outer) / width).clamp(0.0, 1.0).powi(2) };
        let Some(map) = &self.map else {
            return self.intensity * falloff;
        };
        let plane = DVec2::new(self.right.dot(direction), -self.up.dot(direction))
            / (cos_angle.max(1e-6) * self.tan_outer);
        self.intensity * falloff * sample(map, plane * 0.5 + 0.5)
    }

    /// Distances along the ray \[m\] where it crosses the cone of cosine `cos` about the axis.
    fn cone_crossings(&self, light: &LightFromRay, cos: f64) -> impl Iterator<Item = f64> + use<> {
        // With y = x − t: axis · (h across + y along) = cos · √(h² + y²).
        let LightFromRay { t, h, along, across } = *light;
        let (a, b) = (self.axis.dot(across) * h, self.axis.dot(along));
        let (p, q, r) = (b * b - cos * cos, a * b, a * a - cos * cos * h * h);
        let root = (q * q - p * r).max(-1.0).sqrt();
        // The two roots without cancellation; NaN where there are none.
        let w = -(q + root.copysign(q));
        [w / p, r / w].into_iter().filter(move |y| y.is_finite() && a + b * y >= 0.0).map(move |y| t + y)
    }

    /// The part of `range` \[m\] inside the cone; empty as [0, 0].
    pub(super) fn lit_range(&self, light: &LightFromRay, [from, to]: [f64; 2]) -> [f64; 2] {
        let mut cuts: Vec<f64> = self
            .cone_crossings(light, self.cos_outer)
            .filter(|x| from < *x && *x < to)
            .chain([from, to])
            .collect();
        cuts.sort_by(f64::total_cmp);
        let LightFromRay { t, h, along, across } = *light;
        let inside = |x: f64| {
            let towards = across * h + along * (x - t);
            self.axis.dot(towards) >= self.cos_outer * towards.length()
        };
        // The cone is convex, so what is inside of it is in one piece.
        let pieces = cuts.windows(2).filter(|piece| {
            let [a, b] = [piece[0], piece[1]];
            inside(if b < f64::INFINITY { 0.5 * (a + b) } else { a.max(t) + a.abs() + h })
        });
        pieces.map(|piece| [piece[0], piece[1]]).reduce(|first, last| [first[0], last[1]]).unwrap_or([0.0; 2])
    }

    /// Distances \[m\] where the intensity along the ray has a kink: at both cones and, with a light
    /// map, at the lines between texel centres.
    pub(super) fn breaks(&self, light: &LightFromRay) -> Vec<f64> {
        let mut breaks: Vec<f64> = self
            .cone_crossings(light, self.cos_outer)
            .chain(self.cone_crossings(light, self.cos_inner))
            .collect();
        let Some(map) = &self.map else {
            return breaks;
        };
        let LightFromRay { t, h, along, across } = *light;
        for (side, count) in [(self.right, map.width), (-self.up, map.height)] {
            for texel in 0..count {
                let at = 2.0 * (f64::from(texel) + 0.5) / f64::from(count) - 1.0;
                let normal = side - at * self.tan_outer * self.axis;
                let x = t - h * normal.dot(across) / normal.dot(along);
                if x.is_finite() {
                    breaks.push(x);
                }
            }
        }
        breaks
    }
}

/// [`LightMap::sample`] in f64.
fn sample(map: &LightMap, uv: DVec2) -> DVec3 {
    let size = DVec2::new(f64::from(map.width), f64::from(map.height));
    let at = (uv * size - 0.5).clamp(DVec2::ZERO, size - 1.0);
    let (low, fraction) = (at.floor(), at.fract());
    let (x, y) = (low.x as u32, low.y as u32);
    let texel = |x: u32, y: u32| {
        let index = y.min(map.height - 1) as usize * map.width as usize + x.min(map.width - 1) as usize;
        map.texels.get(index).copied().unwrap_or_default().as_dvec3()
    };
    let top = texel(x, y).lerp(texel(x + 1, y), fraction.x);
    let bottom = texel(x, y + 1).lerp(texel(x + 1, y + 1), fraction.x);
    top.lerp(bottom, fraction.y)
}
