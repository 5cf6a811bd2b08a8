//! How the picture is put together: what is held against what, how fine, and how bright.

use common::Terms;

/// What the first technique is held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Against {
    Nothing,
    /// The second technique.
    Technique,
    /// The CPU reference.
    Reference,
}

/// How two pictures are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// One to the left of a line, the other to its right.
    Divided,
    /// Their difference, relative to the second, as colours.
    Error,
}

/// What the picture is, apart from scene and techniques.
#[derive(Clone, Debug)]
pub(super) struct Look {
    pub terms: Terms,
    pub against: Against,
    pub shown: Shown,
    /// Where the line is: share of the width.
    pub divided: f32,
    /// Factor before the tone curve; none is to be found from the next picture.
    pub exposure: Option<f32>,
    /// Texels on a side of shadow maps, where a technique's settings do not say.
    pub shadow_map_size: u32,
    pub fineness: Fineness,
    /// Draw even if nothing changes, to see times.
    pub always: bool,
}

/// Points of the window on a side of one pixel of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fineness {
    /// Found from the time that frames take.
    pub automatic: bool,
    pub divisor: u32,
    /// How long a frame may take \[ms\].
    budget: f64,
}

/// Coarsest picture.
pub(super) const COARSEST: u32 = 8;
/// Pixels of the first picture on a software adapter, about.
const FIRST_PIXELS: f32 = 60_000.0;
/// Fewest pixels each way: the reference's coarsest pixels.
const LEAST: u32 = 9 * 4;

impl Fineness {
    /// What suits an adapter.
    pub(super) fn of(software: bool) -> Self {
        Self {
            automatic: true,
            divisor: if software { 0 } else { 1 },
            budget: if software { 200.0 } else { 33.0 },
        }
    }

    /// Pixels of the picture in so many of the window: multiples of nine, so that the reference's coarser pictures fit.
    pub(super) fn size(&mut self, width: f32, height: f32) -> (u32, u32) {
        if self.divisor == 0 {
            let divisor = (width * height / FIRST_PIXELS).sqrt().ceil();
            self.divisor = (divisor as u32).clamp(1, COARSEST);
        }
        let side = |length: f32| ((length as u32 / self.divisor) / 9 * 9).max(LEAST);
        (side(width), side(height))
    }

    /// Takes note of how long a frame took \[ms\].
    pub(super) fn took(&mut self, milliseconds: f64) {
        if !self.automatic {
            return;
        }
        let finer = f64::from(self.divisor) / f64::from(self.divisor.saturating_sub(1).max(1));
        if milliseconds > 1.5 * self.budget {
            self.divisor = (self.divisor + 1).min(COARSEST);
        } else if self.divisor > 1 && milliseconds * finer * finer < 0.6 * self.budget {
            self.divisor -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_adapter_gets_a_coarser_picture_and_a_fast_one_all_pixels() {
        let mut slow = Fineness::of(true);
        let (width, height) = slow.size(1000.0, 700.0);
        assert!(width * height < 80_000 && width % 9 == 0 && height % 9 == 0);
        let before = slow.divisor;
        slow.took(1000.0);
        assert_eq!(slow.divisor, before + 1);
        (0..20).for_each(|_| slow.took(1000.0));
        assert_eq!(slow.divisor, COARSEST);
        (0..20).for_each(|_| slow.took(1.0));
        assert_eq!(slow.divisor, 1);
        let mut fast = Fineness::of(false);
        assert_eq!(fast.size(1000.0, 700.0), (999, 693));
        assert_eq!(fast.size(1.0, 1.0), (LEAST, LEAST));
    }

    #[test]
    fn fineness_comes_to_rest() {
        // Whatever a pixel costs, and whatever does not depend on pixels.
        for (fixed, per_pixel) in [(5.0, 1e-3), (150.0, 1e-3), (400.0, 0.0), (10.0, 1e-2), (0.0, 1e-4)] {
            let mut fineness = Fineness::of(true);
            let mut seen = Vec::new();
            for _ in 0..50 {
                let (width, height) = fineness.size(1000.0, 700.0);
                fineness.took(fixed + per_pixel * f64::from(width * height));
                seen.push(fineness.divisor);
            }
            assert!(seen[30..].iter().all(|divisor| *divisor == seen[30]), "{fixed} {per_pixel}: {seen:?}");
        }
    }

    #[test]
    fn what_was_chosen_by_hand_stays() {
        let mut fineness = Fineness { automatic: false, divisor: 3, ..Fineness::of(true) };
        fineness.took(1e4);
        assert_eq!(fineness.divisor, 3);
    }
}
