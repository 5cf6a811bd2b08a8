//! Indirect single scattering in a medium without bounds: light that the medium scatters once and
//! that then arrives at a surface. Biri et al. 2006, eq. (8) to (13), put right.
//!
//! Around a point P, a point light at distance `l` makes the medium shine from the direction at angle
//! φ from the light with the radiance `σ_s I/(4π l) · G(λ, φ)/sin φ`, where `λ = σ_t l` and, over the
//! scattering angle θ,
//!
//! `G(λ, φ) = e^{−λ} ∫_φ^π 4π p(cos θ) exp(−2 λ sin(φ/2) sin((θ−φ)/2) / cos(θ/2)) dθ`.
//!
//! A surface weighs directions by `max(cos, 0)^n` about an axis: `n = 1` about the normal gives the
//! irradiance, `n` the Phong exponent about the mirrored eye direction the gloss. In rings about the
//! light (`α` is the angle between axis and light) that is
//!
//! `Γ_n(λ, α) = ∫_0^π K_n(φ, α) G(λ, φ) dφ`, `K_n = ∫_0^{2π} max(cos α cos φ + sin α sin φ cos ψ, 0)^n dψ`,
//!
//! and what is received is `σ_s I/(4π l) · Γ_n`. Parallel light of irradiance E makes the medium shine
//! with `E σ_s/σ_t p(cos φ)`, so that `E σ_s/σ_t · P_n(α)` is received, with
//! `P_n(α) = ∫_0^π K_n(φ, α) p(cos φ) sin φ dφ`.
//!
//! The weight is clamped at its own hemisphere (Biri's is not, so his is the net flux: too small, and
//! negative where the light is behind the surface).

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;
use rayon::prelude::*;

use crate::Lobe;
use crate::quadrature::{gauss_legendre, integrate};

/// Relative tolerance that [`irradiance`], [`gloss`] and [`parallel`] keep to.
pub const TOLERANCE: f64 = 1e-10;

/// `Γ_1(λ, α)` for λ = `lam` > 0, Biri's X with the cosine clamped, by quadrature. The surface receives the irradiance
/// `σ_s I/(4π l) · Γ_1(σ_t l, α)` \[W/m²\], where `cos_n` = cos α is between its normal and the light.
pub fn irradiance(lobe: Lobe, lam: f64, cos_n: f64) -> f64 {
    gloss(lobe, 1.0, lam, cos_n)
}

/// `Γ_n(λ, α)` for λ = `lam` > 0 and the Phong exponent `exponent` ≥ 0, by quadrature; `cos_s` = cos α is between the lobe's axis
/// and the light.
pub fn gloss(lobe: Lobe, exponent: f64, lam: f64, cos_s: f64) -> f64 {
    (-lam).exp() * scaled(lobe, exponent, lam, cos_s.clamp(-1.0, 1.0).acos(), TOLERANCE)
}

/// `P_n(α)` for the Phong exponent `exponent` ≥ 0: what is received of parallel light, by quadrature. `cos` = cos α is between the axis and the
/// way to the light.
pub fn parallel(lobe: Lobe, exponent: f64, cos: f64) -> f64 {
    parallel_at(lobe, exponent, cos.clamp(-1.0, 1.0).acos(), TOLERANCE)
}

fn parallel_at(lobe: Lobe, exponent: f64, angle: f64, tolerance: f64) -> f64 {
    over_rings(exponent, angle, 1.0, tolerance, |phi| lobe.eval(phi.cos()) * phi.sin())
}

/// `e^λ Γ_n`, which does not underflow.
fn scaled(lobe: Lobe, exponent: f64, lam: f64, angle: f64, tolerance: f64) -> f64 {
    over_rings(exponent, angle, 1.0 / (1.0 + lam), tolerance, |phi| profile(lobe, lam, phi, 0.01 * tolerance))
}

/// `e^λ G`.
fn profile(lobe: Lobe, lam: f64, phi: f64, tolerance: f64) -> f64 {
    let steep = 2.0 * lam * (0.5 * phi).sin();
    let f = |delta: f64| {
        let theta = phi + delta;
        // The exponent is infinite at θ = π, but for 0/0 where φ = 0.
        let path =
            if steep == 0.0 { 0.0 } else { steep * (0.5 * delta).sin() / (0.5 * theta).cos().max(0.0) };
        4.0 * PI * lobe.eval(theta.cos()) * (-path).exp()
    };
    scalar(f, 0.0, PI - phi, tolerance)
}

/// `K_n(φ, α)`.
fn ring(exponent: f64, phi: f64, angle: f64, tolerance: f64) -> f64 {
    // The cosines at the ring's nearest and farthest point.
    let (near, far) = ((angle - phi).cos(), (angle + phi).cos());
    if near <= 0.0 {
        return 0.0;
    }
    if exponent == 1.0 {
        let mean = 0.5 * (near + far);
        if far >= 0.0 {
            return 2.0 * PI * mean;
        }
        let half = (-2.0 * mean / (near - far)).clamp(-1.0, 1.0).acos();
        return (2.0 * (mean * half + (-near * far).sqrt())).max(0.0);
    }
    // In half the azimuth, or, where a part of the ring is behind, with sin(ψ/2) = k sin(t).
    let whole = far >= 0.0;
    let share = if whole { far / near } else { -far / (near - far) };
    // Beyond `end` nothing is left.
    let fall = if whole { exponent * (1.0 - share) } else { exponent + 1.0 };
    let end = if fall > 0.0 { FRAC_PI_2.min(9.0 / fall.sqrt()) } else { FRAC_PI_2 };
    let f = |t: f64| {
        let (sin, cos) = t.sin_cos();
        let mixed = cos * cos + share * sin * sin;
        if whole { mixed.powf(exponent) } else { cos.powf(2.0 * exponent + 1.0) / mixed.sqrt() }
    };
    let scale = if whole { 1.0 } else { (near / (near - far)).sqrt() };
    // The integrand bends where the two parts of `mixed` are alike.
    let turn = end - share.sqrt().min(0.5 * end);
    4.0 * near.powf(exponent) * scale * (scalar(f, 0.0, turn, tolerance) + scalar(f, turn, end, tolerance))
}

/// Angles between which the integrand over φ is smooth; what lies outside of them counts for nothing.
/// `widths` are those of peaks at φ = 0.
fn cuts(exponent: f64, angle: f64, widths: &[f64]) -> Vec<f64> {
    // The rings touch the edge of the hemisphere at these, and the lobe is this wide.
    let edge = (FRAC_PI_2 - angle).abs();
    let lobe = 1.0 / exponent.max(1.0).sqrt();
    let (lowest, highest) = ((angle - 12.0 * lobe).max(0.0), (angle + 12.0 * lobe).min(PI));
    let mut cuts = vec![lowest, edge, PI - edge, highest];
    if exponent > 4.0 {
        cuts.extend([-6.0, -2.0, 0.0, 2.0, 6.0].map(|k| angle + k * lobe));
    }
    cuts.extend(widths);
    cuts.retain(|cut| (lowest..=highest).contains(cut));
    cuts.sort_by(f64::total_cmp);
    cuts
}

/// `∫_0^π K_n(φ, α) f(φ) dφ`; `f` may have a peak of width `width` at 0.
fn over_rings(exponent: f64, angle: f64, width: f64, tolerance: f64, f: impl Fn(f64) -> f64) -> f64 {
    let cuts = cuts(exponent, angle, &[2.0 * width, 10.0 * width]);
    let piece = |piece: &[f64]| {
        let g = |t: f64| {
            let (phi, slope) = eased(piece, t);
            let weight = slope * ring(exponent, phi, angle, 0.01 * tolerance);
            if weight == 0.0 { 0.0 } else { weight * f(phi) }
        };
        scalar(g, 0.0, PI, tolerance)
    };
    cuts.windows(2).map(piece).sum()
}

/// A place in `piece` for t in [0, π] and its derivative: both ends may be square roots, and those are
/// smooth in the angle of a cosine.
fn eased(piece: &[f64], t: f64) -> (f64, f64) {
    let (middle, half) = (0.5 * (piece[0] + piece[1]), 0.5 * (piece[1] - piece[0]));
    (middle - half * t.cos(), half * t.sin())
}

/// Angles φ and weights that integrate over rings as [`over_rings`] does, whatever the peak's width.
fn ring_rule(exponent: f64, angle: f64) -> Vec<(f64, f64)> {
    let widths: Vec<f64> = (0..7).map(|k| 0.02 * 2.0_f64.powi(k)).collect();
    let rule = gauss_legendre(16);
    let mut nodes = Vec::new();
    for piece in cuts(exponent, angle, &widths).windows(2) {
        for (x, weight) in &rule {
            let (phi, slope) = eased(piece, FRAC_PI_2 * (1.0 + x));
            nodes.push((phi, FRAC_PI_2 * weight * slope * ring(exponent, phi, angle, 1e-10)));
        }
    }
    nodes
}

fn scalar(f: impl Fn(f64) -> f64, a: f64, b: f64, tolerance: f64) -> f64 {
    integrate(|x| DVec3::splat(f(x)), a, b, tolerance).value.x
}

/// `Γ_n` of one lobe and one exponent for any λ and angle, from Chebyshev series; its relative error
/// is below [`Table::ERROR`].
pub struct Table {
    exponent: f64,
    halves: [Series; 2],
}

/// `P_n` likewise.
pub struct ParallelTable {
    exponent: f64,
    halves: [Series; 2],
}

impl Table {
    /// Relative error of tables, for asymmetries up to 0.9 and exponents up to 1000.
    pub const ERROR: f64 = 1e-5;
    /// Beyond this λ the attenuation e^{−λ} leaves nothing; the rest is taken as it is here.
    const FARTHEST: f64 = 100.0;
    /// Chebyshev nodes in λ, in α (of each half) and, for `G`, in φ.
    const NODES: [usize; 3] = [44, 40, 64];

    /// Computes the table; takes a good tenth of a second.
    pub fn new(lobe: Lobe, exponent: f64) -> Self {
        let [rows, columns, across] = Self::NODES;
        let lams: Vec<f64> = nodes(rows).map(|s| Self::FARTHEST * s.powi(4)).collect();
        // First e^λ G as a series in φ for every λ, dense where it is steep, and without its zero at π.
        let peak = (4.0 * PI * lobe.eval(1.0)).max(1.0).sqrt();
        let profiles: Vec<(f64, Series)> = lams
            .par_iter()
            .map(|lam| {
                let c = (PI * peak.max(1.0 + lam)).asinh();
                let value = |x: f64| {
                    let phi = (PI * (c * x).sinh() / c.sinh()).min(PI);
                    (profile(lobe, *lam, phi, 1e-11) / (0.5 * phi).cos()).ln()
                };
                (c, Series::through(nodes(across).map(value).collect(), across))
            })
            .collect();
        let half = |averted: bool| {
            let rules: Vec<Vec<(f64, f64)>> = nodes(columns)
                .collect::<Vec<_>>()
                .into_par_iter()
                .map(|x| ring_rule(exponent, angle_at(averted, exponent, x)))
                .collect();
            let values = (0..rows * columns)
                .into_par_iter()
                .map(|i| {
                    let (lam, (c, profile)) = (lams[i / columns], &profiles[i / columns]);
                    let shine = |phi: f64| {
                        profile.eval(0.0, (phi / PI * c.sinh()).asinh() / c).exp() * (0.5 * phi).cos()
                    };
                    let sum: f64 = rules[i % columns].iter().map(|(phi, weight)| weight * shine(*phi)).sum();
                    ((1.0 + lam) * sum).ln()
                })
                .collect();
            Series::through(values, columns)
        };
        Self { exponent, halves: [half(false), half(true)] }
    }

    /// `Γ_n(λ, α)` for λ = `lam` > 0 and the angle α \[rad\] in [0, π].
    pub fn eval(&self, lam: f64, angle: f64) -> f64 {
        let near = lam.clamp(0.0, Self::FARTHEST);
        let (half, x) = place_of(self.exponent, angle);
        (self.halves[half].eval((near / Self::FARTHEST).sqrt().sqrt(), x) - lam).exp() / (1.0 + near)
    }
}

impl ParallelTable {
    /// Computes the table.
    pub fn new(lobe: Lobe, exponent: f64) -> Self {
        let shine = |phi: f64| lobe.eval(phi.cos()) * phi.sin();
        let half = |averted: bool| {
            let value = |x: f64| {
                let rule = ring_rule(exponent, angle_at(averted, exponent, x));
                rule.iter().map(|(phi, weight)| weight * shine(*phi)).sum::<f64>().ln()
            };
            Series::through(nodes(Table::NODES[1]).map(value).collect(), Table::NODES[1])
        };
        Self { exponent, halves: [half(false), half(true)] }
    }

    /// `P_n(α)` for the angle α \[rad\] in [0, π].
    pub fn eval(&self, angle: f64) -> f64 {
        let (half, x) = place_of(self.exponent, angle);
        self.halves[half].eval(0.0, x).exp()
    }
}

/// How fast `Γ_n` varies near the light.
fn stretch(exponent: f64) -> f64 {
    (FRAC_PI_2 * exponent.max(1.0).sqrt()).asinh()
}

/// The angle for `x` in [0, 1]: each half of [0, π] has its own series, dense at 90°, where the light
/// sinks behind the lobe's hemisphere, and, as the lobe is narrow, near the light.
fn angle_at(averted: bool, exponent: f64, x: f64) -> f64 {
    if averted {
        return FRAC_PI_2 * (1.0 + x * x);
    }
    let c = stretch(exponent);
    FRAC_PI_2 * (c * x * (2.0 - x)).sinh() / c.sinh()
}

/// The half of an angle and its `x`: the inverse of [`angle_at`].
fn place_of(exponent: f64, angle: f64) -> (usize, f64) {
    let turn = (angle / FRAC_PI_2).clamp(0.0, 2.0);
    if turn > 1.0 {
        return (1, (turn - 1.0).sqrt());
    }
    let c = stretch(exponent);
    (0, 1.0 - (1.0 - (turn * c.sinh()).asinh() / c).max(0.0).sqrt())
}

/// The Chebyshev nodes of [0, 1].
fn nodes(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |k| 0.5 + 0.5 * node_angle(k, count).cos())
}

fn node_angle(k: usize, count: usize) -> f64 {
    PI * (k as f64 + 0.5) / count as f64
}

/// A Chebyshev series in two variables in [0, 1].
struct Series {
    columns: usize,
    coefficients: Vec<f64>,
}

impl Series {
    /// The series that has `values` at the nodes, row by row.
    fn through(values: Vec<f64>, columns: usize) -> Self {
        let rows = values.len() / columns;
        // The discrete cosine transform, one variable after the other.
        let cosine = |j: usize, k: usize, n: usize| {
            (if j == 0 { 1.0 } else { 2.0 }) / n as f64 * (j as f64 * node_angle(k, n)).cos()
        };
        let across: Vec<f64> = (0..values.len())
            .map(|i| (i / columns * columns, i % columns))
            .map(|(row, j)| (0..columns).map(|k| cosine(j, k, columns) * values[row + k]).sum())
            .collect();
        let coefficients = (0..values.len())
            .map(|i| {
                (0..rows).map(|k| cosine(i / columns, k, rows) * across[k * columns + i % columns]).sum()
            })
            .collect();
        Self { columns, coefficients }
    }

    fn eval(&self, row: f64, column: f64) -> f64 {
        let rows = self.coefficients.chunks_exact(self.columns);
        clenshaw(row, rows.map(|row| clenshaw(column, row.iter().copied())))
    }
}

/// The sum of a Chebyshev series on [0, 1].
fn clenshaw(x: f64, coefficients: impl DoubleEndedIterator<Item = f64>) -> f64 {
    let y = 4.0 * x - 2.0;
    let (mut last, mut before) = (0.0, 0.0);
    for c in coefficients.rev() {
        (last, before) = (y * last - before + c, last);
    }
    // The recurrence has counted the second-last sum by half too often.
    last - 0.5 * y * before
}
