//! A run: every method of the plan on its scene, against the reference.

use std::collections::HashSet;
use std::path::Path;

use common::gpu::Context;
use common::image::{Image, write_rgb8};
use common::{Scene, Term, Terms};

use crate::asked::Asked;
use crate::cli;
use crate::cmd::{cause, load, open, shadow_map_size};
use crate::failure::Failure;
use crate::falsecolor::error_map;
use crate::interrupt;
use crate::judge::Judge;
use crate::machine::{self, Machine};
use crate::measure::{Frames, Stage, Times, check_size, motion};
use crate::output::RunFolder;
use crate::papers;
use crate::plan::{self, Depth, Group, Wish};
use crate::progress::Progress;
use crate::record::{
    self, Errors, Key, Pictures, Record, ReferenceNote, SCHEMA, Samples, Spread, Study, Writer,
};
use crate::report;
use crate::techniques::Method;

/// Shadow maps smaller than this are not held to a method's bound.
const BOUND_FROM: u32 = 512;

/// What is the same in all measurements of a run.
struct Run<'a> {
    context: &'a Context,
    depth: Depth,
    frames: Frames,
    shadow_size: u32,
    /// Whether methods were chosen by name: else one that can't draw a scene is left out.
    named: bool,
    machine: Machine,
    commit: String,
    folder: &'a Path,
    progress: &'a Progress,
}

/// A scene with what its pictures are held against.
struct Case<'a> {
    study: Study,
    scene: &'a Scene,
    size: (u32, u32),
    builtin: bool,
    judge: Option<Judge>,
}

/// Measures, prints and writes everything; gives what to print at the end.
pub(crate) fn run(arguments: &cli::Run) -> Result<String, Failure> {
    // Everything that can be wrong with the command line, before any work.
    let depth = if arguments.full { Depth::Full } else { Depth::Quick };
    let wish = |size| Wish {
        depth,
        scenes: &arguments.scenes,
        only: &arguments.only,
        improvements: arguments.improvements,
        studies: &arguments.studies,
        triangles: arguments.ground.triangles,
        size,
    };
    plan::groups(&wish((1, 1)))?;
    let context = open(&arguments.ground)?;
    let full = depth == Depth::Full;
    let size = arguments.size.unwrap_or(match (context.software, full) {
        (true, false) => (256, 208),
        (true, true) => (640, 512),
        (false, _) => (1280, 1024),
    });
    check_size(&context, size)?;
    let groups = plan::groups(&wish(size))?;
    let content = |name: &String| Ok(load(name, arguments.ground.triangles, |_| ())?.content_hash());
    let contents: Vec<String> = arguments.scenes.iter().map(content).collect::<Result<_, Failure>>()?;
    let asked = Asked::of(arguments, contents, size);
    let folder = if arguments.resume {
        let folder = RunFolder::resume(&arguments.output)?;
        asked.check(&folder)?;
        folder
    } else {
        let folder = RunFolder::create(&arguments.output)?;
        asked.write(&folder)?;
        folder
    };
    let machine = Machine::this();
    let taken = if arguments.resume { record::read_stopped(folder.path())? } else { Vec::new() };
    let elsewhere = |record: &&Record| record.adapter != context.adapter || record.machine != machine;
    if let Some(other) = taken.iter().find(elsewhere) {
        return Err(folder.abandon(Failure::Input(format!(
            "the run that was stopped was measured on {} and {}, not on {} and {}; start another one without --resume",
            other.adapter, other.machine.cpu, context.adapter, machine.cpu
        ))));
    }
    let progress = Progress::new(groups.iter().map(|group| group.methods.len() as u64 + 1).sum());
    let software = if context.software { ", software" } else { "" };
    progress.say(&format!("adapter: {} ({}){software}", context.adapter, context.driver));
    let run = Run {
        context: &context,
        depth,
        frames: Frames::of_run(arguments.frames, context.software, !full),
        shadow_size: arguments.ground.shadow_map_size.unwrap_or(if full {
            1024
        } else {
            shadow_map_size(&arguments.ground, &context)
        }),
        named: !arguments.only.is_empty(),
        machine,
        commit: machine::commit(),
        folder: folder.path(),
        progress: &progress,
    };
    let mut records = taken;
    let measured = run.measure_all(&groups, &mut records);
    drop(progress);
    let everything =
        full && arguments.scenes.is_empty() && arguments.only.is_empty() && arguments.studies.is_empty();
    if measured.is_ok() && records.iter().all(|record| record.refused.is_some()) {
        folder.discard();
        return Err(Failure::Input("no method can draw any of the scenes: nothing was measured".into()));
    }
    let finished = measured
        .and_then(|()| if everything { papers::all(folder.path(), arguments) } else { Ok(()) })
        .and_then(|()| report::write(folder.path(), &records));
    if let Err(failure) = finished {
        return Err(folder.abandon(failure));
    }
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

/// Tells scenes of one name apart by numbers, so that they are not taken for one.
#[derive(Default)]
struct Names(Vec<(plan::Subject, String)>);

impl Names {
    fn of(&mut self, group: &Group, scene: &Scene) -> String {
        if let Some((_, name)) = self.0.iter().find(|(subject, _)| subject.is_same_file(&group.subject)) {
            return name.clone();
        }
        let taken = |wanted: &str| self.0.iter().any(|(_, name)| name == wanted);
        let others = (2..).map(|number| format!("{} ({number})", scene.name));
        let name = std::iter::once(scene.name.clone()).chain(others).find(|name| !taken(name));
        let name = name.unwrap_or_default();
        self.0.push((group.subject.clone(), name.clone()));
        name
    }
}

impl Run<'_> {
    /// Measures what is not among `records` yet, and adds it there.
    fn measure_all(&self, groups: &[Group], records: &mut Vec<Record>) -> Result<(), Failure> {
        let failed =
            |error: std::io::Error| Failure::Run(format!("can't write {}: {error}", self.folder.display()));
        std::fs::create_dir_all(self.folder.join("images")).map_err(failed)?;
        let mut writer = Writer::open(self.folder)?;
        let known: HashSet<Key> = records.iter().map(Record::key).collect();
        let mut names = Names::default();
        for (index, group) in groups.iter().enumerate() {
            interrupt::check()?;
            let mut scene = group.subject.load(|note| self.progress.say(note))?;
            scene.name = names.of(group, &scene);
            let missing = |method: &&Method| !known.contains(&self.key(group, &scene, method));
            let mut methods: Vec<&Method> = group
                .methods
                .iter()
                .filter(|method| self.named || method.refusal(&scene).is_none())
                .filter(|method| !self.is_measured_as_another(method, &group.methods))
                .filter(missing)
                .collect();
            self.progress.skip((group.methods.len() - methods.len()) as u64);
            if methods.is_empty() {
                self.progress.step();
                continue;
            }
            // One size of shadow maps after the other: a stage for each.
            methods.sort_by_key(|method| self.side(method));
            let prefix = format!("images/{}-{}", index + 1, report::file_name(&scene.name));
            let case = self.case(group, &scene, prefix)?;
            self.progress.step();
            let mut stage: Option<(u32, Stage<'_>)> = None;
            for method in methods {
                interrupt::check()?;
                let side = self.side(method);
                if stage.as_ref().is_none_or(|(held, _)| *held != side) {
                    // The one before goes first: both may not fit.
                    drop(stage.take());
                    stage = Some((side, Stage::new(self.context, &scene, group.size, side)?));
                }
                let Some((_, stage)) = &mut stage else { continue };
                let what = group.subject.text(&scene);
                self.progress.doing(&format!("{}: {what}: {}", group.study.name(), method.name));
                let record = self.measure(stage, &case, method)?;
                if let Some(refused) = &record.refused {
                    self.progress.say(&format!("{}: {refused}", scene.name));
                }
                writer.add(&record)?;
                records.push(record);
                self.progress.step();
            }
        }
        Ok(())
    }

    /// Texels on a side of the shadow maps that a method is given.
    fn side(&self, method: &Method) -> u32 {
        method.shadow_map_size.unwrap_or(self.shadow_size)
    }

    /// Whether it names the size of map that the same method has without naming one.
    fn is_measured_as_another(&self, method: &Method, methods: &[Method]) -> bool {
        method.shadow_map_size == Some(self.shadow_size)
            && methods.iter().any(|other| {
                other.shadow_map_size.is_none()
                    && method.name == format!("{}@{}", other.name, self.shadow_size)
            })
    }

    /// Which measurement this will be.
    fn key(&self, group: &Group, scene: &Scene, method: &Method) -> Key {
        Key {
            study: group.study,
            scene: scene.name.clone(),
            triangles: scene.triangle_count(),
            lights: scene.lights.len(),
            name: method.name.clone(),
            width: group.size.0,
            height: group.size.1,
            shadow_map_size: Some(u64::from(self.side(method))),
        }
    }

    /// The scene with its reference, where errors are wanted.
    fn case<'a>(&self, group: &Group, scene: &'a Scene, prefix: String) -> Result<Case<'a>, Failure> {
        let judged = matches!(group.study, Study::Main | Study::Improvements);
        let judge = judged.then(|| self.judge(group, scene, prefix)).transpose()?;
        let builtin = group.subject.is_builtin();
        Ok(Case { study: group.study, scene, size: group.size, builtin, judge })
    }

    fn judge(&self, group: &Group, scene: &Scene, prefix: String) -> Result<Judge, Failure> {
        let mut stage = Stage::new(self.context, scene, group.size, self.shadow_size)?;
        let all = self.depth == Depth::Full && group.study == Study::Main;
        let judge = Judge::of(&mut stage, scene, group.size, all, prefix, self.progress)?;
        let Pictures { reference, reference_airlight_exr, exposure, .. } = &judge.pictures;
        self.write(reference, |path| judge.total().write_png(path, *exposure))?;
        self.write(reference_airlight_exr, |path| judge.airlight.write_exr(path))?;
        Ok(judge)
    }

    /// One method on one scene: picture, errors, times.
    fn measure(&self, stage: &mut Stage<'_>, case: &Case<'_>, method: &Method) -> Result<Record, Failure> {
        let named = |failure: Failure| match failure {
            Failure::Run(text) => Failure::Run(format!("{}: {text}", method.name)),
            other => other,
        };
        let refused = |why| Ok(self.record(case, method, Err(why)));
        if let Some(refusal) = method.refusal(case.scene) {
            return refused(refusal);
        }
        let before = self.allocated();
        let made = method.make(&self.context.device, &self.context.queue, stage.format(), case.size);
        let mut technique = match made {
            Ok(technique) => technique,
            Err(refusal) => return refused(refusal),
        };
        // The picture first: it warms up what the times are taken of, and says whether the scene can be drawn.
        let airlight = match stage.try_picture(technique.as_mut(), 0.0).map_err(named)? {
            Ok(airlight) => airlight,
            Err(refusal) => return refused(refusal),
        };
        for warning in technique.warnings() {
            self.progress.say(&format!("note: {}, {}: {warning}", case.scene.name, method.name));
        }
        let silhouette_edges = technique.silhouette_edges();
        let times = match stage.times(technique.as_mut(), &self.frames).map_err(named)? {
            Ok(times) => times,
            Err(refusal) => return refused(refusal),
        };
        let gpu_bytes = before.zip(self.allocated()).map(|(before, after)| after.saturating_sub(before));
        let errors = case
            .judge
            .as_ref()
            .map_or_else(|| Ok(Errors::counted(&airlight)), |judge| judge.errors(&airlight))?;
        let model_error = match &case.judge {
            Some(judge) => judge.model_error(&airlight)?,
            None => None,
        };
        let pictures = self.pictures(case, method, &airlight)?;
        Ok(Record {
            gpu_bytes,
            silhouette_edges,
            model_error,
            ..self.record(case, method, Ok((times, errors, pictures)))
        })
    }

    /// Memory that the device has given out \[bytes\], where it says.
    fn allocated(&self) -> Option<u64> {
        // What was dropped is given back once the device is done with it.
        self.context.wait().ok()?;
        self.context.device.generate_allocator_report().map(|report| report.total_allocated_bytes)
    }

    /// Writes the picture and what it is off by.
    fn pictures(&self, case: &Case<'_>, method: &Method, airlight: &Image) -> Result<Pictures, Failure> {
        let Some(judge) = &case.judge else { return Ok(Pictures::default()) };
        let (prefix, name) = (&judge.prefix, report::file_name(&method.name));
        let pictures = Pictures {
            picture: format!("{prefix}-{name}.png"),
            airlight_exr: format!("{prefix}-{name}-airlight.exr"),
            error_map: format!("{prefix}-{name}-error.png"),
            ..judge.pictures.clone()
        };
        let both = judge.drawn_surface.plus(airlight);
        self.write(&pictures.picture, |path| both.write_png(path, pictures.exposure))?;
        self.write(&pictures.airlight_exr, |path| airlight.write_exr(path))?;
        let map = error_map(airlight, &judge.airlight);
        self.write(&pictures.error_map, |path| write_rgb8(path, map.width, map.height, map.bytes))?;
        Ok(pictures)
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
        held: Result<(Times, Errors, Pictures), String>,
    ) -> Record {
        let refused = held.as_ref().err().cloned();
        let reference_pictures = case.judge.as_ref().map(|judge| judge.pictures.clone()).unwrap_or_default();
        let (times, error, pictures) = held.unwrap_or((Times::default(), Errors::NONE, reference_pictures));
        let frames = times.wall.len();
        let stamped = times.passes_total.len() == frames;
        let technique = if stamped { times.passes_total } else { times.wall.clone() };
        let spreads = |passes: std::collections::BTreeMap<&'static str, Vec<f64>>| {
            passes.into_iter().map(|(name, times)| (name.to_owned(), Spread::of(&times))).collect()
        };
        let kinds = case.scene.lights.iter().map(|light| light.kind().to_owned());
        let names = |terms: Terms| terms.iter().map(|term| term.name().to_owned()).collect::<Vec<_>>();
        let drawn = Terms::from(Term::Airlight);
        let terms = names(if case.scene.cloud.is_some() { drawn.with(Term::Multiple) } else { drawn });
        let side = self.side(method);
        let held_to_bound = case.builtin
            && case.study == Study::Main
            && side >= BOUND_FROM
            && case.judge.as_ref().is_some_and(|judge| judge.lit);
        let mut settings = method.settings();
        settings.insert("shadow_map_size".into(), side.into());
        Record {
            schema: SCHEMA,
            study: case.study,
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
            peer: method.peer,
            preset: method.preset.into(),
            label: method.label.clone(),
            settings,
            terms: terms.clone(),
            width: case.size.0,
            height: case.size.1,
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
            reference: case.judge.as_ref().map_or(ReferenceNote::none(), |judge| judge.note(terms)),
            pictures,
            notes: case.scene.notes.clone(),
        }
    }
}
