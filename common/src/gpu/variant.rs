//! Kinds of light and medium that pipelines are made for, one pipeline per kind: where a processor executes all
//! branches of a shader, those of the other kinds would cost as much as the one that is wanted. And a driver that
//! compiles a shader anew for the values of a uniform that decides much of it (Mesa's lavapipe) finds none.

use super::haze::Haze;
use crate::{Light, Medium};

/// Values of the overrides in [`crate::shader::KIND`] and [`crate::shader::HAZE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    kind: u32,
    has_map: bool,
    has_ramp: bool,
    haze: Haze,
}

impl Variant {
    /// What `light` in `medium` needs.
    pub fn new(light: &Light, medium: &Medium) -> Self {
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
    pub fn constants(&self) -> Vec<(&'static str, f64)> {
        let [map, ramp] = [self.has_map, self.has_ramp].map(|has| u8::from(has).into());
        let mut constants = self.haze.constants();
        constants.extend([("KIND", self.kind.into()), ("HAS_MAP", map), ("HAS_RAMP", ramp)]);
        constants
    }
}
