//! What is promised of the sorted shadow planes; [`super::biri_bench`] measures it.

use serde::Serialize;

use super::Target;
use crate::report::{digits, percent};

const NAME: &str = "biri-ss";

/// Scenes whose error is bounded, and the bound.
pub(super) const SCENES: [&str; 3] = ["pen", "amphora", "cathedral"];
pub(super) const ERROR: f64 = 0.005;
/// The same for the user's cathedral.
pub(super) const SIBENIK_ERROR: f64 = 0.01;
/// Indirect light against that of an unbounded medium: scene and bound.
pub(super) const INDIRECT: (&str, f64) = ("pen", 0.01);
/// Share of the pixels that are left out there: rasterisation snaps corners to 1/256 of a pixel, so that a
/// few pixels at edges show another surface than the reference does.
pub(super) const EDGES: f64 = 1e-4;
/// Part of either side of the pictures that nothing is compared with, and of the frames that are timed.
pub(super) const SMALL: [u32; 2] = [4, 8];
/// Half planes on which the order is checked.
pub(super) const RAYS: u32 = 2000;
/// Silhouettes of the scene with the most triangles, for one light on one core \[ms\].
pub(super) const SILHOUETTES: (&str, f64) = ("complex-camera", 5.0);
/// All tables of a phase function \[ms\].
const TABLES: f64 = 300.0;
/// Size of the paper's airlight table.
pub(super) const TEXELS: [usize; 2] = [256, 512];
/// The path into a shadow: scene, frames, size, and the largest step of the error from frame to frame.
pub(super) const PATH: (&str, usize, (u32, u32), f64) = ("amphora", 40, (64, 52), 0.005);
/// Growth of cost: scene, triangles, and the largest exponent of cost over silhouette edges; above 1 by what
/// times on a busy machine scatter.
pub(super) const GROWTH: (&str, [u32; 3], f64) = ("complex", [10_000, 30_000, 110_000], 1.1);
/// Times that a measurement on the CPU is repeated.
pub(super) const REPEATS: usize = 9;

/// Everything measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Measured {
    pub shots: Vec<Shot>,
    pub silhouettes_ms: f64,
    pub tables_ms: f64,
    pub path: Vec<Step>,
    pub growth: Vec<Cost>,
}

/// One scene at time 0 by the default setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Shot {
    pub scene: String,
    /// Of the airlight against the reference; null where no bound is promised.
    pub rel_rmse: Option<f64>,
    /// Largest `rel_rmse` that is right.
    pub bound: Option<f64>,
    /// Of indirect light against that of an unbounded medium: of all pixels, and without those that differ
    /// most; null where no bound is promised.
    pub indirect_rel_rmse: Option<[f64; 2]>,
    /// Pixels of all terms that are NaN, infinite or negative.
    pub broken: usize,
    /// Pixels of either that differ when the frame is drawn again.
    pub unsteady: usize,
    /// Pairs of planes in the wrong order.
    pub violations: usize,
    pub silhouette_edges: usize,
    pub planes: usize,
}

/// A frame of the path into a shadow.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Step {
    pub rel_rmse: f64,
    /// Shadows that the eye is in, by light.
    pub eye_depths: Vec<u32>,
}

/// What a frame costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Cost {
    pub triangles: usize,
    pub silhouette_edges: f64,
    /// Preparing on the CPU, and all passes of the technique.
    pub prepare_ms: f64,
    pub passes_ms: f64,
}

/// Exponent of cost over silhouette edges.
fn growth_exponent(costs: &[Cost]) -> f64 {
    let points: Vec<_> = costs.iter().map(|c| (c.silhouette_edges, c.prepare_ms + c.passes_ms)).collect();
    crate::fit::Fit::power(&points).map_or(f64::NAN, |fit| fit.slope)
}

/// Largest change of the error from frame to frame; NaN where the path does not lead into a shadow.
fn largest_step(path: &[Step]) -> f64 {
    let enters = path.windows(2).any(|pair| pair[0].eye_depths != pair[1].eye_depths);
    let steps = path.windows(2).map(|pair| (pair[1].rel_rmse - pair[0].rel_rmse).abs());
    // Unlike `f64::max`, any NaN stays.
    let largest =
        steps.fold(0.0, |largest: f64, step| if step > largest || step.is_nan() { step } else { largest });
    if enters { largest } else { f64::NAN }
}

/// Every promise, from what was measured alone.
pub(super) fn targets(measured: &Measured) -> Vec<Target> {
    let target =
        |what: String, at_most: f64, value: f64, text: String| Target::new(NAME, what, at_most, value, text);
    let mut targets = Vec::new();
    let mut bounded = |scene: &str, shot: Option<&Shot>, bound: f64| {
        let value = shot.and_then(|shot| shot.rel_rmse).unwrap_or(f64::NAN);
        let what = format!("{scene}: relative RMSE of the airlight at most {}", percent(bound));
        targets.push(target(what, bound, value, percent(value)));
    };
    for scene in SCENES {
        bounded(scene, measured.shots.iter().find(|shot| shot.scene == scene), ERROR);
    }
    let others = measured.shots.iter().filter(|shot| !SCENES.contains(&shot.scene.as_str()));
    for (shot, bound) in others.filter_map(|shot| shot.bound.map(|bound| (shot, bound))) {
        bounded(&shot.scene, Some(shot), bound);
    }
    let (scene, bound) = INDIRECT;
    let shot = measured.shots.iter().find(|shot| shot.scene == scene);
    let [all, value] = shot.and_then(|shot| shot.indirect_rel_rmse).unwrap_or([f64::NAN; 2]);
    let what = format!(
        "{scene}: relative RMSE of the indirect light at most {} against an unbounded medium, {} of \
         the pixels (edges) left out",
        percent(bound),
        percent(EDGES)
    );
    targets.push(target(what, bound, value, format!("{} (all pixels {})", percent(value), percent(all))));
    let counts = |count: fn(&Shot) -> usize| measured.shots.iter().map(count).collect::<Vec<_>>();
    targets.extend([
        Target::none(NAME, "NaN, infinite and negative pixels of all terms: none", counts(|s| s.broken)),
        Target::none(NAME, "pixels that differ where a frame is drawn twice: none", counts(|s| s.unsteady)),
        Target::none(
            NAME,
            "pairs of planes in the wrong order on 2000 half planes through light and eye: none",
            counts(|s| s.violations),
        ),
        target(
            format!("silhouettes of {}, one light, one core: at most {} ms", SILHOUETTES.0, SILHOUETTES.1),
            SILHOUETTES.1,
            measured.silhouettes_ms,
            format!("{} ms", digits(measured.silhouettes_ms)),
        ),
        target(
            format!("all tables of a phase function on all cores: at most {TABLES} ms"),
            TABLES,
            measured.tables_ms,
            format!("{} ms", digits(measured.tables_ms)),
        ),
    ]);
    let (scene, frames, _, bound) = PATH;
    let step = largest_step(&measured.path);
    let worst = measured.path.iter().map(|step| step.rel_rmse).fold(f64::NAN, f64::max);
    targets.push(target(
        format!(
            "{scene}, {frames} frames into a shadow: error from frame to frame changes by at most {}",
            percent(bound)
        ),
        bound,
        step,
        format!("{} (largest error {})", percent(step), percent(worst)),
    ));
    let (scene, _, bound) = GROWTH;
    let exponent = growth_exponent(&measured.growth);
    let points = measured.growth.iter().map(|cost| {
        format!("{} edges: {} ms", cost.silhouette_edges, digits(cost.prepare_ms + cost.passes_ms))
    });
    targets.push(target(
        format!("{scene} of more and more triangles: cost grows with silhouette edges to the power of at most {bound}"),
        bound,
        exponent,
        format!("{} ({})", digits(exponent), points.collect::<Vec<_>>().join(", ")),
    ));
    targets
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Measured {
        let shot = |scene: &str| Shot {
            scene: scene.into(),
            rel_rmse: Some(0.001),
            bound: Some(ERROR),
            indirect_rel_rmse: Some([0.07, 0.001]),
            broken: 0,
            unsteady: 0,
            violations: 0,
            silhouette_edges: 9,
            planes: 9,
        };
        let step = |rel_rmse, depth| Step { rel_rmse, eye_depths: vec![depth] };
        let cost = |edges: f64| Cost {
            triangles: 9,
            silhouette_edges: edges,
            prepare_ms: 0.5 * edges,
            passes_ms: 0.5 * edges,
        };
        Measured {
            shots: SCENES.map(shot).to_vec(),
            silhouettes_ms: 1.0,
            tables_ms: 1.0,
            path: vec![step(0.001, 0), step(0.002, 1)],
            growth: [10.0, 20.0, 50.0].map(cost).to_vec(),
        }
    }

    #[test]
    fn each_promise_can_be_missed() {
        let missed = |change: fn(&mut Measured)| {
            let mut measured = good();
            change(&mut measured);
            targets(&measured).iter().filter(|target| !target.holds).count()
        };
        assert_eq!(missed(|_| ()), 0);
        assert_eq!(missed(|m| m.shots[1].rel_rmse = Some(0.006)), 1);
        assert_eq!(missed(|m| m.shots[0].indirect_rel_rmse = Some([0.011; 2])), 1);
        assert_eq!(missed(|m| m.shots[2].broken = 1), 1);
        assert_eq!(missed(|m| m.shots[0].unsteady = 1), 1);
        assert_eq!(missed(|m| m.shots[0].violations = 1), 1);
        assert_eq!(missed(|m| m.silhouettes_ms = 6.0), 1);
        assert_eq!(missed(|m| m.tables_ms = f64::NAN), 1);
        assert_eq!(missed(|m| m.path[1].rel_rmse = 0.01), 1);
        assert_eq!(missed(|m| m.path[1].rel_rmse = f64::NAN), 1);
        assert_eq!(missed(|m| m.path[1].eye_depths = vec![0]), 1, "no shadow entered");
        assert_eq!(missed(|m| m.growth[2].passes_ms = 100.0), 1);
        let sibenik = |m: &mut Measured| {
            m.shots.push(Shot {
                scene: "s".into(),
                bound: Some(0.01),
                rel_rmse: Some(0.011),
                ..m.shots[0].clone()
            });
        };
        assert_eq!(missed(sibenik), 1);
        // What was not measured does not hold.
        assert_eq!(
            missed(|m| *m = Measured {
                shots: vec![],
                silhouettes_ms: f64::NAN,
                tables_ms: f64::NAN,
                path: vec![],
                growth: vec![]
            }),
            11
        );
    }

    #[test]
    fn the_exponent_of_a_power_is_found() {
        let cost = |edges: f64| Cost {
            triangles: 0,
            silhouette_edges: edges,
            prepare_ms: 0.0,
            passes_ms: edges.powf(0.7),
        };
        assert!((growth_exponent(&[3.0, 30.0, 500.0].map(cost)) - 0.7).abs() < 1e-12);
    }
}
