//! What single scattering misses: the reference's airlight against all light that the medium scatters.

use common::reference::{Options as Settings, multiple};
use common::scene::builtin;
use common::{Term, Terms};
use serde::Serialize;

use super::super::{Origin, Press, cells};
use super::SCHEMA;
use super::lab::relative;
use crate::cmd::reference_with;
use crate::failure::Failure;
use crate::report::{markdown, percent};

/// Scenes of homogeneous media with surfaces.
const SCENES: [&str; 2] = ["cathedral", "amphora"];
/// Triangles of each: shapes, not detail, decide what light is missed.
const TRIANGLES: u32 = 10_000;

/// Steps of progress.
pub(super) const STEPS: u64 = SCENES.len() as u64;

/// Paths per pixel.
const PATHS: u32 = 64;

#[derive(Debug, Serialize)]
struct Missed {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    rows: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    scene: &'static str,
    /// Mean of what single scattering leaves out over the mean of both.
    share: f64,
    /// Relative RMSE of the airlight against both, the paths' own noise included.
    rel_rmse: f64,
    /// That noise, relative RMS.
    noise: f64,
}

/// Measures and writes; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let mut rows = Vec::new();
    for name in SCENES {
        press.progress.doing(&format!("{name}: what single scattering misses"));
        let scene = builtin::build(name, Some(TRIANGLES)).map_err(|error| Failure::Run(error.to_string()))?;
        let still = scene.at(0.0);
        let view = still.camera.view(press.timed_size.0, press.timed_size.1);
        let terms = Terms::from(Term::Airlight).with(Term::Multiple);
        let multiple = multiple::Options { samples: PATHS, ..Default::default() };
        let settings = Settings { multiple, ..Default::default() };
        let rendered = reference_with(&still, &view, terms, settings, &|part| {
            press.progress.detail(format!("{name}: paths, {:.0} %", 100.0 * part));
        })?;
        let lacking = || Failure::Run("the reference lacks a term".into());
        let single = rendered.airlight.as_ref().ok_or_else(lacking)?;
        let more = rendered.multiple.as_ref().ok_or_else(lacking)?;
        let sum = |image: &common::image::Image| -> f64 {
            image.pixels.iter().map(|pixel| f64::from(pixel.element_sum())).sum()
        };
        let all = single.plus(more);
        rows.push(Row {
            scene: name,
            share: sum(more) / sum(&all),
            rel_rmse: relative(single, &all)?,
            noise: rendered.multiple_uncertainty * sum(more) / sum(&all),
        });
        press.progress.step();
    }
    let text = text(&rows);
    press.json("missed.json", &Missed { schema: SCHEMA, origin: press.origin(), rows })?;
    Ok(text)
}

fn text(rows: &[Row]) -> String {
    let mut table =
        vec![cells(["scene", "share of what is missed", "relative RMSE of single scattering", "noise"])];
    for row in rows {
        let Row { scene, share, rel_rmse, noise } = row;
        table.push(vec![(*scene).into(), percent(*share), percent(*rel_rmse), percent(*noise)]);
    }
    format!(
        "What every technique of single scattering leaves out of the light that the medium sends to the eye, however well \
         it is done: two and more scatterings, and light that surfaces reflect into the medium. By {PATHS} paths a pixel.\n\n{}",
        markdown::table(&table)
    )
}
