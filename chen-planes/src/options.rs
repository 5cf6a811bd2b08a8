//! What is decided when a renderer is made. Each improvement on the paper is a choice of its own.

use common::gpu::Accumulation;

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
    /// Sampling planes for each light, 1 to [`Options::MOST_PLANES`].
    pub planes: u32,
    /// Lattice points of a plane across and up, 2 to [`Options::MOST_POINTS`] each.
    pub lattice: [u32; 2],
    /// Where along the viewing direction the planes are.
    pub placement: Placement,
    /// What is found at lattice points and what for each fragment.
    pub factor: Factor,
    /// Where shadows and the light's intensity are looked up.
    pub visibility: Visibility,
    /// Shift the samples of each pixel by a fraction of their distance, another one for neighbouring pixels:
    /// noise of a few pixels' size instead of bands.
    pub offset: bool,
    /// Let the depth test end rays at the scene, before the fragments of planes behind it are shaded. It is done
    /// where the depth is a `RENDER_ATTACHMENT` too and has no stencil; else the picture is the same, but takes longer.
    pub early_end: bool,
    /// Texels of the phase function's texture, 16 to 8192.
    pub phase_texels: u32,
    /// What planes are added up in.
    pub accumulation: Accumulation,
}

/// Where along the viewing direction the planes are. Every plane stands for a slab of the view; slabs follow each
/// other without gaps from the eye to the reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Placement {
    /// At equal distances: the paper's.
    Even,
    /// At equal steps of the angle at the light (Kulla and Fajardo 2012), in the mean over the view's rays. A
    /// directional light has no such angle: even.
    EquiAngular,
    /// At equal steps of the transmittance to the eye, in the mean over the view's rays.
    Transmittance,
    /// By the unshadowed integrand `f`: as dense as the cube root of its mean square over the view's rays. An edge of
    /// a shadow within a slab of length Δ is an error of about fΔ; among all densities of so many slabs this one
    /// makes the mean square of that least.
    Integrand,
}

/// What is found at lattice points and what for each fragment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Factor {
    /// The paper's ξ at lattice points: attenuation on both ways over the squared distance from the light.
    Whole,
    /// Attenuation at lattice points, the squared distance for each fragment.
    Attenuation,
    /// Nothing at lattice points. For each fragment, the slab is integrated in the angle at the light, in which
    /// 1/r² is constant; the last slab goes on to infinity.
    Integrated,
}

/// Where shadows and the light's intensity (a spot's falloff and light map) are looked up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Visibility {
    /// At lattice points, interpolated between them: step 3 of the paper. What is narrower than a cell is missed.
    PerLatticePoint,
    /// For each fragment: the paper's text.
    PerFragment {
        /// Places within the slab, 1 to [`Options::MOST_SAMPLES`].
        samples: u32,
    },
}

impl Options {
    /// Most planes for each light.
    pub const MOST_PLANES: u32 = 4096;
    /// Most lattice points across and up.
    pub const MOST_POINTS: u32 = 256;
    /// Most places within a slab.
    pub const MOST_SAMPLES: u32 = 64;

    /// The paper's own method with its formulas put right: a hundred planes at equal distances with lattices of 32²
    /// (Table 1, row 4(e)), shadows and light map for each fragment, 16-bit accumulation.
    pub fn paper(target_format: wgpu::TextureFormat) -> Self {
        Self {
            target_format,
            planes: 100,
            lattice: [32, 32],
            placement: Placement::Even,
            factor: Factor::Whole,
            visibility: Visibility::PerFragment { samples: 1 },
            offset: false,
            early_end: false,
            phase_texels: 1024,
            accumulation: Accumulation::F16,
        }
    }

    /// The best that we know: few slabs placed by the integrand, each integrated for every fragment from many places
    /// where shadows are looked up, shifted pixel by pixel.
    pub fn best(target_format: wgpu::TextureFormat) -> Self {
        Self {
            target_format,
            planes: 8,
            lattice: [2, 2],
            placement: Placement::Integrand,
            factor: Factor::Integrated,
            visibility: Visibility::PerFragment { samples: 64 },
            offset: true,
            early_end: true,
            phase_texels: 2048,
            accumulation: Accumulation::F32,
        }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        let wrong = |option, value: String, expected| Err(Error::Option { option, value, expected });
        if !(1..=Self::MOST_PLANES).contains(&self.planes) {
            return wrong("planes", self.planes.to_string(), "1 to 4096");
        }
        if self.lattice.iter().any(|points| !(2..=Self::MOST_POINTS).contains(points)) {
            let [u, v] = self.lattice;
            return wrong("lattice", format!("{u}×{v}"), "2 to 256 points each way");
        }
        if !(16..=8192).contains(&self.phase_texels) {
            return wrong("phase_texels", self.phase_texels.to_string(), "16 to 8192");
        }
        match self.visibility {
            Visibility::PerFragment { samples } if !(1..=Self::MOST_SAMPLES).contains(&samples) => {
                wrong("visibility (samples)", samples.to_string(), "1 to 64")
            }
            _ => Ok(()),
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
            visibility: Visibility::PerFragment { samples: 3 },
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
