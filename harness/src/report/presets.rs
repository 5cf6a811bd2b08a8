//! The papers' settings and the defaults, and what each improvement is worth.

use crate::record::Record;
use crate::report::frontier::Point;
use crate::report::sources::{Case, is_alike};
use crate::report::tables::{Cell, Table};
use crate::report::{FLOOR, digits, percent, yardstick};

/// A default beside the paper's setting, with the same shadow maps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<'a> {
    pub paper: Point<'a>,
    pub default: Point<'a>,
}

/// What the default is to the paper's setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Standing {
    Dominates,
    Alike,
    Better,
    Faster,
    Dominated,
}

impl Standing {
    pub(crate) const fn text(self) -> &'static str {
        match self {
            Self::Dominates => "dominates the paper's",
            Self::Alike => "no difference beyond the noise",
            Self::Better => "better, but takes longer",
            Self::Faster => "faster, but worse",
            Self::Dominated => "worse than the paper's",
        }
    }
}

impl Pair<'_> {
    pub(crate) fn standing(&self) -> Standing {
        let Self { paper, default } = self;
        match (default.dominates(paper), paper.dominates(default)) {
            (true, _) => Standing::Dominates,
            (_, true) => Standing::Dominated,
            _ if default.takes_as_long(paper) => Standing::Alike,
            _ if default.time > paper.time => Standing::Better,
            _ => Standing::Faster,
        }
    }
}

/// All pairs of a case.
pub(crate) fn pairs<'a>(case: &Case<'a>) -> Vec<Pair<'a>> {
    let papers = case.records.iter().filter(|record| record.preset == "paper");
    let pairs = papers.filter_map(|paper| {
        let default = case.records.iter().find(|record| {
            record.preset == "default"
                && record.technique == paper.technique
                && record.shadow_map_size() == paper.shadow_map_size()
        })?;
        Some(Pair { paper: Point::of(paper)?, default: Point::of(default)? })
    });
    pairs.collect()
}

/// Time over that of the technique that leaves the shadows out, with the same shadow maps if it was measured so.
fn over_floor(case: &Case<'_>, record: &Record) -> Option<f64> {
    let floors = || case.records.iter().filter(|other| other.technique == FLOOR);
    let alike = floors().find(|other| other.shadow_map_size() == record.shadow_map_size());
    let floor = alike.or_else(|| floors().next())?.technique_ms.p50;
    (floor > 0.0).then(|| record.technique_ms.p50 / floor)
}

/// Time over that of the yardstick, with the same shadow maps if it was measured so.
pub(crate) fn over_yardstick(case: &Case<'_>, record: &Record) -> Option<f64> {
    let ratio = record.technique_ms.p50 / yardstick(record, case.records.iter().copied())?.technique_ms.p50;
    ratio.is_finite().then_some(ratio)
}

fn ratio(value: Option<f64>) -> Cell {
    value.map_or(Cell::number("–".into(), f64::INFINITY), |value| Cell::number(digits(value), value))
}

/// Every preset: time, error, what it is to the floor, and whether the default dominates.
pub(crate) fn presets(case: &Case<'_>) -> Table {
    let head = [
        "technique",
        "preset",
        "ms",
        "÷ 64 steps",
        "÷ unshadowed",
        "rel. RMSE",
        "worst tile",
        "FLIP",
        "the default",
    ];
    let mut table = Table::new(2, head);
    let pairs = pairs(case);
    for record in case.records.iter().filter(|record| record.preset == "paper" || record.preset == "default")
    {
        let Some(point) = Point::of(record) else { continue };
        let standing = pairs.iter().find(|pair| std::ptr::eq(pair.default.record, *record));
        let preset = match case.maps(record) {
            Some(maps) => format!("{}, {maps}", record.preset),
            None => record.preset.clone(),
        };
        table.rows.push(vec![
            record.technique.as_str().into(),
            preset.into(),
            Cell::number(digits(point.time), point.time),
            ratio(over_yardstick(case, record)),
            ratio(over_floor(case, record)),
            Cell::number(
                format!("{}{}", if point.bound { "≤ " } else { "" }, percent(point.error)),
                point.error,
            ),
            Cell::number(percent(record.error.worst_tile), record.error.worst_tile),
            Cell::number(digits(record.error.flip), record.error.flip),
            standing.map_or("", |pair| pair.standing().text()).into(),
        ]);
    }
    table
}

/// The paper's setting with one improvement each: time and error over the paper's own.
pub(crate) fn improvements(case: &Case<'_>) -> Table {
    let mut table =
        Table::new(2, ["technique", "improvement", "ms", "time ÷ paper", "rel. RMSE", "error ÷ paper"]);
    for record in &case.improvements {
        let Some(point) = Point::of(record) else { continue };
        let all = || case.improvements.iter().chain(&case.records);
        let paper = all().find(|other| {
            other.preset == "paper"
                && other.technique == record.technique
                && is_alike(other, record)
                && other.shadow_map_size() == record.shadow_map_size()
        });
        let paper = paper.and_then(|paper| Point::of(paper));
        table.rows.push(vec![
            record.technique.as_str().into(),
            record.label.as_str().into(),
            Cell::number(digits(point.time), point.time),
            ratio(paper.map(|paper| point.time / paper.time)),
            Cell::number(percent(point.error), point.error),
            ratio(paper.map(|paper| point.error / paper.error)),
        ]);
    }
    table
}

/// All that was drawn of a case, in figures.
pub(crate) fn everything(case: &Case<'_>) -> Table {
    let head = [
        "technique",
        "setting",
        "ms p50",
        "p95",
        "max",
        "÷ 64 steps",
        "ground ms",
        "frame ms",
        "rel. RMSE",
        "bias",
        "p99",
        "max error",
        "worst tile",
        "leak",
        "FLIP",
        "energy",
        "NaN, inf, neg.",
    ];
    let mut table = Table::new(2, head);
    for record in &case.records {
        let name = Cell::from(record.technique.as_str());
        let name = if record.peer { name.with("peer") } else { name };
        let mut row = vec![name, Cell::from(case.setting(record))];
        if let Some(refused) = &record.refused {
            row[1] = Cell::from("refused").with(refused.as_str());
            row.resize(head.len(), Cell::number("–".into(), f64::INFINITY));
            table.rows.push(row);
            continue;
        }
        let (time, error) = (record.technique_ms, record.error);
        let milliseconds = |value: f64| Cell::number(digits(value), value);
        let share = |value: f64| Cell::number(percent(value), value);
        let broken = [error.nan, error.inf, error.negative];
        row.extend([
            milliseconds(time.p50),
            milliseconds(time.p95),
            milliseconds(time.max),
            ratio(over_yardstick(case, record)),
            milliseconds(record.ground_ms()),
            milliseconds(record.frame_ms.p50),
            share(error.rel_rmse),
            share(error.bias),
            share(error.p99),
            share(error.max),
            share(error.worst_tile),
            share(error.leak),
            milliseconds(error.flip),
            milliseconds(error.energy_ratio),
            Cell {
                strong: record.problem().is_some(),
                ..Cell::number(broken.map(|n| n.to_string()).join(", "), broken.map(f64::from).iter().sum())
            },
        ]);
        table.rows.push(row);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::example;
    use crate::record::{Spread, Study};
    use crate::report::YARDSTICK;
    use crate::report::sources::cases;

    fn preset(preset: &str, time: f64, error: f64) -> Record {
        Record { preset: preset.into(), ..example("biri-ss", time, error) }
    }

    #[test]
    fn a_default_dominates_or_does_not() {
        for (time, error, expected) in [
            (4.0, 0.01, Standing::Dominates),
            (4.0, 0.05, Standing::Dominates),
            (5.0, 0.05, Standing::Alike),
            (6.0, 0.01, Standing::Better),
            (4.0, 0.09, Standing::Faster),
            (6.0, 0.05, Standing::Dominated),
        ] {
            let records = [preset("paper", 5.0, 0.05), preset("default", time, error)];
            let pairs = pairs(&cases(&records)[0]);
            assert_eq!(pairs[0].standing(), expected, "{time} {error}");
        }
        // 5.5 ± 1 is no longer than 5: then less error is enough.
        let shaky =
            Record { technique_ms: Spread { p50: 5.5, p95: 7.5, max: 7.5 }, ..preset("default", 5.5, 0.01) };
        let records = [preset("paper", 5.0, 0.05), shaky];
        assert_eq!(super::pairs(&cases(&records)[0])[0].standing(), Standing::Dominates);
    }

    #[test]
    fn presets_are_held_against_floor_and_yardstick() {
        let mut records =
            vec![preset("paper", 5.0, 0.05), preset("default", 4.0, 0.01), example(YARDSTICK, 2.0, 0.1)];
        let table = presets(&cases(&records)[0]);
        assert_eq!((table.rows[1][3].key, table.rows[1][4].text.as_str()), (Some(2.0), "–"));
        assert_eq!(table.rows[1][8].text, "dominates the paper's");
        records.push(example(FLOOR, 0.5, 0.9));
        assert_eq!(presets(&cases(&records)[0]).rows[1][4].key, Some(8.0));
    }

    #[test]
    fn an_improvement_is_held_against_the_paper() {
        let improved =
            Record { study: Study::Improvements, label: "sorted".into(), ..example("biri-ss", 10.0, 0.01) };
        let records = [preset("paper", 5.0, 0.05), improved];
        let table = improvements(&cases(&records)[0]);
        assert_eq!((table.rows[0][3].text.as_str(), table.rows[0][5].text.as_str()), ("2.00", "0.200"));
        assert_eq!(everything(&cases(&records)[0]).rows.len(), 1);
    }
}
