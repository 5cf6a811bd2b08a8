//! From records to tables, charts and a page. Nothing here measures.

pub(crate) mod chart;
mod equal;
mod frontier;
pub(crate) mod html;
mod labels;
mod law;
mod lines;
pub(crate) mod looks;
pub(crate) mod markdown;
mod methodology;
mod papers;
mod passes;
mod pictures;
mod presets;
pub(crate) mod readme;
mod scaling;
mod sections;
pub(crate) mod sources;
pub(crate) mod table;
mod tables;

use std::io::Write;
use std::path::{Path, PathBuf};

use common::files::write_whole;

use crate::failure::Failure;
use crate::record::{RECORDS, Record, write_csv};
use looks::Looks;
use papers::Paper;
use pictures::Album;
use sources::Sources;

/// The page's file in a run's folder.
pub(crate) const PAGE: &str = "index.html";

/// Figures as a table.
const CSV: &str = "records.csv";

/// The technique that others are compared with in time.
pub(crate) const YARDSTICK: &str = "ray-march-64";

/// Marching in even steps, of which a law is known.
const UNIFORM: &str = "ray-march";

/// Airlight without shadows: the least that fog costs.
const FLOOR: &str = "unshadowed";

/// What a page is made of.
#[derive(Clone, Debug)]
pub(crate) struct Report {
    pub sources: Sources,
    papers: Vec<Paper>,
}

impl Report {
    /// With the papers of these folders.
    pub(crate) fn new(sources: Sources, papers: &[PathBuf]) -> Result<Self, Failure> {
        let papers = papers.iter().map(|folder| Paper::read(folder)).collect::<Result<_, _>>()?;
        Ok(Self { sources, papers })
    }

    /// With the papers that lie in and beside the runs' folders; one that can't be read is left out, and said.
    pub(crate) fn with_found_papers(mut sources: Sources, folders: &[PathBuf]) -> Self {
        let mut found: Vec<PathBuf> = folders.iter().flat_map(|folder| papers::find(folder)).collect();
        found.sort();
        found.dedup();
        let mut papers = Vec::new();
        for folder in found {
            match Paper::read(&folder) {
                Ok(paper) => papers.push(paper),
                Err(failure) => sources.notes.push(failure.to_string()),
            }
        }
        Self { sources, papers }
    }

    /// Writes table, charts and page.
    pub(crate) fn write(&self, folder: &Path) -> Result<(), Failure> {
        let failed = |what: &str, error: &dyn std::fmt::Display| {
            Failure::Run(format!("can't write {}: {error}", folder.join(what).display()))
        };
        let text = |name: &str, text: &str| {
            write_whole(&folder.join(name), |file| file.write_all(text.as_bytes()))
                .map_err(|error: std::io::Error| failed(name, &error))
        };
        let records = &self.sources.records;
        write_csv(&folder.join(CSV), records).map_err(|error| failed(CSV, &error))?;
        let (cases, looks) = (sources::cases(records), Looks::of(records));
        let mut names: Vec<String> = Vec::new();
        for case in &cases {
            let stem = format!("chart-{}", file_name(&case.title(&cases)));
            let name = (1..).map(|n| if n == 1 { stem.clone() } else { format!("{stem}-{n}") });
            let name = name.into_iter().find(|name| !names.contains(name)).unwrap_or(stem);
            let title = sections::chart_title(case);
            let chart = chart::error_against_time(case, &title, &looks, chart::WIDE);
            let chart = chart.map_err(|error| failed("the chart", &error))?;
            text(&format!("{name}.svg"), &chart::with_background(&chart.svg))?;
            names.push(name);
        }
        let of_papers: Vec<String> = self.papers.iter().flat_map(Paper::pictures).collect();
        let pictures = records.iter().map(|record| &record.pictures);
        let files = pictures.flat_map(|pictures| [pictures.picture.as_str(), pictures.reference.as_str()]);
        let album = Album::load(files, of_papers.iter().map(String::as_str));
        let raw = [RECORDS, CSV].into_iter().filter(|name| folder.join(name).is_file());
        let page = html::page(self, &cases, &looks, &album, &raw.collect::<Vec<_>>());
        text(PAGE, &page.map_err(|error| failed(PAGE, &error))?)
    }
}

/// Writes table, charts and page into a run's folder, from its records.
pub(crate) fn write(folder: &Path, records: &[Record]) -> Result<(), Failure> {
    Report::with_found_papers(Sources::of(folder, records), &[folder.into()]).write(folder)
}

/// `name` with everything that a file name or a link could stumble over replaced.
pub(crate) fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '-' }).collect()
}

/// Time relative to the yardstick of the same picture and run.
pub(crate) fn relative_time(record: &Record, records: &[Record]) -> Option<f64> {
    let ratio = record.technique_ms.p50 / yardstick_of(record, records)?.technique_ms.p50;
    ratio.is_finite().then_some(ratio)
}

/// The yardstick of the same picture.
pub(crate) fn yardstick_of<'a>(record: &Record, records: &'a [Record]) -> Option<&'a Record> {
    yardstick(record, records.iter().filter(|other| sources::is_alike(other, record)))
}

/// The yardstick, on the same shadow maps if it was measured so.
fn yardstick<'a>(record: &Record, among: impl Iterator<Item = &'a Record>) -> Option<&'a Record> {
    // Behind an @ is the size of the maps.
    let is = |other: &&Record| other.name.split('@').next() == Some(YARDSTICK) && other.refused.is_none();
    let sticks: Vec<&Record> = among.filter(is).collect();
    let on_same = |other: &&&Record| other.shadow_map_size() == record.shadow_map_size();
    sticks.iter().find(on_same).or(sticks.first()).copied()
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
        x if x >= 5e-4 || x == 0.0 => 3,
        _ => return format!("{value:.1e}"),
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
    use crate::record::{Errors, Writer};

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
        for wanted in [
            "ray-march",
            "SOFTWARE ADAPTER",
            "a &lt;fast&gt; one",
            "can't draw &lt;this&gt;",
            "<svg",
            "records.jsonl",
        ] {
            assert!(page.contains(wanted), "{wanted}");
        }
        for unwanted in
            ["<fast>", "<this>", "src=\"http", "href=\"http", "<script src", "@import", "url(", "fetch("]
        {
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
