//! Tables of precomputed functions: texel centres carry the samples, look-up is bilinear.
//!
//! A table owns its mapping: callers speak of the function's own parameters, the table of texels. The
//! WGSL twin of the look-up is `shaders/table.wgsl`.

use rayon::prelude::*;

/// How a parameter is laid along an axis: from the parameter to `[0, 1]` and back. 0 and 1 are the
/// centres of the first and last texel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis {
    /// Evenly from `low` to `high`.
    Linear {
        /// Parameter at the first texel's centre.
        low: f64,
        /// Parameter at the last texel's centre.
        high: f64,
    },
    /// Evenly in the logarithm; both ends positive.
    Log {
        /// Parameter at the first texel's centre.
        low: f64,
        /// Parameter at the last texel's centre.
        high: f64,
    },
}

impl Axis {
    /// Where `parameter` lies, in `[0, 1]` inside the domain and beyond it outside.
    pub fn position(&self, parameter: f64) -> f64 {
        match *self {
            Self::Linear { low, high } => (parameter - low) / (high - low),
            Self::Log { low, high } => (parameter / low).ln() / (high / low).ln(),
        }
    }

    /// Inverse of [`Axis::position`].
    pub fn parameter(&self, position: f64) -> f64 {
        match *self {
            Self::Linear { low, high } => low + position * (high - low),
            Self::Log { low, high } => low * (high / low).powf(position),
        }
    }

    /// Whether `parameter` lies within the domain.
    pub fn contains(&self, parameter: f64) -> bool {
        (0.0..=1.0).contains(&self.position(parameter))
    }
}

/// A looked-up value, and whether the parameters had to be clamped into the table's domain to get it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookup {
    /// The interpolated value.
    pub value: f64,
    /// True where the value is that of the nearest point of the domain.
    pub clamped: bool,
}

/// A function of two parameters. Axis 0 is x.
#[derive(Clone, Debug)]
pub struct Table2 {
    axes: [Axis; 2],
    size: [usize; 2],
    samples: Vec<f64>,
}

impl Table2 {
    /// Tabulates `function` at the texel centres of a table of `size` texels, in parallel, in f64.
    pub fn build(axes: [Axis; 2], size: [usize; 2], function: impl Fn(f64, f64) -> f64 + Sync) -> Self {
        let [width, height] = size;
        let parameter = |axis: usize, i: usize| {
            axes[axis].parameter(if size[axis] > 1 { i as f64 / (size[axis] - 1) as f64 } else { 0.0 })
        };
        let samples = (0..height)
            .into_par_iter()
            .flat_map_iter(|y| {
                let (function, at_y) = (&function, parameter(1, y));
                (0..width).map(move |x| function(parameter(0, x), at_y))
            })
            .collect();
        Self { axes, size, samples }
    }

    /// A table whose samples are there already, row by row.
    ///
    /// # Panics
    /// When there are not as many as texels.
    pub fn from_samples(axes: [Axis; 2], size: [usize; 2], samples: Vec<f64>) -> Self {
        assert_eq!(samples.len(), size[0] * size[1], "as many samples as texels");
        Self { axes, size, samples }
    }

    /// Texels along x and y.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The sample at texel (`x`, `y`).
    pub fn sample(&self, x: usize, y: usize) -> f64 {
        self.samples[y * self.size[0] + x]
    }

    /// Bilinear look-up; parameters outside the domain are clamped into it, and that is reported.
    pub fn lookup(&self, parameters: [f64; 2]) -> Lookup {
        let mut clamped = false;
        let mut cell = [(0, 0, 0.0); 2];
        for axis in 0..2 {
            let last = self.size[axis] - 1;
            let position = self.axes[axis].position(parameters[axis]);
            clamped |= last > 0 && !(0.0..=1.0).contains(&position);
            let texel = position.clamp(0.0, 1.0) * last as f64;
            let low = (texel.floor() as usize).min(last.saturating_sub(1));
            cell[axis] = (low, (low + 1).min(last), texel - low as f64);
        }
        let [(x0, x1, fx), (y0, y1, fy)] = cell;
        let mix = |a: f64, b: f64, f: f64| a + (b - a) * f;
        let top = mix(self.sample(x0, y0), self.sample(x1, y0), fx);
        let bottom = mix(self.sample(x0, y1), self.sample(x1, y1), fx);
        Lookup { value: mix(top, bottom, fy), clamped }
    }

    /// The samples in f32, row by row, as a texture holds them.
    pub fn to_f32(&self) -> Vec<f32> {
        self.samples.iter().map(|&sample| sample as f32).collect()
    }

    /// Largest relative error of the look-up against `function` at the centres of the cells between
    /// texels, where interpolation is worst. `function` is called once per cell.
    pub fn worst_error(&self, function: impl Fn(f64, f64) -> f64 + Sync) -> f64 {
        let between = |axis: usize, i: usize| {
            let cells = (self.size[axis] - 1).max(1) as f64;
            self.axes[axis].parameter((i as f64 + if self.size[axis] > 1 { 0.5 } else { 0.0 }) / cells)
        };
        (0..(self.size[1] - 1).max(1))
            .into_par_iter()
            .map(|j| {
                let y = between(1, j);
                (0..(self.size[0] - 1).max(1))
                    .map(|i| {
                        let x = between(0, i);
                        let exact = function(x, y);
                        (self.lookup([x, y]).value - exact).abs() / exact.abs().max(f64::MIN_POSITIVE)
                    })
                    .fold(0.0, f64::max)
            })
            .reduce(|| 0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example(x: f64, y: f64) -> f64 {
        (-x * y).exp() / (1.0 + x)
    }

    fn table() -> Table2 {
        let axes = [Axis::Log { low: 1e-3, high: 10.0 }, Axis::Linear { low: 0.5, high: 2.0 }];
        Table2::build(axes, [129, 65], example)
    }

    #[test]
    fn texel_centres_carry_the_samples() {
        let table = table();
        // The corners are the ends of the domain, exactly.
        assert_eq!(table.lookup([1e-3, 0.5]).value, example(1e-3, 0.5));
        let end = table.lookup([10.0, 2.0]);
        assert!((end.value / example(10.0, 2.0) - 1.0).abs() < 1e-12);
        assert!((table.lookup([0.1, 1.25]).value / example(0.1, 1.25) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn positions_round_trip() {
        for axis in [Axis::Log { low: 1e-7, high: 6.0 }, Axis::Linear { low: -3.0, high: 4.0 }] {
            for position in [0.0, 0.123, 0.5, 1.0] {
                assert!((axis.position(axis.parameter(position)) - position).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn leaving_the_domain_is_clamped_and_said() {
        let table = table();
        assert!(!table.lookup([1.0, 1.0]).clamped);
        let outside = table.lookup([20.0, 1.0]);
        assert!(outside.clamped);
        assert_eq!(outside.value, table.lookup([10.0, 1.0]).value);
    }

    #[test]
    fn the_worst_error_falls_fourfold_when_texels_double() {
        let axes = [Axis::Log { low: 1e-3, high: 10.0 }, Axis::Linear { low: 0.5, high: 2.0 }];
        let error = |n: usize| Table2::build(axes, [n, n], example).worst_error(example);
        let ratio = error(33) / error(65);
        assert!((3.0..5.0).contains(&ratio), "bilinear interpolation is of second order: {ratio}");
        // And the measure can fail: a table of another function is far off.
        assert!(Table2::build(axes, [33, 33], |x, y| example(x, y) * 1.5).worst_error(example) > 0.3);
    }
}
