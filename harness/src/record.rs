//! One record per measurement: JSON lines and CSV. Every name and unit: `results/README.md`.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::Path;

use clap::ValueEnum;
use common::files::write_whole;
use serde::{Deserialize, Deserializer, Serialize};

use crate::failure::Failure;
use crate::machine::Machine;

/// Version of the record's names and meanings.
pub(crate) const SCHEMA: u32 = 2;

/// File of records in a run's folder.
pub(crate) const RECORDS: &str = "records.jsonl";

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
        Self { terms: Vec::new(), uncertainty: 0.0, seconds: 0.0, cached: false }
    }
}

impl Errors {
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
        Self { p50: rank(0.50), p95: rank(0.95), max }
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

/// Appends records to a file, each one in the file before the next is taken.
pub(crate) struct Writer {
    file: File,
}

impl Writer {
    /// Goes on with the file of records in `folder`, or starts it. A last line that was cut short goes.
    pub(crate) fn open(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(RECORDS);
        let failed = |error: std::io::Error| Failure::Run(format!("can't write {}: {error}", path.display()));
        let file = File::options().append(true).create(true).open(&path).map_err(failed)?;
        let whole = whole_text(&path).len() as u64;
        file.set_len(whole).map_err(failed)?;
        Ok(Self { file })
    }

    /// Adds one record.
    pub(crate) fn add(&mut self, record: &Record) -> Result<(), Failure> {
        let mut line = serde_json::to_vec(record).map_err(|e| Failure::Run(format!("a record: {e}")))?;
        line.push(b'\n');
        let written = self.file.write_all(&line).and_then(|()| self.file.sync_data());
        written.map_err(|error| Failure::Run(format!("can't write {RECORDS}: {error}")))
    }
}

/// All whole lines of a file; nothing of one that is not there.
fn whole_text(path: &Path) -> String {
    let mut text = std::fs::read_to_string(path).unwrap_or_default();
    text.truncate(text.rfind('\n').map_or(0, |end| end + 1));
    text
}

/// All records of a run that was stopped, perhaps before the first one.
pub(crate) fn read_stopped(folder: &Path) -> Result<Vec<Record>, Failure> {
    if whole_text(&folder.join(RECORDS)).is_empty() {
        return Ok(Vec::new());
    }
    read_tolerant(folder).map(|(records, _)| records)
}

/// All records of a run's folder. A last line that was cut off, as in a run that was killed, is left out, and said.
pub(crate) fn read_tolerant(folder: &Path) -> Result<(Vec<Record>, Option<String>), Failure> {
    let path = folder.join(RECORDS);
    let text = std::fs::read_to_string(&path)
        .map_err(|error| Failure::Input(format!("can't read {}: {error}", path.display())))?;
    let (mut records, mut note) = (Vec::new(), None);
    let count = text.lines().count();
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let place = || format!("{} line {}", path.display(), index + 1);
        let last = index + 1 == count && !text.ends_with('\n');
        match serde_json::from_str(line) {
            Err(error) if last && error.is_eof() => {
                note = Some(format!("{} is cut off and was left out", place()))
            }
            Err(error) => return Err(Failure::Input(format!("{}: {error}", place()))),
            Ok(value) => {
                let record = parse(value);
                records.push(record.map_err(|what| Failure::Input(format!("{}: {what}", place())))?);
            }
        }
    }
    if records.is_empty() {
        return Err(Failure::Input(format!("{} holds no records", path.display())));
    }
    Ok((records, note))
}

/// The version first: another one may have other names.
fn parse(value: serde_json::Value) -> Result<Record, String> {
    let schema = value.get("schema").and_then(serde_json::Value::as_u64);
    if schema != Some(u64::from(SCHEMA)) {
        let found = schema.map_or("none".into(), |schema| schema.to_string());
        return Err(format!("the record's schema is {found}; this program reads {SCHEMA}"));
    }
    serde_json::from_value(value).map_err(|error| error.to_string())
}

/// Writes the records as a table, one row each; lists and settings are left to the JSON.
pub(crate) fn write_csv(path: &Path, records: &[Record]) -> std::io::Result<()> {
    write_whole(path, |file| {
        writeln!(file, "{}", CSV_COLUMNS.map(|(name, _)| name).join(","))?;
        for record in records {
            let cells = CSV_COLUMNS.map(|(_, cell)| quoted(&cell(record)));
            writeln!(file, "{}", cells.join(","))?;
        }
        Ok(())
    })
}

/// Quoted as RFC 4180 wants it.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.into()
    }
}

type Column = (&'static str, fn(&Record) -> String);

const CSV_COLUMNS: [Column; 43] = [
    ("schema", |r| r.schema.to_string()),
    ("study", |r| r.study.name().into()),
    ("date", |r| r.date.clone()),
    ("commit", |r| r.commit.clone()),
    ("cpu", |r| r.machine.cpu.clone()),
    ("cores", |r| r.machine.cores.to_string()),
    ("adapter", |r| r.adapter.clone()),
    ("driver", |r| r.driver.clone()),
    ("software", |r| r.software.to_string()),
    ("scene", |r| r.scene.clone()),
    ("triangles", |r| r.triangles.to_string()),
    ("lights", |r| r.lights.to_string()),
    ("name", |r| r.name.clone()),
    ("technique", |r| r.technique.clone()),
    ("peer", |r| r.peer.to_string()),
    ("preset", |r| r.preset.clone()),
    ("label", |r| r.label.clone()),
    ("shadow_map_size", |r| r.shadow_map_size().map_or(String::new(), |size| size.to_string())),
    ("terms", |r| r.terms.join("+")),
    ("width", |r| r.width.to_string()),
    ("height", |r| r.height.to_string()),
    ("frames", |r| r.frames.to_string()),
    ("technique_ms_p50", |r| r.technique_ms.p50.to_string()),
    ("technique_ms_p95", |r| r.technique_ms.p95.to_string()),
    ("technique_ms_max", |r| r.technique_ms.max.to_string()),
    ("cpu_ms_p50", |r| r.cpu_ms.p50.to_string()),
    ("ground_ms_p50", |r| r.ground_ms().to_string()),
    ("frame_ms_p50", |r| r.frame_ms.p50.to_string()),
    ("gpu_bytes", |r| r.gpu_bytes.map_or(String::new(), |bytes| bytes.to_string())),
    ("rel_rmse", |r| r.error.rel_rmse.to_string()),
    ("bias", |r| r.error.bias.to_string()),
    ("p99", |r| r.error.p99.to_string()),
    ("max", |r| r.error.max.to_string()),
    ("worst_tile", |r| r.error.worst_tile.to_string()),
    ("leak", |r| r.error.leak.to_string()),
    ("flip", |r| r.error.flip.to_string()),
    ("nan", |r| r.error.nan.to_string()),
    ("inf", |r| r.error.inf.to_string()),
    ("negative", |r| r.error.negative.to_string()),
    ("energy_ratio", |r| r.error.energy_ratio.to_string()),
    ("reference_uncertainty", |r| r.reference.uncertainty.to_string()),
    ("model_rel_rmse", |r| r.model_error.as_ref().map_or(String::new(), |m| m.rel_rmse.to_string())),
    ("model_bias", |r| r.model_error.as_ref().map_or(String::new(), |m| m.bias.to_string())),
];

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
            },
            pictures: Pictures::default(),
            notes: Vec::new(),
        }
    }

    #[test]
    fn percentiles_are_nearest_ranks() {
        let times: Vec<f64> = (1..=100).rev().map(f64::from).collect();
        assert_eq!(Spread::of(&times), Spread { p50: 50.0, p95: 95.0, max: 100.0 });
        assert_eq!(Spread::of(&[7.0]), Spread { p50: 7.0, p95: 7.0, max: 7.0 });
        assert_eq!(Spread::of(&[]), Spread::default());
    }

    #[test]
    fn records_are_read_back_as_written() {
        let folder = tempfile::tempdir().unwrap();
        let written = [example("ray-march-64", 2.0, 0.01), example("ray-march-16", 0.5, 0.5)];
        let mut writer = Writer::open(folder.path()).unwrap();
        for (index, record) in written.iter().enumerate() {
            writer.add(record).unwrap();
            assert_eq!(read_tolerant(folder.path()).unwrap().0.len(), index + 1, "on disk at once");
        }
        let (read, _) = read_tolerant(folder.path()).unwrap();
        // NaN, which equals nothing, becomes null and comes back.
        assert!(read[0].error.bias.is_nan());
        assert_eq!(format!("{read:?}"), format!("{written:?}"));
    }

    #[test]
    fn what_is_not_a_record_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let whole = serde_json::to_string(&example("ray-march-64", 2.0, 0.01)).unwrap();
        for (text, expected) in [
            (String::new(), "holds no records"),
            (format!("{whole}\n{}\n", &whole[..100]), "line 2"),
            (whole.replacen("\"schema\":2", "\"schema\":99", 1), "schema is 99"),
            ("{}".into(), "schema is none"),
            ("{\"schema\":2}".into(), "missing field"),
        ] {
            std::fs::write(folder.path().join(RECORDS), text).unwrap();
            let failure = read_tolerant(folder.path()).unwrap_err();
            assert!(failure.to_string().contains(expected), "{failure}");
            assert_eq!(failure.exit_code(), 2);
        }
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

    #[test]
    fn a_table_quotes_what_needs_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("records.csv");
        write_csv(&path, &[example("ray-march-64", 2.0, 0.01)]).unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[0].starts_with("schema,study,date,commit,"));
        assert!(lines[1].contains("\"hall, \"\"old\"\"\""), "{text}");
    }
}
