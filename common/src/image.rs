//! Pictures of linear radiance, and (feature `files`) the files that they are written to.

#[cfg(feature = "files")]
mod file;

use glam::Vec3;

#[cfg(feature = "files")]
pub use file::write_rgb8;

/// A picture: linear radiance, RGB \[W m⁻² sr⁻¹\]; pixel centres, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// Row by row, `width` × `height` of them.
    pub pixels: Vec<Vec3>,
}

impl Image {
    /// A black picture.
    pub fn black(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![Vec3::ZERO; (width * height) as usize] }
    }

    /// The sum of two pictures of one size.
    ///
    /// # Panics
    /// When the sizes differ.
    pub fn plus(&self, other: &Self) -> Self {
        assert_eq!((self.width, self.height), (other.width, other.height), "pictures of one size");
        let pixels = self.pixels.iter().zip(&other.pixels).map(|(a, b)| a + b).collect();
        Self { pixels, ..*self }
    }

    /// The exposure that puts the 80th percentile of the luminance of pixels that are not
    /// black at 0.7 before the tone curve \[1 / (W m⁻² sr⁻¹)\]; 1 for a black picture.
    pub fn auto_exposure(&self) -> f32 {
        let mut luminance: Vec<f32> = self
            .pixels
            .iter()
            .map(|p| p.dot(Vec3::new(0.2126, 0.7152, 0.0722)))
            .filter(|l| l.is_finite() && *l > 0.0)
            .collect();
        luminance.sort_by(f32::total_cmp);
        let high = luminance.get(luminance.len() * 80 / 100).copied().unwrap_or(0.0);
        if high > 0.0 { 0.7 / high } else { 1.0 }
    }

    /// Tone-mapped for a screen: `x ↦ 1 − exp(−x)` after `exposure` \[1 / (W m⁻² sr⁻¹)\], then the sRGB curve; three
    /// bytes RGB a pixel.
    pub fn to_srgb8(&self, exposure: f32) -> Vec<u8> {
        self.pixels
            .iter()
            .flat_map(|pixel| {
                let shown = Vec3::ONE - (-(*pixel * exposure).max(Vec3::ZERO)).exp();
                [shown.x, shown.y, shown.z].map(|linear| (srgb_from_linear(linear) * 255.0 + 0.5) as u8)
            })
            .collect()
    }
}

/// The sRGB transfer curve; both sides in [0, 1].
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// Inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(srgb: f32) -> f32 {
    if srgb <= 0.040_45 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}
