//! Kinds of light and medium that pipelines are made for, one pipeline per kind: where a processor executes all
//! branches of a shader, those of the other kinds would cost as much as the one that is wanted.

use std::collections::HashMap;

use common::gpu::Haze;
use common::{Light, Medium};

/// Names and values of overrides.
pub(super) type Constants = Vec<(&'static str, f64)>;

/// Values of the overrides in the shared haze and `light.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Variant {
    kind: u32,
    has_map: bool,
    has_ramp: bool,
    haze: Haze,
}

impl Variant {
    /// What `light` in `medium` needs.
    fn new(light: &Light, medium: &Medium) -> Self {
        let (kind, has_map, has_ramp) = match light {
            Light::Point(_) => (0, false, false),
            Light::Spot(spot) => {
                let ramp = spot.inner_angle.cos() - spot.outer_angle.cos() > 1e-6;
                (1, spot.light_map.is_some(), ramp)
            }
            Light::Directional(_) => (2, false, false),
        };
        Self { kind, has_map, has_ramp, haze: Haze::new(medium) }
    }

    /// Names and values of the overrides.
    fn constants(&self) -> Constants {
        let mut constants = self.haze.constants();
        constants.push(("KIND", self.kind.into()));
        constants.push(("HAS_MAP", u8::from(self.has_map).into()));
        constants.push(("HAS_RAMP", u8::from(self.has_ramp).into()));
        constants
    }
}

/// Pipelines by what they are made for.
pub(super) struct Pipelines<P>(HashMap<Variant, P>);

impl<P: Clone> Pipelines<P> {
    pub(super) fn new() -> Self {
        Self(HashMap::new())
    }

    /// The pipeline of a light, made where there is none yet.
    pub(super) fn of(&mut self, light: &Light, medium: &Medium, make: impl FnOnce(Constants) -> P) -> P {
        let variant = Variant::new(light, medium);
        self.0.entry(variant).or_insert_with(|| make(variant.constants())).clone()
    }
}
