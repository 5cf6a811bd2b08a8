//! Multiple scattering, by paths from the eye.
//!
//! A path goes from the eye through the medium: where it collides, light is scattered into it from all
//! lights, and it goes on in a direction by the phase function; where it meets a surface, it is
//! reflected. In a cloud distances are found by delta tracking, in a homogeneous medium by the law of
//! their colours. What joins a path belongs to a term by what the path has met ([`crate::Term`]).
//! Light of surfaces among themselves, without any scattering, belongs to none and is left out. The
//! sky is seen by what a cloud scatters only: it is no background and lights no surface.
//!
//! A scene without a cloud has its homogeneous medium, which has no end: there paths go on by chance
//! after some scatterings, however bright they are, which matters for an albedo near 1.
//!
//! Everything is right on average; [`Pictures`] says how far off it may be. `simple` does the same in
//! about a hundred lines without any trick, to check it by.

mod escape;
mod path;
mod random;
mod simple;
mod volume;

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::{Error, Rays, Reference, Scratch};
use crate::image::Image;
use crate::{Scene, View};
pub use escape::{Escape, beam, scattered_power};
use path::{Sample, Tracer};
use random::Random;
pub use simple::simple;
use volume::Volume;

/// Settings of the paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Paths per pixel, at least 1.
    pub samples: u32,
    /// Another picture of the same scene for every seed.
    pub seed: u64,
    /// Most scatterings of a path; light that is scattered more often is left out. `None` for no limit.
    pub max_scatterings: Option<u32>,
}

impl Default for Options {
    fn default() -> Self {
        Self { samples: 32, seed: 0, max_scatterings: None }
    }
}

/// A mean and how sure it is, by colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Mean of the samples.
    pub mean: DVec3,
    /// Standard error of the mean.
    pub error: DVec3,
}

/// What the paths of a picture add up to, RGB \[W m⁻² sr⁻¹\] but for the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Pictures {
    /// Direct light on surfaces, attenuated by the cloud; only of a scene with a cloud, else black.
    pub surface: Image,
    /// One scattering of the lights and, in a cloud, of the sky.
    pub airlight: Image,
    /// One scattering of the same that then lights the surface that is seen.
    pub indirect_airlight: Image,
    /// All other light that the medium has scattered or emitted.
    pub multiple: Image,
    /// Standard error of `airlight` and `multiple` together.
    pub error: Image,
    /// Standard error of `multiple`.
    pub multiple_error: Image,
    /// Standard error of `surface`, `airlight` and `indirect_airlight` together.
    pub direct_error: Image,
    /// Transmittance, RGB in [0, 1], of the view rays up to the surface that is seen, or all the way.
    pub transmittance: Image,
}

/// Sums over samples.
#[derive(Clone, Copy, Default)]
struct Sum {
    count: f64,
    sum: DVec3,
    squares: DVec3,
}

impl Sum {
    fn add(&mut self, value: DVec3) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    fn plus(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
        }
    }

    fn estimate(&self) -> Estimate {
        let mean = self.sum / self.count.max(1.0);
        let variance = (self.squares / self.count.max(1.0) - mean * mean).max(DVec3::ZERO);
        let sqrt = |v: DVec3| DVec3::from_array(v.to_array().map(f64::sqrt));
        Estimate { mean, error: sqrt(variance / (self.count - 1.0).max(1.0)) }
    }
}

/// One pixel of [`Pictures`].
#[derive(Clone, Copy, Default)]
struct Pixel {
    sample: Sample,
    error: DVec3,
    multiple_error: DVec3,
    direct_error: DVec3,
    transmittance: DVec3,
}

/// What a scene's paths go through: its cloud, or its medium.
fn volume<'a>(cloud: Option<&'a crate::Cloud>, medium: &'a crate::Medium) -> Volume<'a> {
    match cloud {
        Some(cloud) if cloud.sigma_t > 0.0 => Volume::Cloud(cloud),
        _ => Volume::Endless(medium),
    }
}

/// What is wrong with a scene's media, if anything.
pub(super) fn problem(scene: &Scene) -> Option<String> {
    let foggy = scene.medium.sigma_t() != glam::Vec3::ZERO;
    (scene.cloud.is_some() && foggy).then(|| {
        "there is both a cloud and a medium that fills all space; a cloud hangs in clear air, so leave one of \
         them out"
            .into()
    })
}

impl Reference {
    /// Follows paths through every pixel's centre. `progress` is told the finished fraction, in [0, 1], from any
    /// thread; `cancel` is looked at before every pixel.
    ///
    /// # Errors
    /// [`Error::Scene`], for a view that is not valid; [`Error::Cancelled`] once `cancel` is set.
    pub fn paths(
        &self,
        view: &View,
        options: &Options,
        progress: &(dyn Fn(f32) + Sync),
        cancel: &AtomicBool,
    ) -> Result<Pictures, Error> {
        super::check_view(view)?;
        let rays = Rays::new(view);
        let done = AtomicU32::new(0);
        let tracer = self.tracer(options.max_scatterings);
        let rows = (0..view.height)
            .into_par_iter()
            .map_init(
                || self.scratch(),
                |scratch, y| {
                    let row = (0..view.width)
                        .map(|x| {
                            if cancel.load(Ordering::Relaxed) {
                                return Err(Error::Cancelled);
                            }
                            let pixel = u64::from(y) * u64::from(view.width) + u64::from(x);
                            let random = Random::new(options.seed, pixel);
                            Ok(tracer.pixel(rays.through(x, y), options.samples, random, scratch))
                        })
                        .collect::<Result<Vec<Pixel>, _>>()?;
                    progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f32 / view.height as f32);
                    Ok(row)
                },
            )
            .collect::<Result<Vec<_>, Error>>()?;
        let picture = |of: fn(&Pixel) -> DVec3| Image {
            width: view.width,
            height: view.height,
            pixels: rows.iter().flatten().map(|pixel| of(pixel).as_vec3()).collect(),
        };
        Ok(Pictures {
            surface: picture(|pixel| pixel.sample.surface),
            airlight: picture(|pixel| pixel.sample.airlight),
            indirect_airlight: picture(|pixel| pixel.sample.indirect),
            multiple: picture(|pixel| pixel.sample.multiple),
            error: picture(|pixel| pixel.error),
            multiple_error: picture(|pixel| pixel.multiple_error),
            direct_error: picture(|pixel| pixel.direct_error),
            transmittance: picture(|pixel| pixel.transmittance),
        })
    }

    fn tracer(&self, max_scatterings: Option<u32>) -> Tracer<'_> {
        let volume = volume(self.cloud.as_ref(), &self.medium);
        Tracer {
            reference: self,
            volume,
            max_scatterings: max_scatterings.unwrap_or(u32::MAX),
            surfaces: !volume.is_endless(),
        }
    }
}

impl Tracer<'_> {
    fn pixel(&self, ray: [DVec3; 2], samples: u32, mut random: Random, scratch: &mut Scratch) -> Pixel {
        let samples = samples.max(1);
        let (mut terms, mut transmittance) = ([Sum::default(); 4], Sum::default());
        let (mut both, mut direct) = (Sum::default(), Sum::default());
        for _ in 0..if self.volume.is_exact() { 1 } else { samples } {
            transmittance.add(self.transmittance(ray, &mut random, scratch));
        }
        for _ in 0..if self.volume.is_vacuum() { 0 } else { samples } {
            let Sample { surface, airlight, indirect, multiple } = self.sample(ray, &mut random, scratch);
            for (sum, term) in terms.iter_mut().zip([surface, airlight, indirect, multiple]) {
                sum.add(term);
            }
            both.add(airlight + multiple);
            direct.add(surface + airlight + indirect);
        }
        let [surface, airlight, indirect, multiple] = terms.map(|sum| sum.estimate());
        Pixel {
            sample: Sample {
                surface: surface.mean,
                airlight: airlight.mean,
                indirect: indirect.mean,
                multiple: multiple.mean,
            },
            error: both.estimate().error,
            multiple_error: multiple.error,
            direct_error: direct.estimate().error,
            transmittance: transmittance.estimate().mean,
        }
    }
}

/// Standard errors of a picture, relative to its mean: RMS over the pixels.
pub(super) fn relative(error: &Image, picture: &Image) -> f64 {
    let squares: f64 = error.pixels.iter().map(|e| e.as_dvec3().length_squared()).sum();
    let sum: f64 = picture.pixels.iter().map(|p| p.as_dvec3().element_sum()).sum();
    let count = 3.0 * error.pixels.len().max(1) as f64;
    if squares == 0.0 { 0.0 } else { (squares / count).sqrt() / (sum / count) }
}
