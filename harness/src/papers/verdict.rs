//! Whether a paper's claim holds, and how much longer one thing takes than another.

use std::ops::RangeInclusive;

use serde::Serialize;

use crate::record::Spread;
use crate::report::percent;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Verdict {
    Holds,
    DoesNotHold,
    CannotTell,
    NotTested,
}

impl Verdict {
    pub(super) const fn text(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::DoesNotHold => "does not hold",
            Self::CannotTell => "cannot be told here: the times scatter too much",
            Self::NotTested => "cannot be tested here",
        }
    }

    /// Whether a growth of times is at most `most`, by all of the middle half of the rounds.
    pub(super) fn of_growth(Growth { median, apart }: Growth, most: f64) -> Self {
        match () {
            () if median + 0.5 * apart <= most => Self::Holds,
            () if median - 0.5 * apart > most => Self::DoesNotHold,
            () => Self::CannotTell,
        }
    }

    /// Whether a growth of times is in `range`, by all of the middle half of the rounds.
    pub(super) fn of_change(Growth { median, apart }: Growth, range: RangeInclusive<f64>) -> Self {
        let (low, high) = (median - 0.5 * apart, median + 0.5 * apart);
        match () {
            () if range.contains(&low) && range.contains(&high) => Self::Holds,
            () if high < *range.start() || low > *range.end() => Self::DoesNotHold,
            () => Self::CannotTell,
        }
    }
}

impl From<bool> for Verdict {
    fn from(holds: bool) -> Self {
        if holds { Self::Holds } else { Self::DoesNotHold }
    }
}

/// By how much a time is larger than another one: the median over rounds, in each of which the machine was alike
/// to both; and how far the middle half of the rounds is apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Growth {
    pub median: f64,
    pub apart: f64,
}

impl Growth {
    pub(super) fn of(from: &[f64], to: &[f64]) -> Self {
        let mut ratios: Vec<f64> = from.iter().zip(to).map(|(from, to)| to / from).collect();
        ratios.sort_by(f64::total_cmp);
        let quarter = ratios.len() / 4;
        let apart = match (ratios.get(quarter), ratios.iter().rev().nth(quarter)) {
            (Some(low), Some(high)) => high - low,
            _ => 0.0,
        };
        Self { median: Spread::of(&ratios).p50 - 1.0, apart }
    }
}

/// With its sign.
pub(super) fn signed(share: f64) -> String {
    format!("{}{}", if share < 0.0 { "−" } else { "+" }, percent(share.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_round_is_no_growth() {
        let growth = Growth::of(&[100.0, 300.0, 100.0], &[110.0, 330.0, 111.0]);
        assert_eq!(
            Growth::of(&[1.0, 1.0, 1.0, 1.0], &[9.0, 2.0, 2.0, 1.0]),
            Growth { median: 1.0, apart: 0.0 }
        );
        assert!((growth.median - 0.1).abs() < 1e-12 && (growth.apart - 0.01).abs() < 1e-12, "{growth:?}");
    }

    #[test]
    fn a_growth_within_the_scatter_is_no_verdict() {
        let of = |median, apart| Verdict::of_growth(Growth { median, apart }, 0.1);
        assert_eq!(
            [of(-0.1, 0.3), of(0.1, 0.0), of(0.2, 0.1), of(0.05, 0.2), of(0.2, 0.3)],
            [Verdict::Holds, Verdict::Holds, Verdict::DoesNotHold, Verdict::CannotTell, Verdict::CannotTell]
        );
        let of = |median, apart| Verdict::of_change(Growth { median, apart }, 0.75..=1.25);
        assert_eq!(
            [of(1.0, 0.4), of(1.0, 1.2), of(0.2, 0.4), of(1.3, 0.0)],
            [Verdict::Holds, Verdict::CannotTell, Verdict::DoesNotHold, Verdict::DoesNotHold]
        );
    }
}
