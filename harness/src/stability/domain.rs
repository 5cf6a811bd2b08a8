//! Domains of validity: where a technique's default stays under 2 and 5 percent.

use super::cell::{Cell, Verdict};
use super::row::{Measure, Parameter, Row};
use crate::report::markdown::table;

/// Techniques, and the columns of their defaults.
const TECHNIQUES: [(&str, &str); 4] = [
    ("domain-billeter-plv", "billeter-plv-default"),
    ("domain-biri-ss", "biri-ss-default"),
    ("domain-chen-planes", "chen-planes-default"),
    ("domain-szk-network", "szk-network-default"),
];

const LIMITS: [f64; 2] = [0.02, 0.05];

/// One table for each technique, by the name of its marker.
pub(super) fn blocks(rows: &[Row], cells: &[Cell]) -> Vec<(&'static str, String)> {
    let measured = TECHNIQUES.iter().filter(|(_, column)| cells.iter().any(|cell| cell.column == **column));
    measured.map(|(name, column)| (*name, domain(rows, cells, column))).collect()
}

fn domain(rows: &[Row], cells: &[Cell], column: &str) -> String {
    let head =
        ["what is varied", "from … to", "under 2 %", "under 5 %", "worst", "beyond"].map(str::to_owned);
    let mut lines = vec![head.to_vec()];
    for row in rows.iter().filter(|row| matches!(row.measure, Measure::Error | Measure::Relative)) {
        let own: Vec<&Cell> =
            cells.iter().filter(|cell| cell.row == row.id && cell.column == column).collect();
        if own.is_empty() {
            continue;
        }
        let known: Vec<&&Cell> =
            own.iter().filter(|cell| !cell.figure().is_nan() && cell.refused.is_none()).collect();
        let worst = known.iter().map(|cell| cell.figure()).fold(0.0, f64::max);
        let told: Vec<&str> = own
            .iter()
            .filter(|cell| cell.verdict() == Verdict::Told)
            .map(|cell| cell.label.as_str())
            .collect();
        let told = match told.as_slice() {
            [] => "–".to_owned(),
            some => format!("told at {}", some.join(", ")),
        };
        let mut line = vec![format!("{} ({})", row.title, row.parameter.name()), range(row, &own)];
        line.extend(LIMITS.map(|limit| under(row, &own, limit)));
        line.extend([super::page::percent(worst), told]);
        lines.push(line);
    }
    table(&lines)
}

/// Least and largest value, or how many choices.
fn range(row: &Row, cells: &[&Cell]) -> String {
    match row.parameter {
        Parameter::Choice { .. } => format!("{} cases", cells.len()),
        Parameter::Number { .. } => ends(row, cells.iter().map(|cell| cell.value)),
    }
}

fn ends(row: &Row, values: impl Iterator<Item = f64> + Clone) -> String {
    let (low, high) =
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max));
    let unit = row.parameter.unit();
    let text = |value| row.parameter.label(value);
    if low == high {
        format!("{} {unit}", text(low))
    } else {
        format!("{} … {} {unit}", text(low), text(high))
    }
    .trim()
    .to_owned()
}

/// Where the figure stays under the limit: the values without a gap around the harmless one, or the choices.
fn under(row: &Row, cells: &[&Cell], limit: f64) -> String {
    // Where what is right is not known nothing is said.
    let judged: Vec<&&Cell> =
        cells.iter().filter(|cell| !cell.figure().is_nan() || cell.refused.is_some()).collect();
    let good = |cell: &Cell| cell.refused.is_none() && cell.broken == 0 && cell.figure() <= limit;
    if judged.iter().all(|cell| good(cell)) {
        return "all".into();
    }
    match row.parameter {
        Parameter::Choice { .. } => {
            let bad: Vec<&str> =
                judged.iter().filter(|cell| !good(cell)).map(|cell| cell.label.as_str()).collect();
            if bad.len() == judged.len() { "none".into() } else { format!("all but {}", bad.join(", ")) }
        }
        Parameter::Number { .. } => {
            let mut sorted = judged;
            sorted.sort_by(|a, b| a.value.total_cmp(&b.value));
            let harmless = row.parameter.values().first().copied();
            let Some(start) = sorted.iter().position(|cell| Some(cell.value) == harmless) else {
                return "–".into();
            };
            if !good(sorted[start]) {
                return "none".into();
            }
            let low = sorted[..start].iter().rposition(|cell| !good(cell)).map_or(0, |index| index + 1);
            let high = sorted[start..]
                .iter()
                .position(|cell| !good(cell))
                .map_or(sorted.len(), |index| start + index);
            ends(row, sorted[low..high].iter().map(|cell| cell.value))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::cell::tests::example;
    use crate::stability::rows;

    #[test]
    fn a_domain_is_what_is_good_around_the_harmless_value() {
        let rows = rows::all();
        let row = rows.iter().find(|row| row.id == "optical-thickness").unwrap();
        let cell = |value: f64, figure: f64| Cell {
            label: row.parameter.label(value),
            ..example(row.id, "c", value, figure)
        };
        // Harmless is 1; at 0.01 it is bad, so that what is good beyond does not count.
        let cells = [
            cell(1e-4, 0.0),
            cell(0.01, 0.2),
            cell(0.1, 0.01),
            cell(1.0, 0.0),
            cell(10.0, 0.03),
            cell(100.0, 0.3),
        ];
        let all: Vec<&Cell> = cells.iter().collect();
        assert_eq!(under(row, &all, 0.02), "0.1 … 1");
        assert_eq!(under(row, &all, 0.05), "0.1 … 10");
        assert_eq!(under(row, &all, 0.5), "all");
        assert_eq!(under(row, &all[..2], 0.5), "all");
        let refused = Cell { refused: Some("no".into()), figure: None, ..cell(1.0, 0.0) };
        assert_eq!(under(row, &[&refused, &cells[2]], 0.05), "none");
    }

    #[test]
    fn tables_have_a_line_for_each_row_that_was_measured() {
        let rows = rows::all();
        let cells =
            [example("scale", "biri-ss-default", 1.0, 0.001), example("scale", "biri-ss-default", 1e6, 0.03)];
        let blocks = blocks(&rows, &cells);
        // None of a technique that was not: it would take the place of one that was.
        assert_eq!(blocks.len(), 1);
        let (name, text) = &blocks[0];
        assert_eq!(*name, "domain-biri-ss");
        assert_eq!(text.lines().count(), 3, "{text}");
        assert!(text.contains("| 1 … 1e6") && text.contains("3.00 %"), "{text}");
    }
}
