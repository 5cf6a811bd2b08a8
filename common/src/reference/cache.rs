//! Finished reference pictures on disk, found by the hash of all that determines them.
//!
//! One file per picture: a line of JSON, the pixels as little-endian f32, and the BLAKE3 hash of
//! all before it. A file that is cut short or damaged in any way is passed over and rebuilt.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::{Error, Options, Reference, Rendered};
use crate::files::write_whole;
use crate::image::Image;
use crate::scene::content::Parts;
use crate::{Term, Terms, View};

/// Counts up with every change of the reference that may change its pictures.
const VERSION: u32 = 4;

/// The first line of a file.
#[derive(Serialize, Deserialize)]
struct Header {
    version: u32,
    width: u32,
    height: u32,
    terms: String,
    uncertainty: f64,
    indirect_uncertainty: f64,
    multiple_uncertainty: f64,
    checked_rays: u32,
    seconds: f64,
}

impl Reference {
    /// As [`Reference::render`], but takes the picture from `directory` if it is there already and
    /// puts it there if not. A picture that can't be stored is returned all the same, with the
    /// reason in [`Rendered::cache_problem`].
    ///
    /// # Errors
    /// As [`Reference::render`].
    pub fn render_cached(
        &self,
        directory: &Path,
        view: &View,
        terms: Terms,
        progress: &(dyn Fn(f32) + Sync),
        cancel: &AtomicBool,
    ) -> Result<Rendered, Error> {
        let path = self.cache_path(directory, view, terms);
        let expected = |rendered: &Rendered| {
            let size = |image: &Option<Image>| image.as_ref().map(|image| (image.width, image.height));
            let asked = |term| terms.contains(term).then_some((view.width, view.height));
            size(&rendered.surface) == asked(Term::Surface)
                && size(&rendered.airlight) == asked(Term::Airlight)
                && size(&rendered.indirect_airlight) == asked(Term::IndirectAirlight)
                && size(&rendered.multiple) == asked(Term::Multiple)
        };
        if let Some(rendered) = std::fs::read(&path).ok().and_then(|bytes| decode(&bytes)).filter(expected) {
            progress(1.0);
            return Ok(rendered);
        }
        let mut rendered = self.render(view, terms, progress, cancel)?;
        let bytes = encode(&rendered, view, terms);
        let stored = std::fs::create_dir_all(directory)
            .and_then(|()| write_whole(&path, |file| file.write_all(&bytes)));
        rendered.cache_problem = stored.err().map(|error| format!("{}: {error}", path.display()));
        Ok(rendered)
    }

    /// The file in `directory` that holds this picture, if it was drawn before.
    fn cache_path(&self, directory: &Path, view: &View, terms: Terms) -> PathBuf {
        let mut parts = Parts::default();
        // What only one term depends on makes no other pictures of the rest.
        let (mut options, usual) = (self.options, Options::default());
        if !terms.contains(Term::IndirectAirlight) {
            options = Options { indirect: usual.indirect, seed: usual.seed, ..options };
        }
        if !terms.contains(Term::Multiple) && self.cloud.is_none() {
            options.multiple = usual.multiple;
        }
        // Debug output gives every float its shortest exact form.
        parts.add(format!("version {VERSION} terms {terms} {view:?} {options:?}").as_bytes());
        parts.add(format!("{:?} {:?}", self.medium, self.materials).as_bytes());
        parts.add(format!("{:?}", self.lights).as_bytes());
        if let Some(cloud) = &self.cloud {
            parts.add_cloud(cloud, &self.sky);
        }
        for triangle in &self.geometry.triangles {
            parts.add(bytemuck::bytes_of(&triangle.positions));
            parts.add(bytemuck::bytes_of(&triangle.normals));
            parts.add(&triangle.material.to_le_bytes());
        }
        directory.join(format!("{}.reference", parts.finish()))
    }
}

fn encode(rendered: &Rendered, view: &View, terms: Terms) -> Vec<u8> {
    let header = Header {
        version: VERSION,
        width: view.width,
        height: view.height,
        terms: terms.to_string(),
        uncertainty: rendered.uncertainty,
        indirect_uncertainty: rendered.indirect_uncertainty,
        multiple_uncertainty: rendered.multiple_uncertainty,
        checked_rays: rendered.checked_rays,
        seconds: rendered.seconds,
    };
    let mut bytes = serde_json::to_vec(&header).unwrap_or_default();
    bytes.push(b'\n');
    let images = [&rendered.surface, &rendered.airlight, &rendered.indirect_airlight, &rendered.multiple];
    for image in images.into_iter().flatten() {
        let numbers = image.pixels.iter().flat_map(|pixel| pixel.to_array());
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
    }
    let hash = blake3::hash(&bytes);
    bytes.extend(hash.as_bytes());
    bytes
}

fn decode(bytes: &[u8]) -> Option<Rendered> {
    let (content, hash) = bytes.split_at_checked(bytes.len().checked_sub(blake3::OUT_LEN)?)?;
    if blake3::hash(content).as_bytes() != hash {
        return None;
    }
    let line = content.iter().position(|byte| *byte == b'\n')?;
    let header: Header = serde_json::from_slice(&content[..line]).ok()?;
    let terms: Terms = header.terms.parse().ok()?;
    let (width, height) = (header.width, header.height);
    let size = usize::try_from(u64::from(width) * u64::from(height)).ok()?.checked_mul(12)?;
    let mut rest = &content[line + 1..];
    let mut image = |term| {
        if !terms.contains(term) {
            return Some(None);
        }
        let (pixels, after) = rest.split_at_checked(size)?;
        rest = after;
        let number = |pixel: &[u8], i: usize| {
            f32::from_le_bytes([pixel[4 * i], pixel[4 * i + 1], pixel[4 * i + 2], pixel[4 * i + 3]])
        };
        let pixels = pixels
            .chunks_exact(12)
            .map(|pixel| Vec3::new(number(pixel, 0), number(pixel, 1), number(pixel, 2)))
            .collect();
        Some(Some(Image { width, height, pixels }))
    };
    let rendered = Rendered {
        surface: image(Term::Surface)?,
        airlight: image(Term::Airlight)?,
        indirect_airlight: image(Term::IndirectAirlight)?,
        multiple: image(Term::Multiple)?,
        uncertainty: header.uncertainty,
        indirect_uncertainty: header.indirect_uncertainty,
        multiple_uncertainty: header.multiple_uncertainty,
        checked_rays: header.checked_rays,
        seconds: header.seconds,
        cached: true,
        cache_problem: None,
    };
    (header.version == VERSION && rest.is_empty()).then_some(rendered)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_come_back_to_the_last_bit() {
        let view = crate::Camera::default().view(1, 1);
        // Nearest floats to decimal fractions, many of which a quick parser misses by one unit.
        for index in 1..2000 {
            let seconds = f64::from(index).sqrt() * 1e-3;
            let rendered = Rendered {
                surface: None,
                airlight: Some(Image::black(1, 1)),
                indirect_airlight: None,
                multiple: None,
                uncertainty: 1.0 / seconds,
                indirect_uncertainty: 0.0,
                multiple_uncertainty: 0.0,
                checked_rays: 3,
                seconds,
                cached: true,
                cache_problem: None,
            };
            let again = decode(&encode(&rendered, &view, Term::Airlight.into()));
            assert_eq!(again, Some(rendered), "{seconds:e}");
        }
    }
}
