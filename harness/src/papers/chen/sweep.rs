//! Times against one thing that is varied.

use chen_planes::Options;
use common::Scene;
use serde::Serialize;

use super::super::Press;
use super::{planes_ms, shadow_maps_ms, technique};
use crate::failure::Failure;
use crate::fit::Fit;
use crate::measure::{Stage, Times, Turn, times_in_turn};
use crate::record::Spread;

/// One thing to be timed.
pub(super) struct Case {
    pub x: f64,
    /// Index of the scene.
    pub scene: usize,
    pub shadow_map: u32,
    pub options: Options,
}

/// What was found, and a line through the times of the planes' pass.
#[derive(Debug, Serialize)]
pub(super) struct Series {
    pub what: &'static str,
    pub points: Vec<Point>,
    pub fit: Option<Fit>,
}

/// Times \[ms\] of one case.
#[derive(Debug, Serialize)]
pub(super) struct Point {
    pub x: f64,
    pub frames: usize,
    pub planes_ms: Spread,
    /// Null without timestamps.
    pub shadow_maps_ms: Option<Spread>,
    pub frame_ms: Spread,
    /// How far the times of the planes' pass are apart at most, over their median.
    pub planes_spread: f64,
    /// Round by round.
    pub planes_samples_ms: Vec<f64>,
    pub frame_samples_ms: Vec<f64>,
}

/// Largest less smallest, over the median.
fn apart(times: &[f64]) -> f64 {
    let Spread { p50, max, .. } = Spread::of(times);
    (max - times.iter().copied().fold(max, f64::min)) / p50
}

impl Point {
    fn of(x: f64, times: &Times) -> Self {
        let planes = times.passes.get(super::PLANES).unwrap_or(&times.wall);
        Self {
            x,
            frames: times.frame.len(),
            planes_ms: planes_ms(times),
            shadow_maps_ms: shadow_maps_ms(times),
            frame_ms: Spread::of(&times.frame),
            planes_spread: apart(planes),
            planes_samples_ms: planes.clone(),
            frame_samples_ms: times.frame.clone(),
        }
    }
}

impl Series {
    /// Times all cases in turn, for about `budget` \[s\] where times are few.
    pub(super) fn measure(
        press: &Press<'_>,
        what: &'static str,
        scenes: &[Scene],
        cases: &[Case],
        budget: f64,
    ) -> Result<Self, Failure> {
        press.progress.doing(&format!("claims: {what}"));
        // A stage for each scene and size of shadow maps.
        let mut grounds: Vec<(usize, u32)> = Vec::new();
        let mut stages = Vec::new();
        let mut turns = Vec::new();
        for case in cases {
            let ground = (case.scene, case.shadow_map);
            let stage = match grounds.iter().position(|known| *known == ground) {
                Some(stage) => stage,
                None => {
                    grounds.push(ground);
                    stages.push(Stage::new(
                        press.context,
                        &scenes[case.scene],
                        press.timed_size,
                        case.shadow_map,
                    )?);
                    stages.len() - 1
                }
            };
            turns.push(Turn { stage, technique: technique(press, case.options, press.timed_size)? });
        }
        let times = times_in_turn(&mut stages, &mut turns, &press.frames.within(budget))?;
        let points: Vec<Point> = cases.iter().zip(&times).map(|(case, t)| Point::of(case.x, t)).collect();
        let fit = Fit::line(&points.iter().map(|point| (point.x, point.planes_ms.p50)).collect::<Vec<_>>());
        press.progress.step();
        Ok(Self { what, points, fit })
    }

    /// The point at `x`, which is one of the cases'.
    pub(super) fn at(&self, x: f64) -> &Point {
        self.points.iter().find(|point| point.x == x).unwrap_or(&self.points[0])
    }

    /// Largest spread of the planes' pass.
    pub(super) fn planes_spread(&self) -> f64 {
        self.points.iter().map(|point| point.planes_spread).fold(0.0, f64::max)
    }
}
