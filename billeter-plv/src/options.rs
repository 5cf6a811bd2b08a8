//! What is decided when a renderer is made. Each improvement on the paper is a choice of its own.

use common::gpu::Accumulation;
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
    /// Format of the target that airlight is added to: `Rgba16Float`, or `Rgba32Float` where the device
    /// blends it (`wgpu::Features::FLOAT32_BLENDABLE`).
    #[cfg_attr(feature = "serde", serde(skip))]
    pub target_format: wgpu::TextureFormat,
    /// How the lit volume and a view ray meet. With [`Volume::Rays`], of the options below only the panels of
    /// [`Evaluation::Quadrature`] are used.
    pub volume: Volume,
    /// How the airlight of a face is found.
    pub evaluation: Evaluation,
    /// How finely the shadow map becomes a mesh.
    pub tessellation: Tessellation,
    /// Where the map's depth jumps, let the volume's wall stand upright in the middle between two texels
    /// instead of sloping from one to the other: edges are then off by 0.29 texels in the root mean
    /// square, not 0.41.
    pub upright_walls: bool,
    /// What faces are added up in.
    pub accumulation: Accumulation,
    /// Take rounding below zero, where faces cancel, for zero. Off only to measure that rounding.
    pub clamp_negative: bool,
}

/// How the lit volume of a shadow map and a view ray meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Volume {
    /// The volume's surface is a mesh that is drawn: the paper's method. The cost is that of the faces' pixels.
    Mesh,
    /// Each ray walks through a min-max quadtree of the shadow map and finds its lit intervals, exact to the texel
    /// (nearest, not interpolated); each is then integrated by itself. The cost is that of the intervals. Takes a
    /// texture of 4/3 of the shadow map's size.
    Rays,
}

/// How the airlight from the eye to a face is found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Evaluation {
    /// The paper's two-part look-up table: log-log, pre-multiplied by the optical depth of the light's
    /// distance from the ray. Covers optical depths 1e-7 to 6; rays beyond are integrated.
    Table {
        /// Texels along the ray's optical depth, ahead of and behind the foot point together, 4 to 8192.
        width: u32,
        /// Texels along the optical depth of the light's distance from the ray, 2 to 8192.
        height: u32,
        /// Bits of a texel.
        format: common::gpu::TableFormat,
    },
    /// Gauss-Legendre in the angle at the light: four nodes a panel up to the foot point, eight beyond,
    /// graded towards the far end. No table and no domain; spots may have soft edges.
    Quadrature {
        /// Least number of panels on either side of the foot point, 1 to 16; a peaked phase function takes
        /// as many more as it needs.
        panels: u32,
    },
}

/// How finely the shadow map becomes a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Tessellation {
    /// One vertex for each texel, two triangles for each cell.
    Full,
    /// As many as it takes to keep left-out vertices within a tolerance; without cracks.
    Adaptive {
        /// Farthest that a left-out vertex lies from the mesh, as a fraction of the scene's reach (its
        /// radius, or the light's distance from its centre if that is more) or of the distance from eye to
        /// point or spot light if that is less, in (0, 1).
        tolerance: f32,
    },
}

impl Tessellation {
    /// Adaptive, with a tolerance that the eye does not see: for maps of 4096² and more, or where vertices cost more than
    /// fragments. (The paper's supplement advises the same.)
    pub const ADAPTIVE: Self = Self::Adaptive { tolerance: 5e-4 };
}

impl Options {
    /// The paper's own method with its formulas put right: every texel a vertex, table of 1024×512,
    /// 16-bit accumulation.
    pub fn paper(target_format: wgpu::TextureFormat) -> Self {
        Self {
            target_format,
            volume: Volume::Mesh,
            evaluation: Evaluation::Table { width: 1024, height: 512, format: common::gpu::TableFormat::F32 },
            tessellation: Tessellation::Full,
            upright_walls: false,
            accumulation: Accumulation::F16,
            clamp_negative: true,
        }
    }

    /// The best mesh that we know: upright walls, quadrature, 32-bit accumulation.
    pub fn best(target_format: wgpu::TextureFormat) -> Self {
        Self {
            target_format,
            volume: Volume::Mesh,
            evaluation: Evaluation::Quadrature { panels: 1 },
            tessellation: Tessellation::Full,
            upright_walls: true,
            accumulation: Accumulation::F32,
            clamp_negative: true,
        }
    }

    /// Exact lit intervals per ray in place of a mesh; see [`Volume::Rays`].
    pub fn rays(target_format: wgpu::TextureFormat) -> Self {
        Self { volume: Volume::Rays, ..Self::best(target_format) }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        match self.evaluation {
            Evaluation::Table { width, height, .. }
                if !(4..=8192).contains(&width) || !(2..=8192).contains(&height) =>
            {
                Err(Error::Option {
                    option: "evaluation (table size)",
                    value: format!("{width}×{height}"),
                    expected: "4 to 8192 by 2 to 8192 texels",
                })
            }
            Evaluation::Quadrature { panels } if !(1..=MOST_PANELS).contains(&panels) => Err(Error::Option {
                option: "evaluation (panels)",
                value: panels.to_string(),
                expected: "1 to 16",
            }),
            _ => match self.tessellation {
                Tessellation::Adaptive { tolerance } if !(tolerance > 0.0 && tolerance < 1.0) => {
                    Err(Error::Option {
                        option: "tessellation (tolerance)",
                        value: tolerance.to_string(),
                        expected: "more than 0, less than 1",
                    })
                }
                _ => Ok(()),
            },
        }
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
            tessellation: Tessellation::ADAPTIVE,
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
