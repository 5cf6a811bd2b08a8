//! The CPU reference in the background: coarse at once, finer while nothing moves.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use common::image::Image;
use common::reference::{self, Options, Reference};
use common::{Camera, Scene, Terms};
use eframe::egui;
use glam::Vec3;

/// Pixels of the window on a side of one of the reference, from coarse to fine. All are odd, so that the rays of a coarse
/// picture are rays of the fine one too, and errors can be told of each.
pub(super) const STEPS: [u32; 3] = [9, 3, 1];

/// Rays that the reference's second method checks, in each picture.
const CHECKED: u32 = 64;

/// What a reference picture is of.
pub(super) struct Wanted {
    /// Everything in its place.
    pub scene: Scene,
    pub camera: Camera,
    /// Pixels of the window's picture: multiples of the coarsest step.
    pub size: (u32, u32),
    pub terms: Terms,
}

/// A reference picture.
pub(super) struct Found {
    pub image: Image,
    /// Pixels of the window on a side of one of this.
    pub step: u32,
    /// Relative RMS error that it may have.
    pub uncertainty: f64,
}

/// A thread that computes what was asked for last.
pub(super) struct Refining {
    jobs: Sender<(Wanted, Arc<AtomicBool>)>,
    results: Receiver<(Arc<AtomicBool>, Result<Found, String>)>,
    /// Of the job that counts; set, it stops.
    stop: Arc<AtomicBool>,
    /// Thousandths of the picture in work that are done.
    done: Arc<AtomicU32>,
    /// The finest of the job that counts.
    pub found: Option<Found>,
    /// Why there is none.
    pub problem: Option<String>,
}

impl Refining {
    /// Starts the thread; it asks `window` to look when there is something new.
    pub(super) fn new(window: egui::Context) -> Self {
        let (jobs, to_do) = channel::<(Wanted, Arc<AtomicBool>)>();
        let (done_jobs, results) = channel();
        let done = Arc::new(AtomicU32::new(0));
        let share = Arc::clone(&done);
        std::thread::spawn(move || {
            // The window goes on drawing beside it.
            let threads =
                std::thread::available_parallelism().map_or(1, |n| n.get().saturating_sub(1).max(1));
            let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { return };
            while let Ok((wanted, stop)) = to_do.recv() {
                let told = |found| {
                    let sent = done_jobs.send((Arc::clone(&stop), found));
                    window.request_repaint();
                    sent.is_ok()
                };
                pool.install(|| refine(&wanted, &stop, &share, &told));
            }
        });
        let stop = Arc::new(AtomicBool::new(true));
        Self { jobs, results, stop, done, found: None, problem: None }
    }

    /// Forgets what was asked for.
    pub(super) fn stop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        (self.found, self.problem) = (None, None);
    }

    /// Asks for another picture in place of the one before.
    pub(super) fn ask(&mut self, wanted: Wanted) {
        self.stop();
        self.stop = Arc::new(AtomicBool::new(false));
        self.done.store(0, Ordering::Relaxed);
        // A thread that is gone has said why.
        drop(self.jobs.send((wanted, Arc::clone(&self.stop))));
    }

    /// Takes what has been finished; whether there was anything.
    pub(super) fn poll(&mut self) -> bool {
        let mut new = false;
        while let Ok((of, found)) = self.results.try_recv() {
            if !Arc::ptr_eq(&of, &self.stop) {
                continue;
            }
            new = true;
            match found {
                Ok(found) => self.found = Some(found),
                Err(problem) => self.problem = Some(problem),
            }
        }
        new
    }

    /// Whether the finest picture is there.
    pub(super) fn is_finished(&self) -> bool {
        self.problem.is_some()
            || self.found.as_ref().is_some_and(|found| found.step == STEPS[STEPS.len() - 1])
    }

    /// How much of the picture in work is done, in [0, 1].
    pub(super) fn share(&self) -> f32 {
        self.done.load(Ordering::Relaxed) as f32 / 1000.0
    }
}

/// Computes one picture after the other, until told to stop.
fn refine(
    wanted: &Wanted,
    stop: &AtomicBool,
    share: &AtomicU32,
    told: &dyn Fn(Result<Found, String>) -> bool,
) {
    let options = Options { checked_rays: CHECKED, ..Options::default() };
    let reference = match Reference::with_options(&wanted.scene, options) {
        Ok(reference) => reference,
        Err(error) => {
            told(Err(error.to_string()));
            return;
        }
    };
    for step in STEPS {
        let view = wanted.camera.view(wanted.size.0 / step, wanted.size.1 / step);
        let report = |done: f32| share.store((1000.0 * done) as u32, Ordering::Relaxed);
        let found = match reference.render(&view, wanted.terms, &report, stop) {
            Ok(rendered) => {
                let uncertainty = rendered.uncertainty.max(rendered.multiple_uncertainty);
                Ok(Found { image: rendered.total(), step, uncertainty })
            }
            Err(reference::Error::Cancelled) => return,
            Err(error) => Err(error.to_string()),
        };
        let failed = found.is_err();
        if !told(found) || failed {
            return;
        }
    }
}

/// Those pixels of a window's picture whose rays a reference picture of `step` has.
pub(super) fn at_rays_of(image: &Image, step: u32) -> Image {
    let (width, height) = (image.width / step, image.height / step);
    let middle = step / 2;
    let pixel = |index: u32| {
        let (x, y) = (index % width, index / width);
        let at = (y * step + middle) * image.width + x * step + middle;
        image.pixels.get(at as usize).copied().unwrap_or(Vec3::ZERO)
    };
    Image { width, height, pixels: (0..width * height).map(pixel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_rays_are_rays_of_the_fine_picture() {
        let camera = Camera::default();
        let (width, height) = (27, 18);
        let fine = camera.view(width, height);
        let directions = (0..width * height).map(|i| fine.ray_direction(i % width, i / width));
        let fine = Image { width, height, pixels: directions.collect() };
        for step in STEPS {
            let coarse = camera.view(width / step, height / step);
            let picked = at_rays_of(&fine, step);
            for (index, pixel) in picked.pixels.iter().enumerate() {
                let (x, y) = (index as u32 % coarse.width, index as u32 / coarse.width);
                assert!(pixel.distance(coarse.ray_direction(x, y)) < 1e-6, "{step}: {x}, {y}");
            }
        }
    }

    #[test]
    fn a_picture_comes_coarse_first_and_the_last_question_counts() {
        let scene = common::scene::builtin::knife_edge();
        let mut refining = Refining::new(egui::Context::default());
        let ask = |refining: &mut Refining, size| {
            refining.ask(Wanted { scene: scene.clone(), camera: scene.camera, size, terms: Terms::DIRECT });
        };
        ask(&mut refining, (1800, 1800));
        ask(&mut refining, (36, 27));
        let started = std::time::Instant::now();
        let mut steps = Vec::new();
        while !refining.is_finished() {
            assert!(started.elapsed().as_secs() < 60, "no picture after a minute");
            if refining.poll() {
                let found = refining.found.as_ref().unwrap();
                assert_eq!((found.image.width * found.step, found.image.height * found.step), (36, 27));
                steps.push(found.step);
            }
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        assert!(steps.is_sorted_by(|a, b| a > b) && steps.last() == Some(&1), "{steps:?}");
        let whole = Reference::new(&scene).unwrap();
        let view = scene.camera.view(36, 27);
        let wanted = whole.render(&view, Terms::DIRECT, &|_| (), &AtomicBool::new(false)).unwrap().total();
        assert_eq!(refining.found.as_ref().unwrap().image, wanted);
    }
}
