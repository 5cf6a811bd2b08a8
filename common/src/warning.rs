//! What works, but not well.

use std::fmt;

use crate::{Light, Medium, View};

/// A parameter outside of the range in which a technique was measured to be right. The frame is drawn all the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// Which parameter, with its unit.
    pub parameter: &'static str,
    /// Its value.
    pub value: f64,
    /// The bound that it is beyond.
    pub bound: f64,
    /// What goes wrong, and what to do.
    pub advice: &'static str,
}

impl fmt::Display for Warning {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { parameter, value, bound, advice } = self;
        write!(out, "{parameter} is {}, beyond {}: {advice}", short(*value), short(*bound))
    }
}

/// Three digits.
fn short(value: f64) -> String {
    if value == 0.0 || (1e-2..1e5).contains(&value.abs()) {
        let places = if value.abs() >= 100.0 { 0 } else { 2 };
        let text = format!("{value:.places$}");
        return if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').into()
        } else {
            text
        };
    }
    format!("{value:.1e}")
}

impl Warning {
    /// Distance of the eye from the origin over that to what it looks at, up to which 32-bit positions hold.
    pub const FARTHEST: f64 = 5e3;

    /// Whatever the technique: positions are 32-bit floats in the world, 24 bits from the origin to the eye.
    pub fn far_from_the_origin(view: &View) -> Option<Self> {
        let camera = &view.camera;
        let (from_origin, to_target) = (camera.eye.as_dvec3().length(), camera.eye.distance(camera.target));
        let value = from_origin / f64::from(to_target);
        (value > Self::FARTHEST).then_some(Self {
            parameter: "the eye's distance from the origin over its distance from what it looks at",
            value,
            bound: Self::FARTHEST,
            advice: "positions of 32 bits are too coarse there; move the origin near the eye",
        })
    }

    /// So dense a medium between the eye and all lights that light is lost in the differences of what is left of it: optical
    /// depth to the nearest light beyond `bound`.
    pub fn opaque<'a>(
        medium: &Medium,
        view: &View,
        lights: impl IntoIterator<Item = &'a Light>,
        bound: f64,
    ) -> Option<Self> {
        let eye = view.camera.eye;
        let nearest =
            lights.into_iter().filter_map(Light::position).map(|at| at.distance(eye)).reduce(f32::min)?;
        let value = f64::from(nearest) * f64::from(medium.sigma_t().min_element());
        (value > bound).then_some(Self {
            parameter: "the optical depth from the eye to the nearest light",
            value,
            bound,
            advice: "what light is left is lost in rounding; there is next to nothing to see",
        })
    }

    /// A peak of the phase function that is narrower than a technique resolves: mean cosine beyond ±`bound`, where a light has
    /// a place.
    pub fn peak<'a>(
        medium: &Medium,
        lights: impl IntoIterator<Item = &'a Light>,
        bound: f64,
    ) -> Option<Self> {
        let peaks = medium.phase.lobes.iter().map(|(_, lobe)| lobe.mean_cosine());
        let value = peaks.fold(0.0, |most: f64, g| if g.abs() > most.abs() { g } else { most });
        let placed = lights.into_iter().any(|light| light.position().is_some());
        (placed && value.abs() > bound).then_some(Self {
            parameter: "the mean cosine of the phase function's most peaked lobe",
            value,
            bound: bound.copysign(value),
            advice: "its peak falls between samples; take a wider one, or a technique that integrates it",
        })
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::{Camera, Lobe, PointLight};

    #[test]
    fn what_is_far_from_the_origin_is_told_with_its_bound() {
        let view = |shift: f32| {
            let eye = Vec3::new(shift, 0.0, 5.0);
            Camera { eye, target: Vec3::new(shift, 0.0, 0.0), ..Camera::default() }.view(4, 4)
        };
        assert_eq!(Warning::far_from_the_origin(&view(1e4)), None);
        let warning = Warning::far_from_the_origin(&view(1e6)).unwrap();
        let text = warning.to_string();
        assert!(
            text.contains("2.0e5") && text.contains("beyond 5000") && text.contains("move the origin"),
            "{text}"
        );
    }

    #[test]
    fn fog_between_eye_and_lights_is_told_of_the_nearest_light() {
        let lamp =
            |x: f32| Light::Point(PointLight { position: Vec3::new(x, 0.0, 0.0), intensity: Vec3::ONE });
        let view = Camera { eye: Vec3::ZERO, target: Vec3::X, ..Camera::default() }.view(4, 4);
        let medium = Medium::grey(10.0, 0.9, crate::Phase::isotropic());
        let told =
            |lights: &[Light]| Warning::opaque(&medium, &view, lights, 40.0).map(|warning| warning.value);
        assert_eq!(told(&[lamp(9.0), lamp(5.0)]), Some(50.0));
        assert_eq!(told(&[lamp(9.0), lamp(3.0)]), None);
        assert_eq!(told(&[]), None);
    }

    #[test]
    fn a_peak_is_told_where_a_light_has_a_place() {
        let medium = |g| Medium::grey(0.1, 0.9, Lobe::HenyeyGreenstein { g }.into());
        let lamp = Light::Point(PointLight { position: Vec3::ONE, intensity: Vec3::ONE });
        let told = |g, lights: &[Light]| Warning::peak(&medium(g), lights, 0.9);
        assert_eq!(told(0.85, std::slice::from_ref(&lamp)), None);
        assert_eq!(told(-0.95, &[]), None);
        let warning = told(-0.95, &[lamp]).unwrap();
        assert!((warning.value + 0.95).abs() < 1e-9 && (warning.bound + 0.9).abs() < 1e-9, "{warning}");
    }
}
