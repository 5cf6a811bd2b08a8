//! Numerical integration in f64: Gauss-Legendre rules of any order, and an adaptive rule for
//! integrands of three colours.

use std::f64::consts::PI;

use glam::DVec3;

/// Nodes and weights of the Gauss-Legendre rule of `n` points on [−1, 1], nodes ascending: exact
/// for polynomials of degree `2n − 1`. Empty for `n = 0`.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let mut rule = vec![(0.0, 0.0); n];
    for i in 0..n.div_ceil(2) {
        // Newton's iteration from an asymptotic guess (Abramowitz and Stegun 22.16.6).
        let mut x = ((i as f64 + 0.75) / (n as f64 + 0.5) * PI).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            let (value, derivative) = legendre(n, x);
            slope = derivative;
            let step = value / derivative;
            x -= step;
            if step.abs() < 1e-15 {
                slope = legendre(n, x).1;
                break;
            }
        }
        if 2 * i + 1 == n {
            x = 0.0;
        }
        let weight = 2.0 / ((1.0 - x * x) * slope * slope);
        rule[i] = (-x, weight);
        rule[n - 1 - i] = (x, weight);
    }
    rule
}

/// The Legendre polynomial of degree `n` ≥ 1 and its derivative, for |x| < 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
    }
    (value, n as f64 * (x * value - before) / (x * x - 1.0))
}

/// What [`integrate`] found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integral {
    /// The integral, colour by colour.
    pub value: DVec3,
    /// Estimated absolute error of the worst colour.
    pub error: f64,
}

/// Most panels that [`integrate`] cuts its interval into.
const MAX_PANELS: usize = 400;

/// Integrates `f` over [a, b] until the estimated error of the worst colour is below
/// `relative_tolerance` times the largest colour of the integral.
///
/// Adaptive: the panel of the largest error is halved until the sum is good enough or there are
/// 400 panels, in which case `error` tells how good it got. `f` is never asked at `a` or `b`. The
/// same arguments give the same bits.
pub fn integrate(mut f: impl FnMut(f64) -> DVec3, a: f64, b: f64, relative_tolerance: f64) -> Integral {
    let whole = Panel::new(&mut f, a, b);
    let (mut value, mut error) = (whole.value, whole.error);
    if error <= relative_tolerance * value.abs().max_element() {
        return Integral { value, error };
    }
    let mut panels = vec![whole];
    while panels.len() < MAX_PANELS {
        let (worst, &Panel { a, b, .. }) =
            panels.iter().enumerate().max_by(|x, y| x.1.error.total_cmp(&y.1.error)).expect("not empty");
        let middle = 0.5 * (a + b);
        if !(a.min(b) < middle && middle < a.max(b)) {
            break;
        }
        panels[worst] = Panel::new(&mut f, a, middle);
        panels.push(Panel::new(&mut f, middle, b));
        value = panels.iter().map(|panel| panel.value).sum();
        error = panels.iter().map(|panel| panel.error).sum();
        if error <= relative_tolerance * value.abs().max_element() {
            break;
        }
    }
    Integral { value, error }
}

/// A part of the interval with its integral by the 15-point Kronrod rule.
struct Panel {
    a: f64,
    b: f64,
    value: DVec3,
    error: f64,
}

/// Positive nodes and the centre of the Kronrod rule of 15 points, from the outside in, with its
/// weight and the weight of the 7-point Gauss rule that shares every second node.
const KRONROD: [(f64, f64, f64); 8] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_56, 0.129_484_966_168_869_7),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
    (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
];

impl Panel {
    fn new(f: &mut impl FnMut(f64) -> DVec3, a: f64, b: f64) -> Self {
        let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
        let mut samples = [DVec3::ZERO; 15];
        let (mut kronrod, mut gauss) = (DVec3::ZERO, DVec3::ZERO);
        for (i, &(node, fine, coarse)) in KRONROD.iter().enumerate() {
            samples[i] = f(centre - half * node);
            let mut both = samples[i];
            if i < 7 {
                samples[14 - i] = f(centre + half * node);
                both += samples[14 - i];
            }
            kronrod += fine * both;
            gauss += coarse * both;
        }
        // The difference of the two rules is the error of the coarser one; the finer one's is
        // judged by it relative to how much the integrand varies (Piessens et al. 1983, QUADPACK).
        let mean = 0.5 * kronrod;
        let variation: DVec3 =
            (0..15).map(|i| KRONROD[i.min(14 - i)].1 * (samples[i] - mean).abs()).sum::<DVec3>();
        let difference = (kronrod - gauss).abs();
        let error = (0..3)
            .map(|i| {
                let (difference, variation) = (difference[i], variation[i]);
                if difference == 0.0 || variation == 0.0 {
                    return difference;
                }
                variation * (200.0 * difference / variation).powf(1.5).min(1.0)
            })
            .fold(0.0, f64::max);
        Self { a, b, value: kronrod * half, error: error * half.abs() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_legendre_is_exact_to_its_degree_and_no_further() {
        for n in 1..40 {
            let rule = gauss_legendre(n);
            let moment = |k: i32| rule.iter().map(|(x, w)| w * x.powi(k)).sum::<f64>();
            for k in 0..2 * n as i32 {
                let exact = if k % 2 == 0 { 2.0 / f64::from(k + 1) } else { 0.0 };
                assert!((moment(k) - exact).abs() < 1e-14, "n {n}, degree {k}: {}", moment(k));
            }
            let beyond = 2 * n as i32;
            assert!(n > 12 || (moment(beyond) - 2.0 / f64::from(beyond + 1)).abs() > 1e-9, "n {n}");
            assert!(rule.windows(2).all(|pair| pair[0].0 < pair[1].0), "nodes ascend");
        }
        assert!(gauss_legendre(0).is_empty());
    }

    #[test]
    fn the_kronrod_rule_is_exact_to_degree_22() {
        for k in 0..=22 {
            let panel = Panel::new(&mut |x: f64| DVec3::splat(x.powi(k)), 0.0, 1.0);
            assert!((panel.value.x - 1.0 / f64::from(k + 1)).abs() < 1e-15, "degree {k}");
        }
    }

    #[test]
    fn integrals_with_a_peak_a_kink_and_a_singular_end() {
        let f = |x: f64| DVec3::new(1.0 / (1e-6 + x * x), (x - 0.3).abs(), 1.0 / x.abs().sqrt());
        let exact =
            DVec3::new((1.0 / 1e-3_f64).atan() / 1e-3, (0.3_f64.powi(2) + 0.7_f64.powi(2)) / 2.0, 2.0);
        for colour in 0..3 {
            let found = integrate(|x| DVec3::X * f(x)[colour], 0.0, 1.0, 1e-9);
            let error = (found.value.x / exact[colour] - 1.0).abs();
            assert!(error < 1e-9, "{colour}: {found:?}, off by {error}");
            assert!(found.error <= 1e-9 * exact[colour]);
        }
    }

    #[test]
    fn an_integral_that_diverges_ends_and_says_so() {
        let found = integrate(|x| DVec3::splat(1.0 / x), 0.0, 1.0, 1e-10);
        assert!(found.error > 1e-6);
        assert_eq!(integrate(|_| DVec3::ONE, 2.0, 2.0, 1e-6).value, DVec3::ZERO);
    }
}
