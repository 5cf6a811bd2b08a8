//! How techniques are told apart, by colour, shape and line alike: without colour, and in print, too.

use plotters::prelude::*;

use crate::record::Record;
use crate::report::sources::once;

/// Colours that people with any kind of colour vision can tell apart (Okabe and Ito 2008); black is drawn in the
/// page's own ink.
pub(crate) const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

/// Corners of the marks about their middle \[SVG pixels\].
const SHAPES: [&[(i32, i32)]; 8] = [
    &[(5, 2), (2, 5), (-2, 5), (-5, 2), (-5, -2), (-2, -5), (2, -5), (5, -2)],
    &[(-5, -5), (5, -5), (5, 5), (-5, 5)],
    &[(0, -7), (7, 0), (0, 7), (-7, 0)],
    &[(0, -7), (6, 5), (-6, 5)],
    &[(0, 7), (6, -5), (-6, -5)],
    &[
        (-2, -6),
        (2, -6),
        (2, -2),
        (6, -2),
        (6, 2),
        (2, 2),
        (2, 6),
        (-2, 6),
        (-2, 2),
        (-6, 2),
        (-6, -2),
        (-2, -2),
    ],
    &[(-7, -3), (7, -3), (7, 3), (-7, 3)],
    &[(-6, -6), (0, -3), (6, -6), (3, 0), (6, 6), (0, 3), (-6, 6), (-3, 0)],
];

/// Lengths of dashes and gaps of the peers' lines; the techniques' are solid.
const DASHES: [(i32, i32); 4] = [(8, 4), (2, 4), (14, 5), (5, 9)];

/// How one technique is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Look {
    pub colour: RGBColor,
    pub shape: &'static [(i32, i32)],
    pub dash: Option<(i32, i32)>,
}

/// The looks of all techniques of a report: the same one in all its charts.
#[derive(Clone, Debug)]
pub(crate) struct Looks<'a> {
    names: Vec<&'a str>,
    /// How many of them are no peers.
    own: usize,
}

impl<'a> Looks<'a> {
    /// Of all techniques that records name.
    pub(crate) fn of(records: &'a [Record]) -> Self {
        let names = |peer: bool| records.iter().filter(move |r| r.peer == peer).map(|r| r.technique.as_str());
        let own = once(names(false)).len();
        Self { names: once(names(false).chain(names(true))), own }
    }

    /// Of these, of which the first `own` are no peers.
    pub(crate) fn named(names: &[&'a str], own: usize) -> Self {
        Self { names: names.to_vec(), own }
    }

    /// Of one technique.
    pub(crate) fn get(&self, technique: &str) -> Look {
        let index = self.names.iter().position(|name| *name == technique).unwrap_or(0);
        Look {
            colour: COLOURS[index % COLOURS.len()],
            shape: SHAPES[index % SHAPES.len()],
            dash: index.checked_sub(self.own).map(|peer| DASHES[peer % DASHES.len()]),
        }
    }
}

/// Where a logarithmic axis has its lines: 1, 2 and 5 times a power of ten, or only the powers where
/// there are many.
pub(crate) fn marks(range: (f64, f64)) -> Vec<f64> {
    marks_beyond(range, 1e4)
}

/// The same with only the powers in ranges beyond `most` times their start.
pub(crate) fn marks_beyond((low, high): (f64, f64), most: f64) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let steps: &[f64] = if high / low > most { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let all = decades.flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
    all.filter(|mark| (low..=high).contains(mark)).collect()
}

/// Short form of a number on a logarithmic axis.
pub(crate) fn number(value: f64) -> String {
    if (0.001..1_000_000.0).contains(&value) {
        let text = format!("{value:.4}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{value:.0e}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::example;

    #[test]
    fn no_two_of_a_dozen_look_alike_and_peers_are_dashed() {
        let names: Vec<String> = (0..12).map(|index| format!("{}", char::from(b'a' + index))).collect();
        let records: Vec<Record> = names
            .iter()
            .map(|name| Record { peer: name.as_str() > "d", ..example(name, 1.0, 0.1) })
            .collect();
        let looks = Looks::of(&records);
        let all: Vec<Look> = names.iter().map(|name| looks.get(name)).collect();
        for (index, look) in all.iter().enumerate() {
            assert_eq!(look.dash.is_some(), index > 3);
            assert!(all[..index].iter().all(|other| other != look), "{index}");
        }
    }

    #[test]
    fn an_axis_has_a_few_round_marks() {
        assert_eq!(marks((30.0, 700.0)), [50.0, 100.0, 200.0, 500.0]);
        assert_eq!(marks((0.5, 90_000.0)).len(), 5);
        assert_eq!([0.01, 0.5, 20.0, 1e-7].map(number), ["0.01", "0.5", "20", "1e-7"]);
    }
}
