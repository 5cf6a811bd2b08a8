//! From records to tables, charts and a page. Nothing here measures.

pub(crate) mod chart;
pub(crate) mod html;
pub(crate) mod markdown;
pub(crate) mod table;

use std::io::Write;
use std::path::Path;

use common::files::write_whole;

use crate::failure::Failure;
use crate::record::{Record, write_csv};

/// The page's file in a run's folder.
pub(crate) const PAGE: &str = "index.html";

/// Writes table, charts and page into a run's folder, from its records.
pub(crate) fn write(folder: &Path, records: &[Record]) -> Result<(), Failure> {
    let failed = |what: &str, error: &dyn std::fmt::Display| {
        Failure::Run(format!("can't write {}: {error}", folder.join(what).display()))
    };
    write_csv(&folder.join("records.csv"), records).map_err(|error| failed("records.csv", &error))?;
    let text = |name: &str, text: &str| {
        write_whole(&folder.join(name), |file| file.write_all(text.as_bytes()))
            .map_err(|error: std::io::Error| failed(name, &error))
    };
    let mut charts = Vec::new();
    for scene in scenes(records) {
        let of_scene: Vec<&Record> = records.iter().filter(|record| record.scene == scene).collect();
        let svg = chart::error_against_time(&of_scene).map_err(|error| failed("the chart", &error))?;
        let name = format!("chart-{}.svg", file_name(scene));
        text(&name, &chart::with_background(&svg))?;
        charts.push(svg);
    }
    text(PAGE, &html::page(records, &charts))
}

/// Names of the scenes, each once, in the order of the records.
pub(crate) fn scenes(records: &[Record]) -> Vec<&str> {
    let mut scenes: Vec<&str> = Vec::new();
    for record in records {
        if !scenes.contains(&record.scene.as_str()) {
            scenes.push(&record.scene);
        }
    }
    scenes
}

/// `name` with everything that a file name or a link could stumble over replaced.
pub(crate) fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '-' }).collect()
}

/// The technique that others are compared with in time.
pub(crate) const YARDSTICK: &str = "ray-march-64";

/// Time relative to the yardstick of the same scene and run.
pub(crate) fn relative_time(record: &Record, records: &[Record]) -> Option<f64> {
    let yardstick = records.iter().find(|other| other.scene == record.scene && other.name == YARDSTICK)?;
    let ratio = record.technique_ms.p50 / yardstick.technique_ms.p50;
    ratio.is_finite().then_some(ratio)
}

/// Milliseconds with three digits that mean something.
pub(crate) fn digits(value: f64) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let places = match value.abs() {
        x if x >= 100.0 => 0,
        x if x >= 10.0 => 1,
        x if x >= 1.0 => 2,
        _ => 3,
    };
    format!("{value:.places$}")
}

/// A share as percent, with three digits that mean something.
pub(crate) fn percent(share: f64) -> String {
    let value = 100.0 * share;
    match value.abs() {
        x if !x.is_finite() => "–".into(),
        0.0 => "0 %".into(),
        x if x < 0.001 => format!("{value:.1e} %"),
        x if x < 0.1 => format!("{value:.4} %"),
        _ => format!("{} %", digits(value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::example;
    use crate::record::{Errors, RECORDS, Writer};

    /// Records of two techniques, a refusal among them.
    fn examples() -> Vec<Record> {
        let refused = Record {
            refused: Some("it can't draw <this>".into()),
            error: Errors::NONE,
            technique_ms: Default::default(),
            ..example("billeter-plv", 1.0, 0.0)
        };
        vec![
            example("ray-march-16", 0.5, 0.3),
            example("ray-march-64", 2.0, 0.08),
            example("ray-march-256", 8.0, 1e-9),
            example("billeter-plv", 1.0, 0.01),
            refused,
        ]
    }

    #[test]
    fn a_page_is_made_of_records_alone_and_needs_no_network() {
        let folder = tempfile::tempdir().unwrap();
        let records = examples();
        let mut writer = Writer::open(folder.path()).unwrap();
        records.iter().for_each(|record| writer.add(record).unwrap());
        assert!(folder.path().join(RECORDS).exists());
        write(folder.path(), &records).unwrap();
        let page = std::fs::read_to_string(folder.path().join(PAGE)).unwrap();
        for wanted in
            ["ray-march-256", "Software adapter", "a &lt;fast&gt; one", "can't draw &lt;this&gt;", "<svg"]
        {
            assert!(page.contains(wanted), "{wanted}");
        }
        for unwanted in ["<fast>", "<this>", "src=\"http", "href=\"http", "<script", "@import", "url("] {
            assert!(!page.contains(unwanted), "{unwanted}");
        }
        let chart = std::fs::read_to_string(folder.path().join("chart-hall---old-.svg")).unwrap();
        assert!(chart.contains("relative RMSE") && chart.contains("ray-march"));
    }

    #[test]
    fn the_table_has_a_line_for_every_record() {
        let records = examples();
        let text = table::table(&records);
        assert_eq!(text.lines().count(), records.len() + 2, "{text}");
        assert!(text.contains("refused"));
        assert!(table::legend(&records).contains("it can't draw <this>"));
        // Twice as slow as the yardstick is 2.
        assert_eq!(relative_time(&records[2], &records), Some(4.0));
    }

    #[test]
    fn numbers_keep_three_digits() {
        assert_eq!(
            [digits(0.1234), digits(1.234), digits(12.34), digits(1234.5)],
            ["0.123", "1.23", "12.3", "1234"]
        );
        assert_eq!([percent(0.0123), percent(0.0), percent(f64::NAN)], ["1.23 %", "0 %", "–"]);
        assert_eq!(file_name("../a scene.obj"), "---a-scene-obj");
    }
}
