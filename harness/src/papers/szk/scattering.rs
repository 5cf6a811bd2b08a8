//! A step by the whole matrix, by the same in tiles, and by few components of it: time and error over the asymmetry.

use serde::Serialize;
use szk_network::{Kernel, Options, Sampling, Scattering};

use super::super::{Origin, Press, cells};
use super::lab::{self, best, particles, relative};
use super::{SCHEMA, sphere};
use crate::failure::Failure;
use crate::record::Spread;
use crate::report::{digits, markdown, percent};

const ASYMMETRIES: [f64; 4] = [0.0, 0.3, 0.5, 0.76];

/// Steps of progress.
pub(super) const STEPS: u64 = ASYMMETRIES.len() as u64;

const PARTICLES: u32 = 1024;
/// Steps from dark, drawn alike by all; and how often one step is timed.
const FROM_DARK: u32 = 12;
const TIMED: usize = 3;

const WAYS: [(&str, Scattering); 4] = [
    ("full", Scattering::Full),
    ("tiled", Scattering::Tiled),
    ("low rank, bound 3 %", Scattering::LowRank { bound: 0.03 }),
    ("low rank, bound 10 %", Scattering::LowRank { bound: 0.1 }),
];

#[derive(Debug, Serialize)]
struct Steps {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    rows: Vec<Row>,
}

#[derive(Debug, Serialize)]
struct Row {
    g: f64,
    scattering: &'static str,
    /// Components; null for a whole matrix.
    rank: Option<usize>,
    step_ms: Spread,
    /// Relative RMSE of the picture after 12 steps against that by the whole matrix.
    rel_rmse: f64,
    /// What the crate warns of.
    warnings: Vec<String>,
}

/// Measures and writes; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let mut rows = Vec::new();
    for g in ASYMMETRIES {
        press.progress.doing(&format!("steps: g = {g}"));
        let scene = sphere(g)?;
        let particles = particles(&scene, PARTICLES, Sampling::Even)?;
        let mut whole = None;
        for (name, scattering) in WAYS {
            let options = Options { scattering, ..best(press, 128) };
            let mut lab = lab::lab(press, &scene, &particles, &options)?;
            let image = lab.draw(FROM_DARK, 0.0, true)?.image;
            let mut times = Vec::new();
            for _ in 0..press.frames.at_most(TIMED) {
                times.push(lab.draw(1, 0.0, false)?.iterate_ms());
            }
            let rank = lab.renderer.plan().and_then(|plan| match &plan.kernel {
                Kernel::Components(sets) => sets.first().map(|set| set.values.len()),
                Kernel::Matrices { .. } => None,
            });
            let warnings = lab.renderer.warnings().iter().map(ToString::to_string).collect();
            let rel_rmse = relative(&image, whole.get_or_insert_with(|| image.clone()))?;
            rows.push(Row { g, scattering: name, rank, step_ms: Spread::of(&times), rel_rmse, warnings });
        }
        press.progress.step();
    }
    let steps = Steps { schema: SCHEMA, origin: press.origin(), rows };
    press.json("scattering.json", &steps)?;
    let mut table =
        vec![cells(["g", "step", "components", "ms p50", "full/this", "against full", "the crate warns"])];
    for row in &steps.rows {
        let full = steps.rows.iter().find(|other| other.g == row.g).map_or(f64::NAN, |full| full.step_ms.p50);
        table.push(vec![
            row.g.to_string(),
            row.scattering.into(),
            row.rank.map_or("–".into(), |rank| rank.to_string()),
            digits(row.step_ms.p50),
            digits(full / row.step_ms.p50),
            percent(row.rel_rmse),
            if row.warnings.is_empty() { "–".into() } else { row.warnings.join("; ") },
        ]);
    }
    Ok(format!(
        "`sphere` with Henyey-Greenstein's phase function, {PARTICLES} particles, 128 even directions, one colour: \
         time of one step, and relative RMSE of the picture after {FROM_DARK} steps from dark against that by the whole \
         matrix. Where nearly all components are needed (g = 0.76) the whole matrix takes less time.\n\n{}",
        markdown::table(&table)
    ))
}
