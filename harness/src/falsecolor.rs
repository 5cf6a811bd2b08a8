//! Error maps: relative error as colour, on a logarithmic scale, with a colour bar.

use common::image::{Image, srgb_from_linear};
use glam::Vec3;

use crate::glyphs::{ADVANCE, glyph};

/// Smallest and largest error that have a colour of their own.
pub(crate) const RANGE: (f32, f32) = (1e-4, 1.0);

/// The marks below the bar: a power of ten and how it is written.
pub(crate) const MARKS: [(f32, &str); 5] =
    [(1e-4, "0.01%"), (1e-3, "0.1%"), (1e-2, "1%"), (1e-1, "10%"), (1.0, "100%")];

/// An error map with its colour bar below: sRGB bytes.
pub(crate) struct ErrorMap {
    /// Width \[pixels\].
    pub width: u32,
    /// Height with the bar \[pixels\].
    pub height: u32,
    /// Three bytes a pixel.
    pub bytes: Vec<u8>,
}

/// Height of the bar and of its numbers \[pixels\], at least.
const BAR: u32 = 12;
const NUMBERS: u32 = 16;
/// What stands for NaN and infinity: no colour of the scale.
const BROKEN: [u8; 3] = [255, 0, 255];

/// Draws `|picture − reference|` relative to the reference, both as means of the three colours. Where
/// the reference is darker than a thousandth of its mean, the error is taken relative to that.
///
/// # Panics
/// When the sizes differ.
pub(crate) fn error_map(picture: &Image, reference: &Image) -> ErrorMap {
    assert_eq!((picture.width, picture.height), (reference.width, reference.height), "one size");
    let mean = |pixel: &Vec3| pixel.element_sum() / 3.0;
    let total: f64 = reference.pixels.iter().map(|pixel| f64::from(mean(pixel))).sum();
    let floor = (1e-3 * total / reference.pixels.len().max(1) as f64) as f32;

    let (width, scale) = (picture.width, (picture.width / 320).max(1));
    let height = picture.height + (BAR + NUMBERS) * scale;
    let mut bytes = Vec::with_capacity((width * height * 3) as usize);
    for (a, b) in picture.pixels.iter().zip(&reference.pixels) {
        let error = mean(&(*a - *b).abs());
        let relative = if error == 0.0 { 0.0 } else { error / mean(b).max(floor).max(f32::MIN_POSITIVE) };
        bytes.extend(if a.is_finite() { colour(share(relative)) } else { BROKEN });
    }
    bytes.resize((width * height * 3) as usize, 0);
    let mut map = ErrorMap { width, height, bytes };
    draw_bar(&mut map, picture.height, scale);
    map
}

/// Where an error lies on the scale, in [0, 1].
fn share(error: f32) -> f32 {
    let (low, high) = RANGE;
    ((error.max(low) / low).ln() / (high / low).ln()).clamp(0.0, 1.0)
}

/// Colour of a share in [0, 1]: lightness grows evenly (Oklab), hue runs from violet by red to yellow.
pub(crate) fn colour(share: f32) -> [u8; 3] {
    let lightness = 0.12 + 0.85 * share;
    let hue = (300.0 + 165.0 * share).to_radians();
    let chroma = 0.05 + 0.52 * share * (1.0 - share);
    let rgb = linear_from_oklab(lightness, chroma * hue.cos(), chroma * hue.sin());
    rgb.to_array().map(|linear| (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)
}

/// B. Ottosson, *A perceptual color space for image processing*, 2020.
fn linear_from_oklab(lightness: f32, a: f32, b: f32) -> Vec3 {
    let root = Vec3::new(
        lightness + 0.396_337_78 * a + 0.215_803_76 * b,
        lightness - 0.105_561_346 * a - 0.063_854_17 * b,
        lightness - 0.089_484_18 * a - 1.291_485_5 * b,
    );
    let cone = root * root * root;
    Vec3::new(
        Vec3::new(4.076_741_7, -3.307_711_6, 0.230_969_94).dot(cone),
        Vec3::new(-1.268_438, 2.609_757_4, -0.341_319_4).dot(cone),
        Vec3::new(-0.004_196_086, -0.703_418_6, 1.707_614_7).dot(cone),
    )
}

/// The bar along the bottom, a mark and a number at each power of ten.
fn draw_bar(map: &mut ErrorMap, top: u32, scale: u32) {
    let width = map.width;
    let mut set = |x: u32, y: u32, rgb: [u8; 3]| {
        if x < width {
            let at = ((y * width + x) * 3) as usize;
            map.bytes[at..at + 3].copy_from_slice(&rgb);
        }
    };
    for x in 0..width {
        let rgb = colour(x as f32 / (width - 1).max(1) as f32);
        (0..BAR * scale).for_each(|y| set(x, top + y, rgb));
    }
    let numbers = numbers(width, scale);
    for (index, (value, text)) in MARKS.iter().enumerate() {
        let x = (share(*value) * (width - 1) as f32) as u32;
        for y in 0..3 * scale {
            (0..scale).for_each(|dx| set((x + dx).min(width - 1), top + BAR * scale + y, [255; 3]));
        }
        let Some([left, _]) = numbers[index] else { continue };
        for (place, letter) in text.chars().enumerate() {
            for (row, line) in glyph(letter).into_iter().enumerate() {
                for column in (0..5).filter(|column| line >> (4 - column) & 1 == 1) {
                    let x = left + (place as u32 * ADVANCE + column) * scale;
                    let y = top + (BAR + 5 + row as u32) * scale;
                    for i in 0..scale * scale {
                        set(x + i % scale, y + i / scale, [255; 3]);
                    }
                }
            }
        }
    }
}

/// From where to where the number of each mark stands \[pixels\]: below its mark, the first and the last one within the
/// picture; none where it would run into one that matters more.
fn numbers(width: u32, scale: u32) -> [Option<[u32; 2]>; MARKS.len()] {
    let mut numbers = [None; MARKS.len()];
    for index in [2, 0, 4, 1, 3] {
        let (value, text) = MARKS[index];
        let length = (text.len() as u32 * ADVANCE - 1) * scale;
        let x = (share(value) * (width - 1) as f32) as u32;
        let left = x.saturating_sub(length / 2).min(width.saturating_sub(length));
        let right = left + length;
        let gap = 2 * scale;
        let free = |[from, to]: &[u32; 2]| right + gap < *from || *to + gap < left;
        if right <= width && numbers.iter().flatten().all(free) {
            numbers[index] = Some([left, right]);
        }
    }
    numbers
}

/// The scale as CSS colours, for a report.
pub(crate) fn css_stops() -> String {
    let stop = |i: u32| {
        let [r, g, b] = colour(i as f32 / 16.0);
        format!("rgb({r} {g} {b})")
    };
    (0..=16).map(stop).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use common::image::linear_from_srgb;

    use super::*;

    fn lightness([r, g, b]: [u8; 3]) -> f32 {
        let linear = |byte: u8| linear_from_srgb(f32::from(byte) / 255.0);
        0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b)
    }

    #[test]
    fn a_larger_error_is_a_lighter_colour() {
        let shades: Vec<f32> = (0..=64).map(|i| lightness(colour(i as f32 / 64.0))).collect();
        assert!(shades.is_sorted_by(|a, b| a < b), "{shades:?}");
    }

    #[test]
    fn every_mark_has_its_place_and_glyphs() {
        for (index, (value, text)) in MARKS.iter().enumerate() {
            assert!((share(*value) - index as f32 / 4.0).abs() < 1e-5);
            assert!(text.chars().all(|letter| glyph(letter) != [0; 7]));
        }
    }

    #[test]
    fn numbers_do_not_run_into_each_other() {
        for (width, shown) in [(320, 5), (160, 4), (97, 3), (49, 1), (9, 0)] {
            let mut numbers: Vec<[u32; 2]> = numbers(width, 1).into_iter().flatten().collect();
            assert_eq!(numbers.len(), shown, "{width}: {numbers:?}");
            numbers.sort_unstable();
            assert!(numbers.windows(2).all(|pair| pair[0][1] + 2 < pair[1][0]), "{width}: {numbers:?}");
            assert!(numbers.iter().all(|[_, to]| *to <= width));
        }
    }

    #[test]
    fn right_is_dark_wrong_is_light_and_nan_is_neither() {
        let reference = Image { width: 3, height: 1, pixels: vec![Vec3::ONE; 3] };
        let picture =
            Image { pixels: vec![Vec3::ONE, Vec3::splat(2.0), Vec3::splat(f32::NAN)], ..reference.clone() };
        let map = error_map(&picture, &reference);
        assert_eq!(map.bytes.len(), (map.width * map.height * 3) as usize);
        assert_eq!(map.bytes[..9], [colour(0.0), colour(1.0), BROKEN].concat());
    }
}
