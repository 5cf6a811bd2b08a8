//! How little of a scene's light transport is enough: each term's and each light's share of the picture, estimated in
//! a few seconds on the CPU from small pictures by the reference.
//!
//! ```
//! use common::need::{Settings, estimate};
//! use common::scene::builtin;
//!
//! let scene = builtin::knife_edge();
//! let need = estimate(&scene, &Settings { width: 32, seconds: 0.5, ..Settings::default() }).unwrap();
//! let model = need.model(0.02);
//! println!("{}", need.sentences(0.02).join("\n"));
//! assert!(need.error_of(&model) < 0.02);
//! ```
//!
//! Pictures are of the scene at time 0. As everywhere, an error is a relative RMSE: RMS over the lit pixels, relative to
//! their mean. The error of a [`Model`] is that of the airlight, which is what techniques are judged by, and to first order:
//! what each simplification changes is added up, with signs, pixel by pixel (from the products of the changes with each
//! other), but not what they change in one another.

mod model;
mod pictures;
mod words;

use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use crate::Scene;
use crate::reference::Error;
pub use model::{Model, PhaseModel, Shaft};

/// What an estimate may cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Width of the picture that lights and media are compared in \[pixels\], at least 8; terms are compared in one of a
    /// third of its width.
    pub width: u32,
    /// Width over height, between 0.01 and 100.
    pub aspect: f32,
    /// About how long it may take \[s\]. Paths and directions are followed until it is over, so how many there were, and
    /// with them the last digits of the terms of more than one bounce, differ from run to run.
    pub seconds: f64,
    /// Other paths for every seed.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { width: 96, aspect: 1.25, seconds: 2.0, seed: 1 }
    }
}

/// A number and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub uncertainty: f64,
}

/// What a part is to a whole picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Mean radiance of the part over that of the whole; 0 where there is no light at all.
    pub share: Estimate,
    /// Error of the whole without the part: its RMS over the lit pixels, relative to their mean.
    pub error: Estimate,
}

impl Part {
    /// Whether the part may be left out within an error of `bound`, with two standard errors to spare.
    pub fn may_be_left_out(&self, bound: f64) -> bool {
        self.error.value + 2.0 * self.error.uncertainty <= bound
    }
}

/// Parts of the whole picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TermParts {
    /// Direct light on surfaces.
    pub surface: Part,
    /// Direct single scattering, with shadows.
    pub airlight: Part,
    /// Single scattering that then lights a surface.
    pub indirect_airlight: Part,
    /// All other light that the medium has scattered.
    pub multiple: Part,
}

/// Parts of the airlight.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightParts {
    /// `point`, `spot` or `directional`.
    pub kind: String,
    /// The light's airlight.
    pub airlight: Part,
    /// What its shadows in the air take away; of a cloud, which shadows itself, it is not known and 0.
    pub shadows: Part,
}

/// Errors of the airlight in a simpler medium; 0 where it is as simple already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MediumParts {
    /// Of one colour.
    pub grey: Estimate,
    /// With one Henyey-Greenstein lobe of the same mean cosine.
    pub henyey_greenstein: Estimate,
    /// With an isotropic phase function.
    pub isotropic: Estimate,
}

/// What a scene needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Need {
    /// The scene's name.
    pub scene: String,
    /// Whether it is a cloud: then what the medium sends, airlight and multiple scattering, counts together wherever
    /// airlight is spoken of, and the only simplification is a light that is off.
    pub cloud: bool,
    /// Of the whole picture.
    pub terms: TermParts,
    /// Of the airlight, light by light.
    pub lights: Vec<LightParts>,
    /// Of the airlight.
    pub medium: MediumParts,
    /// Mean products of what the simplifications change in the airlight, relative to its squared mean: each light off,
    /// each light unshadowed, then grey, one lobe, isotropic.
    products: Vec<Vec<f64>>,
    /// Paths per pixel that the multiple scattering comes from.
    pub paths: u32,
    /// Directions per pixel and light that the indirect airlight comes from.
    pub directions: u32,
    /// Time that it took \[s\].
    pub seconds: f64,
}

/// Share of a bound that a model may take: the rest is the technique's. Errors add up by their squares, so that this
/// leaves it 87 %.
const MODEL_SHARE: f64 = 0.5;

/// Estimates what `scene` needs.
///
/// # Errors
/// [`Error::Scene`], for settings out of their ranges and where the reference can't draw the scene.
pub fn estimate(scene: &Scene, settings: &Settings) -> Result<Need, Error> {
    estimate_until(scene, settings, &AtomicBool::new(false))
}

/// As [`estimate`], until `cancel` is set.
///
/// # Errors
/// As [`estimate`], and [`Error::Cancelled`] once `cancel` is set.
pub fn estimate_until(scene: &Scene, settings: &Settings, cancel: &AtomicBool) -> Result<Need, Error> {
    if settings.width < 8 || !(settings.aspect > 0.01 && settings.aspect < 100.0) {
        return Err(Error::Scene(format!(
            "an estimate from a picture of {} pixels across, {} times as wide as high; expected at least 8, and 0.01 to \
             100",
            settings.width, settings.aspect
        )));
    }
    pictures::need(&scene.at(0.0), settings, cancel)
}

impl Need {
    /// Error of the airlight as `model` has it, without what a technique adds to it.
    pub fn error_of(&self, model: &Model) -> f64 {
        let signs = self.signs(model);
        let products = self.products.iter().zip(&signs);
        let square = |(row, sign): (&Vec<f64>, &f64)| -> f64 {
            sign * row.iter().zip(&signs).map(|(product, sign)| product * sign).sum::<f64>()
        };
        products.map(square).sum::<f64>().max(0.0).sqrt()
    }

    /// Standard error of [`Need::error_of`].
    pub fn uncertainty_of(&self, model: &Model) -> f64 {
        let lights = self.lights.iter().enumerate().map(|(index, light)| match model.shaft(index) {
            Shaft::Off => light.airlight.error.uncertainty,
            Shaft::Unshadowed => light.shadows.error.uncertainty,
            Shaft::Shadowed => 0.0,
        });
        let grey = if model.grey { self.medium.grey.uncertainty } else { 0.0 };
        let phase = match model.phase {
            PhaseModel::Own => 0.0,
            PhaseModel::HenyeyGreenstein => self.medium.henyey_greenstein.uncertainty,
            PhaseModel::Isotropic => self.medium.isotropic.uncertainty,
        };
        lights.chain([grey, phase]).map(|error| error * error).sum::<f64>().sqrt()
    }

    /// How much of each simplification is in `model`, in the order of the products.
    fn signs(&self, model: &Model) -> Vec<f64> {
        let of = |shaft: Shaft, sign: f64| {
            (0..self.lights.len()).map(move |index| if model.shaft(index) == shaft { sign } else { 0.0 })
        };
        let is = |yes: bool| if yes { 1.0 } else { 0.0 };
        let medium = [
            is(model.grey),
            is(model.phase == PhaseModel::HenyeyGreenstein),
            is(model.phase == PhaseModel::Isotropic),
        ];
        of(Shaft::Off, -1.0).chain(of(Shaft::Unshadowed, 1.0)).chain(medium).collect()
    }

    /// The least of the scene's airlight that stays within an error of `bound` and leaves a technique most of it: lights off
    /// before lights without shadows, the least missed first, then a simpler medium.
    pub fn model(&self, bound: f64) -> Model {
        let mut model = Model { lights: vec![Shaft::Shadowed; self.lights.len()], ..Model::default() };
        let fits =
            |model: &Model| self.error_of(model) + 2.0 * self.uncertainty_of(model) <= MODEL_SHARE * bound;
        let mut order: Vec<usize> = (0..self.lights.len()).collect();
        let mut take = |model: &mut Model, shaft: Shaft, error: &dyn Fn(&LightParts) -> f64| {
            order.sort_by(|a, b| error(&self.lights[*a]).total_cmp(&error(&self.lights[*b])));
            for &index in &order {
                if model.lights[index] == Shaft::Shadowed {
                    let before = std::mem::replace(&mut model.lights[index], shaft);
                    if !fits(model) {
                        model.lights[index] = before;
                    }
                }
            }
        };
        take(&mut model, Shaft::Off, &|light| light.airlight.error.value);
        if self.cloud {
            return model;
        }
        take(&mut model, Shaft::Unshadowed, &|light| light.shadows.error.value);
        // Exactly what it is already is no simplification.
        for (error, change) in [
            (self.medium.isotropic, Model { phase: PhaseModel::Isotropic, ..model.clone() }),
            (self.medium.henyey_greenstein, Model { phase: PhaseModel::HenyeyGreenstein, ..model.clone() }),
        ] {
            if error.value > 0.0 && model.phase == PhaseModel::Own && fits(&change) {
                model = change;
            }
        }
        let grey = Model { grey: true, ..model.clone() };
        if self.medium.grey.value > 0.0 && fits(&grey) { grey } else { model }
    }

    /// Whether single scattering is all that a picture within `bound` needs of the medium's own light.
    pub fn single_scattering_is_enough(&self, bound: f64) -> bool {
        self.terms.multiple.may_be_left_out(bound)
    }
}

#[cfg(test)]
mod tests;
