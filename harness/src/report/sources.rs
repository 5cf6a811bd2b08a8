//! Where a report's records come from: one run's folder or several, each measurement once.

use std::path::Path;

use crate::failure::Failure;
use crate::record::{self, Pictures, Record, Study};

/// Records of one or several runs, and what has to be said about reading them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sources {
    /// Their pictures are paths from where the program was started, not from the run's folder.
    pub records: Vec<Record>,
    pub notes: Vec<String>,
}

impl Sources {
    /// Of all `folders`; a measurement that is there twice on one adapter counts once, as it was taken last.
    pub(crate) fn read(folders: &[impl AsRef<Path>]) -> Result<Self, Failure> {
        let mut sources = Self::default();
        let mut read = Vec::new();
        for folder in folders {
            let (records, note) = record::read_tolerant(folder.as_ref())?;
            sources.notes.extend(note);
            read.push(records);
        }
        tell_machines_apart(&mut read);
        folders.iter().zip(read).for_each(|(folder, records)| sources.add(folder.as_ref(), records));
        Ok(sources)
    }

    /// Of the run that `records` are of.
    pub(crate) fn of(folder: &Path, records: &[Record]) -> Self {
        let mut sources = Self::default();
        sources.add(folder, records.to_vec());
        sources
    }

    fn add(&mut self, folder: &Path, records: Vec<Record>) {
        for record in records {
            let record = rooted(record, folder);
            let same = |other: &Record| other.adapter == record.adapter && other.key() == record.key();
            match self.records.iter_mut().find(|other| same(other)) {
                Some(earlier) => {
                    let (old, new) = if earlier.date <= record.date {
                        (earlier.date.clone(), record.date.clone())
                    } else {
                        (record.date.clone(), earlier.date.clone())
                    };
                    self.notes.push(format!(
                        "{}, {}, study {}: measured twice on {}; that of {new} counts, not that of {old}",
                        record.scene,
                        record.name,
                        record.study.name(),
                        record.adapter,
                    ));
                    if earlier.date <= record.date {
                        *earlier = record;
                    }
                }
                None => self.records.push(record),
            }
        }
    }

    /// The records as they are kept apart from their runs' folders, in which the pictures stay; adapters by their own names
    /// again, so that they can be read beside others.
    pub(crate) fn without_pictures(&self) -> Vec<Record> {
        let plain = |record: &Record| {
            let pictures = Pictures { exposure: record.pictures.exposure, ..Default::default() };
            let name = record.adapter.strip_suffix(&within(record)).unwrap_or(&record.adapter);
            Record { pictures, adapter: name.to_owned(), ..record.clone() }
        };
        self.records.iter().map(plain).collect()
    }

    /// The adapters, each once, in the order of the records.
    pub(crate) fn adapters(&self) -> Vec<&str> {
        once(self.records.iter().map(|record| record.adapter.as_str()))
    }
}

/// Adapters of one name in different machines get the machine's name too: a software adapter is called the same
/// everywhere, and a card may sit in two machines.
pub(crate) fn tell_machines_apart(runs: &mut [Vec<Record>]) {
    let all: Vec<(String, String)> =
        runs.iter().flatten().map(|record| (record.adapter.clone(), within(record))).collect();
    for record in runs.iter_mut().flatten() {
        let own = within(record);
        if all.iter().any(|(adapter, other)| *adapter == record.adapter && *other != own) {
            record.adapter += &own;
        }
    }
}

/// What is put behind an adapter's name to tell it from others of that name.
fn within(record: &Record) -> String {
    format!(" in {}, {} cores", record.machine.cpu, record.machine.cores)
}

/// A record whose pictures are found from here.
fn rooted(mut record: Record, folder: &Path) -> Record {
    let pictures = &mut record.pictures;
    for file in [
        &mut pictures.picture,
        &mut pictures.airlight_exr,
        &mut pictures.error_map,
        &mut pictures.reference,
        &mut pictures.reference_airlight_exr,
    ] {
        if !file.is_empty() {
            *file = folder.join(&*file).to_string_lossy().into_owned();
        }
    }
    record
}

/// What is compared in one chart: one scene, one size, one adapter, and all that was drawn of it.
#[derive(Clone, Debug)]
pub(crate) struct Case<'a> {
    pub first: &'a Record,
    pub records: Vec<&'a Record>,
    /// The paper's settings with one improvement each.
    pub improvements: Vec<&'a Record>,
}

/// The cases of the main study, in the order of the records, and those of improvements that were measured by themselves.
pub(crate) fn cases(records: &[Record]) -> Vec<Case<'_>> {
    let mut cases: Vec<Case<'_>> = Vec::new();
    for record in records.iter().filter(|record| record.study == Study::Main) {
        match cases.iter_mut().find(|case| is_alike(case.first, record)) {
            Some(case) => case.records.push(record),
            None => cases.push(Case { first: record, records: vec![record], improvements: Vec::new() }),
        }
    }
    let main = cases.len();
    for record in records.iter().filter(|record| record.study == Study::Improvements) {
        // They may be smaller pictures: they are held against each other alone.
        let of = |case: &&mut Case<'_>| {
            let place = |r: &Record| (r.triangles, r.lights);
            case.first.adapter == record.adapter
                && case.first.scene == record.scene
                && place(case.first) == place(record)
        };
        if let Some(case) = cases[..main].iter_mut().find(of) {
            case.improvements.push(record);
            continue;
        }
        // Measured by themselves they are a case of their own.
        match cases[main..].iter_mut().find(|case| is_alike(case.first, record)) {
            Some(case) => {
                case.records.push(record);
                case.improvements.push(record);
            }
            None => cases.push(Case { first: record, records: vec![record], improvements: vec![record] }),
        }
    }
    cases
}

/// Whether two measurements are of the same picture on the same adapter.
pub(crate) fn is_alike(a: &Record, b: &Record) -> bool {
    let place = |r: &Record| (r.triangles, r.lights, r.width, r.height);
    a.adapter == b.adapter && a.scene == b.scene && place(a) == place(b)
}

impl Case<'_> {
    /// Techniques, then peers, each once and in the order of the records.
    pub(crate) fn techniques(&self) -> Vec<&str> {
        let names =
            |peer: bool| self.records.iter().filter(move |r| r.peer == peer).map(|r| r.technique.as_str());
        once(names(false).chain(names(true)))
    }

    /// The setting of a record in few words, with the shadow maps' size where several were measured.
    pub(crate) fn setting(&self, record: &Record) -> String {
        match self.maps(record) {
            Some(maps) if !record.label.ends_with(&maps) => format!("{}, {maps}", record.label),
            _ => record.label.clone(),
        }
    }

    /// The size of a record's shadow maps, where several were measured.
    pub(crate) fn maps(&self, record: &Record) -> Option<String> {
        let size = record.shadow_map_size()?;
        let several = self.records.iter().any(|other| other.shadow_map_size() != Some(size));
        several.then(|| format!("{size}² map"))
    }

    /// Scene and size, apart from those of `all` the others.
    pub(crate) fn title(&self, all: &[Case<'_>]) -> String {
        let Record { scene, width, height, triangles, adapter, .. } = self.first;
        let others =
            all.iter().filter(|case| case.first.scene == *scene && !std::ptr::eq(case.first, self.first));
        let others: Vec<_> = others.collect();
        let mut title = scene.clone();
        if others.iter().any(|case| (case.first.width, case.first.height) != (*width, *height)) {
            title += &format!(", {width} × {height}");
        }
        if others.iter().any(|case| case.first.triangles != *triangles) {
            title += &format!(", {triangles} triangles");
        }
        if others.iter().any(|case| case.first.adapter != *adapter) {
            title += &format!(", {adapter}");
        }
        title
    }
}

/// Each name once, in its order.
pub(crate) fn once<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut all: Vec<&str> = Vec::new();
    for name in names {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::example;
    use crate::record::{RECORDS, Writer};

    fn folder(records: &[Record]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = Writer::open(folder.path()).unwrap();
        records.iter().for_each(|record| writer.add(record).unwrap());
        folder
    }

    #[test]
    fn a_measurement_counts_once_as_it_was_taken_last() {
        let old = example("ray-march-64", 9.0, 0.1);
        let new = Record { date: "2025-02-01T00:00:00Z".into(), ..example("ray-march-64", 2.0, 0.1) };
        let other = Record { adapter: "another".into(), ..old.clone() };
        let (first, second) =
            (folder(&[new.clone(), other]), folder(&[old, example("ray-march-16", 1.0, 0.3)]));
        for order in [[first.path(), second.path()], [second.path(), first.path()]] {
            let sources = Sources::read(&order).unwrap();
            let march = |r: &&Record| r.name == "ray-march-64" && r.adapter == "llvmpipe";
            assert_eq!(sources.records.len(), 3);
            assert_eq!(sources.records.iter().find(march).unwrap().technique_ms.p50, 2.0);
            assert_eq!(sources.notes.len(), 1, "{:?}", sources.notes);
            assert!(sources.notes[0].contains("measured twice"));
            assert_eq!(sources.adapters().len(), 2);
        }
    }

    #[test]
    fn one_adapter_in_two_machines_is_two() {
        let here = example("ray-march-64", 2.0, 0.1);
        let mut there = here.clone();
        there.machine.cores = 64;
        let (first, second) = (folder(std::slice::from_ref(&here)), folder(&[there]));
        let sources = Sources::read(&[first.path(), second.path()]).unwrap();
        assert_eq!((sources.records.len(), sources.notes.len()), (2, 0));
        assert_eq!(
            sources.adapters(),
            ["llvmpipe in a <fast> one, 2 cores", "llvmpipe in a <fast> one, 64 cores"]
        );
        assert_eq!(Sources::read(&[first.path()]).unwrap().adapters(), ["llvmpipe"]);
        // Kept, and read again beside one of them, they are the same two.
        let kept = folder(&sources.without_pictures());
        let again = Sources::read(&[kept.path(), first.path()]).unwrap();
        assert_eq!((again.records.len(), again.adapters()), (2, sources.adapters()));
    }

    #[test]
    fn a_run_that_was_killed_is_read_up_to_there() {
        let whole = folder(&[example("a", 1.0, 0.1), example("b", 1.0, 0.1)]);
        let path = whole.path().join(RECORDS);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, &text[..text.len() - 30]).unwrap();
        let sources = Sources::read(&[whole.path()]).unwrap();
        assert_eq!(sources.records.len(), 1);
        assert!(
            sources.notes[0].contains("line 2") && sources.notes[0].contains("cut off"),
            "{:?}",
            sources.notes
        );
        // In the middle it is no accident.
        std::fs::write(&path, format!("{}\n{text}", &text[..40])).unwrap();
        assert_eq!(Sources::read(&[whole.path()]).unwrap_err().exit_code(), 2);
    }

    #[test]
    fn names_that_this_version_does_not_know_are_passed_over() {
        let whole = folder(&[example("a", 1.0, 0.1)]);
        let path = whole.path().join(RECORDS);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replacen('{', "{\"weather\":\"rain\",", 1)).unwrap();
        assert_eq!(Sources::read(&[whole.path()]).unwrap().records.len(), 1);
    }

    #[test]
    fn sizes_and_adapters_are_not_mixed() {
        let a = example("ray-march-64", 2.0, 0.1);
        let large = Record { width: 640, ..a.clone() };
        let improved = Record { study: Study::Improvements, width: 160, ..a.clone() };
        let elsewhere = Record { adapter: "another".into(), ..a.clone() };
        let fine = Record {
            settings: serde_json::Map::from_iter([("shadow_map_size".into(), 1024.into())]),
            ..a.clone()
        };
        let records = [a, large, elsewhere, improved, fine];
        let cases = cases(&records);
        assert_eq!(cases.iter().map(|case| case.records.len()).collect::<Vec<_>>(), [2, 1, 1]);
        assert_eq!(cases[0].improvements.len(), 1);
        assert_eq!(cases[0].title(&cases), "hall, \"old\", 320 × 256, llvmpipe");
        assert_eq!(cases[0].setting(&records[4]), "64 steps, 1024² map");
        assert_eq!(cases[1].setting(&records[1]), "64 steps");
        let alone = [records[3].clone(), Record { name: "b".into(), ..records[3].clone() }];
        let alone = super::cases(&alone);
        assert_eq!((alone.len(), alone[0].records.len(), alone[0].improvements.len()), (1, 2, 2));
    }
}
