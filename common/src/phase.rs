//! Phase functions \[1/sr\]: all integrate to 1 over the sphere.
//!
//! `cos_theta` is the cosine between the propagation directions before and after scattering: +1 is
//! forward. (Biri's and Nishita's phase functions are 4π times these.)

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

/// One phase function of a single parameter at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lobe {
    /// `1/4π`.
    Isotropic,
    /// `3/16π (1 + c²)`: particles much smaller than the wavelength.
    Rayleigh,
    /// Henyey and Greenstein 1941; its mean cosine is `g` in (−1, 1).
    HenyeyGreenstein {
        /// Asymmetry: the mean cosine.
        g: f64,
    },
    /// Cornette and Shanks 1992, which Szirmay-Kalos et al. 2005 print. Its mean cosine is
    /// `3g(4+g²)/(5(2+g²))`, not `g`; at `g = 0` it is Rayleigh's.
    CornetteShanks {
        /// Asymmetry parameter in (−1, 1).
        g: f64,
    },
    /// Nishita et al. 1987, hazy atmosphere: `∝ 1 + 9 ((1+c)/2)⁸`.
    MieHazy,
    /// Nishita et al. 1987, murky atmosphere: `∝ 1 + 50 ((1+c)/2)³²`.
    MieMurky,
}

impl Lobe {
    /// The value at `cos_theta` \[1/sr\].
    pub fn eval(&self, cos_theta: f64) -> f64 {
        let c = cos_theta;
        match *self {
            Self::Isotropic => 1.0 / (4.0 * PI),
            Self::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + c * c),
            Self::HenyeyGreenstein { g } => {
                (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * c).powf(1.5))
            }
            Self::CornetteShanks { g } => {
                3.0 * (1.0 - g * g) * (1.0 + c * c)
                    / (8.0 * PI * (2.0 + g * g) * (1.0 + g * g - 2.0 * g * c).powf(1.5))
            }
            // The printed functions integrate to 4π·2 and 4π·83/33.
            Self::MieHazy => (1.0 + 9.0 * (0.5 + 0.5 * c).powi(8)) / (8.0 * PI),
            Self::MieMurky => (1.0 + 50.0 * (0.5 + 0.5 * c).powi(32)) * 33.0 / (4.0 * PI * 83.0),
        }
    }

    /// Mean cosine of the scattering angle, in closed form.
    pub fn mean_cosine(&self) -> f64 {
        match *self {
            Self::Isotropic | Self::Rayleigh => 0.0,
            Self::HenyeyGreenstein { g } => g,
            Self::CornetteShanks { g } => 3.0 * g * (4.0 + g * g) / (5.0 * (2.0 + g * g)),
            // Mean cosine of ((1+c)/2)^n is n/(n+2), weighted by its share of the integral.
            Self::MieHazy => 0.5 * 8.0 / 10.0,
            Self::MieMurky => (50.0 / 83.0) * 32.0 / 34.0,
        }
    }

    /// A cosine by chance, as often as the phase function says. `uniform` gives numbers in [0, 1).
    pub fn sample_cosine(&self, uniform: &mut impl FnMut() -> f64) -> f64 {
        // `1 + n ((1+c)/2)^k`, of which the first summand has a share of its own.
        let mut mie = |share: f64, power: f64| {
            if uniform() < share {
                2.0 * uniform() - 1.0
            } else {
                2.0 * uniform().powf(1.0 / (power + 1.0)) - 1.0
            }
        };
        match *self {
            Self::Isotropic => 2.0 * uniform() - 1.0,
            Self::Rayleigh => {
                // The root of c³ + 3c = 8u − 4 (Cardano).
                let z = 4.0 * uniform() - 2.0;
                let root = (z + (z * z + 1.0).sqrt()).cbrt();
                (root - 1.0 / root).clamp(-1.0, 1.0)
            }
            Self::HenyeyGreenstein { g } => henyey_greenstein_cosine(g, uniform()),
            Self::CornetteShanks { g } => loop {
                // Henyey-Greenstein times 1 + c².
                let c = henyey_greenstein_cosine(g, uniform());
                if 2.0 * uniform() < 1.0 + c * c {
                    return c;
                }
            },
            Self::MieHazy => mie(0.5, 8.0),
            Self::MieMurky => mie(33.0 / 83.0, 32.0),
        }
    }

    /// A short name, as scene files and `harness list` spell it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Isotropic => "isotropic",
            Self::Rayleigh => "rayleigh",
            Self::HenyeyGreenstein { .. } => "henyey-greenstein",
            Self::CornetteShanks { .. } => "cornette-shanks",
            Self::MieHazy => "mie-hazy",
            Self::MieMurky => "mie-murky",
        }
    }
}

/// The cosine below which Henyey-Greenstein's function has the share `u`.
fn henyey_greenstein_cosine(g: f64, u: f64) -> f64 {
    if g.abs() < 1e-4 {
        // To first order, where the inverse loses its digits.
        let c = 2.0 * u - 1.0;
        return c + 1.5 * g * (1.0 - c * c);
    }
    let root = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
    ((1.0 + g * g - root * root) / (2.0 * g)).clamp(-1.0, 1.0)
}

/// A phase function: a mixture of lobes whose weights may differ by colour and add up to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Weights (RGB) and lobes; at most [`Phase::MAX_LOBES`].
    pub lobes: Vec<(Vec3, Lobe)>,
}

impl From<Lobe> for Phase {
    fn from(lobe: Lobe) -> Self {
        Self { lobes: vec![(Vec3::ONE, lobe)] }
    }
}

impl Phase {
    /// Most lobes that a mixture may have: the size of the uniform that carries them.
    pub const MAX_LOBES: usize = 4;

    /// The same into all directions.
    pub fn isotropic() -> Self {
        Lobe::Isotropic.into()
    }

    /// A mixture; weights are scaled so that each colour's add up to 1. Chen et al. 2006 weight
    /// Rayleigh and Mie by their scattering coefficients: give those as the weights.
    pub fn mixture(lobes: Vec<(Vec3, Lobe)>) -> Self {
        let total: Vec3 = lobes.iter().map(|(weight, _)| *weight).sum();
        Self { lobes: lobes.into_iter().map(|(weight, lobe)| (weight / total, lobe)).collect() }
    }

    /// The value at `cos_theta`, RGB \[1/sr\].
    pub fn eval(&self, cos_theta: f64) -> DVec3 {
        self.lobes.iter().map(|(weight, lobe)| weight.as_dvec3() * lobe.eval(cos_theta)).sum()
    }

    /// The lobe, where there is just one of weight 1.
    pub fn single(&self) -> Option<Lobe> {
        match self.lobes[..] {
            [(Vec3::ONE, lobe)] => Some(lobe),
            _ => None,
        }
    }

    /// What is wrong with this phase function, if anything: one clause.
    pub fn problem(&self) -> Option<String> {
        if self.lobes.is_empty() || self.lobes.len() > Self::MAX_LOBES {
            return Some(format!(
                "has a phase function of {} lobes; expected 1 to {}",
                self.lobes.len(),
                Self::MAX_LOBES
            ));
        }
        let total: Vec3 = self.lobes.iter().map(|(weight, _)| *weight).sum();
        let negative = self.lobes.iter().any(|(weight, _)| weight.min_element() < 0.0);
        let off = (total - 1.0).abs().max_element();
        if negative || off.is_nan() || off > 1e-4 {
            return Some(format!(
                "has phase function weights that add up to {total}; expected 1, none negative"
            ));
        }
        for (_, lobe) in &self.lobes {
            if let Lobe::HenyeyGreenstein { g } | Lobe::CornetteShanks { g } = lobe
                && (g.is_nan() || g.abs() > 0.99 + 1e-6)
            {
                return Some(format!("has an asymmetry g = {g}; expected −0.99 to 0.99"));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Lobe; 9] = [
        Lobe::Isotropic,
        Lobe::Rayleigh,
        Lobe::HenyeyGreenstein { g: 0.76 },
        Lobe::HenyeyGreenstein { g: -0.9 },
        Lobe::CornetteShanks { g: 0.0 },
        Lobe::CornetteShanks { g: 0.76 },
        Lobe::CornetteShanks { g: -0.5 },
        Lobe::MieHazy,
        Lobe::MieMurky,
    ];

    /// `2π ∫ f dc` by the midpoint rule.
    fn over_sphere(f: impl Fn(f64) -> f64) -> f64 {
        let n = 400_000;
        let step = 2.0 / f64::from(n);
        (0..n).map(|i| f(-1.0 + (f64::from(i) + 0.5) * step)).sum::<f64>() * step * 2.0 * PI
    }

    #[test]
    fn every_lobe_integrates_to_one() {
        for lobe in ALL {
            let total = over_sphere(|c| lobe.eval(c));
            assert!((total - 1.0).abs() < 1e-7, "{lobe:?}: {total}");
        }
    }

    #[test]
    fn mean_cosine_is_the_closed_form_and_fixes_the_sign() {
        for lobe in ALL {
            let mean = over_sphere(|c| c * lobe.eval(c));
            assert!((mean - lobe.mean_cosine()).abs() < 1e-6, "{lobe:?}: {mean}");
        }
        let forward = Lobe::HenyeyGreenstein { g: 0.76 };
        assert!(forward.eval(1.0) > 50.0 * forward.eval(-1.0), "+1 is forward");
        // The closed forms of formulas: Cornette-Shanks at g = .76 has a mean cosine of .8098.
        assert!((Lobe::CornetteShanks { g: 0.76 }.mean_cosine() - 0.8098).abs() < 1e-4);
    }

    #[test]
    fn samples_are_as_frequent_as_the_function_says() {
        for lobe in ALL {
            let mut state = 7u64;
            let mut uniform = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1u64 << 53) as f64
            };
            const N: u32 = 400_000;
            // Counts by bins of the cosine, and the mean.
            let (mut counts, mut sum, mut squares) = ([0u32; 16], 0.0, 0.0);
            for _ in 0..N {
                let c = lobe.sample_cosine(&mut uniform);
                assert!((-1.0..=1.0).contains(&c));
                counts[(8.0 * (c + 1.0)).min(15.0) as usize] += 1;
                sum += c;
                squares += c * c;
            }
            let n = f64::from(N);
            let (mean, error) = (sum / n, ((squares / n - (sum / n).powi(2)) / n).sqrt());
            assert!((mean - lobe.mean_cosine()).abs() < 4.0 * error, "{lobe:?}: {mean} ± {error}");
            for (bin, count) in counts.into_iter().enumerate() {
                let c = |i: u32| -1.0 + (bin as f64 + (f64::from(i) + 0.5) / 1000.0) / 8.0;
                let share = (0..1000).map(|i| lobe.eval(c(i))).sum::<f64>() * 2.0 * PI / 8000.0;
                let off = f64::from(count) - n * share;
                assert!(
                    off.abs() < 4.5 * (n * share + 1.0).sqrt(),
                    "{lobe:?}, bin {bin}: {count}, not {}",
                    n * share
                );
            }
        }
    }

    #[test]
    fn a_mixture_stays_normalised_in_every_colour() {
        let mixture = Phase::mixture(vec![
            (Vec3::new(5.8, 13.5, 33.1), Lobe::Rayleigh),
            (Vec3::splat(21.0), Lobe::HenyeyGreenstein { g: 0.76 }),
        ]);
        assert_eq!(mixture.problem(), None);
        for colour in 0..3 {
            let total = over_sphere(|c| mixture.eval(c)[colour]);
            assert!((total - 1.0).abs() < 1e-6, "{total}");
        }
        assert!(mixture.eval(1.0).x > mixture.eval(1.0).z, "red has the larger share of Mie here");
        let broken = Phase { lobes: vec![(Vec3::splat(0.7), Lobe::Rayleigh)] };
        assert!(broken.problem().is_some());
    }
}
