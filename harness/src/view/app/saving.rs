//! Pictures of the window as files.

use common::image::{Image, write_rgb8};

use super::App;
use crate::view::picture::Shown;
use crate::view::save;

impl App {
    /// Writes what is seen as a PNG, and the first technique's radiance as an EXR.
    pub(in crate::view) fn save_picture(&mut self) {
        let written = self.write_picture();
        self.said = written.unwrap_or_else(|problem| problem);
    }

    fn write_picture(&self) -> Result<String, String> {
        let name = save::free(std::path::Path::new(""), "view", &["png", "exr"]);
        let (png, exr) = (name.with_extension("png"), name.with_extension("exr"));
        let failed = |error: image::ImageError| {
            format!("can't write {}: {}", name.display(), crate::cmd::cause(&error))
        };
        let image = self.sides[0].image(&self.context).ok_or("there is no picture yet")?;
        image.write_exr(&exr).map_err(failed)?;
        let exposure = self.look.exposure.unwrap_or(1.0);
        match (&self.error, self.pair()) {
            (Some(error), _) if self.look.shown == Shown::Error => {
                write_rgb8(&png, error.map.width, error.map.height, error.map.bytes.clone())
                    .map_err(failed)?;
            }
            (_, Some((first, second, _))) if self.second() => {
                divided(&first, &second, self.look.divided).write_png(&png, exposure).map_err(failed)?;
            }
            _ => image.write_png(&png, exposure).map_err(failed)?,
        }
        Ok(format!("wrote {} and {}", png.display(), exr.display()))
    }
}

/// Two pictures of one size, divided by an upright line.
fn divided(first: &Image, second: &Image, share: f32) -> Image {
    let mut image = first.clone();
    let width = first.width.max(1);
    for (index, pixel) in image.pixels.iter_mut().enumerate() {
        let x = index as u32 % width;
        if (x as f32 + 0.5) / width as f32 >= share {
            *pixel = second.pixels[index];
        }
    }
    image
}
