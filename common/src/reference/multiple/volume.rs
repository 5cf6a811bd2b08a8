//! What a path goes through: a homogeneous medium without end, or a cloud.

use std::f64::consts::PI;

use glam::DVec3;

use super::random::Random;
use crate::{Cloud, Density, Medium, Phase};

/// What scatters.
#[derive(Clone, Copy)]
pub(super) enum Volume<'a> {
    Endless(&'a Medium),
    Cloud(&'a Cloud),
}

/// `exp(−σ x)`, 1 for no extinction however far.
fn transmitted(sigma: DVec3, x: f64) -> DVec3 {
    DVec3::from_array(sigma.to_array().map(|sigma| if sigma == 0.0 { 1.0 } else { (-sigma * x).exp() }))
}

/// Shares of the colours; alike if there is nothing.
fn shares(weights: DVec3) -> DVec3 {
    let sum = weights.element_sum();
    if sum > 0.0 { weights / sum } else { DVec3::splat(1.0 / 3.0) }
}

/// Density times length over [0, `end`] of a ray, where there is a closed form.
fn column(density: &Density, [origin, direction]: [DVec3; 2], end: f64) -> Option<f64> {
    let within = |density: &Density| {
        density.span(origin, direction).map_or(0.0, |[from, to]| (to.min(end) - from).max(0.0))
    };
    match density {
        Density::Slab { .. } | Density::Sphere { .. } => Some(within(density)),
        Density::TwoDensity { centre, core, shell, .. } => {
            let core = within(&Density::Sphere { centre: *centre, radius: *core });
            let shell = f64::from(*shell);
            Some(shell * within(density) + (1.0 - shell) * core)
        }
        Density::Cumulus(_) | Density::Grid(_) => None,
    }
}

impl Volume<'_> {
    pub(super) fn phase(&self) -> &Phase {
        match self {
            Self::Endless(medium) => &medium.phase,
            Self::Cloud(cloud) => &cloud.phase,
        }
    }

    pub(super) fn is_endless(&self) -> bool {
        matches!(self, Self::Endless(_))
    }

    pub(super) fn is_vacuum(&self) -> bool {
        match self {
            Self::Endless(medium) => medium.sigma_t() == glam::Vec3::ZERO,
            Self::Cloud(cloud) => cloud.sigma_t == 0.0,
        }
    }

    /// Whether [`Volume::transmittance`] takes no chances.
    pub(super) fn is_exact(&self) -> bool {
        match self {
            Self::Endless(_) => true,
            Self::Cloud(cloud) => !matches!(cloud.density, Density::Cumulus(_) | Density::Grid(_)),
        }
    }

    pub(super) fn albedo(&self) -> DVec3 {
        match self {
            Self::Endless(medium) => {
                let (sigma_s, sigma_t) = (medium.sigma_s.as_dvec3(), self.extinction(DVec3::ZERO));
                DVec3::select(sigma_t.cmpgt(DVec3::ZERO), sigma_s / sigma_t, DVec3::ZERO)
            }
            Self::Cloud(cloud) => cloud.albedo.as_dvec3(),
        }
    }

    /// Radiance that a collision stands for by emission: emission over extinction.
    pub(super) fn emitted(&self) -> DVec3 {
        match self {
            Self::Endless(_) => DVec3::ZERO,
            Self::Cloud(cloud) => cloud.emission.as_dvec3() / f64::from(cloud.sigma_t),
        }
    }

    /// Extinction coefficient at a point \[1/m\].
    pub(super) fn extinction(&self, point: DVec3) -> DVec3 {
        match self {
            // The sum in f64: the f32 sum of the medium's own method would be rounded.
            Self::Endless(medium) => medium.sigma_s.as_dvec3() + medium.sigma_a.as_dvec3(),
            Self::Cloud(cloud) => DVec3::splat(f64::from(cloud.sigma_t) * cloud.density.at(point)),
        }
    }

    /// The part of [0, `end`] of a ray in which there is something.
    pub(super) fn range(&self, [origin, direction]: [DVec3; 2], end: f64) -> Option<[f64; 2]> {
        match self {
            Self::Endless(_) => Some([0.0, end]),
            Self::Cloud(cloud) => {
                let [from, to] = cloud.density.span(origin, direction)?;
                (from < to.min(end)).then_some([from, to.min(end)])
            }
        }
    }

    /// Most collisions that a path over `length` \[m\] has on average; endless in a medium without end.
    pub(super) fn most_collisions(&self, length: f64) -> f64 {
        match self {
            Self::Endless(_) => f64::INFINITY,
            Self::Cloud(cloud) => f64::from(cloud.sigma_t) * length,
        }
    }

    /// Goes along a ray until it collides before `end` or not: the distance, and what the throughput is to
    /// be multiplied by. The colour that decides is one by the throughput's shares.
    pub(super) fn step(
        &self,
        ray: [DVec3; 2],
        end: f64,
        throughput: DVec3,
        random: &mut Random,
    ) -> (Option<f64>, DVec3) {
        match self {
            Self::Endless(_) => {
                let (sigma, share) = (self.extinction(ray[0]), shares(throughput));
                let colour = random.choose(&share.to_array());
                let x = random.free_path() / sigma[colour];
                if x < end {
                    let reached = sigma * transmitted(sigma, x);
                    (Some(x), reached / share.dot(reached))
                } else {
                    let reached = transmitted(sigma, end);
                    (None, reached / share.dot(reached))
                }
            }
            Self::Cloud(cloud) => {
                // Delta tracking (Woodcock et al. 1965).
                let Some([mut x, to]) = self.range(ray, end) else { return (None, DVec3::ONE) };
                let mean_free_path = 1.0 / f64::from(cloud.sigma_t);
                loop {
                    x += random.free_path() * mean_free_path;
                    if x >= to {
                        return (None, DVec3::ONE);
                    }
                    let density = cloud.density.at(ray[0] + x * ray[1]);
                    if density >= 1.0 || random.next() < density {
                        return (Some(x), DVec3::ONE);
                    }
                }
            }
        }
    }

    /// How densely [`Volume::step`] collides at distance `x` \[1/m\]; where there is no closed form of it,
    /// something like it: it only weights.
    pub(super) fn collisions(&self, ray: [DVec3; 2], x: f64, throughput: DVec3) -> f64 {
        match self {
            Self::Endless(_) => {
                let sigma = self.extinction(ray[0]);
                shares(throughput).dot(sigma * transmitted(sigma, x))
            }
            Self::Cloud(cloud) => {
                let sigma = f64::from(cloud.sigma_t);
                let column = column(&cloud.density, ray, x)
                    .unwrap_or_else(|| self.range(ray, x).map_or(0.0, |[from, to]| 0.5 * (to - from)));
                self.extinction(ray[0] + x * ray[1]).x * (-sigma * column).exp()
            }
        }
    }

    /// Transmittance of [0, `end`] of a ray: exact, or by chance and right on average.
    pub(super) fn transmittance(&self, ray: [DVec3; 2], end: f64, random: &mut Random) -> DVec3 {
        match self {
            Self::Endless(_) => transmitted(self.extinction(ray[0]), end),
            Self::Cloud(cloud) => {
                let sigma = f64::from(cloud.sigma_t);
                if let Some(column) = column(&cloud.density, ray, end) {
                    return DVec3::splat(if sigma == 0.0 { 1.0 } else { (-sigma * column).exp() });
                }
                let Some([mut x, to]) = self.range(ray, end) else { return DVec3::ONE };
                // Ratio tracking (Novák et al. 2014), with roulette where little is left.
                let mut left = 1.0;
                loop {
                    x += random.free_path() / sigma;
                    if x >= to {
                        return DVec3::splat(left);
                    }
                    left *= 1.0 - cloud.density.at(ray[0] + x * ray[1]);
                    if left < 0.1 {
                        if random.next() >= 0.5 || left == 0.0 {
                            return DVec3::ZERO;
                        }
                        left *= 2.0;
                    }
                }
            }
        }
    }

    /// What is left of light on its way over `distance` to a ray's origin. Light from infinitely far away
    /// is not attenuated by a medium without end.
    pub(super) fn light_left(&self, ray: [DVec3; 2], distance: f64, random: &mut Random) -> DVec3 {
        if self.is_endless() && distance == f64::INFINITY {
            return DVec3::ONE;
        }
        self.transmittance(ray, distance, random)
    }

    /// A direction after scattering, and what the throughput is to be multiplied by.
    pub(super) fn scatter(&self, direction: DVec3, throughput: DVec3, random: &mut Random) -> (DVec3, DVec3) {
        let phase = self.phase();
        let (cos, weight) = if let [(_, lobe)] = &phase.lobes[..] {
            (lobe.sample_cosine(&mut || random.next()), DVec3::ONE)
        } else {
            // A lobe by what the colours that are left want of it.
            let share = shares(throughput);
            let wanted: Vec<f64> =
                phase.lobes.iter().map(|(weight, _)| share.dot(weight.as_dvec3())).collect();
            let lobe = &phase.lobes[random.choose(&wanted)].1;
            let cos = lobe.sample_cosine(&mut || random.next());
            let density: f64 =
                phase.lobes.iter().zip(&wanted).map(|((_, lobe), wanted)| wanted * lobe.eval(cos)).sum();
            (cos, phase.eval(cos) * wanted.iter().sum::<f64>() / density)
        };
        let (x, y) = direction.any_orthonormal_pair();
        let (sin_azimuth, cos_azimuth) = (2.0 * PI * random.next()).sin_cos();
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        ((cos * direction + sin * (cos_azimuth * x + sin_azimuth * y)).normalize(), weight)
    }
}
