//! Light that the medium scatters once and that then lights the surface that is seen.
//!
//! The exact model integrates the airlight that arrives at the surface over directions. Towards a light
//! the airlight grows as one over the angle from it, so directions are laid out in rings about the way
//! to the light, evenly in that angle and in the azimuth of what lies above the surface and, of a spot,
//! in its cone: in these coordinates the integrand is bounded. A glossy surface has directions about
//! the mirrored eye direction too, and each direction is weighted by how often all sets together take
//! it (Veach and Guibas 1995). A set is a lattice, shifted from pixel to pixel.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::fan::{Fan, Lattice};
use super::scan::choose;
use super::source::Source;
use super::surface::Place;
use super::{Error, Pixel, Rays, Reference, Scratch};
use crate::airlight::Optics;
use crate::indirect::{ParallelTable, Table};
use crate::scene::Material;
use crate::{Lobe, Phase};

/// How indirect airlight is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IndirectModel {
    /// With all surfaces and shadows.
    Exact {
        /// Directions per pixel and light.
        directions: u32,
    },
    /// As if the medium around the point that is seen had no bounds and nothing cast a shadow. Gloss
    /// counts every direction of the lobe's own hemisphere, with the cosine of the mirrored eye
    /// direction. There are no spots in it.
    Unbounded,
}

impl Default for IndirectModel {
    fn default() -> Self {
        Self::Exact { directions: 512 }
    }
}

/// Relative tolerance of the airlight in one direction: well below what the directions leave.
const TOLERANCE: f64 = 1e-4;

/// At most so many times as many directions are tried to find what ends nowhere.
const OPENINGS: f64 = 16.0;

/// Compares pixels of the picture with the same pixels by other directions: the RMS difference,
/// relative to the mean.
pub(super) fn check(
    reference: &Reference,
    rays: &Rays,
    rows: &[Vec<Pixel>],
    cancel: &AtomicBool,
) -> Result<f64, Error> {
    let pairs = choose(rays, reference.options.checked_rays)
        .into_par_iter()
        .map_init(
            || reference.scratch(),
            |scratch, [x, y]| {
                if cancel.load(Ordering::Relaxed) {
                    return Err(Error::Cancelled);
                }
                let first = rows[y as usize][x as usize].indirect;
                let pattern = reference.pattern(rays, [x, y], 1);
                let terms = crate::Term::IndirectAirlight.into();
                let second = reference.pixel(rays.through(x, y), terms, None, pattern, scratch).indirect;
                Ok([(second - first).length_squared() / 3.0, first.element_sum() / 3.0])
            },
        )
        .collect::<Result<Vec<_>, _>>()?;
    // Only lit pixels count; elsewhere there is nothing to be wrong about.
    let lit = pairs.iter().filter(|pair| pair[1] > 0.0 || pair[0] > 0.0).count().max(1) as f64;
    let [squares, sum] = pairs.iter().fold([0.0; 2], |[a, b], pair| [a + pair[0], b + pair[1]]);
    let difference = if squares == 0.0 { 0.0 } else { (squares / lit).sqrt() / (sum / lit) };
    Ok(difference.max(TOLERANCE))
}

impl Reference {
    /// What the shift of a pixel's lattices depends on; `set` tells its sets of directions apart.
    pub(super) fn pattern(&self, rays: &Rays, [x, y]: [u32; 2], set: u64) -> u64 {
        let pixel = u64::from(y) * u64::from(rays.width) + u64::from(x);
        // Some bits are left free for those who count on from here.
        (self.options.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ ((pixel << 1 | set) << 10)) >> 2
    }

    /// Airlight that the surface reflects to the eye \[W m⁻² sr⁻¹\], before it is attenuated on the
    /// way: the exact model.
    pub(super) fn indirect(
        &self,
        place: &Place,
        directions: u32,
        pattern: u64,
        scratch: &mut Scratch,
    ) -> DVec3 {
        let Place { k_d, k_s, .. } = *place;
        let (diffuse, glossy) = (k_d.max_element(), k_s.max_element());
        if diffuse <= 0.0 && glossy <= 0.0 {
            return DVec3::ZERO;
        }
        // Of all directions, those about the mirrored one.
        let share = (glossy / (diffuse + glossy)).min(0.5);
        let directions = f64::from(directions.max(1));
        let mirrored = (share * directions).floor();
        let count = directions - mirrored;
        let fans: Vec<Option<Fan>> = self.sources.iter().map(|source| Fan::new(source, place)).collect();
        // Directions per solid angle of both sets.
        let density = |fan: &Fan, direction: DVec3| {
            mirrored * lobe_density(place, direction) + count * fan.density(direction)
        };
        let mut radiance = DVec3::ZERO;
        for (index, (source, fan)) in self.sources.iter().zip(&fans).enumerate() {
            let Some(fan) = fan else { continue };
            let mut sum = |lattice: Lattice, wanted: fn(f64) -> bool| {
                let (mut sum, mut found) = (DVec3::ZERO, 0.0);
                for direction in lattice.filter_map(|at| fan.direction(at)) {
                    let Some(weight) = weight(place, direction) else { continue };
                    let end = self.end(place, direction, scratch);
                    found += f64::from(end == f64::INFINITY);
                    if wanted(end) {
                        let seen = self.arriving(source, place, direction, end, scratch);
                        sum += weight * seen / density(fan, direction);
                    }
                }
                (sum, found)
            };
            let pattern = pattern + 4 * index as u64;
            let lattice = Lattice::new(count as u32, pattern + 1);
            if !matches!(source, Source::Directional { .. }) {
                radiance += sum(lattice, |_| true).0;
                continue;
            }
            // Out of doors the sun lights the medium without end, so that an opening may outshine all
            // else: as many directions that end nowhere as directions that end on a surface.
            let (ending, found) = sum(lattice, f64::is_finite);
            let more = (count / f64::max(found, 1.0)).clamp(1.0, OPENINGS).floor();
            let (endless, _) = sum(Lattice::new((more * count) as u32, pattern + 2), f64::is_infinite);
            radiance += ending + endless / more;
        }
        for at in Lattice::new(mirrored as u32, pattern) {
            let direction = lobe_direction(place, at);
            let Some(weight) = weight(place, direction) else { continue };
            let end = self.end(place, direction, scratch);
            for (source, fan) in self.sources.iter().zip(&fans) {
                // Outside of its fan a light has nothing to send.
                if let Some(fan) = fan.as_ref().filter(|fan| fan.density(direction) > 0.0) {
                    let seen = self.arriving(source, place, direction, end, scratch);
                    radiance += weight * seen / density(fan, direction);
                }
            }
        }
        radiance
    }

    /// Distance from a place to the next surface \[m\].
    fn end(&self, place: &Place, direction: DVec3, scratch: &mut Scratch) -> f64 {
        let hit = self.geometry.nearest(&mut scratch.stack, place.lifted(), direction, [0.0, f64::INFINITY]);
        hit.map_or(f64::INFINITY, |hit| hit.distance)
    }

    /// Airlight that arrives at a place from a direction \[W m⁻² sr⁻¹\].
    fn arriving(
        &self,
        source: &Source,
        place: &Place,
        direction: DVec3,
        end: f64,
        scratch: &mut Scratch,
    ) -> DVec3 {
        let (ray, tolerance) = ([place.lifted(), direction], self.options.tolerance.max(TOLERANCE));
        source.airlight(&self.geometry, &self.optics(), ray, end, tolerance, scratch)
    }
}

/// What a direction counts: the reflectance function times the cosine; `None` below the surface.
pub(super) fn weight(place: &Place, direction: DVec3) -> Option<DVec3> {
    let cos = place.shading.dot(direction);
    (cos > 0.0 && place.flat.dot(direction) > 0.0).then(|| place.reflected(direction) * cos)
}

/// Directions about the mirrored one, as dense as the gloss.
pub(super) fn lobe_direction(place: &Place, [u, v]: [f64; 2]) -> DVec3 {
    let cos = (1.0 - u).powf(1.0 / (place.exponent + 1.0));
    let (x, y) = place.mirrored.any_orthonormal_pair();
    let (sin_azimuth, cos_azimuth) = (2.0 * PI * v).sin_cos();
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    (cos * place.mirrored + sin * (cos_azimuth * x + sin_azimuth * y)).normalize()
}

/// Directions per solid angle of [`lobe_direction`].
pub(super) fn lobe_density(place: &Place, direction: DVec3) -> f64 {
    let cos = place.mirrored.dot(direction).max(0.0);
    (place.exponent + 1.0) / (2.0 * PI) * cos.powf(place.exponent)
}

/// Tables of the unbounded model.
pub(super) struct Unbounded {
    /// Colour weights of the phase function's lobes.
    weights: Vec<DVec3>,
    /// Tables by exponent, one for each lobe.
    point: Vec<(f64, Vec<Table>)>,
    parallel: Vec<(f64, Vec<ParallelTable>)>,
}

impl Unbounded {
    pub(super) fn new(sources: &[Source], materials: &[Material], phase: &Phase) -> Result<Self, Error> {
        if sources.iter().any(|source| matches!(source, Source::Spot(_))) {
            return Err(Error::Scene(
                "the unbounded model of indirect airlight has no spots, and there is one in the scene".into(),
            ));
        }
        let mut exponents = vec![1.0];
        let glossy = materials.iter().filter(|material| material.k_s.max_element() > 0.0);
        exponents.extend(glossy.map(|material| f64::from(material.exponent)));
        exponents.sort_by(f64::total_cmp);
        exponents.dedup();
        let any = |parallel: bool| {
            sources.iter().any(|source| matches!(source, Source::Directional { .. }) == parallel)
        };
        Ok(Self {
            weights: phase.lobes.iter().map(|(weight, _)| weight.as_dvec3()).collect(),
            point: tables(&exponents, phase, any(false), Table::new),
            parallel: tables(&exponents, phase, any(true), ParallelTable::new),
        })
    }

    /// Airlight that the surface reflects to the eye \[W m⁻² sr⁻¹\], before it is attenuated on the way.
    pub(super) fn reflected(&self, sources: &[Source], optics: &Optics, place: &Place) -> DVec3 {
        let gloss = place.k_s * ((place.exponent + 2.0) / (2.0 * PI) * place.shading.dot(place.mirrored));
        let mut radiance = DVec3::ZERO;
        for source in sources {
            let mut received =
                place.k_d / PI * self.received(source, optics, place.point, place.shading, 1.0);
            if place.k_s.max_element() > 0.0 {
                received +=
                    gloss * self.received(source, optics, place.point, place.mirrored, place.exponent);
            }
            radiance += received;
        }
        radiance
    }

    /// The radiance around a point, weighted by a power of the cosine about an axis \[W/m²\].
    fn received(&self, source: &Source, optics: &Optics, point: DVec3, axis: DVec3, exponent: f64) -> DVec3 {
        let arrival = source.arrival(point);
        // The angle between two unit directions, exact where it is small.
        let angle = axis.cross(arrival.to_light).length().atan2(axis.dot(arrival.to_light));
        let Optics { sigma_t, sigma_s, .. } = *optics;
        match source {
            Source::Directional { irradiance, .. } => {
                let values = of(&self.parallel, exponent).iter().map(|table| table.eval(angle));
                let sum: DVec3 = self.weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
                let albedo = DVec3::select(sigma_s.cmpgt(DVec3::ZERO), sigma_s / sigma_t, DVec3::ZERO);
                *irradiance * albedo * sum
            }
            _ => {
                let distance = arrival.distance.max(f64::MIN_POSITIVE);
                let values = of(&self.point, exponent).iter().map(|table| {
                    DVec3::from_array((sigma_t * distance).to_array().map(|lam| table.eval(lam, angle)))
                });
                let sum: DVec3 = self.weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
                // The intensity is the irradiance times the squared distance.
                arrival.irradiance * distance * sigma_s / (4.0 * PI) * sum
            }
        }
    }
}

fn tables<T>(
    exponents: &[f64],
    phase: &Phase,
    wanted: bool,
    new: impl Fn(Lobe, f64) -> T,
) -> Vec<(f64, Vec<T>)> {
    let of =
        |exponent: &f64| (*exponent, phase.lobes.iter().map(|(_, lobe)| new(*lobe, *exponent)).collect());
    if wanted { exponents.iter().map(of).collect() } else { Vec::new() }
}

fn of<T>(tables: &[(f64, Vec<T>)], exponent: f64) -> &[T] {
    tables.iter().find(|(known, _)| *known == exponent).map_or(&[], |(_, tables)| tables)
}
