//! How far a picture is from its reference, on linear radiance.

use glam::DVec3;

use crate::image::Image;

/// Errors of a picture against a reference of the same terms.
///
/// **The mask** is where the reference is lit: its luminance (Rec. 709 weights) is above 10⁻⁶ of
/// its largest. **The mean** is the mean of the reference over the mask and the three colours; all
/// relative figures are relative to it. Every mean and sum is taken over the three colours alike.
///
/// A pixel of the picture that is not finite is counted and enters all other figures as black,
/// which is what a screen would show: it is never left out. A pixel of the reference that is not
/// finite can't judge anything: it is counted and left out of all other figures.
///
/// Where the reference is black altogether, relative figures are 0 for a black picture and infinite
/// for any other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// RMS error over the mask, relative to the mean.
    pub rel_rmse: f64,
    /// Mean signed error over the mask, relative to the mean; positive where the picture is too
    /// bright.
    pub bias: f64,
    /// 99th percentile over **all** pixels of the largest absolute error of a pixel's colours,
    /// relative to the mean: the least value that 99 % of the pixels don't exceed.
    pub p99: f64,
    /// Largest absolute error of any colour of any pixel, relative to the mean.
    pub max: f64,
    /// Largest RMS error of a tile of 64 × 64 pixels (less at the right and lower rim), over **all**
    /// its pixels, relative to the mean of the whole picture's mask.
    pub worst_tile: f64,
    /// RMS, over the pixels outside the mask, of the picture's radiance less the reference's,
    /// relative to the mean: light where there should be none. 0 if the mask is the whole picture.
    pub leak: f64,
    /// Sum of the picture over the sum of the reference, all pixels; 1 if both are 0.
    pub energy_ratio: f64,
    /// Number of the picture's pixels with a NaN.
    pub nan: u32,
    /// Number of the picture's pixels with an infinity and no NaN.
    pub inf: u32,
    /// Number of the picture's pixels with a colour below zero.
    pub negative: u32,
    /// Number of the reference's pixels that are not finite.
    pub reference_not_finite: u32,
    /// Number of pixels in the mask.
    pub lit: u32,
}

/// Side of the tiles of [`Errors::worst_tile`] \[pixels\].
pub const TILE: u32 = 64;

/// Luminance, as a share of the reference's largest, above which a pixel is lit.
pub const LIT: f64 = 1e-6;

/// Two pictures that can't be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {}×{} pixels can't be compared with a reference of {}×{}", .image.0, .image.1, .reference.0, .reference.1)]
pub struct SizesDiffer {
    /// Width and height of the picture \[pixels\].
    pub image: (u32, u32),
    /// Width and height of the reference \[pixels\].
    pub reference: (u32, u32),
}

fn luminance(pixel: DVec3) -> f64 {
    pixel.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// The errors of `image` against `reference`.
///
/// # Errors
/// When the pictures have different sizes.
pub fn compare(image: &Image, reference: &Image) -> Result<Errors, SizesDiffer> {
    let sizes = [(image.width, image.height), (reference.width, reference.height)];
    if sizes[0] != sizes[1] || image.pixels.len() != reference.pixels.len() {
        return Err(SizesDiffer { image: sizes[0], reference: sizes[1] });
    }
    let count = |test: &dyn Fn(glam::Vec3) -> bool| image.pixels.iter().filter(|p| test(**p)).count() as u32;
    let mut errors = Errors {
        rel_rmse: 0.0,
        bias: 0.0,
        p99: 0.0,
        max: 0.0,
        worst_tile: 0.0,
        leak: 0.0,
        energy_ratio: 1.0,
        nan: count(&|p| p.is_nan()),
        inf: count(&|p| !p.is_finite() && !p.is_nan()),
        negative: count(&|p| p.min_element() < 0.0),
        reference_not_finite: reference.pixels.iter().filter(|p| !p.is_finite()).count() as u32,
        lit: 0,
    };

    let brightest = reference
        .pixels
        .iter()
        .filter(|p| p.is_finite())
        .map(|p| luminance(p.as_dvec3()))
        .fold(0.0, f64::max);
    let (mut lit, mut dark) = (Sum::default(), Sum::default());
    let (mut shown, mut wanted, mut masked) = (0.0, 0.0, 0.0);
    let mut worst_colours = Vec::with_capacity(image.pixels.len());
    let tiles = [image.width.div_ceil(TILE), image.height.div_ceil(TILE)];
    let mut per_tile = vec![Sum::default(); tiles[0] as usize * tiles[1] as usize];
    for (index, (pixel, truth)) in image.pixels.iter().zip(&reference.pixels).enumerate() {
        if !truth.is_finite() {
            continue;
        }
        let pixel = if pixel.is_finite() { pixel.as_dvec3() } else { DVec3::ZERO };
        let truth = truth.as_dvec3();
        let error = pixel - truth;
        shown += pixel.element_sum();
        wanted += truth.element_sum();
        worst_colours.push(error.abs().max_element());
        let (x, y) = (index as u32 % image.width, index as u32 / image.width);
        per_tile[(y / TILE * tiles[0] + x / TILE) as usize].add(error);
        if brightest > 0.0 && luminance(truth) > LIT * brightest {
            lit.add(error);
            masked += truth.element_sum();
        } else {
            dark.add(error);
        }
    }

    errors.lit = lit.count;
    let mean = masked / (3.0 * f64::from(lit.count.max(1)));
    let relative = |value: f64| if value == 0.0 { 0.0 } else { value / mean };
    errors.rel_rmse = relative(lit.rms());
    errors.bias = relative(lit.signed / (3.0 * f64::from(lit.count.max(1))));
    errors.leak = relative(dark.rms());
    errors.worst_tile = relative(per_tile.iter().map(Sum::rms).fold(0.0, f64::max));
    if shown != wanted {
        errors.energy_ratio = shown / wanted;
    }
    worst_colours.sort_by(f64::total_cmp);
    let rank = (worst_colours.len() * 99).div_ceil(100).max(1) - 1;
    errors.p99 = relative(worst_colours.get(rank).copied().unwrap_or(0.0));
    errors.max = relative(worst_colours.last().copied().unwrap_or(0.0));
    Ok(errors)
}

/// A sum of errors over pixels.
#[derive(Clone, Copy, Default)]
struct Sum {
    count: u32,
    squared: f64,
    signed: f64,
}

impl Sum {
    fn add(&mut self, error: DVec3) {
        self.count += 1;
        self.squared += error.length_squared();
        self.signed += error.element_sum();
    }

    /// Over pixels and colours.
    fn rms(&self) -> f64 {
        (self.squared / (3.0 * f64::from(self.count.max(1)))).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn image(width: u32, pixels: &[[f32; 3]]) -> Image {
        let pixels: Vec<Vec3> = pixels.iter().map(|p| Vec3::from_array(*p)).collect();
        Image { width, height: pixels.len() as u32 / width, pixels }
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found}, not {expected}");
    }

    #[test]
    fn by_hand() {
        // Lit: the first three; mean = (1+1+1 + 2+2+2 + 3+3+3)/9 = 2.
        let reference = image(2, &[[1.0; 3], [2.0; 3], [3.0; 3], [0.0; 3]]);
        let picture = image(2, &[[1.5, 1.0, 1.0], [2.0; 3], [3.0, 2.0, 3.0], [0.25, 0.0, 0.0]]);
        let errors = compare(&picture, &reference).unwrap();
        assert_eq!(errors.lit, 3);
        near(errors.rel_rmse, ((0.25_f64 + 1.0) / 9.0).sqrt() / 2.0);
        near(errors.bias, (0.5 - 1.0) / 9.0 / 2.0);
        near(errors.leak, (0.0625_f64 / 3.0).sqrt() / 2.0);
        near(errors.worst_tile, ((0.25_f64 + 1.0 + 0.0625) / 12.0).sqrt() / 2.0);
        near(errors.max, 0.5);
        near(errors.p99, 0.5);
        near(errors.energy_ratio, (18.0 - 0.25) / 18.0);
        assert_eq!((errors.nan, errors.inf, errors.negative, errors.reference_not_finite), (0, 0, 0, 0));
    }

    #[test]
    fn the_same_picture_has_no_error() {
        let picture = image(3, &[[0.1, 0.2, 0.3], [0.0; 3], [4.0; 3]]);
        let errors = compare(&picture, &picture).unwrap();
        let all = [errors.rel_rmse, errors.bias, errors.p99, errors.max, errors.worst_tile, errors.leak];
        assert_eq!(all, [0.0; 6]);
        assert_eq!(errors.energy_ratio, 1.0);
    }

    #[test]
    fn broken_pixels_are_counted_and_shown_as_black() {
        let reference = image(4, &[[1.0; 3], [1.0; 3], [1.0; 3], [1.0; 3]]);
        let broken =
            image(4, &[[f32::NAN, 1.0, -1.0], [f32::INFINITY, 1.0, 1.0], [1.0; 3], [1.0, 1.0, -1.0]]);
        let errors = compare(&broken, &reference).unwrap();
        assert_eq!((errors.nan, errors.inf, errors.negative), (1, 1, 2));
        near(errors.rel_rmse, ((3.0_f64 + 3.0 + 4.0) / 12.0).sqrt());
        let unsure = image(4, &[[f32::INFINITY; 3], [1.0; 3], [1.0; 3], [1.0; 3]]);
        let errors = compare(&reference, &unsure).unwrap();
        assert_eq!((errors.reference_not_finite, errors.lit, errors.rel_rmse), (1, 3, 0.0));
    }

    #[test]
    fn a_percentile_and_tiles_of_a_larger_picture() {
        // 100 by 80 pixels: 2 by 2 tiles. One error of 1 in 80 pixels (1 %) of the last column
        // stays just outside the percentile; all of it lies in the two tiles at the right.
        let reference = Image { pixels: vec![Vec3::ONE; 8000], ..Image::black(100, 80) };
        let mut picture = reference.clone();
        for y in 0..80 {
            picture.pixels[y * 100 + 99] = Vec3::splat(2.0);
        }
        let errors = compare(&picture, &reference).unwrap();
        assert_eq!((errors.p99, errors.max), (0.0, 1.0));
        near(errors.rel_rmse, 0.1);
        near(errors.worst_tile, (1.0_f64 / 36.0).sqrt());
        picture.pixels[0] = Vec3::splat(1.5);
        near(compare(&picture, &reference).unwrap().p99, 0.5);
    }

    #[test]
    fn a_black_reference_and_pictures_that_do_not_fit() {
        let black = Image::black(2, 2);
        let errors = compare(&black, &black).unwrap();
        assert_eq!((errors.rel_rmse, errors.max, errors.energy_ratio, errors.lit), (0.0, 0.0, 1.0, 0));
        let lit = Image { pixels: vec![Vec3::ONE; 4], ..black };
        let errors = compare(&lit, &Image::black(2, 2)).unwrap();
        assert_eq!(
            (errors.leak, errors.max, errors.energy_ratio),
            (f64::INFINITY, f64::INFINITY, f64::INFINITY)
        );
        let error = compare(&lit, &Image::black(4, 1)).unwrap_err();
        assert!(error.to_string().contains("2×2"), "{error}");
        let empty = compare(&Image::black(0, 0), &Image::black(0, 0)).unwrap();
        assert_eq!(empty.max, 0.0);
    }
}
