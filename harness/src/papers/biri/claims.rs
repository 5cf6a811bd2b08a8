//! What the paper's text claims, each claim held against measurements.

use biri_ss::Options;
use common::{Term, metrics};

use super::super::Press;
use super::super::claims::{self, Claim};
use super::super::verdict::Verdict;
use super::table::{CLAIM, Row};
use crate::cmd::{load, reference};
use crate::deferred::{Stage, Wanted};
use crate::failure::Failure;
use crate::measure::{self, Drawn};
use crate::report::{digits, percent};
use crate::techniques;

/// Steps of progress.
pub(super) const STEPS: u64 = 1;

/// The scene whose shadows are held against the reference.
const SCENE: &str = "pen";
/// Errors below this have no edge of a shadow in the wrong pixel.
const EXACT: f64 = 0.01;
/// The shadow map that the planes are held against.
const SHADOW_MAP: u32 = 512;
/// Frames per second that are real time for "moderately complex scenes".
const REAL_TIME: f64 = 30.0;
/// A larger share of the picture is not "subtle".
const SUBTLE: f64 = 0.1;

const HOW: &str = "By the frames of Table II, drawn in turn, everything moving, in the paper's setting unless said \
    otherwise; errors at the size of the timed frames, relative RMSE of the airlight.";

/// Measures what Table II leaves open, judges and writes; gives the table as Markdown. `indirect` is the share of indirect
/// light in Figure 10.
pub(super) fn make(press: &Press<'_>, heading: &str, rows: &[Row], indirect: f64) -> Result<String, Failure> {
    press.progress.doing("claims");
    let errors = errors(press)?;
    press.progress.step();
    let paper: Vec<&Row> = rows.iter().filter(|row| row.preset == "paper").collect();
    let claims = [
        cost(&paper),
        real_time(press, &paper),
        by_triangles(&paper),
        exact(errors),
        subtle(indirect),
        on_the_device(&paper),
        Claim {
            letter: 'g',
            claim: "objects, lights, camera and medium may change from frame to frame: nothing is computed beforehand for \
                    lights or camera",
            measured: "by the way it is measured: in Table II objects move (11 a), a light (11 b), camera and medium \
                       (11 c), and every frame is prepared from the scene alone"
                .into(),
            verdict: Verdict::Holds,
        },
        Claim {
            letter: 'h',
            claim: "little texture memory beside that of volume rendering",
            measured: "the tables are there once, but there is no volume renderer of that time to hold them against".into(),
            verdict: Verdict::NotTested,
        },
    ];
    claims::write(press, heading, HOW, &claims, Default::default())
}

/// Errors of the paper's setting, of the default, and of a march through a shadow map.
fn errors(press: &Press<'_>) -> Result<[f64; 3], Failure> {
    let scene = load(SCENE, None, |note| press.progress.say(note))?.at(0.0);
    let view = scene.camera.view(press.timed_size.0, press.timed_size.1);
    let rendered = reference(&scene, &view, Term::Airlight.into(), &|share| {
        press.progress.detail(format!("{SCENE}: reference, {:.0} %", 100.0 * share));
    })?;
    let truth = rendered.airlight.ok_or_else(|| Failure::Run("the reference lacks a term".into()))?;
    let error = |image: &common::image::Image| {
        metrics::compare(image, &truth).map(|e| e.rel_rmse).map_err(|error| Failure::Run(error.to_string()))
    };
    let mut stage = Stage::new(press.context, &scene, press.timed_size)?;
    let mut by_planes = |options: Options| {
        let mut renderer = stage.renderer(&options)?;
        error(&stage.pictures(&mut renderer, &scene, Wanted::default())?.airlight)
    };
    let format = press.context.radiance_format();
    let planes = [by_planes(Options::paper(format))?, by_planes(Options::best(format))?];
    let mut stage = measure::Stage::new(press.context, &scene, press.timed_size, SHADOW_MAP)?;
    let march = techniques::find_one("ray-march-equiangular-1024").map_err(Failure::Run)?;
    let (device, queue) = (&press.context.device, &press.context.queue);
    let mut march = march.make(device, queue, format, press.timed_size).map_err(Failure::Run)?;
    let march = error(&stage.picture(Some(march.as_mut()), 0.0, Drawn::Airlight)?)?;
    Ok([planes[0], planes[1], march])
}

fn each(rows: &[&Row], text: impl Fn(&Row) -> String) -> String {
    rows.iter().map(|row| format!("{} {}", row.scene, text(row))).collect::<Vec<_>>().join(", ")
}

fn cost(rows: &[&Row]) -> Claim {
    let share = |row: &Row| row.pass_cost.unwrap_or(row.cost);
    Claim {
        letter: 'a',
        claim: "indirect single scattering costs little: 3 to 8 % of the frames per second (Table II)",
        measured: format!("{}; little: under {}", each(rows, |row| percent(share(row))), percent(CLAIM)),
        verdict: rows.iter().all(|row| share(row) < CLAIM).into(),
    }
}

fn real_time(press: &Press<'_>, rows: &[&Row]) -> Claim {
    let fps = |row: &Row| row.measured[1].fps;
    let small = rows.iter().find(|row| row.scene == "pen").is_some_and(|row| fps(row) >= REAL_TIME);
    let (reason, verdict) = if press.context.software {
        ("; an adapter in software says nothing of a graphics card", Verdict::NotTested)
    } else {
        ("", small.into())
    };
    Claim {
        letter: 'b',
        claim: "more than 30 frames per second at 800x600 for moderately complex scenes (14 785 triangles)",
        measured: format!("frames per second: {}{reason}", each(rows, |row| digits(fps(row)))),
        verdict,
    }
}

fn by_triangles(rows: &[&Row]) -> Claim {
    // Of the scene with the fewest triangles over each, paper and ours.
    let over = |row: &Row, of: fn(&Row) -> f64| rows.first().map_or(f64::NAN, |first| of(first) / of(row));
    // Scenes are timed one after the other, so only frames that are all apart tell them apart.
    let samples = |row: &Row| row.measured[1].samples_ms.clone();
    let pairs = rows.windows(2).map(|pair| slower(&samples(pair[0]), &samples(pair[1])));
    let verdict = pairs.fold(Verdict::Holds, |all, pair| match (all, pair) {
        (Verdict::DoesNotHold, _) | (_, Verdict::DoesNotHold) => Verdict::DoesNotHold,
        (Verdict::Holds, pair) => pair,
        (all, _) => all,
    });
    Claim {
        letter: 'c',
        claim: "frames per second fall with the number of triangles (30, 10.2 and 7 for 14 785, 110 014 and 136 266)",
        measured: format!(
            "times as slow as the first: {}",
            each(rows, |row| format!(
                "{} (paper {})",
                digits(over(row, |row| row.measured[1].fps)),
                digits(over(row, |row| row.paper_fps[1]))
            ))
        ),
        verdict,
    }
}

/// Whether every time in `next` is longer than all in `first`; or none is.
fn slower(first: &[f64], next: &[f64]) -> Verdict {
    let least = |times: &[f64]| times.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |times: &[f64]| times.iter().copied().fold(0.0, f64::max);
    match () {
        () if least(next) > most(first) => Verdict::Holds,
        () if most(next) < least(first) => Verdict::DoesNotHold,
        () => Verdict::CannotTell,
    }
}

fn exact([paper, default, march]: [f64; 3]) -> Claim {
    Claim {
        letter: 'd',
        claim: "exact shadow planes: none of the aliasing of volume rendering and of shadow maps",
        measured: format!(
            "`{SCENE}`: error {} by the default and {} by the paper's setting, where tables and sums of 16 bits are left; \
             1024 steps through shadow maps of {SHADOW_MAP}²: {}; exact: the default under {}",
            percent(default),
            percent(paper),
            percent(march),
            percent(EXACT)
        ),
        verdict: (default < EXACT && default < march).into(),
    }
}

fn subtle(share: f64) -> Claim {
    Claim {
        letter: 'e',
        claim: "indirect single scattering introduces subtle modifications",
        measured: format!(
            "{} of all light in the picture of Figure 10; subtle: under {}",
            percent(share),
            percent(SUBTLE)
        ),
        verdict: (share < SUBTLE).into(),
    }
}

fn on_the_device(rows: &[&Row]) -> Claim {
    let share = |row: &Row| row.measured[1].prepare_ms.p50 / row.measured[1].frame_ms.p50;
    Claim {
        letter: 'f',
        claim: "except for the determination of silhouettes, all the work is done in hardware",
        measured: format!(
            "the paper's own step 4 sorts planes on the CPU, and so do we; silhouettes, sorting and uploads take of the \
             frame: {}",
            each(rows, |row| percent(share(row)))
        ),
        verdict: Verdict::DoesNotHold,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_overlap_are_no_verdict() {
        assert_eq!(slower(&[1.0, 2.0], &[2.1, 9.0]), Verdict::Holds);
        assert_eq!(slower(&[3.0, 4.0], &[1.0, 2.0]), Verdict::DoesNotHold);
        assert_eq!(slower(&[1.0, 3.0], &[2.0, 4.0]), Verdict::CannotTell);
    }
}
