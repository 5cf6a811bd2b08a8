//! Straight lines through points, by least squares.

use serde::Serialize;

/// `y = intercept + slope · x`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Fit {
    pub slope: f64,
    pub intercept: f64,
    /// Share of the variance that the line explains.
    pub r2: f64,
}

impl Fit {
    /// Of at least two places; `None` of less or where a number is not finite.
    pub(crate) fn line(points: &[(f64, f64)]) -> Option<Self> {
        let count = points.len() as f64;
        let mean = |value: fn(&(f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / count;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let sum = |product: &dyn Fn(f64, f64) -> f64| -> f64 {
            points.iter().map(|p| product(p.0 - x, p.1 - y)).sum()
        };
        let (xx, xy, yy) = (sum(&|x, _| x * x), sum(&|x, y| x * y), sum(&|_, y| y * y));
        let slope = xy / xx;
        // Points of one height lie on the line.
        let r2 = if yy > 0.0 { xy * xy / (xx * yy) } else { 1.0 };
        let fit = Self { slope, intercept: y - slope * x, r2 };
        (slope.is_finite() && fit.intercept.is_finite() && r2.is_finite()).then_some(fit)
    }

    /// Of `y ∝ x^slope`: the line through the logarithms of positive numbers.
    pub(crate) fn power(points: &[(f64, f64)]) -> Option<Self> {
        Self::line(&points.iter().map(|(x, y)| (x.ln(), y.ln())).collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_powers_are_found_again() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let fit = Fit::line(&[(0.0, 1.0), (1.0, 3.0), (4.0, 9.0)]).unwrap();
        assert!(near(fit.slope, 2.0) && near(fit.intercept, 1.0) && near(fit.r2, 1.0), "{fit:?}");
        // Half of the variance is not the line's.
        let fit = Fit::line(&[(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, 3.0)]).unwrap();
        assert!(near(fit.slope, 1.0) && near(fit.intercept, 1.0) && near(fit.r2, 0.5), "{fit:?}");
        let fit = Fit::power(&[(4.0, 0.5), (8.0, 0.125), (16.0, 0.03125)]).unwrap();
        assert!(near(fit.slope, -2.0) && near(fit.r2, 1.0), "{fit:?}");
        assert_eq!(Fit::line(&[(1.0, 2.0), (2.0, 2.0)]).unwrap().r2, 1.0);
        assert_eq!(
            [Fit::line(&[]), Fit::line(&[(1.0, 2.0)]), Fit::power(&[(1.0, 0.0), (2.0, 1.0)])],
            [None; 3]
        );
    }
}
