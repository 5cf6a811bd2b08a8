//! What of a scene's fog is drawn.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::{Lobe, Medium, Phase, Scene};

/// What is drawn of a light's airlight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shaft {
    /// Nothing. The light goes on lighting surfaces.
    Off,
    /// All of it, as if nothing threw a shadow into the air: one full-screen pass does it.
    Unshadowed,
    /// All of it, with its shadows.
    #[default]
    Shadowed,
}

/// What is taken for the medium's phase function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PhaseModel {
    /// Itself.
    #[default]
    Own,
    /// One Henyey-Greenstein lobe of the same mean cosine.
    HenyeyGreenstein,
    /// The same into all directions.
    Isotropic,
}

/// How much of a scene's fog is drawn: plain data, to be applied to any frame of the scene.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Model {
    /// Of each light, in the scene's order; those that are not named are [`Shaft::Shadowed`].
    pub lights: Vec<Shaft>,
    /// Take the medium's coefficients for the mean of their three colours: one transmittance instead of three.
    pub grey: bool,
    /// What is taken for the phase function.
    pub phase: PhaseModel,
}

impl Model {
    /// Everything, as the scene has it.
    pub fn full(scene: &Scene) -> Self {
        Self { lights: vec![Shaft::Shadowed; scene.lights.len()], ..Self::default() }
    }

    /// Whether it leaves nothing out.
    pub fn is_full(&self) -> bool {
        !self.grey
            && self.phase == PhaseModel::Own
            && self.lights.iter().all(|light| *light == Shaft::Shadowed)
    }

    /// What is drawn of light `index`.
    pub fn shaft(&self, index: usize) -> Shaft {
        self.lights.get(index).copied().unwrap_or_default()
    }

    /// Those of `lights`, which are in the scene's order, of which `shaft` is drawn.
    pub fn of<'a, L>(&'a self, lights: &'a [L], shaft: Shaft) -> impl Iterator<Item = &'a L> {
        lights
            .iter()
            .enumerate()
            .filter(move |(index, _)| self.shaft(*index) == shaft)
            .map(|(_, light)| light)
    }

    /// Whether any light's `shaft` of so many is drawn.
    pub fn has(&self, lights: usize, shaft: Shaft) -> bool {
        (0..lights).any(|index| self.shaft(index) == shaft)
    }

    /// The medium that is drawn in place of `medium`.
    pub fn medium(&self, medium: &Medium) -> Medium {
        let mean = |colour: Vec3| if self.grey { Vec3::splat(colour.element_sum() / 3.0) } else { colour };
        let phase = match self.phase {
            PhaseModel::Own => medium.phase.clone(),
            PhaseModel::Isotropic => Phase::isotropic(),
            PhaseModel::HenyeyGreenstein => {
                let of = |(weight, lobe): &(Vec3, Lobe)| {
                    f64::from(weight.element_sum()) / 3.0 * lobe.mean_cosine()
                };
                let g = medium.phase.lobes.iter().map(of).sum::<f64>().clamp(-0.99, 0.99);
                Lobe::HenyeyGreenstein { g }.into()
            }
        };
        Medium { sigma_s: mean(medium.sigma_s), sigma_a: mean(medium.sigma_a), phase }
    }

    /// What is wrong with this model for a scene of so many lights, if anything: one clause.
    pub fn problem(&self, lights: usize) -> Option<String> {
        (self.lights.len() > lights)
            .then(|| format!("says what to do with {} lights, and the scene has {lights}", self.lights.len()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_that_are_not_named_are_drawn_whole() {
        let model = Model { lights: vec![Shaft::Off, Shaft::Unshadowed], ..Model::default() };
        let lights = ["a", "b", "c"];
        assert_eq!(model.of(&lights, Shaft::Shadowed).collect::<Vec<_>>(), [&"c"]);
        assert_eq!(model.of(&lights, Shaft::Unshadowed).collect::<Vec<_>>(), [&"b"]);
        assert!(model.has(3, Shaft::Shadowed) && !model.has(2, Shaft::Shadowed));
        assert!(!model.is_full() && Model::default().is_full());
        assert!(model.problem(1).unwrap().contains("2 lights"));
        assert_eq!(model.problem(2), None);
    }

    #[test]
    fn a_simpler_medium_keeps_the_means() {
        let lobes = vec![
            (Vec3::new(0.2, 0.4, 0.9), Lobe::Rayleigh),
            (Vec3::new(0.8, 0.6, 0.1), Lobe::HenyeyGreenstein { g: 0.8 }),
        ];
        let medium = Medium {
            sigma_s: Vec3::new(0.1, 0.2, 0.3),
            sigma_a: Vec3::new(0.0, 0.0, 0.3),
            phase: Phase::mixture(lobes),
        };
        let simple =
            Model { grey: true, phase: PhaseModel::HenyeyGreenstein, ..Model::default() }.medium(&medium);
        assert!(simple.is_grey());
        assert!((simple.sigma_s - 0.2).abs().max_element() < 1e-6);
        assert!((simple.sigma_a - 0.1).abs().max_element() < 1e-6);
        let Some(Lobe::HenyeyGreenstein { g }) = simple.phase.single() else { panic!("{simple:?}") };
        assert!((g - 0.4).abs() < 1e-6);
        assert_eq!(Model::default().medium(&medium), medium);
    }

    #[test]
    fn a_model_is_read_back_as_written() {
        let model =
            Model { lights: vec![Shaft::Off, Shaft::Shadowed], grey: true, phase: PhaseModel::Isotropic };
        let text = serde_json::to_string(&model).unwrap();
        assert_eq!(text, r#"{"lights":["off","shadowed"],"grey":true,"phase":"isotropic"}"#);
        assert_eq!(serde_json::from_str::<Model>(&text).unwrap(), model);
        assert_eq!(serde_json::from_str::<Model>("{}").unwrap(), Model::default());
        assert!(serde_json::from_str::<Model>(r#"{"gray":true}"#).is_err());
    }
}
