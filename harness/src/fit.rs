//! Lines through measurements, by least squares.

/// `y = intercept + slope · x`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Line {
    pub slope: f64,
    pub intercept: f64,
    /// Share of the variance of y that the line explains; 1 is all of it.
    pub r2: f64,
}

/// The line through (x, y); not a number through fewer than two different x.
pub(crate) fn line(points: &[(f64, f64)]) -> Line {
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(a, b), (x, y)| (a + x / count, b + y / count));
    let moment = |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|(a, b)| f(a - x, b - y)).sum::<f64>();
    let (xx, xy, yy) = (moment(&|a, _| a * a), moment(&|a, b| a * b), moment(&|_, b| b * b));
    let slope = xy / xx;
    // Points in a row along x lie on a line.
    let r2 = if yy == 0.0 && xx > 0.0 { 1.0 } else { xy * xy / (xx * yy) };
    Line { slope, intercept: y - slope * x, r2 }
}

/// Exponent of the power law through (x, y), all positive.
pub(crate) fn order(points: &[(f64, f64)]) -> f64 {
    let logarithms: Vec<_> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    line(&logarithms).slope
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_powers_are_found() {
        let found = line(&[(1.0, 5.0), (2.0, 7.0), (4.0, 11.0)]);
        assert!((found.slope - 2.0).abs() < 1e-12 && (found.intercept - 3.0).abs() < 1e-12);
        assert!((found.r2 - 1.0).abs() < 1e-12);
        let noisy = line(&[(1.0, 5.0), (2.0, 9.0), (4.0, 11.0)]);
        assert!(noisy.r2 < 0.95 && noisy.r2 > 0.5, "{noisy:?}");
        let powers: Vec<_> = [1.0f64, 2.0, 8.0].map(|x| (x, 3.0 * x.powf(-1.5))).into();
        assert!((order(&powers) + 1.5).abs() < 1e-12);
        assert!(line(&[]).slope.is_nan() && line(&[]).r2.is_nan() && order(&[]).is_nan());
    }
}
