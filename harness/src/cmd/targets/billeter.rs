//! What is promised of the polygonal light volumes.

use billeter_plv::{Options, Tessellation};
use common::gpu::Context;
use common::image::Image;
use common::{Light, Scene, Term, metrics};
use serde::Serialize;

use super::{Target, broken, unsteady};
use crate::cmd::{load, reference};
use crate::failure::Failure;
use crate::interrupt;
use crate::measure::{Drawn, Stage};
use crate::progress::Progress;
use crate::report::percent;
use crate::techniques::{self, Method};

/// Scenes whose error is bounded.
const SCENES: [&str; 2] = ["cathedral", "amphora"];

/// Sides of the shadow maps at which the error is bounded, and the bounds.
const ERROR_BOUNDS: [(u32, f64); 2] = [(2048, 0.01), (512, 0.03)];

/// Side of the shadow maps from which adaptive meshes are held against full ones.
const MESH_SIZE: u32 = 1024;

/// Side of the rooms' shadow maps.
const ROOM_SIZE: u32 = 512;

/// Steps of progress.
pub(super) const STEPS: u64 = 14;

/// One setting on one scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Shot {
    scene: String,
    setting: &'static str,
    shadow_map_size: u32,
    /// Against the reference; null where there is none to hold it against.
    rel_rmse: Option<f64>,
    /// Sum of the airlight over all pixels and colours.
    sum: f64,
    /// Triangles of the meshes of all projections of all lights, without the walls that close them.
    triangles: u64,
    /// Pixels that are NaN, infinite or negative.
    broken: usize,
    /// Pixels whose bits differ when the frame is drawn again; null where it is drawn once.
    unsteady: Option<usize>,
}

/// The two settings that are held against each other.
fn settings() -> [(&'static str, Method); 2] {
    [
        ("default", techniques::billeter("default", "default", None, Options::best(techniques::ANY))),
        (
            "adaptive mesh",
            techniques::billeter(
                "adaptive",
                "sweep",
                None,
                Options { tessellation: Tessellation::ADAPTIVE, ..Options::best(techniques::ANY) },
            ),
        ),
    ]
}

/// What all shots are taken on.
pub(super) struct Bench<'a> {
    pub context: &'a Context,
    pub size: (u32, u32),
    pub progress: &'a Progress,
}

impl Bench<'_> {
    pub(super) fn shots(&self) -> Result<Vec<Shot>, Failure> {
        let mut shots = Vec::new();
        for name in SCENES {
            let scene = load(name, None, |note| self.progress.say(note))?.at(0.0);
            self.progress.doing(&format!("{name}: reference"));
            let view = scene.camera.view(self.size.0, self.size.1);
            let rendered = reference(&scene, &view, Term::Airlight.into(), &|share| {
                self.progress.detail(format!("{name}: reference, {:.0} %", 100.0 * share));
            })?;
            self.progress.step();
            let truth = rendered.airlight.as_ref();
            for shadow_size in [512, MESH_SIZE, 2048] {
                let settings = settings().into_iter().take(if shadow_size == MESH_SIZE { 2 } else { 1 });
                self.shoot(&scene, truth, shadow_size, settings, &mut shots)?;
            }
        }
        for name in ["sealed-room", "open-room"] {
            let scene = load(name, None, |note| self.progress.say(note))?.at(0.0);
            self.shoot(&scene, None, ROOM_SIZE, settings(), &mut shots)?;
        }
        Ok(shots)
    }

    /// One scene with maps of one size, in several settings.
    fn shoot(
        &self,
        scene: &Scene,
        truth: Option<&Image>,
        shadow_size: u32,
        settings: impl IntoIterator<Item = (&'static str, Method)>,
        shots: &mut Vec<Shot>,
    ) -> Result<(), Failure> {
        let (device, queue) = (&self.context.device, &self.context.queue);
        let mut stage = Stage::new(self.context, scene, self.size, shadow_size)?;
        for (setting, method) in settings {
            interrupt::check()?;
            self.progress.doing(&format!("{}, {shadow_size}² map, {setting}", scene.name));
            let mut technique =
                method.make(device, queue, stage.format(), self.size).map_err(Failure::Run)?;
            let image = stage.picture(Some(technique.as_mut()), 0.0, Drawn::Airlight)?;
            // The largest maps take longest and show nothing in this that smaller ones do not.
            let again = if shadow_size <= MESH_SIZE {
                Some(stage.picture(Some(technique.as_mut()), 0.0, Drawn::Airlight)?)
            } else {
                None
            };
            let triangles = technique.adaptive_triangles(device, queue).map(u64::from);
            let rel_rmse = match truth {
                Some(truth) => {
                    let errors = metrics::compare(&image, truth);
                    Some(errors.map_err(|error| Failure::Run(error.to_string()))?.rel_rmse)
                }
                None => None,
            };
            shots.push(Shot {
                scene: scene.name.clone(),
                setting,
                shadow_map_size: shadow_size,
                rel_rmse,
                sum: image.pixels.iter().map(|pixel| pixel.as_dvec3().element_sum()).sum(),
                triangles: triangles.unwrap_or_else(|| full_triangles(scene, shadow_size)),
                broken: broken(&image),
                unsteady: again.map(|again| unsteady(&image, &again)),
            });
            self.progress.step();
        }
        Ok(())
    }
}

/// Triangles of meshes with a vertex for each texel.
fn full_triangles(scene: &Scene, shadow_size: u32) -> u64 {
    let projections = |light: &Light| if matches!(light, Light::Point(_)) { 6 } else { 1 };
    let cells = u64::from(shadow_size - 1).pow(2);
    scene.lights.iter().map(projections).sum::<u64>() * 2 * cells
}

/// Every promise, from the shots alone.
pub(super) fn targets(shots: &[Shot]) -> Vec<Target> {
    let find = |scene: &str, setting: &str, size: u32| {
        shots.iter().find(|s| s.scene == scene && s.setting == setting && s.shadow_map_size == size)
    };
    let error = |scene: &str, setting: &str, size: u32| {
        find(scene, setting, size).and_then(|shot| shot.rel_rmse).unwrap_or(f64::NAN)
    };
    let target = |what: String, at_most: f64, measured: f64, text: String| {
        Target::new("billeter-plv", what, at_most, measured, text)
    };
    let mut targets = Vec::new();
    for (size, bound) in ERROR_BOUNDS {
        for scene in SCENES {
            let measured = error(scene, "default", size);
            let what =
                format!("{scene}, {size}² map: relative RMSE of the airlight at most {:.0} %", 100.0 * bound);
            targets.push(target(what, bound, measured, percent(measured)));
        }
    }
    for scene in SCENES {
        let count = |setting| find(scene, setting, MESH_SIZE).map_or(f64::NAN, |shot| shot.triangles as f64);
        let (adaptive, full) = (count("adaptive mesh"), count("default"));
        let what = format!("{scene}, {MESH_SIZE}² map: adaptive meshes at most a tenth of the full ones");
        let text = format!("{} ({adaptive} of {full})", percent(adaptive / full));
        targets.push(target(what, 0.1, adaptive / full, text));
        let (adaptive, full) = (error(scene, "adaptive mesh", MESH_SIZE), error(scene, "default", MESH_SIZE));
        let added = adaptive / full - 1.0;
        let what = format!("{scene}, {MESH_SIZE}² map: error that adaptive meshes add at most 10 %");
        let text = format!("{} ({} for {})", percent(added), percent(adaptive), percent(full));
        targets.push(target(what, 0.1, added, text));
    }
    for (setting, _) in settings() {
        let sum = |scene| find(scene, setting, ROOM_SIZE).map_or(f64::NAN, |shot| shot.sum);
        let measured = sum("sealed-room") / sum("open-room");
        let what = format!("sealed room, {setting}: airlight at most 1e-5 of the open room's");
        targets.push(target(what, 1e-5, measured, format!("{measured:.1e}")));
    }
    let broken = shots.iter().map(|shot| shot.broken).collect();
    targets.push(Target::none(
        "billeter-plv",
        "NaN, infinite and negative pixels of all pictures: none",
        broken,
    ));
    let unsteady = shots.iter().filter_map(|shot| shot.unsteady).collect();
    targets.push(Target::none(
        "billeter-plv",
        "pixels that differ where a frame is drawn twice: none",
        unsteady,
    ));
    targets
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> Vec<Shot> {
        let shot = |scene: &str, setting, shadow_map_size, triangles, sum| Shot {
            scene: scene.into(),
            setting,
            shadow_map_size,
            rel_rmse: Some(0.01),
            sum,
            triangles,
            broken: 0,
            unsteady: Some(0),
        };
        let mut shots = Vec::new();
        for scene in SCENES {
            for size in [512, 1024, 2048] {
                shots.push(shot(scene, "default", size, 100, 1.0));
            }
            shots.push(shot(scene, "adaptive mesh", 1024, 10, 1.0));
        }
        for setting in ["default", "adaptive mesh"] {
            shots.push(shot("sealed-room", setting, ROOM_SIZE, 1, 0.0));
            shots.push(shot("open-room", setting, ROOM_SIZE, 1, 1.0));
        }
        shots
    }

    #[test]
    fn each_promise_can_be_missed() {
        let missed = |change: fn(&mut Vec<Shot>)| {
            let mut shots = good();
            change(&mut shots);
            targets(&shots).iter().filter(|target| !target.holds).count()
        };
        assert_eq!(missed(|_| ()), 0);
        assert_eq!(missed(|shots| shots[0].rel_rmse = Some(0.031)), 1);
        assert_eq!(missed(|shots| shots[2].rel_rmse = Some(0.011)), 1);
        assert_eq!(missed(|shots| shots[2].rel_rmse = Some(f64::NAN)), 1);
        assert_eq!(missed(|shots| shots[3].rel_rmse = Some(0.012)), 1);
        assert_eq!(missed(|shots| shots[3].triangles = 11), 1);
        assert_eq!(missed(|shots| shots[8].sum = 2e-5), 1);
        assert_eq!(missed(|shots| shots[3].broken = 1), 1);
        assert_eq!(missed(|shots| shots[10].unsteady = Some(1)), 1);
        // What was not measured does not hold.
        assert_eq!(missed(Vec::clear), 12);
    }
}
