//! Which measurements are worth having: no other one is both faster and better.

use crate::record::Record;

/// A measurement as a point of the chart of error against time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<'a> {
    pub record: &'a Record,
    /// Median time of the technique's own passes \[ms\].
    pub time: f64,
    /// Half of what lies between median and 95th percentile \[ms\].
    pub spread: f64,
    /// Relative RMSE, or the reference's uncertainty where that is larger.
    pub error: f64,
    /// Uncertainty of the reference.
    pub noise: f64,
    /// Whether `error` is only an upper bound: the true one can't be told from 0.
    pub bound: bool,
}

impl<'a> Point<'a> {
    /// `None` of a refusal, of a broken picture, and of what is not finite.
    pub(crate) fn of(record: &'a Record) -> Option<Self> {
        let time = record.technique_ms.p50;
        let spread = (0.5 * (record.technique_ms.p95 - time)).max(0.0);
        let noise = record.reference.uncertainty;
        let noise = if noise.is_finite() { noise.max(0.0) } else { 0.0 };
        let bound = record.error.rel_rmse <= noise;
        let error = if bound { noise } else { record.error.rel_rmse };
        let broken = record.error.nan + record.error.inf + record.error.negative > 0;
        let drawable = record.refused.is_none() && !broken && time > 0.0 && time.is_finite();
        (drawable && error > 0.0 && error.is_finite()).then_some(Self {
            record,
            time,
            spread,
            error,
            noise,
            bound,
        })
    }

    /// Faster by more than both spreads.
    fn is_faster(&self, other: &Self) -> bool {
        self.time + self.spread + other.spread < other.time
    }

    /// Less wrong by more than the reference's uncertainty.
    fn is_better(&self, other: &Self) -> bool {
        self.error + self.noise.max(other.noise) < other.error
    }

    /// Whether two times are equal within their spreads.
    pub(crate) fn takes_as_long(&self, other: &Self) -> bool {
        !self.is_faster(other) && !other.is_faster(self)
    }

    /// Whether there is no reason to take `other`: this one is faster or better beyond the noise, and in neither
    /// worse beyond it.
    pub(crate) fn dominates(&self, other: &Self) -> bool {
        let (faster, better) = (self.is_faster(other), self.is_better(other));
        (faster && !other.is_better(self)) || (better && !other.is_faster(self))
    }
}

/// Whether each point is dominated by any other.
pub(crate) fn dominated(points: &[Point<'_>]) -> Vec<bool> {
    points.iter().map(|point| points.iter().any(|other| other.dominates(point))).collect()
}

/// The frontier from fast to right: points that none dominates, as far as each is less wrong than all faster ones.
pub(crate) fn frontier<'a>(points: &[Point<'a>]) -> Vec<Point<'a>> {
    let free = dominated(points);
    let mut left: Vec<Point<'a>> =
        points.iter().zip(free).filter(|(_, dominated)| !dominated).map(|(point, _)| *point).collect();
    left.sort_by(|a, b| a.time.total_cmp(&b.time).then(a.error.total_cmp(&b.error)));
    let mut least = f64::INFINITY;
    left.retain(|point| {
        let keep = point.error < least;
        least = least.min(point.error);
        keep
    });
    left
}

/// The cheapest point whose error is at most `bound`.
pub(crate) fn cheapest<'a>(points: &[Point<'a>], bound: f64) -> Option<Point<'a>> {
    let under = points.iter().filter(|point| point.error <= bound);
    under.min_by(|a, b| a.time.total_cmp(&b.time)).copied()
}

/// The least wrong point that takes at most `time`; of equal ones the fastest.
pub(crate) fn best<'a>(points: &[Point<'a>], time: f64) -> Option<Point<'a>> {
    let within = points.iter().filter(|point| point.time <= time);
    within.min_by(|a, b| a.error.total_cmp(&b.error).then(a.time.total_cmp(&b.time))).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Spread;
    use crate::record::tests::example;

    fn records() -> Vec<Record> {
        vec![
            example("ray-march-16", 1.0, 0.3),
            example("ray-march-64", 4.0, 0.08),
            example("billeter-plv", 3.0, 0.02),
            example("biri-ss", 5.0, 1e-6),
            example("biri-ss", 9.0, 5e-5),
        ]
    }

    #[test]
    fn slower_and_worse_is_dominated() {
        let records = records();
        let points: Vec<Point<'_>> = records.iter().filter_map(Point::of).collect();
        // The last two are both below the reference's uncertainty: equally right, so the slower one loses.
        assert_eq!(dominated(&points), [false, true, false, false, true]);
        assert!(points[3].bound && points[3].error == 1e-4 && !points[2].bound);
        let names: Vec<&str> = frontier(&points).iter().map(|p| p.record.name.as_str()).collect();
        assert_eq!(names, ["ray-march-16", "billeter-plv", "biri-ss"]);
        assert_eq!(cheapest(&points, 0.05).map(|p| p.time), Some(3.0));
        assert_eq!(cheapest(&points, 1e-5).map(|p| p.time), None);
        assert_eq!(best(&points, 4.0).map(|p| p.error), Some(0.02));
        assert!(best(&points, 0.5).is_none());
    }

    #[test]
    fn what_the_noise_allows_is_no_difference() {
        let steady = example("a", 10.0, 0.02);
        let mut shaky = example("b", 11.0, 0.02);
        let faster = |a: &Record, b: &Record| Point::of(a).unwrap().dominates(&Point::of(b).unwrap());
        assert!(faster(&steady, &shaky));
        // 11 ± 2 may be 10.
        shaky.technique_ms = Spread { p50: 11.0, p95: 15.0, max: 15.0 };
        assert!(!faster(&steady, &shaky) && !faster(&shaky, &steady));
        assert!(Point::of(&steady).unwrap().takes_as_long(&Point::of(&shaky).unwrap()));
        // Nor is 2.005 % worse than 2 % where the reference is sure to 0.01 % only.
        let close = example("c", 10.0, 0.02005);
        assert!(!faster(&steady, &close) && !faster(&close, &steady));
        let apart = example("d", 10.0, 0.0203);
        assert!(faster(&steady, &apart));
    }

    #[test]
    fn a_refusal_is_no_point() {
        let refused = Record { refused: Some("no".into()), ..example("a", 1.0, 0.1) };
        assert!(Point::of(&refused).is_none());
        assert!(Point::of(&example("a", 1.0, f64::NAN)).is_none());
        assert!(Point::of(&example("a", 0.0, 0.1)).is_none());
        let mut broken = example("a", 1.0, 0.1);
        broken.error.nan = 1;
        assert!(Point::of(&broken).is_none());
    }
}
