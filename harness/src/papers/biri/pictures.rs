//! Figures 10 and 11: what each term adds, and snapshots.

use biri_ss::Options;
use common::image::Image;
use glam::Vec3;

use super::super::{Picture, Press};
use crate::cmd::load;
use crate::deferred::{Stage, Wanted};
use crate::failure::Failure;
use crate::report::{digits, markdown, percent};

/// Figure 11: letter, scene, and a time at which much is to be seen \[s\].
const SNAPSHOTS: [(&str, &str, f32); 3] =
    [("a", "pen", 0.4), ("b", "complex", 2.0), ("c", "complex-camera", 4.0)];

/// Figure 10; its numbers as Markdown, and the share of indirect light on surfaces in the picture.
pub(super) fn grid(press: &Press<'_>) -> Result<(String, f64), Failure> {
    press.progress.doing("figure 10");
    let scene = load("still-life", None, |note| press.progress.say(note))?.at(0.0);
    let mut stage = Stage::new(press.context, &scene, press.size)?;
    let mut renderer = stage.renderer(&Options::best(press.context.radiance_format()))?;
    let full = stage.pictures(&mut renderer, &scene, Wanted { indirect: true, ..Default::default() })?;
    let open = stage.pictures(&mut renderer, &scene, Wanted { unshadowed: true, ..Default::default() })?;
    // The paper's third step: whole view rays, where they end on what the light reaches.
    let third_step = Image {
        pixels: std::iter::zip(&open.airlight.pixels, &full.surfaces.pixels)
            .map(|(airlight, surface)| if *surface == Vec3::ZERO { Vec3::ZERO } else { *airlight })
            .collect(),
        ..open.airlight
    };
    let exposure = full.total().auto_exposure();
    let columns =
        [full.surfaces.clone(), full.surfaces.plus(&third_step), full.surfaces.plus(&full.airlight)];
    let rows = [columns.clone(), columns.map(|column| column.plus(&full.indirect))];

    let cell = |image: &Image| Picture::of(&halved(image), exposure);
    let cells = rows.map(|row| row.each_ref().map(cell));
    press.picture("figure-10.png", Picture::grid(&cells))?;

    let sum = |image: &Image| -> f64 { image.pixels.iter().map(|p| p.as_dvec3().element_sum()).sum() };
    let [surfaces, airlight, indirect] = [&full.surfaces, &full.airlight, &full.indirect].map(sum);
    let [open, third_step] =
        [sum(&Image { pixels: open.airlight.pixels, ..third_step.clone() }), sum(&third_step)];
    let total = surfaces + airlight + indirect;
    let row = |what: &str, value: f64, of: f64| vec![what.to_owned(), digits(value), percent(value / of)];
    let table = markdown::table(&[
        ["term", "sum over pixels and colours [W/(m² sr)]", "share of the whole picture"]
            .map(str::to_owned)
            .to_vec(),
        row("surfaces, direct light", surfaces, total),
        row("airlight with shadows", airlight, total),
        row("indirect single scattering on surfaces", indirect, total),
        row("all", total, total),
    ]);
    let text = format!(
        "Columns: surfaces; with the airlight of whole view rays, but only those that end on what the light \
         reaches (the paper's third step: the airlight without casters, black where no direct light falls); \
         with the airlight as the volumetric shadows leave it. Rows: without and with indirect single \
         scattering on surfaces. One exposure ({}); each cell is the picture of {}x{} at half its size. \
         Drawn by the default setting; surfaces have their shadows everywhere.\n\n{table}\n\
         Volumetric shadows take away {} of the airlight that the scene would have without casters ({}). The \
         third step alone leaves {} of it, {} of what is right.\n",
        digits(f64::from(exposure)),
        press.size.0,
        press.size.1,
        percent(1.0 - airlight / open),
        digits(open),
        percent(third_step / open),
        percent(third_step / airlight),
    );
    press.text("figure-10.md", &format!("# Figure 10: what each term adds\n\n{text}"))?;
    press.progress.step();
    Ok((text, indirect / total))
}

/// Half the size, each pixel the mean of those that it covers.
fn halved(image: &Image) -> Image {
    let (width, height) = ((image.width / 2).max(1), (image.height / 2).max(1));
    let at = |x: u32, y: u32| {
        image.pixels[(y.min(image.height - 1) * image.width + x.min(image.width - 1)) as usize]
    };
    let mean = |x: u32, y: u32| {
        0.25 * (at(2 * x, 2 * y) + at(2 * x + 1, 2 * y) + at(2 * x, 2 * y + 1) + at(2 * x + 1, 2 * y + 1))
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| mean(x, y)).collect();
    Image { width, height, pixels }
}

/// Figure 11: files, and what each shows.
pub(super) fn snapshots(press: &Press<'_>) -> Result<Vec<(String, String)>, Failure> {
    let mut files = Vec::new();
    for (letter, name, time) in SNAPSHOTS {
        press.progress.doing(&format!("figure 11 {letter}"));
        let scene = load(name, None, |note| press.progress.say(note))?;
        let mut stage = Stage::new(press.context, &scene, press.size)?;
        let mut renderer = stage.renderer(&Options::best(press.context.radiance_format()))?;
        let wanted = Wanted { indirect: true, ..Default::default() };
        let image = stage.pictures(&mut renderer, &scene.at(time), wanted)?.total();
        let file = format!("figure-11-{letter}.png");
        press.picture(&file, Picture::of(&image, image.auto_exposure()))?;
        files.push((file, format!("{letter}. {name}, {} triangles, at {time} s", scene.triangle_count())));
        press.progress.step();
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halving_keeps_the_mean_and_a_single_pixel() {
        let pixels = [1.0, 2.0, 3.0, 6.0].map(Vec3::splat).to_vec();
        assert_eq!(halved(&Image { width: 2, height: 2, pixels }).pixels, [Vec3::splat(3.0)]);
        let one = Image { width: 1, height: 1, pixels: vec![Vec3::ONE] };
        assert_eq!(halved(&one), one);
    }
}
