//! A homogeneous participating medium.

use glam::Vec3;

use crate::Phase;

/// A homogeneous medium that fills all space.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Scattering coefficient, RGB \[1/m\], not negative.
    pub sigma_s: Vec3,
    /// Absorption coefficient, RGB \[1/m\], not negative.
    pub sigma_a: Vec3,
    /// Phase function \[1/sr\].
    pub phase: Phase,
}

impl Medium {
    /// No medium at all.
    pub fn vacuum() -> Self {
        Self { sigma_s: Vec3::ZERO, sigma_a: Vec3::ZERO, phase: Phase::isotropic() }
    }

    /// A grey medium from its extinction coefficient \[1/m\] and albedo in [0, 1].
    pub fn grey(sigma_t: f32, albedo: f32, phase: Phase) -> Self {
        Self { sigma_s: Vec3::splat(sigma_t * albedo), sigma_a: Vec3::splat(sigma_t * (1.0 - albedo)), phase }
    }

    /// Extinction coefficient, RGB \[1/m\].
    pub fn sigma_t(&self) -> Vec3 {
        self.sigma_s + self.sigma_a
    }

    /// Single-scattering albedo, RGB; 0 where there is no extinction.
    pub fn albedo(&self) -> Vec3 {
        let sigma_t = self.sigma_t();
        Vec3::select(
            sigma_t.cmpgt(Vec3::ZERO),
            self.sigma_s / sigma_t.max(Vec3::splat(f32::MIN_POSITIVE)),
            Vec3::ZERO,
        )
    }

    /// Whether extinction is the same in all three colours.
    pub fn is_grey(&self) -> bool {
        let sigma_t = self.sigma_t();
        sigma_t == Vec3::splat(sigma_t.x)
    }

    /// What is wrong with this medium, if anything: one clause, to be put behind its name.
    pub fn problem(&self) -> Option<String> {
        for (name, sigma) in [("sigma_s", self.sigma_s), ("sigma_a", self.sigma_a)] {
            if !sigma.is_finite() || sigma.min_element() < 0.0 {
                return Some(format!(
                    "has {name} = {sigma} 1/m; expected three finite numbers, none negative"
                ));
            }
        }
        self.phase.problem()
    }
}
