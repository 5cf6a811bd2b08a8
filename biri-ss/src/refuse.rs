//! What the technique can't model: named, never drawn wrongly.

use common::Light;

use crate::{Airlight, Error, Inputs, Options};

/// Narrowest cone \[rad\]: half an angle whose cosine is still told from 1.
const NARROWEST: f32 = 3e-3;

/// An error for what would be drawn wrongly.
pub(crate) fn refuse(inputs: &Inputs<'_>, options: &Options, indirect: bool) -> Result<(), Error> {
    let unsupported = |what, index, why: String| Err(Error::Unsupported { what, index, why });
    for (index, light) in inputs.lights.iter().enumerate() {
        if let Some(problem) = light.problem() {
            return unsupported("light", index, format!("it {problem}"));
        }
        let Light::Spot(spot) = light else { continue };
        let why = if spot.outer_angle < NARROWEST {
            "its cone is narrower than 0.17° to either side, which cosines in 32 bits do not resolve; widen it"
        } else if spot.light_map.is_some() {
            "it carries a light map, which an integral from the eye can't resolve; take the map away"
        } else if matches!(options.airlight, Airlight::Gamma { .. }) && spot.inner_angle < spot.outer_angle {
            "its edge is soft, which a table of constant intensity does not hold; use Airlight::GammaRest or \
             make inner_angle equal outer_angle"
        } else if indirect {
            "indirect light is tabulated for lights that shine into all directions, and a spot does not; leave \
             the indirect light out"
        } else {
            continue;
        };
        return unsupported("light", index, why.into());
    }
    if let Some(problem) = inputs.medium.problem() {
        return unsupported("medium", 0, format!("it {problem}"));
    }
    if let Some(problem) = inputs.view.camera.problem() {
        return unsupported("view", 0, format!("its camera {problem}"));
    }
    if !inputs.ambient.is_finite() || inputs.ambient.min_element() < 0.0 {
        return unsupported("ambient radiance", 0, format!("it is {}", inputs.ambient));
    }
    if inputs.ambient != glam::Vec3::ZERO && inputs.lights.is_empty() {
        return unsupported("ambient radiance", 0, "there is no light that it could stem from".into());
    }
    for (index, object) in inputs.casters.iter().enumerate() {
        let place = object.world_from_object;
        let determinant = place.matrix3.determinant();
        if !place.is_finite() || determinant == 0.0 || !determinant.recip().is_finite() {
            return unsupported("caster", index, "its placement has no inverse; give it a volume".into());
        }
    }
    Ok(())
}
