//! The sky: light that comes from all around, from infinitely far away.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Vec2, Vec3};

use crate::LightMap;

/// Radiance from all around. It lights clouds; homogeneous media, which have no outside, don't see it.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Sky {
    /// None.
    #[default]
    Black,
    /// The same from everywhere, RGB \[W m⁻² sr⁻¹\].
    Constant(Vec3),
    /// A picture of longitude and latitude (equirectangular): its middle is seen towards −z, the right edge of its
    /// middle row towards +z by way of +x, the upper row towards +y.
    Picture(Arc<LightMap>),
}

impl Sky {
    /// Radiance seen in a unit direction, RGB \[W m⁻² sr⁻¹\].
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        match self {
            Self::Black => Vec3::ZERO,
            Self::Constant(radiance) => *radiance,
            Self::Picture(picture) => {
                let u = 0.5 + direction.x.atan2(-direction.z) / (2.0 * PI);
                let v = direction.y.clamp(-1.0, 1.0).acos() / PI;
                picture.sample(Vec2::new(u, v))
            }
        }
    }

    /// Whether there is no light in it.
    pub fn is_black(&self) -> bool {
        match self {
            Self::Black => true,
            Self::Constant(radiance) => *radiance == Vec3::ZERO,
            Self::Picture(picture) => picture.texels.iter().all(|texel| *texel == Vec3::ZERO),
        }
    }

    /// What is wrong with this sky, if anything: one clause, to be put behind its name.
    pub fn problem(&self) -> Option<String> {
        let bad = |radiance: &Vec3| !(radiance.is_finite() && radiance.cmpge(Vec3::ZERO).all());
        match self {
            Self::Black => None,
            Self::Constant(radiance) => bad(radiance).then(|| {
                format!("has a radiance of {radiance}; expected three finite numbers, none negative")
            }),
            Self::Picture(picture) => {
                let LightMap { width, height, texels } = picture.as_ref();
                if texels.is_empty() || texels.len() as u64 != u64::from(*width) * u64::from(*height) {
                    return Some(format!(
                        "is a picture of {width}×{height} pixels with {} values",
                        texels.len()
                    ));
                }
                let texel = texels.iter().find(|texel| bad(texel))?;
                Some(format!("has a pixel of {texel}; expected three finite numbers, none negative"))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_lies_as_it_is_said() {
        // Left to right: behind, left, ahead, right; brighter above.
        let texels = |row: f32| [1.0, 2.0, 3.0, 4.0].map(|x| Vec3::splat(row * x));
        let texels = [texels(10.0), texels(1.0)].concat();
        let sky = Sky::Picture(Arc::new(LightMap { width: 4, height: 2, texels }));
        let seen = |direction: Vec3| sky.radiance(direction.normalize()).x;
        // Texel centres are half-way between the axes.
        assert!((seen(Vec3::new(0.5, -0.7, -0.5)) - 3.0).abs() < 0.2);
        assert!((seen(Vec3::new(-0.5, -0.7, -0.5)) - 2.0).abs() < 0.2);
        assert!((seen(Vec3::new(0.5, -0.7, 0.5)) - 4.0).abs() < 0.2);
        assert!((seen(Vec3::new(0.5, 0.9, -0.5)) - 30.0).abs() < 2.0);
        assert_eq!(sky.problem(), None);
        assert!(!sky.is_black() && Sky::default().is_black());
    }

    #[test]
    fn problems_are_named() {
        assert!(Sky::Constant(Vec3::NAN).problem().is_some());
        assert!(
            Sky::Picture(Arc::new(LightMap { width: 2, height: 1, texels: vec![Vec3::ONE] }))
                .problem()
                .is_some()
        );
    }
}
