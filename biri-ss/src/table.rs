//! The paper's tables: purely numerical, one of each for a phase function, whatever the medium's density.
//!
//! As in the paper the phase function is 4π times the one in 1/sr (its mean is 1). Formulas (6), (10), (11)
//! and (13) are put right; each function says how. `u(a) = tan(a/2 + π/4) = (1 + sin a)/cos a`.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

use common::Lobe;
use common::quadrature::gauss_legendre;
use common::table::{Axis, Table2};
use rayon::prelude::*;

/// Optical depths `λ = σ_t h` of the airlight tables.
pub const AIRLIGHT_DOMAIN: (f64, f64) = (1e-4, 30.0);
/// Optical depths `λ = σ_t l` of the tables of indirect light.
pub const INDIRECT_DOMAIN: (f64, f64) = (1e-4, 50.0);
/// Texels of the Lambert table: optical depth, cosine.
pub const LAMBERT_SIZE: [usize; 2] = [192, 64];
/// Texels of a layer of the Phong table: optical depth, angle.
pub const PHONG_SIZE: [usize; 2] = [192, 64];
/// Phong exponents of the layers; see [`phong_layer`].
pub const EXPONENTS: [u32; 21] =
    [0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024];

/// Nodes over the angle between a direction and the light.
const NODES: usize = 256;

/// Eight-point Gauss-Legendre rule.
fn eight() -> &'static [(f64, f64)] {
    static RULE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    RULE.get_or_init(|| gauss_legendre(8))
}

fn gauss(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    half * eight().iter().map(|&(x, w)| w * f(middle + half * x)).sum::<f64>()
}

/// Integral from `start` to `end` on `panels` panels that shrink by halves towards `end`.
fn graded(start: f64, end: f64, panels: i32, f: impl Fn(f64) -> f64) -> f64 {
    let place = |panel: i32| if panel == panels { end } else { end + (start - end) * 0.5_f64.powi(panel) };
    (0..panels).map(|panel| gauss(place(panel), place(panel + 1), &f)).sum()
}

/// `tan(a/2 + π/4)`, in the form that does not cancel.
fn u(a: f64) -> f64 {
    if a < 0.0 { a.cos() / (1.0 - a.sin()) } else { (1.0 + a.sin()) / a.cos().max(1e-300) }
}

/// The phase function at the angle `a` at the light, 4π times 1/sr. The deflection is a + 90°.
fn phase(lobe: Lobe, a: f64) -> f64 {
    4.0 * PI * lobe.eval(-a.sin())
}

/// `Γ(λ, γ) = ∫_0^γ p(a + π/2) exp(−λ u(a)) da`, (6). Printed with `k_t λ` in the exponent, where λ has `k_t`
/// in it already.
pub fn gamma(lobe: Lobe, lambda: f64, angle: f64) -> f64 {
    // Towards the end the exponential falls off within the last bit of angle.
    graded(0.0, angle, 14, |a| phase(lobe, a) * (-lambda * u(a)).exp())
}

/// `∫_γ^{π/2} p(a + π/2) exp(−λ [u(a) − u(γ)]) da`, which lies in (0, π] times the phase function: the form
/// of `Γ` that does not cancel where the light is behind the eye.
pub fn gamma_rest(lobe: Lobe, lambda: f64, angle: f64) -> f64 {
    let start = u(angle);
    let value = |a: f64| phase(lobe, a) * (-lambda * (u(a) - start)).exp();
    let middle = 0.5 * (angle + FRAC_PI_2);
    graded(middle, FRAC_PI_2, 8, value) - graded(middle, angle, 14, value)
}

/// `e^λ G(λ, φ)`: light that arrives from the direction at the angle `φ` to the light, times sin φ, without
/// the attenuation that all of it has in common (1.3 of the errata: the exponent's numerator is
/// cos(a − φ) + sin φ, printed as cos(a − φ) + 1).
fn arriving(lobe: Lobe, lambda: f64, phi: f64) -> f64 {
    gamma_rest(lobe, lambda * phi.sin(), phi - FRAC_PI_2)
}

/// What a Lambert surface does to light from the angle `phi` to the light, whose own angle to the normal has
/// the cosine `cos_n`: the cosine law integrated around the light's axis. Clamped it is 0 below the surface;
/// unclamped it is (9) as printed, which takes light away from behind the surface.
fn lambert_kernel(phi: f64, cos_n: f64, clamped: bool) -> f64 {
    let a = cos_n * phi.cos();
    let b = ((1.0 - cos_n * cos_n).max(0.0)).sqrt() * phi.sin();
    match () {
        () if a >= b || !clamped => 2.0 * PI * a,
        () if a <= -b => 0.0,
        () => 2.0 * (a * (-a / b).acos() + (b * b - a * a).max(0.0).sqrt()),
    }
}

/// Irradiance by indirect single scattering in units of `σ_s I/(4π l) e^{−λ}`, `λ = σ_t l`, on a surface whose
/// normal has the cosine `cos_n` to the light: (10) with the cosine clamped, or as printed.
pub fn lambert(lobe: Lobe, lambda: f64, cos_n: f64, clamped: bool) -> f64 {
    let angle = cos_n.clamp(-1.0, 1.0).acos();
    let value = |phi: f64| lambert_kernel(phi, cos_n, clamped) * arriving(lobe, lambda, phi);
    // The kernel's kink: where the cone around the light touches the horizon.
    let kink = (FRAC_PI_2 - angle).abs();
    let mut sum = 0.0;
    for [low, high] in [[0.0, kink], [kink, PI - kink], [PI - kink, PI]] {
        let middle = 0.5 * (low + high);
        sum += graded(middle, high, 12, value) - graded(middle, low, 12, value);
    }
    sum
}

/// Light that a lobe of `cosⁿ` gathers about an axis at the angle `phi_s` to the light, by indirect single
/// scattering in units of `σ_s I/(4π l) e^{−λ}`: (13), printed without the ratio of sines that its change of
/// variables needs; here it is integrated around the light's axis, where there is none.
pub fn phong(lobe: Lobe, lambda: f64, phi_s: f64, n: u32, clamped: bool) -> f64 {
    let kernel = |phi: f64| {
        let mut value = 0.0;
        phong_recurrence(phi, phi_s, clamped, n, |k, v| value = if k == n { v } else { value });
        value
    };
    let value = |phi: f64| kernel(phi) * arriving(lobe, lambda, phi);
    let kink = (FRAC_PI_2 - phi_s).abs();
    let mut cuts = [0.0, kink, PI - kink, PI, phi_s.min(PI)];
    cuts.sort_by(f64::total_cmp);
    cuts.windows(2)
        .map(|cut| {
            let middle = 0.5 * (cut[0] + cut[1]);
            graded(middle, cut[1], 12, value) - graded(middle, cut[0], 12, value)
        })
        .sum()
}

/// `(n + 1) K_n` for each of [`EXPONENTS`]; see [`phong_recurrence`].
fn phong_kernel(phi: f64, phi_s: f64, clamped: bool) -> [f64; EXPONENTS.len()] {
    let mut kernel = [0.0; EXPONENTS.len()];
    let mut next = 0;
    phong_recurrence(phi, phi_s, clamped, EXPONENTS[EXPONENTS.len() - 1], |k, value| {
        if EXPONENTS[next] == k {
            kernel[next] = f64::from(k + 1) * value;
            next += 1;
        }
    });
    kernel
}

/// `K_k = ∫ max(cos, 0)^k dθ` around the light's axis for k = 0 to `last`, of a lobe about an axis at the angle
/// `phi_s` to the light, in directions at the angle `phi` to it: 1.4 of the errata. Unclamped it is the lobe and
/// its mirror image behind, as (13) has them.
fn phong_recurrence(phi: f64, phi_s: f64, clamped: bool, last: u32, mut found: impl FnMut(u32, f64)) {
    let (a, b) = (phi_s.cos() * phi.cos(), phi_s.sin() * phi.sin());
    let c = (b - a) * (b + a);
    let [mut before, mut now] = match () {
        () if a >= b || !clamped => [PI, PI * a],
        () if a <= -b => [0.0, 0.0],
        () => {
            let half = (-a / b).acos();
            [half, a * half + c.max(0.0).sqrt()]
        }
    };
    for k in 0..=last {
        let value = match k {
            0 => before,
            1 => now,
            _ => {
                let k = f64::from(k);
                let value = ((2.0 * k - 1.0) * a * now + (k - 1.0) * c * before) / k;
                (before, now) = (now, value);
                value
            }
        };
        found(k, 2.0 * value);
    }
}

/// Where among [`EXPONENTS`] a Phong exponent lies: two layers for each doubling. What a lobe gathers runs about
/// straight in 1/(n + 1), so that is what weighs between two layers.
pub fn phong_layer(exponent: f64) -> f64 {
    let n = exponent.clamp(0.0, f64::from(EXPONENTS[EXPONENTS.len() - 1]));
    let (below, low, high) = if n < 2.0 {
        (n.floor(), n.floor(), n.floor() + 1.0)
    } else {
        let octave = n.log2().floor();
        let (start, half) = (octave.exp2(), f64::from(u8::from(n >= 1.5 * octave.exp2())));
        (2.0 * octave + half, start * (1.0 + 0.5 * half), start * (1.5 + 0.5 * half))
    };
    below + (n - low) / (high - low) * (high + 1.0) / (n + 1.0)
}

/// A table of `Γ` (as printed) or of the form that does not cancel: λ along x, logarithmic; along y γ from −π/2 to
/// π/2, or for the second form tan(γ/2) from −1 to 1, which shaders find without an arc tangent.
pub fn build_airlight(lobe: Lobe, [width, height]: [usize; 2], rest: bool) -> Table2 {
    let axes = [
        Axis::Log { low: AIRLIGHT_DOMAIN.0, high: AIRLIGHT_DOMAIN.1 },
        if rest {
            Axis::Linear { low: -1.0, high: 1.0 }
        } else {
            Axis::Linear { low: -FRAC_PI_2, high: FRAC_PI_2 }
        },
    ];
    let angle = |j: usize| {
        let place = axes[1].parameter(j as f64 / (height - 1) as f64);
        match (j + 1 == height, rest) {
            (true, _) => FRAC_PI_2,
            (false, true) => 2.0 * place.atan(),
            (false, false) => place,
        }
    };
    let lambda = |i: usize| axes[0].parameter(i as f64 / (width - 1) as f64);
    // From texel to texel along γ, so that each holds the sum of short integrals.
    let columns: Vec<Vec<f64>> = (0..width)
        .into_par_iter()
        .map(|i| {
            let lambda = lambda(i);
            let mut column = vec![0.0; height];
            if rest {
                column[height - 2] = gamma_rest(lobe, lambda, angle(height - 2));
                for j in (0..height - 2).rev() {
                    let [a, b] = [angle(j), angle(j + 1)];
                    let piece = gauss(a, b, |x| phase(lobe, x) * (-lambda * (u(x) - u(a))).exp());
                    column[j] = piece + (-lambda * (u(b) - u(a))).exp() * column[j + 1];
                }
            } else {
                let middle = height / 2;
                let value = |a: f64| phase(lobe, a) * (-lambda * u(a)).exp();
                column[middle] = gamma(lobe, lambda, angle(middle));
                (0..middle)
                    .rev()
                    .for_each(|j| column[j] = column[j + 1] - gauss(angle(j), angle(j + 1), value));
                for j in middle + 1..height {
                    let [a, b] = [angle(j - 1), angle(j)];
                    let piece = if j + 1 == height { graded(a, b, 14, value) } else { gauss(a, b, value) };
                    column[j] = column[j - 1] + piece;
                }
            }
            column
        })
        .collect();
    let samples = (0..height).flat_map(|j| columns.iter().map(move |column| column[j])).collect();
    Table2::from_samples(axes, [width, height], samples)
}

/// Nodes over the angle to the light with their weights.
fn nodes() -> Vec<(f64, f64)> {
    gauss_legendre(NODES).into_iter().map(|(x, w)| (0.5 * PI * (1.0 + x), 0.5 * PI * w)).collect()
}

/// Light that arrives from each node, by optical depth and weighted; with a last row for a directional light,
/// in units of its irradiance times albedo over 4π. As [`arriving`], but what does not depend on the optical
/// depth is found once for all of them.
fn arriving_rows(lobe: Lobe, width: usize, nodes: &[(f64, f64)]) -> Vec<Vec<f64>> {
    let axis = Axis::Log { low: INDIRECT_DOMAIN.0, high: INDIRECT_DOMAIN.1 };
    // For each direction: the integral's nodes as (sin φ · [u(a) − u(a₀)], weight · phase function).
    let inner: Vec<Vec<[f64; 2]>> = nodes
        .par_iter()
        .map(|&(phi, weight)| {
            let start = phi - FRAC_PI_2;
            let mut found = Vec::with_capacity(128);
            let mut panels = |from: f64, to: f64, count: i32, sign: f64| {
                let place = |i: i32| if i == count { to } else { to + (from - to) * 0.5_f64.powi(i) };
                for i in 0..count {
                    let (middle, half) = (0.5 * (place(i) + place(i + 1)), 0.5 * (place(i + 1) - place(i)));
                    found.extend(eight().iter().map(|&(x, w)| {
                        let a = middle + half * x;
                        [phi.sin() * (u(a) - u(start)), sign * half * w * weight * phase(lobe, a)]
                    }));
                }
            };
            let middle = 0.5 * (start + FRAC_PI_2);
            panels(middle, FRAC_PI_2, 6, 1.0);
            panels(middle, start, 10, -1.0);
            found
        })
        .collect();
    let mut rows: Vec<Vec<f64>> = (0..width)
        .into_par_iter()
        .map(|i| {
            let lambda = axis.parameter(i as f64 / (width - 1) as f64);
            inner.iter().map(|nodes| nodes.iter().map(|[v, w]| w * (-lambda * v).exp()).sum()).collect()
        })
        .collect();
    rows.push(nodes.iter().map(|&(phi, w)| w * 4.0 * PI * lobe.eval(phi.cos()) * phi.sin()).collect());
    rows
}

fn indirect_table(size: [usize; 2], second: Axis, samples: Vec<f64>) -> Table2 {
    let axes = [Axis::Log { low: INDIRECT_DOMAIN.0, high: INDIRECT_DOMAIN.1 }, second];
    Table2::from_samples(axes, size, samples)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Tables of [`lambert`]: λ along x, cosine from −1 to 1 along y. The first is for point lights, the second
/// for directional ones, alike along x, in units of irradiance · albedo / 4π.
pub fn build_lambert(lobe: Lobe, clamped: bool) -> [Table2; 2] {
    let [width, height] = LAMBERT_SIZE;
    let axis = Axis::Linear { low: -1.0, high: 1.0 };
    let nodes = nodes();
    let rows = arriving_rows(lobe, width, &nodes);
    let samples: Vec<[Vec<f64>; 2]> = (0..height)
        .into_par_iter()
        .map(|j| {
            let cos_n = axis.parameter(j as f64 / (height - 1) as f64);
            let kernel: Vec<f64> =
                nodes.iter().map(|&(phi, _)| lambert_kernel(phi, cos_n, clamped)).collect();
            let point = rows[..width].iter().map(|row| dot(row, &kernel)).collect();
            [point, vec![dot(&rows[width], &kernel); width]]
        })
        .collect();
    [0, 1].map(|light| {
        let samples = samples.iter().flat_map(|rows| rows[light].iter().copied()).collect();
        indirect_table(LAMBERT_SIZE, axis, samples)
    })
}

/// Tables of `(n + 1) e^λ Γ_P(φ_S, λ)`, one for each of [`EXPONENTS`]: λ along x, the angle between lobe and
/// light from 0 to π along y; first those for point lights, then those for directional ones.
pub fn build_phong(lobe: Lobe, clamped: bool) -> Vec<Table2> {
    let [width, height] = PHONG_SIZE;
    let axis = Axis::Linear { low: 0.0, high: PI };
    let nodes = nodes();
    let rows = arriving_rows(lobe, width, &nodes);
    // For each angle: for each exponent and optical depth, and the directional light last.
    let by_angle: Vec<Vec<f64>> = (0..height)
        .into_par_iter()
        .map(|j| {
            let phi_s = axis.parameter(j as f64 / (height - 1) as f64);
            let kernels: Vec<_> = nodes.iter().map(|&(phi, _)| phong_kernel(phi, phi_s, clamped)).collect();
            let mut sums = Vec::with_capacity(EXPONENTS.len() * rows.len());
            for n in 0..EXPONENTS.len() {
                let kernel: Vec<f64> = kernels.iter().map(|kernel| kernel[n]).collect();
                sums.extend(rows.iter().map(|row| dot(row, &kernel)));
            }
            sums
        })
        .collect();
    let table = |light: usize, n: usize| {
        let place = |i: usize| n * rows.len() + if light == 0 { i } else { width };
        let samples = by_angle.iter().flat_map(|sums| (0..width).map(move |i| sums[place(i)])).collect();
        indirect_table(PHONG_SIZE, axis, samples)
    };
    (0..2).flat_map(|light| (0..EXPONENTS.len()).map(move |n| (light, n))).map(|(l, n)| table(l, n)).collect()
}
