//! Where settings are measured: one scene at two sizes, and a model of it.

use std::collections::{BTreeMap, HashMap};
use std::time::Instant;

use common::Scene;
use common::gpu::Context;
use common::image::Image;
use common::need::Model;

use super::family::{Family, Rung};
use super::search::{Measures, Seen};
use crate::failure::Failure;
use crate::interrupt;
use crate::judge::Judge;
use crate::measure::{Drawn, Frames, Stage};
use crate::progress::Progress;
use crate::record::Spread;
use crate::techniques::{Method, Technique};

/// Most pixels of a small picture: what a software adapter draws in no time.
const SMALL: u32 = 160 * 128;

/// A frame that takes longer is not drawn again \[s\].
const LONG: f64 = 4.0;

/// Maps of more than so many texels on a side are held one at a time.
const LARGE: u32 = 1024;

/// A scene on the device at two sizes, with what its pictures are held against.
pub(super) struct Bench<'a> {
    pub context: &'a Context,
    pub scene: &'a Scene,
    pub frames: Frames,
    pub progress: &'a Progress,
    /// Small, and real.
    sizes: [(u32, u32); 2],
    judges: [Option<Judge>; 2],
    stages: HashMap<(usize, u32), Stage<'a>>,
    /// What was measured already, by method, model and size, and how long that took \[s\].
    known: Vec<(Key, Result<Seen, String>, f64)>,
    /// What the measurements that were asked for took \[s\], those that were known already included.
    pub spent: f64,
}

type Key = (String, Model, usize, bool);

/// A quarter of the pixels, or fewer where that is still many.
fn small((width, height): (u32, u32)) -> (u32, u32) {
    let mut share = 2;
    while (width / share) * (height / share) > SMALL {
        share += 1;
    }
    ((width / share).max(1), (height / share).max(1))
}

impl<'a> Bench<'a> {
    pub(super) fn new(
        context: &'a Context,
        scene: &'a Scene,
        size: (u32, u32),
        frames: Frames,
        progress: &'a Progress,
    ) -> Self {
        Self {
            context,
            scene,
            frames,
            progress,
            sizes: [small(size), size],
            judges: [None, None],
            stages: HashMap::new(),
            known: Vec::new(),
            spent: 0.0,
        }
    }

    /// Size of the real picture \[pixels\].
    pub(super) fn size(&self) -> (u32, u32) {
        self.sizes[1]
    }

    /// Draws the references, if they are not drawn yet; gives what they took when they were computed \[s\].
    pub(super) fn references(&mut self) -> Result<f64, Failure> {
        let mut seconds = 0.0;
        for (index, size) in self.sizes.into_iter().enumerate() {
            if self.judges[index].is_none() {
                self.stage(index, 256)?;
                let Some(stage) = self.stages.get_mut(&(index, 256)) else { continue };
                let judge = Judge::of(stage, self.scene, size, false, String::new(), self.progress)?;
                self.judges[index] = Some(judge);
            }
            seconds += self.judges[index].as_ref().map_or(0.0, |judge| judge.note(Vec::new()).seconds);
        }
        Ok(seconds)
    }

    /// Whether there is any airlight to be wrong about.
    pub(super) fn is_lit(&self) -> bool {
        self.judges.iter().flatten().all(|judge| judge.lit)
    }

    /// What the errors at the real size may be off by, relative.
    pub(super) fn uncertainty(&self) -> f64 {
        self.judges[1].as_ref().map_or(0.0, |judge| judge.note(Vec::new()).uncertainty)
    }

    /// Lets all stages go, so that whoever measures next has to make them anew.
    pub(super) fn forget_stages(&mut self) {
        self.stages.clear();
    }

    /// The ground at one of the sizes, on maps of that side, its shadow maps and depth drawn at time 0.
    fn stage(&mut self, index: usize, side: u32) -> Result<&mut Stage<'a>, Failure> {
        if !self.stages.contains_key(&(index, side)) {
            if side > LARGE {
                self.stages.retain(|(_, held), _| *held <= LARGE);
            }
            let stage = Stage::new(self.context, self.scene, self.sizes[index], side)?;
            self.stages.insert((index, side), stage);
        }
        self.stages.get_mut(&(index, side)).ok_or_else(|| Failure::Run("a scene is missing".into()))
    }

    fn made(&mut self, method: &Method, model: &Model, index: usize) -> Result<Box<dyn Technique>, String> {
        if let Some(refusal) = method.refusal(self.scene) {
            return Err(refusal);
        }
        let (device, queue) = (&self.context.device, &self.context.queue);
        let format = self.context.radiance_format();
        let lights = self.scene.lights.len();
        method.make_reduced(device, queue, format, self.sizes[index], (model, lights))
    }

    fn error(&self, index: usize, airlight: &Image) -> Result<f64, Failure> {
        match &self.judges[index] {
            Some(judge) => judge.relative_error(airlight),
            None => Ok(f64::NAN),
        }
    }

    /// A measurement, or what is known of it.
    fn once(
        &mut self,
        key: Key,
        measure: impl FnOnce(&mut Self) -> Result<Result<Seen, String>, Failure>,
    ) -> Result<Result<Seen, String>, Failure> {
        interrupt::check()?;
        if let Some((_, seen, seconds)) = self.known.iter().find(|(known, ..)| *known == key) {
            self.spent += seconds;
            return Ok(seen.clone());
        }
        let (name, _, _, moving) = &key;
        let what = if *moving { "measuring" } else { "looking at" };
        self.progress.doing(&format!("{}: {what} {name}", self.scene.name));
        let started = Instant::now();
        let seen = measure(self)?;
        let seconds = started.elapsed().as_secs_f64();
        self.spent += seconds;
        self.known.push((key, seen.clone(), seconds));
        self.progress.step();
        Ok(seen)
    }

    /// A picture, small or of the real size, and its passes, standing still.
    pub(super) fn look(
        &mut self,
        method: &Method,
        model: &Model,
        side: u32,
        whole: bool,
    ) -> Result<Result<Seen, String>, Failure> {
        let index = usize::from(whole);
        let key = (method.name.clone(), model.clone(), index, false);
        self.once(key, |bench| {
            let mut technique = match bench.made(method, model, index) {
                Ok(technique) => technique,
                Err(refusal) => return Ok(Err(refusal)),
            };
            let stage = bench.stage(index, side)?;
            // Its shadow maps and depth may be of another time.
            stage.picture(None, 0.0, Drawn::Airlight)?;
            // Once to warm up, unless that is very long: pipelines, tables and particles are made in it.
            let mut wall = Instant::now();
            let mut drawn = stage.airlight_again(technique.as_mut(), 0.0);
            if drawn.is_ok() && wall.elapsed().as_secs_f64() < LONG {
                wall = Instant::now();
                drawn = stage.airlight_again(technique.as_mut(), 0.0);
            }
            let wall = wall.elapsed();
            let (airlight, passes) = match drawn {
                Ok(drawn) => drawn,
                Err(Failure::Input(refusal)) => return Ok(Err(refusal)),
                Err(failure) => return Err(failure),
            };
            let mut passes: BTreeMap<String, f64> =
                passes.into_iter().map(|(name, ms)| (name.to_owned(), ms)).collect();
            // As in `measure`: a software adapter's timestamps can't be trusted.
            if passes.is_empty() || bench.context.software {
                passes.clear();
                passes.insert("wall clock".into(), 1e3 * wall.as_secs_f64());
            }
            Ok(Ok(Seen { error: bench.error(index, &airlight)?, passes }))
        })
    }

    /// A picture of the real size, and the medians of its passes with everything moving.
    pub(super) fn verify(
        &mut self,
        method: &Method,
        model: &Model,
        side: u32,
    ) -> Result<Result<Seen, String>, Failure> {
        let key = (method.name.clone(), model.clone(), 1, true);
        self.once(key, |bench| {
            let mut technique = match bench.made(method, model, 1) {
                Ok(technique) => technique,
                Err(refusal) => return Ok(Err(refusal)),
            };
            let frames = bench.frames.clone();
            let stage = bench.stage(1, side)?;
            let airlight = match stage.try_picture(technique.as_mut(), 0.0)? {
                Ok(airlight) => airlight,
                Err(refusal) => return Ok(Err(refusal)),
            };
            let times = match stage.times(technique.as_mut(), &frames)? {
                Ok(times) => times,
                Err(refusal) => return Ok(Err(refusal)),
            };
            let mut passes: BTreeMap<String, f64> =
                times.passes.iter().map(|(name, all)| ((*name).to_owned(), Spread::of(all).p50)).collect();
            if times.passes_total.len() < times.wall.len() {
                passes = BTreeMap::from([("wall clock".into(), Spread::of(&times.wall).p50)]);
            }
            Ok(Ok(Seen { error: bench.error(1, &airlight)?, passes }))
        })
    }
}

/// A bench for one model, as the search sees it.
pub(super) struct Modelled<'a, 'b> {
    pub bench: &'b mut Bench<'a>,
    pub model: &'b Model,
    pub families: &'b [Family],
}

impl Measures for Modelled<'_, '_> {
    fn pixels(&self) -> [f64; 2] {
        self.bench.sizes.map(|(width, height)| f64::from(width) * f64::from(height))
    }

    fn look(&mut self, rung: &Rung, whole: bool) -> Result<Result<Seen, String>, Failure> {
        match self.families[rung.family].method(rung) {
            Ok(method) => self.bench.look(&method, self.model, rung.side, whole),
            Err(problem) => Ok(Err(problem)),
        }
    }

    fn verify(&mut self, rung: &Rung) -> Result<Result<Seen, String>, Failure> {
        match self.families[rung.family].method(rung) {
            Ok(method) => self.bench.verify(&method, self.model, rung.side),
            Err(problem) => Ok(Err(problem)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_pictures_are_small_and_of_the_same_shape() {
        assert_eq!([small((160, 128)), small((640, 512))], [(80, 64), (160, 128)]);
        assert_eq!(small((1, 1)), (1, 1));
        let (width, height) = small((1280, 1024));
        assert!(width * height <= SMALL && width * 1024 == height * 1280);
    }
}
