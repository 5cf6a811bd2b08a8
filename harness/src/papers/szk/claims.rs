//! What the paper's text claims, each claim held against measurements.

use super::super::Press;
use super::super::claims::{self, Claim};
use super::super::verdict::{Growth, Verdict, signed};
use super::convergence::Convergence;
use super::grid::Grid;
use super::heading;
use super::timing::{Case, Row, Timing};
use crate::failure::Failure;
use crate::fit::Fit;
use crate::report::{digits, percent};

/// How times were taken, and of what.
const HOW: &str = "Times are medians of frames drawn in turn (`timing.json`), growths medians of the ratios within each round, ± \
         half of what the middle half of the rounds spans. Unless said otherwise the paper's method with 1024 \
         particles, 128 directions, three colours.";
/// Largest growth of the frame that is "almost independent".
const LITTLE: f64 = 0.10;
/// How far the ratio of frames per second may be from the paper's.
const ABOUT: f64 = 0.15;
/// How far an exponent may be from the claimed one.
const EXPONENT: f64 = 0.2;

/// Judges and writes; gives the table as Markdown.
pub(super) fn make(
    press: &Press<'_>,
    timing: &Timing,
    convergence: &Convergence,
    grid: &Grid,
) -> Result<String, Failure> {
    let claims = vec![
        half_the_particles(timing),
        lights(timing),
        sky(timing),
        sensitivity(grid),
        fast(convergence),
        warm(convergence),
        by_particles(timing),
        by_directions(timing),
        low_rank(timing),
    ];
    claims::write(press, &heading(press), HOW, &claims, Default::default())
}

/// The paper's usual setting.
const USUAL: Case = Case::new("paper", 1024, 128);

fn growth(from: &Row, to: &Row) -> [Growth; 2] {
    [
        Growth::of(&from.frame_samples_ms, &to.frame_samples_ms),
        Growth::of(&from.iterate_samples_ms, &to.iterate_samples_ms),
    ]
}

fn text(Growth { median, apart }: Growth) -> String {
    format!("{} (±{})", signed(median), percent(0.5 * apart))
}

fn half_the_particles(timing: &Timing) -> Claim {
    let half = timing.row(Case::new("paper", 512, 128));
    let [frame, step] = growth(half, timing.row(USUAL));
    let paper = 45.0 / 26.0;
    let ratio = 1.0 + frame.median;
    let (low, high) = (ratio - 0.5 * frame.apart, ratio + 0.5 * frame.apart);
    let verdict = match () {
        () if low > paper * (1.0 - ABOUT) && high < paper * (1.0 + ABOUT) => Verdict::Holds,
        () if high < paper * (1.0 - ABOUT) || low > paper * (1.0 + ABOUT) => Verdict::DoesNotHold,
        () => Verdict::CannotTell,
    };
    Claim {
        letter: 'a',
        claim: "512 particles instead of 1024 make frames 1.73 times as fast (26 to 45 fps)",
        measured: format!(
            "{} times (±{}); the step alone {} times; holds within {}",
            digits(ratio),
            percent(0.5 * frame.apart),
            digits(1.0 + step.median),
            percent(ABOUT)
        ),
        verdict,
    }
}

fn lights(timing: &Timing) -> Claim {
    let of = |lights| timing.row(Case { lights, sky: false, ..USUAL });
    let [two, four] = [2, 4].map(|lights| growth(of(1), of(lights))[0]);
    let steps = [1, 2, 4].map(|lights| digits(of(lights).iterate_ms.p50)).join(" / ");
    Claim {
        letter: 'b',
        claim: "the number of lights hardly matters to the speed",
        measured: format!(
            "frame with 2 lights {}, with 4 {} to that with 1, direct light of all found again in each; the step {steps} \
             ms; hardly: at most {} for twice as many",
            text(two),
            text(four),
            percent(LITTLE)
        ),
        verdict: Verdict::of_growth(two, LITTLE),
    }
}

fn sky(timing: &Timing) -> Claim {
    let [frame, _] = growth(timing.row(Case { sky: false, ..USUAL }), timing.row(USUAL));
    Claim {
        letter: 'c',
        claim: "light from the sky hardly matters to the speed",
        measured: format!("frame with a sky {} to that without", text(frame)),
        verdict: Verdict::of_growth(frame, LITTLE),
    }
}

fn sensitivity(grid: &Grid) -> Claim {
    let over = |[a, b]: [(u32, u32); 2]| grid.error(a.0, a.1) / grid.error(b.0, b.1);
    let directions = over([(1024, 32), (1024, 512)]);
    let particles = over([(128, 128), (4096, 128)]);
    let pair = over([(512, 128), (1024, 128)]);
    Claim {
        letter: 'd',
        claim: "the number of directions matters little to the picture, that of particles more",
        measured: format!(
            "error of 32 directions over that of 512, 1024 particles: {}; of 128 particles over 4096, 128 directions: \
             {}; of 512 over 1024: {}",
            digits(directions),
            digits(particles),
            digits(pair)
        ),
        verdict: (directions < particles && directions < 1.5).into(),
    }
}

fn fast(convergence: &Convergence) -> Claim {
    let steps = |name: &str| {
        convergence.curves.iter().find(|curve| curve.setting == name).and_then(|curve| curve.to_5_percent)
    };
    let text = |steps: Option<u32>| steps.map_or("more than 128".into(), |steps| steps.to_string());
    let paper = steps("paper");
    Claim {
        letter: 'e',
        claim: "the iteration converges fast",
        measured: format!(
            "steps from dark to 5 % of the end: paper's method {}, default {}; fast: within a second at the paper's 26 \
             fps",
            text(paper),
            text(steps("default"))
        ),
        verdict: paper.is_some_and(|steps| steps <= 26).into(),
    }
}

fn warm(convergence: &Convergence) -> Claim {
    let turned = |turned: &super::convergence::Turned| {
        format!("{}°: {} steps, from dark {}", turned.degrees, turned.from_old, turned.from_dark)
    };
    let first = convergence.turned.first();
    Claim {
        letter: 'f',
        claim: "after a light has moved, the old solution is a good one to begin with",
        measured: format!(
            "to 5 % of the new picture after all lights turned by {}; good: at most half the steps after 10°",
            convergence.turned.iter().map(turned).collect::<Vec<_>>().join("; by ")
        ),
        verdict: first.is_some_and(|turned| 2 * turned.from_old <= turned.from_dark).into(),
    }
}

fn exponent(fit: Option<Fit>) -> String {
    fit.map_or("no line".into(), |fit| format!("{:.2} (R² {:.3})", fit.slope, fit.r2))
}

fn is_about(fit: Option<Fit>, wanted: f64) -> bool {
    fit.is_some_and(|fit| (fit.slope - wanted).abs() <= EXPONENT)
}

fn by_particles(timing: &Timing) -> Claim {
    let [particles, _] = timing.growth("paper");
    Claim {
        letter: 'g',
        claim: "the cost of a step grows with the number of particles (by the printed form)",
        measured: format!("time of a step ∝ N to the {}, N from 256 to 2048", exponent(particles)),
        verdict: is_about(particles, 1.0).into(),
    }
}

fn by_directions(timing: &Timing) -> Claim {
    let [_, directions] = timing.growth("paper");
    Claim {
        letter: 'h',
        claim: "the cost of a step grows with the square of the number of directions (by the printed form)",
        measured: format!("time of a step ∝ D to the {}, D from 32 to 128", exponent(directions)),
        verdict: is_about(directions, 2.0).into(),
    }
}

fn low_rank(timing: &Timing) -> Claim {
    let [particles, directions] = timing.growth("default");
    Claim {
        letter: 'i',
        claim: "not the paper's: by few components of the matrix it grows with the number of directions only",
        measured: format!(
            "default: time of a step ∝ N to the {} and ∝ D to the {}",
            exponent(particles),
            exponent(directions)
        ),
        verdict: is_about(directions, 1.0).into(),
    }
}
