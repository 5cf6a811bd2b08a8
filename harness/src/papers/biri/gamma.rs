//! Figure 3: Γ over its two parameters, from the table that the renderer looks it up in.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use common::Lobe;

use super::super::{Picture, Press};
use crate::failure::Failure;
use crate::falsecolor::colour;
use crate::glyphs::{ADVANCE, ROWS, glyph};

/// Where the plot lies, and how large it is \[pixels\].
const LEFT: u32 = 84;
const TOP: u32 = 40;
const SIZE: [u32; 2] = [500, 400];
/// The bar of colours, and the room for its numbers.
const BAR: u32 = 20;
const RIGHT: u32 = 120;
const BOTTOM: u32 = 64;
/// Enlargement of letters.
const LETTER: u32 = 2;
/// Largest optical depth shown.
const LAMBDA: f64 = 10.0;
/// Texels of the paper setting's table.
const TEXELS: [usize; 2] = [256, 512];

/// Both figures.
pub(super) fn make(press: &Press<'_>) -> Result<(), Failure> {
    for (name, lobe) in [("isotropic", Lobe::Isotropic), ("hazy", Lobe::MieHazy)] {
        press.progress.doing(&format!("figure 3, {name}"));
        let table = biri_ss::table::build_airlight(lobe, TEXELS, false);
        let value = |lambda: f64, angle: f64| table.lookup([lambda, angle]).value;
        press.picture(&format!("figure-3-{name}.png"), heat_map(name, value))?;
        press.progress.step();
    }
    Ok(())
}

/// The function in false colour with lines of equal value, axes and a bar.
fn heat_map(name: &str, function: impl Fn(f64, f64) -> f64) -> Picture {
    let [width, height] = SIZE;
    let at = |x: u32, y: u32| {
        let lambda = LAMBDA * f64::from(x) / f64::from(width - 1);
        let angle = FRAC_PI_2 * (1.0 - 2.0 * f64::from(y) / f64::from(height - 1));
        function(lambda, angle)
    };
    let values: Vec<f64> =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect();
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let step = round_step((high - low) / 16.0);
    let shade = |value: f64| colour(((value - low) / (high - low)) as f32);

    let mut picture = Picture::white(LEFT + width + RIGHT, TOP + height + BOTTOM);
    for y in 0..height {
        for x in 0..width {
            let value = |x: u32, y: u32| values[(y * width + x) as usize];
            let level = |value: f64| (value / step).floor() as i64;
            let here = value(x, y);
            let next = [value((x + 1).min(width - 1), y), value(x, (y + 1).min(height - 1))];
            let line = next.iter().any(|&next| level(next) != level(here));
            // Lines stand out from what they cross.
            let light = (here - low) / (high - low) < 0.55;
            let rgb = match () {
                () if !line => shade(here),
                () if light => [235; 3],
                () => [20; 3],
            };
            picture.set(i64::from(LEFT + x), i64::from(TOP + y), rgb);
        }
    }
    axes(&mut picture, name);
    bar(&mut picture, [low, high], step, shade);
    picture
}

/// 1, 2 or 5 times a power of ten, near `wanted`.
fn round_step(wanted: f64) -> f64 {
    let power = 10f64.powf(wanted.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    steps.into_iter().find(|step| *step >= wanted).unwrap_or(steps[3])
}

fn axes(picture: &mut Picture, name: &str) {
    let [width, height] = SIZE.map(i64::from);
    let (left, top) = (i64::from(LEFT), i64::from(TOP));
    frame(picture, [left - 1, top - 1], [width + 1, height + 1]);
    for lambda in [0, 2, 4, 6, 8, 10] {
        let x = left + (width - 1) * lambda / LAMBDA as i64;
        (0..6).for_each(|y| picture.set(x, top + height + 1 + y, [0; 3]));
        let text = lambda.to_string();
        write(picture, &text, [x - length(&text) / 2, top + height + 10]);
    }
    write(picture, "λ", [left + width / 2 + 42, top + height + 34]);
    for (text, angle) in
        [("-π/2", -FRAC_PI_2), ("-π/4", -FRAC_PI_4), ("0", 0.0), ("π/4", FRAC_PI_4), ("π/2", FRAC_PI_2)]
    {
        let y = top + ((height - 1) as f64 * 0.5 * (1.0 - angle / FRAC_PI_2)).round() as i64;
        (0..6).for_each(|x| picture.set(left - 2 - x, y, [0; 3]));
        write(picture, text, [left - 12 - length(text), y - i64::from(ROWS * LETTER) / 2]);
    }
    write(picture, "γ", [8, top + height / 2 - 50]);
    write(picture, &format!("Γ(λ,γ) {name}"), [left, 12]);
}

/// The bar of colours beside the plot, a number at each line's value.
fn bar(picture: &mut Picture, [low, high]: [f64; 2], step: f64, shade: impl Fn(f64) -> [u8; 3]) {
    let height = i64::from(SIZE[1]);
    let (left, top) = (i64::from(LEFT + SIZE[0] + 20), i64::from(TOP));
    for y in 0..height {
        let value = high - (high - low) * y as f64 / (height - 1) as f64;
        (0..i64::from(BAR)).for_each(|x| picture.set(left + x, top + y, shade(value)));
    }
    frame(picture, [left - 1, top - 1], [i64::from(BAR) + 1, height + 1]);
    let places = if step >= 1.0 { 0 } else { (-step.log10()).ceil() as usize };
    for level in (low / step).ceil() as i64..=(high / step).floor() as i64 {
        let value = level as f64 * step;
        let y = top + ((height - 1) as f64 * (high - value) / (high - low)).round() as i64;
        (0..6).for_each(|x| picture.set(left + i64::from(BAR) + 1 + x, y, [0; 3]));
        let text = format!("{value:.places$}");
        write(picture, &text, [left + i64::from(BAR) + 12, y - i64::from(ROWS * LETTER) / 2]);
    }
}

/// The outline of a box, its corner and its size given.
fn frame(picture: &mut Picture, [left, top]: [i64; 2], [width, height]: [i64; 2]) {
    (0..=width).for_each(|x| [0, height].iter().for_each(|y| picture.set(left + x, top + y, [0; 3])));
    (0..=height).for_each(|y| [0, width].iter().for_each(|x| picture.set(left + x, top + y, [0; 3])));
}

fn length(text: &str) -> i64 {
    text.chars().count() as i64 * i64::from(ADVANCE * LETTER)
}

/// Writes a line of text, its corner at (`left`, `top`).
fn write(picture: &mut Picture, text: &str, [left, top]: [i64; 2]) {
    for (place, letter) in (0i64..).zip(text.chars()) {
        for (row, bits) in (0i64..).zip(glyph(letter)) {
            for column in (0..5i64).filter(|column| bits >> (4 - column) & 1 == 1) {
                let scale = i64::from(LETTER);
                let x = left + (place * i64::from(ADVANCE) + column) * scale;
                let y = top + row * scale;
                (0..scale * scale).for_each(|i| picture.set(x + i % scale, y + i / scale, [0; 3]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        assert_eq!([0.3, 1.0, 1.1, 0.07].map(round_step), [0.5, 1.0, 2.0, 0.1]);
    }

    #[test]
    fn letters_that_are_written_exist() {
        for letter in "Γ(λ,γ) isotropic hazy -π/2 0123456789.".chars().filter(|letter| *letter != ' ') {
            assert_ne!(glyph(letter), [0; 7], "{letter}");
        }
    }
}
