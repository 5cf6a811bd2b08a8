//! Random directions against even ones, and direct light that comes in by the nearest of them.

use glam::{Quat, Vec3};
use serde::Serialize;
use szk_network::{DirectionSet, Incidence, Options, Sampling};

use super::super::plot::{Chart, Curve, Look, Numbers};
use super::super::{Origin, Press, cells};
use super::lab::{self, Lab, best, particles, relative};
use super::{SCHEMA, axis, built, draw, sphere};
use crate::failure::Failure;
use crate::report::{digits, markdown, percent};
use common::{Light, Scene};

/// Steps of progress: each number of directions, both incidences.
pub(super) const STEPS: u64 = NUMBERS.len() as u64 + 2;

const PARTICLES: u32 = 1024;
const NUMBERS: [u32; 5] = [16, 32, 64, 128, 256];
const SEEDS: u64 = 3;
/// What all are held against.
const MOST: u32 = 512;

/// Frames of a light that turns by so much in each \[degrees\].
const FRAMES: u32 = 40;
const TURN: f32 = 0.1;
/// Mean cosine of their scattering.
const G: f64 = 0.5;

#[derive(Debug, Serialize)]
struct Directions {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    sets: Vec<Set>,
    popping: Vec<Popping>,
}

/// So many directions: relative RMSE of the picture against 512 even ones.
#[derive(Debug, Serialize)]
struct Set {
    directions: u32,
    even: f64,
    /// Of each seed.
    random: Vec<f64>,
}

/// Change of the picture from frame to frame, relative RMS.
#[derive(Debug, Serialize)]
struct Popping {
    incidence: String,
    changes: Vec<f64>,
    largest: f64,
    median: f64,
}

/// Measures, draws and writes; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let scene = built("sphere")?;
    let particles = particles(&scene, PARTICLES, Sampling::Even)?;
    let settled = |options: &Options| -> Result<common::image::Image, Failure> {
        Ok(lab::lab(press, &scene, &particles, options)?.settle()?.image)
    };
    let finest = settled(&best(press, MOST))?;
    let mut sets = Vec::new();
    for directions in NUMBERS {
        press.progress.doing(&format!("{directions} directions"));
        let options = best(press, directions);
        let error = |direction_set| relative(&settled(&Options { direction_set, ..options })?, &finest);
        let random =
            (1..=SEEDS).map(|seed| error(DirectionSet::Random { seed })).collect::<Result<_, _>>()?;
        sets.push(Set { directions, even: error(DirectionSet::Fibonacci)?, random });
        press.progress.step();
    }
    // Where light goes on as it came, it matters where it is taken to come from.
    let scene = sphere(G)?;
    let particles = super::lab::particles(&scene, PARTICLES, Sampling::Even)?;
    let mut popping = Vec::new();
    for incidence in [Incidence::Nearest, Incidence::Exact] {
        press.progress.doing(&format!("a light that turns: {incidence:?}"));
        let options = Options { incidence, ..best(press, 128) };
        let mut lab = lab::lab(press, &scene, &particles, &options)?;
        popping.push(pop(&mut lab, incidence)?);
        press.progress.step();
    }
    draw(press, "directions.svg", &chart_of_sets(&sets))?;
    draw(press, "popping.svg", &chart_of_popping(&popping))?;
    let directions = Directions { schema: SCHEMA, origin: press.origin(), sets, popping };
    press.json("directions.json", &directions)?;
    Ok(text(&directions))
}

/// Turns the light past the middle between two directions, one step in every frame.
fn pop(lab: &mut Lab<'_>, incidence: Incidence) -> Result<Popping, Failure> {
    let directions: Vec<Vec3> =
        lab.renderer.plan().map_or_else(Vec::new, |plan| plan.windows.iter().map(|w| w.direction).collect());
    let still = lab.scene.clone();
    let from = change_of_nearest(&still, &directions) - 0.5 * TURN * FRAMES as f32;
    set(&mut lab.scene, &still, from);
    let mut last = lab.settle()?.image;
    let mut changes = Vec::new();
    for frame in 1..=FRAMES {
        set(&mut lab.scene, &still, from + TURN * frame as f32);
        let image = lab.draw(1, 0.0, true)?.image;
        changes.push(relative(&image, &last)?);
        last = image;
    }
    let largest = changes.iter().copied().fold(0.0, f64::max);
    let median = crate::record::Spread::of(&changes).p50;
    Ok(Popping { incidence: format!("{incidence:?}"), changes, largest, median })
}

/// The light as it is in `still`, turned about the vertical.
fn set(scene: &mut Scene, still: &Scene, degrees: f32) {
    scene.lights = still.lights.clone();
    super::turn(scene, degrees);
}

/// Angle that the first light turns by until another direction is its nearest \[degrees\].
fn change_of_nearest(scene: &Scene, directions: &[Vec3]) -> f32 {
    let Some(Light::Directional(light)) = scene.lights.first() else { return 0.0 };
    let nearest = |degrees: f32| {
        let way = Quat::from_rotation_y(degrees.to_radians()) * light.direction;
        let at = |(_, direction): &(usize, &Vec3)| direction.dot(way);
        directions.iter().enumerate().max_by(|a, b| at(a).total_cmp(&at(b))).map(|(index, _)| index)
    };
    let first = nearest(0.0);
    (0..3600).map(|step| step as f32 * TURN).find(|degrees| nearest(*degrees) != first).unwrap_or(0.0)
}

fn chart_of_sets(sets: &[Set]) -> Chart {
    let x = |set: &Set| f64::from(set.directions);
    let random = sets.iter().flat_map(|set| set.random.iter().map(move |error| (x(set), *error)));
    Chart {
        axes: [
            axis("directions", true, Numbers::Plain),
            axis("relative RMSE against 512 even ones", true, Numbers::Percent),
        ],
        curves: vec![
            Curve {
                label: "even (Fibonacci)".into(),
                points: sets.iter().map(|set| (x(set), set.even)).collect(),
                look: Look::Both,
                colour: 0,
            },
            Curve {
                label: format!("random, {SEEDS} seeds"),
                points: random.collect(),
                look: Look::Dots,
                colour: 1,
            },
        ],
    }
}

fn chart_of_popping(popping: &[Popping]) -> Chart {
    let curves = popping.iter().enumerate().map(|(colour, popping)| Curve {
        label: format!("{} direction", popping.incidence.to_lowercase()),
        points: (1..=FRAMES).map(f64::from).zip(popping.changes.iter().copied()).collect(),
        look: Look::Both,
        colour,
    });
    Chart {
        axes: [
            axis("frame; the light turns by 0.1° in each", false, Numbers::Plain),
            axis("change of the picture, relative RMS", true, Numbers::Percent),
        ],
        curves: curves.collect(),
    }
}

fn text(directions: &Directions) -> String {
    let mut rows = vec![cells(["directions", "even", "random, each seed", "random, worst/even"])];
    for Set { directions, even, random } in &directions.sets {
        let worst = random.iter().copied().fold(0.0, f64::max);
        let each: Vec<String> = random.iter().map(|error| percent(*error)).collect();
        rows.push(vec![directions.to_string(), percent(*even), each.join(", "), digits(worst / even)]);
    }
    let mut popping = vec![cells(["light comes in by", "largest change", "median change"])];
    for Popping { incidence, largest, median, .. } in &directions.popping {
        let what = if incidence == "Exact" { "its own direction" } else { "the nearest direction" };
        popping.push(vec![what.into(), percent(*largest), percent(*median)]);
    }
    format!(
        "![directions](directions.svg)\n\n`sphere`, {PARTICLES} particles, default but for the directions: relative \
         RMSE of the picture against that of {MOST} even directions.\n\n{}\n![popping](popping.svg)\n\nThe light turns \
         past the middle between two of 128 directions, in `sphere` with g = {G}, one step a frame: change of the picture from frame to frame, \
         relative RMS.\n\n{}",
        markdown::table(&rows),
        markdown::table(&popping)
    )
}
