use super::super::family::{families, floor};
use super::*;

/// A made-up adapter on which every family follows laws.
struct Laws {
    families: Vec<Family>,
    /// Error of a map of one texel on a side.
    map: f64,
    /// Error and time per pixel of each family's rung of fineness 1, and powers of the fineness by which they go.
    of: Vec<(f64, f64, f64, f64)>,
    /// Errors in real pictures over those in small ones.
    worse: f64,
    /// What is in all errors.
    model: f64,
    looks: usize,
    verified: Vec<Rung>,
}

impl Laws {
    fn new(of: &[(&str, f64, f64, f64, f64)]) -> Self {
        let mut families = families(false);
        families.retain(|family| of.iter().any(|(name, ..)| *name == family.technique));
        let law = |family: &Family| {
            let (_, error, order, time, work) =
                *of.iter().find(|(name, ..)| *name == family.technique).unwrap();
            (error, order, time, work)
        };
        let of = families.iter().map(law).collect();
        Self { families, map: 5.0, of, worse: 1.0, model: 0.0, looks: 0, verified: Vec::new() }
    }

    fn seen(&self, rung: &Rung, pixels: f64) -> Seen {
        let (error, order, time, work) = self.of[rung.family];
        let map = match self.families[rung.family].map {
            Map::Sampled => self.map / f64::from(rung.side),
            _ => 0.0,
        };
        let own = error * rung.fineness.powf(-order);
        let ms = time * rung.fineness.powf(work) * pixels;
        Seen { error: own.hypot(map).hypot(self.model), passes: BTreeMap::from([("draw".into(), ms)]) }
    }

    fn search(&mut self, bound: f64) -> Outcome {
        let families = self.families.clone();
        Search::new(&families, self, bound, 0.0).run().unwrap()
    }

    fn name(&self, outcome: &Outcome) -> (&'static str, f64) {
        let rung = outcome.verified[outcome.best.expect("a best one")].rung;
        (self.families[rung.family].technique, rung.fineness)
    }
}

impl Measures for Laws {
    fn pixels(&self) -> [f64; 2] {
        [1000.0, 4000.0]
    }

    fn look(&mut self, rung: &Rung, whole: bool) -> Result<Result<Seen, String>, Failure> {
        self.looks += 1;
        Ok(Ok(self.seen(rung, self.pixels()[usize::from(whole)])))
    }

    fn verify(&mut self, rung: &Rung) -> Result<Result<Seen, String>, Failure> {
        self.verified.push(*rung);
        let mut seen = self.seen(rung, 4000.0);
        seen.error *= self.worse;
        Ok(Ok(seen))
    }
}

/// Lit intervals, a march that is faster where little is asked, and an exact method that is slow.
fn three() -> Laws {
    Laws::new(&[
        ("lit-intervals", 5.0, 1.0, 1e-3, 0.25),
        ("ray-march", 4.0, 1.0, 1e-4, 1.0),
        ("biri-ss", 1e-4, 0.0, 2e-2, 0.0),
    ])
}

#[test]
fn the_cheapest_setting_under_the_bound_is_found_from_a_few_looks() {
    for (bound, wanted) in [(0.1, ("lit-intervals", 128.0)), (0.01, ("lit-intervals", 1024.0))] {
        let mut laws = three();
        let outcome = laws.search(bound);
        assert_eq!(laws.name(&outcome), wanted, "{bound}: {outcome:?}");
        let best = &outcome.verified[outcome.best.unwrap()];
        assert!(best.seen.error <= bound);
        // The laws are what the search takes them for, so it knows beforehand.
        assert!((best.predicted_error / best.seen.error - 1.0).abs() < 0.05, "{best:?}");
        assert!((best.predicted_ms / best.seen.ms() - 1.0).abs() < 0.05, "{best:?}");
        assert!(laws.looks + laws.verified.len() <= 10, "{} looks, {:?}", laws.looks, laws.verified);
        let lost: Vec<usize> = outcome.lost.iter().map(|lost| lost.family).collect();
        assert_eq!(lost.len(), 2, "{:?}", outcome.lost);
    }
    // Where nothing but the exact one is fine enough.
    let mut laws = three();
    let outcome = laws.search(2e-4);
    assert_eq!(laws.name(&outcome).0, "biri-ss", "{outcome:?}");
}

#[test]
fn a_cheap_march_beats_maps_where_the_map_is_not_the_matter() {
    let mut laws = three();
    laws.of[1] = (0.4, 1.0, 1e-5, 1.0);
    let outcome = laws.search(0.05);
    assert_eq!(laws.name(&outcome).0, "ray-march", "{outcome:?}");
    // Its map is no finer than it has to be.
    let side = outcome.verified[outcome.best.unwrap()].rung.side;
    assert!(side == 256 || side == 512, "{side}");
}

#[test]
fn what_fails_at_the_real_size_is_tried_finer() {
    let mut laws = three();
    laws.worse = 2.5;
    let outcome = laws.search(0.02);
    let best = &outcome.verified[outcome.best.expect("one that holds")];
    assert!(best.seen.error <= 0.02 && outcome.verified.len() > 1, "{outcome:?}");
    assert!(outcome.verified[0].seen.error > 0.02);
}

#[test]
fn none_is_chosen_where_none_is_under_the_bound() {
    let mut laws = Laws::new(&[("lit-intervals", 500.0, 1.0, 1e-3, 0.25)]);
    let outcome = laws.search(0.01);
    assert!(outcome.best.is_none() && outcome.least.is_empty(), "{outcome:?}");
    assert!(outcome.lost[0].why.contains("finest"), "{:?}", outcome.lost);
    // How near it gets is measured, once.
    assert_eq!((outcome.verified.len(), outcome.lost.len()), (1, 1));
}

#[test]
fn what_a_model_leaves_out_is_not_taken_for_the_techniques_error() {
    let mut laws = three();
    let families = laws.families.clone();
    // Every picture is off by another 0.8 % that no setting helps.
    laws.model = 0.008;
    let outcome = Search::new(&families, &mut laws, 0.01, 0.008).run().unwrap();
    assert_eq!(laws.name(&outcome), ("lit-intervals", 2048.0), "{outcome:?}");
    assert_eq!(outcome.verified.len(), 1, "known beforehand");
}

#[test]
fn the_floor_alone_is_a_family_too() {
    let mut laws = three();
    laws.families = vec![floor()];
    laws.of = vec![(0.004, 0.0, 1e-4, 0.0)];
    let outcome = laws.search(0.01);
    assert_eq!(laws.name(&outcome).0, "unshadowed");
    let families = laws.families.clone();
    let outcome = Search::new(&families, &mut laws, 0.001, 0.0).run().unwrap();
    assert!(outcome.best.is_none());
}

#[test]
fn what_is_not_wanted_is_looked_at_for_its_map_and_not_chosen() {
    let mut laws = three();
    laws.families[0].wanted = false;
    let outcome = laws.search(0.05);
    assert_eq!(laws.name(&outcome).0, "ray-march", "{outcome:?}");
    assert!(laws.verified.iter().all(|rung| rung.family != 0));
    assert!(outcome.least.iter().all(|least| least.rung.family != 0));
}

#[test]
fn a_near_miss_is_measured_where_it_would_win() {
    let mut laws = three();
    // A map of 512 is at 0.977 % of 1 %: over what is aimed at, under the bound, and much faster than the next.
    laws.of[0] = (5.0, 1.0, 1e-4, 1.0);
    laws.families[0].work = 1.0;
    laws.of[1].2 = 1.0;
    laws.of[2].2 = 1.0;
    let outcome = laws.search(5.0 / 512.0 + 1e-6);
    assert_eq!(laws.name(&outcome), ("lit-intervals", 512.0), "{outcome:?}");
    // It is no reason to have lost.
    assert!(outcome.lost.iter().all(|lost| lost.family != 0), "{:?}", outcome.lost);
}
