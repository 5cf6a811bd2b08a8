//! How many panels the quadrature of `shaders/airlight.wgsl` needs for a phase function: no more than it
//! takes.

use std::f64::consts::FRAC_PI_2;

use crate::Phase;
use crate::quadrature::gauss_legendre;

/// Most panels that are used; a mean cosine of ±0.99 stays within a hundredth with them.
pub const MOST_PANELS: u32 = 16;

/// Relative error that the panels keep the scattered light of a whole ray within, medium left out.
const TOLERANCE: f64 = 2e-4;

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
    (least..MOST_PANELS).find(good).unwrap_or(MOST_PANELS)
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
        assert_eq!(panels_for(&Phase::isotropic(), 3), 3, "never fewer than asked for");
    }
}
