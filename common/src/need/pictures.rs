//! The small pictures that an estimate is made of.

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use glam::{DVec3, Vec3};

use super::{Estimate, LightParts, MediumParts, Model, Need, Part, PhaseModel, Settings, TermParts};
use crate::image::Image;
use crate::reference::{ByLight, Error, IndirectModel, Options, Reference, multiple};
use crate::{Light, Medium, Scene, Sky, Term, View};

/// Interleaved parts of the pixels, each left out in turn: how far a number then moves is how sure it is.
const FOLDS: usize = 8;

/// Relative tolerance of integrals: well below anything that is asked here.
const TOLERANCE: f64 = 1e-4;

/// Directions per pixel and light of either half of the indirect airlight: at least, and at most.
const DIRECTIONS: [u32; 2] = [8, 256];

/// Paths per pixel of the first round; later ones have twice as many each.
const PATHS: u32 = 2;

/// Share of the multiple scattering's error below which more paths change no verdict.
const SURE: f64 = 0.03;

/// A picture twice, by independent samples where it takes any, so that noise adds nothing to products.
#[derive(Clone)]
struct Twice([Vec<DVec3>; 2]);

impl Twice {
    fn exact(image: &Image) -> Self {
        Self::of(image, image)
    }

    fn of(a: &Image, b: &Image) -> Self {
        Self([a, b].map(|image| image.pixels.iter().map(|pixel| pixel.as_dvec3()).collect()))
    }

    fn black(like: &Self) -> Self {
        Self([0, 1].map(|half| vec![DVec3::ZERO; like.0[half].len()]))
    }

    /// `self + factor · other`.
    fn plus(&self, factor: f64, other: &Self) -> Self {
        let sum = |half: usize| self.0[half].iter().zip(&other.0[half]).map(|(a, b)| *a + factor * *b);
        Self([0, 1].map(|half| sum(half).collect()))
    }

    fn mean(&self, pixel: usize) -> DVec3 {
        0.5 * (self.0[0][pixel] + self.0[1][pixel])
    }

    fn product(&self, other: &Self, pixel: usize) -> f64 {
        let (a, b) = (&self.0, &other.0);
        0.5 * (a[0][pixel].dot(b[1][pixel]) + a[1][pixel].dot(b[0][pixel]))
    }
}

/// A whole picture: what is lit, and the mean there, with each fold left out and with none.
struct Whole {
    lit: Vec<bool>,
    counts: [f64; FOLDS + 1],
    means: [f64; FOLDS + 1],
}

/// Sums over the pixels of all folds but one each, and over all.
fn folds(pixels: usize, value: impl Fn(usize) -> f64) -> [f64; FOLDS + 1] {
    let mut sums = [0.0; FOLDS + 1];
    for pixel in 0..pixels {
        // Neighbours in a row fall into different folds; odd widths keep columns apart.
        sums[pixel % FOLDS] += value(pixel);
    }
    let all: f64 = sums.iter().sum();
    sums.map(|fold| all - fold)
}

/// From values without each fold and with all.
fn jackknife(values: [f64; FOLDS + 1]) -> Estimate {
    let folds = FOLDS as f64;
    let mean = values[..FOLDS].iter().sum::<f64>() / folds;
    let spread: f64 = values[..FOLDS].iter().map(|value| (value - mean).powi(2)).sum();
    Estimate { value: values[FOLDS], uncertainty: ((folds - 1.0) / folds * spread).sqrt() }
}

impl Whole {
    fn new(picture: &Twice) -> Self {
        let count = picture.0[0].len();
        let luminance = |pixel: usize| picture.mean(pixel).dot(DVec3::new(0.2126, 0.7152, 0.0722));
        let brightest = (0..count).map(luminance).fold(0.0, f64::max);
        let lit: Vec<bool> =
            (0..count).map(|pixel| luminance(pixel) > crate::metrics::LIT * brightest).collect();
        let counts = folds(count, |pixel| if lit[pixel] { 3.0 } else { 0.0 });
        let sums = folds(count, |pixel| if lit[pixel] { picture.mean(pixel).element_sum() } else { 0.0 });
        let means = std::array::from_fn(|fold| sums[fold] / counts[fold].max(1.0));
        Self { lit, counts, means }
    }

    /// Mean over the lit pixels, relative to the whole's.
    fn relative(&self, value: impl Fn(usize) -> f64, power: i32) -> [f64; FOLDS + 1] {
        let sums = folds(self.lit.len(), |pixel| if self.lit[pixel] { value(pixel) } else { 0.0 });
        std::array::from_fn(|fold| {
            let whole = self.means[fold].powi(power) * self.counts[fold];
            if whole > 0.0 { sums[fold] / whole } else { 0.0 }
        })
    }

    fn error(&self, change: &Twice) -> Estimate {
        let squares = self.relative(|pixel| change.product(change, pixel), 2);
        jackknife(squares.map(|square| square.max(0.0).sqrt()))
    }

    fn part(&self, part: &Twice) -> Part {
        let share = self.relative(|pixel| part.mean(pixel).element_sum(), 1);
        Part { share: jackknife(share), error: self.error(part) }
    }

    fn products(&self, changes: &[Twice]) -> Vec<Vec<f64>> {
        let product = |a: &Twice, b: &Twice| self.relative(|pixel| a.product(b, pixel), 2)[FOLDS];
        changes.iter().map(|a| changes.iter().map(|b| product(a, b)).collect()).collect()
    }
}

/// What `scene`, everything in its place, needs.
pub(super) fn need(scene: &Scene, settings: &Settings, cancel: &AtomicBool) -> Result<Need, Error> {
    let started = Instant::now();
    let view = |width: u32| {
        // Odd, so that a fold's pixels lie in all columns.
        let width = width.max(8) | 1;
        scene.camera.view(width, ((width as f32 / settings.aspect).round() as u32).max(1))
    };
    let (fine, coarse) = (view(settings.width), view(settings.width / 3));
    let options =
        Options { tolerance: TOLERANCE, checked_rays: 1, seed: settings.seed, ..Options::default() };
    let mut need = Need {
        scene: scene.name.clone(),
        cloud: scene.cloud.is_some(),
        terms: TermParts::default(),
        lights: Vec::new(),
        medium: MediumParts::default(),
        products: Vec::new(),
        paths: 0,
        directions: 0,
        seconds: 0.0,
    };
    let seconds = |share: f64| share * settings.seconds - started.elapsed().as_secs_f64();
    if need.cloud {
        of_cloud(&mut need, scene, &view(settings.width / 2), options, settings.seed, &seconds, cancel)?;
    } else {
        let reference = Reference::with_options(scene, options)?;
        let lights = reference.by_light(&fine, cancel)?;
        let reference = of_lights(&mut need, scene, &lights, reference, &fine, cancel)?;
        of_terms(&mut need, scene, options, &reference, &coarse, &seconds, cancel)?;
    }
    need.seconds = started.elapsed().as_secs_f64();
    Ok(need)
}

fn sum<'a>(pictures: impl Iterator<Item = &'a Image>, view: &View) -> Image {
    pictures.fold(Image::black(view.width, view.height), |sum, picture| sum.plus(picture))
}

/// Lights and simpler media, of the airlight. Gives the reference back, in the scene's own medium.
fn of_lights(
    need: &mut Need,
    scene: &Scene,
    lights: &[ByLight],
    mut reference: Reference,
    view: &View,
    cancel: &AtomicBool,
) -> Result<Reference, Error> {
    let own = Twice::exact(&sum(lights.iter().map(|light| &light.airlight), view));
    let whole = Whole::new(&own);
    let off: Vec<Twice> = lights.iter().map(|light| Twice::exact(&light.airlight)).collect();
    let shadows: Vec<Twice> = lights
        .iter()
        .zip(&off)
        .map(|(light, airlight)| Twice::exact(&light.unshadowed).plus(-1.0, airlight))
        .collect();
    need.lights = scene
        .lights
        .iter()
        .zip(off.iter().zip(&shadows))
        .map(|(light, (airlight, shadows))| LightParts {
            kind: light.kind().into(),
            airlight: whole.part(airlight),
            shadows: whole.part(shadows),
        })
        .collect();
    let mut changes = Vec::new();
    let simpler = [
        Model { grey: true, ..Model::default() },
        Model { phase: PhaseModel::HenyeyGreenstein, ..Model::default() },
        Model { phase: PhaseModel::Isotropic, ..Model::default() },
    ];
    for model in simpler {
        let medium = model.medium(&scene.medium);
        changes.push(if is_same(&medium, &scene.medium) {
            Twice::black(&own)
        } else {
            reference = reference.in_medium(medium);
            let lights = reference.by_light(view, cancel)?;
            Twice::exact(&sum(lights.iter().map(|light| &light.airlight), view)).plus(-1.0, &own)
        });
    }
    let [grey, henyey_greenstein, isotropic] = [0, 1, 2].map(|index| whole.error(&changes[index]));
    need.medium = MediumParts { grey, henyey_greenstein, isotropic };
    let all: Vec<Twice> = off.into_iter().chain(shadows).chain(changes).collect();
    need.products = whole.products(&all);
    Ok(reference.in_medium(scene.medium.clone()))
}

/// Whether two media scatter alike.
fn is_same(a: &Medium, b: &Medium) -> bool {
    let directions = (0..=16).map(|step| f64::from(step) / 8.0 - 1.0);
    let near = |x: DVec3, y: DVec3| (x - y).abs().max_element() <= 1e-6 * x.max(y).max_element();
    a.sigma_s == b.sigma_s
        && a.sigma_a == b.sigma_a
        && directions.map(|c| (a.phase.eval(c), b.phase.eval(c))).all(|(x, y)| near(x, y))
}

/// The terms of a scene without a cloud.
fn of_terms(
    need: &mut Need,
    scene: &Scene,
    options: Options,
    reference: &Reference,
    view: &View,
    seconds: &dyn Fn(f64) -> f64,
    cancel: &AtomicBool,
) -> Result<(), Error> {
    let lights = reference.by_light(view, cancel)?;
    let surface = Twice::exact(&sum(lights.iter().map(|light| &light.surface), view));
    let airlight = Twice::exact(&sum(lights.iter().map(|light| &light.airlight), view));
    let foggy = scene.medium.sigma_s != Vec3::ZERO;
    let mut indirect = Twice::black(&surface);
    if foggy && !scene.objects.is_empty() {
        // As many directions as half of the time is enough for.
        let [mut directions, most] = DIRECTIONS;
        let mut seed = options.seed;
        loop {
            let started = Instant::now();
            let half = |seed| {
                let indirect = IndirectModel::Exact { directions };
                let reference = Reference::with_options(scene, Options { indirect, seed, ..options })?;
                let rendered = reference.render(view, Term::IndirectAirlight.into(), &|_| (), cancel)?;
                rendered.indirect_airlight.ok_or_else(|| Error::Scene("a term is missing".into()))
            };
            indirect = Twice::of(&half(seed)?, &half(seed + 1)?);
            need.directions = 2 * directions;
            seed += 2;
            let spent = started.elapsed().as_secs_f64();
            let factor = (seconds(0.55) / spent.max(1e-6)).min(f64::from(most / directions)) as u32;
            if factor < 3 {
                break;
            }
            directions *= factor.next_power_of_two() / 2;
        }
    }
    let direct = surface.plus(1.0, &airlight).plus(1.0, &indirect);
    let mut multiple = Twice::black(&surface);
    if foggy {
        let whole_of = |multiple: &Twice| Whole::new(&direct.plus(1.0, multiple));
        let sure = |multiple: &Twice| {
            let Estimate { value, uncertainty } = whole_of(multiple).error(multiple);
            uncertainty < SURE * value
        };
        let take = |pictures: &multiple::Pictures| pictures.multiple.clone();
        let paths = paths(reference, view, options.seed, seconds, cancel, take, sure)?;
        (multiple, need.paths) = paths;
    }
    let whole = Whole::new(&direct.plus(1.0, &multiple));
    need.terms = TermParts {
        surface: whole.part(&surface),
        airlight: whole.part(&airlight),
        indirect_airlight: whole.part(&indirect),
        multiple: whole.part(&multiple),
    };
    Ok(())
}

/// One picture of paths, in rounds of twice as many each, until it is sure or time is over; and how many paths a pixel has
/// got.
fn paths(
    reference: &Reference,
    view: &View,
    seed: u64,
    seconds: &dyn Fn(f64) -> f64,
    cancel: &AtomicBool,
    take: impl Fn(&multiple::Pictures) -> Image,
    sure: impl Fn(&Twice) -> bool,
) -> Result<(Twice, u32), Error> {
    let mut seed = 2 * seed;
    let mut half = |samples: u32| {
        seed += 1;
        let options = multiple::Options { samples, seed, ..Default::default() };
        reference.paths(view, &options, &|_| (), cancel).map(|pictures| take(&pictures))
    };
    let (mut samples, mut all, mut picture): (u32, u32, Option<Twice>) = (PATHS, 0, None);
    loop {
        let started = Instant::now();
        let (a, b) = (half(samples)?, half(samples)?);
        let round = Twice::of(&a, &b);
        let weight = f64::from(samples) / f64::from(samples + all);
        let mean = match picture {
            Some(before) => before.plus(weight, &round.plus(-1.0, &before)),
            None => round,
        };
        all += samples;
        let spent = started.elapsed().as_secs_f64();
        if sure(&mean) || 2.0 * spent > seconds(1.0) || samples >= 1 << 20 {
            return Ok((mean, 2 * all));
        }
        picture = Some(mean);
        samples *= 2;
    }
}

/// Terms and lights of a cloud, all by paths.
fn of_cloud(
    need: &mut Need,
    scene: &Scene,
    view: &View,
    options: Options,
    seed: u64,
    seconds: &dyn Fn(f64) -> f64,
    cancel: &AtomicBool,
) -> Result<(), Error> {
    let reference = Reference::with_options(scene, options)?;
    // Each term by paths of its own: they are as independent of each other as of the sum.
    let terms: [fn(&multiple::Pictures) -> &Image; 4] =
        [|p| &p.surface, |p| &p.airlight, |p| &p.indirect_airlight, |p| &p.multiple];
    let stacked = |pictures: &multiple::Pictures| Image {
        width: view.width,
        height: 4 * view.height,
        pixels: terms.iter().flat_map(|term| term(pictures).pixels.iter().copied()).collect(),
    };
    let count = view.width as usize * view.height as usize;
    let split = |stack: &Twice| -> [Twice; 4] {
        [0, 1, 2, 3]
            .map(|term| Twice([0, 1].map(|half| stack.0[half][term * count..(term + 1) * count].to_vec())))
    };
    let total = |[a, b, c, d]: &[Twice; 4]| a.plus(1.0, b).plus(1.0, c).plus(1.0, d);
    let sure = |stack: &Twice| {
        let all = split(stack);
        let Estimate { value, uncertainty } = Whole::new(&total(&all)).error(&all[3]);
        uncertainty < SURE * value
    };
    let lights = scene.lights.len();
    let part = if lights > 1 { 0.5 } else { 1.0 };
    let (stack, paths_taken) =
        paths(&reference, view, seed, &|share| seconds(share * part), cancel, stacked, sure)?;
    need.paths = paths_taken;
    let all = split(&stack);
    let whole = Whole::new(&total(&all));
    let [surface, airlight, indirect_airlight, multiple] = [0, 1, 2, 3].map(|term| whole.part(&all[term]));
    need.terms = TermParts { surface, airlight, indirect_airlight, multiple };
    let medium = all[1].plus(1.0, &all[3]);
    let mut off = Vec::new();
    for (index, light) in scene.lights.iter().enumerate() {
        let dark = scene.sky.is_black() && lights == 1;
        off.push(if dark {
            medium.clone()
        } else {
            let alone = Scene { lights: vec![light.clone()], sky: Sky::Black, ..scene.clone() };
            let reference = Reference::with_options(&alone, options)?;
            let take = |pictures: &multiple::Pictures| pictures.airlight.plus(&pictures.multiple);
            let share = part + (1.0 - part) * (index + 1) as f64 / lights as f64;
            let seed = seed + 1000 * (index as u64 + 1);
            paths(&reference, view, seed, &|of| seconds(of * share), cancel, take, |_| false)?.0
        });
    }
    of_cloud_lights(need, &scene.lights, &Whole::new(&medium), off);
    Ok(())
}

fn of_cloud_lights(need: &mut Need, lights: &[Light], whole: &Whole, mut off: Vec<Twice>) {
    let parts = lights.iter().zip(&off).map(|(light, part)| LightParts {
        kind: light.kind().into(),
        airlight: whole.part(part),
        shadows: Part::default(),
    });
    need.lights = parts.collect();
    if let Some(black) = off.first().map(Twice::black) {
        off.resize(2 * lights.len() + 3, black);
        need.products = whole.products(&off);
    }
}
