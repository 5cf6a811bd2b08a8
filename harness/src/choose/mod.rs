//! `harness choose`: what a scene needs, and the cheapest technique and settings within an error.

mod bench;
mod evidence;
mod family;
mod search;
mod snippet;
mod told;

use common::Scene;
use common::need::{self, Model, Need, Shaft};
use serde::Serialize;

use crate::cli;
use crate::cmd::{load, reference_failure};
use crate::failure::Failure;
use crate::interrupt;
use crate::machine::{self, Machine};
use crate::measure::{Frames, check_size};
use crate::output::write_text;
use crate::plan;
use crate::progress::Progress;
use crate::techniques::Method;
use crate::techniques::settings::Settings;
use bench::{Bench, Modelled};
use evidence::Sweep;
use family::{EXACT_ON_MAP, Family, Rung, families, floor};
use search::{Outcome, Search, Verified};

/// Measurements that one choice takes, about.
const USUAL: usize = 10;

/// What was chosen for a scene and a bound: one line of choices.jsonl. Times in ms unless their name says otherwise,
/// errors relative RMSE of the airlight.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Choice {
    pub date: String,
    pub commit: String,
    pub machine: Machine,
    pub adapter: String,
    pub driver: String,
    pub software: bool,
    pub scene: String,
    pub triangles: usize,
    pub lights: usize,
    pub width: u32,
    pub height: u32,
    pub max_error: f64,
    pub max_ms: Option<f64>,
    pub need: Need,
    /// The cheapest under the bound, if there is one.
    pub chosen: Option<Candidate>,
    /// The cheapest of another technique under the bound, measured or predicted, or else the nearest to it.
    pub runner_up: Option<RunnerUp>,
    /// The least error of those within `max_ms`, where the chosen one is not.
    pub within_max_ms: Option<Candidate>,
    /// Why each other technique was not chosen.
    pub lost: Vec<Loser>,
    /// Least of each knob that the bound allows, as the laws predict it.
    pub least: Vec<Least>,
    /// What errors may be off by.
    pub reference_uncertainty: f64,
    pub seconds: Seconds,
    /// The whole grid, where it was measured too.
    pub sweep: Option<Sweep>,
}

/// A setting that was predicted and measured.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Candidate {
    /// As the command line spells it.
    pub name: String,
    pub settings: Settings,
    pub predicted_error: f64,
    pub error: f64,
    pub predicted_ms: f64,
    pub ms: f64,
    pub passes: std::collections::BTreeMap<String, f64>,
}

/// The second.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RunnerUp {
    pub name: String,
    pub predicted_error: f64,
    pub predicted_ms: f64,
    /// Where it was measured.
    pub error: Option<f64>,
    pub ms: Option<f64>,
}

/// A technique that was not chosen.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Loser {
    pub technique: String,
    pub why: String,
    /// Measured or predicted.
    pub ms: Option<f64>,
}

/// The coarsest setting of a technique that the bound allows.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Least {
    pub technique: String,
    pub setting: String,
    pub predicted_error: f64,
}

/// What choosing took \[s\].
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Seconds {
    pub need: f64,
    /// Of the references, when they were computed.
    pub references: f64,
    pub measuring: f64,
}

impl Seconds {
    pub(crate) fn total(&self) -> f64 {
        self.need + self.references + self.measuring
    }
}

/// Chooses, prints and writes; gives what to print.
pub(crate) fn run(arguments: &cli::Choose) -> Result<String, Failure> {
    for name in &arguments.techniques {
        if !families(true).iter().chain(&families(false)).any(|family| family.technique == *name) {
            return Err(Failure::Input(format!("`{name}` is not chosen from; expected {}", names())));
        }
    }
    let scenes = arguments
        .scenes
        .iter()
        .map(|name| load(name, arguments.triangles, |note| eprintln!("{note}")))
        .collect::<Result<Vec<_>, _>>()?;
    let context = crate::cmd::open(&cli::Ground {
        triangles: arguments.triangles,
        shadow_map_size: None,
        adapter: arguments.adapter.clone(),
    })?;
    let size = arguments.size.unwrap_or(if context.software { (256, 208) } else { (1280, 1024) });
    check_size(&context, size)?;
    std::fs::create_dir_all(&arguments.output)
        .and_then(|()| tempfile::tempfile_in(&arguments.output))
        .map_err(|error| Failure::Input(format!("can't write to {}: {error}", arguments.output.display())))?;
    let grid = if arguments.sweep { plan::grid()?.len() } else { 0 };
    let progress = Progress::new((scenes.len() * (arguments.max_errors.len() * USUAL + grid)) as u64);
    let mut choices: Vec<Choice> = Vec::new();
    for scene in &scenes {
        let frames = Frames::of_run(arguments.frames, context.software, true);
        let mut bench = Bench::new(&context, scene, size, frames, &progress);
        let need = estimate(scene, size, &progress)?;
        for &bound in &arguments.max_errors {
            choices.push(choose(&mut bench, &need, arguments, bound)?);
        }
        if arguments.sweep {
            let first = choices.len() - arguments.max_errors.len();
            evidence::sweep(&mut bench, &mut choices[first..])?;
            // What was measured is not lost where a later scene fails.
            write(arguments, &choices)?;
        }
    }
    drop(progress);
    write(arguments, &choices)?;
    let text: Vec<String> = choices.iter().map(told::text).collect();
    let text = format!("{}\nwrote {}\n", text.join("\n"), arguments.output.display());
    let unmet: Vec<String> = choices.iter().filter_map(told::unmet).collect();
    if unmet.is_empty() || arguments.sweep {
        return Ok(text);
    }
    crate::print(&text);
    Err(Failure::Run(unmet.join("; ")))
}

/// Techniques that are chosen from.
fn names() -> String {
    let all = families(false).into_iter().chain(families(true));
    all.map(|family| family.technique).collect::<Vec<_>>().join(", ")
}

fn estimate(scene: &Scene, (width, height): (u32, u32), progress: &Progress) -> Result<Need, Failure> {
    progress.doing(&format!("{}: what it needs", scene.name));
    let settings = need::Settings { aspect: width as f32 / height as f32, ..Default::default() };
    need::estimate_until(scene, &settings, interrupt::flag())
        .map_err(|error| reference_failure(&scene.name, error))
}

/// The models that are tried, the least one first: each stands in where the one before is no good.
fn models(need: &Need, bound: f64) -> Vec<Model> {
    let least = need.model(bound);
    let with = |from: Shaft, to: Shaft| {
        let lights = least.lights.iter().map(|shaft| if *shaft == from { to } else { *shaft });
        Model { lights: lights.collect(), ..least.clone() }
    };
    let full = Model { lights: vec![Shaft::Shadowed; need.lights.len()], ..Model::default() };
    let mut models = vec![least.clone(), with(Shaft::Unshadowed, Shaft::Shadowed), full];
    // The full-screen pass adds next to nothing of its own, so all of the bound is the model's, and nothing is cheaper.
    let bare = with(Shaft::Shadowed, Shaft::Unshadowed);
    if !need.cloud && need.error_of(&bare) + 2.0 * need.uncertainty_of(&bare) <= bound {
        models.insert(0, bare);
    }
    models.dedup();
    models
}

/// Finds the cheapest setting for one scene and one bound.
fn choose(
    bench: &mut Bench<'_>,
    need: &Need,
    arguments: &cli::Choose,
    bound: f64,
) -> Result<Choice, Failure> {
    let (scene, context) = (bench.scene, bench.context);
    bench.forget_stages();
    bench.spent = 0.0;
    let references = bench.references()?;
    if !bench.is_lit() {
        return Err(Failure::Input(format!(
            "{}: no light reaches the fog that is seen, so there is nothing to choose",
            scene.name
        )));
    }
    let wanted = |family: &Family| {
        arguments.techniques.is_empty() || arguments.techniques.iter().any(|name| *name == family.technique)
    };
    let mut found = None;
    for model in models(need, bound) {
        let lights = scene.lights.len();
        let unshadowed = !model.has(lights, Shaft::Shadowed) && !need.cloud;
        if unshadowed && !arguments.techniques.is_empty() {
            // What was asked for would have nothing to do.
            continue;
        }
        let mut families: Vec<Family> = if unshadowed { vec![floor()] } else { families(need.cloud) };
        for family in families.iter_mut().filter(|_| !unshadowed) {
            family.wanted = wanted(family);
        }
        // Lit intervals show what the maps' own errors are.
        families.retain(|family| family.wanted || family.technique == EXACT_ON_MAP);
        let outcome = {
            let mut measures = Modelled { bench: &mut *bench, model: &model, families: &families };
            Search::new(&families, &mut measures, bound, need.error_of(&model)).run()?
        };
        let done = outcome.best.is_some();
        found = Some((model, families, outcome));
        if done {
            break;
        }
    }
    let Some((model, families, outcome)) = found else {
        return Err(Failure::Run("no model was tried".into()));
    };
    let candidate = |verified: &Verified| candidate(&families, &model, verified);
    let chosen = outcome.best.map(|best| candidate(&outcome.verified[best])).transpose()?;
    let runner_up = runner_up(&families, &outcome, bound)?;
    let within = within(&outcome, arguments.max_ms).map(candidate).transpose()?;
    let least = outcome.least.iter().map(|search::Least { rung, error, .. }| {
        let method = families[rung.family].method(rung).map_err(Failure::Run)?;
        let technique = method.technique.into();
        Ok(Least { technique, setting: method.name, predicted_error: *error })
    });
    Ok(Choice {
        date: machine::now(),
        commit: machine::commit(),
        machine: Machine::this(),
        adapter: context.adapter.clone(),
        driver: context.driver.clone(),
        software: context.software,
        scene: scene.name.clone(),
        triangles: scene.triangle_count(),
        lights: scene.lights.len(),
        width: bench.size().0,
        height: bench.size().1,
        max_error: bound,
        max_ms: arguments.max_ms,
        need: need.clone(),
        chosen,
        runner_up,
        within_max_ms: within,
        least: least.collect::<Result<_, Failure>>()?,
        lost: outcome
            .lost
            .iter()
            .map(|lost| Loser {
                technique: families[lost.family].technique.into(),
                why: lost.why.clone(),
                ms: lost.ms,
            })
            .collect(),
        reference_uncertainty: bench.uncertainty(),
        seconds: Seconds { need: need.seconds, references, measuring: bench.spent },
        sweep: None,
    })
}

fn candidate(families: &[Family], model: &Model, verified: &Verified) -> Result<Candidate, Failure> {
    let method: Method = families[verified.rung.family].method(&verified.rung).map_err(Failure::Run)?;
    Ok(Candidate {
        settings: Settings::of(&method, model),
        name: method.name,
        predicted_error: verified.predicted_error,
        error: verified.seen.error,
        predicted_ms: verified.predicted_ms,
        ms: verified.seen.ms(),
        passes: verified.seen.passes.clone(),
    })
}

/// The fastest of another family under the bound, measured or else predicted; where there is none, that of the least error.
fn runner_up(families: &[Family], outcome: &Outcome, bound: f64) -> Result<Option<RunnerUp>, Failure> {
    let chosen = outcome.best.map(|best| outcome.verified[best].rung.family);
    let others = || outcome.verified.iter().filter(|verified| Some(verified.rung.family) != chosen);
    let under = others().filter(|verified| verified.seen.error <= bound);
    let measured = under.min_by(|a, b| a.seen.ms().total_cmp(&b.seen.ms()));
    let predicted = || {
        let least =
            outcome.least.iter().filter(|least| Some(least.rung.family) != chosen && least.ms.is_finite());
        least.min_by(|a, b| a.ms.total_cmp(&b.ms))
    };
    let nearest = || others().min_by(|a, b| a.seen.error.total_cmp(&b.seen.error));
    let name = |rung: &Rung| Ok(families[rung.family].method(rung).map_err(Failure::Run)?.name);
    let of = |verified: &Verified| {
        Ok(RunnerUp {
            name: name(&verified.rung)?,
            predicted_error: verified.predicted_error,
            predicted_ms: verified.predicted_ms,
            error: Some(verified.seen.error),
            ms: Some(verified.seen.ms()),
        })
    };
    match (measured, chosen.and_then(|_| predicted()), nearest()) {
        (Some(measured), ..) => of(measured).map(Some),
        (None, Some(least), _) => Ok(Some(RunnerUp {
            name: name(&least.rung)?,
            predicted_error: least.error,
            predicted_ms: least.ms,
            error: None,
            ms: None,
        })),
        (None, None, Some(nearest)) => of(nearest).map(Some),
        (None, None, None) => Ok(None),
    }
}

/// The least error within a time that the chosen one does not keep.
fn within(outcome: &Outcome, max_ms: Option<f64>) -> Option<&Verified> {
    let max_ms = max_ms?;
    let fast = outcome.verified.iter().filter(|verified| verified.seen.ms() <= max_ms);
    fast.min_by(|a, b| a.seen.error.total_cmp(&b.seen.error))
}

/// Writes all files into the output folder, each whole or not at all.
fn write(arguments: &cli::Choose, choices: &[Choice]) -> Result<(), Failure> {
    let folder = &arguments.output;
    let line = |choice: &Choice| {
        serde_json::to_string(choice)
            .map_err(|error| Failure::Run(format!("a choice can't be written: {error}")))
    };
    let lines = choices.iter().map(line).collect::<Result<Vec<_>, _>>()?;
    write_text(folder, "choices.jsonl", &(lines.join("\n") + "\n"))?;
    for choice in choices {
        let name = match choices {
            [_] => "choice".into(),
            _ => format!(
                "{}-{}",
                crate::report::file_name(&choice.scene),
                crate::report::file_name(&format!("{}pct", 100.0 * choice.max_error))
            ),
        };
        write_text(folder, &format!("{name}.md"), &told::text(choice))?;
        if let Some(chosen) = &choice.chosen {
            let text = serde_json::to_string_pretty(&chosen.settings)
                .map_err(|error| Failure::Run(format!("settings can't be written: {error}")))?;
            write_text(folder, &format!("{name}.json"), &(text + "\n"))?;
            write_text(folder, &format!("{name}.rs"), &snippet::of(&chosen.settings)?)?;
        } else {
            // What an earlier choice left there is not this one's.
            for extension in ["json", "rs"] {
                let _ = std::fs::remove_file(folder.join(format!("{name}.{extension}")));
            }
        }
    }
    if arguments.sweep { evidence::write(folder, choices) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::builtin;

    #[test]
    fn all_of_a_bound_may_go_into_lights_without_shadows() {
        let settings = need::Settings { width: 40, seconds: 0.3, ..Default::default() };
        let need = need::estimate(&builtin::knife_edge(), &settings).unwrap();
        let shadows = need.lights[0].shadows.error;
        let tight = models(&need, 0.5 * shadows.value);
        assert_eq!(tight, [Model::full(&builtin::knife_edge())]);
        // More than half of the bound, which is what a technique would leave.
        let loose = models(&need, shadows.value + 3.0 * shadows.uncertainty);
        assert_eq!(loose[0].lights, [Shaft::Unshadowed]);
        assert_eq!(loose[1..], tight[..]);
    }
}
