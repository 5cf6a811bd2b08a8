//! Billeter, Sintorn and Assarson 2010 with the supplement of 2012: its one figure with a frame rate, and the claims of
//! the text.

mod claims;
mod measured;

use common::scene::Scene;
use common::scene::builtin;

use super::{Picture, Press, cells};
use crate::failure::Failure;
use crate::measure::{Drawn, Stage};
use crate::report::table::SOFTWARE;
use crate::report::{digits, markdown, percent};
use crate::techniques;
use measured::{Group, Measured, Row};

/// The paper's pictures \[pixels\].
pub(super) const SIZE: (u32, u32) = (1280, 1024);

/// Steps of progress: two pictures, errors and times.
pub(super) const STEPS: u64 = 2 + measured::STEPS;

/// The page that ties the rest together.
const PAGE: &str = "index.md";

/// Triangles of the Sibenik model, which `cathedral` has too.
const TRIANGLES: u32 = 75_000;
/// Texels on a side of the table's shadow maps: the supplement gives none, and with 1024² a software adapter takes many
/// seconds a frame, because a point light has six of them.
const SHADOW_MAP: u32 = 512;
/// Frames per second under Figure 3 of the supplement: "~90 fps".
const PAPER_FPS: f64 = 90.0;
/// The settings of the table, and what each is called there.
const SETTINGS: [(&str, &str); 2] = [("paper", PAPER), ("default", DEFAULT)];
const PAPER: &str = "billeter-plv-paper";
const DEFAULT: &str = "billeter-plv-default";

/// Makes everything; gives what to print.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let files = pictures(press)?;
    let measured = Measured::take(press)?;
    let heading = heading(press);
    let table = table(press, &measured);
    press.text("figure-3.md", &format!("# Figure 3\n\n{heading}\n{table}"))?;
    let claims = claims::make(press, &heading, &measured)?;
    let mut page = format!(
        "# Billeter 2010: the results again\n\n\
         M. Billeter, E. Sintorn, U. Assarson, *Real time volumetric shadows using polygonal light volumes*, High \
         Performance Graphics 2010, and its supplement of 2012, on a GeForce GTX 480 at 1280x1024. Of the paper itself \
         only the abstract was to be had, of the supplement all. `cathedral` is our own, with as many triangles as the \
         Sibenik model and two lights as in Figure 3: a sun, and a lamp that takes six shadow maps where theirs took \
         one.\n\n{heading}\n\
         ## Figure 3: frames per second\n\n{table}\n\
         ## What the text claims\n\n{claims}\n\
         ## Figure 3: the picture\n\n"
    );
    for (file, what) in files {
        page += &format!("![{what}]({file})\n\n{what}\n\n");
    }
    press.text(PAGE, &page)?;
    Ok(format!("{table}\n{claims}\npage: {}\n", press.folder.join(PAGE).display()))
}

/// Where and when, and what to know about it.
fn heading(press: &Press<'_>) -> String {
    let software = if press.context.software { format!("\n{SOFTWARE}\n") } else { String::new() };
    format!("{}\n{software}", press.origin().line())
}

/// The scene of the figure, with so many triangles.
fn cathedral(triangles: u32) -> Scene {
    builtin::cathedral(triangles)
}

/// The figure by both settings.
fn pictures(press: &Press<'_>) -> Result<Vec<(String, String)>, Failure> {
    let scene = cathedral(TRIANGLES);
    let mut stage = Stage::new(press.context, &scene, press.size, SHADOW_MAP)?;
    let (device, queue) = (&press.context.device, &press.context.queue);
    let mut exposure = None;
    let mut files = Vec::new();
    for (name, method) in SETTINGS {
        crate::interrupt::check()?;
        press.progress.doing(&format!("figure 3, {name}"));
        let method = techniques::find_one(method).map_err(Failure::Run)?;
        let mut technique = method.make(device, queue, stage.format(), press.size).map_err(Failure::Run)?;
        let image = stage.picture(Some(technique.as_mut()), 0.0, Drawn::Both)?;
        let exposure = *exposure.get_or_insert_with(|| image.auto_exposure());
        let file = format!("figure-3-{name}.png");
        press.picture(&file, Picture::of(&image, exposure))?;
        files.push((file, format!("by the {name} setting, shadow maps of {SHADOW_MAP}²")));
        press.progress.step();
    }
    Ok(files)
}

fn table(press: &Press<'_>, measured: &Measured) -> String {
    let mut rows = vec![cells([
        "scene",
        "triangles",
        "lights",
        "shadow maps",
        "setting",
        "paper fps",
        "our fps",
        "ours/paper",
        "frame ms p50/p95/max",
        "technique ms p50",
        "error",
    ])];
    for (name, method) in SETTINGS {
        let row: &Row = measured.row(Group::Marches, method, SHADOW_MAP);
        let fps = 1e3 / row.frame_ms.p50;
        rows.push(vec![
            "cathedral".into(),
            row.triangles.to_string(),
            row.lights.to_string(),
            row.shadow_map_size.to_string(),
            name.into(),
            format!("~{}", digits(PAPER_FPS)),
            digits(fps),
            digits(fps / PAPER_FPS),
            [row.frame_ms.p50, row.frame_ms.p95, row.frame_ms.max].map(digits).join(" / "),
            digits(row.technique_ms.p50),
            row.rel_rmse.map_or("–".into(), percent),
        ]);
    }
    let smaller = f64::from(SIZE.0 * SIZE.1) / f64::from(press.timed_size.0 * press.timed_size.1);
    let pixels = if smaller > 1.0 {
        format!(" Our frames have {} times fewer pixels.", digits(smaller))
    } else {
        String::new()
    };
    format!(
        "Whole frames (shadow maps, depth, lit surfaces, airlight), everything moving, medians. Error: relative RMSE of \
         the airlight at time 0 against the CPU reference; the paper has none.{pixels}\n\n{}",
        markdown::table(&rows)
    )
}
