//! The table in the terminal.

use crate::record::Record;
use crate::report::{YARDSTICK, digits, percent, relative_time};

/// One line per measurement, columns aligned; ends with a newline.
pub(crate) fn table(records: &[Record]) -> String {
    let head = [
        "scene",
        "triangles",
        "technique",
        "settings",
        "ms",
        "fps",
        "time ratio",
        "rel. RMSE",
        "bias",
        "leak",
        "FLIP",
        "NaN",
    ];
    let mut rows = vec![head.map(str::to_owned)];
    for record in records {
        if record.refused.is_some() {
            let (scene, name) = (record.scene.clone(), record.name.clone());
            let mut row = head.map(|_| "–".to_owned());
            (row[0], row[1], row[2], row[3]) = (scene, record.triangles.to_string(), name, "refused".into());
            rows.push(row);
            continue;
        }
        rows.push([
            record.scene.clone(),
            record.triangles.to_string(),
            record.name.clone(),
            record.label.clone(),
            digits(record.technique_ms.p50),
            digits(1000.0 / record.technique_ms.p50),
            relative_time(record, records).map_or("–".into(), digits),
            percent(record.error.rel_rmse),
            percent(record.error.bias),
            percent(record.error.leak),
            digits(record.error.flip),
            record.error.nan.to_string(),
        ]);
    }
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut text = String::new();
    for (index, row) in rows.iter().enumerate() {
        for (column, (cell, width)) in row.iter().zip(&widths).enumerate() {
            // Words to the left, numbers to the right.
            let gap = " ".repeat(width - cell.chars().count());
            let (before, after) =
                if matches!(column, 0 | 2 | 3) { ("", gap) } else { (gap.as_str(), "".into()) };
            text += &format!("{before}{cell}{after}  ");
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
        if index == 0 {
            text += &format!("{}\n", "-".repeat(widths.iter().sum::<usize>() + 2 * (widths.len() - 1)));
        }
    }
    text
}

/// What has to be known to read the table.
pub(crate) fn legend(records: &[Record]) -> String {
    let Some(first) = records.first() else { return String::new() };
    let mut text = format!(
        "{} ({}), {}x{}; ms and fps: the technique's own passes, median; time ratio: to {YARDSTICK}; \
         errors: airlight against the CPU reference where that is lit\n\
         (leak: where it is not; FLIP: the whole picture)\n",
        first.adapter, first.driver, first.width, first.height
    );
    for record in records {
        if let Some(refused) = &record.refused {
            text += &format!("refused, {}, {}: {refused}\n", record.scene, record.name);
        }
    }
    if first.software {
        text += SOFTWARE;
        text.push('\n');
    }
    text
}

/// Said wherever times of a software adapter are shown.
pub(crate) const SOFTWARE: &str =
    "Software adapter: absolute times mean little; compare the ratios, which were taken in one run.";
