//! What is promised of the sorted shadow planes.

use std::sync::Arc;
use std::time::Instant;

use biri_ss::table::{build_airlight, build_lambert, build_phong};
use biri_ss::{Connectivity, Options, Origin, Silhouette};
use common::gpu::Context;
use common::reference::IndirectModel;
use common::scene::builtin;
use common::{Light, Lobe, Scene, Term, metrics};
use glam::{DAffine3, DVec3, Vec3};
use serde::Serialize;

use super::{Target, unsteady};
use crate::cmd::{load, reference, reference_by};
use crate::deferred::{Stage, Wanted};
use crate::failure::Failure;
use crate::interrupt;
use crate::measure::Frames;
use crate::progress::Progress;
use crate::record::Spread;
use crate::report::{digits, percent};

const NAME: &str = "biri-ss";

/// Scenes whose error is bounded, and the bound.
const SCENES: [&str; 3] = ["pen", "amphora", "cathedral"];
const ERROR: f64 = 0.005;
/// The same for the user's cathedral.
const SIBENIK_ERROR: f64 = 0.01;
/// Indirect light against that of an unbounded medium: scene and bound.
const INDIRECT: (&str, f64) = ("pen", 0.01);
/// Part of either side of the pictures that nothing is compared with, and of the frames that are timed.
const SMALL: [u32; 2] = [4, 8];
/// Half planes on which the order is checked.
const RAYS: u32 = 2000;
/// Silhouettes of the scene with the most triangles, for one light on one core \[ms\].
const SILHOUETTES: (&str, f64) = ("complex-camera", 5.0);
/// All tables of a phase function \[ms\].
const TABLES: f64 = 300.0;
/// Size of the paper's airlight table.
const TEXELS: [usize; 2] = [256, 512];
/// The path into a shadow: scene, frames, size, and the largest step of the error from frame to frame.
const PATH: (&str, usize, (u32, u32), f64) = ("amphora", 40, (64, 52), 0.005);
/// Growth of cost: scene, triangles, and the largest exponent of cost over silhouette edges; above 1 by what
/// times on a busy machine scatter.
const GROWTH: (&str, [u32; 3], f64) = ("complex", [10_000, 30_000, 110_000], 1.1);
/// Times that a measurement on the CPU is repeated.
const REPEATS: usize = 9;

/// Steps of progress.
pub(super) const STEPS: u64 = builtin::NAMES.len() as u64 + 5;

/// Everything measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Measured {
    shots: Vec<Shot>,
    silhouettes_ms: f64,
    tables_ms: f64,
    path: Vec<Step>,
    growth: Vec<Cost>,
}

/// One scene at time 0 by the default setting.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Shot {
    scene: String,
    /// Of the airlight against the reference; null where no bound is promised.
    rel_rmse: Option<f64>,
    /// Largest `rel_rmse` that is right.
    bound: Option<f64>,
    /// Of indirect light against that of an unbounded medium; null where no bound is promised.
    indirect_rel_rmse: Option<f64>,
    /// Pixels of all terms that are NaN, infinite or negative.
    broken: usize,
    /// Pixels of either that differ when the frame is drawn again.
    unsteady: usize,
    /// Pairs of planes in the wrong order.
    violations: usize,
    silhouette_edges: usize,
    planes: usize,
}

/// A frame of the path into a shadow.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Step {
    rel_rmse: f64,
    /// Shadows that the eye is in, by light.
    eye_depths: Vec<u32>,
}

/// What a frame costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Cost {
    triangles: usize,
    silhouette_edges: f64,
    /// Preparing on the CPU, and all passes of the technique.
    prepare_ms: f64,
    passes_ms: f64,
}

/// What everything is measured with.
pub(super) struct Bench<'a> {
    pub context: &'a Context,
    pub size: (u32, u32),
    pub progress: &'a Progress,
    pub sibenik: Option<&'a str>,
}

impl Bench<'_> {
    pub(super) fn measure(&self) -> Result<Measured, Failure> {
        let mut shots = Vec::new();
        for (name, _) in builtin::NAMES {
            let bound = SCENES.contains(name).then_some(ERROR);
            shots.push(self.shoot(&self.scene(name, None)?, bound)?);
        }
        if let Some(file) = self.sibenik {
            shots.push(self.shoot(&self.scene(file, None)?, Some(SIBENIK_ERROR))?);
        }
        self.progress.doing("silhouettes and tables");
        let silhouettes_ms = silhouettes_ms(&self.scene(SILHOUETTES.0, None)?.at(0.0));
        let tables_ms = tables_ms();
        self.progress.step();
        Ok(Measured { shots, silhouettes_ms, tables_ms, path: self.path()?, growth: self.growth()? })
    }

    fn scene(&self, name: &str, triangles: Option<u32>) -> Result<Scene, Failure> {
        load(name, triangles, |note| self.progress.say(note))
    }

    fn options(&self) -> Options {
        Options::best(self.context.radiance_format())
    }

    /// A part of either side of the pictures' size.
    fn small(&self, part: u32) -> (u32, u32) {
        (self.size.0.div_ceil(part), self.size.1.div_ceil(part))
    }

    fn shoot(&self, scene: &Scene, bound: Option<f64>) -> Result<Shot, Failure> {
        interrupt::check()?;
        self.progress.doing(&format!("{}: shadow planes", scene.name));
        let scene = scene.at(0.0);
        let wanted = Wanted { indirect: scene.name == INDIRECT.0, ..Default::default() };
        let small = self.small(SMALL[0]);
        let mut stage = Stage::new(self.context, &scene, small)?;
        let mut renderer = stage.renderer(&self.options())?;
        let first = stage.pictures(&mut renderer, &scene, wanted)?;
        let again = stage.pictures(&mut renderer, &scene, wanted)?;
        let statistics = renderer.statistics();
        let violations = renderer.order_violations(scene.camera.eye, RAYS);
        let indirect_rel_rmse = if wanted.indirect {
            let view = scene.camera.view(small.0, small.1);
            let term = Term::IndirectAirlight.into();
            let truth = reference_by(&scene, &view, term, IndirectModel::Unbounded, &|_| ())?;
            Some(error(&first.indirect, truth.indirect_airlight.as_ref())?)
        } else {
            None
        };
        let mut broken =
            [&first.airlight, &first.surfaces, &first.indirect].map(super::broken).iter().sum::<usize>();
        let rel_rmse = if bound.is_some() {
            let mut stage = Stage::new(self.context, &scene, self.size)?;
            let picture = stage.pictures(&mut renderer, &scene, Wanted::default())?;
            broken += super::broken(&picture.airlight) + super::broken(&picture.surfaces);
            self.progress.doing(&format!("{}: reference", scene.name));
            let view = scene.camera.view(self.size.0, self.size.1);
            let truth = reference(&scene, &view, Term::Airlight.into(), &|share| {
                self.progress.detail(format!("{}: reference, {:.0} %", scene.name, 100.0 * share));
            })?;
            Some(error(&picture.airlight, truth.airlight.as_ref())?)
        } else {
            None
        };
        self.progress.step();
        Ok(Shot {
            scene: scene.name.clone(),
            rel_rmse,
            bound,
            indirect_rel_rmse,
            broken,
            unsteady: unsteady(&first.airlight, &again.airlight) + unsteady(&first.surfaces, &again.surfaces),
            violations,
            silhouette_edges: statistics.silhouette_edges,
            planes: statistics.planes,
        })
    }

    /// The camera goes into the shadow that the jug throws in the light from outside.
    fn path(&self) -> Result<Vec<Step>, Failure> {
        let (name, frames, size, _) = PATH;
        self.progress.doing("path into a shadow");
        let mut scene = self.scene(name, None)?.at(0.0);
        let mut stage_scene = scene.clone();
        stage_scene.animation.clear();
        let mut stage = Stage::new(self.context, &stage_scene, size)?;
        let mut renderer = stage.renderer(&self.options())?;
        let (from, to) = (scene.camera.eye, Vec3::new(0.25, 0.4, -1.3));
        let mut steps = Vec::with_capacity(frames);
        for frame in 0..frames {
            interrupt::check()?;
            scene.camera.eye = from.lerp(to, frame as f32 / (frames - 1) as f32);
            let picture = stage.pictures(&mut renderer, &scene, Wanted::default())?.airlight;
            let view = scene.camera.view(size.0, size.1);
            let truth = reference(&scene, &view, Term::Airlight.into(), &|_| ())?;
            self.progress.detail(format!("path into a shadow, frame {} of {frames}", frame + 1));
            steps.push(Step {
                rel_rmse: error(&picture, truth.airlight.as_ref())?,
                eye_depths: renderer.statistics().eye_depths,
            });
        }
        self.progress.step();
        Ok(steps)
    }

    fn growth(&self) -> Result<Vec<Cost>, Failure> {
        let (name, counts, _) = GROWTH;
        let mut costs = Vec::new();
        for triangles in counts {
            self.progress.doing(&format!("{name} of {triangles} triangles: times"));
            let scene = self.scene(name, Some(triangles))?;
            let mut stage = Stage::new(self.context, &scene, self.small(SMALL[1]))?;
            let mut renderers = [(stage.renderer(&self.options())?, Wanted::default())];
            let frames = Frames::new(None, self.context.software);
            let [times] = stage.times(&mut renderers, &frames)?;
            let edges: Vec<f64> = times.statistics.iter().map(|s| s.silhouette_edges as f64).collect();
            // Without timestamps the rest of the frame is as near as one gets.
            let rest = std::iter::zip(&times.frame, &times.prepare).map(|(frame, prepare)| frame - prepare);
            let passes = if times.technique.is_empty() { rest.collect() } else { times.technique };
            costs.push(Cost {
                triangles: scene.triangle_count(),
                silhouette_edges: Spread::of(&edges).p50,
                prepare_ms: Spread::of(&times.prepare).p50,
                passes_ms: Spread::of(&passes).p50,
            });
            self.progress.step();
        }
        Ok(costs)
    }
}

fn error(picture: &common::image::Image, truth: Option<&common::image::Image>) -> Result<f64, Failure> {
    let Some(truth) = truth else { return Ok(f64::NAN) };
    let errors = metrics::compare(picture, truth).map_err(|error| Failure::Run(error.to_string()))?;
    Ok(errors.rel_rmse)
}

/// Median over several runs \[ms\].
fn median_ms(mut work: impl FnMut()) -> f64 {
    let times = [(); REPEATS].map(|()| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64() * 1e3
    });
    Spread::of(&times).p50
}

/// Silhouettes of all objects on this thread alone, for the light that takes longest; what does not change
/// when a light moves is found before.
fn silhouettes_ms(scene: &Scene) -> f64 {
    let mut meshes: Vec<(*const common::scene::Mesh, Arc<Connectivity>)> = Vec::new();
    let mut placed = Vec::new();
    for object in &scene.objects {
        let address = Arc::as_ptr(&object.mesh);
        let known = meshes.iter().find(|(known, _)| *known == address).map(|(_, mesh)| Arc::clone(mesh));
        let mesh = known.unwrap_or_else(|| {
            let mesh = Arc::new(Connectivity::new(&object.mesh));
            meshes.push((address, Arc::clone(&mesh)));
            mesh
        });
        let place = object.world_from_object;
        let world_from_object =
            DAffine3 { matrix3: place.matrix3.as_dmat3(), translation: place.translation.as_dvec3() };
        placed.push((mesh, world_from_object.inverse()));
    }
    let of_light = |light: &Light| {
        let Origin(origin) = Origin::of(light);
        let origins: Vec<Origin> = placed
            .iter()
            .map(|(_, object_from_world)| {
                let at: DVec3 =
                    object_from_world.matrix3 * origin.truncate() + object_from_world.translation * origin.w;
                Origin(at.extend(origin.w))
            })
            .collect();
        median_ms(|| {
            for ((mesh, _), origin) in placed.iter().zip(&origins) {
                std::hint::black_box(Silhouette::new(mesh, *origin));
            }
        })
    };
    scene.lights.iter().map(of_light).fold(f64::NAN, f64::max)
}

/// All tables that the renderer may build for a phase function.
fn tables_ms() -> f64 {
    let lobe = Lobe::Isotropic;
    median_ms(|| {
        std::hint::black_box(build_airlight(lobe, TEXELS, false));
        std::hint::black_box(build_lambert(lobe, true));
        std::hint::black_box(build_phong(lobe, true));
    })
}

/// Exponent of cost over silhouette edges: the slope of the straight line through their logarithms.
fn growth_exponent(costs: &[Cost]) -> f64 {
    let points: Vec<(f64, f64)> =
        costs.iter().map(|c| (c.silhouette_edges.ln(), (c.prepare_ms + c.passes_ms).ln())).collect();
    let mean = |value: fn(&(f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let [covariance, variance] = [0, 1].map(|which| {
        let other = |point: &(f64, f64)| if which == 0 { point.1 - y } else { point.0 - x };
        points.iter().map(|point| (point.0 - x) * other(point)).sum::<f64>()
    });
    covariance / variance
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
    let value = shot.and_then(|shot| shot.indirect_rel_rmse).unwrap_or(f64::NAN);
    let what = format!(
        "{scene}: relative RMSE of the indirect light at most {} of that in an unbounded medium",
        percent(bound)
    );
    targets.push(target(what, bound, value, percent(value)));
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
            indirect_rel_rmse: Some(0.001),
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
        assert_eq!(missed(|m| m.shots[0].indirect_rel_rmse = Some(0.011)), 1);
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
