//! `harness targets`: what is promised of the polygonal light volumes, measured in one run.

use std::path::Path;

use billeter_plv::{Options, Tessellation};
use common::gpu::Context;
use common::image::Image;
use common::{Light, Scene, Term, metrics};
use serde::Serialize;

use crate::cli::{Ground, Targets};
use crate::cmd::{load, open, reference};
use crate::failure::Failure;
use crate::interrupt;
use crate::machine::{self, Machine};
use crate::measure::{Drawn, Stage, check_size};
use crate::progress::Progress;
use crate::report::percent;
use crate::techniques::{self, Method};

/// Scenes whose error is bounded.
const SCENES: [&str; 2] = ["cathedral", "amphora"];

/// Sides of the shadow maps at which the error is bounded, and the bounds.
const ERROR_BOUNDS: [(u32, f64); 2] = [(2048, 0.01), (512, 0.03)];

/// Side of the shadow maps from which adaptive meshes are held against full ones.
const MESH_SIZE: u32 = 1024;

/// Side of the rooms' shadow maps.
const ROOM_SIZE: u32 = 512;

/// Version of `targets.json`, described in results/README.md.
const SCHEMA: u32 = 1;

/// Files in the output folder.
const FILES: [&str; 2] = ["targets.json", "targets.md"];

/// A promise and what was measured of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Target {
    target: String,
    at_most: f64,
    measured: f64,
    /// The measured value as the table shows it.
    text: String,
    holds: bool,
}

/// One setting on one scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Shot {
    scene: String,
    setting: &'static str,
    shadow_map_size: u32,
    /// Against the reference; null where there is none to hold it against.
    rel_rmse: Option<f64>,
    /// Sum of the airlight over all pixels and colours.
    sum: f64,
    /// Triangles of the meshes of all projections of all lights, without the walls that close them.
    triangles: u64,
    /// Pixels that are NaN, infinite or negative.
    broken: usize,
    /// Pixels whose bits differ when the frame is drawn again; null where it is drawn once.
    unsteady: Option<usize>,
}

/// What is written to `targets.json`.
#[derive(Serialize)]
struct Report<'a> {
    schema: u32,
    date: String,
    commit: String,
    machine: Machine,
    adapter: &'a str,
    driver: &'a str,
    software: bool,
    technique: &'static str,
    width: u32,
    height: u32,
    targets: &'a [Target],
    shots: &'a [Shot],
}

/// Measures, prints and writes; gives what to print, or a failure if a promise does not hold.
pub(crate) fn run(arguments: &Targets) -> Result<String, Failure> {
    let unusable = |error: std::io::Error| {
        Failure::Input(format!("can't write results to {}: {error}", arguments.output.display()))
    };
    std::fs::create_dir_all(&arguments.output).map_err(unusable)?;
    tempfile::tempfile_in(&arguments.output).map_err(unusable)?;
    let ground = Ground { triangles: None, shadow_map_size: None, adapter: arguments.adapter.clone() };
    let context = open(&ground)?;
    check_size(&context, arguments.size)?;
    let progress = Progress::new(14);
    progress.say(&format!("adapter: {} ({})", context.adapter, context.driver));

    let shots = Bench { context: &context, size: arguments.size, progress: &progress }.shots()?;
    drop(progress);
    let targets = targets(&shots);
    let report = Report {
        schema: SCHEMA,
        date: machine::now(),
        commit: machine::commit(),
        machine: Machine::this(),
        adapter: &context.adapter,
        driver: &context.driver,
        software: context.software,
        technique: "billeter-plv",
        width: arguments.size.0,
        height: arguments.size.1,
        targets: &targets,
        shots: &shots,
    };
    let json = serde_json::to_string_pretty(&report).map_err(|error| Failure::Run(error.to_string()))?;
    let text = markdown(&report);
    for (name, content) in FILES.iter().zip([json, text.clone()]) {
        write(&arguments.output, name, &content)?;
    }
    let missed = targets.iter().filter(|target| !target.holds).count();
    let written = format!("{text}\nwrote {}\n", FILES.map(|f| path(&arguments.output, f)).join(", "));
    if missed == 0 {
        return Ok(written);
    }
    crate::print(&written);
    Err(Failure::Run(format!("{missed} of {} targets missed", targets.len())))
}

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

/// Replaces a file whole or not at all.
fn write(folder: &Path, name: &str, content: &str) -> Result<(), Failure> {
    let whole = tempfile::NamedTempFile::new_in(folder).and_then(|file| {
        std::fs::write(file.path(), content)?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            std::fs::set_permissions(file.path(), std::fs::Permissions::from_mode(0o644))?;
        }
        file.persist(folder.join(name)).map_err(|error| error.error)
    });
    whole.map(drop).map_err(|error| Failure::Run(format!("can't write {}: {error}", path(folder, name))))
}

/// The two settings that are held against each other.
fn settings() -> [(&'static str, Method); 2] {
    [
        ("default", techniques::billeter("default", "default", None, Options::best)),
        (
            "full mesh",
            techniques::billeter("full", "sweep", None, |format| Options {
                tessellation: Tessellation::Full,
                ..Options::best(format)
            }),
        ),
    ]
}

/// What all shots are taken on.
struct Bench<'a> {
    context: &'a Context,
    size: (u32, u32),
    progress: &'a Progress,
}

impl Bench<'_> {
    fn shots(&self) -> Result<Vec<Shot>, Failure> {
        let mut shots = Vec::new();
        for name in SCENES {
            let scene = load(name, None, |note| self.progress.say(note))?.at(0.0);
            self.progress.doing(&format!("{name}: reference"));
            let view = scene.camera.view(self.size.0, self.size.1);
            let rendered = reference(&scene, &view, Term::Airlight.into(), &|share| {
                self.progress.detail(format!("{name}: reference, {:.0} %", 100.0 * share));
            })?;
            self.progress.step();
            let truth = rendered.airlight.as_ref();
            for shadow_size in [512, MESH_SIZE, 2048] {
                let settings = settings().into_iter().take(if shadow_size == MESH_SIZE { 2 } else { 1 });
                self.shoot(&scene, truth, shadow_size, settings, &mut shots)?;
            }
        }
        for name in ["sealed-room", "open-room"] {
            let scene = load(name, None, |note| self.progress.say(note))?.at(0.0);
            self.shoot(&scene, None, ROOM_SIZE, settings(), &mut shots)?;
        }
        Ok(shots)
    }

    /// One scene with maps of one size, in several settings.
    fn shoot(
        &self,
        scene: &Scene,
        truth: Option<&Image>,
        shadow_size: u32,
        settings: impl IntoIterator<Item = (&'static str, Method)>,
        shots: &mut Vec<Shot>,
    ) -> Result<(), Failure> {
        let (device, queue) = (&self.context.device, &self.context.queue);
        let mut stage = Stage::new(self.context, scene, self.size, shadow_size)?;
        for (setting, method) in settings {
            interrupt::check()?;
            self.progress.doing(&format!("{}, {shadow_size}² map, {setting}", scene.name));
            let mut technique =
                method.make(device, queue, stage.format(), self.size).map_err(Failure::Run)?;
            let image = stage.picture(Some(technique.as_mut()), 0.0, Drawn::Airlight)?;
            // The largest maps take longest and show nothing in this that smaller ones do not.
            let again = if shadow_size <= MESH_SIZE {
                Some(stage.picture(Some(technique.as_mut()), 0.0, Drawn::Airlight)?)
            } else {
                None
            };
            let triangles = technique.adaptive_triangles(device, queue).map(u64::from);
            let rel_rmse = match truth {
                Some(truth) => {
                    let errors = metrics::compare(&image, truth);
                    Some(errors.map_err(|error| Failure::Run(error.to_string()))?.rel_rmse)
                }
                None => None,
            };
            let bits = |image: &Image| -> Vec<[u32; 3]> {
                image.pixels.iter().map(|pixel| pixel.to_array().map(f32::to_bits)).collect()
            };
            shots.push(Shot {
                scene: scene.name.clone(),
                setting,
                shadow_map_size: shadow_size,
                rel_rmse,
                sum: image.pixels.iter().map(|pixel| pixel.as_dvec3().element_sum()).sum(),
                triangles: triangles.unwrap_or_else(|| full_triangles(scene, shadow_size)),
                broken: image.pixels.iter().filter(|p| !p.is_finite() || p.min_element() < 0.0).count(),
                unsteady: again
                    .map(|again| bits(&image).iter().zip(&bits(&again)).filter(|(a, b)| a != b).count()),
            });
            self.progress.step();
        }
        Ok(())
    }
}

/// Triangles of meshes with a vertex for each texel.
fn full_triangles(scene: &Scene, shadow_size: u32) -> u64 {
    let projections = |light: &Light| if matches!(light, Light::Point(_)) { 6 } else { 1 };
    let cells = u64::from(shadow_size - 1).pow(2);
    scene.lights.iter().map(projections).sum::<u64>() * 2 * cells
}

/// Every promise, from the shots alone.
fn targets(shots: &[Shot]) -> Vec<Target> {
    let find = |scene: &str, setting: &str, size: u32| {
        shots.iter().find(|s| s.scene == scene && s.setting == setting && s.shadow_map_size == size)
    };
    let error = |scene: &str, setting: &str, size: u32| {
        find(scene, setting, size).and_then(|shot| shot.rel_rmse).unwrap_or(f64::NAN)
    };
    let target = |target: String, at_most: f64, measured: f64, text: String| Target {
        target,
        at_most,
        measured,
        text,
        // Not so for NaN.
        holds: measured <= at_most,
    };
    let mut targets = Vec::new();
    for (size, bound) in ERROR_BOUNDS {
        for scene in SCENES {
            let measured = error(scene, "default", size);
            let what =
                format!("{scene}, {size}² map: relative RMSE of the airlight at most {:.0} %", 100.0 * bound);
            targets.push(target(what, bound, measured, percent(measured)));
        }
    }
    for scene in SCENES {
        let count = |setting| find(scene, setting, MESH_SIZE).map_or(f64::NAN, |shot| shot.triangles as f64);
        let (adaptive, full) = (count("default"), count("full mesh"));
        let what = format!("{scene}, {MESH_SIZE}² map: adaptive meshes at most a tenth of the full ones");
        let text = format!("{} ({adaptive} of {full})", percent(adaptive / full));
        targets.push(target(what, 0.1, adaptive / full, text));
        let (adaptive, full) = (error(scene, "default", MESH_SIZE), error(scene, "full mesh", MESH_SIZE));
        let added = adaptive / full - 1.0;
        let what = format!("{scene}, {MESH_SIZE}² map: error that adaptive meshes add at most 10 %");
        let text = format!("{} ({} for {})", percent(added), percent(adaptive), percent(full));
        targets.push(target(what, 0.1, added, text));
    }
    for (setting, _) in settings() {
        let sum = |scene| find(scene, setting, ROOM_SIZE).map_or(f64::NAN, |shot| shot.sum);
        let measured = sum("sealed-room") / sum("open-room");
        let what = format!("sealed room, {setting}: airlight at most 1e-5 of the open room's");
        targets.push(target(what, 1e-5, measured, format!("{measured:.1e}")));
    }
    let mut none = |what: &str, counts: Vec<usize>| {
        // Of no picture at all nothing is known.
        let total = if counts.is_empty() { f64::NAN } else { counts.iter().sum::<usize>() as f64 };
        let text = format!("{total} in {} pictures", counts.len());
        targets.push(target(what.into(), 0.0, total, text));
    };
    none(
        "NaN, infinite and negative pixels of all pictures: none",
        shots.iter().map(|shot| shot.broken).collect(),
    );
    none(
        "pixels that differ where a frame is drawn twice: none",
        shots.iter().filter_map(|shot| shot.unsteady).collect(),
    );
    targets
}

/// The table as Markdown.
fn markdown(report: &Report<'_>) -> String {
    let mut rows = vec![["target", "measured", "holds"].map(str::to_owned)];
    for target in report.targets {
        let holds = if target.holds { "yes" } else { "NO" };
        rows.push([target.target.clone(), target.text.clone(), holds.into()]);
    }
    let widths = [0, 1, 2].map(|i| rows.iter().map(|row| row[i].chars().count()).max().unwrap_or(0));
    let line = |cells: [String; 3]| format!("| {} |\n", cells.join(" | "));
    let mut text = format!(
        "# Targets of billeter-plv\n\n{}x{}, {} ({}), commit {}, {}\n\n",
        report.width, report.height, report.adapter, report.driver, report.commit, report.date
    );
    for (index, row) in rows.iter().enumerate() {
        let pad = |i: usize| format!("{}{}", row[i], " ".repeat(widths[i] - row[i].chars().count()));
        text += &line([pad(0), pad(1), pad(2)]);
        if index == 0 {
            text += &line(widths.map(|width| "-".repeat(width)));
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Vec<Shot> {
        let shot = |scene: &str, setting, shadow_map_size, triangles, sum| Shot {
            scene: scene.into(),
            setting,
            shadow_map_size,
            rel_rmse: Some(0.01),
            sum,
            triangles,
            broken: 0,
            unsteady: Some(0),
        };
        let mut shots = Vec::new();
        for scene in SCENES {
            for size in [512, 1024, 2048] {
                shots.push(shot(scene, "default", size, 10, 1.0));
            }
            shots.push(shot(scene, "full mesh", 1024, 100, 1.0));
        }
        for setting in ["default", "full mesh"] {
            shots.push(shot("sealed-room", setting, ROOM_SIZE, 1, 0.0));
            shots.push(shot("open-room", setting, ROOM_SIZE, 1, 1.0));
        }
        shots
    }

    #[test]
    fn each_promise_can_be_missed() {
        let missed = |change: fn(&mut Vec<Shot>)| {
            let mut shots = good();
            change(&mut shots);
            targets(&shots).iter().filter(|target| !target.holds).count()
        };
        assert_eq!(missed(|_| ()), 0);
        assert_eq!(missed(|shots| shots[0].rel_rmse = Some(0.031)), 1);
        assert_eq!(missed(|shots| shots[2].rel_rmse = Some(0.011)), 1);
        assert_eq!(missed(|shots| shots[2].rel_rmse = Some(f64::NAN)), 1);
        assert_eq!(missed(|shots| shots[1].rel_rmse = Some(0.012)), 1);
        assert_eq!(missed(|shots| shots[1].triangles = 11), 1);
        assert_eq!(missed(|shots| shots[8].sum = 2e-5), 1);
        assert_eq!(missed(|shots| shots[3].broken = 1), 1);
        assert_eq!(missed(|shots| shots[10].unsteady = Some(1)), 1);
        // What was not measured does not hold.
        assert_eq!(missed(Vec::clear), 12);
    }
}
