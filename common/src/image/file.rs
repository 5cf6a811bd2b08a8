//! Picture files.

use std::path::Path;

use glam::Vec3;
use image::{ImageBuffer, Rgb};

use super::Image;
use crate::files::write_whole;

impl Image {
    /// Writes an `OpenEXR` file of 32-bit linear radiance; whole or not at all.
    ///
    /// # Errors
    /// When the file can't be written.
    ///
    /// # Panics
    /// When there are not as many pixels as width and height say.
    pub fn write_exr(&self, path: &Path) -> Result<(), image::ImageError> {
        let raw: Vec<f32> = self.pixels.iter().flat_map(|p| p.to_array()).collect();
        let buffer: ImageBuffer<Rgb<f32>, _> =
            ImageBuffer::from_raw(self.width, self.height, raw).expect("three numbers per pixel");
        write_whole(path, |file| buffer.write_to(file, image::ImageFormat::OpenExr))
    }

    /// Writes a tone-mapped PNG ([`Image::to_srgb8`]); whole or not at all.
    ///
    /// # Errors
    /// When the file can't be written.
    ///
    /// # Panics
    /// When there are not as many pixels as width and height say.
    pub fn write_png(&self, path: &Path, exposure: f32) -> Result<(), image::ImageError> {
        write_rgb8(path, self.width, self.height, self.to_srgb8(exposure))
    }

    /// Reads a picture of linear radiance; an alpha channel is dropped.
    ///
    /// # Errors
    /// When the file can't be read or is no picture.
    pub fn read_exr(path: &Path) -> Result<Self, image::ImageError> {
        let buffer = image::open(path)?.into_rgb32f();
        let pixels = buffer.pixels().map(|Rgb(p)| Vec3::from_array(*p)).collect();
        Ok(Self { width: buffer.width(), height: buffer.height(), pixels })
    }
}

/// Writes sRGB bytes as a PNG; whole or not at all.
///
/// # Errors
/// When the file can't be written.
///
/// # Panics
/// When there are not three bytes for each of the pixels.
pub fn write_rgb8(path: &Path, width: u32, height: u32, bytes: Vec<u8>) -> Result<(), image::ImageError> {
    let buffer: ImageBuffer<Rgb<u8>, _> =
        ImageBuffer::from_raw(width, height, bytes).expect("three bytes per pixel");
    write_whole(path, |file| buffer.write_to(file, image::ImageFormat::Png))
}
