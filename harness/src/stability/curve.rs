//! A row as a chart: figures over the parameter.

use plotters::prelude::*;

use super::cell::{Cell, Verdict};
use super::row::Row;
use crate::report::chart::{Drawing, Sheet, draw_line, draw_mark, ink, sheet};
use crate::report::looks::{Looks, number};

const SIZE: (u32, u32) = (960, 420);
const LEGEND: i32 = 250;
/// Edges of the plot.
const LEFT: i32 = 84;
const TOP: i32 = 16;
const BELOW: i32 = 62;

/// Figures of a row. Values stand side by side in their order, because a sweep may go to zero and beyond; figures are
/// logarithmic, what is below or above the axis lies at its end.
pub(super) fn curve(
    row: &Row,
    cells: &[&Cell],
    columns: &[&str],
    looks: &Looks<'_>,
) -> Result<String, String> {
    sheet(SIZE, |area| draw(area, row, cells, columns, looks))
}

fn draw(area: &Sheet<'_>, row: &Row, cells: &[&Cell], columns: &[&str], looks: &Looks<'_>) -> Drawing<()> {
    let mut values: Vec<f64> = cells.iter().map(|cell| cell.value).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let (low, high) = if row.measure.relative() { (1e-6, 10.0) } else { (1.0, 1e6) };
    let (width, height) = (SIZE.0 as i32, SIZE.1 as i32);
    let (right, bottom) = (width - LEGEND, height - BELOW);
    let x = |value: f64| {
        let index = values.iter().position(|other| *other == value).unwrap_or(0) as f64;
        LEFT + ((index + 0.5) / values.len().max(1) as f64 * f64::from(right - LEFT)) as i32
    };
    let y = |figure: f64| {
        let share = (figure.clamp(low, high) / low).ln() / (high / low).ln();
        bottom - (share * f64::from(bottom - TOP)).round() as i32
    };
    let grey = RGBColor(128, 128, 128).mix(0.3);
    for decade in low.log10().round() as i32..=high.log10().round() as i32 {
        let figure = 10f64.powi(decade);
        area.draw(&PathElement::new([(LEFT, y(figure)), (right, y(figure))], grey))?;
        let text =
            if row.measure.relative() { format!("{} %", number(100.0 * figure)) } else { number(figure) };
        area.draw(&Text::new(text, (8, y(figure) - 8), ink(15)))?;
    }
    area.draw(&PathElement::new([(LEFT, TOP), (LEFT, bottom), (right, bottom)], BLACK))?;
    for (index, value) in values.iter().enumerate() {
        let label = row.parameter.label(*value);
        // Words are shown in the table; here there is room for their number.
        let label = if label.chars().count() > 8 { format!("{}", index + 1) } else { label };
        area.draw(&Text::new(
            label.clone(),
            (x(*value) - 4 * label.chars().count() as i32, bottom + 6),
            ink(15),
        ))?;
    }
    let unit =
        if row.parameter.unit().is_empty() { String::new() } else { format!(" [{}]", row.parameter.unit()) };
    area.draw(&Text::new(format!("{}{unit}", row.parameter.name()), (LEFT, height - 24), ink(16)))?;

    for (column, line) in columns.iter().zip(0..) {
        let look = looks.get(column);
        let mut own: Vec<&&Cell> =
            cells.iter().filter(|cell| cell.column == *column && !cell.figure().is_nan()).collect();
        own.sort_by(|a, b| a.value.total_cmp(&b.value));
        let places: Vec<(i32, i32)> = own.iter().map(|cell| (x(cell.value), y(cell.figure()))).collect();
        draw_line(area, &places, look)?;
        for (cell, place) in own.iter().zip(&places) {
            draw_mark(area, *place, look, cell.verdict() == Verdict::Told, false)?;
        }
        let at = (right + 22, TOP + 14 + 24 * line);
        draw_line(area, &[(at.0 - 12, at.1), (at.0 + 12, at.1)], look)?;
        draw_mark(area, at, look, false, false)?;
        area.draw(&Text::new((*column).to_owned(), (at.0 + 20, at.1 - 8), ink(15)))?;
    }
    Ok(())
}
