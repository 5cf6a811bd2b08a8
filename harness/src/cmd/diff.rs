//! `harness compare`: what changed from one run to another, beyond the noise.

use crate::cli;
use crate::failure::Failure;
use crate::record::Record;
use crate::report::sources::{Sources, once, tell_machines_apart};
use crate::report::{digits, markdown, percent, yardstick_of};

/// Errors that differ by less than this share are alike.
const ERROR_SHARE: f64 = 0.02;

/// What one measurement became.
#[derive(Clone, Debug, PartialEq)]
struct Change {
    what: String,
    /// New time over the old one, less 1; of the ratio to the yardstick between adapters.
    time: f64,
    faster: bool,
    slower: bool,
    errors: (f64, f64),
    better: bool,
    worse: bool,
}

/// A heading, and what comes under it.
type Group = (&'static str, fn(&Change) -> bool);

/// All that can be said of two runs.
#[derive(Clone, Debug, Default, PartialEq)]
struct Outcome {
    /// Two adapters, whose times are compared by their ratios to the yardstick.
    adapters: Option<(String, String)>,
    changes: Vec<Change>,
    new: Vec<String>,
    missing: Vec<String>,
    /// There in both, and can't be compared: why.
    apart: Vec<String>,
}

/// Compares; gives what to print, and fails where something got slower or worse.
pub(crate) fn run(arguments: &cli::Diff) -> Result<String, Failure> {
    let read = |folder| Sources::read(&[folder]);
    let (mut old, mut new) = (read(&arguments.old)?, read(&arguments.new)?);
    let mut both = [std::mem::take(&mut old.records), std::mem::take(&mut new.records)];
    tell_machines_apart(&mut both);
    [old.records, new.records] = both;
    let outcome = compare(&old.records, &new.records, arguments.threshold).map_err(Failure::Input)?;
    let notes: String = old.notes.iter().chain(&new.notes).map(|note| format!("note: {note}\n")).collect();
    let text = notes + &outcome.text(arguments.threshold);
    match outcome.regressions() {
        0 => Ok(text),
        count => {
            crate::print(&text);
            Err(Failure::Run(format!("{count} of {} got slower or worse", outcome.changes.len())))
        }
    }
}

fn compare(old: &[Record], new: &[Record], threshold: f64) -> Result<Outcome, String> {
    let from = once(old.iter().map(|record| record.adapter.as_str()));
    let to = once(new.iter().map(|record| record.adapter.as_str()));
    let shared = from.iter().any(|adapter| to.contains(adapter));
    let mut outcome = Outcome::default();
    if !shared {
        let ([from], [to]) = (from.as_slice(), to.as_slice()) else {
            return Err(format!("no adapter is in both runs: {} and {}", from.join(", "), to.join(", ")));
        };
        outcome.adapters = Some(((*from).to_owned(), (*to).to_owned()));
    }
    let same = |a: &Record, b: &Record| a.key() == b.key() && (!shared || a.adapter == b.adapter);
    for after in new {
        match old.iter().find(|before| same(before, after)) {
            None => outcome.new.push(name(after)),
            Some(before) => match change((before, old), (after, new), shared, threshold) {
                Ok(change) => outcome.changes.push(change),
                Err(why) => outcome.apart.push(format!("{}: {why}", name(after))),
            },
        }
    }
    let gone = old.iter().filter(|before| !new.iter().any(|after| same(before, after)));
    outcome.missing = gone.map(name).collect();
    if outcome.changes.is_empty() && outcome.apart.is_empty() {
        return Err("the two runs have no measurement in common".into());
    }
    Ok(outcome)
}

/// A measurement among those of its run, before and after.
fn change(
    (before, old): (&Record, &[Record]),
    (after, new): (&Record, &[Record]),
    shared: bool,
    threshold: f64,
) -> Result<Change, String> {
    let mut worse = false;
    match (&before.refused, &after.refused) {
        (None, None) => {}
        (Some(_), Some(_)) => return Err("refused in both".into()),
        (Some(_), None) => return Err("was refused, and is drawn now".into()),
        // What can no longer be drawn is a regression.
        (None, Some(why)) => {
            return Ok(Change {
                what: format!("{}: refused now: {why}", name(after)),
                time: f64::NAN,
                faster: false,
                slower: false,
                errors: (before.error.rel_rmse, f64::NAN),
                better: false,
                worse: true,
            });
        }
    }
    let (a, b) = (before.technique_ms, after.technique_ms);
    let half = |spread: crate::record::Spread| 0.5 * (spread.p95 - spread.p50).max(0.0);
    let (time, beyond) = if shared {
        (b.p50 / a.p50 - 1.0, (b.p50 - a.p50).abs() > half(a) + half(b))
    } else {
        let sticks = yardstick_of(before, old).zip(yardstick_of(after, new));
        let (x, y) =
            sticks.ok_or("other adapter, and no ray-march-64 of the same picture to compare it to")?;
        let (x, y) = (x.technique_ms, y.technique_ms);
        let ratio = (b.p50 / y.p50) / (a.p50 / x.p50) - 1.0;
        // Relative spreads of all four measurements.
        let noise: f64 = [a, b, x, y].map(|spread| half(spread) / spread.p50).iter().sum();
        (ratio, ratio.abs() > noise)
    };
    let (x, y) = (before.error.rel_rmse, after.error.rel_rmse);
    let sure = before.reference.uncertainty.max(after.reference.uncertainty);
    let apart = (y - x).abs() > (ERROR_SHARE * x).max(sure);
    worse |= apart && y > x || y.is_nan() && !x.is_nan();
    worse |= after.problem().is_some() && before.problem().is_none();
    Ok(Change {
        what: name(after),
        time,
        faster: beyond && time < -threshold,
        slower: beyond && time > threshold,
        errors: (x, y),
        better: apart && y < x,
        worse,
    })
}

fn name(record: &Record) -> String {
    let Record { scene, name, width, height, triangles, study, .. } = record;
    let maps = record.shadow_map_size().map_or(String::new(), |size| format!(", {size}² maps"));
    format!("{scene}, {name} ({}, {width}x{height}, {triangles} triangles{maps})", study.name())
}

impl Outcome {
    fn regressions(&self) -> usize {
        self.changes.iter().filter(|change| change.slower || change.worse).count()
    }

    fn text(&self, threshold: f64) -> String {
        let mut text = String::new();
        if let Some((from, to)) = &self.adapters {
            text += &format!(
                "different adapters: {from} and {to}; times are compared as ratios to ray-march-64 of the same run\n"
            );
        }
        let groups: [Group; 4] = [
            ("slower", |c| c.slower),
            ("worse", |c| c.worse),
            ("faster", |c| c.faster),
            ("better", |c| c.better),
        ];
        for (title, is) in groups {
            let of: Vec<&Change> = self.changes.iter().filter(|change| is(change)).collect();
            if of.is_empty() {
                continue;
            }
            let head = ["", "time", "rel. RMSE before", "after"].map(str::to_owned).to_vec();
            let row = |change: &&Change| {
                let sign = if change.time < 0.0 { "−" } else { "+" };
                let time = if change.time.is_nan() {
                    "–".into()
                } else {
                    format!("{sign}{}", percent(change.time.abs()))
                };
                vec![change.what.clone(), time, percent(change.errors.0), percent(change.errors.1)]
            };
            let rows: Vec<Vec<String>> = std::iter::once(head).chain(of.iter().map(row)).collect();
            text += &format!("\n{title}: {}\n\n{}", of.len(), markdown::table(&rows));
        }
        for (title, names) in [("new", &self.new), ("missing", &self.missing), ("not compared", &self.apart)]
        {
            if !names.is_empty() {
                text += &format!("\n{title}: {}\n", names.len());
                names.iter().for_each(|name| text += &format!("  {name}\n"));
            }
        }
        let still = |c: &&Change| !(c.slower || c.worse || c.faster || c.better);
        text + &format!(
            "\n{} compared, {} alike (times within both spreads or {}, errors within {} or the reference's uncertainty)\n",
            self.changes.len(),
            self.changes.iter().filter(still).count(),
            digits_percent(threshold),
            digits_percent(ERROR_SHARE),
        )
    }
}

fn digits_percent(share: f64) -> String {
    let text = digits(100.0 * share);
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Spread;
    use crate::record::tests::example;

    fn run(march: f64, planes: f64, error: f64) -> Vec<Record> {
        vec![example("ray-march-64", march, 0.08), example("biri-ss", planes, error)]
    }

    fn of<'a>(outcome: &'a Outcome, name: &str) -> &'a Change {
        outcome.changes.iter().find(|change| change.what.contains(name)).unwrap()
    }

    #[test]
    fn what_the_noise_allows_is_no_change() {
        let outcome = compare(&run(2.0, 5.0, 0.01), &run(2.05, 4.9, 0.0101), 0.05).unwrap();
        assert_eq!(outcome.regressions(), 0);
        assert!(outcome.text(0.05).contains("2 compared, 2 alike"), "{}", outcome.text(0.05));
        // Twice as long, but it scatters that much.
        let mut shaky = run(2.0, 10.0, 0.01);
        shaky[1].technique_ms = Spread { p50: 10.0, p95: 21.0, max: 21.0 };
        assert_eq!(compare(&run(2.0, 5.0, 0.01), &shaky, 0.05).unwrap().regressions(), 0);
    }

    #[test]
    fn slower_and_worse_are_regressions() {
        let before = run(2.0, 5.0, 0.01);
        let slower = compare(&before, &run(2.0, 6.0, 0.009), 0.05).unwrap();
        assert!(of(&slower, "biri").slower && of(&slower, "biri").better && slower.regressions() == 1);
        let worse = compare(&before, &run(1.0, 5.0, 0.011), 0.05).unwrap();
        assert!(of(&worse, "biri").worse && of(&worse, "march").faster && worse.regressions() == 1);
        assert_eq!(compare(&before, &run(2.0, 6.0, 0.01), 0.5).unwrap().regressions(), 0, "threshold");
        // Below the reference's uncertainty no error is worse than another.
        assert_eq!(compare(&run(2.0, 5.0, 1e-6), &run(2.0, 5.0, 5e-5), 0.05).unwrap().regressions(), 0);
        let lost = [before[0].clone(), Record { refused: Some("no".into()), ..before[1].clone() }];
        assert_eq!(compare(&before, &lost, 0.05).unwrap().regressions(), 1);
        let broken = compare(&before, &run(2.0, 5.0, f64::NAN), 0.05).unwrap();
        assert_eq!(broken.regressions(), 1);
    }

    #[test]
    fn between_adapters_ratios_are_compared() {
        let elsewhere = |records: Vec<Record>| -> Vec<Record> {
            records.into_iter().map(|r| Record { adapter: "a card".into(), ..r }).collect()
        };
        // Everything ten times as fast is no change.
        let outcome = compare(&run(2.0, 5.0, 0.01), &elsewhere(run(0.2, 0.5, 0.01)), 0.05).unwrap();
        assert_eq!(outcome.regressions(), 0);
        assert!(outcome.text(0.05).contains("different adapters"));
        let outcome = compare(&run(2.0, 5.0, 0.01), &elsewhere(run(0.2, 0.6, 0.01)), 0.05).unwrap();
        assert!(of(&outcome, "biri").slower);
        // A yardstick that scatters by half makes nothing slower.
        let mut shaky = elsewhere(run(0.2, 0.6, 0.01));
        shaky[0].technique_ms.p95 = 0.4;
        assert_eq!(compare(&run(2.0, 5.0, 0.01), &shaky, 0.05).unwrap().regressions(), 0);
        assert_eq!([1.0, 0.05, 2.0].map(digits_percent), ["100 %", "5 %", "200 %"]);
        // Without a yardstick there is nothing to say.
        let outcome =
            compare(&run(2.0, 5.0, 0.01), &elsewhere(run(0.2, 0.5, 0.01)[1..].to_vec()), 0.05).unwrap();
        assert_eq!((outcome.changes.len(), outcome.apart.len(), outcome.missing.len()), (0, 1, 1));
    }

    #[test]
    fn what_is_in_one_alone_is_named() {
        let before = run(2.0, 5.0, 0.01);
        let after = [before[0].clone(), example("chen-planes", 1.0, 0.1)];
        let outcome = compare(&before, &after, 0.05).unwrap();
        assert!(outcome.new[0].contains("chen-planes") && outcome.missing[0].contains("biri-ss"));
        assert!(compare(&before[..1], &after[1..], 0.05).unwrap_err().contains("no measurement in common"));
    }
}
