//! What is decided when a renderer is made. Each improvement on the paper is a choice of its own.

use common::gpu::{Accumulation, TableFormat};
use common::panels::MOST_PANELS;

use crate::Error;

/// Choices of a [`Renderer`](crate::Renderer), fixed at creation.
///
/// With the feature `serde` they are read and written, all but the target's format, which is that of
/// [`Options::default`] until the caller sets it; what is not named is the default, too.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Options {
    /// Format of the targets that radiance is added to: `Rgba16Float`, or `Rgba32Float` where the device
    /// blends it (`wgpu::Features::FLOAT32_BLENDABLE`).
    #[cfg_attr(feature = "serde", serde(skip))]
    pub target_format: wgpu::TextureFormat,
    /// How the airlight up to a plane is found.
    pub airlight: Airlight,
    /// In which order shadow planes are drawn.
    pub order: Order,
    /// From which end of a ray the shadows are counted.
    pub counting: Counting,
    /// Add the airlight that all planes of a ray begin with once, instead of with each plane: a plane then takes one
    /// look-up and no integral. Needs [`Airlight::GammaRest`] and [`Counting::FromEye`].
    pub shared_beginning: bool,
    /// What planes are added up in.
    pub accumulation: Accumulation,
    /// What the tables of indirect light hold.
    pub indirect: Indirect,
    /// Leave out planes that the view does not show.
    pub cull: bool,
    /// Casters so far from a point or spot light that, through the medium, no more than this share of what gets
    /// to the eye gets there throw no shadow; 0 lets all of them, most 0.01.
    pub faintest: f32,
    /// Take rounding below zero, where planes cancel, for zero. Off only to measure that rounding.
    pub clamp_negative: bool,
}

/// How the airlight from the eye to a plane is found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Airlight {
    /// The paper's `Γ(λ, γ)`, two look-ups. Loses digits where the light is behind the eye.
    Gamma {
        /// Texels along λ, 4 to 4096.
        width: u32,
        /// Texels along γ, 4 to 4096.
        height: u32,
        /// Bits of a texel.
        format: TableFormat,
    },
    /// The same integral from the other end, which does not cancel there. Spots with a soft edge and phase
    /// functions of a mean cosine beyond 0.955 are integrated.
    GammaRest {
        /// Texels along λ, 4 to 4096.
        width: u32,
        /// Texels along γ, 4 to 4096.
        height: u32,
        /// Bits of a texel.
        format: TableFormat,
    },
    /// Gauss-Legendre in the angle at the light. No table and no domain; spots may have soft edges.
    Quadrature {
        /// Least number of panels on either side of the foot point, 1 to 16; a peaked phase function takes
        /// as many more as it needs.
        panels: u32,
    },
}

/// In which order shadow planes are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Order {
    /// Whole planes by the angle at the light to the middle of their edge: the paper's sort. Planes that
    /// cross or interleave come out wrong.
    Angle,
    /// By a binary space partition of all directions from the light, which splits planes where it has to:
    /// without mistakes, and found anew only when light or casters move.
    Exact,
}

/// From which end of a ray the shadows are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Counting {
    /// The paper's: from the surface. Shadow volumes with caps are drawn against the scene's depth
    /// (depth-fail), then their planes once more, back to front.
    DepthFail,
    /// From the eye, whose shadows are counted on the CPU: planes are drawn once, front to back, without caps,
    /// and what is left in the stencil says which surfaces are lit.
    FromEye,
}

/// What the tables of indirect light hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Indirect {
    /// The paper's: light from behind the surface counts as negative, and where there is no direct light
    /// there is no indirect light either.
    Unclamped,
    /// Light from the hemisphere above the surface, everywhere.
    Clamped,
}

impl Options {
    /// The paper's own method with its formulas put right: `Γ` as a table, planes sorted whole, shadows
    /// counted by depth-fail, 16-bit accumulation, indirect light unclamped.
    pub fn paper(target_format: wgpu::TextureFormat) -> Self {
        Self {
            target_format,
            airlight: Airlight::Gamma { width: 256, height: 512, format: TableFormat::F32 },
            order: Order::Angle,
            counting: Counting::DepthFail,
            shared_beginning: false,
            accumulation: Accumulation::F16,
            indirect: Indirect::Unclamped,
            cull: false,
            faintest: 0.0,
            clamp_negative: true,
        }
    }

    /// The best that we know.
    pub fn best(target_format: wgpu::TextureFormat) -> Self {
        Self {
            target_format,
            airlight: Airlight::GammaRest { width: 256, height: 512, format: TableFormat::F32 },
            order: Order::Exact,
            counting: Counting::FromEye,
            shared_beginning: true,
            accumulation: Accumulation::F32,
            indirect: Indirect::Clamped,
            cull: true,
            faintest: 1e-5,
            clamp_negative: true,
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        match self.airlight {
            Airlight::Gamma { width, height, .. } | Airlight::GammaRest { width, height, .. }
                if !(4..=4096).contains(&width) || !(4..=4096).contains(&height) =>
            {
                Err(Error::Option {
                    option: "airlight (table size)",
                    value: format!("{width}×{height}"),
                    expected: "4 to 4096 texels each way",
                })
            }
            Airlight::Quadrature { panels } if !(1..=MOST_PANELS).contains(&panels) => Err(Error::Option {
                option: "airlight (panels)",
                value: panels.to_string(),
                expected: "1 to 16",
            }),
            airlight
                if self.shared_beginning
                    && (!matches!(airlight, Airlight::GammaRest { .. })
                        || self.counting != Counting::FromEye) =>
            {
                Err(Error::Option {
                    option: "shared_beginning",
                    value: "true".into(),
                    expected: "false, or airlight: GammaRest and counting: FromEye",
                })
            }
            _ if !(0.0..=0.01).contains(&self.faintest) => Err(Error::Option {
                option: "faintest",
                value: self.faintest.to_string(),
                expected: "0 to 0.01",
            }),
            _ => Ok(()),
        }
    }
}

impl Default for Options {
    /// [`Options::best`] for targets of `Rgba16Float`, which blends everywhere.
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
            airlight: Airlight::Quadrature { panels: 3 },
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
