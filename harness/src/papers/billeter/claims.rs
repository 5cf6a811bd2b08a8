//! What paper and supplement claim, each claim held against measurements.

use serde_json::Map;

use super::super::Press;
use super::super::claims::{self, Claim};
use super::super::verdict::{Growth, Verdict, signed};
use super::measured::{ADAPTIVE, COUNTS, LIGHTS, MAPS, Measured, Row, SMALL_MAP, STEPS_OF_MARCH};
use super::{PAPER, PAPER_FPS, SHADOW_MAP};
use crate::failure::Failure;
use crate::fit::Fit;
use crate::report::{digits, percent};

/// How far the exponent of the error over the texel may be from 1.
const EXPONENT: f64 = 0.3;
/// Largest growth that is "nearly independent".
const LITTLE: f64 = 0.1;
/// How far a doubling may be from twice the time.
const PROPORTION: f64 = 0.25;
/// Largest difference by the table that nobody sees.
const TABLE: f64 = 0.005;

const HOW: &str = "`cathedral` with two lights unless said otherwise, the paper's setting. Times are medians of the \
    technique's own passes, all cases in turn, everything moving; growths are medians of the ratios within each round, ± \
    half of what the middle half of the rounds spans. Errors: relative RMSE of the airlight at time 0.";

/// Judges and writes; gives the table as Markdown.
pub(super) fn make(press: &Press<'_>, heading: &str, measured: &Measured) -> Result<String, Failure> {
    let claims = [
        exact(measured),
        no_steps(measured),
        real_time(press, measured),
        by_triangles(measured),
        by_map(measured),
        by_lights(measured),
        no_tessellation(measured),
        table(measured),
        faster_than_marching(measured),
    ];
    let rows = serde_json::to_value(&measured.rows).map_err(|error| Failure::Run(error.to_string()))?;
    let more = Map::from_iter([
        ("rows".to_owned(), rows),
        ("table_error".to_owned(), measured.table_error.into()),
        ("uncertainty".to_owned(), measured.uncertainty.into()),
    ]);
    claims::write(press, heading, HOW, &claims, more)
}

/// Error of a row; NaN for one without.
fn error(row: &Row) -> f64 {
    row.rel_rmse.unwrap_or(f64::NAN)
}

fn growth(from: &Row, to: &Row) -> Growth {
    Growth::of(&from.technique_samples_ms, &to.technique_samples_ms)
}

fn growth_text(Growth { median, apart }: Growth) -> String {
    format!("{} (±{})", signed(median), percent(0.5 * apart))
}

/// Numbers by the size of the maps.
fn by_maps(name: &str, measured: &Measured, text: impl Fn(&Row) -> String) -> String {
    MAPS.map(|map| format!("{map}²: {}", text(measured.row(name, map)))).join(", ")
}

/// `y ∝ size^slope`.
fn power(name: &str, measured: &Measured, value: impl Fn(&Row) -> f64) -> Option<Fit> {
    Fit::power(&MAPS.map(|map| (f64::from(map), value(measured.row(name, map)))))
}

fn exponent(fit: Option<Fit>) -> String {
    fit.map_or("no line".into(), |fit| format!("{:.2} (R² {:.3})", fit.slope, fit.r2))
}

fn exact(measured: &Measured) -> Claim {
    let fit = power(PAPER, measured, error);
    Claim {
        letter: 'a',
        claim: "exact with respect to the resolution of the shadow map: what error there is comes from its texels",
        measured: format!(
            "error {}; ∝ size to the {}; in proportion to the texel: to the −1 ± {EXPONENT}",
            by_maps(PAPER, measured, |row| percent(error(row))),
            exponent(fit)
        ),
        verdict: fit.is_some_and(|fit| (fit.slope + 1.0).abs() <= EXPONENT).into(),
    }
}

fn no_steps(measured: &Measured) -> Claim {
    let march = |steps: u32| measured.row(&format!("ray-march-equiangular-{steps}"), SHADOW_MAP);
    let marches = STEPS_OF_MARCH.map(|steps| format!("{steps}: {}", percent(error(march(steps)))));
    Claim {
        letter: 'b',
        claim: "no sampling along view rays: nothing that more steps would improve",
        measured: format!(
            "by the way it is built: {} by the default and {} by the paper's setting with maps of {SHADOW_MAP}², at once. \
             Error of a march through the same maps by its steps: {}",
            percent(error(measured.row("billeter-plv-default", SHADOW_MAP))),
            percent(error(measured.row(PAPER, SHADOW_MAP))),
            marches.join(", ")
        ),
        verdict: Verdict::Holds,
    }
}

fn real_time(press: &Press<'_>, measured: &Measured) -> Claim {
    let fps = 1e3 / measured.row(PAPER, SHADOW_MAP).frame_ms.p50;
    let (reason, verdict) = if press.context.software {
        ("; an adapter in software says nothing of a graphics card", Verdict::NotTested)
    } else {
        ("", (fps >= PAPER_FPS).into())
    };
    Claim {
        letter: 'c',
        claim: "real time: about 90 frames per second at 1280x1024 with two lights",
        measured: format!("{} frames per second{reason}", digits(fps)),
        verdict,
    }
}

fn by_triangles(measured: &Measured) -> Claim {
    let rows = COUNTS.map(|count| measured.with_triangles(count));
    let [few, own, many] = rows;
    let all = growth(few, many);
    Claim {
        letter: 'd',
        claim: "the cost of the volumes does not depend on the number of triangles in the scene",
        measured: format!(
            "{} ms with {} triangles; {} from the first to the last, sixteen times as many; maps of {SMALL_MAP}²; nearly \
             independent: at most {} more",
            rows.map(|row| digits(row.technique_ms.p50)).join(" / "),
            [few, own, many].map(|row| row.triangles.to_string()).join(" / "),
            growth_text(all),
            percent(LITTLE)
        ),
        verdict: Verdict::of_growth(all, LITTLE),
    }
}

fn by_map(measured: &Measured) -> Claim {
    let time = |row: &Row| row.technique_ms.p50;
    let fit = power(PAPER, measured, time);
    let rises =
        MAPS.windows(2).all(|pair| time(measured.row(PAPER, pair[0])) < time(measured.row(PAPER, pair[1])));
    Claim {
        letter: 'e',
        claim: "the cost grows with the resolution of the shadow map, one vertex a texel",
        measured: format!(
            "ms {}; ∝ size to the {}, where 2 would be the vertices alone and 0 the pixels",
            by_maps(PAPER, measured, |row| digits(time(row))),
            exponent(fit)
        ),
        verdict: rises.into(),
    }
}

fn by_lights(measured: &Measured) -> Claim {
    let rows = LIGHTS.map(|lights| measured.with_lights(lights));
    let [one, two, four] = rows;
    let double = growth(two, four);
    Claim {
        letter: 'f',
        claim: "each light is a mesh of its own: the cost grows with their number",
        measured: format!(
            "{} ms with 1 / 2 / 4 lights (sun; sun and lamp of six maps; both twice; maps of {SMALL_MAP}²); {} from two to \
             four, in proportion +100 %; {} from one to two",
            rows.map(|row| digits(row.technique_ms.p50)).join(" / "),
            growth_text(double),
            growth_text(growth(one, two))
        ),
        verdict: Verdict::of_change(double, 1.0 - PROPORTION..=1.0 + PROPORTION),
    }
}

fn no_tessellation(measured: &Measured) -> Claim {
    // Positive where the adaptive mesh takes longer.
    let gains = MAPS.map(|map| growth(measured.row(PAPER, map), measured.row(ADAPTIVE, map)));
    let verdicts = gains.map(|gain| Verdict::of_growth(Growth { median: -gain.median, ..gain }, 0.0));
    let verdict = match () {
        () if verdicts.iter().all(|verdict| *verdict == Verdict::Holds) => Verdict::Holds,
        () if verdicts.contains(&Verdict::DoesNotHold) => Verdict::DoesNotHold,
        () => Verdict::CannotTell,
    };
    let texts: Vec<String> =
        MAPS.iter().zip(gains).map(|(map, gain)| format!("{map}²: {}", growth_text(gain))).collect();
    Claim {
        letter: 'g',
        claim: "below shadow maps of 4096² the full mesh is fast, and adaptive tessellation may be left out",
        measured: format!(
            "our adaptive mesh (built on the GPU, not the paper's) takes over the full one {}; holds where it is never \
             faster. How either scales to a GPU, which sets up triangles in hardware, this adapter does not say if it is \
             one in software",
            texts.join(", ")
        ),
        verdict,
    }
}

fn table(measured: &Measured) -> Claim {
    Claim {
        letter: 'h',
        claim: "airlight can be looked up in a table of 1024x512 without harm",
        measured: format!(
            "{} relative RMS between table and quadrature on the same mesh of {SHADOW_MAP}²; without harm: under {}",
            percent(measured.table_error),
            percent(TABLE)
        ),
        verdict: (measured.table_error < TABLE).into(),
    }
}

/// Time of a march that errs as much as `wanted`, between the numbers of steps that were taken; none where no number is
/// enough, the time of the fewest steps where that is.
fn march_time(measured: &Measured, technique: &str, wanted: f64) -> Option<f64> {
    let row = |steps: &u32| measured.row(&format!("{technique}-{steps}"), SHADOW_MAP);
    let point = |row: &Row| (error(row), row.technique_ms.p50);
    let points: Vec<(f64, f64)> = STEPS_OF_MARCH.iter().map(|steps| point(row(steps))).collect();
    time_at(&points, wanted)
}

/// Time at an error, by the logarithms between points of falling error.
fn time_at(points: &[(f64, f64)], wanted: f64) -> Option<f64> {
    let first = points.first()?;
    if first.0 <= wanted {
        return Some(first.1);
    }
    let pair = points.windows(2).find(|pair| pair[1].0 <= wanted)?;
    let share = (pair[0].0 / wanted).ln() / (pair[0].0 / pair[1].0).ln();
    Some(pair[0].1 * (pair[1].1 / pair[0].1).powf(share))
}

fn faster_than_marching(measured: &Measured) -> Claim {
    let mut texts = Vec::new();
    let mut all_faster = true;
    for (name, method) in super::SETTINGS {
        let row = measured.row(method, SHADOW_MAP);
        let times = ["ray-march", "ray-march-equiangular"]
            .map(|technique| march_time(measured, technique, error(row)));
        let best = times.into_iter().flatten().reduce(f64::min);
        all_faster &= best.is_none_or(|time| row.technique_ms.p50 < time);
        texts.push(format!(
            "{name}: {} ms at {}, a march as right {}",
            digits(row.technique_ms.p50),
            percent(error(row)),
            times
                .map(|time| time
                    .map_or("not at all up to 1024 steps".into(), |time| format!("{} ms", digits(time))))
                .join(" (equal steps), ")
                + " (equi-angular)"
        ));
    }
    Claim {
        letter: 'i',
        claim: "faster than ray marching of equal quality",
        measured: format!("maps of {SHADOW_MAP}², {}; the march as fast as we can make it", texts.join("; ")),
        verdict: all_faster.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_at_an_error_is_read_between_two_points() {
        let points = [(0.4, 1.0), (0.1, 4.0), (0.2, 8.0)];
        assert_eq!(time_at(&points, 0.5), Some(1.0));
        assert!((time_at(&points, 0.2).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(time_at(&points, 0.05), None);
    }
}
