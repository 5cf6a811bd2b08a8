//! What a scene's pictures are held against.

use common::image::Image;
use common::reference::{Reference, Rendered};
use common::{Scene, Term, Terms, metrics};

use crate::cmd::reference;
use crate::failure::Failure;
use crate::flip::mean_flip;
use crate::interrupt;
use crate::measure::{Drawn, Stage};
use crate::progress::Progress;
use crate::record::{Errors, ModelError, Pictures, ReferenceNote};
use crate::truth::{AllLight, Truth};

/// The reference of a scene's picture.
pub(crate) struct Judge {
    reference: Rendered,
    /// Airlight by the reference; at edges up to what the depth buffer holds.
    pub airlight: Image,
    /// Pixels where the depth buffer sees another surface than the reference's ray.
    other_surface: usize,
    surface: Image,
    /// Surfaces as the GPU draws them.
    pub drawn_surface: Image,
    /// Where the reference are paths: two pictures of it, so that their noise is in no error.
    paths: Option<Truth>,
    /// All light of the medium, where it is known.
    all: Option<AllLight>,
    /// Whether there is any airlight: else no relative error has a meaning.
    pub lit: bool,
    /// What the file names of its pictures begin with.
    pub prefix: String,
    pub pictures: Pictures,
}

impl Judge {
    /// Of pictures of `size` \[pixels\] that are drawn on `stage`; with `all`, of all light of the medium too.
    pub(crate) fn of(
        stage: &mut Stage<'_>,
        scene: &Scene,
        size: (u32, u32),
        all: bool,
        prefix: String,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        progress.doing(&format!("{}: reference", scene.name));
        let told = |what: &'static str| {
            let name = &scene.name;
            move |share: f32| progress.detail(format!("{name}: {what}, {:.0} %", 100.0 * share))
        };
        let still = scene.at(0.0);
        let view = still.camera.view(size.0, size.1);
        // A technique that draws clouds draws all orders of scattering.
        let cloudy = scene.cloud.is_some();
        let terms = if cloudy { Terms::DIRECT.with(Term::Multiple) } else { Terms::DIRECT };
        let rendered = reference(&still, &view, terms, &told("reference"))?;
        if let Some(problem) = &rendered.cache_problem {
            progress.say(&format!("note: the reference was not kept for the next run: {problem}"));
        }
        let (Some(own), Some(surface)) = (&rendered.airlight, &rendered.surface) else {
            return Err(Failure::Run(format!("{}: the reference lacks a term", scene.name)));
        };
        let paths = if cloudy { Some(Truth::of(&still, size, &told("paths"))?) } else { None };
        let (airlight, other_surface) = match &paths {
            Some(paths) => (paths.image().clone(), 0),
            None => {
                let distances = stage.distances(0.0)?;
                let failed = |error| crate::cmd::reference_failure(&scene.name, error);
                Reference::new(&still)
                    .and_then(|reference| {
                        reference.airlight_as_seen(&view, own, &distances, interrupt::flag())
                    })
                    .map_err(failed)?
            }
        };
        let all = if all && !cloudy {
            Some(AllLight::of(&still, &view, &airlight, &told("all light"))?)
        } else {
            None
        };
        Ok(Self {
            drawn_surface: stage.picture(None, 0.0, Drawn::Surface)?,
            lit: airlight.pixels.iter().any(|pixel| pixel.max_element() > 0.0),
            surface: surface.clone(),
            airlight,
            other_surface,
            paths,
            all,
            pictures: Pictures {
                reference: format!("{prefix}-reference.png"),
                reference_airlight_exr: format!("{prefix}-reference-airlight.exr"),
                exposure: rendered.total().auto_exposure(),
                ..Default::default()
            },
            prefix,
            reference: rendered,
        })
    }

    /// The reference's picture of all its terms.
    pub(crate) fn total(&self) -> Image {
        self.reference.total()
    }

    /// Relative RMSE of a picture of the airlight alone; NaN where nothing is lit.
    pub(crate) fn relative_error(&self, airlight: &Image) -> Result<f64, Failure> {
        match &self.paths {
            _ if !self.lit => Ok(f64::NAN),
            Some(paths) => paths.off(airlight).map(|off| off.rel_rmse),
            None => crate::truth::relative(airlight, &self.airlight),
        }
    }

    /// What a picture of the airlight is off by.
    pub(crate) fn errors(&self, airlight: &Image) -> Result<Errors, Failure> {
        let error = metrics::compare(airlight, &self.airlight).map_err(|e| Failure::Run(e.to_string()))?;
        let (rel_rmse, bias) = match &self.paths {
            // Of no light nothing is a share.
            _ if !self.lit => (f64::NAN, f64::NAN),
            Some(paths) => paths.off(airlight).map(|off| (off.rel_rmse, off.bias))?,
            None => (error.rel_rmse, error.bias),
        };
        let seen = |airlight: &Image| self.surface.plus(airlight).to_srgb8(self.pictures.exposure);
        let (width, height) = (airlight.width as usize, airlight.height as usize);
        let flip = mean_flip(&seen(&self.airlight), &seen(airlight), width, height);
        Ok(Errors {
            rel_rmse,
            bias,
            p99: error.p99,
            max: error.max,
            worst_tile: error.worst_tile,
            leak: error.leak,
            flip,
            nan: error.nan,
            inf: error.inf,
            negative: error.negative,
            energy_ratio: error.energy_ratio,
        })
    }

    /// What it is off by from all light of the medium, where that is known.
    pub(crate) fn model_error(&self, airlight: &Image) -> Result<Option<ModelError>, Failure> {
        self.all.as_ref().map(|all| all.error_of(airlight)).transpose()
    }

    /// What a record says of it; `terms` are those of the airlight.
    pub(crate) fn note(&self, terms: Vec<String>) -> ReferenceNote {
        ReferenceNote {
            terms,
            uncertainty: self.paths.as_ref().map_or(self.reference.uncertainty, Truth::uncertainty),
            seconds: self.reference.seconds,
            cached: self.reference.cached,
            other_surface: self.other_surface,
        }
    }
}
