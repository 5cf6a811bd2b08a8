//! Pictures: mean colours of textures, and light maps.

use std::collections::HashMap;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DVec3, Vec3};
use image::{DynamicImage, ImageReader, Limits};

use super::{LoadError, read, short};
use crate::LightMap;
use crate::image::linear_from_srgb;

/// Most texels along a side.
const MAX_SIDE: u32 = 8192;

/// Largest picture file that is read \[bytes\].
const MAX_PICTURE_BYTES: u64 = 256 << 20;

/// A picture's mean over all texels, alpha not heeded.
#[derive(Clone, Copy)]
pub(crate) struct Mean {
    /// As a colour: linear RGB.
    pub(crate) linear: Vec3,
    /// As data: the values as they are stored, in [0, 1] for a picture of integers.
    pub(crate) stored: Vec3,
}

/// Means of pictures, each read once.
#[derive(Default)]
pub(crate) struct Pictures(HashMap<PathBuf, Result<Mean, String>>);

impl Pictures {
    /// The mean of a picture file, or a clause that says what is wrong with it.
    pub(crate) fn mean(&mut self, path: &Path) -> Result<Mean, String> {
        let entry = self.0.entry(path.into());
        entry
            .or_insert_with(|| {
                let bytes = read(path, MAX_PICTURE_BYTES).map_err(|error| error.to_string())?;
                Mean::of(&bytes).map_err(|problem| format!("{}: {problem}", path.display()))
            })
            .clone()
    }
}

impl Mean {
    /// The mean of an encoded picture, or a clause that says what is wrong with it.
    pub(crate) fn of(bytes: &[u8]) -> Result<Self, String> {
        let picture = decode(bytes)?;
        let count = f64::from(picture.width()) * f64::from(picture.height());
        let (mut linear, mut stored) = (DVec3::ZERO, DVec3::ZERO);
        each_texel(picture, |is, was| {
            linear += is.as_dvec3();
            stored += was.as_dvec3();
        });
        let mean = Self { linear: (linear / count).as_vec3(), stored: (stored / count).as_vec3() };
        if mean.linear.is_finite() { Ok(mean) } else { Err("has texels that are not finite numbers".into()) }
    }
}

/// Reads a picture of light, which messages call `what`; `place` is where its name stands in the file `from`.
pub(crate) fn light_map(
    what: &str,
    path: &Path,
    from: &Path,
    place: &str,
) -> Result<Arc<LightMap>, LoadError> {
    let bytes = read(path, MAX_PICTURE_BYTES)
        .map_err(|error| LoadError::invalid(from, place, format!("{what}: {error}")))?;
    let invalid =
        |problem: String| LoadError::invalid(from, place, format!("{what} {} {problem}", path.display()));
    let picture = decode(&bytes).map_err(|problem| invalid(format!("can't be decoded: {problem}")))?;
    let (width, height) = (picture.width(), picture.height());
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    each_texel(picture, |linear, _| texels.push(linear));
    if texels.iter().any(|t| !t.is_finite() || t.min_element() < 0.0) {
        return Err(invalid(
            "has texels that are negative or not finite; expected a picture of light".into(),
        ));
    }
    Ok(Arc::new(LightMap { width, height, texels }))
}

fn decode(bytes: &[u8]) -> Result<DynamicImage, String> {
    let mut reader =
        ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string())?;
    if reader.format().is_none() {
        return Err("is of an unknown format; expected PNG, JPEG or OpenEXR".into());
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    // A picture of four 32-bit channels, and as much again for the decoder to work in.
    limits.max_alloc = Some(2 * 16 * u64::from(MAX_SIDE) * u64::from(MAX_SIDE));
    reader.limits(limits);
    let picture = reader.decode().map_err(|error| short(&error.to_string()))?;
    if picture.width() == 0 || picture.height() == 0 { Err("has no texels".into()) } else { Ok(picture) }
}

/// Calls `each(linear, stored)` texel by texel, row by row.
fn each_texel(picture: DynamicImage, mut each: impl FnMut(Vec3, Vec3)) {
    match picture {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            for texel in picture.into_rgb32f().pixels() {
                let value = Vec3::from_array(texel.0);
                each(value, value);
            }
        }
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            for texel in picture.into_rgb16().pixels() {
                let stored = texel.0.map(|x| f32::from(x) / 65_535.0);
                each(Vec3::from_array(stored.map(linear_from_srgb)), Vec3::from_array(stored));
            }
        }
        _ => {
            let table: Vec<f32> = (0..=255u8).map(|x| linear_from_srgb(f32::from(x) / 255.0)).collect();
            for texel in picture.into_rgb8().pixels() {
                let linear = texel.0.map(|x| table[usize::from(x)]);
                each(Vec3::from_array(linear), Vec3::from_array(texel.0.map(|x| f32::from(x) / 255.0)));
            }
        }
    }
}
