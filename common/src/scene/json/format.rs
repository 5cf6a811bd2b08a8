//! What a JSON scene file may say; docs/scene-format.md is its manual.

use std::fmt;

use glam::Vec3;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::scene::Track;
use crate::{Lobe, Phase};

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with `version` and the scene's parts")]
pub(super) struct SceneFile {
    pub(super) version: u32,
    pub(super) name: Option<String>,
    #[serde(default)]
    pub(super) objects: Vec<ObjectEntry>,
    pub(super) lights: Option<Vec<LightEntry>>,
    pub(super) medium: Option<MediumEntry>,
    pub(super) cloud: Option<CloudEntry>,
    pub(super) sky: Option<SkyEntry>,
    pub(super) camera: Option<CameraEntry>,
    pub(super) animation: Option<Vec<Track>>,
}

/// A model file or a built-in scene, placed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct ObjectEntry {
    pub(super) file: Option<String>,
    pub(super) builtin: Option<String>,
    pub(super) triangles: Option<u32>,
    pub(super) name: Option<String>,
    pub(super) scale: Option<Triple>,
    pub(super) rotate_degrees: Option<Rotation>,
    pub(super) translate: Option<Vector>,
    pub(super) material: Option<MaterialEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct Rotation {
    pub(super) axis: Vector,
    pub(super) angle: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct MaterialEntry {
    pub(super) name: Option<String>,
    pub(super) k_d: Option<Triple>,
    pub(super) k_s: Option<Triple>,
    pub(super) exponent: Option<Number>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum LightEntry {
    Point(PointEntry),
    Spot(Box<SpotEntry>),
    Directional(DirectionalEntry),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct PointEntry {
    pub(super) position: Vector,
    pub(super) intensity: Triple,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct SpotEntry {
    pub(super) position: Vector,
    pub(super) direction: Option<Vector>,
    pub(super) target: Option<Vector>,
    pub(super) up: Option<Vector>,
    pub(super) intensity: Triple,
    pub(super) inner_angle_degrees: Option<Number>,
    pub(super) outer_angle_degrees: Number,
    pub(super) light_map: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct DirectionalEntry {
    pub(super) direction: Vector,
    pub(super) irradiance: Triple,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct MediumEntry {
    pub(super) sigma_s: Option<Triple>,
    pub(super) sigma_a: Option<Triple>,
    pub(super) sigma_t: Option<Triple>,
    pub(super) albedo: Option<Triple>,
    pub(super) phase: Option<PhaseEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct CloudEntry {
    pub(super) shape: ShapeEntry,
    pub(super) sigma_t: Number,
    pub(super) albedo: Option<Triple>,
    pub(super) phase: Option<PhaseEntry>,
    pub(super) emission: Option<Triple>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) enum ShapeEntry {
    Slab {
        low: Number,
        high: Number,
    },
    Sphere {
        centre: Vector,
        radius: Number,
    },
    TwoDensity {
        centre: Vector,
        core: Number,
        radius: Number,
        shell: Number,
    },
    Cumulus {
        base: Vector,
        size: Number,
        #[serde(default)]
        seed: u32,
    },
    Voxels {
        file: String,
    },
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SkyEntry {
    Radiance(Triple),
    Picture(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct CameraEntry {
    pub(super) eye: Vector,
    pub(super) target: Vector,
    pub(super) up: Option<Vector>,
    pub(super) fov_y_degrees: Option<Number>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum PhaseEntry {
    Isotropic,
    Rayleigh,
    HenyeyGreenstein(Asymmetry),
    CornetteShanks(Asymmetry),
    MieHazy,
    MieMurky,
    Mixture(Vec<WeightedLobe>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct Asymmetry {
    pub(super) g: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "an object with fields in braces")]
pub(super) struct WeightedLobe {
    pub(super) weight: Triple,
    pub(super) phase: Box<PhaseEntry>,
}

impl PhaseEntry {
    fn lobe(&self) -> Option<Lobe> {
        Some(match self {
            Self::Isotropic => Lobe::Isotropic,
            Self::Rayleigh => Lobe::Rayleigh,
            Self::HenyeyGreenstein(asymmetry) => Lobe::HenyeyGreenstein { g: asymmetry.g.0.into() },
            Self::CornetteShanks(asymmetry) => Lobe::CornetteShanks { g: asymmetry.g.0.into() },
            Self::MieHazy => Lobe::MieHazy,
            Self::MieMurky => Lobe::MieMurky,
            Self::Mixture(_) => return None,
        })
    }

    /// The phase function, or a clause that says why there is none.
    pub(super) fn phase(&self) -> Result<Phase, String> {
        let Self::Mixture(entries) = self else {
            return self.lobe().map(Phase::from).ok_or_else(|| "expected a phase function".into());
        };
        let mut lobes = Vec::new();
        for entry in entries {
            let Some(lobe) = entry.phase.lobe() else {
                return Err("a mixture within a mixture; expected single phase functions in it".into());
            };
            if entry.weight.0.min_element() < 0.0 {
                return Err(format!("weight {}; expected none negative", entry.weight.0));
            }
            lobes.push((entry.weight.0, lobe));
        }
        let total: Vec3 = lobes.iter().map(|(weight, _)| *weight).sum();
        if !(total.min_element() > 0.0 && total.is_finite()) {
            return Err(format!("weights that add up to {total}; expected more than 0 in each colour"));
        }
        Ok(Phase::mixture(lobes))
    }
}

/// A number that is finite in 32 bits.
#[derive(Clone, Copy)]
pub(super) struct Number(pub(super) f32);

/// Three numbers.
#[derive(Clone, Copy)]
pub(super) struct Vector(pub(super) Vec3);

/// Three numbers, or one that stands for three.
#[derive(Clone, Copy)]
pub(super) struct Triple(pub(super) Vec3);

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Numbers { one: true, three: false }).map(|v| Self(v.x))
    }
}

impl<'de> Deserialize<'de> for Vector {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Numbers { one: false, three: true }).map(Self)
    }
}

impl<'de> Deserialize<'de> for Triple {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Numbers { one: true, three: true }).map(Self)
    }
}

/// Reads one number, three, or either.
struct Numbers {
    one: bool,
    three: bool,
}

impl Numbers {
    fn single<E: Error>(&self, value: f64) -> Result<Vec3, E> {
        let number = value as f32;
        if !self.one {
            return Err(E::invalid_type(serde::de::Unexpected::Float(value), self));
        }
        if !number.is_finite() {
            return Err(E::custom(format!("{value:e} is too large; expected a number below 3.4e38")));
        }
        Ok(Vec3::splat(number))
    }
}

impl<'de> Visitor<'de> for Numbers {
    type Value = Vec3;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match (self.one, self.three) {
            (true, false) => "a number",
            (false, _) => "three numbers like [1, 2, 3]",
            (true, true) => "a number or three like [1, 2, 3]",
        })
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Vec3, E> {
        self.single(value)
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Vec3, E> {
        self.single(value as f64)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Vec3, E> {
        self.single(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec3, A::Error> {
        if !self.three {
            return Err(A::Error::invalid_type(serde::de::Unexpected::Seq, &self));
        }
        let mut numbers = [0.0; 3];
        for (index, number) in numbers.iter_mut().enumerate() {
            let next: Option<Number> = list.next_element()?;
            *number = next.ok_or_else(|| A::Error::invalid_length(index, &self))?.0;
        }
        match list.next_element::<serde::de::IgnoredAny>()? {
            None => Ok(Vec3::from_array(numbers)),
            Some(_) => Err(A::Error::invalid_length(4, &self)),
        }
    }
}
