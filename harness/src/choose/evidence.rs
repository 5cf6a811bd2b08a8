//! Whether choices hold: the whole grid measured beside them, what leaving things out saves, and charts of both.

use std::path::Path;

use common::need::{Model, PhaseModel, Shaft};
use plotters::prelude::*;
use serde::Serialize;

use super::bench::Bench;
use super::{Candidate, Choice};
use crate::failure::Failure;
use crate::output::write_text;
use crate::plan;
use crate::report::chart::{Drawing, Sheet, ink, sheet, span, with_background};
use crate::report::looks::{marks, number};
use crate::report::{digits, percent};
use crate::techniques::{self, Method};

/// The whole grid on the same scene, beside one choice.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Sweep {
    /// Settings that were measured, and how long all of that took \[s\].
    pub settings: usize,
    pub seconds: f64,
    /// The cheapest of them under the bound.
    pub best: Option<Point>,
    /// The chosen technique's default on maps of 1024², everything drawn \[ms\].
    pub default_ms: Option<f64>,
    /// The chosen setting with everything drawn \[ms\].
    pub full_model_ms: Option<f64>,
    /// What was left out, one thing at a time, and what it saves.
    pub parts: Vec<PartOff>,
    /// All of them; with the first choice of a scene alone.
    pub points: Vec<Point>,
}

/// One of the grid.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Point {
    pub name: String,
    pub error: f64,
    pub ms: f64,
}

/// A model that leaves out one thing, drawn by an exact technique.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PartOff {
    pub technique: String,
    pub what: String,
    pub predicted_error: f64,
    pub error: f64,
    pub passes: std::collections::BTreeMap<String, f64>,
}

/// Techniques that show what a part costs.
const SHOWN: [&str; 2] = ["biri-ss-default@512", "lit-intervals@512"];

/// Left out of the picture that the others are compared with.
const NOTHING: &str = "nothing";

impl Sweep {
    /// How the choice compares.
    pub(super) fn sentence(&self, choice: &Choice) -> String {
        let share = percent(choice.seconds.total() / self.seconds);
        let best = match (&self.best, &choice.chosen) {
            (Some(best), Some(chosen)) => format!(
                "its best is {} ({} ms, error {}), so the choice takes {} times as long",
                best.name,
                digits(best.ms),
                percent(best.error),
                digits(chosen.ms / best.ms)
            ),
            (Some(best), None) => {
                format!("its best is {} ({} ms), which was missed", best.name, digits(best.ms))
            }
            (None, _) => "none of it stays under the bound".into(),
        };
        format!(
            "The whole grid of {} settings took {} s, of which choosing took {share}; {best}.",
            self.settings,
            digits(self.seconds)
        )
    }
}

/// Measures the whole grid on the bench's scene and puts it beside the scene's choices.
pub(super) fn sweep(bench: &mut Bench<'_>, choices: &mut [Choice]) -> Result<(), Failure> {
    let full = Model::full(bench.scene);
    let parts = match choices.first() {
        Some(first) if !first.need.cloud => parts(bench, first)?,
        _ => Vec::new(),
    };
    bench.forget_stages();
    bench.spent = 0.0;
    let references = bench.references()?;
    let mut methods = plan::grid()?;
    methods.retain(|method| method.refusal(bench.scene).is_none());
    // The largest meshes take longer than all the rest together and are never the best; without them the grid is the more
    // to be measured against.
    let is_huge = |method: &Method| method.is_of("billeter-plv") && method.shadow_map_size > Some(1024);
    methods.retain(|method| !is_huge(method));
    methods.sort_by_key(|method| method.shadow_map_size.unwrap_or(1024));
    let mut points = Vec::new();
    for method in &methods {
        let side = method.shadow_map_size.unwrap_or(1024);
        if let Ok(seen) = bench.verify(method, &full, side)? {
            points.push(Point { name: method.name.clone(), error: seen.error, ms: seen.ms() });
        }
    }
    let seconds = bench.spent + references;
    for (index, choice) in choices.iter_mut().enumerate() {
        let under = points.iter().filter(|point| point.error <= choice.max_error);
        let mut time = |name: &str, side: Option<u32>, model: &Model| -> Result<Option<f64>, Failure> {
            let method = techniques::find_one(name).map_err(Failure::Run)?;
            let side = side.or(method.shadow_map_size).unwrap_or(1024);
            Ok(bench.verify(&method, model, side)?.ok().map(|seen| seen.ms()))
        };
        let (mut default_ms, mut full_model_ms) = (None, None);
        if let Some(Candidate { settings, name, ms, .. }) = &choice.chosen {
            default_ms = time(&settings.technique, Some(1024), &full)?;
            full_model_ms = if settings.model.is_full() {
                Some(*ms)
            } else if settings.technique == "unshadowed" {
                None
            } else {
                time(name, settings.shadow_map_size, &full)?
            };
        }
        choice.sweep = Some(Sweep {
            settings: points.len(),
            seconds,
            best: under.min_by(|a, b| a.ms.total_cmp(&b.ms)).cloned(),
            default_ms,
            full_model_ms,
            parts: if index == 0 { parts.clone() } else { Vec::new() },
            points: if index == 0 { points.clone() } else { Vec::new() },
        });
    }
    Ok(())
}

/// What leaving out one thing at a time does to error and passes.
fn parts(bench: &mut Bench<'_>, choice: &Choice) -> Result<Vec<PartOff>, Failure> {
    let full = Model::full(bench.scene);
    let mut models = vec![(NOTHING.to_owned(), full.clone())];
    for index in 0..bench.scene.lights.len().min(4) {
        for (shaft, what) in [(Shaft::Unshadowed, "shadows of light"), (Shaft::Off, "light")] {
            let mut model = full.clone();
            model.lights[index] = shaft;
            models.push((format!("{what} {index}"), model));
        }
    }
    models.push(("colour".into(), Model { grey: true, ..full.clone() }));
    let isotropic = Model { phase: PhaseModel::Isotropic, ..full.clone() };
    models.push(("the phase function".into(), isotropic));
    let dark = Model { lights: vec![Shaft::Off; full.lights.len()], ..full.clone() };
    models.push(("all lights".into(), dark));
    // A medium that is as simple already has nothing to leave out.
    let is_some = |model: &Model| model.lights != full.lights || choice.need.error_of(model) > 0.0;
    models.retain(|(what, model)| what == NOTHING || is_some(model));
    let mut parts = Vec::new();
    for technique in SHOWN {
        let method = techniques::find_one(technique).map_err(Failure::Run)?;
        for (what, model) in &models {
            if let Ok(seen) = bench.verify(&method, model, 512)? {
                parts.push(PartOff {
                    technique: technique.into(),
                    what: what.clone(),
                    predicted_error: choice.need.error_of(model),
                    error: seen.error,
                    passes: seen.passes,
                });
            }
        }
    }
    Ok(parts)
}

/// Tables and charts.
pub(super) fn write(folder: &Path, choices: &[Choice]) -> Result<(), Failure> {
    write_text(folder, "evidence.md", &table(choices))?;
    write_text(folder, "parts.md", &parts_table(choices))?;
    let cases = || {
        choices.iter().filter_map(|choice| Some((choice.chosen.as_ref()?, choice.sweep.as_ref()?, choice)))
    };
    let charts: [(&str, Scatter<'_>); 4] = [
        (
            "predicted-error.svg",
            Scatter {
                title: "Predicted and measured error of the chosen settings",
                axes: ["measured relative RMSE of the airlight [%]", "predicted [%]"],
                points: cases()
                    .map(|(chosen, ..)| (100.0 * chosen.error, 100.0 * chosen.predicted_error))
                    .collect(),
                lines: &[(1.0, "equal")],
            },
        ),
        (
            "saved-time.svg",
            Scatter {
                title: "Time of the choice and of its technique's default with everything drawn",
                axes: ["default, every light with shadows [ms]", "chosen [ms]"],
                points: cases()
                    .filter_map(|(chosen, sweep, _)| Some((sweep.default_ms?, chosen.ms)))
                    .collect(),
                lines: &[(1.0, "equal"), (0.1, "a tenth")],
            },
        ),
        (
            "best-of-sweep.svg",
            Scatter {
                title: "Time of the choice and of the best setting of the whole grid",
                axes: ["best of the grid under the bound [ms]", "chosen [ms]"],
                points: cases()
                    .filter_map(|(chosen, sweep, _)| Some((sweep.best.as_ref()?.ms, chosen.ms)))
                    .collect(),
                lines: &[(1.0, "equal"), (1.5, "1.5 times")],
            },
        ),
        (
            "choosing-time.svg",
            Scatter {
                title: "Time to choose and time to measure the whole grid",
                axes: ["the whole grid [s]", "choosing [s]"],
                points: cases().map(|(_, sweep, choice)| (sweep.seconds, choice.seconds.total())).collect(),
                lines: &[(0.1, "a tenth")],
            },
        ),
    ];
    for (name, scatter) in charts {
        let svg = sheet((620, 560), |area| scatter.draw(area)).map_err(Failure::Run)?;
        write_text(folder, name, &with_background(&svg))?;
    }
    Ok(())
}

/// Points, both axes logarithmic, and lines of equal ratio.
struct Scatter<'a> {
    title: &'a str,
    axes: [&'a str; 2],
    points: Vec<(f64, f64)>,
    lines: &'a [(f64, &'a str)],
}

impl Scatter<'_> {
    fn draw(&self, area: &Sheet<'_>) -> Drawing<()> {
        let (Some(x), Some(y)) =
            (span(self.points.iter().map(|p| p.0)), span(self.points.iter().map(|p| p.1)))
        else {
            return area.draw(&Text::new("no measurement", (20, 20), ink(17)));
        };
        let mut chart = ChartBuilder::on(area)
            .margin(12)
            .margin_top(38)
            .margin_right(28)
            .x_label_area_size(44)
            .y_label_area_size(72)
            .build_cartesian_2d(
                (x.0..x.1).log_scale().with_key_points(marks(x)),
                (y.0..y.1).log_scale().with_key_points(marks(y)),
            )?;
        chart
            .configure_mesh()
            .x_desc(self.axes[0])
            .y_desc(self.axes[1])
            .axis_desc_style(ink(17))
            .label_style(ink(16))
            .axis_style(BLACK)
            .bold_line_style(RGBColor(128, 128, 128).mix(0.25))
            .light_line_style(TRANSPARENT)
            .x_label_formatter(&|value| number(*value))
            .y_label_formatter(&|value| number(*value))
            .draw()?;
        area.draw(&Text::new(self.title.to_owned(), (12, 12), ink(18)))?;
        for (ratio, name) in self.lines {
            // From where it enters the chart to where it leaves it.
            let (from, to) = (x.0.max(y.0 / ratio), x.1.min(y.1 / ratio));
            if from < to {
                let ends = [(from, from * ratio), (to, to * ratio)];
                chart.draw_series(LineSeries::new(ends, RGBColor(128, 128, 128).stroke_width(2)))?;
                let place = chart.backend_coord(&ends[1]);
                area.draw(&Text::new((*name).to_owned(), (place.0 - 70, place.1 + 14), ink(15)))?;
            }
        }
        chart.draw_series(
            self.points.iter().map(|point| Circle::new(*point, 5, RGBColor(0, 90, 160).mix(0.7).filled())),
        )?;
        Ok(())
    }
}

/// One line for each choice, and what holds of all.
fn table(choices: &[Choice]) -> String {
    let mut lines = vec![
        "# What was chosen, beside the whole grid".to_owned(),
        String::new(),
        "Errors are relative RMSE of the airlight against the reference of the whole scene, times those of the \
         technique's own passes, everything moving. *Default* is the chosen technique's default on maps of 1024² with \
         every light and its shadows."
            .to_owned(),
        String::new(),
        "| scene | bound | chosen | left out | predicted | error | time | best of the grid | its time | ratio | default | \
         choosing | grid |"
            .to_owned(),
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|".to_owned(),
    ];
    let (mut met, mut near, mut quick, mut of, mut with_best) = (0, 0, 0, 0, 0);
    for choice in choices {
        let Some(sweep) = &choice.sweep else { continue };
        let share = choice.seconds.total() / sweep.seconds;
        of += 1;
        quick += usize::from(share < 0.1);
        let best = sweep.best.as_ref();
        let [best_name, best_ms] = best.map_or(["none".into(), "–".into()], |best| {
            [best.name.clone(), format!("{} ms", digits(best.ms))]
        });
        let seconds = format!("{} s ({})", digits(choice.seconds.total()), percent(share));
        let grid = format!("{} s", digits(sweep.seconds));
        let bound = percent(choice.max_error);
        let Some(chosen) = &choice.chosen else {
            met += usize::from(best.is_none());
            lines.push(format!(
                "| {} | {bound} | none |  |  |  |  | {best_name} | {best_ms} |  |  | {seconds} | {grid} |",
                choice.scene
            ));
            continue;
        };
        let ratio = best.map(|best| chosen.ms / best.ms);
        with_best += usize::from(ratio.is_some());
        near += usize::from(ratio.is_some_and(|ratio| ratio <= 1.5));
        met += usize::from(chosen.error <= choice.max_error);
        lines.push(format!(
            "| {} | {bound} | {} | {} | {} | {} | {} ms | {best_name} | {best_ms} | {} | {} ms | {seconds} | {grid} |",
            choice.scene,
            chosen.name,
            left_out(&chosen.settings.model),
            percent(chosen.predicted_error),
            percent(chosen.error),
            digits(chosen.ms),
            ratio.map_or("–".into(), digits),
            digits(sweep.default_ms.unwrap_or(f64::NAN)),
        ));
    }
    lines.extend([
        String::new(),
        format!("Under the bound, or nothing in the grid is: {met} of {of}."),
        format!("Within 1.5 times of the best of the grid: {near} of {with_best}."),
        format!("Chosen in less than a tenth of the grid's time: {quick} of {of}."),
    ]);
    lines.join("\n") + "\n"
}

/// A model in few words.
fn left_out(model: &Model) -> String {
    let lights = model.lights.iter().enumerate().filter_map(|(index, shaft)| match shaft {
        Shaft::Off => Some(format!("light {index}")),
        Shaft::Unshadowed => Some(format!("shadows of {index}")),
        Shaft::Shadowed => None,
    });
    let grey = model.grey.then(|| "colour".to_owned());
    let phase = match model.phase {
        PhaseModel::Own => None,
        PhaseModel::HenyeyGreenstein => Some("phase: one lobe".to_owned()),
        PhaseModel::Isotropic => Some("phase: isotropic".to_owned()),
    };
    lights.chain(grey).chain(phase).collect::<Vec<_>>().join(", ")
}

/// What each part costs.
fn parts_table(choices: &[Choice]) -> String {
    let mut lines = vec![
        "# What leaving out one thing saves".to_owned(),
        String::new(),
        "Each technique's own passes, and the error against the reference of everything beside the one that was estimated \
         on the CPU."
            .to_owned(),
        String::new(),
        "| scene | technique | left out | estimated error | error | time | passes |".to_owned(),
        "|---|---|---|---|---|---|---|".to_owned(),
    ];
    for choice in choices {
        for part in choice.sweep.iter().flat_map(|sweep| &sweep.parts) {
            let passes: Vec<String> =
                part.passes.iter().map(|(name, ms)| format!("{name} {} ms", digits(*ms))).collect();
            lines.push(format!(
                "| {} | {} | {} | {} | {} | {} ms | {} |",
                choice.scene,
                part.technique,
                part.what,
                percent(part.predicted_error),
                percent(part.error),
                digits(part.passes.values().sum()),
                passes.join(", ")
            ));
        }
    }
    lines.join("\n") + "\n"
}
