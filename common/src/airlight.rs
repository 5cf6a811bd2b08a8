//! Unshadowed single scattering along a piece of a ray, in f64.
//!
//! Seen from a point at distance `x` along a view ray from the eye, a light lies at distance `t`
//! along the ray and `h` beside it, so `r = √((x−t)² + h²)` metres away. The medium sends towards
//! the eye (Biri et al. 2006, eq. (3), with the phase function in 1/sr)
//!
//! `L = ∫ σ_s p(cos θ) I exp(−σ_t (x + r)) / r² dx`.
//!
//! In the scattering angle θ, which is the angle at the light plus 90°, `dx/r² = dθ/h` and
//! `x + r = t + h tan(θ/2)` (eq. (5) to (7), exponent put right): the singularity is gone. On the
//! eye's side of the light θ is small, on the other side π − θ is, and each side is integrated in
//! its small angle, so that nothing cancels however close the ray passes by the light.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use crate::Phase;
use crate::quadrature::integrate;

/// Where a point light lies relative to a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightFromRay {
    /// Distance along the ray of the ray's point nearest to the light \[m\]; negative behind the eye.
    pub t: f64,
    /// Distance of the light from the ray's line \[m\].
    pub h: f64,
    /// Unit direction of the ray.
    pub along: DVec3,
    /// Unit direction from the light to the ray's nearest point; zero where `h` is.
    pub across: DVec3,
}

impl LightFromRay {
    /// From the eye, the ray's unit direction, and the light's position \[m\].
    pub fn new(eye: DVec3, direction: DVec3, light: DVec3) -> Self {
        let to_light = light - eye;
        // |v × d| keeps its digits where √(l² − t²) loses them.
        let normal = to_light.cross(direction);
        let h = normal.length();
        Self {
            t: to_light.dot(direction),
            h,
            along: direction,
            across: normal.cross(direction).normalize_or_zero(),
        }
    }
}

/// The medium, as this module takes it: everything in f64, whatever built it.
#[derive(Clone, Copy, Debug)]
pub struct Optics<'a> {
    /// Extinction coefficient, RGB \[1/m\].
    pub sigma_t: DVec3,
    /// Scattering coefficient, RGB \[1/m\].
    pub sigma_s: DVec3,
    /// Phase function \[1/sr\].
    pub phase: &'a Phase,
}

/// Airlight of a point light along the part [`x0`, `x1`] of a ray, per unit of radiant intensity
/// \[W m⁻² sr⁻¹ per W/sr\]. `x1` may be infinite; `t` and `h` as in [`LightFromRay`].
///
/// A light on the segment itself (`h = 0`) shines infinitely bright into the eye: the answer is
/// infinite there. `tolerance` is relative.
#[expect(clippy::too_many_arguments, reason = "the variables of the formula, under their own names")]
pub fn airlight_point(
    sigma_t: DVec3,
    sigma_s: DVec3,
    phase: &Phase,
    t: f64,
    h: f64,
    x0: f64,
    x1: f64,
    tolerance: f64,
) -> DVec3 {
    let geometry = LightFromRay { t, h, along: DVec3::X, across: DVec3::Y };
    airlight_towards(&Optics { sigma_t, sigma_s, phase }, &geometry, [x0, x1], &[], tolerance, |_| DVec3::ONE)
}

/// Airlight of a point light whose radiant intensity depends on direction \[W m⁻² sr⁻¹\].
///
/// `intensity` is asked for unit directions away from the light \[W/sr\]. `breaks` are distances
/// along the ray \[m\] where it jumps or has a kink, in any order; those outside the segment are
/// passed over. The rest is as in [`airlight_point`].
pub fn airlight_towards(
    optics: &Optics,
    geometry: &LightFromRay,
    [x0, x1]: [f64; 2],
    breaks: &[f64],
    tolerance: f64,
    intensity: impl Fn(DVec3) -> DVec3,
) -> DVec3 {
    if x0 >= x1 || optics.sigma_s == DVec3::ZERO {
        return DVec3::ZERO;
    }
    let t = geometry.t;
    let short = breaks.len() > 16;
    let mut total = DVec3::ZERO;
    let mut piece = |a: f64, b: f64| {
        // A piece that reaches across the light's foot is integrated in two angles.
        if a < t {
            total += one_side(optics, geometry, [a, b.min(t)], tolerance, short, &intensity);
        }
        if b > t {
            total += one_side(optics, geometry, [a.max(t), b], tolerance, short, &intensity);
        }
    };
    if breaks.is_empty() {
        piece(x0, x1);
        return total;
    }
    let mut cuts: Vec<f64> = breaks.iter().copied().filter(|&x| x0 < x && x < x1).collect();
    cuts.sort_by(f64::total_cmp);
    cuts.push(x1);
    let mut from = x0;
    for to in cuts {
        piece(from, to);
        from = to;
    }
    total
}

/// A piece that lies wholly on one side of the ray's point nearest to the light; `short` if it is one
/// of many.
fn one_side(
    optics: &Optics,
    geometry: &LightFromRay,
    [x0, x1]: [f64; 2],
    tolerance: f64,
    short: bool,
    intensity: &impl Fn(DVec3) -> DVec3,
) -> DVec3 {
    let LightFromRay { t, h, along, across } = *geometry;
    let Optics { sigma_t, sigma_s, phase } = *optics;
    let towards_light = x1 <= t;
    if h < 1e-100 {
        return collinear(optics, t, [x0, x1], tolerance)
            * intensity(if towards_light { -along } else { along });
    }
    // The small angle's lower end, and its range without the cancellation of a difference.
    let (near, sign) = if towards_light { (t - x0, -1.0) } else { (x1 - t, 1.0) };
    let low = if near == f64::INFINITY { 0.0 } else { h.atan2(near) };
    let range = if x1 == f64::INFINITY {
        h.atan2(x0 - t)
    } else {
        (h * (x1 - x0)).atan2(h * h + (x0 - t) * (x1 - t))
    };
    let grey = sigma_t == DVec3::splat(sigma_t.x);
    let integrand = |angle: f64| {
        let angle = (low + angle).min(FRAC_PI_2);
        let (sin, cos) = angle.sin_cos();
        // tan(θ/2) on the eye's side, 1/tan((π−θ)/2) on the other.
        let tan = sin / (1.0 + cos);
        let path = t + if towards_light { h * tan } else { h / tan };
        let transmittance =
            if grey { DVec3::splat((-sigma_t.x * path).exp()) } else { (-sigma_t * path).exp() };
        // The cosine of the scattering angle is +cos towards the light, −cos beyond it.
        transmittance * phase.eval(-sign * cos) * intensity(sin * across + sign * cos * along)
    };
    integrate_piece(integrand, range, tolerance, short) * sigma_s / h
}

/// Integrates over [0, `range`]. A short piece, between two of many breaks, mostly needs no more
/// than three points: their error is about the difference to two points to the power 3/2.
fn integrate_piece(f: impl Fn(f64) -> DVec3, range: f64, tolerance: f64, short: bool) -> DVec3 {
    if short {
        let at = |node: f64| f(0.5 * range * (1.0 + node));
        let two = 0.5 * range * (at(-0.577_350_269_189_625_8) + at(0.577_350_269_189_625_8));
        let sides = at(-0.774_596_669_241_483_4) + at(0.774_596_669_241_483_4);
        let three = range / 18.0 * (5.0 * sides + 8.0 * at(0.0));
        let relative = (three - two).abs().max_element() / three.abs().max_element();
        if relative.powf(1.5) <= tolerance {
            return three;
        }
    }
    integrate(f, 0.0, range, tolerance).value
}

/// The light lies on the ray's line: θ is 0 before it and π behind it.
fn collinear(optics: &Optics, t: f64, [x0, x1]: [f64; 2], tolerance: f64) -> DVec3 {
    let Optics { sigma_t, sigma_s, phase } = *optics;
    if x0 <= t && t <= x1 {
        return DVec3::select(sigma_s.cmpgt(DVec3::ZERO), DVec3::INFINITY, DVec3::ZERO);
    }
    if x1 < t {
        // x + r = t all along.
        let inverse_square = (x1 - x0) / ((t - x1) * (t - x0));
        return sigma_s * phase.eval(1.0) * (-sigma_t * t).exp() * inverse_square;
    }
    // x + r = t + 2y with y = x − t; in w = 1/y the integrand is smooth.
    let end = if x1 == f64::INFINITY { 0.0 } else { 1.0 / (x1 - t) };
    let range = if x1 == f64::INFINITY { 1.0 / (x0 - t) } else { (x1 - x0) / ((x1 - t) * (x0 - t)) };
    let integrand = |w: f64| (-sigma_t * (t + 2.0 / (end + w))).exp();
    sigma_s * phase.eval(-1.0) * integrate(integrand, 0.0, range, tolerance).value
}

/// Airlight of a directional light along the part [`x0`, `x1`] of a ray, per unit of irradiance
/// \[W m⁻² sr⁻¹ per W/m²\]: `σ_s p (e^{−σ_t x0} − e^{−σ_t x1}) / σ_t`, in closed form.
///
/// `cos_theta` is the cosine between the light's travel and the way to the eye. The light is not
/// attenuated on its way to the ray. `x1` may be infinite; without extinction an infinite segment
/// is infinitely bright where the medium scatters at all.
pub fn airlight_directional(
    sigma_t: DVec3,
    sigma_s: DVec3,
    phase: &Phase,
    cos_theta: f64,
    x0: f64,
    x1: f64,
) -> DVec3 {
    if x0 >= x1 {
        return DVec3::ZERO;
    }
    let p = phase.eval(cos_theta);
    let colour = |i: usize| {
        let (sigma, length) = (sigma_t[i], x1 - x0);
        if sigma_s[i] == 0.0 {
            return 0.0;
        }
        let path = if sigma == 0.0 { length } else { -(-sigma * length).exp_m1() / sigma };
        sigma_s[i] * p[i] * (-sigma * x0).exp() * path
    };
    DVec3::new(colour(0), colour(1), colour(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: DVec3, b: DVec3, tolerance: f64) {
        assert!((a - b).abs().max_element() <= tolerance * b.abs().max_element(), "{a} is not {b}");
    }

    /// The integral of the module's head by the midpoint rule in `x`.
    fn midpoint(optics: &Optics, t: f64, h: f64, [x0, x1]: [f64; 2]) -> DVec3 {
        let n = 200_000;
        let step = (x1 - x0) / f64::from(n);
        (0..n)
            .map(|i| {
                let x = x0 + (f64::from(i) + 0.5) * step;
                let r = (x - t).hypot(h);
                optics.sigma_s * optics.phase.eval((t - x) / r) * (-optics.sigma_t * (x + r)).exp() / (r * r)
            })
            .sum::<DVec3>()
            * step
    }

    #[test]
    fn agrees_with_the_integral_as_it_is_written() {
        let phase = Phase::from(crate::Lobe::HenyeyGreenstein { g: 0.6 });
        let sigma_t = DVec3::new(0.3, 0.6, 0.1);
        let optics = Optics { sigma_t, sigma_s: 0.7 * sigma_t, phase: &phase };
        for (t, h) in [(3.0, 0.8), (-1.0, 0.5), (9.0, 2.0), (0.0, 1.0)] {
            let found = airlight_point(optics.sigma_t, optics.sigma_s, &phase, t, h, 0.5, 6.0, 1e-10);
            near(found, midpoint(&optics, t, h, [0.5, 6.0]), 1e-8);
        }
    }

    #[test]
    fn pieces_add_up() {
        let phase = Phase::from(crate::Lobe::MieMurky);
        let one = DVec3::splat(0.2);
        let part = |x0, x1| airlight_point(one, one, &phase, 2.0, 0.3, x0, x1, 1e-12);
        near(part(0.0, 1.3) + part(1.3, 2.7) + part(2.7, f64::INFINITY), part(0.0, f64::INFINITY), 1e-11);
        assert_eq!(part(1.0, 1.0), DVec3::ZERO);
        assert_eq!(part(2.0, 1.0), DVec3::ZERO);
    }

    #[test]
    fn limits_without_extinction_or_scattering() {
        let phase = Phase::isotropic();
        // Without extinction the integral is the angle: σ_s I/(4π) · π/h over a whole line.
        let whole = airlight_point(DVec3::ZERO, DVec3::ONE, &phase, 0.0, 2.0, -1e300, f64::INFINITY, 1e-12);
        near(whole, DVec3::splat(1.0 / 8.0), 1e-12);
        let none = airlight_point(DVec3::ONE, DVec3::ZERO, &phase, 0.0, 0.0, 0.0, 1.0, 1e-9);
        assert_eq!(none, DVec3::ZERO);
        let on_ray = airlight_point(DVec3::ONE, DVec3::X, &phase, 0.5, 0.0, 0.0, 1.0, 1e-9);
        assert_eq!(on_ray, DVec3::new(f64::INFINITY, 0.0, 0.0));
    }

    #[test]
    fn collinear_is_the_limit_of_near() {
        let phase = Phase::from(crate::Lobe::HenyeyGreenstein { g: 0.5 });
        let sigma = DVec3::new(0.3, 1.0, 2.0);
        for (t, x1) in [(5.0, 4.0), (-1.0, 4.0), (-1.0, f64::INFINITY)] {
            let at = |h: f64| airlight_point(sigma, sigma, &phase, t, h, 0.0, x1, 1e-12);
            near(at(0.0), at(1e-7), 1e-10);
        }
    }

    #[test]
    fn intensity_by_direction_and_breaks() {
        // Light only into the half space x > 2.5: the same as a shorter segment.
        let phase = Phase::isotropic();
        let sigma = DVec3::splat(0.4);
        let optics = Optics { sigma_t: sigma, sigma_s: sigma, phase: &phase };
        let geometry = LightFromRay::new(DVec3::ZERO, DVec3::X, DVec3::new(2.0, 1.0, 0.0));
        assert_eq!((geometry.t, geometry.h, geometry.across), (2.0, 1.0, DVec3::NEG_Y));
        let half = |d: DVec3| if d.x > -0.5 * d.y { DVec3::splat(3.0) } else { DVec3::ZERO };
        let found = airlight_towards(&optics, &geometry, [0.0, 8.0], &[2.5, -4.0, 99.0], 1e-11, half);
        near(found, 3.0 * airlight_point(sigma, sigma, &phase, 2.0, 1.0, 2.5, 8.0, 1e-11), 1e-10);
    }

    #[test]
    fn many_breaks_are_as_good_as_none() {
        let phase = Phase::from(crate::Lobe::MieMurky);
        let sigma = DVec3::new(0.1, 0.4, 2.0);
        let optics = Optics { sigma_t: sigma, sigma_s: sigma, phase: &phase };
        let breaks: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.1).collect();
        for (t, h) in [(4.0, 0.3), (-1.0, 0.2), (12.0, 3.0)] {
            let geometry = LightFromRay { t, h, along: DVec3::X, across: DVec3::Y };
            let of = |breaks: &[f64], end: f64| {
                airlight_towards(&optics, &geometry, [0.0, end], breaks, 1e-8, |_| DVec3::ONE)
            };
            near(of(&breaks, 9.0), of(&[], 9.0), 1e-7);
            near(of(&breaks, f64::INFINITY), of(&[], f64::INFINITY), 1e-7);
        }
    }

    #[test]
    fn directional_light_in_closed_form() {
        let phase = Phase::from(crate::Lobe::HenyeyGreenstein { g: 0.5 });
        let (sigma_t, sigma_s) = (DVec3::new(1e-12, 0.5, 3.0), DVec3::new(1e-12, 0.4, 1.0));
        let found = airlight_directional(sigma_t, sigma_s, &phase, 0.3, 1.0, 3.0);
        let p = phase.eval(0.3).x;
        let exact =
            |i: usize| sigma_s[i] * p * ((-sigma_t[i]).exp() - (-3.0 * sigma_t[i]).exp()) / sigma_t[i];
        near(found, DVec3::new(2e-12 * p, exact(1), exact(2)), 1e-12);
        let endless = airlight_directional(sigma_t, sigma_s, &phase, 0.3, 0.0, f64::INFINITY);
        near(endless, sigma_s / sigma_t * p, 1e-12);
        let vacuum = airlight_directional(DVec3::ZERO, DVec3::ZERO, &phase, 0.3, 0.0, f64::INFINITY);
        assert_eq!(vacuum, DVec3::ZERO);
    }
}
