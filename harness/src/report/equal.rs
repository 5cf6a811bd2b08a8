//! Techniques at equal error and at equal time, and who wins.

use crate::report::frontier::{Point, best, cheapest};
use crate::report::law::{Law, Reach};
use crate::report::sources::Case;
use crate::report::tables::{Cell, Table};
use crate::report::{FLOOR, UNIFORM, digits, percent};

/// Errors that are asked for: relative RMSE of the airlight.
pub(crate) const BOUNDS: [f64; 5] = [0.05, 0.02, 0.01, 0.005, 0.001];

/// Numbers of uniform steps whose time others are given.
const BUDGETS: [u64; 3] = [16, 64, 256];

/// A technique with all its settings.
#[derive(Clone, Debug)]
pub(crate) struct Curve<'a> {
    pub technique: &'a str,
    pub peer: bool,
    pub points: Vec<Point<'a>>,
    /// Of uniform marching alone.
    law: Option<Law>,
}

/// What an error costs.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Cost<'a> {
    Measured(Point<'a>),
    /// Steps, and the time that the law gives them \[ms\].
    Extrapolated(f64, f64),
    /// The error does not fall below this, however many steps.
    Never(f64),
    /// No setting that was measured is under it; the least error.
    NotMeasured(f64),
}

impl Cost<'_> {
    /// \[ms\]
    pub(crate) fn time(&self) -> Option<f64> {
        match self {
            Self::Measured(point) => Some(point.time),
            Self::Extrapolated(_, time) => Some(*time),
            Self::Never(_) | Self::NotMeasured(_) => None,
        }
    }
}

impl<'a> Curve<'a> {
    /// All that have a point, but for the one that leaves the shadows out.
    pub(crate) fn all(case: &Case<'a>) -> Vec<Self> {
        let names = case.techniques().into_iter().filter(|name| *name != FLOOR);
        let curves = names.filter_map(|name| {
            let of = case.records.iter().copied().filter(|record| record.technique == name);
            let points: Vec<Point<'a>> = of.filter_map(Point::of).collect();
            let first = points.first()?.record;
            // A law holds for one size of shadow maps: the one of most settings.
            let on = |size| points.iter().filter(move |point| point.record.shadow_map_size() == size);
            let sizes = points.iter().map(|point| point.record.shadow_map_size());
            let usual = sizes.max_by_key(|size| (on(*size).count(), *size)).flatten();
            let alike: Vec<Point<'_>> = on(usual).copied().collect();
            let law = if name == UNIFORM { Law::of(&alike) } else { None };
            Some(Self { technique: &first.technique, peer: first.peer, points, law })
        });
        curves.collect()
    }

    /// The cheapest way to an error of at most `bound`.
    pub(crate) fn cost(&self, bound: f64) -> Cost<'a> {
        let least = self.points.iter().map(|point| point.error).fold(f64::INFINITY, f64::min);
        if let Some(point) = cheapest(&self.points, bound) {
            return Cost::Measured(point);
        }
        match self.law.map(|law| law.reach(bound)) {
            Some(Reach::Steps(steps, time)) => Cost::Extrapolated(steps, time),
            Some(Reach::Never(floor)) => Cost::Never(floor),
            None => Cost::NotMeasured(least),
        }
    }

    /// By which power of the number of steps the error falls, of uniform marching.
    pub(crate) fn order(&self) -> Option<f64> {
        Some(self.law?.order())
    }
}

/// The peer that is cheapest under `bound`, and its time \[ms\].
fn best_peer<'b, 'a>(curves: &'b [Curve<'a>], bound: f64) -> Option<(&'b Curve<'a>, f64)> {
    let peers = curves.iter().filter(|curve| curve.peer);
    let reached = peers.filter_map(|curve| Some((curve, curve.cost(bound).time()?)));
    reached.min_by(|a, b| a.1.total_cmp(&b.1))
}

fn uniform_time(curves: &[Curve<'_>], bound: f64) -> Option<f64> {
    curves.iter().find(|curve| curve.technique == UNIFORM)?.cost(bound).time()
}

/// A time in few words, with what it is to the best peer and to uniform marching.
fn cost_cell(case: &Case<'_>, curves: &[Curve<'_>], curve: &Curve<'_>, bound: f64) -> Cell {
    let cost = curve.cost(bound);
    let (setting, mark) = match cost {
        Cost::Measured(point) => (case.setting(point.record), ""),
        Cost::Extrapolated(steps, _) => (format!("extrapolated, {steps:.0} steps"), "≈ "),
        Cost::Never(floor) => {
            return Cell::number("never".into(), f64::INFINITY).with(format!("floor {}", percent(floor)));
        }
        Cost::NotMeasured(least) => {
            return Cell::number("–".into(), f64::INFINITY).with(format!("at best {}", percent(least)));
        }
    };
    let time = cost.time().unwrap_or(f64::INFINITY);
    let milliseconds = format!("{mark}{} ms", digits(time));
    let mut notes = vec![setting];
    let to_uniform =
        uniform_time(curves, bound).map(|uniform| format!("{} × marching", digits(time / uniform)));
    if let Some((peer, best)) = best_peer(curves, bound)
        && peer.technique != curve.technique
    {
        notes.push(format!("{} × best peer", digits(time / best)));
    }
    let cheapest = curves.iter().filter_map(|curve| curve.cost(bound).time()).fold(f64::INFINITY, f64::min);
    // Absolute times of a software adapter mean little: the ratio first.
    let text = match to_uniform.filter(|_| curve.technique != UNIFORM) {
        Some(ratio) if case.first.software => {
            notes.insert(0, milliseconds);
            ratio
        }
        Some(ratio) => {
            notes.push(ratio);
            milliseconds
        }
        None => milliseconds,
    };
    Cell { strong: time <= cheapest, ..Cell::number(text, time).with(notes.join("; ")) }
}

/// The cheapest setting of everyone under each error.
pub(crate) fn equal_error(case: &Case<'_>) -> Table {
    let curves = Curve::all(case);
    let mut table = Table::new(
        1,
        std::iter::once("technique".to_owned()).chain(BOUNDS.map(|bound| format!("under {}", plain(bound)))),
    );
    for curve in &curves {
        let cells = BOUNDS.map(|bound| cost_cell(case, &curves, curve, bound));
        table.rows.push(std::iter::once(name_cell(curve)).chain(cells).collect());
    }
    table
}

/// The best setting of everyone within the time of some uniform steps.
pub(crate) fn equal_time(case: &Case<'_>) -> Table {
    let curves = Curve::all(case);
    let budget = |steps: u64| {
        let marches =
            curves.iter().filter(|curve| curve.technique == UNIFORM).flat_map(|curve| &curve.points);
        let of = marches.filter(|p| p.record.settings.get("steps").and_then(|s| s.as_u64()) == Some(steps));
        of.min_by(|a, b| a.time.total_cmp(&b.time)).map(|point| (steps, point.time + point.spread))
    };
    let budgets: Vec<(u64, f64)> = BUDGETS.into_iter().filter_map(budget).collect();
    let heads = budgets.iter().map(|(steps, time)| format!("within {steps} steps ({} ms)", digits(*time)));
    let mut table = Table::new(1, std::iter::once("technique".to_owned()).chain(heads));
    if budgets.is_empty() {
        return table;
    }
    for curve in &curves {
        let cells = budgets.iter().map(|(_, time)| match best(&curve.points, *time) {
            Some(point) => {
                let least =
                    curves.iter().filter_map(|other| best(&other.points, *time)).map(|other| other.error);
                let text = format!("{}{}", if point.bound { "≤ " } else { "" }, percent(point.error));
                let strong = point.error <= least.fold(f64::INFINITY, f64::min);
                let small = format!("{}; {} ms", case.setting(point.record), digits(point.time));
                Cell { strong, ..Cell::number(text, point.error).with(small) }
            }
            None => {
                let fastest = curve.points.iter().map(|point| point.time).fold(f64::INFINITY, f64::min);
                let small = format!("at least {} ms", digits(fastest));
                Cell::number("–".into(), f64::INFINITY).with(small)
            }
        });
        table.rows.push(std::iter::once(name_cell(curve)).chain(cells).collect());
    }
    table
}

fn name_cell(curve: &Curve<'_>) -> Cell {
    let cell = Cell::from(curve.technique);
    if curve.peer { cell.with("peer") } else { cell }
}

/// Who is cheapest under an error.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Winner {
    pub bound: String,
    pub who: String,
    pub how: String,
}

/// One sentence for each error, peers included.
pub(crate) fn winners(case: &Case<'_>) -> Vec<Winner> {
    let curves = Curve::all(case);
    if curves.is_empty() {
        return Vec::new();
    }
    let mut winners: Vec<Winner> = Vec::new();
    for winner in BOUNDS.map(|bound| winner(case, &curves, bound)) {
        match winners.last_mut() {
            // The same answer to several bounds is given once.
            Some(last) if (&last.who, &last.how) == (&winner.who, &winner.how) => {
                last.bound += &format!(", {}", winner.bound);
            }
            _ => winners.push(winner),
        }
    }
    winners
}

/// The cheapest setting under `bound` that was measured.
fn measured<'a>(curve: &Curve<'a>, bound: f64) -> Option<Point<'a>> {
    match curve.cost(bound) {
        Cost::Measured(point) => Some(point),
        _ => None,
    }
}

fn winner(case: &Case<'_>, curves: &[Curve<'_>], bound: f64) -> Winner {
    let measured = |curve: &_| measured(curve, bound);
    let text = plain(bound);
    let in_time = |point: &Point<'_>| format!("{} in {} ms", case.setting(point.record), digits(point.time));
    let reached = curves.iter().filter_map(|curve| Some((curve, measured(curve)?)));
    let Some((curve, point)) = reached.min_by(|a, b| a.1.time.total_cmp(&b.1.time)) else {
        let all = curves.iter().flat_map(|curve| &curve.points);
        let least = all.min_by(|a, b| a.error.total_cmp(&b.error));
        let how = least.map_or(String::new(), |point| {
            let Point { record, error, .. } = point;
            format!(
                "of those measured; the best is {} ({}) at {}",
                record.technique,
                case.setting(record),
                percent(*error)
            )
        });
        return Winner { bound: text, who: "None".into(), how };
    };
    let mut how = format!("({})", in_time(&point));
    let tied: Vec<&str> = curves
        .iter()
        .filter(|other| other.technique != curve.technique)
        .filter(|other| measured(other).is_some_and(|other| other.takes_as_long(&point)))
        .map(|other| other.technique)
        .collect();
    if !tied.is_empty() {
        how += &format!(", within the spread as fast: {}", tied.join(", "));
    }
    if curve.peer {
        let others = curves.iter().filter(|other| !other.peer);
        let next = others.filter_map(|other| Some((other, measured(other)?)));
        how += &match next.min_by(|a, b| a.1.time.total_cmp(&b.1.time)) {
            Some((other, cost)) => format!(
                ", a peer; the cheapest of the papers' techniques, {} ({}), takes {} times as long",
                other.technique,
                case.setting(cost.record),
                digits(cost.time / point.time)
            ),
            None => ", a peer; none of the papers' techniques gets there".into(),
        };
    } else {
        how += &match best_peer(curves, bound) {
            Some((peer, time)) => {
                let sure = if measured(peer).is_some() { "" } else { ", extrapolated" };
                format!(
                    ": {} of the time of the best peer, {} ({} ms{sure})",
                    digits(point.time / time),
                    peer.technique,
                    digits(time)
                )
            }
            None => "; no peer gets there".into(),
        };
    }
    Winner { bound: text, who: curve.technique.into(), how }
}

/// 0.005 as `0.5 %`.
fn plain(bound: f64) -> String {
    format!("{} %", 100.0 * bound)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Record;
    use crate::record::tests::example;
    use crate::report::sources::cases;

    fn march(steps: u32, error: f64) -> Record {
        let mut record = example(&format!("ray-march-{steps}"), 0.1 * f64::from(steps), error);
        record.settings.insert("steps".into(), steps.into());
        record.label = format!("{steps} steps");
        record
    }

    fn records() -> Vec<Record> {
        let marches = [8, 16, 32, 64, 128].map(|n| march(n, 1.28 / f64::from(n)));
        let froxels = Record { peer: true, label: "coarse".into(), ..example("froxels", 3.0, 0.04) };
        let bare = Record { peer: true, ..example("unshadowed", 0.1, 0.9) };
        let best = Record { label: "default".into(), ..example("billeter-plv", 4.0, 0.008) };
        marches.into_iter().chain([froxels, bare, best]).collect()
    }

    fn row<'a>(table: &'a Table, name: &str) -> &'a [Cell] {
        table.rows.iter().find(|row| row[0].text == name).unwrap()
    }

    #[test]
    fn equal_error_says_what_each_takes() {
        let records = records();
        let table = equal_error(&cases(&records)[0]);
        assert_eq!(table.rows.len(), 3, "the floor is no competitor");
        // 5 %: marching takes 32 steps (3.2 ms), froxels 3 ms, volumes 4 ms.
        let cells = row(&table, "billeter-plv");
        assert_eq!(cells[1].text, "1.25 × marching", "{cells:?}");
        assert!(
            cells[1].small.contains("4.00 ms") && cells[1].small.contains("1.33 × best peer"),
            "{cells:?}"
        );
        assert!(row(&table, "froxels")[1].strong && !cells[1].strong);
        // 0.5 %: nobody measured; marching by its law takes 256 steps.
        let marching = row(&table, "ray-march");
        assert!(marching[4].text.starts_with("≈ 25.6"), "{marching:?}");
        assert!(marching[4].small.contains("extrapolated, 256 steps"), "{marching:?}");
        assert_eq!((cells[4].text.as_str(), cells[4].small.as_str()), ("–", "at best 0.800 %"));
    }

    #[test]
    fn a_hardware_adapter_leads_with_milliseconds() {
        let records: Vec<Record> = records().into_iter().map(|r| Record { software: false, ..r }).collect();
        let table = equal_error(&cases(&records)[0]);
        assert_eq!(row(&table, "billeter-plv")[1].text, "4.00 ms");
    }

    #[test]
    fn equal_time_says_how_right_each_gets() {
        let records = records();
        let table = equal_time(&cases(&records)[0]);
        // No 256 steps were measured.
        assert_eq!(table.head.len(), 3, "{:?}", table.head);
        let froxels = row(&table, "froxels");
        assert_eq!((froxels[1].text.as_str(), froxels[2].text.as_str()), ("–", "4.00 %"));
        assert!(row(&table, "billeter-plv")[2].strong);
    }

    #[test]
    fn the_winner_is_named_with_what_it_beats() {
        let records = records();
        let sentences = winners(&cases(&records)[0]);
        assert_eq!((sentences[0].bound.as_str(), sentences[0].who.as_str()), ("5 %", "froxels"));
        assert!(!sentences[0].how.contains("within the spread"), "{:?}", sentences[0]);
        assert!(
            sentences[0].how.contains("billeter-plv (default), takes 1.33 times as long"),
            "{:?}",
            sentences[0]
        );
        assert_eq!(sentences[2].who, "billeter-plv");
        assert!(
            sentences[2].how.contains("0.312 of the time of the best peer, ray-march (12.8 ms)"),
            "{:?}",
            sentences[2]
        );
        // The same answer to both is given once.
        let last = sentences.last().unwrap();
        assert_eq!((last.bound.as_str(), last.who.as_str()), ("0.5 %, 0.1 %", "None"));
        assert!(last.how.contains("0.800 %"), "{last:?}");
    }
}
