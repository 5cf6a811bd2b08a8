//! Figure 6: how a solution is found step by step, from dark and from that of another light.

use common::Scene;
use common::image::Image;
use serde::Serialize;
use szk_network::{Colours, Options, Particles, Sampling, Scattering};

use super::super::plot::{Chart, Curve, Look, Numbers};
use super::super::{Origin, Picture, Press, cells};
use super::lab::{self, Frame, Lab, Truth, best, paper, particles, relative};
use super::{SCHEMA, axis, draw, turn, white};
use crate::failure::Failure;
use crate::report::{digits, markdown, percent};

/// Steps of progress: paths, two settings, two turns.
pub(super) const STEPS: u64 = 5;

const PARTICLES: u32 = 1024;
/// Steps that are shown.
const SHOWN: [u32; 8] = [1, 2, 4, 8, 16, 32, 64, 128];
/// After so many steps all are measured one by one no longer.
const SINGLE: u32 = 24;
/// Where a solution is as good as it gets.
const FOUND: f32 = 1e-4;
const MOST: u32 = 400;
/// Steps after those of the figure, to its end.
const MORE: u32 = 128;
/// What is less is left out of the chart.
const LEAST: f64 = 1e-4;

#[derive(Debug, Serialize)]
pub(super) struct Convergence {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    /// Standard error of the paths, relative RMS.
    paths_noise: f64,
    pub curves: Vec<Steps>,
    pub turned: Vec<Turned>,
}

/// One setting, from dark.
#[derive(Debug, Serialize)]
pub(super) struct Steps {
    pub setting: &'static str,
    points: Vec<Point>,
    /// Steps until the picture is so near to the one that is found in the end.
    pub to_5_percent: Option<u32>,
    pub to_1_percent: Option<u32>,
}

#[derive(Debug, Serialize)]
struct Point {
    steps: u32,
    residual: f64,
    /// Relative RMSE against the picture that is found in the end.
    to_converged: f64,
    /// Relative RMSE against paths, their noise taken out.
    to_paths: f64,
}

/// After all lights were turned: steps until the picture is within 5 % of the new one.
#[derive(Debug, Serialize)]
pub(super) struct Turned {
    pub degrees: f32,
    pub from_old: u32,
    pub from_dark: u32,
    /// How far the old picture is from the new one.
    pub change: f64,
}

/// Measures, draws and writes; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<(Convergence, String), Failure> {
    press.progress.doing("figure 6: paths");
    let scene = white(2, 0.0)?;
    let truth = lab::truth(press, &scene)?;
    press.progress.step();
    // With g = 0 a few components are all of the matrix: the same in less time.
    let scattering = Scattering::LowRank { bound: 1e-6 };
    let grey = |options| Options { colours: Colours::Grey, scattering, ..options };
    let settings = [
        ("default", best(press, 128), Sampling::Even),
        ("paper", grey(paper(press, 128)), Sampling::Random { seed: 1 }),
    ];
    let (mut curves, mut rows) = (Vec::new(), Vec::new());
    let mut exposure = None;
    for (setting, options, sampling) in settings {
        press.progress.doing(&format!("figure 6: {setting}"));
        let particles = particles(&scene, PARTICLES, sampling)?;
        let (curve, images) = steps(press, &scene, &particles, (setting, options), &truth)?;
        let exposure = *exposure.get_or_insert(truth.image().auto_exposure());
        let pictures: Vec<Picture> = images.iter().map(|image| Picture::of(image, exposure)).collect();
        let mut pictures = pictures.into_iter();
        rows.extend(
            [(); 2].map(|()| [(); 4].map(|()| pictures.next().unwrap_or_else(|| Picture::white(1, 1)))),
        );
        curves.push(curve);
        press.progress.step();
    }
    press.picture("figure-6.png", Picture::grid(&rows[..2]))?;
    press.picture("figure-6-paper.png", Picture::grid(&rows[2..]))?;
    let mut turned = Vec::new();
    for degrees in [10.0, 90.0] {
        press.progress.doing(&format!("figure 6: lights turned by {degrees}°"));
        turned.push(after_a_turn(press, &scene, degrees)?);
        press.progress.step();
    }
    let convergence =
        Convergence { schema: SCHEMA, origin: press.origin(), paths_noise: truth.noise, curves, turned };
    press.json("convergence.json", &convergence)?;
    draw(press, "convergence.svg", &chart(&convergence.curves))?;
    let text = text(&convergence);
    Ok((convergence, text))
}

/// Step by step from dark; gives the pictures that are shown.
fn steps(
    press: &Press<'_>,
    scene: &Scene,
    particles: &Particles,
    (setting, options): (&'static str, Options),
    truth: &Truth,
) -> Result<(Steps, Vec<Image>), Failure> {
    let mut lab = lab::lab(press, scene, particles, &options)?;
    let (mut frames, mut images): (Vec<(u32, Frame)>, _) = (Vec::new(), Vec::new());
    let mut done = 0;
    for to in (1..=SINGLE).chain([32, 48, 64, 96, 128]) {
        let frame = lab.draw(to - done, 0.0, done == 0)?;
        done = to;
        if SHOWN.contains(&to) {
            images.push(frame.image.clone());
        }
        frames.push((to, frame));
    }
    let found = lab.draw(MORE, 0.0, false)?.image;
    let mut points = Vec::new();
    for (steps, frame) in frames {
        points.push(Point {
            steps,
            residual: frame.residual,
            to_converged: relative(&frame.image, &found)?,
            to_paths: truth.off(&frame.image)?.rel_rmse,
        });
    }
    let first = |bound| points.iter().find(|point| point.to_converged < bound).map(|point| point.steps);
    let (to_5_percent, to_1_percent) = (first(0.05), first(0.01));
    Ok((Steps { setting, points, to_5_percent, to_1_percent }, images))
}

fn after_a_turn(press: &Press<'_>, scene: &Scene, degrees: f32) -> Result<Turned, Failure> {
    let particles = particles(scene, PARTICLES, Sampling::Even)?;
    let mut turned = scene.clone();
    turn(&mut turned, degrees);
    let mut lab = lab::lab(press, &turned, &particles, &best(press, 128))?;
    let found = lab.draw(MOST, FOUND, true)?.image;
    let steps = |mut lab: Lab<'_>| -> Result<u32, Failure> {
        lab.scene = turned.clone();
        for step in 1..=SINGLE * 4 {
            if relative(&lab.draw(1, 0.0, step == 1)?.image, &found)? < 0.05 {
                return Ok(step);
            }
        }
        Ok(MOST)
    };
    let mut old = lab::lab(press, scene, &particles, &best(press, 128))?;
    let change = relative(&old.draw(MOST, FOUND, true)?.image, &found)?;
    let from_old = steps(old)?;
    let from_dark = steps(lab::lab(press, scene, &particles, &best(press, 128))?)?;
    Ok(Turned { degrees, from_old, from_dark, change })
}

fn chart(curves: &[Steps]) -> Chart {
    let mut drawn = Vec::new();
    for (index, steps) in curves.iter().enumerate() {
        let colour = 3 * index;
        let mut curve = |label: &str, look, colour, value: fn(&Point) -> f64| {
            // The residual shows nothing of new sources in their first step.
            let points = steps.points.iter().map(|point| (f64::from(point.steps), value(point)));
            drawn.push(Curve {
                label: format!("{label}, {}", steps.setting),
                points: points.filter(|point| point.1 > LEAST).collect(),
                look,
                colour,
            });
        };
        curve("residual", Look::Line, colour, |point| point.residual);
        curve("to the end", Look::Both, colour + 1, |point| point.to_converged);
        curve("to paths", Look::Both, colour + 2, |point| point.to_paths);
    }
    Chart {
        axes: [
            axis("steps from dark", true, Numbers::Plain),
            axis("residual, relative RMSE", true, Numbers::Percent),
        ],
        curves: drawn,
    }
}

fn text(convergence: &Convergence) -> String {
    let mut rows = vec![cells(["setting", "steps to 5 %", "steps to 1 %", "against paths in the end"])];
    let steps = |steps: Option<u32>| steps.map_or("more than 128".into(), |steps| steps.to_string());
    for Steps { setting, points, to_5_percent, to_1_percent } in &convergence.curves {
        let end = points.last().map_or(f64::NAN, |point| point.to_paths);
        rows.push(vec![(*setting).into(), steps(*to_5_percent), steps(*to_1_percent), percent(end)]);
    }
    let mut turned = vec![cells([
        "lights turned by",
        "the picture changes by",
        "steps from the old solution",
        "steps from dark",
    ])];
    for Turned { degrees, from_old, from_dark, change } in &convergence.turned {
        turned.push(vec![
            format!("{}°", digits((*degrees).into())),
            percent(*change),
            from_old.to_string(),
            from_dark.to_string(),
        ]);
    }
    format!(
        "![step by step](figure-6.png)\n\nTwo white lights, {PARTICLES} particles, 128 directions, after {} steps from \
         dark, default.\n\n![step by step, paper](figure-6-paper.png)\n\nThe same by the paper's \
         method.\n\n![convergence](convergence.svg)\n\nRelative RMSE of the picture against the one after \
         {MORE} steps more, and against paths, whose own noise ({}) is taken out: two \
         pictures by independent paths are compared with, and the noise cancels from the product of both \
         errors.\n\n{}\nSteps until the picture is within 5 % of the new one after all lights were turned, \
         default:\n\n{}",
        SHOWN.map(|steps| steps.to_string()).join(", "),
        percent(convergence.paths_noise),
        markdown::table(&rows),
        markdown::table(&turned)
    )
}
