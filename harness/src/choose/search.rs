//! The search for the cheapest setting under a bound: looks at small pictures, laws through what was seen, verification
//! at the real size.

use std::collections::BTreeMap;

use super::family::{EXACT_ON_MAP, Family, Map, Rung, SIDES, work};
use crate::failure::Failure;

/// Share of the bound that a setting is predicted to stay under before it is measured.
const AIM: f64 = 0.9;

/// A setting that is predicted to be over the bound by no more than this factor is measured where it is predicted to be faster
/// than the best by at least that one.
const NEAR: f64 = 1.03;
const CLEARLY_FASTER: f64 = 1.2;

/// Share of what is aimed at that the error of a sampled map may take.
const MAP_SHARE: f64 = 0.6;

/// A family is dropped when it is predicted to take so many times as long as the best: looks predict time no better.
const CLEARLY_SLOWER: f64 = 2.0;

/// The same where the best was measured at the real size.
const SLOWER: f64 = 1.4;

/// Looks at one family, and settings of it that are measured at the real size, at most.
const LOOKS: usize = 3;
const TRIES: usize = 4;

/// What was measured of a setting.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Seen {
    /// Relative RMSE of the airlight.
    pub error: f64,
    /// Its passes \[ms\].
    pub passes: BTreeMap<String, f64>,
}

impl Seen {
    /// All passes \[ms\].
    pub(super) fn ms(&self) -> f64 {
        self.passes.values().sum()
    }
}

/// Who measures: a sentence where a scene can't be drawn.
pub(super) trait Measures {
    /// Pixels of a small picture and of one of the real size.
    fn pixels(&self) -> [f64; 2];
    /// Roughly, standing still; in a small picture, or in one of the real size.
    fn look(&mut self, rung: &Rung, whole: bool) -> Result<Result<Seen, String>, Failure>;
    /// At the real size, everything moving.
    fn verify(&mut self, rung: &Rung) -> Result<Result<Seen, String>, Failure>;
}

/// A setting that was measured at the real size, and what had been predicted of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Verified {
    pub rung: Rung,
    pub seen: Seen,
    pub predicted_error: f64,
    pub predicted_ms: f64,
}

/// Why a family was not chosen.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lost {
    pub family: usize,
    pub why: String,
    /// Time at the bound, measured or predicted \[ms\], where it gets there.
    pub ms: Option<f64>,
}

/// A setting as it is predicted.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Least {
    pub rung: Rung,
    pub error: f64,
    /// At the real size.
    pub ms: f64,
}

/// What came out.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    /// All that were measured at the real size, in the order of measuring.
    pub verified: Vec<Verified>,
    /// Index among them of the cheapest under the bound.
    pub best: Option<usize>,
    pub lost: Vec<Lost>,
    /// The coarsest setting of each family that is predicted to stay under the bound.
    pub least: Vec<Least>,
}

/// What was seen of a family.
#[derive(Clone, Debug, Default)]
struct Law {
    seen: Vec<(Rung, f64, Seen)>,
}

impl Law {
    fn add(&mut self, rung: Rung, pixels: f64, seen: Seen) {
        self.seen.push((rung, pixels, seen));
    }

    /// The measurement that says most of a rung: the largest picture of the nearest setting.
    fn anchor(&self, rung: &Rung) -> Option<&(Rung, f64, Seen)> {
        let far = |(own, ..): &&(Rung, f64, Seen)| (own.fineness / rung.fineness).ln().abs();
        self.seen.iter().min_by(|a, b| far(a).total_cmp(&far(b)).then(b.1.total_cmp(&a.1)))
    }

    /// Power by which the family's own error falls: measured where two settings were seen, within reason.
    fn order(&self, family: &Family, others: f64) -> f64 {
        let own = |seen: &Seen| (seen.error.powi(2) - others.powi(2)).max((0.1 * seen.error).powi(2)).sqrt();
        let ends =
            |(a, ..): &&(Rung, f64, Seen), (b, ..): &&(Rung, f64, Seen)| a.fineness.total_cmp(&b.fineness);
        let (Some(low), Some(high)) = (self.seen.iter().min_by(ends), self.seen.iter().max_by(ends)) else {
            return family.order;
        };
        let finer = (high.0.fineness / low.0.fineness).ln();
        if finer < 0.5 {
            return family.order;
        }
        ((own(&low.2) / own(&high.2)).ln() / finer).clamp(0.4 * family.order, 1.2 * family.order)
    }
}

/// The search's state.
pub(super) struct Search<'a, M> {
    families: &'a [Family],
    measures: &'a mut M,
    bound: f64,
    /// Error of the model, which is in all that is measured.
    model: f64,
    laws: Vec<Law>,
    /// Times at the real size over those that small pictures predict: what is fixed in a frame counts more in these.
    scale: f64,
}

impl<'a, M: Measures> Search<'a, M> {
    /// For an error of at most `bound`, of which the model makes `model`.
    pub(super) fn new(families: &'a [Family], measures: &'a mut M, bound: f64, model: f64) -> Self {
        Self { families, measures, bound, model, laws: vec![Law::default(); families.len()], scale: 1.0 }
    }

    fn aim(&self) -> f64 {
        AIM * self.bound
    }

    /// Error of a sampled map, where lit intervals have shown it.
    fn map_error(&self, side: u32) -> f64 {
        let exact = self.families.iter().position(|family| family.technique == EXACT_ON_MAP);
        let Some(exact) = exact else { return 0.0 };
        let rung = Rung { family: exact, index: 0, fineness: f64::from(side), side };
        self.own_error(&rung)
    }

    /// What a map of that side adds to the errors of a family.
    fn sampled(&self, family: usize, side: u32) -> f64 {
        match self.families[family].map {
            Map::Sampled => self.map_error(side),
            Map::Is | Map::Unused => 0.0,
        }
    }

    /// What of a rung's error is the family's own.
    fn own_error(&self, rung: &Rung) -> f64 {
        let (family, law) = (&self.families[rung.family], &self.laws[rung.family]);
        let Some((from, _, seen)) = law.anchor(rung) else { return 0.0 };
        let others = self.model.hypot(self.sampled(rung.family, from.side));
        let own = (seen.error.powi(2) - others.powi(2)).max((0.1 * seen.error).powi(2)).sqrt();
        own * (rung.fineness / from.fineness).powf(-law.order(family, others))
    }

    /// Predicted error of a rung.
    fn error(&self, rung: &Rung) -> f64 {
        self.own_error(rung).hypot(self.sampled(rung.family, rung.side)).hypot(self.model)
    }

    /// Predicted time at the real size \[ms\].
    fn ms(&self, rung: &Rung) -> f64 {
        let [_, whole] = self.measures.pixels();
        let Some((from, pixels, seen)) = self.laws[rung.family].anchor(rung) else { return f64::INFINITY };
        let family = &self.families[rung.family];
        let of = |(pass, ms): (&String, &f64)| ms * work(family, pass, (from, *pixels), (rung, whole));
        let scale = if *pixels < whole { self.scale } else { 1.0 };
        scale * seen.passes.iter().map(of).sum::<f64>()
    }

    /// The coarsest map that leaves a sampling family most of what is aimed at.
    fn side(&self) -> u32 {
        let fits = |side: &&u32| self.map_error(**side).hypot(self.model) <= MAP_SHARE * self.aim();
        // Beyond 2048 maps cost more to draw than they are worth to who samples them.
        let few = &SIDES[1..SIDES.len() - 1];
        *few.iter().find(fits).unwrap_or(&few[few.len() - 1])
    }

    /// The coarsest rung from `least` on that is predicted to stay under the aim; none of what was not looked at.
    fn cheapest(&self, family: usize, least: usize) -> Option<Rung> {
        self.cheapest_within(family, least, self.aim())
    }

    /// The same with an error of at most `error`.
    fn cheapest_within(&self, family: usize, least: usize, error: f64) -> Option<Rung> {
        if self.laws[family].seen.is_empty() {
            return None;
        }
        let side = self.side();
        let rungs = least..self.families[family].rungs.len();
        rungs
            .map(|index| self.families[family].rung(family, index, side))
            .find(|rung| self.error(rung) <= error)
    }

    /// Looks at one family until it is clear which setting it would take, or that it loses against `best` \[ms\].
    fn look(&mut self, family: usize, best: f64) -> Result<Result<Rung, Lost>, Failure> {
        let [small, whole] = self.measures.pixels();
        let in_pixels = self.families[family].in_pixels;
        let pixels = if in_pixels { whole } else { small };
        let lost = |why: String, ms| Ok(Err(Lost { family, why, ms }));
        let mut rung = self.families[family].rung(family, self.families[family].first, self.side());
        for look in 1.. {
            match self.measures.look(&rung, in_pixels)? {
                Ok(seen) if !seen.error.is_finite() => {
                    return lost("its picture has no error: nothing is lit".into(), None);
                }
                Ok(seen) => self.laws[family].add(rung, pixels, seen),
                Err(refusal) => return lost(format!("can't draw it: {refusal}"), None),
            }
            let Some(next) = self.cheapest(family, 0) else {
                let last = self.families[family].rungs.len() - 1;
                let finest = self.families[family].rung(family, last, self.side());
                let seen = self.laws[family].seen.iter().any(|(own, ..)| own.index == last);
                let (error, ms) = (100.0 * self.error(&finest), self.ms(&finest));
                if seen || look >= LOOKS || ms > CLEARLY_SLOWER * best {
                    let why = format!("its finest setting is predicted at {error:.2} % in {}", time(ms));
                    return lost(why, None);
                }
                rung = finest;
                continue;
            };
            let ms = self.ms(&next);
            if ms > CLEARLY_SLOWER * best {
                return lost(format!("predicted to take {}", time(ms)), Some(ms));
            }
            let far = (next.fineness / rung.fineness).ln().abs() > 1.0;
            let known = self.laws[family].seen.iter().any(|(own, ..)| own.index == next.index);
            if known || !far || look >= LOOKS {
                return Ok(Ok(next));
            }
            rung = next;
        }
        unreachable!("looks end")
    }

    /// Searches.
    pub(super) fn run(mut self) -> Result<Outcome, Failure> {
        let mut outcome = Outcome::default();
        let mut ranked: Vec<Rung> = Vec::new();
        let mut best = f64::INFINITY;
        for family in 0..self.families.len() {
            match self.look(family, best)? {
                _ if !self.families[family].wanted => {}
                Ok(rung) => {
                    best = best.min(self.ms(&rung));
                    ranked.push(rung);
                }
                Err(lost) => outcome.lost.push(lost),
            }
        }
        ranked.sort_by(|a, b| self.ms(a).total_cmp(&self.ms(b)));
        for rung in ranked {
            let best = outcome.best.map_or(f64::INFINITY, |best| outcome.verified[best].seen.ms());
            let ms = self.ms(&rung);
            if ms > SLOWER * best {
                let why = format!("predicted to take {}", time(ms));
                outcome.lost.push(Lost { family: rung.family, why, ms: Some(ms) });
                continue;
            }
            self.verify(rung, &mut outcome)?;
        }
        self.near_misses(&mut outcome)?;
        if outcome.verified.is_empty() {
            self.nearest(&mut outcome)?;
        }
        let chosen = outcome.best.map(|best| outcome.verified[best].rung.family);
        for family in 0..self.families.len() {
            let own = outcome.verified.iter().filter(|verified| verified.rung.family == family);
            let told = outcome.lost.iter().any(|lost| lost.family == family);
            if Some(family) == chosen || told || own.clone().count() == 0 {
                continue;
            }
            let under = own.clone().filter(|verified| verified.seen.error <= self.bound);
            let fastest = under.map(|verified| verified.seen.ms()).reduce(f64::min);
            let least = own.map(|verified| verified.seen.error).fold(f64::INFINITY, f64::min);
            let why = match fastest {
                Some(ms) => format!("takes {}", time(ms)),
                None => format!("its error was {:.2} %", 100.0 * least),
            };
            outcome.lost.push(Lost { family, why, ms: fastest });
        }
        outcome.lost.sort_by(|a, b| a.ms.unwrap_or(f64::INFINITY).total_cmp(&b.ms.unwrap_or(f64::INFINITY)));
        let wanted = (0..self.families.len()).filter(|family| self.families[*family].wanted);
        let least = wanted.filter_map(|family| self.cheapest(family, 0));
        outcome.least =
            least.map(|rung| Least { rung, error: self.error(&rung), ms: self.ms(&rung) }).collect();
        Ok(outcome)
    }

    /// Measures the best that was looked at, where nothing gets under the bound: the user is told how near it gets.
    fn nearest(&mut self, outcome: &mut Outcome) -> Result<(), Failure> {
        let wanted = self.laws.iter().zip(self.families).filter(|(_, family)| family.wanted);
        let seen = wanted.flat_map(|(law, _)| &law.seen);
        let nearest = seen.min_by(|a, b| a.2.error.total_cmp(&b.2.error)).map(|(rung, ..)| *rung);
        nearest.map_or(Ok(()), |rung| self.verify(rung, outcome))
    }

    /// Measures what is predicted to be clearly faster than the best and so close to the bound that it may be under it.
    fn near_misses(&mut self, outcome: &mut Outcome) -> Result<(), Failure> {
        for family in (0..self.families.len()).filter(|family| self.families[*family].wanted) {
            let Some(best) = outcome.best.map(|best| outcome.verified[best].seen.ms()) else { return Ok(()) };
            let near = self.cheapest_within(family, 0, NEAR * self.bound);
            let known = |rung: &Rung| outcome.verified.iter().any(|verified| verified.rung == *rung);
            if let Some(near) = near.filter(|near| !known(near) && CLEARLY_FASTER * self.ms(near) < best) {
                outcome.lost.retain(|lost| lost.family != family);
                self.verify(near, outcome)?;
            }
        }
        Ok(())
    }

    /// Measures a family at the real size: a finer setting where the error is above the bound, a coarser one where the law
    /// now says that it is enough.
    fn verify(&mut self, mut rung: Rung, outcome: &mut Outcome) -> Result<(), Failure> {
        let [_, whole] = self.measures.pixels();
        let family = rung.family;
        let mut tried: Vec<usize> = Vec::new();
        for _ in 0..TRIES {
            let (predicted_error, predicted_ms) = (self.error(&rung), self.ms(&rung));
            tried.push(rung.index);
            let seen = match self.measures.verify(&rung)? {
                Ok(seen) => seen,
                Err(refusal) => {
                    let why = format!("can't draw it: {refusal}");
                    outcome.lost.push(Lost { family, why, ms: None });
                    return Ok(());
                }
            };
            if tried.len() == 1 && predicted_ms > 0.0 && !self.families[family].in_pixels {
                self.scale *= (seen.ms() / predicted_ms).clamp(0.25, 4.0);
            }
            self.laws[family].add(rung, whole, seen.clone());
            let fits = seen.error <= self.bound;
            let ms = seen.ms();
            outcome.verified.push(Verified { rung, seen, predicted_error, predicted_ms });
            if fits && outcome.best.is_none_or(|best| ms < outcome.verified[best].seen.ms()) {
                outcome.best = Some(outcome.verified.len() - 1);
            }
            let best = outcome.best.map_or(f64::INFINITY, |best| outcome.verified[best].seen.ms());
            let next = self.cheapest(family, if fits { 0 } else { rung.index + 1 });
            let Some(next) = next.filter(|next| !tried.contains(&next.index)) else { return Ok(()) };
            let finer = next.index > rung.index;
            // A finer one is wanted only where this one failed, and where it may still be the best.
            if finer == fits || self.ms(&next) > SLOWER * best {
                return Ok(());
            }
            rung = next;
        }
        Ok(())
    }
}

/// A time, in words.
pub(super) fn time(ms: f64) -> String {
    format!("{} ms", crate::report::digits(ms))
}

#[cfg(test)]
mod tests;
