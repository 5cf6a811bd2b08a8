//! `harness papers`: the tables and figures of a paper, made again by its method and by the best we know.

mod billeter;
mod biri;
mod chen;
mod claims;
mod plot;
mod szk;
mod verdict;

use std::path::{Path, PathBuf};

use common::gpu::Context;
use common::image::Image;
use serde::Serialize;

use clap::ValueEnum;

use crate::cli::{self, Ground, Paper, Papers};
use crate::cmd::{cause, open};
use crate::failure::Failure;
use crate::machine::{self, Machine};
use crate::measure::{Frames, check_size};
use crate::output::{check_replaceable, make_writable, write_text};
use crate::progress::Progress;

/// Part of either side that frames are timed at on a software adapter.
const SOFTWARE_SHARE: u32 = 4;

/// The page that ties a paper's results together.
const PAGE: &str = "index.md";

/// There until the page is.
const UNFINISHED: &str = "unfinished.txt";

/// Gap between the pictures of a grid \[pixels\].
const GAP: u32 = 4;

/// Makes everything; gives what to print.
pub(crate) fn run(arguments: &Papers) -> Result<String, Failure> {
    let (name, size, steps) = match arguments.paper {
        Paper::Billeter => ("billeter", billeter::SIZE, billeter::STEPS),
        Paper::Biri => ("biri", biri::SIZE, biri::STEPS),
        Paper::Chen => ("chen", chen::SIZE, chen::STEPS),
        Paper::Szk => ("szk", szk::SIZE, szk::STEPS),
    };
    let output = arguments.output.clone().unwrap_or_else(|| PathBuf::from("results/papers").join(name));
    check_replaceable(&output, &[PAGE, UNFINISHED])?;
    let ground = Ground { triangles: None, shadow_map_size: None, adapter: arguments.adapter.clone() };
    let context = open(&ground)?;
    // Where a picture takes seconds, times are taken on small ones.
    let share = if context.software { SOFTWARE_SHARE } else { 1 };
    let timed_size = arguments.size.unwrap_or((size.0 / share, size.1 / share));
    let size = arguments.size.unwrap_or(size);
    check_size(&context, size)?;
    make_writable(&output)?;
    write_text(&output, UNFINISHED, "These results are being made, or were when it was stopped.\n")?;
    let progress = Progress::new(steps);
    progress.say(&format!("adapter: {} ({})", context.adapter, context.driver));
    let press = Press {
        context: &context,
        size,
        timed_size,
        frames: Frames::new(arguments.frames, context.software),
        folder: &output,
        progress: &progress,
    };
    let text = match arguments.paper {
        Paper::Billeter => billeter::make(&press),
        Paper::Biri => biri::make(&press),
        Paper::Chen => chen::make(&press),
        Paper::Szk => szk::make(&press),
    }?;
    // What can't be removed does no harm.
    drop(std::fs::remove_file(output.join(UNFINISHED)));
    Ok(text)
}

/// Results of all papers in folders `papers-…` of a run's folder; those that are there already are left alone.
pub(crate) fn all(folder: &Path, run: &cli::Run) -> Result<(), Failure> {
    for paper in Paper::value_variants() {
        let Some(name) = paper.to_possible_value() else { continue };
        let output = folder.join(format!("papers-{}", name.get_name()));
        if !output.join(PAGE).is_file() {
            let adapter = run.ground.adapter.clone();
            self::run(&Papers {
                paper: *paper,
                output: Some(output),
                size: None,
                frames: run.frames,
                adapter,
            })?;
        }
    }
    Ok(())
}

/// What everything is made with.
struct Press<'a> {
    context: &'a Context,
    /// Of pictures, and of frames that are timed.
    size: (u32, u32),
    timed_size: (u32, u32),
    frames: Frames,
    folder: &'a Path,
    progress: &'a Progress,
}

impl Press<'_> {
    /// Writes a text whole or not at all.
    fn text(&self, name: &str, text: &str) -> Result<(), Failure> {
        write_text(self.folder, name, text)
    }

    /// Writes numbers whole or not at all.
    fn json(&self, name: &str, value: &impl Serialize) -> Result<(), Failure> {
        let json = serde_json::to_string_pretty(value).map_err(|error| Failure::Run(error.to_string()))?;
        self.text(name, &json)
    }

    /// Writes a picture of bytes whole or not at all.
    fn picture(&self, name: &str, picture: Picture) -> Result<(), Failure> {
        let path = self.folder.join(name);
        common::image::write_rgb8(&path, picture.width, picture.height, picture.bytes)
            .map_err(|error| Failure::Run(format!("can't write {}: {}", path.display(), cause(&error))))
    }

    fn origin(&self) -> Origin {
        let Context { adapter, driver, software, .. } = self.context;
        Origin {
            date: machine::now(),
            commit: machine::commit(),
            machine: Machine::this(),
            adapter: adapter.clone(),
            driver: driver.clone(),
            software: *software,
            width: self.timed_size.0,
            height: self.timed_size.1,
        }
    }
}

/// Where and when numbers were taken.
#[derive(Clone, Debug, Serialize)]
struct Origin {
    date: String,
    commit: String,
    machine: Machine,
    adapter: String,
    driver: String,
    software: bool,
    width: u32,
    height: u32,
}

impl Origin {
    /// One line.
    fn line(&self) -> String {
        let Machine { cpu, cores, os } = &self.machine;
        format!(
            "timed at {}x{}, {} ({}){}; {cpu}, {cores} cores, {os}; commit {}, {}",
            self.width,
            self.height,
            self.adapter,
            self.driver,
            if self.software { ", software" } else { "" },
            self.commit,
            self.date
        )
    }
}

/// sRGB bytes.
struct Picture {
    width: u32,
    height: u32,
    bytes: Vec<u8>,
}

impl Picture {
    /// White all over.
    fn white(width: u32, height: u32) -> Self {
        Self { width, height, bytes: vec![255; (width * height * 3) as usize] }
    }

    /// Radiance for a screen.
    fn of(image: &Image, exposure: f32) -> Self {
        Self { width: image.width, height: image.height, bytes: image.to_srgb8(exposure) }
    }

    /// Pictures of one size in rows, with gaps between them.
    fn grid<const COLUMNS: usize>(rows: &[[Self; COLUMNS]]) -> Self {
        let (width, height) =
            rows.first().and_then(|row| row.first()).map_or((0, 0), |cell| (cell.width, cell.height));
        let (columns, count) = (COLUMNS as u32, rows.len() as u32);
        let mut picture = Self::white(
            (columns * (width + GAP)).saturating_sub(GAP),
            (count * (height + GAP)).saturating_sub(GAP),
        );
        for (row, cells) in (0..).zip(rows) {
            for (column, cell) in (0..).zip(cells) {
                picture.put(cell, column * (width + GAP), row * (height + GAP));
            }
        }
        picture
    }

    /// Sets a pixel; what lies outside is left out.
    fn set(&mut self, x: i64, y: i64, rgb: [u8; 3]) {
        if (0..i64::from(self.width)).contains(&x) && (0..i64::from(self.height)).contains(&y) {
            let at = (y as usize * self.width as usize + x as usize) * 3;
            self.bytes[at..at + 3].copy_from_slice(&rgb);
        }
    }

    /// Puts another one on top, its corner at (`left`, `top`).
    fn put(&mut self, other: &Self, left: u32, top: u32) {
        for (y, row) in (0i64..).zip(other.bytes.chunks_exact(other.width as usize * 3)) {
            for (x, rgb) in (0i64..).zip(row.chunks_exact(3)) {
                self.set(i64::from(left) + x, i64::from(top) + y, [rgb[0], rgb[1], rgb[2]]);
            }
        }
    }
}

/// A row of a table.
fn cells<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}
