//! What is promised of the illumination networks.

use common::Scene;
use common::gpu::{Context, read_floats, read_u32s};
use common::reference::multiple::scattered_power;
use common::scene::builtin;
use common::{Lobe, Phase};
use glam::Vec3;
use serde::Serialize;
use szk_network::twin::received;
use szk_network::{Colours, Options, Sampling, Scattering};

use super::{Target, broken, unsteady};
use crate::clouds::{Lab, particles};
use crate::failure::Failure;
use crate::fit::Fit;
use crate::progress::Progress;
use crate::report::percent;
use crate::truth::Truth;

/// The scene that everything is promised of.
const SCENE: &str = "sphere";
/// Particles of the promise, and those that errors and times are fitted over.
const PARTICLES: u32 = 4096;
const ERROR_PARTICLES: [u32; 4] = [256, 1024, 4096, 16384];
const TIME_PARTICLES: [u32; 4] = [1024, 2048, 4096, 8192];
/// Rounds that are timed.
const ROUNDS: usize = 5;
/// Asymmetries that energy has to stay for, steps that it has to, and particles that it is tried with.
const ASYMMETRIES: [f64; 5] = [0.0, 0.3, 0.5, 0.76, 0.9];
const ENERGY_STEPS: u32 = 200;
const ENERGY_PARTICLES: u32 = 512;
/// Paths that the power of the reference is found by.
const PATHS: u32 = 1_000_000;

/// Steps of progress.
pub(super) const STEPS: u64 = 5;

/// All that was measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Measured {
    /// Scattered power \[W\], by the network, by paths, and the standard error of the latter.
    power: [f64; 3],
    /// Particles, relative RMSE of the picture without the noise of the paths, and bias.
    errors: Vec<(u32, f64, f64)>,
    /// Asymmetry, and by how much what came in differs from what went out and what is left, in parts of what came in.
    energy: Vec<(f64, f64)>,
    /// Asymmetry, components, time of a step by them over that of the whole matrix, and both errors of the picture.
    rank: Vec<Rank>,
    /// Particles and time of a step \[ms\].
    times: Vec<(u32, f64)>,
    /// Bytes of the network as allocated, and as predicted.
    bytes: [u64; 2],
    /// Pixels that are NaN, infinite or negative, by picture.
    broken: Vec<usize>,
    /// Pixels that differ when a frame is drawn twice.
    unsteady: Vec<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Rank {
    g: f64,
    ratio: f64,
    rel_rmse: f64,
    rel_rmse_full: f64,
}

/// What everything is measured on.
pub(super) struct Bench<'a> {
    pub context: &'a Context,
    pub size: (u32, u32),
    pub progress: &'a Progress,
}

fn scene() -> Result<Scene, Failure> {
    builtin::build(SCENE, None).map_err(|error| Failure::Run(error.to_string()))
}

fn with(g: f64, albedo: f32) -> Result<Scene, Failure> {
    let mut scene = scene()?;
    if let Some(cloud) = &mut scene.cloud {
        cloud.albedo = Vec3::splat(albedo);
        cloud.phase = if g == 0.0 { Phase::isotropic() } else { Lobe::HenyeyGreenstein { g }.into() };
    }
    Ok(scene)
}

impl Bench<'_> {
    pub(super) fn measure(&self) -> Result<Measured, Failure> {
        let mut measured = Measured::default();
        self.sphere(&mut measured)?;
        self.progress.step();
        self.energy(&mut measured)?;
        self.progress.step();
        self.rank(&mut measured)?;
        self.progress.step();
        self.times(&mut measured)?;
        self.progress.step();
        self.same_bits(&mut measured)?;
        self.progress.step();
        Ok(measured)
    }

    fn options(&self) -> Options {
        Options { colours: Colours::Grey, ..Options::best(self.context.radiance_format()) }
    }

    fn lab(
        &self,
        scene: &Scene,
        count: u32,
        options: &Options,
        size: (u32, u32),
    ) -> Result<Lab<'_>, Failure> {
        Lab::new(self.context, scene, &particles(scene, count, Sampling::Even)?, options, size)
    }

    fn truth(&self, scene: &Scene) -> Result<Truth, Failure> {
        self.progress.doing(&format!("{}: paths", scene.name));
        Truth::of(scene, self.size, &|share| {
            self.progress.detail(format!("{}: paths, {:.0} %", scene.name, 100.0 * share));
        })
    }

    /// Outgoing power \[W\] that somebody receives, and that nobody does; and that of the sources.
    fn powers(&self, lab: &Lab<'_>) -> Result<[f64; 3], Failure> {
        let lost = || Failure::Run("the device was lost".into());
        let (device, queue) = (&self.context.device, &self.context.queue);
        let (Some(buffers), Some(plan)) = (lab.renderer.buffers(), lab.renderer.plan()) else {
            return Err(lost());
        };
        let count = plan.depths.len();
        let links = count * plan.windows.len();
        let neighbours = read_u32s(device, queue, buffers.neighbours, links).ok_or_else(lost)?;
        let outgoing = read_floats(device, queue, buffers.outgoing, links).ok_or_else(lost)?;
        let sources = read_floats(device, queue, buffers.sources, links).ok_or_else(lost)?;
        let [mut stays, mut leaves] = [0.0, 0.0];
        for (radiance, received) in outgoing.iter().zip(received(&neighbours, count)) {
            *(if received { &mut stays } else { &mut leaves }) += f64::from(*radiance);
        }
        let sources = sources.iter().map(|s| f64::from(*s)).sum::<f64>();
        Ok([stays, leaves, sources].map(|sum| sum * plan.power_of_radiance()))
    }

    fn sphere(&self, measured: &mut Measured) -> Result<(), Failure> {
        let scene = scene()?;
        let truth = self.truth(&scene)?;
        let by_paths = scattered_power(&scene, PATHS, 1).map_err(|error| Failure::Run(error.to_string()))?;
        for count in ERROR_PARTICLES {
            self.progress.doing(&format!("{SCENE}: {count} particles"));
            let mut lab = self.lab(&scene, count, &self.options(), self.size)?;
            let frame = lab.settle()?;
            let off = truth.off(&frame.image)?;
            measured.errors.push((count, off.rel_rmse, off.bias));
            measured.broken.push(broken(&frame.image));
            if count == PARTICLES {
                let [_, leaves, _] = self.powers(&lab)?;
                measured.power = [leaves, by_paths.scattered.mean.x, by_paths.scattered.error.x];
                if let (Some(buffers), Some(plan)) = (lab.renderer.buffers(), lab.renderer.plan()) {
                    measured.bytes = [buffers.bytes, plan.bytes(&self.options())];
                }
            }
        }
        Ok(())
    }

    /// Light that came in, against what went out and what is still on its way, step by step.
    fn energy(&self, measured: &mut Measured) -> Result<(), Failure> {
        for g in ASYMMETRIES {
            self.progress.doing(&format!("energy, g = {g}"));
            let mut lab = self.lab(&with(g, 1.0)?, ENERGY_PARTICLES, &self.options(), (8, 8))?;
            let (mut left, mut came, mut stays) = (0.0, 0.0, 0.0);
            for step in 0..ENERGY_STEPS {
                lab.draw(1, 0.0, step == 0)?;
                let [now, leaves, sources] = self.powers(&lab)?;
                (stays, left, came) = (now, left + leaves, came + sources);
            }
            measured.energy.push((g, (left + stays) / came - 1.0));
        }
        Ok(())
    }

    fn rank(&self, measured: &mut Measured) -> Result<(), Failure> {
        for g in [0.0, 0.3] {
            self.progress.doing(&format!("components against the whole matrix, g = {g}"));
            let scene = with(g, 0.9)?;
            let truth = self.truth(&scene)?;
            let full = Options { scattering: Scattering::Full, ..self.options() };
            let mut labs = [self.options(), full]
                .into_iter()
                .map(|options| self.lab(&scene, PARTICLES, &options, self.size))
                .collect::<Result<Vec<_>, _>>()?;
            let mut errors = Vec::new();
            for lab in &mut labs {
                let frame = lab.settle()?;
                errors.push(truth.off(&frame.image)?.rel_rmse);
                measured.broken.push(broken(&frame.image));
            }
            let [few, whole] = [0, 1].map(|which| which);
            let times = in_turn(&mut labs)?;
            measured.rank.push(Rank {
                g,
                ratio: times[few] / times[whole],
                rel_rmse: errors[few],
                rel_rmse_full: errors[whole],
            });
        }
        Ok(())
    }

    fn times(&self, measured: &mut Measured) -> Result<(), Failure> {
        self.progress.doing("time of a step over the number of particles");
        let scene = scene()?;
        let mut labs = TIME_PARTICLES
            .iter()
            .map(|count| self.lab(&scene, *count, &self.options(), (8, 8)))
            .collect::<Result<Vec<_>, _>>()?;
        measured.times = TIME_PARTICLES.into_iter().zip(in_turn(&mut labs)?).collect();
        Ok(())
    }

    fn same_bits(&self, measured: &mut Measured) -> Result<(), Failure> {
        self.progress.doing("a frame twice");
        let scene = scene()?;
        let draw = || {
            let mut lab = self.lab(&scene, 1024, &self.options(), (160, 128))?;
            Ok::<_, Failure>(lab.draw(20, 0.0, true)?.image)
        };
        measured.unsteady.push(unsteady(&draw()?, &draw()?));
        Ok(())
    }
}

/// Median time of a step \[ms\] of each, all in turn.
fn in_turn(labs: &mut [Lab<'_>]) -> Result<Vec<f64>, Failure> {
    let mut times = vec![Vec::new(); labs.len()];
    for round in 0..=ROUNDS {
        for (lab, times) in labs.iter_mut().zip(&mut times) {
            let frame = lab.draw(2, 0.0, false)?;
            if round > 0 {
                times.push(0.5 * frame.iterate_ms());
            }
        }
    }
    let median = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    };
    Ok(times.into_iter().map(median).collect())
}

/// Every promise, from what was measured alone.
pub(super) fn targets(measured: &Measured) -> Vec<Target> {
    let target = |what: &str, at_most: f64, value: f64, text: String| {
        Target::new("szk-network", what.into(), at_most, value, text)
    };
    let nan = f64::NAN;
    let [ours, paths, error] = measured.power;
    let off = (ours / paths - 1.0).abs();
    let of_promise = measured.errors.iter().find(|(count, ..)| *count == PARTICLES);
    let (rmse, bias) = of_promise.map_or((nan, nan), |(_, rmse, bias)| (*rmse, *bias));
    let points: Vec<(f64, f64)> = measured.errors.iter().map(|(n, rmse, _)| (f64::from(*n), *rmse)).collect();
    let slope = Fit::power(&points).map_or(nan, |fit| fit.slope);
    let worst = measured.energy.iter().map(|(_, off)| off.abs()).fold(nan, f64::max);
    let all = |values: Vec<f64>| values.into_iter().fold(nan, f64::max);
    let ratio = all(measured.rank.iter().map(|rank| rank.ratio).collect());
    let apart = all(measured.rank.iter().map(|r| (r.rel_rmse - r.rel_rmse_full).abs()).collect());
    let times: Vec<(f64, f64)> = measured.times.iter().map(|(n, ms)| (f64::from(*n), *ms)).collect();
    let r2 = Fit::line(&times).map_or(nan, |fit| fit.r2);
    let [allocated, predicted] = measured.bytes;
    let listed = |values: &mut dyn Iterator<Item = String>| values.collect::<Vec<_>>().join(", ");
    vec![
        target(
            "sphere (20 optical depths, albedo 0.9, isotropic), 4096 particles, 128 directions: scattered power within 5 % of the path tracer",
            0.05,
            off,
            format!(
                "{ours:.4} W, by paths {paths:.4} ± {error:.4} W: {:+.2} %",
                100.0 * (ours / paths - 1.0)
            ),
        ),
        target(
            "its picture within 10 % relative RMSE of the path tracer",
            0.1,
            rmse,
            format!("{} (bias {:+.1} %)", percent(rmse), 100.0 * bias),
        ),
        target(
            "the error falls as a power of the number of particles: exponent at most -0.2",
            -0.2,
            slope,
            format!(
                "{slope:.2} ({})",
                listed(&mut measured.errors.iter().map(|(n, rmse, _)| format!("{n}: {}", percent(*rmse))))
            ),
        ),
        target(
            "albedo 1: what came in is what went out and what is left, within 0.1 % over 200 steps, g up to 0.9",
            1e-3,
            worst,
            listed(&mut measured.energy.iter().map(|(g, off)| format!("g {g}: {off:+.1e}"))),
        ),
        target(
            "a step by components takes at most a fifth of one by the whole matrix, isotropic and g = 0.3",
            0.2,
            ratio,
            listed(&mut measured.rank.iter().map(|rank| format!("g {}: {:.3}", rank.g, rank.ratio))),
        ),
        target(
            "and its error is the same: within 0.2 %",
            2e-3,
            apart,
            listed(
                &mut measured
                    .rank
                    .iter()
                    .map(|r| format!("g {}: {} and {}", r.g, percent(r.rel_rmse), percent(r.rel_rmse_full))),
            ),
        ),
        target(
            "time of a step is linear in the number of particles: 1 − R² at most 0.02",
            0.02,
            1.0 - r2,
            format!("R² {r2:.4}"),
        ),
        target(
            "memory is what the formula says, within 1 %",
            0.01,
            if predicted == 0 { nan } else { (allocated as f64 / predicted as f64 - 1.0).abs() },
            format!("{allocated} bytes; N·D (12 + 4) + 16 ⌈K/4⌉ (D + 1 + N) = {predicted}"),
        ),
        Target::none(
            "szk-network",
            "NaN, infinite and negative pixels of all pictures: none",
            measured.broken.clone(),
        ),
        Target::none(
            "szk-network",
            "pixels that differ when a frame is drawn twice: none",
            measured.unsteady.clone(),
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Measured {
        Measured {
            power: [1.0, 1.02, 0.001],
            errors: vec![(256, 0.3, 0.0), (4096, 0.09, 0.0)],
            energy: vec![(0.0, 1e-6), (0.9, -1e-5)],
            rank: vec![Rank { g: 0.0, ratio: 0.1, rel_rmse: 0.09, rel_rmse_full: 0.0901 }],
            times: vec![(1000, 1.0), (2000, 2.0), (4000, 4.0)],
            bytes: [1000, 1001],
            broken: vec![0],
            unsteady: vec![0],
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
        assert_eq!(missed(|m| m.power[0] = 0.9), 1);
        assert_eq!(missed(|m| m.errors[1].1 = 0.11), 1);
        assert_eq!(missed(|m| m.errors[0].1 = 0.1), 1);
        assert_eq!(missed(|m| m.energy[1].1 = -0.01), 1);
        assert_eq!(missed(|m| m.rank[0].ratio = 0.3), 1);
        assert_eq!(missed(|m| m.rank[0].rel_rmse = 0.1), 1);
        assert_eq!(missed(|m| m.times[2].1 = 1.5), 1);
        assert_eq!(missed(|m| m.bytes[0] = 1100), 1);
        assert_eq!(missed(|m| m.broken[0] = 1), 1);
        assert_eq!(missed(|m| m.unsteady.clear()), 1);
        // What was not measured does not hold.
        assert_eq!(missed(|m| *m = Measured::default()), 10);
    }
}
