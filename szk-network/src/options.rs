//! What is decided when a renderer is made. Each improvement on the paper is a choice of its own.

use crate::{DirectionSet, Error, Quadrature};

/// Choices of a [`Renderer`](crate::Renderer), fixed at creation.
///
/// With the feature `serde` they are read and written, all but the target's format, which is that of
/// [`Options::default`] until the caller sets it; what is not named is the default, too.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Options {
    /// Format of the target that the cloud is drawn over: `Rgba16Float`, or `Rgba32Float` where the device blends it
    /// (`wgpu::Features::FLOAT32_BLENDABLE`).
    #[cfg_attr(feature = "serde", serde(skip))]
    pub target_format: wgpu::TextureFormat,
    /// Number of directions D, 2 to [`Options::MOST_DIRECTIONS`].
    pub directions: u32,
    /// Which ones.
    pub direction_set: DirectionSet,
    /// Side M of the window \[pixels\], 1 to [`Options::MOST_WINDOW`]; with `None` it is found by
    /// [`Options::OPTICAL_DEPTH`].
    pub window: Option<u32>,
    /// Turn and shift the window of each direction at random.
    pub turned: bool,
    /// What a particle takes of the light that meets it.
    pub opacity: Opacity,
    /// How the phase function is sampled.
    pub quadrature: Quadrature,
    /// Make the phase matrix conserve energy.
    pub conserving: bool,
    /// How light is scattered.
    pub scattering: Scattering,
    /// Which way direct light comes in.
    pub incidence: Incidence,
    /// Colours of the network.
    pub colours: Colours,
    /// Radius of a splat, in radii of the particle's ball, 0.5 to 8.
    pub overlap: f32,
    /// Find direct light for each fragment instead of each particle.
    pub per_fragment: bool,
    /// Correct splats by the ratio of the density to what the splats add up to, so that edges are as sharp as the
    /// density.
    pub corrected: bool,
    /// Most places along a splat that its density and, for each fragment, direct light are found at, 1 to 32: as many
    /// as its optical depth takes.
    pub samples: u32,
}

/// What a particle takes of the light that meets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Opacity {
    /// By the distance to the particle before it: the paper's. Along a line the opacities multiply to exp(−τ).
    Link,
    /// By its own cross section in the area of a pixel, the same for all directions. Light that it scatters may be
    /// scattered again before it leaves. Where many particles share a pixel's column, their opacities multiply to
    /// exp(−τ) of the column.
    Particle,
}

/// How light is scattered from all directions into all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Scattering {
    /// By the whole matrix: D² products for each particle.
    Full,
    /// The same in tiles that a workgroup shares.
    Tiled,
    /// By as few components of the matrix as leave at most this error; see `Components`. Where
    /// that takes more than half of all, as [`Scattering::Full`].
    LowRank {
        /// Largest error of a step, in [0, 1).
        bound: f64,
    },
}

/// Which way direct light comes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Incidence {
    /// In the nearest of the directions: the paper's.
    Nearest,
    /// As it does. Its scattered light is normalised over the directions.
    Exact,
}

/// Colours of the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Colours {
    /// Red, green and blue.
    Rgb,
    /// One for all: a third of memory and time, where neither cloud nor lights nor sky are coloured.
    Grey,
}

impl Options {
    /// Most directions.
    pub const MOST_DIRECTIONS: u32 = 512;
    /// Largest window.
    pub const MOST_WINDOW: u32 = 1022;
    /// Mean optical depth of a particle in its pixel that a window is chosen for, without [`Options::window`].
    pub const OPTICAL_DEPTH: f32 = 0.65;

    /// The paper's own method with its formulas put right: 128 random directions, opacities by link, the whole
    /// matrix, direct light in the nearest direction. It refuses media whose light would grow.
    pub fn paper(target_format: wgpu::TextureFormat) -> Self {
        Self {
            target_format,
            directions: 128,
            direction_set: DirectionSet::Random { seed: 1 },
            window: None,
            turned: false,
            opacity: Opacity::Link,
            quadrature: Quadrature::Points,
            conserving: false,
            scattering: Scattering::Full,
            incidence: Incidence::Nearest,
            colours: Colours::Rgb,
            overlap: 2.0,
            per_fragment: false,
            corrected: false,
            samples: 1,
        }
    }

    /// The best that we know.
    pub fn best(target_format: wgpu::TextureFormat) -> Self {
        Self {
            target_format,
            directions: 128,
            direction_set: DirectionSet::Fibonacci,
            window: None,
            turned: true,
            opacity: Opacity::Particle,
            quadrature: Quadrature::Cells,
            conserving: true,
            scattering: Scattering::LowRank { bound: 0.03 },
            incidence: Incidence::Exact,
            colours: Colours::Rgb,
            overlap: 2.0,
            per_fragment: true,
            corrected: true,
            samples: 16,
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let wrong = |option, value: String, expected| Err(Error::Option { option, value, expected });
        if !(2..=Self::MOST_DIRECTIONS).contains(&self.directions) {
            return wrong("directions", self.directions.to_string(), "2 to 512");
        }
        match self.window {
            Some(window) if !(1..=Self::MOST_WINDOW).contains(&window) => {
                return wrong("window", window.to_string(), "1 to 1022 pixels");
            }
            _ => {}
        }
        match self.scattering {
            Scattering::LowRank { bound } if !(0.0..1.0).contains(&bound) => {
                return wrong("scattering (bound)", bound.to_string(), "0 or more, below 1");
            }
            _ => {}
        }
        if !(0.5..=8.0).contains(&self.overlap) {
            return wrong("overlap", self.overlap.to_string(), "0.5 to 8");
        }
        if !(1..=32).contains(&self.samples) {
            return wrong("samples", self.samples.to_string(), "1 to 32");
        }
        Ok(())
    }
}

impl Default for Options {
    /// [`Options::best`] for a target of `Rgba16Float`, which blends everywhere.
    fn default() -> Self {
        Self::best(wgpu::TextureFormat::Rgba16Float)
    }
}

#[cfg(all(test, feature = "serde"))]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_back_as_written() {
        let options = Options {
            scattering: Scattering::LowRank { bound: 0.1 },
            ..Options::paper(wgpu::TextureFormat::Rgba16Float)
        };
        for options in [options, Options::default()] {
            let text = serde_json::to_string(&options).unwrap();
            assert_eq!(serde_json::from_str::<Options>(&text).unwrap(), options, "{text}");
        }
        assert_eq!(serde_json::from_str::<Options>("{}").unwrap(), Options::default());
        let unknown = serde_json::from_str::<Options>(r#"{"planets": 8}"#).unwrap_err();
        assert!(unknown.to_string().contains("planets"), "{unknown}");
    }
}
