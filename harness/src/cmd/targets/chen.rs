//! What is promised of the sampling planes.

use chen_planes::{Accumulation, Options, Visibility};
use common::gpu::Context;
use common::image::Image;
use common::{Light, PointLight, Scene, Term, metrics};
use serde::Serialize;

use super::{Target, broken};
use crate::cmd::{load, reference};
use crate::failure::Failure;
use crate::fit::Fit;
use crate::flip::mean_flip;
use crate::interrupt;
use crate::measure::{Drawn, Frames, Stage};
use crate::progress::Progress;
use crate::report::percent;
use crate::techniques::{self, Method};

/// Side of the shadow maps: so fine that planes, not texels, make the error.
const MAP_SIZE: u32 = 2048;
/// The scene on which the default is held against the paper's setting, and the one with stained glass.
const RACE: &str = "cathedral";
const GLASS: &str = "window";
/// Error that both have to reach.
const RACE_ERROR: f64 = 0.02;
/// Planes that the paper's setting is tried with, until it is there.
const RACE_PLANES: [u32; 3] = [100, 200, 400];
/// Numbers of planes, or of places in the default's slabs, that errors are fitted over.
const ORDER_NUMBERS: [u32; 5] = [4, 8, 16, 32, 64];
/// Numbers of planes that times are fitted over, and how often each is timed.
const TIME_PLANES: [u32; 5] = [10, 20, 40, 60, 80];
const ROUNDS: usize = 5;
/// Depths of a light, in distances of planes: on one, between two, behind the eye and at it.
const LIGHT_DEPTHS: [f32; 4] = [20.5, 21.0, -3.0, 0.0];

/// Steps of progress.
pub(super) const STEPS: u64 = 26;

/// One setting on one scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Shot {
    /// Which promise it is for.
    part: Part,
    scene: String,
    setting: String,
    /// Planes; or, of the default, places in each slab.
    number: u32,
    /// Against the reference; null where it was not compared.
    rel_rmse: Option<f64>,
    flip: Option<f64>,
    /// The technique's passes \[ms\], median; null where it was not timed.
    technique_ms: Option<f64>,
    /// Pixels that are NaN, infinite or negative.
    broken: usize,
}

/// Promises, each with its shots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Part {
    /// The default and the paper's setting up to an error.
    RaceDefault,
    RacePaper,
    /// Error against number.
    OrderDefault,
    OrderPaper,
    /// Time against planes.
    Linear,
    /// Lights in awkward places.
    Awkward,
    /// Stained glass by the default.
    Glass,
}

/// What all shots are taken on.
pub(super) struct Bench<'a> {
    pub context: &'a Context,
    pub size: (u32, u32),
    pub progress: &'a Progress,
}

fn method(name: String, options: Options) -> Method {
    techniques::chen(&name, "sweep", None, options)
}

/// The paper's setting with so many planes, for a target of whatever format.
fn paper(planes: u32) -> Options {
    Options { planes, ..Options::paper(wgpu::TextureFormat::Rgba16Float) }
}

fn default_setting() -> Options {
    Options::default()
}

impl Bench<'_> {
    pub(super) fn shots(&self) -> Result<Vec<Shot>, Failure> {
        let mut shots = Vec::new();
        self.race(&mut shots)?;
        self.glass(&mut shots)?;
        self.linear(&mut shots)?;
        self.awkward(&mut shots)?;
        Ok(shots)
    }

    fn truth(&self, scene: &Scene) -> Result<Image, Failure> {
        self.progress.doing(&format!("{}: reference", scene.name));
        let view = scene.camera.view(self.size.0, self.size.1);
        let rendered = reference(scene, &view, Term::Airlight.into(), &|share| {
            self.progress.detail(format!("{}: reference, {:.0} %", scene.name, 100.0 * share));
        })?;
        self.progress.step();
        rendered.airlight.ok_or_else(|| Failure::Run("the reference has no airlight".into()))
    }

    /// A picture, compared and timed as wanted.
    fn shoot(
        &self,
        stage: &mut Stage<'_>,
        scene: &Scene,
        part: Part,
        (method, number): (&Method, u32),
        truth: Option<&Image>,
        rounds: usize,
    ) -> Result<Shot, Failure> {
        interrupt::check()?;
        self.progress.doing(&format!("{}: {}", scene.name, method.name));
        let (device, queue) = (&self.context.device, &self.context.queue);
        let mut technique = method.make(device, queue, stage.format(), self.size).map_err(Failure::Run)?;
        let image = stage.picture(Some(technique.as_mut()), 0.0, Drawn::Airlight)?;
        let errors = truth.map(|truth| metrics::compare(&image, truth)).transpose();
        let errors = errors.map_err(|error| Failure::Run(error.to_string()))?;
        let flip = truth.map(|truth| {
            let seen = |image: &Image| image.to_srgb8(truth.auto_exposure());
            mean_flip(&seen(truth), &seen(&image), self.size.0 as usize, self.size.1 as usize)
        });
        let mut times = Vec::new();
        if rounds > 0 {
            let frames = Frames::new(Some(rounds as u32), self.context.software);
            let frames = if rounds == 1 { frames.cold() } else { frames };
            let taken = stage.times(technique.as_mut(), &frames)?.map_err(Failure::Run)?;
            times = if taken.passes_total.is_empty() { taken.wall } else { taken.passes_total };
        }
        self.progress.step();
        Ok(Shot {
            part,
            scene: scene.name.clone(),
            setting: method.name.clone(),
            number,
            rel_rmse: errors.map(|errors| errors.rel_rmse),
            flip,
            technique_ms: median(times),
            broken: broken(&image),
        })
    }

    fn race(&self, shots: &mut Vec<Shot>) -> Result<(), Failure> {
        let scene = load(RACE, None, |note| self.progress.say(note))?.at(0.0);
        let truth = self.truth(&scene)?;
        let mut stage = Stage::new(self.context, &scene, self.size, MAP_SIZE)?;
        let default = default_setting();
        let name = method("default".into(), default);
        shots.push(self.shoot(
            &mut stage,
            &scene,
            Part::RaceDefault,
            (&name, default.planes),
            Some(&truth),
            ROUNDS,
        )?);
        for planes in RACE_PLANES {
            let method = method(format!("paper-{planes}"), paper(planes));
            let shot = self.shoot(&mut stage, &scene, Part::RacePaper, (&method, planes), Some(&truth), 1)?;
            let there = shot.rel_rmse.is_some_and(|error| error <= RACE_ERROR);
            shots.push(shot);
            if there {
                break;
            }
        }
        Ok(())
    }

    fn glass(&self, shots: &mut Vec<Shot>) -> Result<(), Failure> {
        let scene = load(GLASS, None, |note| self.progress.say(note))?.at(0.0);
        let truth = self.truth(&scene)?;
        let mut stage = Stage::new(self.context, &scene, self.size, MAP_SIZE)?;
        for number in ORDER_NUMBERS {
            let planes = Options { accumulation: Accumulation::F32, ..paper(4 * number) };
            let by_planes = method(format!("paper-{}", planes.planes), planes);
            let visibility = Visibility::PerFragment { samples: number };
            let default = Options { visibility, ..default_setting() };
            let by_places = method(format!("{}x{number}", default.planes), default);
            for (part, method, number) in
                [(Part::OrderPaper, by_planes, planes.planes), (Part::OrderDefault, by_places, number)]
            {
                shots.push(self.shoot(&mut stage, &scene, part, (&method, number), Some(&truth), 0)?);
            }
        }
        let default = method("default".into(), default_setting());
        shots.push(self.shoot(
            &mut stage,
            &scene,
            Part::Glass,
            (&default, default_setting().planes),
            Some(&truth),
            0,
        )?);
        Ok(())
    }

    /// Numbers of planes in turn, so that whatever else the machine does hits all alike.
    fn linear(&self, shots: &mut Vec<Shot>) -> Result<(), Failure> {
        let scene = load(GLASS, None, |note| self.progress.say(note))?.at(0.0);
        let mut stage = Stage::new(self.context, &scene, self.size, 512)?;
        let (device, queue) = (&self.context.device, &self.context.queue);
        let mut timed = Vec::new();
        for planes in TIME_PLANES {
            let method = method(format!("paper-{planes}"), paper(planes));
            let technique = method.make(device, queue, stage.format(), self.size).map_err(Failure::Run)?;
            timed.push((planes, method, technique, Vec::new()));
        }
        let frames = Frames::new(Some(1), self.context.software);
        for round in 0..ROUNDS {
            for (planes, _, technique, times) in &mut timed {
                interrupt::check()?;
                self.progress.doing(&format!("{GLASS}: {planes} planes, round {}", round + 1));
                let taken = stage.times(technique.as_mut(), &frames)?.map_err(Failure::Run)?;
                times.extend(if taken.passes_total.is_empty() { taken.wall } else { taken.passes_total });
            }
        }
        for (planes, method, _, times) in timed {
            shots.push(Shot {
                part: Part::Linear,
                scene: scene.name.clone(),
                setting: method.name,
                number: planes,
                rel_rmse: None,
                flip: None,
                technique_ms: median(times),
                broken: 0,
            });
        }
        self.progress.step();
        Ok(())
    }

    /// A light on a plane, between two, behind the eye and at it, by both settings.
    fn awkward(&self, shots: &mut Vec<Shot>) -> Result<(), Failure> {
        let still = load(RACE, None, |note| self.progress.say(note))?.at(0.0);
        let view = still.camera.view(self.size.0, self.size.1);
        let forward = view.camera.basis().2;
        let spacing = chen_planes::reach(&view, still.bounds(), &still.lights, &still.medium) / 100.0;
        for depth in LIGHT_DEPTHS {
            let position = view.camera.eye + depth * spacing * forward;
            let light = PointLight { position, intensity: glam::Vec3::splat(100.0) };
            let scene = Scene { lights: vec![Light::Point(light)], ..still.clone() };
            let mut stage = Stage::new(self.context, &scene, self.size, 512)?;
            for (name, options) in [("default", default_setting()), ("paper-100", paper(100))] {
                let method = method(name.into(), options);
                let number = options.planes;
                shots.push(self.shoot(&mut stage, &scene, Part::Awkward, (&method, number), None, 0)?);
            }
        }
        Ok(())
    }
}

fn median(mut times: Vec<f64>) -> Option<f64> {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied()
}

/// Time that the paper's setting needs for the error, and whether that is only a lower bound because no number of
/// planes that was tried gets there.
fn paper_time(shots: &[Shot]) -> (f64, bool) {
    let mut before: Option<(f64, f64)> = None;
    let mut longest = f64::NAN;
    for shot in shots.iter().filter(|shot| shot.part == Part::RacePaper) {
        let (Some(error), Some(time)) = (shot.rel_rmse, shot.technique_ms) else { continue };
        if error <= RACE_ERROR {
            // Between the last two, errors fall as a power of the time.
            let share = before.map_or(1.0, |(e, _)| (e / RACE_ERROR).ln() / (e / error).ln());
            return (before.map_or(time, |(_, t)| t * (time / t).powf(share)), false);
        }
        before = Some((error, time));
        longest = time;
    }
    (longest, true)
}

/// Every promise, from the shots alone.
pub(super) fn targets(shots: &[Shot]) -> Vec<Target> {
    let of = |part| shots.iter().filter(move |shot: &&Shot| shot.part == part);
    let first = |part| of(part).next();
    let target = |what: String, at_most: f64, measured: f64, text: String| {
        Target::new("chen-planes", what, at_most, measured, text)
    };
    let nan = f64::NAN;
    let mut targets = Vec::new();

    let default = first(Part::RaceDefault);
    let error = default.and_then(|shot| shot.rel_rmse).unwrap_or(nan);
    let what =
        format!("{RACE}: relative RMSE of the airlight by the default at most {:.0} %", 100.0 * RACE_ERROR);
    targets.push(target(what, RACE_ERROR, error, percent(error)));
    let time = default.and_then(|shot| shot.technique_ms).unwrap_or(nan);
    let (needed, bound) = paper_time(shots);
    let least = of(Part::RacePaper).filter_map(|shot| shot.rel_rmse).fold(nan, f64::min);
    let text = if bound {
        format!(
            "below {:.3} (the paper's setting got to {} with the most planes tried)",
            time / needed,
            percent(least)
        )
    } else {
        format!("{:.3}", time / needed)
    };
    let what = format!(
        "{RACE}: time of the default at most a third of what the paper's setting takes for that error"
    );
    targets.push(target(what, 1.0 / 3.0, time / needed, text));

    for (part, name) in
        [(Part::OrderPaper, "paper's placement, planes"), (Part::OrderDefault, "default, places in a slab")]
    {
        let points: Vec<(f64, f64)> =
            of(part).filter_map(|s| Some((f64::from(s.number), s.rel_rmse?))).collect();
        let slope = Fit::power(&points).map_or(nan, |fit| fit.slope);
        let what = format!("{GLASS}: error falls as a power of the number ({name}): exponent at most -0.7");
        targets.push(target(what, -0.7, slope, format!("{slope:.2}")));
    }

    let points: Vec<(f64, f64)> =
        of(Part::Linear).filter_map(|s| Some((f64::from(s.number), s.technique_ms?))).collect();
    let r2 = Fit::line(&points).map_or(nan, |fit| fit.r2);
    let what = "time is linear in the number of planes: 1 − R² at most 0.02".to_owned();
    targets.push(target(what, 0.02, 1.0 - r2, format!("R² {r2:.4}")));

    let glass = first(Part::Glass);
    let flip = glass.and_then(|shot| shot.flip).unwrap_or(nan);
    let text =
        format!("{flip:.4} (relative RMSE {})", percent(glass.and_then(|shot| shot.rel_rmse).unwrap_or(nan)));
    let what =
        format!("{GLASS}: no banding to be seen in the default: FLIP against the reference at most 0.02");
    targets.push(target(what, 0.02, flip, text));

    let awkward = of(Part::Awkward).map(|shot| shot.broken).collect();
    let what = "NaN, infinite and negative pixels, light on, between and behind planes and at the eye: none";
    targets.push(Target::none("chen-planes", what, awkward));
    let others = shots.iter().filter(|s| s.part != Part::Awkward && s.part != Part::Linear);
    targets.push(Target::none(
        "chen-planes",
        "NaN, infinite and negative pixels of all other pictures: none",
        others.map(|shot| shot.broken).collect(),
    ));
    targets
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Vec<Shot> {
        let shot = |part, number, rel_rmse, technique_ms| Shot {
            part,
            scene: RACE.into(),
            setting: "any".into(),
            number,
            rel_rmse: Some(rel_rmse),
            flip: Some(0.01),
            technique_ms: Some(technique_ms),
            broken: 0,
        };
        let mut shots = vec![
            shot(Part::RaceDefault, 8, 0.019, 10.0),
            shot(Part::RacePaper, 100, 0.04, 40.0),
            shot(Part::RacePaper, 200, 0.01, 80.0),
            shot(Part::Glass, 8, 0.01, 1.0),
            shot(Part::Awkward, 8, 0.01, 1.0),
        ];
        for number in [1, 2, 4] {
            shots.push(shot(Part::OrderPaper, number, 1.0 / f64::from(number), 1.0));
            shots.push(shot(Part::OrderDefault, number, 1.0 / f64::from(number), 1.0));
            shots.push(shot(Part::Linear, number, 1.0, f64::from(number)));
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
        assert_eq!(missed(|shots| shots[0].rel_rmse = Some(0.021)), 1);
        assert_eq!(missed(|shots| shots[0].technique_ms = Some(20.0)), 1);
        assert_eq!(missed(|shots| shots[3].flip = Some(0.03)), 1);
        assert_eq!(missed(|shots| shots[4].broken = 1), 1);
        assert_eq!(missed(|shots| shots[1].broken = 1), 1);
        assert_eq!(missed(|shots| shots[5].rel_rmse = Some(0.2)), 1);
        assert_eq!(missed(|shots| shots[7].technique_ms = Some(9.0)), 1);
        // What was not measured does not hold.
        assert_eq!(missed(Vec::clear), 8);
    }

    #[test]
    fn the_paper_s_time_is_found_between_two_numbers() {
        // 4 % at 40 ms, 1 % at 80 ms: 2 % half-way.
        let (time, bound) = paper_time(&good());
        assert!((time - 40.0 * 2f64.sqrt()).abs() < 1e-9 && !bound);
        let mut shots = good();
        shots.remove(2);
        assert_eq!(paper_time(&shots), (40.0, true));
    }
}
