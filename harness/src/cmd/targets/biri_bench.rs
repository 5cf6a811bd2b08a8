//! Measures what is promised of the sorted shadow planes.

use std::sync::Arc;
use std::time::Instant;

use biri_ss::table::{build_airlight, build_lambert, build_phong};
use biri_ss::{Connectivity, Options, Origin, Silhouette};
use common::gpu::Context;
use common::image::Image;
use common::reference::IndirectModel;
use common::scene::builtin;
use common::{Light, Lobe, Scene, Term, metrics};
use glam::{DAffine3, DVec3, Vec3};

use super::biri::{
    Cost, EDGES, ERROR, GROWTH, INDIRECT, Measured, PATH, RAYS, REPEATS, SCENES, SIBENIK_ERROR, SILHOUETTES,
    SMALL, Shot, Step, TEXELS,
};
use super::unsteady;
use crate::cmd::{load, reference, reference_by};
use crate::deferred::{Stage, Wanted};
use crate::failure::Failure;
use crate::interrupt;
use crate::measure::Frames;
use crate::progress::Progress;
use crate::record::Spread;

/// Steps of progress.
pub(super) const STEPS: u64 = builtin::NAMES.len() as u64 + 5;

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
            let scene = self.scene(name, None)?;
            // Light maps are refused.
            if scene.lights.iter().any(|light| matches!(light, Light::Spot(spot) if spot.light_map.is_some()))
            {
                self.progress.step();
                continue;
            }
            shots.push(self.shoot(&scene, bound)?);
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
        let mut broken =
            [&first.airlight, &first.surfaces, &first.indirect].map(super::broken).iter().sum::<usize>();
        let mut indirect_rel_rmse = None;
        let rel_rmse = if bound.is_some() {
            let mut stage = Stage::new(self.context, &scene, self.size)?;
            let picture = stage.pictures(&mut renderer, &scene, wanted)?;
            broken += super::broken(&picture.airlight) + super::broken(&picture.surfaces);
            if wanted.indirect {
                let view = scene.camera.view(self.size.0, self.size.1);
                let term = Term::IndirectAirlight.into();
                let truth = reference_by(&scene, &view, term, IndirectModel::Unbounded, &|_| ())?;
                let truth = truth.indirect_airlight.as_ref();
                let all = error(&picture.indirect, truth)?;
                indirect_rel_rmse =
                    Some([all, error(&without_worst(&picture.indirect, truth, EDGES), truth)?]);
            }
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

fn error(picture: &Image, truth: Option<&Image>) -> Result<f64, Failure> {
    let Some(truth) = truth else { return Ok(f64::NAN) };
    let errors = metrics::compare(picture, truth).map_err(|error| Failure::Run(error.to_string()))?;
    Ok(errors.rel_rmse)
}

/// The picture with the share of pixels that differ most from `truth` taken from there.
fn without_worst(picture: &Image, truth: Option<&Image>, share: f64) -> Image {
    let mut picture = picture.clone();
    let Some(truth) = truth.filter(|truth| truth.pixels.len() == picture.pixels.len()) else {
        return picture;
    };
    let off = |index: usize| (picture.pixels[index] - truth.pixels[index]).length_squared();
    let mut worst: Vec<usize> = (0..picture.pixels.len()).collect();
    worst.sort_by(|a, b| off(*b).total_cmp(&off(*a)));
    worst.truncate((share * worst.len() as f64) as usize);
    for index in worst {
        picture.pixels[index] = truth.pixels[index];
    }
    picture
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
