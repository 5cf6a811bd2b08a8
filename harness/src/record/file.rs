//! Files of records: JSON lines, and CSV.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::Path;

use common::files::write_whole;

use super::{Record, SCHEMA};
use crate::failure::Failure;

/// File of records in a run's folder.
pub(crate) const RECORDS: &str = "records.jsonl";

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
        let whole = whole_text(&path).map_err(failed)?.len() as u64;
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

/// Writes a whole file of records.
pub(crate) fn write_records(path: &Path, records: &[Record]) -> std::io::Result<()> {
    write_whole(path, |file| {
        for record in records {
            serde_json::to_writer(&mut *file, record)?;
            file.write_all(b"\n")?;
        }
        Ok(())
    })
}

/// All whole lines of a file; nothing of one that is not there. The last line may be cut within a letter.
fn whole_text(path: &Path) -> std::io::Result<String> {
    let mut bytes = match std::fs::read(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
        read => read?,
    };
    bytes.truncate(bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1));
    String::from_utf8(bytes).map_err(|error| std::io::Error::new(ErrorKind::InvalidData, error))
}

/// All records of a run that was stopped, perhaps before the first one.
pub(crate) fn read_stopped(folder: &Path) -> Result<Vec<Record>, Failure> {
    let path = folder.join(RECORDS);
    let text = whole_text(&path).map_err(|error| unreadable(&path, &error))?;
    records_of(&path, &text)
}

/// All records of a run's folder. A last line that was cut off, as in a run that was killed, is left out, and said.
pub(crate) fn read_tolerant(folder: &Path) -> Result<(Vec<Record>, Option<String>), Failure> {
    let path = folder.join(RECORDS);
    let size = path.metadata().map_err(|error| unreadable(&path, &error))?.len();
    let text = whole_text(&path).map_err(|error| unreadable(&path, &error))?;
    let records = records_of(&path, &text)?;
    if records.is_empty() {
        return Err(Failure::Input(format!("{} holds no records", path.display())));
    }
    let last = text.lines().count() + 1;
    let cut = format!("{} line {last} is cut off and was left out", path.display());
    Ok((records, (size > text.len() as u64).then_some(cut)))
}

fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Input(format!("can't read {}: {error}", path.display()))
}

/// The records of whole lines.
fn records_of(path: &Path, text: &str) -> Result<Vec<Record>, Failure> {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let record = |(index, line): (usize, &str)| {
        let value = serde_json::from_str(line).map_err(|error| error.to_string());
        value
            .and_then(parse)
            .map_err(|what| Failure::Input(format!("{} line {}: {what}", path.display(), index + 1)))
    };
    lines.map(record).collect()
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
mod tests {
    use super::super::tests::example;
    use super::*;

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
            (whole.replacen("\"schema\":2", "\"schema\":99", 1) + "\n", "schema is 99"),
            ("{}\n".into(), "schema is none"),
            ("{\"schema\":2}\n".into(), "missing field"),
        ] {
            std::fs::write(folder.path().join(RECORDS), text).unwrap();
            let failure = read_tolerant(folder.path()).unwrap_err();
            assert!(failure.to_string().contains(expected), "{failure}");
            assert_eq!(failure.exit_code(), 2);
        }
    }

    #[test]
    fn a_line_cut_within_a_letter_loses_that_line_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(RECORDS);
        let mut record = example("froxels-8x64", 2.0, 0.01);
        record.label = "8² pixels × 64 slices".into();
        Writer::open(folder.path()).unwrap().add(&record).unwrap();
        let whole = std::fs::read(&path).unwrap();
        let cut = whole.windows(2).position(|two| two == "²".as_bytes()).unwrap() + 1;
        std::fs::write(&path, [&whole[..], &whole[..cut]].concat()).unwrap();
        let (records, note) = read_tolerant(folder.path()).unwrap();
        assert!(records.len() == 1 && note.unwrap().contains("line 2 is cut off"));
        assert_eq!(read_stopped(folder.path()).unwrap().len(), 1);
        Writer::open(folder.path()).unwrap().add(&record).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), [&whole[..], &whole[..]].concat());
        // What can't be read is not taken for nothing.
        std::fs::write(&path, [&whole[..cut], b"\n"].concat()).unwrap();
        assert!(Writer::open(folder.path()).is_err() && read_stopped(folder.path()).is_err());
        assert_eq!(std::fs::read(&path).unwrap().len(), cut + 1);
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
