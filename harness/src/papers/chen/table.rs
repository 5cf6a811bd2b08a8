//! Table 1: frames per second by planes, lattice and sizes of maps; and the errors, which the paper does not give.

use chen_planes::Options;
use common::Scene;
use common::scene::builtin::{HALL_TRIANGLES, WINDOW_TRIANGLES, hall_with_map, window_with_map};
use serde::Serialize;

use super::super::{Origin, Press, cells};
use super::{SIZE, best, errors, heading, paper, planes_ms, shadow_maps_ms, technique, truth};
use crate::failure::Failure;
use crate::measure::{Drawn, Stage, Times, Turn, motion, times_in_turn};
use crate::record::Spread;
use crate::report::{digits, markdown, percent};

/// Version of `table-1.json`, described in results/README.md.
const SCHEMA: u32 = 1;

/// Steps of progress: errors of each row, and the times.
pub(super) const STEPS: u64 = ROWS.len() as u64 + 1;

/// Rounds of all rows in both settings go on for so long on a software adapter \[s\].
const BUDGET: f64 = 24.0;

/// What the paper measured.
pub(super) struct PaperRow {
    pub figure: &'static str,
    pub planes: u32,
    /// Lattice points each way.
    pub points: u32,
    pub shadow_map: u32,
    pub light_map: u32,
    pub fps: f64,
    pub hall: bool,
}

const fn row(figure: &'static str, [planes, points, shadow_map, light_map]: [u32; 4], fps: f64) -> PaperRow {
    PaperRow { figure, planes, points, shadow_map, light_map, fps, hall: false }
}

/// Table 1.
pub(super) const ROWS: [PaperRow; 7] = [
    row("4(a)", [50, 32, 256, 64], 30.0),
    row("4(b)", [50, 64, 256, 64], 26.0),
    row("4(c)", [50, 64, 512, 64], 24.0),
    row("4(d)", [50, 64, 512, 256], 22.0),
    row("4(e)", [100, 32, 256, 64], 16.0),
    row("4(f)", [100, 96, 512, 128], 10.0),
    PaperRow { hall: true, ..row("5(a-d)", [100, 96, 512, 128], 9.0) },
];

impl PaperRow {
    pub(super) fn scene(&self) -> Scene {
        if self.hall {
            hall_with_map(HALL_TRIANGLES, self.light_map)
        } else {
            window_with_map(WINDOW_TRIANGLES, self.light_map)
        }
    }

    pub(super) fn options(&self) -> Options {
        paper(self.planes, self.points)
    }
}

#[derive(Debug, Serialize)]
struct Table {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    rows: Vec<Row>,
}

/// One row of the paper's, by its method and by ours.
#[derive(Debug, Serialize)]
struct Row {
    figure: &'static str,
    scene: String,
    triangles: usize,
    planes: u32,
    lattice: [u32; 2],
    shadow_map_size: u32,
    light_map_size: u32,
    moving: String,
    warm_up: usize,
    paper_fps: f64,
    paper: Measured,
    default: Measured,
}

/// Whole frames, and the error at time 0.
#[derive(Debug, Serialize)]
struct Measured {
    frames: usize,
    fps: f64,
    /// Over the paper's.
    fps_ratio: f64,
    frame_ms: Spread,
    planes_ms: Spread,
    /// Null without timestamps.
    shadow_maps_ms: Option<Spread>,
    rel_rmse: f64,
    bias: f64,
    samples_ms: Vec<f64>,
}

impl Measured {
    fn of(times: &Times, paper_fps: f64, error: &common::metrics::Errors) -> Self {
        let frame_ms = Spread::of(&times.frame);
        let fps = 1e3 / frame_ms.p50;
        Self {
            frames: times.frame.len(),
            fps,
            fps_ratio: fps / paper_fps,
            frame_ms,
            planes_ms: planes_ms(times),
            shadow_maps_ms: shadow_maps_ms(times),
            rel_rmse: error.rel_rmse,
            bias: error.bias,
            samples_ms: times.frame.clone(),
        }
    }
}

/// Measures and writes; gives the table as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let size = press.timed_size;
    let scenes: Vec<Scene> = ROWS.iter().map(PaperRow::scene).collect();
    let mut stages = Vec::new();
    let mut turns = Vec::new();
    let mut found = Vec::new();
    for (index, (row, scene)) in ROWS.iter().zip(&scenes).enumerate() {
        crate::interrupt::check()?;
        press.progress.doing(&format!("table 1: errors of {}", row.figure));
        let truth = truth(press, scene)?;
        let mut stage = Stage::new(press.context, scene, size, row.shadow_map)?;
        for options in [row.options(), best()] {
            let mut technique = technique(press, options, size)?;
            let image = stage.picture(Some(technique.as_mut()), 0.0, Drawn::Airlight)?;
            found.push(errors(&image, &truth)?);
            turns.push(Turn { stage: index, technique });
        }
        stages.push(stage);
        press.progress.step();
    }
    press.progress.doing("table 1: times");
    let times = times_in_turn(&mut stages, &mut turns, &press.frames.within(BUDGET))?;
    press.progress.step();

    let measured = |index: usize, fps: f64| Measured::of(&times[index], fps, &found[index]);
    let rows = ROWS.iter().zip(&scenes).enumerate().map(|(index, (row, scene))| Row {
        figure: row.figure,
        scene: scene.name.clone(),
        triangles: scene.triangle_count(),
        planes: row.planes,
        lattice: [row.points; 2],
        shadow_map_size: row.shadow_map,
        light_map_size: row.light_map,
        moving: motion(scene).into(),
        warm_up: press.frames.warm_up,
        paper_fps: row.fps,
        paper: measured(2 * index, row.fps),
        default: measured(2 * index + 1, row.fps),
    });
    let table = Table { schema: SCHEMA, origin: press.origin(), rows: rows.collect() };
    press.json("table-1.json", &table)?;
    let text = markdown(&table.rows, size);
    press.text("table-1.md", &format!("# Table 1\n\n{}\n{text}", heading(press)))?;
    Ok(text)
}

fn markdown(rows: &[Row], (width, height): (u32, u32)) -> String {
    let mut fps = vec![cells([
        "figure",
        "scene",
        "planes",
        "lattice",
        "depth map",
        "light map",
        "paper fps",
        "our fps",
        "ours/paper",
        "our error",
        "default fps",
        "default error",
    ])];
    let mut frames = vec![cells([
        "figure",
        "frames",
        "frame ms p50/p95/max",
        "planes ms p50",
        "shadow map ms p50",
        "default: frame ms p50/p95/max",
        "planes ms p50",
    ])];
    for row in rows {
        let Row { paper, default, .. } = row;
        fps.push(vec![
            row.figure.into(),
            row.scene.clone(),
            row.planes.to_string(),
            row.lattice.map(|points| points.to_string()).join("x"),
            row.shadow_map_size.to_string(),
            row.light_map_size.to_string(),
            digits(row.paper_fps),
            digits(paper.fps),
            digits(paper.fps_ratio),
            percent(paper.rel_rmse),
            digits(default.fps),
            percent(default.rel_rmse),
        ]);
        let spread = |Spread { p50, p95, max }: Spread| [p50, p95, max].map(digits).join(" / ");
        frames.push(vec![
            row.figure.into(),
            paper.frames.to_string(),
            spread(paper.frame_ms),
            digits(paper.planes_ms.p50),
            paper.shadow_maps_ms.map_or("–".into(), |ms| digits(ms.p50)),
            spread(default.frame_ms),
            digits(default.planes_ms.p50),
        ]);
    }
    let smaller = f64::from(SIZE.0 * SIZE.1) / f64::from(width * height);
    let pixels = if smaller > 1.0 {
        format!(" Our frames have {} times fewer pixels.", digits(smaller))
    } else {
        String::new()
    };
    format!(
        "Frames per second of whole frames (shadow map, depth, lit surfaces, planes), everything moving, medians; all \
         rows in both settings in turn. Ours: the paper's method with the row's planes, lattice and maps; default: \
         the best that we know on the same maps. Error: relative RMSE of the airlight at time 0 against the CPU \
         reference with that light map; the paper has none.{pixels}\n\n{}\n{}",
        markdown::table(&fps),
        markdown::table(&frames)
    )
}
