//! The atlas as a page and as text.

use std::path::Path;

use super::cell::Cell;
use super::row::{COLUMNS, Row};
use crate::failure::Failure;
use crate::report::markdown::table;

/// A share as a percentage.
pub(super) fn percent(value: f64) -> String {
    if value.is_nan() {
        return "–".into();
    }
    if !value.is_finite() {
        return "∞".into();
    }
    format!("{} %", crate::report::digits(100.0 * value))
}

/// A figure of a measure.
pub(super) fn amount(measure: &str, value: f64) -> String {
    if measure.contains("bytes") { format!("{} B", value.round()) } else { percent(value) }
}

pub(super) fn page(_rows: &[Row], _cells: &[Cell], _folder: &Path) -> Result<String, Failure> {
    Ok(String::new())
}

/// All figures as text.
pub(super) fn text(rows: &[Row], cells: &[Cell]) -> String {
    let mut text = String::new();
    for row in rows {
        let own: Vec<&Cell> = cells.iter().filter(|cell| cell.row == row.id).collect();
        let columns: Vec<&str> =
            COLUMNS.into_iter().filter(|column| own.iter().any(|cell| cell.column == *column)).collect();
        let mut labels: Vec<&str> = own.iter().map(|cell| cell.label.as_str()).collect();
        labels.dedup();
        let mut lines = vec![std::iter::once(row.id.to_owned()).chain(columns.iter().map(|c| (*c).to_owned())).collect::<Vec<_>>()];
        for label in labels {
            let mut line = vec![label.to_owned()];
            for column in &columns {
                let cell = own.iter().find(|cell| cell.column == *column && cell.label == label);
                line.push(cell.map_or("".into(), |cell| {
                    let mark = match cell.verdict() {
                        super::cell::Verdict::Kept => "",
                        super::cell::Verdict::Told => " (told)",
                        super::cell::Verdict::Silent => " !",
                        super::cell::Verdict::Broken => " BROKEN",
                    };
                    format!("{}{mark}", amount(&cell.measure, cell.figure()))
                }));
            }
            lines.push(line);
        }
        text += &table(&lines);
        text.push('\n');
    }
    text
}
