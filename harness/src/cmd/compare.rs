//! The comparison: every technique on every scene, against the reference.

use std::collections::BTreeMap;
use std::path::Path;

use common::gpu::Context;
use common::image::{Image, write_rgb8};
use common::reference::Rendered;
use common::{Scene, Term, Terms, metrics};

use crate::cli::Compare;
use crate::cmd::{cause, load, open, reference, shadow_map_size};
use crate::failure::Failure;
use crate::falsecolor::error_map;
use crate::flip::mean_flip;
use crate::interrupt;
use crate::machine::{self, Machine};
use crate::measure::{Drawn, Frames, Stage, Times, check_size, motion};
use crate::output::RunFolder;
use crate::progress::Progress;
use crate::record::{Errors, Pictures, Record, ReferenceNote, SCHEMA, Samples, Spread, Study, Writer};
use crate::report;
use crate::techniques::{self, Method, Technique};

/// The scenes of a run that names none.
const SCENES: [&str; 2] = ["cathedral", "amphora"];

/// Shadow maps smaller than this are not held to a method's bound.
const BOUND_FROM: u32 = 512;

/// What is the same in all measurements of a run.
struct Run<'a> {
    context: &'a Context,
    size: (u32, u32),
    frames: Frames,
    shadow_size: u32,
    /// Whether methods were chosen by name: else one that can't draw a scene is left out.
    named: bool,
    machine: Machine,
    commit: String,
    folder: &'a Path,
    progress: &'a Progress,
}

/// A scene with its reference.
struct Case<'a> {
    scene: &'a Scene,
    builtin: bool,
    /// Whether there is any airlight in the reference: else no relative error has a meaning.
    lit: bool,
    reference: &'a Rendered,
    airlight: &'a Image,
    surface: &'a Image,
    /// Surfaces as the GPU draws them.
    drawn_surface: &'a Image,
    exposure: f32,
    pictures: Pictures,
}

/// Compares, prints and writes everything; gives what to print at the end.
pub(crate) fn run(arguments: &Compare) -> Result<String, Failure> {
    // Everything that can be wrong with the command line, before any work.
    let methods = methods(&arguments.techniques, arguments.improvements)?;
    let names: Vec<&str> = if arguments.scenes.is_empty() {
        SCENES.to_vec()
    } else {
        arguments.scenes.iter().map(String::as_str).collect()
    };
    let progress = Progress::new((names.len() * (methods.len() + 1)) as u64);
    let context = open(&arguments.ground)?;
    progress.say(&format!(
        "adapter: {} ({}){}",
        context.adapter,
        context.driver,
        if context.software { ", software" } else { "" }
    ));
    let mut scenes = names
        .iter()
        .map(|name| load(name, arguments.ground.triangles, |note| progress.say(note)))
        .collect::<Result<Vec<Scene>, Failure>>()?;
    name_apart(&mut scenes);
    let size = arguments.size.unwrap_or(if context.software { (256, 208) } else { (1280, 1024) });
    check_size(&context, size)?;
    let folder = RunFolder::create(&arguments.output)?;
    let run = Run {
        context: &context,
        size,
        frames: Frames::new(arguments.frames, context.software),
        shadow_size: shadow_map_size(&arguments.ground, &context),
        named: !arguments.techniques.is_empty(),
        machine: Machine::this(),
        commit: machine::commit(),
        folder: folder.path(),
        progress: &progress,
    };
    let records = match run.measure_all(&names, &scenes, &methods) {
        Ok(records) => records,
        Err(failure) => return Err(folder.abandon(failure)),
    };
    if let Err(failure) = report::write(folder.path(), &records) {
        return Err(folder.abandon(failure));
    }
    drop(progress);
    let destination = folder.finish()?;

    let text = format!(
        "\n{}\n{}page: {}\n",
        report::table::table(&records),
        report::table::legend(&records),
        destination.join(report::PAGE).display()
    );
    let wrong: Vec<String> = records
        .iter()
        .filter_map(|r| r.problem().map(|problem| format!("{}, {}: {problem}", r.scene, r.name)))
        .collect();
    if wrong.is_empty() {
        return Ok(text);
    }
    crate::print(&text);
    Err(Failure::Run(format!("wrong pictures: {}", wrong.join("; "))))
}

/// The methods that the user named, each once; all if none was named; and `improvements` if wanted.
fn methods(wanted: &[String], improvements: bool) -> Result<Vec<Method>, Failure> {
    let mut named = Vec::new();
    for name in wanted {
        named.extend(techniques::find(name).map_err(Failure::Input)?);
    }
    if wanted.is_empty() {
        named = techniques::all();
    }
    if improvements {
        named.extend(techniques::improvements());
    }
    let mut methods: Vec<Method> = Vec::new();
    for method in named {
        if !methods.iter().any(|known| known.name == method.name) {
            methods.push(method);
        }
    }
    Ok(methods)
}

/// Numbers scenes of one name, so that they are not taken for one.
fn name_apart(scenes: &mut [Scene]) {
    for index in 1..scenes.len() {
        let (before, here) = scenes.split_at_mut(index);
        let (name, mut number) = (here[0].name.clone(), 1);
        while before.iter().any(|scene| scene.name == here[0].name) {
            number += 1;
            here[0].name = format!("{name} ({number})");
        }
    }
}

impl Run<'_> {
    fn measure_all(
        &self,
        names: &[&str],
        scenes: &[Scene],
        methods: &[Method],
    ) -> Result<Vec<Record>, Failure> {
        let failed =
            |error: std::io::Error| Failure::Run(format!("can't write {}: {error}", self.folder.display()));
        std::fs::create_dir(self.folder.join("images")).map_err(failed)?;
        let mut writer = Writer::create(self.folder)?;
        let mut records = Vec::new();
        for (index, (name, scene)) in names.iter().zip(scenes).enumerate() {
            let mut stage = Stage::new(self.context, scene, self.size, self.shadow_size)?;
            self.progress.doing(&format!("{}: reference", scene.name));
            let view = scene.at(0.0).camera.view(self.size.0, self.size.1);
            // A technique that draws clouds draws all orders of scattering.
            let cloudy = scene.cloud.is_some();
            let terms = if cloudy { Terms::DIRECT.with(Term::Multiple) } else { Terms::DIRECT };
            let rendered = reference(&scene.at(0.0), &view, terms, &|share| {
                self.progress.detail(format!("{}: reference, {:.0} %", scene.name, 100.0 * share));
            })?;
            let (Some(airlight), Some(surface)) = (&rendered.airlight, &rendered.surface) else {
                return Err(Failure::Run(format!("{}: the reference lacks a term", scene.name)));
            };
            let airlight = &match &rendered.multiple {
                Some(multiple) => airlight.plus(multiple),
                None => airlight.clone(),
            };
            if let Some(problem) = &rendered.cache_problem {
                self.progress.say(&format!("note: the reference was not kept for the next run: {problem}"));
            }
            let total = rendered.total();
            let prefix = format!("images/{}-{}", index + 1, report::file_name(&scene.name));
            let drawn_surface = stage.picture(None, 0.0, Drawn::Surface)?;
            let case = Case {
                drawn_surface: &drawn_surface,
                scene,
                builtin: common::scene::builtin::NAMES.iter().any(|(known, _)| known == name),
                lit: airlight.pixels.iter().any(|pixel| pixel.max_element() > 0.0),
                airlight,
                surface,
                exposure: total.auto_exposure(),
                pictures: Pictures {
                    reference: format!("{prefix}-reference.png"),
                    reference_airlight_exr: format!("{prefix}-reference-airlight.exr"),
                    exposure: total.auto_exposure(),
                    ..Default::default()
                },
                reference: &rendered,
            };
            self.write(&case.pictures.reference, |path| total.write_png(path, case.exposure))?;
            self.write(&case.pictures.reference_airlight_exr, |path| airlight.write_exr(path))?;
            self.progress.step();
            for method in methods {
                interrupt::check()?;
                if !self.named && method.refusal(scene).is_some() {
                    self.progress.step();
                    continue;
                }
                self.progress.doing(&format!("{}: {}", scene.name, method.name));
                let record = self.measure(&mut stage, &case, method, &prefix)?;
                if let Some(refused) = &record.refused {
                    self.progress.say(&format!("{}: {refused}", scene.name));
                }
                writer.add(&record)?;
                records.push(record);
                self.progress.step();
            }
        }
        Ok(records)
    }

    /// One technique on one scene: times, picture, errors.
    fn measure(
        &self,
        stage: &mut Stage<'_>,
        case: &Case<'_>,
        method: &Method,
        prefix: &str,
    ) -> Result<Record, Failure> {
        let named = |failure: Failure| match failure {
            Failure::Run(text) => Failure::Run(format!("{}: {text}", method.name)),
            other => other,
        };
        if let Some(refusal) = method.refusal(case.scene) {
            return Ok(self.record(case, method, Times::default(), Err(refusal)));
        }
        let made = method.make(&self.context.device, &self.context.queue, stage.format(), self.size);
        let mut technique = match made {
            Ok(technique) => technique,
            Err(refusal) => return Ok(self.record(case, method, Times::default(), Err(refusal))),
        };
        let times = match stage.times(technique.as_mut(), &self.frames).map_err(named)? {
            Ok(times) => times,
            Err(refusal) => return Ok(self.record(case, method, Times::default(), Err(refusal))),
        };
        let held = self.pictures(stage, case, technique.as_mut(), prefix, &method.name).map_err(named)?;
        Ok(self.record(case, method, times, Ok(held)))
    }

    /// Draws the picture at time 0, holds it against the reference, and writes it.
    fn pictures(
        &self,
        stage: &mut Stage<'_>,
        case: &Case<'_>,
        technique: &mut dyn Technique,
        prefix: &str,
        name: &str,
    ) -> Result<(Errors, Pictures), Failure> {
        let airlight = stage.picture(Some(technique), 0.0, Drawn::Airlight)?;
        let both = case.drawn_surface.plus(&airlight);

        let error = metrics::compare(&airlight, case.airlight).map_err(|e| Failure::Run(e.to_string()))?;
        let seen = |airlight: &Image| case.surface.plus(airlight).to_srgb8(case.exposure);
        let (width, height) = (airlight.width as usize, airlight.height as usize);
        let flip = mean_flip(&seen(case.airlight), &seen(&airlight), width, height);
        let errors = Errors {
            rel_rmse: error.rel_rmse,
            bias: error.bias,
            p99: error.p99,
            max: error.max,
            worst_tile: error.worst_tile,
            leak: error.leak,
            flip,
            nan: error.nan,
            inf: error.inf,
            negative: error.negative,
            energy_ratio: error.energy_ratio,
        };

        let pictures = Pictures {
            picture: format!("{prefix}-{name}.png"),
            airlight_exr: format!("{prefix}-{name}-airlight.exr"),
            error_map: format!("{prefix}-{name}-error.png"),
            ..case.pictures.clone()
        };
        self.write(&pictures.picture, |path| both.write_png(path, case.exposure))?;
        self.write(&pictures.airlight_exr, |path| airlight.write_exr(path))?;
        let map = error_map(&airlight, case.airlight);
        self.write(&pictures.error_map, |path| write_rgb8(path, map.width, map.height, map.bytes))?;
        Ok((errors, pictures))
    }

    /// Writes a picture into the run's folder.
    fn write<E: std::error::Error + 'static>(
        &self,
        name: &str,
        write: impl FnOnce(&Path) -> Result<(), E>,
    ) -> Result<(), Failure> {
        let path = self.folder.join(name);
        write(&path)
            .map_err(|error| Failure::Run(format!("can't write {}: {}", path.display(), cause(&error))))
    }

    fn record(
        &self,
        case: &Case<'_>,
        method: &Method,
        times: Times,
        held: Result<(Errors, Pictures), String>,
    ) -> Record {
        let refused = held.as_ref().err().cloned();
        let (error, pictures) = held.unwrap_or((Errors::NONE, case.pictures.clone()));
        let frames = times.wall.len();
        let stamped = times.passes_total.len() == frames;
        let technique = if stamped { times.passes_total } else { times.wall.clone() };
        let spreads = |passes: BTreeMap<&'static str, Vec<f64>>| {
            passes.into_iter().map(|(name, times)| (name.to_owned(), Spread::of(&times))).collect()
        };
        let kinds = case.scene.lights.iter().map(|light| light.kind().to_owned());
        let names = |terms: Terms| terms.iter().map(|term| term.name().to_owned()).collect::<Vec<_>>();
        let drawn = Terms::from(Term::Airlight);
        let terms = names(if case.scene.cloud.is_some() { drawn.with(Term::Multiple) } else { drawn });
        let held_to_bound = case.builtin && case.lit && self.shadow_size >= BOUND_FROM;
        let mut settings = method.settings();
        settings.insert("shadow_map_size".into(), self.shadow_size.into());
        Record {
            schema: SCHEMA,
            study: Study::Main,
            date: machine::now(),
            commit: self.commit.clone(),
            machine: self.machine.clone(),
            adapter: self.context.adapter.clone(),
            driver: self.context.driver.clone(),
            software: self.context.software,
            scene: case.scene.name.clone(),
            triangles: case.scene.triangle_count(),
            lights: case.scene.lights.len(),
            light_kinds: kinds.collect(),
            name: method.name.clone(),
            technique: method.technique.into(),
            peer: method.technique.starts_with("ray-march"),
            preset: method.preset.into(),
            label: method.label.clone(),
            settings,
            terms: terms.clone(),
            width: self.size.0,
            height: self.size.1,
            frames,
            warm_up: self.frames.warm_up,
            moving: motion(case.scene).into(),
            technique_ms: Spread::of(&technique),
            technique_ms_from: if stamped { "timestamps" } else { "wall clock" }.into(),
            technique_wall_ms: Spread::of(&times.wall),
            passes: spreads(times.passes),
            ground_passes: spreads(times.ground_passes),
            cpu_ms: Spread::of(&times.cpu),
            frame_ms: Spread::of(&times.frame),
            samples_ms: Samples { technique, technique_wall: times.wall, cpu: times.cpu, frame: times.frame },
            gpu_bytes: None,
            silhouette_edges: None,
            error,
            model_error: None,
            bound: method.bound.filter(|_| held_to_bound),
            refused,
            reference: ReferenceNote {
                terms,
                uncertainty: case.reference.uncertainty.max(case.reference.multiple_uncertainty),
                seconds: case.reference.seconds,
                cached: case.reference.cached,
            },
            pictures,
            notes: case.scene.notes.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_of_one_name_are_told_apart() {
        let mut scenes = ["a", "b", "a", "a"].map(Scene::empty);
        name_apart(&mut scenes);
        assert_eq!(scenes.map(|scene| scene.name), ["a", "b", "a (2)", "a (3)"]);
    }

    #[test]
    fn a_method_is_taken_once() {
        let wanted = ["ray-march", "ray-march-64", "billeter-plv"].map(String::from);
        let names: Vec<String> =
            methods(&wanted, false).unwrap().into_iter().map(|method| method.name).collect();
        assert_eq!(names.len(), 5, "{names:?}");
        assert!(methods(&["fog".into()], true).is_err());
        assert_eq!(methods(&wanted, true).unwrap().len(), 5 + techniques::improvements().len());
        let named = methods(&["billeter-plv-paper-f32".into()], true).unwrap();
        assert_eq!(named.len(), techniques::improvements().len());
    }
}
