//! What the paper's text claims, each claim held against measurements.

use super::super::Press;
use super::super::claims::{self, Claim};
use super::super::verdict::{Growth, Verdict, signed};
use super::sweep::{Case, Point, Series};
use super::{heading, paper};
use crate::failure::Failure;
use crate::fit::Fit;
use crate::report::{digits, percent};
use chen_planes::{Options, Renderer};
use common::Scene;
use common::scene::builtin::{HALL_TRIANGLES, WINDOW_TRIANGLES, hall_with_map, window_with_map};

/// How times were taken, and of what.
const HOW: &str = "Medians of frames drawn in turn, everything moving; spread: largest less smallest over the median. \
         Growths are medians of the ratios within each round, ± half of what the middle half of the rounds spans; a \
         verdict is given where all of that says the same. (a) and \
         (b) at 256² and 64² texels of depth and light map, (a) with lattices of 32x32; (c) and (d) with 50 planes of \
         64x64; (e) as rows 4(f) and 5.";

/// Steps of progress: one for each series.
pub(super) const STEPS: u64 = 5;

/// A series goes on for so long on a software adapter \[s\].
const BUDGET: f64 = 10.0;

/// From this share of the variance on, times lie on a line.
const LINEAR: f64 = 0.98;
/// Largest growth of the frame that is "a little": the paper's own rows have 8 and 9 %.
const LITTLE: f64 = 0.10;
/// What the claim of "about 10 %" may be: 9 and 10 frames per second are rounded.
const ABOUT_TENTH: f64 = 0.15;

/// Measures and writes; gives the table as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let series = measure(press)?;
    let claims = judge(&series);
    let value = serde_json::to_value(&series).map_err(|error| Failure::Run(error.to_string()))?;
    let more = serde_json::Map::from_iter([("series".to_owned(), value)]);
    claims::write(press, &heading(press), HOW, &claims, more)
}

/// One after the other: planes, lattice, depth map, light map, triangles.
fn measure(press: &Press<'_>) -> Result<Vec<Series>, Failure> {
    let windows = [64, 128, 256, 1024].map(|map| window_with_map(WINDOW_TRIANGLES, map));
    let row =
        |x: u32, shadow_map: u32, options: Options| Case { x: f64::from(x), scene: 0, shadow_map, options };
    let planes = [10, 25, 50, 100, 200].map(|planes| row(planes, 256, paper(planes, 32)));
    let lattice = [2, 16, 32, 64, 96, 128].map(|points| row(points * points, 256, paper(50, points)));
    let depth = [256, 512, 1024, 2048].map(|size| row(size, size, paper(50, 64)));
    let light = [0, 1, 2, 3].map(|scene| {
        let size = [64, 128, 256, 1024][scene];
        Case { scene, ..row(size, 512, paper(50, 64)) }
    });
    let halls = [
        window_with_map(WINDOW_TRIANGLES, 128),
        hall_with_map(4_000, 128),
        hall_with_map(HALL_TRIANGLES, 128),
    ];
    let triangles = [0, 1, 2].map(|scene| Case { scene, ..row(scene as u32, 512, paper(100, 96)) });
    let measure =
        |what, scenes: &[Scene], cases: &[Case]| Series::measure(press, what, scenes, cases, BUDGET);
    Ok(vec![
        measure("planes", &windows, &planes)?,
        measure("lattice points", &windows, &lattice)?,
        measure("texels on a side of the depth map", &windows, &depth)?,
        measure("texels on a side of the light map", &windows, &light)?,
        measure("scene: 0 window, 1 hall of 4 000 triangles, 2 hall of 43 000", &halls, &triangles)?,
    ])
}

fn growth(from: f64, to: f64) -> f64 {
    to / from - 1.0
}

fn judge(series: &[Series]) -> Vec<Claim> {
    let [planes, lattice, depth, light, scenes] = series else { return Vec::new() };
    let bytes = |points: u32| points * points * 8 + (points - 1) * (points - 1) * 24;
    let fixed = "by the way it is built: ";
    vec![
        by_planes(planes),
        by_lattice(lattice),
        Claim {
            letter: 'c',
            claim: "a larger depth texture costs a little (256² to 512²: 26 to 24 fps)",
            ..little(depth, [256.0, 512.0, 2048.0])
        },
        Claim {
            letter: 'd',
            claim: "a larger light map costs a little (64² to 256²: 24 to 22 fps)",
            ..little(light, [64.0, 256.0, 1024.0])
        },
        by_triangles(scenes),
        Claim {
            letter: 'f',
            claim: "objects are drawn twice in all, for the depth map and as they are seen; the shafts need no \
                    further pass over them",
            measured: format!(
                "{fixed}the technique's passes ({}) are given depth and shadow maps, and no object. Our frame draws \
                 the objects a third time, for a depth of its own before they are lit",
                Renderer::PASSES.join(", ")
            ),
            verdict: Verdict::Holds,
        },
        Claim {
            letter: 'g',
            claim: "the refinement pattern is uploaded once and serves all planes",
            measured: format!(
                "{fixed}{} KiB for 96x96 points once, 48 bytes a plane and frame, one instanced draw a light",
                bytes(96) / 1024
            ),
            verdict: Verdict::Holds,
        },
    ]
}

fn line(fit: Option<Fit>, unit: &str) -> String {
    fit.map_or("no line".into(), |Fit { slope, intercept, r2 }| {
        let slope = if slope.abs() < 0.01 { format!("{slope:.2e}") } else { digits(slope) };
        format!("{} ms + {slope} ms a {unit}, R² {r2:.4}", digits(intercept))
    })
}

fn times(series: &Series) -> String {
    let text = |point: &Point| format!("{}: {}", point.x, digits(point.planes_ms.p50));
    series.points.iter().map(text).collect::<Vec<_>>().join(", ")
}

fn by_planes(series: &Series) -> Claim {
    let at_hundred = series.at(100.0).planes_ms.p50;
    let holds = series.fit.is_some_and(|fit| fit.r2 >= LINEAR && fit.intercept.abs() < 0.1 * at_hundred);
    Claim {
        letter: 'a',
        claim: "frames per second are inversely proportional to the number of planes",
        measured: format!(
            "planes' pass {} (ms by planes: {}; spread at most {}); proportional where R² is at least {LINEAR} and \
             the intercept under a tenth of the time of 100 planes",
            line(series.fit, "plane"),
            times(series),
            percent(series.planes_spread())
        ),
        verdict: holds.into(),
    }
}

fn by_lattice(series: &Series) -> Claim {
    let times_only: Vec<f64> = series.points.iter().map(|point| point.planes_ms.p50).collect();
    let rises = growth(times_only[0], times_only[times_only.len() - 1]);
    let verdict = match () {
        () if rises > series.planes_spread() => Verdict::Holds,
        () if rises > 0.0 => Verdict::CannotTell,
        () => Verdict::DoesNotHold,
    };
    Claim {
        letter: 'b',
        claim: "a finer lattice takes longer",
        measured: format!(
            "50 planes: planes' pass {} (ms by points: {}; spread at most {}); {} from 4 to 16 384 points",
            line(series.fit, "point"),
            times(series),
            percent(series.planes_spread()),
            signed(rises)
        ),
        verdict,
    }
}

/// Growth of the frame and of the planes' pass.
fn growths(from: &Point, to: &Point) -> [Growth; 2] {
    [
        Growth::of(&from.frame_samples_ms, &to.frame_samples_ms),
        Growth::of(&from.planes_samples_ms, &to.planes_samples_ms),
    ]
}

fn growth_text(Growth { median, apart }: Growth) -> String {
    format!("{} (±{})", signed(median), percent(0.5 * apart))
}

/// What the larger maps add to the frame, from the first size to the second, as in the paper, and to the third.
fn little(series: &Series, [small, large, largest]: [f64; 3]) -> Claim {
    let [a, b, c] = [small, large, largest].map(|size| series.at(size));
    let [frame, planes] = growths(a, b);
    let [frame_more, planes_more] = growths(a, c);
    let shadow_maps = |point: &Point| point.shadow_maps_ms.map_or("–".into(), |ms| digits(ms.p50));
    Claim {
        letter: '?',
        claim: "",
        measured: format!(
            "{small}² to {large}²: frame {}, planes' pass {}; to {largest}²: frame {}, planes' pass {}; shadow map {} \
             / {} / {} ms; a little: at most {} more of the frame",
            growth_text(frame),
            signed(planes.median),
            growth_text(frame_more),
            signed(planes_more.median),
            shadow_maps(a),
            shadow_maps(b),
            shadow_maps(c),
            percent(LITTLE)
        ),
        verdict: Verdict::of_growth(frame, LITTLE),
    }
}

fn by_triangles(series: &Series) -> Claim {
    let [window, few, many] = [0.0, 1.0, 2.0].map(|scene| series.at(scene));
    let rest = |point: &Point| point.frame_ms.p50 - point.planes_ms.p50;
    // What more triangles cost where they are drawn: all but the planes' pass, which draws none of them.
    let rests = |point: &Point| -> Vec<f64> {
        point
            .frame_samples_ms
            .iter()
            .zip(&point.planes_samples_ms)
            .map(|(frame, planes)| frame - planes)
            .collect()
    };
    let without: Vec<f64> = many
        .frame_samples_ms
        .iter()
        .zip(rests(many).iter().zip(rests(few)))
        .map(|(frame, (many, few))| frame - (many - few))
        .collect();
    let cost = Growth::of(&without, &many.frame_samples_ms);
    let [frame_few, planes_few] = growths(few, many).map(growth_text);
    let [frame_window, planes_window] = growths(window, many).map(growth_text);
    Claim {
        letter: 'e',
        claim: "43 000 triangles cost about 10 % of the frame (10 to 9 fps)",
        measured: format!(
            "the hall's frame with 43 000 triangles ({} ms): {frame_few} to the hall of 4 000, {frame_window} to \
             `window`; the planes' pass alone: {planes_few} and {planes_window}, which is what the view shows and not \
             the triangles' cost. All but the planes' pass: {} / {} / {} ms (window, hall of 4 000, of 43 000), so \
             that 39 000 triangles more add {} to the frame; about 10 %: at most {}",
            digits(many.frame_ms.p50),
            digits(rest(window)),
            digits(rest(few)),
            digits(rest(many)),
            growth_text(cost),
            percent(ABOUT_TENTH)
        ),
        verdict: Verdict::of_growth(cost, ABOUT_TENTH),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_own_rows_keep_its_claims() {
        assert!(growth(1.0 / 26.0, 1.0 / 24.0) <= LITTLE && growth(1.0 / 24.0, 1.0 / 22.0) <= LITTLE);
        assert_eq!(Verdict::of_growth(Growth::of(&[0.1], &[1.0 / 9.0]), ABOUT_TENTH), Verdict::Holds);
        assert_eq!(signed(-0.5), "−50.0 %");
    }
}
