//! Light sources: point (omni), spot (cone, optional light map) and directional.

use std::sync::Arc;

use glam::{Vec2, Vec3};

/// A light source.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// Radiates alike into all directions from a point.
    Point(PointLight),
    /// Radiates into a cone from a point.
    Spot(SpotLight),
    /// Parallel light from infinitely far away.
    Directional(DirectionalLight),
}

/// A point that radiates alike into all directions.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLight {
    /// Position \[m\].
    pub position: Vec3,
    /// Radiant intensity, RGB \[W/sr\], 0 to [`Light::MAX_STRENGTH`].
    pub intensity: Vec3,
}

/// A point that radiates into a cone.
///
/// Inside `inner_angle` the intensity is whole; between the two it falls as the square of a ramp
/// that is linear in the cosine (the glTF extension `KHR_lights_punctual`); outside it is zero.
#[derive(Clone, Debug, PartialEq)]
pub struct SpotLight {
    /// Position of the apex \[m\].
    pub position: Vec3,
    /// Axis of the cone, the way the light travels; unit length.
    pub direction: Vec3,
    /// Which way is up in the light map; not parallel to `direction`.
    pub up: Vec3,
    /// Radiant intensity on the axis, RGB \[W/sr\], 0 to [`Light::MAX_STRENGTH`].
    pub intensity: Vec3,
    /// Half angle of the cone of whole intensity \[rad\], 0 ≤ inner ≤ outer.
    pub inner_angle: f32,
    /// Half angle of the cone \[rad\], 0 < outer ≤ [`SpotLight::MAX_ANGLE`].
    pub outer_angle: f32,
    /// A picture that tints the intensity over the square that bounds the cone, if any.
    pub light_map: Option<Arc<LightMap>>,
}

/// Parallel light.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionalLight {
    /// The way the light travels; unit length.
    pub direction: Vec3,
    /// Irradiance on a facing plane, RGB \[W/m²\], 0 to [`Light::MAX_STRENGTH`]. It is what arrives: the way from the source into
    /// the scene is not attenuated, because in an endless medium nothing would be left of it.
    pub irradiance: Vec3,
}

/// A picture that tints a spot's intensity: linear RGB, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct LightMap {
    /// Width \[texels\], at least 1.
    pub width: u32,
    /// Height \[texels\], at least 1.
    pub height: u32,
    /// Row by row, `width` × `height` of them, linear RGB, not negative.
    pub texels: Vec<Vec3>,
}

impl LightMap {
    /// Bilinear look-up with texel centres carrying the samples; `uv` in [0, 1]², clamped.
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        let size = Vec2::new(self.width as f32, self.height as f32);
        let at = (uv * size - 0.5).clamp(Vec2::ZERO, size - 1.0);
        let low = at.floor();
        let fraction = at - low;
        let texel = |x: u32, y: u32| {
            self.texels[(y.min(self.height - 1) * self.width + x.min(self.width - 1)) as usize]
        };
        let (x, y) = (low.x as u32, low.y as u32);
        let top = texel(x, y).lerp(texel(x + 1, y), fraction.x);
        let bottom = texel(x, y + 1).lerp(texel(x + 1, y + 1), fraction.x);
        top.lerp(bottom, fraction.y)
    }
}

impl SpotLight {
    /// Widest half angle of a cone \[rad\]: a shadow map of one projection can't show a half space.
    pub const MAX_ANGLE: f32 = 85.0 * std::f32::consts::PI / 180.0;

    /// Unit vectors right and up of the light map, seen from the apex.
    pub fn basis(&self) -> (Vec3, Vec3) {
        let right = self.direction.cross(self.up).normalize();
        (right, right.cross(self.direction))
    }

    /// Fraction of the axis intensity at `cos_angle` from the axis, in [0, 1].
    pub fn falloff(&self, cos_angle: f32) -> f32 {
        let (inner, outer) = (self.inner_angle.cos(), self.outer_angle.cos());
        if cos_angle < outer {
            return 0.0;
        }
        let ramp = ((cos_angle - outer) / (inner - outer).max(1e-6)).clamp(0.0, 1.0);
        if inner - outer < 1e-6 { 1.0 } else { ramp * ramp }
    }

    /// Radiant intensity towards the unit vector `direction`, RGB \[W/sr\].
    pub fn intensity_towards(&self, direction: Vec3) -> Vec3 {
        let cos_angle = self.direction.dot(direction);
        let falloff = self.falloff(cos_angle);
        if falloff == 0.0 {
            return Vec3::ZERO;
        }
        self.intensity * falloff * self.tint(direction)
    }

    /// The light map's colour towards the unit vector `direction`, or 1 without one.
    pub fn tint(&self, direction: Vec3) -> Vec3 {
        let Some(map) = &self.light_map else {
            return Vec3::ONE;
        };
        let (right, up) = self.basis();
        let along = self.direction.dot(direction).max(1e-6);
        let plane = Vec2::new(right.dot(direction), -up.dot(direction)) / (along * self.outer_angle.tan());
        map.sample(plane * 0.5 + 0.5)
    }
}

impl Light {
    /// Greatest intensity \[W/sr\] or irradiance \[W/m²\]; the sun has 3e25 W/sr. Sums and squares of what is
    /// brighter overflow in shaders, where pictures become flat or black.
    pub const MAX_STRENGTH: f32 = 1e30;

    /// `"point"`, `"spot"` or `"directional"`.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Point(_) => "point",
            Self::Spot(_) => "spot",
            Self::Directional(_) => "directional",
        }
    }

    /// Intensity, RGB \[W/sr\] or, for a directional light, irradiance \[W/m²\].
    pub fn strength(&self) -> Vec3 {
        match self {
            Self::Point(light) => light.intensity,
            Self::Spot(light) => light.intensity,
            Self::Directional(light) => light.irradiance,
        }
    }

    /// Where it is \[m\]; `None` for a directional light.
    pub fn position(&self) -> Option<Vec3> {
        match self {
            Self::Point(light) => Some(light.position),
            Self::Spot(light) => Some(light.position),
            Self::Directional(_) => None,
        }
    }

    /// What is wrong with this light, if anything: one clause, to be put behind its name.
    pub fn problem(&self) -> Option<String> {
        let strength = self.strength();
        if !strength.is_finite() || strength.min_element() < 0.0 {
            return Some(format!("has strength {strength}; expected three finite numbers, none negative"));
        }
        if strength.max_element() > Self::MAX_STRENGTH {
            return Some(format!(
                "has a strength of {:e} {}; expected at most {:e}, for 32-bit floats to hold its light",
                strength.max_element(),
                if self.position().is_some() { "W/sr" } else { "W/m²" },
                Self::MAX_STRENGTH
            ));
        }
        if self.position().is_some_and(|position| !position.is_finite()) {
            return Some("has a position that is not a finite number".into());
        }
        let unit = |direction: Vec3| (direction.length() - 1.0).abs() < 1e-3;
        match self {
            Self::Point(_) => None,
            Self::Directional(light) => {
                (!unit(light.direction)).then(|| "has a direction that is not of unit length".into())
            }
            Self::Spot(light) => {
                if !unit(light.direction) {
                    return Some("has a direction that is not of unit length".into());
                }
                if light.direction.cross(light.up.normalize_or_zero()).length() < 1e-4 {
                    return Some("has an `up` that is zero or parallel to its direction".into());
                }
                let (inner, outer) = (light.inner_angle, light.outer_angle);
                if !(inner >= 0.0 && inner <= outer && outer > 0.0 && outer <= SpotLight::MAX_ANGLE + 1e-6) {
                    return Some(format!(
                        "has half angles inner {:.1}°, outer {:.1}°; expected 0 ≤ inner ≤ outer ≤ 85°",
                        inner.to_degrees(),
                        outer.to_degrees()
                    ));
                }
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_bright_a_light_is_refused_with_the_bound() {
        let point = |intensity| Light::Point(PointLight { position: Vec3::ZERO, intensity });
        let sun = |irradiance| Light::Directional(DirectionalLight { direction: Vec3::NEG_Y, irradiance });
        assert_eq!(point(Vec3::splat(1e30)).problem(), None);
        for (light, unit) in [(point(Vec3::new(1.0, 2e30, 0.0)), "W/sr"), (sun(Vec3::splat(1e38)), "W/m²")] {
            let problem = light.problem().expect("too bright");
            assert!(problem.contains("at most 1e30") && problem.contains(unit), "{problem}");
        }
        assert!(point(Vec3::splat(f32::INFINITY)).problem().expect("infinite").contains("finite"));
    }
}
