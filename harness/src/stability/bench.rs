//! What a row's figures come from: pictures, and what they should be.

use std::collections::{BTreeSet, HashMap};
use std::panic::{AssertUnwindSafe, catch_unwind};

use common::gpu::Context;
use common::image::Image;
use common::reference::Reference;
use common::{Scene, Term, metrics};

use super::row::{Measure, SHADOW_MAP, Setup, Still, Truth};
use crate::cmd::{reference, reference_failure};
use crate::failure::Failure;
use crate::interrupt;
use crate::measure::Stage;
use crate::techniques::{CLOUDS, Method, Technique};
use crate::truth::Truth as Paths;

/// Draws rows; a renderer is made once and draws whatever comes, as in a program that runs for long.
pub(super) struct Bench<'a> {
    context: &'a Context,
    kept: HashMap<(String, wgpu::TextureFormat), Box<dyn Technique>>,
}

/// Pixels of a picture that a renderer is kept after.
const MOST_PIXELS: u64 = 1 << 18;

/// The grounds of a setup's frames by their size, for all methods: to make one takes longer than to draw a picture.
pub(super) type Stages<'s> = Vec<((u32, u32), Stage<'s>)>;

/// What a method made of a setup.
pub(super) enum Outcome {
    Drawn {
        pictures: Vec<Image>,
        warnings: Vec<String>,
        /// Growth of the program's memory over the second half of the frames \[bytes a frame\].
        memory: f64,
    },
    /// It says that it can't draw this, and why.
    Refused(String),
    /// It panicked, or the device complained.
    Broken(String),
}

/// What the pictures of a setup should be.
pub(super) enum Wanted {
    /// One for each frame that is judged, and how many pixels of a picture one of it is, each way.
    Pictures {
        images: Vec<Image>,
        thinned: u32,
    },
    Paths(Box<Paths>),
    /// Black; the mean of the lit scene's pixels.
    Black {
        mean: f64,
    },
    Unknown,
}

/// A figure, and how often a pixel is no radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Figure {
    /// Of the row's measure; `None` where what is right is not known.
    pub value: Option<f64>,
    /// Relative mean signed error, where there is a reference.
    pub bias: Option<f64>,
    /// Sum of the picture over that of the reference, where there is one.
    pub energy_ratio: Option<f64>,
    /// Pixels that are NaN, infinite or negative.
    pub broken: u32,
}

impl<'a> Bench<'a> {
    pub(super) fn new(context: &'a Context) -> Self {
        Self { context, kept: HashMap::new() }
    }

    /// What a method makes of a setup. Fails where the user stopped it.
    pub(super) fn draw<'s>(
        &mut self,
        setup: &'s Setup,
        stages: &mut Stages<'s>,
        method: &Method,
    ) -> Result<Outcome, Failure>
    where
        'a: 's,
    {
        let format = setup.format.unwrap_or_else(|| self.context.radiance_format());
        let key = (method.name.clone(), format);
        let Some(first) = setup.frames.first() else { return Ok(Outcome::Refused("no frame".into())) };
        if let Some(refusal) = method.refusal(&first.scene) {
            return Ok(Outcome::Refused(refusal));
        }
        // A cloud is loaded once.
        let mut technique = match self.kept.remove(&key).filter(|_| method.technique != CLOUDS) {
            Some(technique) => technique,
            None => match method.make(&self.context.device, &self.context.queue, format, first.size) {
                Ok(technique) => technique,
                Err(refusal) => return Ok(Outcome::Refused(refusal)),
            },
        };
        // What was made for large maps or pictures is not kept with it.
        let pixels = u64::from(first.size.0) * u64::from(first.size.1);
        let keep = setup.shadow_map <= SHADOW_MAP && pixels < MOST_PIXELS;
        let drawn = catch_unwind(AssertUnwindSafe(|| self.frames(setup, stages, technique.as_mut(), format)));
        match drawn {
            Ok(Ok(outcome)) => {
                if keep {
                    self.kept.insert(key, technique);
                }
                Ok(outcome)
            }
            Ok(Err(Failure::Input(refusal))) => Ok(Outcome::Refused(refusal)),
            Ok(Err(Failure::Run(problem))) => Ok(Outcome::Broken(problem)),
            Ok(Err(stopped)) => Err(stopped),
            Err(panic) => {
                let said = panic.downcast_ref::<String>().cloned();
                let said = said.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
                Ok(Outcome::Broken(format!("panicked: {}", said.unwrap_or_default())))
            }
        }
    }

    fn frames<'s>(
        &self,
        setup: &'s Setup,
        stages: &mut Stages<'s>,
        technique: &mut dyn Technique,
        format: wgpu::TextureFormat,
    ) -> Result<Outcome, Failure>
    where
        'a: 's,
    {
        let mut pictures = Vec::with_capacity(setup.frames.len());
        let mut warnings: BTreeSet<String> = BTreeSet::new();
        let mut before = 0;
        for (index, still) in setup.frames.iter().enumerate() {
            interrupt::check()?;
            if index == setup.frames.len() / 2 {
                before = self.bytes_but_for(&pictures);
            }
            let stage = match stages.iter().position(|(size, _)| *size == still.size) {
                Some(index) => &mut stages[index].1,
                None => {
                    let side = setup.shadow_map;
                    let made = Stage::of_format(self.context, &still.scene, still.size, side, format)?;
                    stages.push((still.size, made));
                    let last = stages.len() - 1;
                    &mut stages[last].1
                }
            };
            pictures.push(stage.airlight_of(technique, &still.scene)?);
            warnings.extend(technique.warnings());
        }
        let second_half = setup.frames.len().div_ceil(2).max(1) as f64;
        let memory = self.bytes_but_for(&pictures).saturating_sub(before) as f64 / second_half;
        Ok(Outcome::Drawn { pictures, warnings: warnings.into_iter().collect(), memory })
    }

    /// What the program has on the heap, and on the device where that says, without these pictures. (What a driver keeps for
    /// itself is not in it.)
    fn bytes_but_for(&self, pictures: &[Image]) -> usize {
        let kept: usize = pictures.iter().map(|picture| size_of_val(picture.pixels.as_slice())).sum();
        let device = self.context.device.generate_allocator_report();
        crate::HEAP.allocated() - kept + device.map_or(0, |report| report.total_allocated_bytes as usize)
    }

    /// What a setup's pictures should be.
    pub(super) fn wanted(&self, setup: &Setup, measure: Measure) -> Result<Wanted, Failure> {
        let frames = match measure {
            Measure::Error | Measure::Relative => &setup.frames[..1.min(setup.frames.len())],
            Measure::Flicker => &setup.frames[..],
            Measure::Return | Measure::Memory | Measure::Sound => return Ok(Wanted::Unknown),
        };
        let [first, ..] = frames else { return Ok(Wanted::Unknown) };
        let own = |thinned: u32| -> Result<Vec<Image>, Failure> {
            let small = |still: &Still| (still.size.0 / thinned, still.size.1 / thinned);
            frames.iter().map(|still| self.airlight(&still.scene, small(still))).collect()
        };
        Ok(match &setup.truth {
            Truth::Unknown => Wanted::Unknown,
            Truth::Black(lit) => {
                let image = self.airlight(lit, first.size)?;
                let sum: f64 = image.pixels.iter().map(|pixel| f64::from(pixel.element_sum())).sum();
                Wanted::Black { mean: sum / (3.0 * image.pixels.len() as f64) }
            }
            Truth::Own if first.scene.cloud.is_some() => paths(&first.scene, first.size)?,
            Truth::Of(scene) if scene.cloud.is_some() => paths(scene, first.size)?,
            Truth::Own => Wanted::Pictures { images: own(1)?, thinned: 1 },
            Truth::Thinned(times) => Wanted::Pictures { images: own(*times)?, thinned: *times },
            Truth::Of(scene) => {
                Wanted::Pictures { images: vec![self.airlight(scene, first.size)?], thinned: 1 }
            }
            Truth::OwnBut(pixels) => {
                let mut images = own(1)?;
                for image in &mut images {
                    for &(x, y) in pixels {
                        // What is no number in a reference judges nothing.
                        image.pixels[(y * image.width + x) as usize] = glam::Vec3::NAN;
                    }
                }
                Wanted::Pictures { images, thinned: 1 }
            }
        })
    }

    /// The reference's airlight, at edges up to what the depth buffer holds.
    fn airlight(&self, scene: &Scene, size: (u32, u32)) -> Result<Image, Failure> {
        let view = scene.camera.view(size.0, size.1);
        let rendered = reference(scene, &view, Term::Airlight.into(), &|_| {})?;
        let own = rendered.airlight.ok_or_else(|| Failure::Run("the reference lacks a term".into()))?;
        let mut stage = Stage::new(self.context, scene, size, 2)?;
        let distances = stage.distances(0.0)?;
        let failed = |error| reference_failure(&scene.name, error);
        let seen = Reference::new(scene)
            .and_then(|reference| reference.airlight_as_seen(&view, &own, &distances, interrupt::flag()));
        Ok(seen.map_err(failed)?.0)
    }
}

fn paths(scene: &Scene, size: (u32, u32)) -> Result<Wanted, Failure> {
    Ok(Wanted::Paths(Box::new(Paths::of(scene, size, &|_| {})?)))
}

/// Every n-th pixel each way, from the middle of the first n on.
fn thin(image: &Image, times: u32) -> Image {
    let mut thin = Image::black(image.width / times, image.height / times);
    for (index, pixel) in thin.pixels.iter_mut().enumerate() {
        let (x, y) = (index as u32 % thin.width, index as u32 / thin.width);
        *pixel = image.pixels[((y * times + times / 2) * image.width + x * times + times / 2) as usize];
    }
    thin
}

/// Pixels that are no radiance.
fn broken(image: &Image) -> u32 {
    image.pixels.iter().filter(|pixel| !(pixel.is_finite() && pixel.min_element() >= 0.0)).count() as u32
}

/// A method's picture, and what it should be where that is known.
pub(super) type Shown = (Image, Option<Image>);

/// The figure of a setup's pictures; also those that show it best.
pub(super) fn figure(
    setup: &Setup,
    measure: Measure,
    pictures: &[Image],
    memory: f64,
    wanted: &Wanted,
) -> Result<(Figure, Option<Shown>), Failure> {
    let mut figure =
        Figure { value: None, bias: None, energy_ratio: None, broken: pictures.iter().map(broken).sum() };
    let Some(first) = pictures.first() else { return Ok((figure, None)) };
    let compare = |image: &Image, other: &Image| {
        metrics::compare(image, other).map_err(|error| Failure::Run(error.to_string()))
    };
    let shown = match (measure, wanted) {
        (Measure::Memory, _) => {
            figure.value = Some(memory);
            None
        }
        (Measure::Return, _) => {
            let (difference, pair) = largest_difference(setup, pictures);
            figure.value = Some(difference);
            pair
        }
        (Measure::Flicker, Wanted::Pictures { images, .. }) => {
            figure.value = Some(flicker(pictures, images));
            images.first().map(|image| (first.clone(), Some(image.clone())))
        }
        (_, Wanted::Pictures { images, thinned }) => {
            let Some(image) = images.first() else { return Ok((figure, None)) };
            let picture = if *thinned == 1 { first.clone() } else { thin(first, *thinned) };
            let errors = compare(&picture, image)?;
            let value =
                if measure == Measure::Relative { relative(&picture, image) } else { errors.rel_rmse };
            (figure.value, figure.bias) = (Some(value), Some(errors.bias));
            figure.energy_ratio = Some(errors.energy_ratio);
            Some((picture, Some(image.clone())))
        }
        (_, Wanted::Paths(paths)) => {
            let off = paths.off(first)?;
            // What is less than the paths' own noise is not known.
            (figure.value, figure.bias) = (Some(off.rel_rmse.max(paths.uncertainty())), Some(off.bias));
            if !paths.image().pixels.iter().any(|pixel| pixel.max_element() > 0.0) {
                // Of no light nothing is a share.
                figure.bias = None;
                figure.value = Some(if first.pixels.iter().all(|p| p.max_element() <= 0.0) {
                    0.0
                } else {
                    f64::INFINITY
                });
            }
            Some((first.clone(), Some(paths.image().clone())))
        }
        (_, Wanted::Black { mean }) => {
            let square: f64 = first
                .pixels
                .iter()
                .map(|pixel| if pixel.is_finite() { f64::from(pixel.length_squared()) } else { 0.0 })
                .sum();
            let rms = (square / (3.0 * first.pixels.len() as f64)).sqrt();
            figure.value = Some(rms / mean);
            Some((first.clone(), Some(Image::black(first.width, first.height))))
        }
        (_, Wanted::Unknown) => Some((first.clone(), None)),
    };
    Ok((figure, shown))
}

/// RMS of relative errors where the reference is lit.
fn relative(image: &Image, reference: &Image) -> f64 {
    let errors: Vec<f64> = image
        .pixels
        .iter()
        .zip(&reference.pixels)
        .filter(|(_, truth)| truth.is_finite() && truth.min_element() > 0.0)
        .map(|(pixel, truth)| {
            let pixel = if pixel.is_finite() { *pixel } else { glam::Vec3::ZERO };
            f64::from(((pixel - *truth) / *truth).length_squared() / 3.0)
        })
        .collect();
    (errors.iter().sum::<f64>() / errors.len().max(1) as f64).sqrt()
}

/// Between pictures of one place, over the brightest pixel; and the two.
fn largest_difference(setup: &Setup, pictures: &[Image]) -> (f64, Option<Shown>) {
    let mut worst: (f64, Option<Shown>) = (0.0, None);
    for (index, (still, picture)) in setup.frames.iter().zip(pictures).enumerate() {
        let earlier = setup.frames[..index].iter().position(|other| other.place == still.place);
        let Some(earlier) = earlier.map(|index| &pictures[index]) else { continue };
        let brightest = earlier.pixels.iter().map(|pixel| pixel.max_element()).fold(0.0, f32::max);
        let pairs = picture.pixels.iter().zip(&earlier.pixels);
        let difference = pairs.map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f32::max);
        let share = if difference == 0.0 { 0.0 } else { f64::from(difference / brightest) };
        if share > worst.0 || worst.1.is_none() {
            worst = (share, Some((picture.clone(), Some(earlier.clone()))));
        }
    }
    worst
}

/// RMS of how much more pictures change than the references, over the mean reference.
fn flicker(pictures: &[Image], references: &[Image]) -> f64 {
    let (mut square, mut sum, mut count) = (0.0, 0.0, 0.0);
    for (pictures, references) in pictures.windows(2).zip(references.windows(2)) {
        let change =
            |images: &[Image], index: usize| (images[1].pixels[index] - images[0].pixels[index]).as_dvec3();
        for index in 0..pictures[0].pixels.len().min(references[0].pixels.len()) {
            let beyond = change(pictures, index) - change(references, index);
            if beyond.is_finite() {
                square += beyond.length_squared();
                sum += f64::from(references[0].pixels[index].element_sum());
                count += 3.0;
            }
        }
    }
    if sum > 0.0 { (square / count).sqrt() / (sum / count) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn picture(values: &[f32]) -> Image {
        let mut image = Image::black(values.len() as u32, 1);
        image.pixels = values.iter().map(|value| Vec3::splat(*value)).collect();
        image
    }

    #[test]
    fn flicker_is_change_that_the_reference_has_not() {
        let references = [picture(&[1.0, 1.0]), picture(&[1.0, 2.0])];
        assert_eq!(flicker(&references, &references), 0.0);
        let pictures = [picture(&[1.0, 1.0]), picture(&[1.3, 1.6])];
        let expected = ((0.3f64.powi(2) + 0.4f64.powi(2)) / 2.0).sqrt() / 1.0;
        assert!((flicker(&pictures, &references) - expected).abs() < 1e-6);
    }

    #[test]
    fn pictures_of_one_place_are_held_against_each_other() {
        let setup = Setup::returning([0, 1, 0], |_| Scene::empty("nothing"));
        let [a, b, c] = [[1.0, 4.0], [9.0, 9.0], [1.0, 5.0]].map(|values| picture(&values));
        assert_eq!(largest_difference(&setup, &[a.clone(), b.clone(), a.clone()]).0, 0.0);
        assert_eq!(largest_difference(&setup, &[a, b, c]).0, 0.25);
    }

    #[test]
    fn a_picture_is_thinned_at_the_middles() {
        let image = Image { width: 6, height: 3, ..picture(&(0..18).map(|i| i as f32).collect::<Vec<_>>()) };
        let pixels: Vec<f32> = thin(&image, 3).pixels.iter().map(|pixel| pixel.x).collect();
        assert_eq!(pixels, [7.0, 10.0]);
    }

    #[test]
    fn what_is_no_radiance_is_broken() {
        assert_eq!(broken(&picture(&[0.0, 1.0, f32::NAN, f32::INFINITY, -1e-9])), 3);
    }
}
