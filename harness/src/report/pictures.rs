//! Pictures inside the page: each once, small enough for the whole to be one file.

use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::codecs::jpeg::JpegEncoder;
use image::imageops::FilterType;
use rayon::prelude::*;

/// Quality of the JPEG files; what it leaves out is a few of 255 codes.
const QUALITY: u8 = 88;

/// Widths that are tried until all pictures together fit \[pixels\].
const WIDTHS: [u32; 5] = [640, 480, 360, 240, 120];

/// Most that all pictures together may take \[bytes of text\].
const MOST_BYTES: usize = 6 << 20;

/// Pictures as data URIs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Album {
    index: BTreeMap<String, usize>,
    uris: Vec<String>,
    /// Files that are not there or can't be read.
    pub missing: usize,
}

impl Album {
    /// Of all `files`, each once; what can't be read is left out.
    pub(crate) fn load<'a>(files: impl IntoIterator<Item = &'a str>) -> Self {
        Self::load_within(files, MOST_BYTES)
    }

    fn load_within<'a>(files: impl IntoIterator<Item = &'a str>, most: usize) -> Self {
        let mut files: Vec<&str> = files.into_iter().filter(|file| !file.is_empty()).collect();
        files.sort_unstable();
        files.dedup();
        let mut found = Vec::new();
        for width in WIDTHS {
            found = files.par_iter().map(|file| data_uri(Path::new(file), width)).collect();
            if found.iter().flatten().map(String::len).sum::<usize>() <= most {
                break;
            }
        }
        let mut album = Self::default();
        for (file, uri) in files.into_iter().zip(found) {
            match uri {
                Some(uri) => {
                    album.index.insert(file.to_owned(), album.uris.len());
                    album.uris.push(uri);
                }
                None => album.missing += 1,
            }
        }
        album
    }

    /// Where a file's picture is in [`Album::uris`].
    pub(crate) fn get(&self, file: &str) -> Option<usize> {
        self.index.get(file).copied()
    }

    pub(crate) fn uris(&self) -> &[String] {
        &self.uris
    }
}

/// A picture of at most `width`; a drawing as it is.
fn data_uri(path: &Path, width: u32) -> Option<String> {
    if path.extension().is_some_and(|extension| extension == "svg") {
        let text = std::fs::read(path).ok()?;
        return Some(format!("data:image/svg+xml;base64,{}", STANDARD.encode(text)));
    }
    let picture = image::open(path).ok()?;
    let picture =
        if picture.width() > width { picture.resize(width, u32::MAX, FilterType::Triangle) } else { picture };
    let mut bytes = Vec::new();
    picture.to_rgb8().write_with_encoder(JpegEncoder::new_with_quality(&mut bytes, QUALITY)).ok()?;
    Some(format!("data:image/jpeg;base64,{}", STANDARD.encode(bytes)))
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
        let files = [a.as_str(), &b, &a, &gone, ""];
        let album = Album::load(files);
        assert_eq!((album.uris().len(), album.missing), (2, 1));
        assert_eq!(album.get(&gone), None);
        let decoded = |uri: &str| {
            let bytes = STANDARD.decode(uri.strip_prefix("data:image/jpeg;base64,").unwrap()).unwrap();
            image::load_from_memory(&bytes).unwrap()
        };
        assert_eq!(decoded(&album.uris()[album.get(&a).unwrap()]).width(), 640);
        assert_eq!(decoded(&album.uris()[album.get(&b).unwrap()]).width(), 64);
        // Where they would be too much, they are made smaller.
        let small = Album::load_within(files, 20_000);
        assert!(small.uris().iter().map(String::len).sum::<usize>() < 20_000);
        assert!(decoded(&small.uris()[small.get(&a).unwrap()]).width() < 640);
    }
}
