//! Where the time goes, what it takes of memory, and what the model misses.

use crate::record::{Record, Spread};
use crate::report::sources::Case;
use crate::report::tables::{Cell, Table};
use crate::report::{digits, percent};

/// Timestamps that say less than this share of the wall time are suspect.
const LEAST_SHARE: f64 = 0.7;

fn is_preset(record: &&&Record) -> bool {
    record.refused.is_none() && (record.preset == "paper" || record.preset == "default")
}

/// Presets; of a technique without any, its setting in the middle.
fn chosen<'a>(case: &Case<'a>) -> Vec<&'a Record> {
    let mut chosen: Vec<&Record> = case.records.iter().filter(is_preset).copied().collect();
    for technique in case.techniques() {
        let of = case.records.iter().filter(|r| r.technique == technique && r.refused.is_none());
        let mut of: Vec<&Record> = of.copied().collect();
        of.sort_by(|a, b| a.technique_ms.p50.total_cmp(&b.technique_ms.p50));
        if !of.is_empty() && !of.iter().any(|record| is_preset(&record)) {
            chosen.push(of[of.len() / 2]);
        }
    }
    chosen
}

fn spread(time: Spread) -> [Cell; 3] {
    [time.p50, time.p95, time.max].map(|time| Cell::number(digits(time), time))
}

/// Time by pass, the CPU beside the device.
pub(crate) fn by_pass(case: &Case<'_>) -> Table {
    let mut table = Table::new(3, ["technique", "setting", "pass", "p50 ms", "p95 ms", "max ms"]);
    for record in chosen(case) {
        let name = record.technique.as_str();
        let mut add = |pass: &str, time: Spread, strong: bool| {
            let pass = Cell { strong, ..pass.into() };
            let head = [name.into(), case.setting(record).into(), pass];
            table.rows.push(head.into_iter().chain(spread(time)).collect());
        };
        for (pass, time) in &record.passes {
            add(pass, *time, false);
        }
        add("all its passes", record.technique_ms, true);
        add("CPU: prepare and encode", record.cpu_ms, false);
    }
    table
}

/// Timestamps against wall time, memory, worst tile.
pub(crate) fn health(case: &Case<'_>) -> Table {
    let head = [
        "technique",
        "setting",
        "timestamps ms",
        "wall ms",
        "ratio",
        "CPU ms",
        "GPU memory",
        "rel. RMSE",
        "worst 64×64 tile",
        "tile ÷ RMSE",
    ];
    let mut table = Table::new(2, head);
    for record in chosen(case) {
        let (stamps, wall) = (record.technique_ms.p50, record.technique_wall_ms.p50);
        let share = stamps / wall;
        let share = if record.technique_ms_from == "timestamps" && share.is_finite() {
            let suspect = share < LEAST_SHARE;
            let cell = Cell { strong: suspect, ..Cell::number(format!("{share:.2}"), share) };
            if suspect { cell.with("timestamps may say too little") } else { cell }
        } else {
            Cell::number("–".into(), f64::INFINITY).with("no timestamps")
        };
        let memory = record.gpu_bytes.map_or(Cell::number("–".into(), f64::INFINITY), |bytes| {
            Cell::number(format!("{} MiB", digits(bytes as f64 / f64::from(1 << 20))), bytes as f64)
        });
        let (rmse, tile) = (record.error.rel_rmse, record.error.worst_tile);
        let sure = rmse > record.reference.uncertainty;
        table.rows.push(vec![
            record.technique.as_str().into(),
            case.setting(record).into(),
            Cell::number(digits(stamps), stamps),
            Cell::number(digits(wall), wall),
            share,
            Cell::number(digits(record.cpu_ms.p50), record.cpu_ms.p50),
            memory,
            Cell::number(percent(rmse), rmse),
            Cell::number(percent(tile), tile),
            if sure {
                Cell::number(digits(tile / rmse), tile / rmse)
            } else {
                Cell::number("–".into(), f64::INFINITY)
            },
        ]);
    }
    table
}

/// Records with a model error, each technique's presets or all.
pub(crate) fn with_model_error<'a>(case: &Case<'a>) -> Vec<&'a Record> {
    let known = |record: &&Record| {
        record.model_error.as_ref().is_some_and(|model| model.rel_rmse.is_finite())
            && record.refused.is_none()
    };
    case.records.iter().copied().filter(known).collect()
}

/// What the implementation gets wrong of its terms, and what it misses of all light.
pub(crate) fn model_errors(case: &Case<'_>) -> Table {
    let head = [
        "technique",
        "setting",
        "its terms",
        "implementation: rel. RMSE",
        "bias",
        "all terms",
        "model: rel. RMSE",
        "bias ",
        "noise of the paths",
    ];
    let mut table = Table::new(2, head);
    for record in with_model_error(case) {
        let Some(model) = &record.model_error else { continue };
        let share = |value: f64| Cell::number(percent(value), value);
        table.rows.push(vec![
            record.technique.as_str().into(),
            case.setting(record).into(),
            record.terms.join(" + ").into(),
            share(record.error.rel_rmse),
            share(record.error.bias),
            model.terms.join(" + ").into(),
            share(model.rel_rmse),
            share(model.bias),
            share(model.noise),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::ModelError;
    use crate::record::tests::example;
    use crate::report::sources::cases;

    #[test]
    fn passes_and_the_processor_are_beside_each_other() {
        let records = [example("biri-ss", 2.0, 0.01), example("ray-march-64", 4.0, 0.1)];
        let table = by_pass(&cases(&records)[0]);
        let passes: Vec<&str> = table.rows.iter().map(|row| row[2].text.as_str()).collect();
        assert_eq!(passes[..3], ["a: draw", "all its passes", "CPU: prepare and encode"]);
        assert_eq!(passes.len(), 6);
    }

    #[test]
    fn timestamps_that_say_too_little_are_flagged() {
        let mut low = example("biri-ss", 2.0, 0.01);
        low.technique_wall_ms.p50 = 4.0;
        let records = [low, example("ray-march-64", 4.0, 0.1)];
        let table = health(&cases(&records)[0]);
        assert!(table.rows[0][4].strong && table.rows[0][4].small.contains("too little"));
        assert!(!table.rows[1][4].strong);
        assert_eq!(table.rows[1][6].text, "1.00 MiB");
    }

    #[test]
    fn a_model_error_is_shown_where_it_is_known() {
        let model = ModelError { terms: vec!["multiple".into()], rel_rmse: 0.4, bias: -0.3, noise: 0.01 };
        let records =
            [Record { model_error: Some(model), ..example("biri-ss", 2.0, 0.01) }, example("a", 1.0, 0.1)];
        let table = model_errors(&cases(&records)[0]);
        assert_eq!(table.rows.len(), 1);
        assert_eq!((table.rows[0][3].text.as_str(), table.rows[0][6].text.as_str()), ("1.00 %", "40.0 %"));
    }
}
