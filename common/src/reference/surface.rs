//! Direct light on the first surface along a ray, attenuated on both ways.

use std::f64::consts::PI;

use glam::DVec3;

use super::geometry::{Geometry, Hit};
use super::source::Source;
use crate::airlight::Optics;
use crate::scene::{Material, WorldTriangle};

/// The place where a ray meets a surface.
///
/// Both sides of a triangle reflect: its own and its shading normal are each turned to the eye.
pub(super) struct Place {
    pub(super) point: DVec3,
    /// The triangle's own normal.
    pub(super) flat: DVec3,
    /// The shading normal.
    pub(super) shading: DVec3,
    /// The direction of the eye, mirrored in the shading normal.
    pub(super) mirrored: DVec3,
    /// More than the error of `point` \[m\]: rays start off the surface by this.
    pub(super) offset: f64,
    /// Diffuse and specular reflectance.
    pub(super) k_d: DVec3,
    pub(super) k_s: DVec3,
    pub(super) exponent: f64,
}

impl Place {
    /// `None` where the triangle has no material.
    pub(super) fn new(
        geometry: &Geometry,
        materials: &[Material],
        [eye, direction]: [DVec3; 2],
        hit: &Hit,
    ) -> Option<Self> {
        let triangle = &geometry.triangles[hit.triangle as usize];
        let material = materials.get(triangle.material as usize)?;
        let (flat, shading) = normals(triangle, hit, direction);
        let point = eye + hit.distance * direction;
        Some(Self {
            point,
            flat,
            shading,
            mirrored: direction - 2.0 * direction.dot(shading) * shading,
            offset: 1e-9 * (geometry.scale + point.abs().max_element() + hit.distance),
            k_d: material.k_d.as_dvec3(),
            k_s: material.k_s.as_dvec3(),
            exponent: f64::from(material.exponent),
        })
    }

    /// Where rays start: the point, a little off the surface.
    pub(super) fn lifted(&self) -> DVec3 {
        self.point + self.offset * self.flat
    }

    /// The reflectance function for light from a unit direction, RGB \[1/sr\].
    pub(super) fn reflected(&self, to_light: DVec3) -> DVec3 {
        let lobe = self.mirrored.dot(to_light).max(0.0).powf(self.exponent);
        self.k_d / PI + self.k_s * ((self.exponent + 2.0) / (2.0 * PI) * lobe)
    }
}

/// Radiance \[W m⁻² sr⁻¹\] that the surface sends to the eye and that arrives there.
///
/// A light counts if it is on the eye's side of the triangle's plane and of the shading normal. The
/// medium attenuates the way to the eye and, of point and spot lights, the way from the light.
pub(super) fn shade(
    geometry: &Geometry,
    sources: &[Source],
    optics: &Optics,
    place: &Place,
    distance: f64,
    stack: &mut Vec<u32>,
) -> DVec3 {
    let mut radiance = DVec3::ZERO;
    for source in sources {
        let arrival = source.arrival(place.point);
        let cos = place.shading.dot(arrival.to_light);
        if cos <= 0.0 || place.flat.dot(arrival.to_light) <= 0.0 || arrival.irradiance == DVec3::ZERO {
            continue;
        }
        // Shadow rays start off the surface towards the light; a light on the eye's side of the plane
        // can't be hidden by the triangle itself.
        let between = [place.offset, arrival.distance - place.offset];
        if geometry.occluded(stack, place.point, arrival.to_light, between) {
            continue;
        }
        let medium = if arrival.distance.is_finite() {
            (-optics.sigma_t * arrival.distance).exp()
        } else {
            DVec3::ONE
        };
        radiance += place.reflected(arrival.to_light) * cos * medium * arrival.irradiance;
    }
    radiance * (-optics.sigma_t * distance).exp()
}

/// The triangle's own normal and the shading normal, unit, both turned against `direction`.
fn normals(triangle: &WorldTriangle, hit: &Hit, direction: DVec3) -> (DVec3, DVec3) {
    let [a, b, c] = triangle.positions.map(|position| position.as_dvec3());
    let flat = (b - a).cross(c - a).normalize_or_zero();
    let shading: DVec3 =
        triangle.normals.iter().zip(hit.weights).map(|(normal, weight)| normal.as_dvec3() * weight).sum();
    let shading = shading.try_normalize().unwrap_or(flat);
    let turned = |normal: DVec3| if normal.dot(direction) > 0.0 { -normal } else { normal };
    (turned(flat), turned(shading))
}
