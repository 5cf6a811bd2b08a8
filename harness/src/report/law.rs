//! What a march of more steps than were measured would take: a law through its own points.

use crate::fit::Fit;
use crate::report::frontier::Point;

/// An error that falls by a lower power of the number of steps is at its floor: by less than 15 % where they double.
const FALLS: f64 = 0.234;

/// Error and time of a march over its number of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Law {
    /// Logarithm of the error over that of the steps, where it still falls.
    error: Fit,
    /// Time over steps \[ms\].
    time: Fit,
    /// Most steps of those that it was found by, their error, and their time \[ms\]: beyond lies what was not measured.
    last: (f64, f64, f64),
    /// Where the error stops falling, if that was measured.
    floor: Option<f64>,
}

/// What a law says of an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reach {
    /// So many steps, in so many milliseconds.
    Steps(f64, f64),
    /// The floor lies above.
    Never(f64),
}

impl Law {
    /// Through the points of one march, at least three of them with a falling error.
    pub(crate) fn of(points: &[Point<'_>]) -> Option<Self> {
        let steps = |point: &Point<'_>| point.record.settings.get("steps")?.as_f64();
        let mut measured: Vec<(f64, &Point<'_>)> =
            points.iter().filter_map(|point| Some((steps(point)?, point))).collect();
        measured.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.error.total_cmp(&b.1.error)));
        // One of each number of steps.
        measured.dedup_by(|later, first| later.0 == first.0);
        // The first counts of steps may all miss the light, each in its own way: the law starts at the worst.
        let worst =
            (0..measured.len()).max_by(|a, b| measured[*a].1.error.total_cmp(&measured[*b].1.error))?;
        let measured = &measured[worst..];
        let falls = |two: &&[(f64, &Point<'_>)]| {
            (two[0].1.error / two[1].1.error).ln() > FALLS * (two[1].0 / two[0].0).ln()
        };
        let falling = 1 + measured.windows(2).take_while(falls).count();
        if falling < 3 {
            return None;
        }
        let floor = measured[falling..].iter().map(|(_, point)| point.error).reduce(f64::min);
        let errors: Vec<_> = measured[..falling].iter().map(|(n, point)| (*n, point.error)).collect();
        let times: Vec<_> = measured.iter().map(|(n, point)| (*n, point.time)).collect();
        let (error, time) = (Fit::power(&errors)?, Fit::line(&times)?);
        let (steps, point) = measured[falling - 1];
        let last = (steps, point.error, point.time);
        (error.slope < 0.0 && time.slope > 0.0).then_some(Self { error, time, last, floor })
    }

    /// How many steps an error of at most `bound` takes, from the last measurement on: a line through all of them may lie
    /// below it.
    pub(crate) fn reach(&self, bound: f64) -> Reach {
        if let Some(floor) = self.floor.filter(|floor| *floor > bound) {
            return Reach::Never(floor);
        }
        let (last, error, time) = self.last;
        let steps = (last * (error / bound).powf(1.0 / self.order())).ceil();
        Reach::Steps(steps, time + self.time.slope * (steps - last))
    }

    /// By which power of the number of steps the error falls.
    pub(crate) fn order(&self) -> f64 {
        -self.error.slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Record;
    use crate::record::tests::example;

    fn march(steps: u32, error: f64) -> Record {
        let mut record = example("ray-march-8", 2.0 + 0.5 * f64::from(steps), error);
        record.settings.insert("steps".into(), steps.into());
        record
    }

    #[test]
    fn more_steps_follow_from_fewer() {
        let records: Vec<Record> = [8, 16, 32, 64].map(|n| march(n, 2.0 / f64::from(n))).into();
        let points: Vec<Point<'_>> = records.iter().filter_map(Point::of).collect();
        let law = Law::of(&points).unwrap();
        assert!((law.order() - 1.0).abs() < 1e-9);
        let Reach::Steps(steps, time) = law.reach(0.00999) else { panic!("{law:?}") };
        assert_eq!(steps, 201.0);
        assert!((time - 102.5).abs() < 1e-6, "{time}");
    }

    #[test]
    fn a_law_starts_where_the_error_starts_to_fall() {
        let errors = [(8, 2.1), (16, 2.4), (32, 1.2), (64, 0.6)];
        let records: Vec<Record> = errors.map(|(n, error)| march(n, error)).into();
        let points: Vec<Point<'_>> = records.iter().filter_map(Point::of).collect();
        assert!((Law::of(&points).unwrap().order() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_floor_is_not_gone_under() {
        let errors = [(8, 0.4), (16, 0.2), (32, 0.1), (64, 0.05), (128, 0.048), (256, 0.047)];
        let records: Vec<Record> = errors.map(|(n, error)| march(n, error)).into();
        let points: Vec<Point<'_>> = records.iter().filter_map(Point::of).collect();
        let law = Law::of(&points).unwrap();
        assert_eq!(law.reach(0.01), Reach::Never(0.047));
        assert!(matches!(law.reach(0.06), Reach::Steps(steps, _) if (50.0..60.0).contains(&steps)));
        // Counts that lie close together fall by little, and still fall.
        let errors = [(16, 0.32), (64, 0.08), (256, 0.02), (300, 0.017_07)];
        let close: Vec<Record> = errors.map(|(n, error)| march(n, error)).into();
        let close: Vec<Point<'_>> = close.iter().filter_map(Point::of).collect();
        assert!(matches!(Law::of(&close).unwrap().reach(0.01), Reach::Steps(..)));
        // What was measured is not contradicted.
        let errors = [(8, 0.32), (16, 0.09), (32, 0.04), (64, 0.02), (128, 0.0101)];
        let bent: Vec<Record> = errors.map(|(n, error)| march(n, error)).into();
        let bent: Vec<Point<'_>> = bent.iter().filter_map(Point::of).collect();
        assert!(matches!(Law::of(&bent).unwrap().reach(0.01), Reach::Steps(steps, _) if steps >= 129.0));
        // Two points are no law, nor is an error that does not fall.
        assert_eq!(Law::of(&points[..2]), None);
        assert_eq!(Law::of(&points[3..]), None);
    }
}
