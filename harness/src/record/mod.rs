//! One record per measurement. Every name and unit: `results/README.md`.

mod file;

use std::collections::BTreeMap;

use clap::ValueEnum;
use common::image::Image;
use serde::{Deserialize, Deserializer, Serialize};

use crate::machine::Machine;
pub(crate) use file::{RECORDS, Writer, read_stopped, read_tolerant, write_csv, write_records};

/// Version of the record's names and meanings.
pub(crate) const SCHEMA: u32 = 2;

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    pub schema: u32,
    /// Which question it is part of.
    pub study: Study,
    pub date: String,
    pub commit: String,
    pub machine: Machine,
    pub adapter: String,
    pub driver: String,
    pub software: bool,
    pub scene: String,
    pub triangles: usize,
    pub lights: usize,
    pub light_kinds: Vec<String>,
    pub name: String,
    pub technique: String,
    /// Whether it is what a user would otherwise pick, and not one of the techniques.
    pub peer: bool,
    pub preset: String,
    pub label: String,
    pub settings: serde_json::Map<String, serde_json::Value>,
    pub terms: Vec<String>,
    pub width: u32,
    pub height: u32,
    pub frames: usize,
    pub warm_up: usize,
    pub moving: String,
    pub technique_ms: Spread,
    pub technique_ms_from: String,
    pub technique_wall_ms: Spread,
    pub passes: BTreeMap<String, Spread>,
    pub ground_passes: BTreeMap<String, Spread>,
    pub cpu_ms: Spread,
    pub frame_ms: Spread,
    pub samples_ms: Samples,
    /// Memory on the device that the technique took for itself \[bytes\]; none where the device does not say.
    pub gpu_bytes: Option<u64>,
    /// Silhouette edges of the scene, all lights together, where they were counted.
    pub silhouette_edges: Option<u64>,
    pub error: Errors,
    /// Errors against all terms of light in the medium, where they are known.
    pub model_error: Option<ModelError>,
    /// Largest `error.rel_rmse` that counts as right; beyond it the run fails.
    pub bound: Option<f64>,
    /// What the technique can't draw in this scene, if it refused: then times and errors are none.
    pub refused: Option<String>,
    pub reference: ReferenceNote,
    pub pictures: Pictures,
    pub notes: Vec<String>,
}

/// What a measurement is taken for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Study {
    /// Error against time: every technique in many settings.
    Main,
    /// The paper's setting with one improvement each.
    Improvements,
    /// Time against triangles.
    Triangles,
    /// Time against the number of lights.
    Lights,
    /// Time against the number of pixels.
    Resolution,
    /// Time against the size of shadow maps.
    ShadowMap,
    /// Time against silhouette edges.
    Edges,
}

/// Which measurement it is.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Key {
    pub study: Study,
    pub scene: String,
    pub triangles: usize,
    pub lights: usize,
    pub name: String,
    pub width: u32,
    pub height: u32,
    pub shadow_map_size: Option<u64>,
}

/// What a technique misses of the light that the medium sends to the eye because its model is too small, its own
/// errors included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ModelError {
    pub terms: Vec<String>,
    #[serde(deserialize_with = "number")]
    pub rel_rmse: f64,
    #[serde(deserialize_with = "number")]
    pub bias: f64,
    /// What noise of the paths is left in `rel_rmse`, relative RMS.
    #[serde(deserialize_with = "number")]
    pub noise: f64,
}

/// A distribution of times \[ms\].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Spread {
    pub p50: f64,
    pub p95: f64,
    pub max: f64,
}

/// Every measured time \[ms\], frame by frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Samples {
    pub technique: Vec<f64>,
    pub technique_wall: Vec<f64>,
    pub cpu: Vec<f64>,
    pub frame: Vec<f64>,
}

/// Errors of the picture at time 0 against the reference of the same terms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Errors {
    #[serde(deserialize_with = "number")]
    pub rel_rmse: f64,
    #[serde(deserialize_with = "number")]
    pub bias: f64,
    #[serde(deserialize_with = "number")]
    pub p99: f64,
    #[serde(deserialize_with = "number")]
    pub max: f64,
    #[serde(deserialize_with = "number")]
    pub worst_tile: f64,
    #[serde(deserialize_with = "number")]
    pub leak: f64,
    #[serde(deserialize_with = "number")]
    pub flip: f64,
    pub nan: u32,
    pub inf: u32,
    pub negative: u32,
    #[serde(deserialize_with = "number")]
    pub energy_ratio: f64,
}

/// What the picture was held against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ReferenceNote {
    pub terms: Vec<String>,
    #[serde(deserialize_with = "number")]
    pub uncertainty: f64,
    pub seconds: f64,
    pub cached: bool,
    /// Pixels where the depth buffer ends the ray at another surface than the ray itself, so that the airlight was drawn
    /// again up to there.
    #[serde(default)]
    pub other_surface: usize,
}

/// Pictures of a measurement, relative to the run's folder.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pictures {
    pub picture: String,
    pub airlight_exr: String,
    pub error_map: String,
    pub reference: String,
    pub reference_airlight_exr: String,
    pub exposure: f32,
}

impl ReferenceNote {
    /// Where nothing was held against a reference.
    pub(crate) const fn none() -> Self {
        Self { terms: Vec::new(), uncertainty: 0.0, seconds: 0.0, cached: false, other_surface: 0 }
    }
}

impl Errors {
    /// Of a picture that is held against nothing: what is not a number of light.
    pub(crate) fn counted(image: &Image) -> Self {
        let count = |is: fn(f32) -> bool| {
            image.pixels.iter().filter(|pixel| pixel.to_array().into_iter().any(is)).count() as u32
        };
        Self {
            nan: count(f32::is_nan),
            inf: count(f32::is_infinite),
            negative: count(|x| x < 0.0),
            ..Self::NONE
        }
    }

    /// Of no picture.
    pub(crate) const NONE: Self = Self {
        rel_rmse: f64::NAN,
        bias: f64::NAN,
        p99: f64::NAN,
        max: f64::NAN,
        worst_tile: f64::NAN,
        leak: f64::NAN,
        flip: f64::NAN,
        nan: 0,
        inf: 0,
        negative: 0,
        energy_ratio: f64::NAN,
    };
}

/// JSON has no NaN and no infinity: they are written as null and come back as NaN.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl Spread {
    /// Of times in any order; zero of none.
    pub(crate) fn of(times: &[f64]) -> Self {
        let mut sorted = times.to_vec();
        sorted.sort_by(f64::total_cmp);
        let Some(&max) = sorted.last() else { return Self::default() };
        // Nearest rank: the smallest time that at least this share of all times does not exceed.
        let rank = |share: f64| sorted[((share * sorted.len() as f64).ceil() as usize).max(1) - 1];
        let half = sorted.len() / 2;
        let p50 = 0.5 * (sorted[half] + sorted[(sorted.len() - 1) / 2]);
        Self { p50, p95: rank(0.95), max }
    }
}

impl Study {
    /// As records spell it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Main => "main",
            Self::Improvements => "improvements",
            Self::Triangles => "triangles",
            Self::Lights => "lights",
            Self::Resolution => "resolution",
            Self::ShadowMap => "shadow-map",
            Self::Edges => "edges",
        }
    }
}

impl Record {
    /// Texels on a side of its shadow maps.
    pub(crate) fn shadow_map_size(&self) -> Option<u64> {
        self.settings.get("shadow_map_size")?.as_u64()
    }

    /// Median time of what every technique needs: shadow maps, depth, surfaces \[ms\].
    pub(crate) fn ground_ms(&self) -> f64 {
        self.ground_passes.values().map(|pass| pass.p50).sum()
    }

    /// Which measurement it is: another one with this key, on the same adapter, is the same measurement again.
    pub(crate) fn key(&self) -> Key {
        Key {
            study: self.study,
            scene: self.scene.clone(),
            triangles: self.triangles,
            lights: self.lights,
            name: self.name.clone(),
            width: self.width,
            height: self.height,
            shadow_map_size: self.shadow_map_size(),
        }
    }

    /// What is wrong with the picture, if anything: then the run has failed.
    pub(crate) fn problem(&self) -> Option<String> {
        if self.refused.is_some() {
            return None;
        }
        let Errors { nan, inf, negative, rel_rmse, .. } = self.error;
        if nan + inf + negative > 0 {
            return Some(format!("{nan} NaN, {inf} infinite and {negative} negative pixels"));
        }
        let bound = self.bound?;
        (rel_rmse.is_nan() || rel_rmse > bound)
            .then(|| format!("relative RMSE {rel_rmse:.4} above the bound {bound}"))
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A record of a right picture.
    pub(crate) fn example(name: &str, milliseconds: f64, rel_rmse: f64) -> Record {
        let spread = Spread { p50: milliseconds, p95: milliseconds, max: milliseconds };
        Record {
            schema: SCHEMA,
            study: Study::Main,
            date: "2025-01-31T12:00:00Z".into(),
            commit: "0123456789ab".into(),
            machine: Machine { cpu: "a <fast> one".into(), cores: 2, os: "Linux, x86_64".into() },
            adapter: "llvmpipe".into(),
            driver: "Mesa".into(),
            software: true,
            scene: "hall, \"old\"".into(),
            triangles: 12,
            lights: 1,
            light_kinds: vec!["point".into()],
            name: name.into(),
            technique: name.trim_end_matches(|c: char| c == '-' || c.is_ascii_digit()).into(),
            peer: name.starts_with("ray-march"),
            preset: "sweep".into(),
            label: "64 steps".into(),
            settings: Default::default(),
            terms: vec!["airlight".into()],
            width: 320,
            height: 256,
            frames: 3,
            warm_up: 1,
            moving: "the scene's own motion".into(),
            technique_ms: spread,
            technique_ms_from: "timestamps".into(),
            technique_wall_ms: spread,
            passes: BTreeMap::from([("a: draw".into(), spread)]),
            ground_passes: BTreeMap::new(),
            cpu_ms: spread,
            frame_ms: spread,
            samples_ms: Samples::default(),
            gpu_bytes: Some(1 << 20),
            silhouette_edges: None,
            model_error: None,
            error: Errors { rel_rmse, nan: 0, inf: 0, negative: 0, flip: 0.01, ..Errors::NONE },
            bound: Some(0.03),
            refused: None,
            reference: ReferenceNote {
                terms: vec!["airlight".into()],
                uncertainty: 1e-4,
                seconds: 2.0,
                cached: false,
                other_surface: 0,
            },
            pictures: Pictures::default(),
            notes: Vec::new(),
        }
    }

    #[test]
    fn medians_lie_in_the_middle_and_percentiles_are_nearest_ranks() {
        let times: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(Spread::of(&times), Spread { p50: 50.5, p95: 95.0, max: 100.0 });
        assert_eq!(Spread::of(&[3.0, 1.0, 2.0]), Spread { p50: 2.0, p95: 3.0, max: 3.0 });
        assert_eq!(Spread::of(&[7.0]), Spread { p50: 7.0, p95: 7.0, max: 7.0 });
        assert_eq!(Spread::of(&[]), Spread::default());
    }

    #[test]
    fn a_wrong_picture_is_a_problem() {
        let right = example("ray-march-64", 2.0, 0.01);
        assert_eq!(right.problem(), None);
        let off = Record { error: Errors { rel_rmse: 0.04, ..right.error }, ..right.clone() };
        assert!(off.problem().unwrap().contains("above the bound"));
        assert_eq!(Record { bound: None, ..off }.problem(), None);
        let unknown = Record { error: Errors { rel_rmse: f64::NAN, ..right.error }, ..right.clone() };
        assert!(unknown.problem().is_some());
        let speckled = Record { error: Errors { nan: 1, ..right.error }, bound: None, ..right };
        assert!(speckled.problem().unwrap().contains("1 NaN"));
    }
}
