//! Light that leaves a cloud, by paths from the light.

use std::f64::consts::PI;

use glam::DVec3;
use rayon::prelude::*;

use super::super::Error;
use super::super::source::Source;
use super::path::roulette;
use super::random::Random;
use super::volume::Volume;
use super::{Estimate, Sum};
use crate::{Cloud, Light, Scene};

/// Where the light goes that meets a cloud: powers \[W\] from [`scattered_power`], shares from [`beam`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Escape {
    /// What meets the density's bounds.
    pub incident: Estimate,
    /// What leaves without having been scattered.
    pub unscattered: Estimate,
    /// What leaves after one scattering or more.
    pub scattered: Estimate,
    /// The part of it that leaves towards +y.
    pub upwards: Estimate,
    /// The part of it that leaves towards −y.
    pub downwards: Estimate,
}

#[derive(Clone, Copy, Default)]
struct Sums {
    incident: Sum,
    unscattered: Sum,
    upwards: Sum,
    downwards: Sum,
    scattered: Sum,
}

/// Paths that one piece of work follows.
const BATCH: u32 = 4096;

/// What becomes of the light of one ray that meets a cloud, by `samples` paths: parts of it, 1 is all of it. Lengths
/// in metres; `direction` need not be of unit length.
///
/// # Errors
/// [`Error::Scene`], for a cloud that has something wrong with it.
pub fn beam(
    cloud: &Cloud,
    origin: DVec3,
    direction: DVec3,
    samples: u32,
    seed: u64,
) -> Result<Escape, Error> {
    check(cloud)?;
    let direction = direction.normalize();
    Ok(follow(cloud, samples, seed, |_| (origin, direction, DVec3::ONE)))
}

/// Power \[W\] of the scene's lights that meets its cloud, and where it goes. Surfaces, the sky and emission
/// do not count.
///
/// # Errors
/// [`Error::Scene`], without a cloud or a light, and for directional light on a cloud without end.
pub fn scattered_power(scene: &Scene, samples: u32, seed: u64) -> Result<Escape, Error> {
    if let Some(problem) = scene.problem() {
        return Err(Error::Scene(problem));
    }
    let Some(cloud) = &scene.cloud else {
        return Err(Error::Scene("there is no cloud in the scene that could scatter light".into()));
    };
    check(cloud)?;
    let (low, high) = cloud.density.bounds();
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let parallel = scene.lights.iter().any(|light| matches!(light, Light::Directional(_)));
    if parallel && !(high - low).is_finite() {
        return Err(Error::Scene(
            "the power of directional light on a slab is infinite; choose a cloud with an end".into(),
        ));
    }
    let centre = 0.5 * (low + high);
    // Half the diagonal; of a round cloud its radius.
    let radius = match &cloud.density {
        crate::Density::Sphere { radius, .. } | crate::Density::TwoDensity { radius, .. } => {
            f64::from(*radius)
        }
        _ => 0.5 * (high - low).length(),
    };
    let sources: Vec<Source> = scene.lights.iter().map(Source::new).collect();
    let count = sources.len() as f64;
    if sources.is_empty() {
        return Err(Error::Scene("there is no light in the scene whose power could be scattered".into()));
    }
    // The lights take turns by chance, so each counts for all of them.
    Ok(follow(cloud, samples, seed, |random| {
        let at = [random.next(), random.next()];
        match &sources[((random.next() * count) as usize).min(sources.len() - 1)] {
            Source::Directional { direction, irradiance } => {
                let (x, y) = direction.any_orthonormal_pair();
                let (sin, cos) = (2.0 * PI * at[1]).sin_cos();
                let off = radius * at[0].sqrt();
                let origin = centre - 2.0 * radius * *direction + off * (cos * x + sin * y);
                (origin, *direction, *irradiance * (count * PI * radius * radius))
            }
            Source::Point { position, intensity } => {
                let direction = towards(DVec3::Z, -1.0, at);
                (*position, direction, *intensity * (count * 4.0 * PI))
            }
            Source::Spot(spot) => {
                let cone = spot.cone();
                let direction = towards(cone.axis, cone.angle.cos(), at);
                let solid_angle = 2.0 * PI * (1.0 - cone.angle.cos());
                (spot.position, direction, spot.intensity_towards(direction) * (count * solid_angle))
            }
        }
    }))
}

fn check(cloud: &Cloud) -> Result<(), Error> {
    cloud.problem().map_or(Ok(()), |problem| Err(Error::Scene(format!("the cloud {problem}"))))
}

/// A direction in a cone.
fn towards(axis: DVec3, cos_angle: f64, [u, v]: [f64; 2]) -> DVec3 {
    let cos = 1.0 - u * (1.0 - cos_angle);
    let (x, y) = axis.any_orthonormal_pair();
    let (sin_azimuth, cos_azimuth) = (2.0 * PI * v).sin_cos();
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    (cos * axis + sin * (cos_azimuth * x + sin_azimuth * y)).normalize()
}

fn follow(
    cloud: &Cloud,
    samples: u32,
    seed: u64,
    emit: impl Fn(&mut Random) -> (DVec3, DVec3, DVec3) + Sync,
) -> Escape {
    let batches: Vec<Sums> = (0..samples.max(1).div_ceil(BATCH))
        .into_par_iter()
        .map(|batch| {
            let mut random = Random::new(seed, u64::from(batch));
            let mut sums = Sums::default();
            for _ in 0..BATCH.min(samples.max(1) - batch * BATCH) {
                let (origin, direction, power) = emit(&mut random);
                walk(cloud, [origin, direction], power, &mut random, &mut sums);
            }
            sums
        })
        .collect();
    // In order, so that the sums have the same bits every time.
    let total = |of: fn(&Sums) -> Sum| batches.iter().map(of).fold(Sum::default(), Sum::plus).estimate();
    Escape {
        incident: total(|sums| sums.incident),
        unscattered: total(|sums| sums.unscattered),
        scattered: total(|sums| sums.scattered),
        upwards: total(|sums| sums.upwards),
        downwards: total(|sums| sums.downwards),
    }
}

fn walk(cloud: &Cloud, mut ray: [DVec3; 2], power: DVec3, random: &mut Random, sums: &mut Sums) {
    let volume = Volume::Cloud(cloud);
    let meets = cloud.density.span(ray[0], ray[1]).is_some();
    let incident = if meets { power } else { DVec3::ZERO };
    let (mut throughput, mut scattered) = (DVec3::ONE, false);
    let mut alive = meets;
    while alive && !volume.is_vacuum() {
        let (Some(x), _) = volume.step(ray, f64::INFINITY, throughput, random) else { break };
        throughput *= volume.albedo();
        let (direction, factor) = volume.scatter(ray[1], throughput, random);
        throughput *= factor;
        ray = [ray[0] + x * ray[1], direction];
        scattered = true;
        alive = roulette(&mut throughput, random);
    }
    let left = if alive { incident * throughput } else { DVec3::ZERO };
    let part = |wanted: bool| if wanted { left } else { DVec3::ZERO };
    sums.incident.add(incident);
    sums.unscattered.add(part(!scattered));
    sums.scattered.add(part(scattered));
    sums.upwards.add(part(scattered && ray[1].y > 0.0));
    sums.downwards.add(part(scattered && ray[1].y <= 0.0));
}
