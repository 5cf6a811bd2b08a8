//! The atlas of what breaks: every way to break a method swept from harmless to absurd, who survives it, and how.

mod bench;
mod bounds;
mod cell;
mod coverage;
mod curve;
mod domain;
mod page;
mod row;
mod rows;
mod scenes;

use std::io::Write;
use std::path::Path;

use common::gpu::Context;
use common::image::Image;

use crate::cli::Stability;
use crate::failure::Failure;
use crate::falsecolor::error_map;
use crate::machine::{self, Machine};
use crate::output::{RunFolder, write_text};
use crate::progress::Progress;
use crate::record::RECORDS;
use crate::report::readme;
use bench::{Bench, Outcome, Shown, Wanted};
use cell::{Cell, Verdict};
use row::{COLUMNS, PROMISED, Row};

/// Measures the rows and writes records, pictures and page; gives what to print. Fails where a promise does not hold.
pub(crate) fn run(arguments: &Stability) -> Result<String, Failure> {
    let rows = wanted_rows(&arguments.rows)?;
    if let Some(unknown) = arguments.only.iter().find(|name| !COLUMNS.contains(&name.as_str())) {
        return Err(Failure::Input(format!(
            "there is no column `{unknown}`; there are: {}",
            COLUMNS.join(", ")
        )));
    }
    if arguments.from_records {
        let cells = read(&arguments.output)?;
        if cells.is_empty() {
            return Err(nothing());
        }
        let text = write(&rows, &cells, &arguments.output)?;
        return finish(arguments, &rows, &cells, text);
    }
    let context = crate::cmd::open_adapter(arguments.adapter.as_deref())?;
    let folder = RunFolder::create(&arguments.output)?;
    let mut cells = Vec::new();
    let atlas = Atlas::new(&context, folder.path(), wanted_columns(arguments));
    let measured = atlas.measure(&rows, arguments.quick, &mut cells);
    if measured.is_ok() && cells.is_empty() {
        return Err(folder.abandon(nothing()));
    }
    let text = match measured.and_then(|()| write(&rows, &cells, folder.path())) {
        Ok(text) => text,
        Err(failure) if cells.is_empty() => return Err(folder.abandon(failure)),
        Err(failure) => {
            // What was measured is worth something.
            write(&rows, &cells, folder.path())?;
            let place = folder.path().display().to_string();
            return Err(failure.also(&format!("what was measured so far is in {place}")));
        }
    };
    let place = folder.finish()?;
    finish(arguments, &rows, &cells, text + &format!("\n{}: the page\n", place.join(PAGE).display()))
}

/// Of nothing nothing can be said to hold.
fn nothing() -> Failure {
    Failure::Input("nothing was measured: none of these columns is in these rows; choose others".into())
}

/// What came out, for the eye and for the exit code.
fn finish(arguments: &Stability, rows: &[Row], cells: &[Cell], text: String) -> Result<String, Failure> {
    let blocks = domain::blocks(rows, cells);
    for path in &arguments.readme {
        let failed = |what: &dyn std::fmt::Display| {
            Failure::Input(format!("can't put tables into {}: {what}", path.display()))
        };
        let old = std::fs::read_to_string(path).map_err(|error| failed(&error))?;
        let new = readme::splice(&old, &blocks).map_err(|problem| failed(&problem))?;
        if new != old {
            common::files::write_whole(path, |file| file.write_all(new.as_bytes()))
                .map_err(|error: std::io::Error| failed(&error))?;
        }
    }
    // A warning that is always there warns of nothing.
    let harmless = |cell: &Cell| {
        let row = rows.iter().find(|row| row.id == cell.row);
        row.is_some_and(|row| row.parameter.values().first() == Some(&cell.value))
    };
    let needless = |cell: &Cell| {
        let told = cell.bound.is_some() && cell.told() && harmless(cell);
        told.then(|| "is refused or warned about, harmless as it is".to_owned())
    };
    let problems: Vec<String> = cells
        .iter()
        .filter_map(|cell| {
            let problem = cell.problem().or_else(|| needless(cell))?;
            Some(format!("{} at {} ({}): {problem}", cell.column, cell.label, cell.row))
        })
        .collect();
    if problems.is_empty() {
        return Ok(text);
    }
    print!("{text}");
    Err(Failure::Run(format!("{} promises do not hold:\n  {}", problems.len(), problems.join("\n  "))))
}

/// The columns that are asked for; in the quick form what something is promised of.
fn wanted_columns(arguments: &Stability) -> Vec<&'static str> {
    let wanted = |column: &&str| match arguments.only.as_slice() {
        [] => !arguments.quick || PROMISED.contains(column),
        only => only.iter().any(|name| name == column),
    };
    COLUMNS.into_iter().filter(wanted).collect()
}

fn wanted_rows(wanted: &[String]) -> Result<Vec<Row>, Failure> {
    let mut rows = rows::all();
    if let Some(unknown) = wanted.iter().find(|id| rows.iter().all(|row| row.id != **id)) {
        let ids: Vec<&str> = rows.iter().map(|row| row.id).collect();
        return Err(Failure::Input(format!("there is no row `{unknown}`; there are: {}", ids.join(", "))));
    }
    rows.retain(|row| wanted.is_empty() || wanted.iter().any(|id| id == row.id));
    Ok(rows)
}

/// File of the page.
const PAGE: &str = "index.html";

/// Cells that were measured before; their bounds are those that are promised now.
fn read(folder: &Path) -> Result<Vec<Cell>, Failure> {
    let path = folder.join(RECORDS);
    let unusable = |what: String| Failure::Input(format!("can't read {}: {what}", path.display()));
    let text = std::fs::read_to_string(&path).map_err(|error| unusable(error.to_string()))?;
    let rows = rows::all();
    let cell = |(line, text): (usize, &str)| {
        let mut cell: Cell = serde_json::from_str(text).map_err(|error| {
            unusable(format!("line {}: {error}; expected records of `harness stability`", line + 1))
        })?;
        let row = rows.iter().find(|row| row.id == cell.row);
        cell.bound = row.and_then(|row| bounds::bound(row, &cell.column, cell.value));
        Ok(cell)
    };
    text.lines().enumerate().map(cell).collect()
}

/// Writes records, curves and page; gives the matrix as a table.
fn write(rows: &[Row], cells: &[Cell], folder: &Path) -> Result<String, Failure> {
    let mut lines = String::new();
    for cell in cells {
        lines += &serde_json::to_string(cell).map_err(|error| Failure::Run(error.to_string()))?;
        lines.push('\n');
    }
    write_text(folder, RECORDS, &lines)?;
    write_text(folder, PAGE, &page::page(rows, cells)?)?;
    for (name, table) in domain::blocks(rows, cells) {
        write_text(folder, &format!("{name}.md"), &table)?;
    }
    Ok(page::text(rows, cells))
}

/// What the rows are measured with.
struct Atlas<'a> {
    context: &'a Context,
    folder: &'a Path,
    columns: Vec<&'static str>,
    machine: Machine,
    commit: String,
}

impl<'a> Atlas<'a> {
    fn new(context: &'a Context, folder: &'a Path, columns: Vec<&'static str>) -> Self {
        Self { context, folder, columns, machine: Machine::this(), commit: machine::commit() }
    }

    fn measure(&self, rows: &[Row], quick: bool, cells: &mut Vec<Cell>) -> Result<(), Failure> {
        let values = |row: &Row| if quick { row.quick.to_vec() } else { row.parameter.values() };
        let progress = Progress::new(rows.iter().map(|row| values(row).len() as u64).sum());
        let software = if self.context.software { ", software" } else { "" };
        progress.say(&format!("adapter: {} ({}){software}", self.context.adapter, self.context.driver));
        let mut bench = Bench::new(self.context);
        for row in rows {
            let mut worst: Vec<Worst> = Vec::new();
            for value in values(row) {
                progress.doing(&format!(
                    "{}: {} {}",
                    row.id,
                    row.parameter.label(value),
                    row.parameter.unit()
                ));
                self.measure_value(&mut bench, row, value, cells, &mut worst)?;
                progress.step();
            }
            for one in worst {
                cells[one.cell].picture = Some(self.picture(row, &cells[one.cell], &one.images)?);
            }
        }
        Ok(())
    }

    fn measure_value(
        &self,
        bench: &mut Bench<'_>,
        row: &Row,
        value: f64,
        cells: &mut Vec<Cell>,
        worst: &mut Vec<Worst>,
    ) -> Result<(), Failure> {
        let setup = (row.build)(value);
        let mut entries = (row.methods)(value);
        entries.retain(|entry| self.columns.contains(&entry.column));
        // What no one can draw has no reference.
        let wanted = match bench.wanted(&setup, row.measure) {
            Err(Failure::Input(refusal)) => Err(refusal),
            other => Ok(other?),
        };
        let mut stages = Vec::new();
        for entry in entries {
            let mut cell = self.cell(row, entry.column, value);
            let outcome = match &wanted {
                Err(refusal) => Outcome::Refused(refusal.clone()),
                Ok(_) => bench.draw(&setup, &mut stages, &entry.method)?,
            };
            match outcome {
                Outcome::Refused(why) => cell.refused = Some(why),
                Outcome::Broken(fault) => cell.fault = Some(fault),
                Outcome::Drawn { pictures, warnings, memory } => {
                    let (figure, images) = bench::figure(
                        &setup,
                        row.measure,
                        &pictures,
                        memory,
                        wanted.as_ref().unwrap_or(&Wanted::Unknown),
                    )?;
                    cell.figure = figure.value.filter(|value| value.is_finite());
                    cell.infinite = figure.value.is_some_and(|value| !value.is_finite());
                    (cell.bias, cell.energy_ratio, cell.broken) =
                        (figure.bias, figure.energy_ratio, figure.broken);
                    cell.warnings = warnings;
                    if let Some(images) = images {
                        keep_worst(worst, cells, &cell, images);
                    }
                }
            }
            self.keep(&cell)?;
            cells.push(cell);
        }
        Ok(())
    }

    /// Adds a record to the file, so that none is lost whatever happens.
    fn keep(&self, cell: &Cell) -> Result<(), Failure> {
        let path = self.folder.join(RECORDS);
        let line = serde_json::to_string(cell).map_err(|error| Failure::Run(error.to_string()))? + "\n";
        std::fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .and_then(|mut file| file.write_all(line.as_bytes()))
            .map_err(|error| Failure::Run(format!("can't write {}: {error}", path.display())))
    }

    fn cell(&self, row: &Row, column: &str, value: f64) -> Cell {
        Cell {
            schema: cell::SCHEMA,
            row: row.id.into(),
            column: column.into(),
            value,
            label: format!("{} {}", row.parameter.label(value), row.parameter.unit()).trim().to_owned(),
            measure: row.measure.title().into(),
            figure: None,
            infinite: false,
            bound: bounds::bound(row, column, value),
            bias: None,
            energy_ratio: None,
            broken: 0,
            refused: None,
            fault: None,
            warnings: Vec::new(),
            picture: None,
            adapter: self.context.adapter.clone(),
            driver: self.context.driver.clone(),
            software: self.context.software,
            machine: self.machine.clone(),
            commit: self.commit.clone(),
            date: machine::now(),
        }
    }

    /// Picture and, where it is known, what it should be and the error, side by side in one file; gives its name.
    fn picture(&self, row: &Row, cell: &Cell, (picture, wanted): &Shown) -> Result<String, Failure> {
        let lit = |image: &&Image| image.pixels.iter().any(|pixel| pixel.max_element() > 0.0);
        let exposure = wanted.as_ref().filter(lit).unwrap_or(picture).auto_exposure();
        let (width, mut height) = (picture.width, picture.height);
        let mut parts = vec![picture.to_srgb8(exposure)];
        if let Some(wanted) = wanted {
            // What was left out of the judgement is shown as black.
            let mut shown = wanted.clone();
            shown
                .pixels
                .iter_mut()
                .filter(|pixel| !pixel.is_finite())
                .for_each(|pixel| *pixel = glam::Vec3::ZERO);
            let map = error_map(picture, &shown);
            height = map.height;
            parts.extend([shown.to_srgb8(exposure), map.bytes]);
        }
        let all = parts.len() as u32 * (width + GAP) - GAP;
        let mut strip = image::RgbImage::from_pixel(all, height, image::Rgb([255; 3]));
        for (index, bytes) in (0..).zip(&parts) {
            for (pixel, rgb) in (0..).zip(bytes.chunks_exact(3)) {
                strip.put_pixel(
                    index * (width + GAP) + pixel % width,
                    pixel / width,
                    image::Rgb([rgb[0], rgb[1], rgb[2]]),
                );
            }
        }
        let name = format!("{}--{}.jpg", row.id, cell.column);
        let path = self.folder.join(&name);
        let failed =
            |error: &dyn std::fmt::Display| Failure::Run(format!("can't write {}: {error}", path.display()));
        let mut bytes = Vec::new();
        image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, QUALITY)
            .encode_image(&strip)
            .map_err(|error| failed(&error))?;
        common::files::write_whole(&path, |file| file.write_all(&bytes))
            .map_err(|error: std::io::Error| failed(&error))?;
        Ok(name)
    }
}

/// Between the parts of a picture \[pixels\], and its quality as a JPEG.
const GAP: u32 = 3;
const QUALITY: u8 = 75;

/// The worst measurement of a column in a row.
struct Worst {
    /// Index into the cells.
    cell: usize,
    images: Shown,
}

/// Keeps the pictures of the worse one of a column's: `cell` is about to be added to `cells`.
fn keep_worst(worst: &mut Vec<Worst>, cells: &[Cell], cell: &Cell, images: Shown) {
    // What is told of is not the worst while there is something that is not.
    let badness = |cell: &Cell| {
        let figure = cell.figure();
        let figure = if figure.is_nan() { 0.0 } else { figure };
        (cell.verdict() == Verdict::Broken, !cell.told(), figure / cell.bound.unwrap_or(1.0))
    };
    let new = Worst { cell: cells.len(), images };
    match worst.iter_mut().find(|one| cells[one.cell].column == cell.column) {
        Some(one) if badness(&cells[one.cell]) < badness(cell) => *one = new,
        Some(_) => {}
        None => worst.push(new),
    }
}
