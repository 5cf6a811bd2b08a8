//! How many panels the quadrature of `shaders/airlight.wgsl` needs for a phase function: no more than it
//! takes.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use crate::Phase;
use crate::quadrature::gauss_legendre;

/// Most panels that are used; a mean cosine of ±0.99 stays within a hundredth with them.
pub const MOST_PANELS: u32 = 16;

/// Relative error that the panels keep the scattered light of a whole ray within, medium left out.
const TOLERANCE: f64 = 2e-4;
/// The same within a medium and of rays that end early.
const TOLERANCE_IN_MEDIUM: f64 = 4e-4;
/// Optical depths of the light's distance from a ray, and angles at the light at which rays end, that are looked at: with
/// them what is left of a backward peak becomes narrower than the peak.
const DEPTHS: [f64; 2] = [1e-2, 1e-1];
const ENDS: [f64; 2] = [1.0, 0.92];

/// Least number of panels, not below `least`, that integrate `phase` over the angle at the light.
pub fn panels_for(phase: &Phase, least: u32) -> u32 {
    let value = |angle: f64| phase.eval(-angle.sin());
    // The shader's rules: four nodes a panel up to the foot point; beyond it eight in q, angle = π/2 (1 - q²).
    let (four, eight, many) = (gauss_legendre(4), gauss_legendre(8), gauss_legendre(32));
    let rule = |nodes: &[(f64, f64)], panels: u32, f: &dyn Fn(f64) -> glam::DVec3| {
        let half = 0.5 / f64::from(panels);
        let panel = |i: u32| (2.0 * f64::from(i) + 1.0) * half;
        (0..panels)
            .flat_map(|i| nodes.iter().map(move |&(x, w)| (panel(i) + half * x, half * w)))
            .map(|(x, w)| w * f(x))
            .sum::<glam::DVec3>()
    };
    let before = |x: f64| FRAC_PI_2 * value(-FRAC_PI_2 * x);
    let after = |q: f64| 2.0 * FRAC_PI_2 * q * value(FRAC_PI_2 * (1.0 - q * q));
    let exact = [rule(&many, 32, &before), rule(&many, 32, &after)];
    let good = |panels: &u32| {
        let off = [rule(&four, *panels, &before) - exact[0], rule(&eight, *panels, &after) - exact[1]];
        off.iter().zip(&exact).all(|(off, exact)| (off.abs() / *exact).max_element() < TOLERANCE)
    };
    let panels = (least..MOST_PANELS).find(good).unwrap_or(MOST_PANELS);
    // What lies behind the light, within a medium.
    let fading =
        DEPTHS.iter().flat_map(|depth| ENDS.map(|end| (*depth, end * FRAC_PI_2))).map(|(depth, end)| {
            move |q: f64| {
                let angle = end * (1.0 - q * q);
                let path = (0.5 * angle + FRAC_PI_4).tan();
                2.0 * end * q * value(angle) * (-depth * path).exp()
            }
        });
    fading.fold(panels, |panels, fading| {
        let exact = rule(&many, 4, &fading);
        let whole = (exact + rule(&many, 4, &before)).max(glam::DVec3::splat(f64::MIN_POSITIVE));
        let good = |panels: &u32| {
            ((rule(&eight, *panels, &fading) - exact).abs() / whole).max_element() < TOLERANCE_IN_MEDIUM
        };
        (panels..MOST_PANELS).find(good).unwrap_or(MOST_PANELS)
    })
}

#[cfg(test)]
mod tests {
    use crate::Lobe;

    use super::*;

    #[test]
    fn peaked_phase_functions_take_more_panels() {
        let panels = |lobe: Lobe| panels_for(&lobe.into(), 1);
        assert_eq!(panels(Lobe::Isotropic), 1);
        assert!(panels(Lobe::Rayleigh) <= 2);
        let by_g: Vec<u32> = [0.0, 0.5, 0.8, 0.95].map(|g| panels(Lobe::HenyeyGreenstein { g })).into();
        assert!(by_g.windows(2).all(|pair| pair[0] <= pair[1]) && by_g[3] > 2, "{by_g:?}");
        let backward: Vec<u32> =
            [0.0, -0.3, -0.8, -0.9, -0.95].map(|g| panels(Lobe::HenyeyGreenstein { g })).into();
        assert_eq!(backward[..2], [1, 1], "what is smooth costs no more");
        assert!(backward.windows(2).all(|pair| pair[0] <= pair[1]) && backward[4] > 3, "{backward:?}");
        assert_eq!(panels_for(&Phase::isotropic(), 3), 3, "never fewer than asked for");
    }
}
