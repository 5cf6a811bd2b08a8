//! The reference's second method: lit intervals from shadow rays.
//!
//! A ray is divided into strata, of equal angle at a point light and of equal transmittance for a
//! directional one; a shadow ray starts somewhere in each. Where two neighbours see the light
//! differently, the change between them is bisected. The number of strata is doubled until the
//! two methods agree or the limit is reached. What lies wholly between two shadow rays is missed,
//! and that is nearly all of what remains: the difference from the exact intervals is a bound for
//! their error rather than the error. (With the limit it falls on and on.)

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::source::{Source, nearest};
use super::{Error, Pixel, Rays, Reference, Scratch};
use crate::airlight::LightFromRay;
use crate::random::unit;

/// What the check found.
pub(super) struct Check {
    /// RMS difference of the two methods over the checked rays, relative to their mean airlight.
    pub(super) difference: f64,
    pub(super) rays: u32,
}

/// Strata to begin with.
const COARSEST: u32 = 128;

/// Difference, relative to the picture's mean airlight, below which a ray's methods agree.
const AGREED: f64 = 1e-5;

/// Compares the scan with the picture on a stratified choice of rays, the same every time.
pub(super) fn check(
    reference: &Reference,
    rays: &Rays,
    rows: &[Vec<Pixel>],
    cancel: &AtomicBool,
) -> Result<Check, Error> {
    let choice = choose(rays, reference.options.checked_rays);
    let pixels = rows.iter().flatten().filter(|pixel| pixel.airlight != DVec3::ZERO);
    let (sum, lit) = pixels.fold((0.0, 0.0), |(sum, n), p| (sum + p.airlight.element_sum() / 3.0, n + 1.0));
    let agreed = AGREED * sum / f64::max(lit, 1.0);
    let count = choice.len() as f64;
    let sums = choice
        .par_iter()
        .enumerate()
        .map_init(
            || reference.scratch(),
            |scratch, (index, &[x, y])| {
                if cancel.load(Ordering::Relaxed) {
                    return Err(Error::Cancelled);
                }
                let exact = rows[y as usize][x as usize].airlight;
                let ray = rays.through(x, y);
                let mut count = COARSEST.min(reference.options.scan_limit.max(1));
                let error = loop {
                    let error = airlight(reference, ray, count, index as u64, scratch) - exact;
                    let finished = error.abs().max_element() <= agreed;
                    if finished || count.saturating_mul(2) > reference.options.scan_limit {
                        break error;
                    }
                    count *= 2;
                };
                Ok([error.length_squared() / 3.0, exact.element_sum() / 3.0])
            },
        )
        .collect::<Result<Vec<_>, _>>()?;
    // Only lit rays make up the mean.
    let lit = sums.iter().filter(|sum| sum[1] > 0.0).count().max(1) as f64;
    let rms = (sums.iter().map(|sum| sum[0]).sum::<f64>() / count.min(lit)).sqrt();
    let mean = sums.iter().map(|sum| sum[1]).sum::<f64>() / lit;
    let difference = if rms == 0.0 { 0.0 } else { rms / mean };
    Ok(Check { difference, rays: choice.len() as u32 })
}

/// About `wanted` pixels, one somewhere in each of as many cells that are about square.
pub(super) fn choose(rays: &Rays, wanted: u32) -> Vec<[u32; 2]> {
    let wanted = f64::from(wanted.max(1));
    let cell = (f64::from(rays.width) * f64::from(rays.height) / wanted).sqrt().max(1.0);
    let columns = (f64::from(rays.width) / cell).ceil() as u32;
    let lines = (f64::from(rays.height) / cell).ceil() as u32;
    let place = |index: u32, count: u32, size: u32, random: f64| {
        let at = (f64::from(index) + random) / f64::from(count) * f64::from(size);
        (at as u32).min(size - 1)
    };
    let pixel = |index: u32| {
        let random = |k: u64| unit(u64::from(index) * 4 + k);
        let x = place(index % columns, columns, rays.width, random(0));
        [x, place(index / columns, lines, rays.height, random(1))]
    };
    (0..columns * lines).map(pixel).collect()
}

/// Airlight on one ray from `count` strata per light.
fn airlight(reference: &Reference, ray: [DVec3; 2], count: u32, seed: u64, scratch: &mut Scratch) -> DVec3 {
    let optics = reference.optics();
    if optics.sigma_s == DVec3::ZERO {
        return DVec3::ZERO;
    }
    let [eye, direction] = ray;
    let hit = reference.geometry.nearest(&mut scratch.stack, eye, direction, [0.0, f64::INFINITY]);
    let end = hit.map_or(f64::INFINITY, |hit| hit.distance);
    reference
        .sources
        .iter()
        .map(|source| {
            let strata = Strata::new(source, ray, end, optics.sigma_t);
            lit_intervals(reference, source, ray, &strata, count, seed, scratch);
            source.integrate(&optics, ray, &scratch.lit, reference.options.tolerance)
        })
        .sum()
}

/// Fills `scratch.lit` from `count` shadow rays.
fn lit_intervals(
    reference: &Reference,
    source: &Source,
    ray: [DVec3; 2],
    strata: &Strata,
    count: u32,
    seed: u64,
    scratch: &mut Scratch,
) {
    let Scratch { stack, lit, .. } = scratch;
    lit.clear();
    let mut sees = |s: f64| {
        let point = ray[0] + strata.distance(s) * ray[1];
        let arrival = source.arrival(point);
        arrival.irradiance != DVec3::ZERO
            && !reference.geometry.occluded(stack, point, arrival.to_light, [0.0, arrival.distance])
    };
    let mut last: Option<(f64, bool)> = None;
    let mut open = None;
    for stratum in 0..count {
        let random = unit((seed << 32) ^ (u64::from(count) << 16) ^ u64::from(stratum));
        let at = (f64::from(stratum) + random) / f64::from(count);
        let now = sees(at);
        if let Some((before, seen)) = last
            && seen != now
        {
            let (mut a, mut b) = (before, at);
            for _ in 0..45 {
                let middle = 0.5 * (a + b);
                if sees(middle) == seen { a = middle } else { b = middle }
            }
            let change = strata.distance(0.5 * (a + b));
            if let Some(start) = open.take() {
                lit.push([start, change]);
            } else {
                open = Some(change);
            }
        } else if last.is_none() && now {
            open = Some(strata.distance(0.0));
        }
        last = Some((at, now));
    }
    if let Some(start) = open {
        lit.push([start, strata.distance(1.0)]);
    }
}

/// How [0, 1] is laid along a ray.
enum Strata {
    /// Evenly in the angle at the light.
    Angle { t: f64, h: f64, from: f64, to: f64, end: f64 },
    /// Evenly in exp(−σ x), or in x where there is no extinction.
    Transmittance { sigma: f64, end: f64 },
}

impl Strata {
    fn new(source: &Source, [eye, direction]: [DVec3; 2], end: f64, sigma_t: DVec3) -> Self {
        let position = match source {
            Source::Point { position, .. } => *position,
            Source::Spot(spot) => spot.position,
            Source::Directional { .. } => {
                let sigma = sigma_t.to_array().into_iter().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
                return Self::Transmittance { sigma: if sigma.is_finite() { sigma } else { 0.0 }, end };
            }
        };
        let light = LightFromRay::new(eye, direction, position);
        let (t, h) = (light.t, light.h.max(nearest(&light)));
        Self::Angle { t, h, from: (-t).atan2(h), to: (end - t).atan2(h), end }
    }

    /// Distance along the ray \[m\] at `s` in [0, 1].
    fn distance(&self, s: f64) -> f64 {
        match *self {
            Self::Angle { end, .. } | Self::Transmittance { end, .. } if s >= 1.0 => end,
            Self::Angle { t, h, from, to, end } => {
                (t + h * (from + s * (to - from)).tan()).clamp(0.0, end.min(1e12))
            }
            Self::Transmittance { sigma, end } if sigma > 0.0 => {
                (-(s * (-sigma * end).exp_m1()).ln_1p() / sigma).clamp(0.0, end.min(1e12))
            }
            Self::Transmittance { end, .. } => s * end.min(1e12),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{Light, Lobe, Medium, PointLight, Scene, Term};

    /// The judge of the judge can fail: a picture that is 10 % too bright is 10 % off.
    #[test]
    fn a_wrong_picture_is_found_out() {
        let mut scene = Scene::empty("test");
        scene.medium = Medium::grey(0.3, 0.8, Lobe::Rayleigh.into());
        scene.lights = vec![Light::Point(PointLight { position: Vec3::Y, intensity: Vec3::ONE })];
        let reference = Reference::new(&scene).unwrap();
        let rays = Rays::new(&scene.camera.view(20, 20));
        let difference = |factor: f64| {
            let pixel = |x, y| {
                let (ray, terms) = (rays.through(x, y), Term::Airlight.into());
                let right = reference.pixel(ray, terms, None, 0, &mut reference.scratch());
                Pixel { airlight: factor * right.airlight, ..right }
            };
            let rows: Vec<Vec<Pixel>> = (0..20).map(|y| (0..20).map(|x| pixel(x, y)).collect()).collect();
            check(&reference, &rays, &rows, &AtomicBool::new(false)).unwrap().difference
        };
        assert!(difference(1.0) < 1e-6, "{}", difference(1.0));
        assert!(difference(1.1) > 0.09, "{}", difference(1.1));
    }
}
