//! Times of frames in all settings that the text speaks of, drawn in turn.

use serde::Serialize;
use szk_network::{Options, Sampling};

use super::super::{Origin, Press, cells};
use super::lab::{self, Lab, paper, particles};
use super::{SCHEMA, built, turn, white};
use crate::failure::Failure;
use crate::fit::Fit;
use crate::record::Spread;
use crate::report::{digits, markdown};

/// Steps of progress.
pub(super) const STEPS: u64 = 1;

/// Rounds that are timed, after one that is not; fewer where they were asked for.
const ROUNDS: usize = 3;

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Case {
    /// `paper` or `default`.
    pub setting: &'static str,
    pub particles: u32,
    pub directions: u32,
    pub lights: usize,
    pub sky: bool,
}

impl Case {
    pub(super) const fn new(setting: &'static str, particles: u32, directions: u32) -> Self {
        Self { setting, particles, directions, lights: 2, sky: true }
    }
}

/// The paper's frames per second: of Figures 5 and 8.
const PAPER: [(&str, u32, f64); 2] = [("5", 1024, 26.0), ("8 and 7", 512, 45.0)];
/// What the sweeps go through.
const PARTICLES: [u32; 4] = [256, 512, 1024, 2048];
const DIRECTIONS: [u32; 4] = [32, 64, 96, 128];

/// Times \[ms\] of frames: one step, direct light found again.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    #[serde(flatten)]
    pub case: Case,
    pub frame_ms: Spread,
    /// Of the iteration's pass; of the frame where there are no timestamps.
    pub iterate_ms: Spread,
    /// Round by round.
    pub frame_samples_ms: Vec<f64>,
    pub iterate_samples_ms: Vec<f64>,
}

#[derive(Debug, Serialize)]
pub(super) struct Timing {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    pub rows: Vec<Row>,
}

/// Measures and writes.
pub(super) fn measure(press: &Press<'_>) -> Result<Timing, Failure> {
    press.progress.doing("times");
    let mut cases: Vec<Case> = Vec::new();
    for setting in ["paper", "default"] {
        let by_particles = PARTICLES.map(|count| Case::new(setting, count, 128));
        let by_directions = DIRECTIONS.map(|count| Case::new(setting, 1024, count));
        for case in by_particles.into_iter().chain(by_directions) {
            if !cases.contains(&case) {
                cases.push(case);
            }
        }
    }
    for (lights, sky) in [(1, false), (2, false), (4, false)] {
        cases.push(Case { lights, sky, ..Case::new("paper", 1024, 128) });
    }
    let mut labs = cases.iter().map(|case| lab(press, case)).collect::<Result<Vec<_>, _>>()?;
    let mut samples = vec![(Vec::new(), Vec::new()); cases.len()];
    for round in 0..=press.frames.at_most(ROUNDS) {
        for turn_of in 0..labs.len() {
            // Another one begins each round, so that whatever else the machine does hits all alike.
            let which = (round + turn_of) % labs.len();
            turn(&mut labs[which].scene, 1.0);
            let frame = labs[which].draw(1, 0.0, true)?;
            if round > 0 {
                samples[which].0.push(frame.ms);
                samples[which].1.push(frame.iterate_ms());
            }
        }
    }
    let rows = cases.into_iter().zip(samples).map(|(case, (frames, iterations))| Row {
        case,
        frame_ms: Spread::of(&frames),
        iterate_ms: Spread::of(&iterations),
        frame_samples_ms: frames,
        iterate_samples_ms: iterations,
    });
    let timing = Timing { schema: SCHEMA, origin: press.origin(), rows: rows.collect() };
    press.json("timing.json", &timing)?;
    press.progress.step();
    Ok(timing)
}

fn lab<'a>(press: &'a Press<'a>, case: &Case) -> Result<Lab<'a>, Failure> {
    // Coloured as the paper's, so that both have three colours.
    let mut scene = built("cloud")?;
    if case.lights != scene.lights.len() || !case.sky {
        let other = white(case.lights, 0.0)?;
        (scene.lights, scene.sky) = (other.lights, other.sky);
    }
    let (options, sampling) = match case.setting {
        // Few random directions would make light grow; that they conserve energy takes no time.
        "paper" => {
            (Options { conserving: true, ..paper(press, case.directions) }, Sampling::Random { seed: 1 })
        }
        _ => {
            let options = Options::best(press.context.radiance_format());
            (Options { directions: case.directions, ..options }, Sampling::Even)
        }
    };
    lab::lab(press, &scene, &particles(&scene, case.particles, sampling)?, &options)
}

impl Timing {
    /// The row of a case that was timed.
    pub(super) fn row(&self, case: Case) -> &Row {
        self.rows.iter().find(|row| row.case == case).unwrap_or(&self.rows[0])
    }

    /// How the time of a step grows with particles and with directions: a line through logarithms.
    pub(super) fn growth(&self, setting: &'static str) -> [Option<Fit>; 2] {
        let of = |case: Case| self.row(case).iterate_ms.p50;
        let particles = PARTICLES.map(|n| (f64::from(n), of(Case::new(setting, n, 128))));
        let directions = DIRECTIONS.map(|d| (f64::from(d), of(Case::new(setting, 1024, d))));
        [Fit::power(&particles), Fit::power(&directions)]
    }

    pub(super) fn table(&self) -> String {
        let mut rows = vec![cells([
            "figure",
            "particles x directions",
            "paper fps",
            "our fps",
            "ours/paper",
            "frame ms p50/p95/max",
            "step ms",
            "default fps",
            "default/paper",
            "default step ms",
        ])];
        for (figure, particles, paper_fps) in PAPER {
            let [ours, default] = ["paper", "default"].map(|s| self.row(Case::new(s, particles, 128)));
            let [fps, default_fps] = [ours, default].map(|row| 1e3 / row.frame_ms.p50);
            let Spread { p50, p95, max } = ours.frame_ms;
            rows.push(vec![
                figure.into(),
                format!("{particles}x128"),
                digits(paper_fps),
                digits(fps),
                digits(fps / paper_fps),
                [p50, p95, max].map(digits).join(" / "),
                digits(ours.iterate_ms.p50),
                digits(default_fps),
                digits(default_fps / paper_fps),
                digits(default.iterate_ms.p50),
            ]);
        }
        format!(
            "Whole frames of `cloud`: both lights turn, direct light is found again, one step of the iteration in \
             three colours, splats; medians, all settings in turn. Ours: the paper's method; default: the best that we \
             know with as many particles and directions.\n\n{}",
            markdown::table(&rows)
        )
    }
}
