//! Direct light on the first surface along a ray, attenuated on both ways.

use std::f64::consts::PI;

use glam::DVec3;

use super::geometry::{Geometry, Hit};
use super::source::Source;
use crate::airlight::Optics;
use crate::scene::{Material, WorldTriangle};

/// Radiance \[W m⁻² sr⁻¹\] that the surface sends to the eye and that arrives there.
///
/// Both sides of a triangle reflect: its own and its shading normal are each turned to the eye. A light counts if it is on
/// the eye's side of the triangle's plane and of the shading normal. The medium attenuates the way
/// to the eye and, of point and spot lights, the way from the light.
pub(super) fn shade(
    geometry: &Geometry,
    sources: &[Source],
    materials: &[Material],
    optics: &Optics,
    [eye, direction]: [DVec3; 2],
    hit: &Hit,
    stack: &mut Vec<u32>,
) -> DVec3 {
    let triangle = &geometry.triangles[hit.triangle as usize];
    let Some(material) = materials.get(triangle.material as usize) else {
        return DVec3::ZERO;
    };
    let (flat, shading) = normals(triangle, hit, direction);
    let point = eye + hit.distance * direction;
    // Shadow rays start off the surface by more than the error of `point`, towards the light; a
    // light on the eye's side of the plane can't be hidden by the triangle itself.
    let offset = 1e-9 * (geometry.scale + point.abs().max_element() + hit.distance);
    let mirrored = direction - 2.0 * direction.dot(shading) * shading;
    let (k_d, k_s) = (material.k_d.as_dvec3(), material.k_s.as_dvec3());
    let exponent = f64::from(material.exponent);

    let mut radiance = DVec3::ZERO;
    for source in sources {
        let arrival = source.arrival(point);
        let cos = shading.dot(arrival.to_light);
        if cos <= 0.0 || flat.dot(arrival.to_light) <= 0.0 || arrival.irradiance == DVec3::ZERO {
            continue;
        }
        if geometry.occluded(stack, point, arrival.to_light, [offset, arrival.distance - offset]) {
            continue;
        }
        let lobe = mirrored.dot(arrival.to_light).max(0.0).powf(exponent);
        let reflected = k_d / PI + k_s * ((exponent + 2.0) / (2.0 * PI) * lobe);
        let medium = if arrival.distance.is_finite() {
            (-optics.sigma_t * arrival.distance).exp()
        } else {
            DVec3::ONE
        };
        radiance += reflected * cos * medium * arrival.irradiance;
    }
    radiance * (-optics.sigma_t * hit.distance).exp()
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
