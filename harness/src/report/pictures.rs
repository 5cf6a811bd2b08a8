//! Pictures inside the page: each once, small enough for the whole to be one file.

use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::PngEncoder;
use image::imageops::FilterType;
use rayon::prelude::*;

/// Quality of the JPEG files; what it leaves out is a few of 255 codes.
const QUALITY: u8 = 88;

/// Forms that are tried until all pictures together fit: widest first, without loss before any other.
const FORMS: [Form; 6] = [
    Form { width: 640, lossless: true },
    Form { width: 640, lossless: false },
    Form { width: 480, lossless: false },
    Form { width: 360, lossless: false },
    Form { width: 240, lossless: false },
    Form { width: 120, lossless: false },
];

/// Most that all pictures of measurements, and all figures of papers, may take \[bytes of text\].
const MOST_BYTES: usize = 5 << 20;
const MOST_BYTES_OF_FIGURES: usize = 2 << 20;

/// At most how wide a picture is \[pixels\], and whether every pixel is kept as it is.
#[derive(Clone, Copy, Debug)]
struct Form {
    width: u32,
    lossless: bool,
}

/// Pictures as data URIs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Album {
    index: BTreeMap<String, usize>,
    uris: Vec<String>,
}

impl Album {
    /// Of all files, each once; what can't be read is left out.
    pub(crate) fn load<'a>(
        pictures: impl IntoIterator<Item = &'a str>,
        figures: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let mut album = Self::default();
        album.add(pictures, MOST_BYTES);
        album.add(figures, MOST_BYTES_OF_FIGURES);
        album
    }

    fn add<'a>(&mut self, files: impl IntoIterator<Item = &'a str>, most: usize) {
        let mut files: Vec<&str> = files.into_iter().filter(|file| !file.is_empty()).collect();
        files.sort_unstable();
        files.dedup();
        let mut found = Vec::new();
        for form in FORMS {
            found = files.par_iter().map(|file| data_uri(Path::new(file), form)).collect();
            if found.iter().flatten().map(String::len).sum::<usize>() <= most {
                break;
            }
        }
        for (file, uri) in files.into_iter().zip(found) {
            if let Some(uri) = uri {
                self.index.insert(file.to_owned(), self.uris.len());
                self.uris.push(uri);
            }
        }
    }

    /// Where a file's picture is in [`Album::uris`].
    pub(crate) fn get(&self, file: &str) -> Option<usize> {
        self.index.get(file).copied()
    }

    pub(crate) fn uris(&self) -> &[String] {
        &self.uris
    }
}

/// A picture in a form; a drawing as it is.
fn data_uri(path: &Path, form: Form) -> Option<String> {
    if path.extension().is_some_and(|extension| extension == "svg") {
        let text = std::fs::read(path).ok()?;
        return Some(format!("data:image/svg+xml;base64,{}", STANDARD.encode(text)));
    }
    let picture = image::open(path).ok()?;
    let picture = if picture.width() > form.width {
        picture.resize(form.width, u32::MAX, FilterType::Triangle)
    } else {
        picture
    };
    let (mut bytes, picture) = (Vec::new(), picture.to_rgb8());
    let kind = if form.lossless {
        picture.write_with_encoder(PngEncoder::new(&mut bytes)).ok()?;
        "png"
    } else {
        picture.write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, QUALITY)).ok()?;
        "jpeg"
    };
    Some(format!("data:image/{kind};base64,{}", STANDARD.encode(bytes)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_in_the_page_once_and_a_missing_one_is_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
        let noisy = |width: u32, height: u32| {
            image::RgbImage::from_fn(width, height, |x, y| {
                image::Rgb([(x * 7 + y * 13) as u8, (x * y) as u8, 90])
            })
        };
        noisy(700, 80).save(path("a.png")).unwrap();
        noisy(64, 80).save(path("b.png")).unwrap();
        let (a, b, gone) = (path("a.png"), path("b.png"), path("gone.png"));
        let album = Album::load([a.as_str(), &b, &a, &gone, ""], []);
        assert_eq!(album.uris().len(), 2);
        assert_eq!(album.get(&gone), None);
        let decoded = |album: &Album, file: &str| {
            let (_, text) = album.uris()[album.get(file).unwrap()].split_once(',').unwrap();
            image::load_from_memory(&STANDARD.decode(text).unwrap()).unwrap()
        };
        assert_eq!(decoded(&album, &a).width(), 640);
        assert_eq!(decoded(&album, &b).to_rgb8(), noisy(64, 80), "without loss where that fits");
        // Where they would be too much, they are made smaller.
        let mut small = Album::default();
        small.add([a.as_str(), &b], 20_000);
        assert!(small.uris().iter().map(String::len).sum::<usize>() < 20_000);
        assert!(decoded(&small, &a).width() < 640);
    }
}
