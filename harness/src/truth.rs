//! Pictures by paths that others are held against, with the paths' own noise taken out of the errors.

use common::image::Image;
use common::reference::{Options as Settings, multiple};
use common::{Scene, Term, Terms, View};
use glam::Vec3;
use serde::Serialize;

use crate::cmd::reference_with;
use crate::failure::Failure;
use crate::record::ModelError;

/// Paths per pixel of each of two references of a cloud.
const PATHS: u32 = 24;

/// Pixels across of a picture of all light, about: each is the mean of a block of pixels, so that few paths do for each of
/// these, and what is compared is where the light is and not its edges.
const ACROSS: u32 = 80;

/// Paths of either half through such a block, about.
const PATHS_OF_BLOCK: u32 = 192;

/// Two pictures of the same by independent paths: their noise cancels from products of errors.
pub(crate) struct Truth {
    halves: [Image; 2],
    mean: Image,
    /// Standard error of the mean of both, relative RMS.
    pub noise: f64,
}

/// Of a picture against the paths, over what is lit, as everywhere: relative RMSE with the noise of the paths taken
/// out, and bias.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Off {
    pub rel_rmse: f64,
    pub bias: f64,
}

impl Truth {
    /// All that a cloud scatters, in pictures of `size`; `progress` is told the finished part of either.
    pub(crate) fn of(
        scene: &Scene,
        size: (u32, u32),
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Self, Failure> {
        let still = scene.at(0.0);
        let view = still.camera.view(size.0, size.1);
        let terms = Terms::from(Term::Airlight).with(Term::Multiple);
        let half = |seed| {
            let multiple = multiple::Options { samples: PATHS, seed, ..Default::default() };
            let rendered =
                reference_with(&still, &view, terms, Settings { multiple, ..Default::default() }, progress)?;
            Ok(rendered.total())
        };
        Self::from_halves([half(1)?, half(2)?])
    }

    fn from_halves(halves: [Image; 2]) -> Result<Self, Failure> {
        let mut mean = halves[0].plus(&halves[1]);
        mean.pixels.iter_mut().for_each(|pixel| *pixel *= 0.5);
        let mut truth = Self { halves, mean, noise: 0.0 };
        truth.noise = 0.5 * relative(&truth.halves[0], &truth.halves[1])?;
        Ok(truth)
    }

    pub(crate) fn off(&self, image: &Image) -> Result<Off, Failure> {
        let bias = errors(image, &self.mean)?.bias;
        let [a, b] = &self.halves;
        let (mut product, mut sum, mut lit) = (0.0, 0.0, 0.0);
        for (((x, a), b), mean) in image.pixels.iter().zip(&a.pixels).zip(&b.pixels).zip(&self.mean.pixels) {
            if mean.max_element() > 0.0 {
                // What is no number counts as black, as everywhere.
                let x = if x.is_finite() { *x } else { Vec3::ZERO };
                product += (x - *a).as_dvec3().dot((x - *b).as_dvec3());
                sum += mean.as_dvec3().element_sum();
                lit += 3.0;
            }
        }
        let rmse = (product / f64::max(lit, 1.0)).max(0.0).sqrt();
        Ok(Off { rel_rmse: rmse / (sum / f64::max(lit, 1.0)), bias })
    }

    /// What errors may be off by, relative: the root of the standard error of the product of both halves' errors.
    pub(crate) fn uncertainty(&self) -> f64 {
        let lit = self.mean.pixels.iter().filter(|pixel| pixel.max_element() > 0.0).count();
        // Each half has √2 times the noise of the mean; the product of two such has its square in each pixel.
        std::f64::consts::SQRT_2 * self.noise / (lit.max(1) as f64).powf(0.25)
    }

    pub(crate) fn image(&self) -> &Image {
        &self.mean
    }
}

fn errors(image: &Image, other: &Image) -> Result<common::metrics::Errors, Failure> {
    common::metrics::compare(image, other).map_err(|error| Failure::Run(error.to_string()))
}

/// Relative RMSE of a picture against another one.
pub(crate) fn relative(image: &Image, other: &Image) -> Result<f64, Failure> {
    Ok(errors(image, other)?.rel_rmse)
}

/// All light that the medium of a scene with surfaces sends to the eye, however often it was scattered or reflected: what
/// airlight alone is off from because its model is too small.
pub(crate) struct AllLight {
    truth: Truth,
    block: u32,
}

impl AllLight {
    /// Beside the reference's `airlight`, by paths; `progress` is told the finished part of either half.
    pub(crate) fn of(
        scene: &Scene,
        view: &View,
        airlight: &Image,
        progress: &(dyn Fn(f32) + Sync),
    ) -> Result<Self, Failure> {
        let block = (view.width / ACROSS).max(1);
        let samples = PATHS_OF_BLOCK.div_ceil(block * block);
        let single = blocks(airlight, block);
        let half = |seed| {
            let multiple = multiple::Options { samples, seed, ..Default::default() };
            let settings = Settings { multiple, ..Default::default() };
            let rendered = reference_with(scene, view, Terms::from(Term::Multiple), settings, progress)?;
            let more = rendered.multiple.ok_or_else(|| Failure::Run("the reference lacks a term".into()))?;
            Ok(single.plus(&blocks(&more, block)))
        };
        Ok(Self { truth: Truth::from_halves([half(1)?, half(2)?])?, block })
    }

    /// What a picture of the airlight is off by.
    pub(crate) fn error_of(&self, airlight: &Image) -> Result<ModelError, Failure> {
        let Off { rel_rmse, bias } = self.truth.off(&blocks(airlight, self.block))?;
        let terms = [Term::Airlight, Term::Multiple].map(|term| term.name().to_owned());
        Ok(ModelError { terms: terms.to_vec(), rel_rmse, bias, noise: self.truth.noise })
    }
}

/// Means of blocks of pixels; what is left of a row or column is left out.
fn blocks(image: &Image, side: u32) -> Image {
    let (width, height) = (image.width / side, image.height / side);
    let mut means = Image::black(width, height);
    for (index, mean) in means.pixels.iter_mut().enumerate() {
        let (x, y) = (index as u32 % width * side, index as u32 / width * side);
        let row = |y: u32| ((y * image.width + x) as usize, ((y * image.width + x) + side) as usize);
        let rows = (y..y + side).map(row);
        let sum: Vec3 = rows.map(|(first, end)| image.pixels[first..end].iter().copied().sum::<Vec3>()).sum();
        *mean = sum / (side * side) as f32;
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, values: &[f32]) -> Image {
        let mut image = Image::black(width, values.len() as u32 / width);
        image.pixels = values.iter().map(|value| Vec3::splat(*value)).collect();
        image
    }

    #[test]
    fn blocks_are_means() {
        let image = picture(5, &[1.0, 2.0, 3.0, 4.0, 9.0, 5.0, 6.0, 7.0, 8.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0]);
        assert_eq!(blocks(&image, 2), picture(2, &[3.5, 5.5]));
        assert_eq!(blocks(&image, 1), image);
    }

    #[test]
    fn noise_of_the_halves_cancels_from_errors() {
        // Each half is off by as much as the other, by signs of their own: ++, +-, -+, --.
        let truth =
            Truth::from_halves([picture(4, &[11.0, 11.0, 9.0, 9.0]), picture(4, &[11.0, 9.0, 11.0, 9.0])])
                .unwrap();
        assert_eq!(truth.off(&picture(4, &[10.0; 4])).unwrap().rel_rmse, 0.0);
        let off = truth.off(&picture(4, &[8.0; 4])).unwrap();
        assert!((off.rel_rmse - 0.2).abs() < 1e-9 && (off.bias + 0.2).abs() < 1e-6, "{off:?}");
        // A broken pixel is as wrong as a black one.
        let [broken, black] =
            [f32::NAN, 0.0].map(|first| truth.off(&picture(4, &[first, 10.0, 10.0, 10.0])).unwrap());
        assert!(
            (broken.rel_rmse - black.rel_rmse).abs() < 1e-9 && black.rel_rmse > 0.4,
            "{broken:?} {black:?}"
        );
        assert!((truth.uncertainty() - 2f64.sqrt() * truth.noise / 4f64.powf(0.25)).abs() < 1e-9);
        assert!((truth.noise - 0.05 * 2f64.sqrt()).abs() < 1e-9, "{}", truth.noise);
    }
}
