//! What paper and supplement claim, each claim held against measurements.

use serde_json::Map;

use super::super::Press;
use super::super::claims::{self, Claim};
use super::super::verdict::{Growth, Verdict, signed};
use super::measured::{ADAPTIVE, COUNTS, Group, LIGHTS, MAPS, Measured, Row, SMALL_MAP, STEPS_OF_MARCH};
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
    technique's own passes, the cases of a claim in turn, everything moving; growths are medians of the ratios within each round, ± \
    half of what the middle half of the rounds spans. Errors: relative RMSE of the airlight at time 0.";

/// Judges and writes; gives the table as Markdown.
pub(super) fn make(press: &Press<'_>, heading: &str, measured: &Measured) -> Result<String, Failure> {
    let mut claims: Vec<Claim> = judge(measured).into();
    claims.insert(2, real_time(press, measured));
    let rows = serde_json::to_value(&measured.rows).map_err(|error| Failure::Run(error.to_string()))?;
    let more = Map::from_iter([
        ("rows".to_owned(), rows),
        ("table_error".to_owned(), measured.table_error.into()),
        ("uncertainty".to_owned(), measured.uncertainty.into()),
    ]);
    claims::write(press, heading, HOW, &claims, more)
}

/// All that does not depend on what kind of adapter this is.
fn judge(measured: &Measured) -> [Claim; 8] {
    [
        exact(measured),
        no_steps(measured),
        by_triangles(measured),
        by_map(measured),
        by_lights(measured),
        no_tessellation(measured),
        table(measured),
        faster_than_marching(measured),
    ]
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
    MAPS.map(|map| format!("{map}²: {}", text(measured.row(Group::Maps, name, map)))).join(", ")
}

/// `y ∝ size^slope`.
fn power(name: &str, measured: &Measured, value: impl Fn(&Row) -> f64) -> Option<Fit> {
    Fit::power(&MAPS.map(|map| (f64::from(map), value(measured.row(Group::Maps, name, map)))))
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
    let march =
        |steps: u32| measured.row(Group::Marches, &format!("ray-march-equiangular-{steps}"), SHADOW_MAP);
    let marches = STEPS_OF_MARCH.map(|steps| format!("{steps}: {}", percent(error(march(steps)))));
    Claim {
        letter: 'b',
        claim: "no sampling along view rays: nothing that more steps would improve",
        measured: format!(
            "by the way it is built: {} by the default and {} by the paper's setting with maps of {SHADOW_MAP}², at once. \
             Error of a march through the same maps by its steps: {}",
            percent(error(measured.row(Group::Marches, super::DEFAULT, SHADOW_MAP))),
            percent(error(measured.row(Group::Marches, PAPER, SHADOW_MAP))),
            marches.join(", ")
        ),
        verdict: Verdict::Holds,
    }
}

fn real_time(press: &Press<'_>, measured: &Measured) -> Claim {
    let fps = 1e3 / measured.row(Group::Marches, PAPER, SHADOW_MAP).frame_ms.p50;
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
    let rises = MAPS.windows(2).all(|pair| {
        time(measured.row(Group::Maps, PAPER, pair[0])) < time(measured.row(Group::Maps, PAPER, pair[1]))
    });
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
    let gains = MAPS
        .map(|map| growth(measured.row(Group::Maps, PAPER, map), measured.row(Group::Maps, ADAPTIVE, map)));
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
    let row = |steps: &u32| measured.row(Group::Marches, &format!("{technique}-{steps}"), SHADOW_MAP);
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
        let row = measured.row(Group::Marches, method, SHADOW_MAP);
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
    use crate::record::Spread;

    /// As the paper has it: error in proportion to the texel, time by the mesh and lights alone, marches slow.
    fn as_claimed() -> Measured {
        let row = |group: Group,
                   name: &str,
                   map: u32,
                   (triangles, lights): (u32, usize),
                   ms: f64,
                   error: Option<f64>| Row {
            group,
            triangles: triangles as usize,
            lights,
            name: name.into(),
            shadow_map_size: map,
            frames: 2,
            technique_ms: Spread::of(&[ms, ms]),
            frame_ms: Spread::of(&[ms, ms]),
            rel_rmse: error,
            bias: error,
            technique_samples_ms: vec![ms; 2],
            frame_samples_ms: vec![ms; 2],
        };
        let of_map = |map: u32| (f64::from(map).powi(2) * 1e-4, Some(10.0 / f64::from(map)));
        let figure = (COUNTS[1], LIGHTS[1]);
        let mut rows = Vec::new();
        for map in MAPS {
            let (ms, error) = of_map(map);
            rows.push(row(Group::Maps, PAPER, map, figure, ms, error));
            rows.push(row(Group::Maps, ADAPTIVE, map, figure, 1.5 * ms, error));
        }
        let (ms, _) = of_map(SMALL_MAP);
        rows.extend(COUNTS.map(|count| row(Group::Triangles, PAPER, SMALL_MAP, (count, 2), ms, None)));
        rows.extend(LIGHTS.map(|lights| {
            row(Group::Lights, PAPER, SMALL_MAP, (COUNTS[1], lights), ms * lights as f64, None)
        }));
        let march = |name: &str, ms, error| row(Group::Marches, name, SHADOW_MAP, figure, ms, error);
        let (ms, error) = of_map(SHADOW_MAP);
        rows.extend([PAPER, super::super::DEFAULT].map(|name| march(name, ms, error)));
        for technique in ["ray-march", "ray-march-equiangular"] {
            rows.extend(STEPS_OF_MARCH.map(|steps| {
                let steps_of = f64::from(steps);
                march(&format!("{technique}-{steps}"), steps_of, Some(2.0 / steps_of))
            }));
        }
        Measured { rows, table_error: 0.001, uncertainty: 0.0 }
    }

    fn verdicts(measured: &Measured) -> Vec<Verdict> {
        judge(measured).map(|claim| claim.verdict).into()
    }

    #[test]
    fn claims_hold_where_all_is_as_claimed_and_not_where_it_is_not() {
        assert_eq!(verdicts(&as_claimed()), [Verdict::Holds; 8]);
        // What is changed of which rows, and the one verdict that falls: its place among the claims.
        type Change = (fn(&Row) -> bool, fn(&mut Row), usize);
        let slow = |row: &mut Row| {
            row.technique_samples_ms.iter_mut().for_each(|ms| *ms *= 3.0);
            row.technique_ms.p50 *= 3.0;
        };
        let changes: [Change; 4] = [
            (
                |row| row.group == Group::Maps && row.shadow_map_size == MAPS[3],
                |row| row.rel_rmse = Some(0.08),
                0,
            ),
            (|row| row.triangles == COUNTS[2] as usize, slow, 2),
            (|row| row.lights == LIGHTS[2], slow, 4),
            (|row| row.name.starts_with("ray-march"), |row| row.technique_ms.p50 *= 0.01, 7),
        ];
        for (of, change, which) in changes {
            let mut measured = as_claimed();
            measured.rows.iter_mut().filter(|row| of(row)).for_each(change);
            let found = verdicts(&measured);
            for (index, verdict) in found.iter().enumerate() {
                let expected = if index == which { Verdict::DoesNotHold } else { Verdict::Holds };
                assert_eq!(*verdict, expected, "{which}: {found:?}");
            }
        }
    }

    #[test]
    fn a_time_at_an_error_is_read_between_two_points() {
        let points = [(0.4, 1.0), (0.1, 4.0), (0.2, 8.0)];
        assert_eq!(time_at(&points, 0.5), Some(1.0));
        assert!((time_at(&points, 0.2).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(time_at(&points, 0.05), None);
    }
}
