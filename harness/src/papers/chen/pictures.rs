//! Figures 4 and 5 by the paper's method beside the default, and the noise of the offset by pixel.

use chen_planes::{Options, Visibility};
use common::Scene;
use common::image::Image;
use common::scene::builtin::{WINDOW_TRIANGLES, window_with_map};

use super::super::{Picture, Press};
use super::best;
use super::table::{PaperRow, ROWS};
use super::technique;
use crate::failure::Failure;
use crate::measure::{Drawn, Stage};

/// Steps of progress: three pairs and the noise.
pub(super) const STEPS: u64 = 4;

/// Rows of Table 1 that are shown: file, caption, row.
const SHOWN: [(&str, &str, usize); 3] = [
    ("figure-4-a.png", "Figure 4(a)", 0),
    ("figure-4-f.png", "Figure 4(f)", 5),
    ("figure-5.png", "Figure 5", 6),
];

/// What is enlarged of the picture \[share of its sides\]: left, top, width, height; and by how much.
const CROP: [f32; 4] = [0.24, 0.30, 0.125, 0.125];
const ENLARGED: u32 = 5;

/// Draws all; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let mut text =
        "Left the paper's method with the row's planes, lattice and maps, right the default on the same \
                    maps; surfaces lit, one exposure.\n\n"
            .to_owned();
    for (file, caption, index) in SHOWN {
        press.progress.doing(caption);
        let PaperRow { planes, points, shadow_map, light_map, .. } = ROWS[index];
        let scene = ROWS[index].scene();
        let pair = [ROWS[index].options(), best()];
        let pair = pictures(press, &scene, shadow_map, pair)?;
        let exposure = pair[1].auto_exposure();
        press.picture(file, Picture::grid(&[pair.each_ref().map(|image| Picture::of(image, exposure))]))?;
        text += &format!(
            "![{caption}]({file})\n\n{caption}: `{}`, {planes} planes of {points}x{points}, depth map {shadow_map}², \
             light map {light_map}².\n\n",
            scene.name
        );
        press.progress.step();
    }
    text += &noise(press)?;
    Ok(text)
}

/// The scene lit, in two settings.
fn pictures(
    press: &Press<'_>,
    scene: &Scene,
    shadow_map: u32,
    [first, second]: [Options; 2],
) -> Result<[Image; 2], Failure> {
    let mut stage = Stage::new(press.context, scene, press.size, shadow_map)?;
    let mut draw = |options| {
        crate::interrupt::check()?;
        let mut technique = technique(press, options, press.size)?;
        stage.picture(Some(technique.as_mut()), 0.0, Drawn::Both)
    };
    Ok([draw(first)?, draw(second)?])
}

/// The default without and with the offset by pixel, with as many planes as it has and with few, enlarged.
fn noise(press: &Press<'_>) -> Result<String, Failure> {
    const FILE: &str = "offset.png";
    press.progress.doing("offset by pixel");
    let scene = window_with_map(WINDOW_TRIANGLES, 256);
    let few = Options { planes: 8, visibility: Visibility::PerFragment { samples: 1 }, ..best() };
    let mut rows = Vec::new();
    let mut exposure = None;
    for options in [best(), few] {
        let pair = [false, true].map(|offset| Options { offset, ..options });
        let pair = pictures(press, &scene, 1024, pair)?;
        let exposure = *exposure.get_or_insert(pair[0].auto_exposure());
        rows.push(pair.each_ref().map(|image| Picture::of(&enlarged(image), exposure)));
    }
    press.picture(FILE, Picture::grid(&rows))?;
    press.progress.step();
    Ok(format!(
        "![offset by pixel]({FILE})\n\nPart of `window`, {ENLARGED} times enlarged: left without, right with the \
         offset by pixel. Above the default, which looks so often that the offset has little left to do; below 8 planes \
         with one place each, where bands become noise.\n\n"
    ))
}

/// A part of the picture, each pixel a square.
fn enlarged(image: &Image) -> Image {
    let [left, top, width, height] = CROP;
    let of = |share: f32, side: u32| (share * side as f32) as u32;
    let (left, top) = (of(left, image.width), of(top, image.height));
    let (width, height) =
        (of(width, image.width).max(1) * ENLARGED, of(height, image.height).max(1) * ENLARGED);
    let at =
        |x: u32, y: u32| image.pixels[((top + y / ENLARGED) * image.width + left + x / ENLARGED) as usize];
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect();
    Image { width, height, pixels }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn an_enlarged_part_is_made_of_squares() {
        let pixels = (0..32 * 16).map(|i| Vec3::splat(i as f32)).collect();
        let part = enlarged(&Image { width: 32, height: 16, pixels });
        assert_eq!((part.width, part.height), (4 * ENLARGED, 2 * ENLARGED));
        let first = 4 * 32 + 7;
        let at = |x: u32, y: u32| part.pixels[(y * part.width + x) as usize].x as u32;
        assert_eq!([at(0, 0), at(4, 4), at(5, 0), at(0, 5)], [first, first, first + 1, first + 32]);
        assert_eq!(enlarged(&Image::black(1, 1)).pixels.len(), (ENLARGED * ENLARGED) as usize);
    }
}
