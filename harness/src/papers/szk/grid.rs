//! Figure 7: pictures, times and errors over the numbers of particles and directions.

use serde::Serialize;
use szk_network::Sampling;

use super::super::plot::{Chart, Curve, Look, Numbers};
use super::super::{Origin, Picture, Press, cells};
use super::lab::{self, Off, best, particles};
use super::{SCHEMA, axis, draw, white};
use crate::failure::Failure;
use crate::fit::Fit;
use crate::record::Spread;
use crate::report::{digits, markdown, percent};

pub(super) const PARTICLES: [u32; 4] = [128, 512, 1024, 4096];
pub(super) const DIRECTIONS: [u32; 3] = [32, 128, 512];

/// Steps of progress: paths, and each number of particles.
pub(super) const STEPS: u64 = 1 + PARTICLES.len() as u64;

/// Frames that are timed.
const FRAMES: usize = 3;

#[derive(Debug, Serialize)]
pub(super) struct Grid {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    paths_noise: f64,
    cells: Vec<Cell>,
    /// Error ∝ N^slope with 128 directions, and ∝ D^slope with 4096 particles.
    by_particles: Option<Fit>,
    by_directions: Option<Fit>,
}

/// One setting.
#[derive(Debug, Serialize)]
pub(super) struct Cell {
    particles: u32,
    directions: u32,
    window: u32,
    /// Frames with one step, direct light found again \[ms\].
    frame_ms: Spread,
    steps_to_residual: f64,
    #[serde(flatten)]
    off: Off,
}

impl Grid {
    /// Relative RMSE of one setting.
    pub(super) fn error(&self, particles: u32, directions: u32) -> f64 {
        let cell = self.cells.iter().find(|c| (c.particles, c.directions) == (particles, directions));
        cell.map_or(f64::NAN, |cell| cell.off.rel_rmse)
    }
}

/// Measures, draws and writes; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<(Grid, String), Failure> {
    press.progress.doing("figure 7: paths");
    let scene = white(1, 0.0)?;
    let truth = lab::truth(press, &scene)?;
    let exposure = truth.image().auto_exposure();
    press.progress.step();
    let mut found = Vec::new();
    let mut columns = Vec::new();
    for count in PARTICLES {
        press.progress.doing(&format!("figure 7: {count} particles"));
        let particles = particles(&scene, count, Sampling::Even)?;
        let mut pictures = Vec::new();
        for directions in DIRECTIONS {
            let mut lab = lab::lab(press, &scene, &particles, &best(press, directions))?;
            let settled = lab.settle()?;
            let mut times = Vec::new();
            for _ in 0..press.frames.at_most(FRAMES) {
                times.push(lab.draw(1, 0.0, true)?.ms);
            }
            pictures.push(Picture::of(&settled.image, exposure));
            found.push(Cell {
                particles: count,
                directions,
                window: lab.renderer.plan().map_or(0, |plan| plan.pixels),
                frame_ms: Spread::of(&times),
                steps_to_residual: settled.steps,
                off: truth.off(&settled.image)?,
            });
        }
        columns.push(pictures);
        press.progress.step();
    }
    // Directions from row to row, particles from column to column, paths at the end of the first row.
    let mut columns: Vec<_> = columns.into_iter().map(Vec::into_iter).collect();
    let mut paths = Some(Picture::of(truth.image(), exposure));
    let blank = || Picture::white(press.timed_size.0, press.timed_size.1);
    let rows = DIRECTIONS.map(|_| {
        [0, 1, 2, 3, 4].map(|column| {
            let cell = columns.get_mut(column).map_or_else(|| paths.take(), Iterator::next);
            cell.unwrap_or_else(blank)
        })
    });
    press.picture("figure-7.png", Picture::grid(&rows))?;
    let grid = fitted(found, truth.noise, press.origin());
    press.json("grid.json", &grid)?;
    draw(press, "grid.svg", &chart(&grid))?;
    let text = text(&grid);
    Ok((grid, text))
}

fn fitted(cells: Vec<Cell>, paths_noise: f64, origin: Origin) -> Grid {
    let mut grid =
        Grid { schema: SCHEMA, origin, paths_noise, cells, by_particles: None, by_directions: None };
    let by = |grid: &Grid, all: &[u32], of: fn(u32) -> (u32, u32)| {
        let point = |x: &u32| (f64::from(*x), grid.error(of(*x).0, of(*x).1));
        Fit::power(&all.iter().map(point).collect::<Vec<_>>())
    };
    grid.by_particles = by(&grid, &PARTICLES, |n| (n, 128));
    grid.by_directions = by(&grid, &DIRECTIONS, |d| (4096, d));
    grid
}

fn chart(grid: &Grid) -> Chart {
    let curves = DIRECTIONS.iter().enumerate().map(|(colour, directions)| Curve {
        label: format!("{directions} directions"),
        points: PARTICLES.map(|n| (f64::from(n), grid.error(n, *directions))).to_vec(),
        look: Look::Both,
        colour,
    });
    Chart {
        axes: [
            axis("particles", true, Numbers::Plain),
            axis("relative RMSE against paths", true, Numbers::Percent),
        ],
        curves: curves.collect(),
    }
}

fn text(grid: &Grid) -> String {
    let mut rows =
        vec![cells(["particles", "directions", "window", "frame ms", "steps to 1e-3", "rel. RMSE", "bias"])];
    for cell in &grid.cells {
        rows.push(vec![
            cell.particles.to_string(),
            cell.directions.to_string(),
            format!("{0}x{0}", cell.window),
            digits(cell.frame_ms.p50),
            digits(cell.steps_to_residual),
            percent(cell.off.rel_rmse),
            super::super::verdict::signed(cell.off.bias),
        ]);
    }
    let slope = |fit: Option<Fit>| {
        fit.map_or("no line".into(), |fit| format!("{:+.2} (R² {:.2})", fit.slope, fit.r2))
    };
    format!(
        "![particles and directions](figure-7.png)\n\nOne white light from the upper right, default. From left to \
         right {} particles, and paths; from above {} directions.\n\n![errors](grid.svg)\n\nAgainst paths, whose own \
         noise ({}) is taken out. Slope of the error over the particles (128 directions) {}, over the directions (4096 \
         particles) {}. Frames: one step in one colour, direct light found again.\n\n{}",
        PARTICLES.map(|n| n.to_string()).join(", "),
        DIRECTIONS.map(|n| n.to_string()).join(", "),
        percent(grid.paths_noise),
        slope(grid.by_particles),
        slope(grid.by_directions),
        markdown::table(&rows)
    )
}
