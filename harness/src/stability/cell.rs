//! A measurement of the atlas, as it is kept.

use serde::{Deserialize, Serialize};

use crate::machine::Machine;

/// Version of [`Cell`]'s fields.
pub(crate) const SCHEMA: u32 = 1;

/// One method at one value of a row's parameter.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Cell {
    pub schema: u32,
    /// The row.
    pub row: String,
    /// The column: technique and setting, or the peer.
    pub column: String,
    /// Value of the parameter, in its unit; the index of a choice.
    pub value: f64,
    /// The same in words.
    pub label: String,
    /// What `figure` is.
    pub measure: String,
    /// The measured figure; `null` where it is infinite, or what is right is not known.
    pub figure: Option<f64>,
    /// Whether the figure is infinite.
    pub infinite: bool,
    /// What is promised: `figure` is at most this, or the method refuses or warns. `null` where nothing is.
    pub bound: Option<f64>,
    /// Relative mean signed error.
    pub bias: Option<f64>,
    /// Sum of the picture over that of the reference.
    pub energy_ratio: Option<f64>,
    /// Pixels that are NaN, infinite or negative, in all frames together.
    pub broken: u32,
    /// Why it was not drawn, in the method's words.
    pub refused: Option<String>,
    /// Panic, or what the device complained about.
    pub fault: Option<String>,
    /// What the method warned of.
    pub warnings: Vec<String>,
    /// File with picture, reference and error side by side, if it is the row's worst.
    pub picture: Option<String>,
    pub adapter: String,
    pub driver: String,
    pub software: bool,
    pub machine: Machine,
    pub commit: String,
    pub date: String,
}

/// What is to be said of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Within the bound, or nothing is promised.
    Kept,
    /// Refused or warned about.
    Told,
    /// Beyond the bound without a word.
    Silent,
    /// No radiance, a panic, or an error of the device.
    Broken,
}

impl Cell {
    /// The figure, infinity included; NaN where there is none.
    pub(crate) fn figure(&self) -> f64 {
        if self.infinite { f64::INFINITY } else { self.figure.unwrap_or(f64::NAN) }
    }

    pub(crate) fn told(&self) -> bool {
        self.refused.is_some() || !self.warnings.is_empty()
    }

    pub(crate) fn verdict(&self) -> Verdict {
        if self.broken > 0 || self.fault.is_some() {
            Verdict::Broken
        } else if self.told() {
            Verdict::Told
        } else if self.bound.is_some_and(|bound| self.figure() > bound) {
            Verdict::Silent
        } else {
            Verdict::Kept
        }
    }

    /// What is wrong, if anything: a clause behind row, column and value.
    pub(crate) fn problem(&self) -> Option<String> {
        match self.verdict() {
            Verdict::Kept | Verdict::Told => None,
            Verdict::Silent => Some(format!(
                "{} is {}, above {}, without a warning",
                self.measure,
                super::page::amount(&self.measure, self.figure()),
                super::page::amount(&self.measure, self.bound.unwrap_or(0.0))
            )),
            Verdict::Broken => Some(match &self.fault {
                Some(fault) => fault.clone(),
                None => format!("{} pixels are NaN, infinite or negative", self.broken),
            }),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A measurement within its bound.
    pub(in crate::stability) fn example(row: &str, column: &str, value: f64, figure: f64) -> Cell {
        Cell {
            schema: SCHEMA,
            row: row.into(),
            column: column.into(),
            value,
            label: format!("{value}"),
            measure: "relative RMSE".into(),
            figure: Some(figure),
            infinite: false,
            bound: Some(0.02),
            bias: Some(0.0),
            energy_ratio: Some(1.0),
            broken: 0,
            refused: None,
            fault: None,
            warnings: Vec::new(),
            picture: None,
            adapter: "adapter".into(),
            driver: "driver".into(),
            software: true,
            machine: Machine { cpu: "cpu".into(), cores: 2, os: "os".into() },
            commit: "commit".into(),
            date: "2000-01-01T00:00:00Z".into(),
        }
    }

    #[test]
    fn what_is_beyond_its_bound_has_to_be_told_and_nothing_may_be_broken() {
        let kept = example("row", "column", 1.0, 0.01);
        assert_eq!((kept.verdict(), kept.problem()), (Verdict::Kept, None));
        let silent = Cell { figure: Some(0.03), ..kept.clone() };
        assert_eq!(silent.verdict(), Verdict::Silent);
        assert!(silent.problem().unwrap().contains("3.00 %, above 2.00 %"), "{:?}", silent.problem());
        let infinite = Cell { figure: None, infinite: true, ..kept.clone() };
        assert_eq!(infinite.verdict(), Verdict::Silent);
        let warned = Cell { warnings: vec!["too far".into()], ..silent.clone() };
        assert_eq!((warned.verdict(), warned.problem()), (Verdict::Told, None));
        // No word makes up for a pixel that is no radiance.
        let broken = Cell { broken: 1, ..warned };
        assert_eq!(broken.verdict(), Verdict::Broken);
        assert_eq!(Cell { bound: None, ..silent }.verdict(), Verdict::Kept);
        let panicked = Cell { fault: Some("panicked".into()), ..kept };
        assert_eq!(panicked.problem().as_deref(), Some("panicked"));
    }

    #[test]
    fn a_measurement_reads_as_it_was_written() {
        let cell = example("row", "column", 1e-6, 0.1 + 0.2);
        let text = serde_json::to_string(&cell).unwrap();
        let read: Cell = serde_json::from_str(&text).unwrap();
        assert_eq!((read.value, read.figure, read.bound), (cell.value, cell.figure, cell.bound));
    }
}
