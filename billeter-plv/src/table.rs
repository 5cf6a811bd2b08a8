//! The paper's look-up table of airlight (supplement, `airlight_components`), for any phase function.
//!
//! With optical depths `t` along the ray and `l` from ray to light, and the angle `a` at the light:
//!
//! - ahead of the foot point: `∫_{-atan(t/l)}^0 p(-sin a) exp(-(t + l tan(a/2 + π/4))) da`
//! - behind it: `∫_0^{atan(t/l)} p(-sin a) exp(-l tan(a/2 + π/4)) da`
//!
//! which is the paper's integral in `z` pre-multiplied by `l`. Differs: the phase function is inside
//! the integral, so that it need not be isotropic; the two parts are two tables, so that no look-up
//! interpolates across the seam between them.

use common::Lobe;
use common::quadrature::gauss_legendre;
use common::table::{Axis, Table2};

/// Least and greatest optical depth of the table: `exp(-16.1181)`, `exp(17.9099 - 16.1181)`.
pub const DOMAIN: (f64, f64) = (1e-7, 6.0);

/// The table's entry ahead of the foot point: light from `t` before it up to it, seen from there.
pub fn compute_ahead(lobe: Lobe, t: f64, l: f64) -> f64 {
    integrate(-(t / l).atan(), 0.0, |a| lobe.eval(-a.sin()) * (-(t + l * tangent(a))).exp())
}

/// The table's entry behind the foot point: light from the foot point up to `t`, seen from the former.
pub fn compute_behind(lobe: Lobe, t: f64, l: f64) -> f64 {
    integrate(0.0, (t / l).atan(), |a| lobe.eval(-a.sin()) * (-l * tangent(a)).exp())
}

/// The two tables of a phase function, ahead and behind, each of `width / 2` × `height` texels.
pub fn build_tables(lobe: Lobe, width: u32, height: u32) -> [Table2; 2] {
    let axis = Axis::Log { low: DOMAIN.0, high: DOMAIN.1 };
    let size = [width as usize / 2, height as usize];
    [
        Table2::build([axis; 2], size, |t, l| compute_ahead(lobe, t, l)),
        Table2::build([axis; 2], size, |t, l| compute_behind(lobe, t, l)),
    ]
}

/// `tan(a/2 + π/4) = (1 + sin a)/cos a`, the form that does not cancel for `a < 0`.
fn tangent(a: f64) -> f64 {
    if a < 0.0 { a.cos() / (1.0 - a.sin()) } else { (1.0 + a.sin()) / a.cos().max(1e-300) }
}

/// Sixteen-point Gauss-Legendre on eight panels, graded towards the far end, where the exponential
/// falls off within the last bit of angle.
fn integrate(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    use std::sync::OnceLock;
    static RULE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    let rule = RULE.get_or_init(|| gauss_legendre(16));
    // The angle 0 is the foot point, where the integrand is smooth; panels shrink away from it.
    let (near, far) = if high > 0.0 { (low, high) } else { (high, low) };
    let mut sum = 0.0;
    let mut start = 0.0;
    for panel in 1..=8 {
        let end = if panel == 8 { 1.0 } else { 1.0 - 0.5f64.powi(panel) };
        let (a, b) = (near + (far - near) * start, near + (far - near) * end);
        sum += rule.iter().map(|&(x, w)| w * f(0.5 * (a + b) + 0.5 * (b - a) * x)).sum::<f64>()
            * 0.5
            * (b - a).abs();
        start = end;
    }
    sum
}
