//! A cloud that moves: some directions are linked anew in every frame, and the picture lags behind by so much.

use std::sync::Arc;

use common::cloud::Grid;
use common::{Cloud, Density, Scene};
use glam::{DVec3, Quat, UVec3, Vec3};
use serde::Serialize;
use szk_network::{Particles, Sampling};

use super::super::plot::{Chart, Curve, Look, Numbers};
use super::super::{Origin, Picture, Press, cells};
use super::lab::{self, best, particles, relative};
use super::{SCHEMA, axis, built, draw};
use crate::failure::Failure;
use crate::record::Spread;
use crate::report::{digits, markdown, percent};

const PARTICLES: u32 = 1024;
/// Directions linked anew in a frame.
const RELINKED: [u32; 4] = [1, 4, 16, 128];
/// Frames, and which of them are held against a network of their own.
const FRAMES: u32 = 48;
const HELD: [u32; 5] = [6, 12, 24, 36, 48];
/// The middle turns by this much in a frame \[degrees\].
const TURN: f32 = 2.0;
/// Voxels each way.
const CELLS: u32 = 40;

/// Steps of progress: the networks of their own, each number of directions.
pub(super) const STEPS: u64 = 1 + RELINKED.len() as u64;

#[derive(Debug, Serialize)]
struct Animated {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    curves: Vec<Lag>,
}

#[derive(Debug, Serialize)]
struct Lag {
    relinked: u32,
    frame_ms: Spread,
    points: Vec<Point>,
}

/// Relative RMSE against a network that was made and solved for this very frame.
#[derive(Debug, Serialize)]
struct Point {
    frame: u32,
    rel_rmse: f64,
}

/// Measures, draws and writes; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    press.progress.doing("a cloud that moves: networks of their own");
    let mut scene = built("sphere")?;
    if let Some(cloud) = &mut scene.cloud {
        *cloud = Cloud { density: Density::Grid(Arc::new(balls(0.0))), ..cloud.clone() };
    }
    let first = particles(&scene, PARTICLES, Sampling::Even)?;
    let mut wanted = Vec::new();
    for frame in HELD {
        let mut lab = lab::lab(press, &scene, &swirled(&first, frame), &best(press, 128))?;
        wanted.push(lab.settle()?.image);
    }
    press.progress.step();
    let mut curves = Vec::new();
    let mut rows = Vec::new();
    for relinked in RELINKED {
        press.progress.doing(&format!("a cloud that moves: {relinked} directions a frame"));
        let (lag, image) = lag(press, &scene, &first, relinked, &wanted)?;
        curves.push(lag);
        rows.push(image);
        press.progress.step();
    }
    let last = wanted.pop().unwrap_or_else(|| common::image::Image::black(1, 1));
    let exposure = last.auto_exposure();
    let pictures = [0, 1, 2, 3, 4].map(|i| Picture::of(rows.get(i).unwrap_or(&last), exposure));
    press.picture("animated.png", Picture::grid(&[pictures]))?;
    draw(press, "animated.svg", &chart(&curves))?;
    let animated = Animated { schema: SCHEMA, origin: press.origin(), curves };
    press.json("animated.json", &animated)?;
    Ok(text(&animated.curves))
}

fn lag(
    press: &Press<'_>,
    scene: &Scene,
    first: &Particles,
    relinked: u32,
    wanted: &[common::image::Image],
) -> Result<(Lag, common::image::Image), Failure> {
    let mut lab = lab::lab(press, scene, first, &best(press, 128))?;
    let mut image = lab.settle()?.image;
    let (mut points, mut times) = (Vec::new(), Vec::new());
    for frame in 1..=FRAMES {
        lab.update(&swirled(first, frame), relinked)?;
        let drawn = lab.draw(1, 0.0, true)?;
        times.push(drawn.ms);
        if let Some(at) = HELD.iter().position(|held| *held == frame) {
            points.push(Point { frame, rel_rmse: relative(&drawn.image, &wanted[at])? });
        }
        image = drawn.image;
    }
    Ok((Lag { relinked, frame_ms: Spread::of(&times), points }, image))
}

/// Turns a place about the line of sight, the outside by half as much as the middle. It leaves volumes as they are.
fn swirl(at: Vec3, frame: f32) -> Vec3 {
    let angle = frame * TURN * (1.0 - 0.5 * at.length_squared().min(1.0));
    Quat::from_rotation_z(angle.to_radians()) * at
}

/// Two balls beside each other, after so many frames of the swirl.
fn balls(frame: f32) -> Grid {
    let inside = |at: Vec3| {
        let at = swirl(at, -frame);
        let centre = Vec3::new(0.5f32.copysign(at.x), 0.0, 0.0);
        if at.distance(centre) < 0.45 { 1.0 } else { 0.0 }
    };
    let side = 2.0 / CELLS as f32;
    let cells = UVec3::splat(CELLS);
    let mut values = Vec::with_capacity((CELLS as usize).pow(3));
    for (z, y, x) in (0..CELLS).flat_map(|z| (0..CELLS).flat_map(move |y| (0..CELLS).map(move |x| (z, y, x))))
    {
        // Edges are as smooth as cells are wide.
        let corner =
            |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)).as_vec3();
        let of = |i| inside((UVec3::new(x, y, z).as_vec3() + 0.25 + 0.5 * corner(i)) * side - 1.0);
        values.push((0..8).map(of).sum::<f32>() / 8.0);
    }
    Grid { cells, low: Vec3::NEG_ONE, high: Vec3::ONE, values }
}

fn swirled(first: &Particles, frame: u32) -> Particles {
    let frame = frame as f32;
    let mut particles = Particles { density: Arc::new(balls(frame)), ..first.clone() };
    particles.list.iter_mut().for_each(|particle| particle.position = swirl(particle.position, frame));
    particles
}

fn chart(curves: &[Lag]) -> Chart {
    let curves = curves.iter().enumerate().map(|(colour, lag)| Curve {
        label: format!("{} linked anew a frame", lag.relinked),
        points: lag.points.iter().map(|point| (f64::from(point.frame), point.rel_rmse)).collect(),
        look: Look::Both,
        colour,
    });
    Chart {
        axes: [
            axis("frame", false, Numbers::Plain),
            axis("relative RMSE against a new network", false, Numbers::Percent),
        ],
        curves: curves.collect(),
    }
}

fn text(curves: &[Lag]) -> String {
    let mut rows =
        vec![cells(["directions linked anew a frame", "frame ms", "lag after 12 frames", "after 48"])];
    for Lag { relinked, frame_ms, points } in curves {
        let at = |frame: u32| {
            points
                .iter()
                .find(|point| point.frame == frame)
                .map_or("–".into(), |point| percent(point.rel_rmse))
        };
        rows.push(vec![relinked.to_string(), digits(frame_ms.p50), at(12), at(48)]);
    }
    format!(
        "![the last frame](animated.png)\n\n![lag](animated.svg)\n\nTwo balls swirl about each other, {TURN}° a frame \
         in the middle; {PARTICLES} particles, 128 directions, one step a frame. Above the last frame with {} directions \
         linked anew in each, and by a network made for it; below the relative RMSE against networks made and solved \
         for their frames. With all 128 what is left is the lag of the iteration.\n\n{}",
        RELINKED.map(|n| n.to_string()).join(", "),
        markdown::table(&rows)
    )
}
