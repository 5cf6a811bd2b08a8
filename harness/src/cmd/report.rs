//! `harness report`: the page of one run or several, made again from their records.

use std::io::Write;
use std::path::{Path, PathBuf};

use common::files::write_whole;

use crate::cli;
use crate::failure::Failure;
use crate::output::{check_replaceable, make_writable};
use crate::record::{RECORDS, Record, Study, read_tolerant, write_records};
use crate::report::sources::{Sources, cases};
use crate::report::{self, Report, readme, table};

/// Writes table, charts and page; gives what to print.
pub(crate) fn run(arguments: &cli::Report) -> Result<String, Failure> {
    let folders = &arguments.folders;
    let output = match (&arguments.output, folders.as_slice()) {
        (Some(output), [_, _, ..]) if folders.iter().any(|folder| is_same_folder(folder, output)) => {
            return Err(Failure::Input(format!(
                "{} is one of the runs; the page of several goes into a folder of its own",
                output.display()
            )));
        }
        (Some(output), _) => output,
        (None, [folder]) => folder,
        (None, _) => {
            return Err(Failure::Input(
                "several runs make one page in a folder of its own: name it by -o".into(),
            ));
        }
    };
    let sources = Sources::read(folders)?;
    let report = if arguments.papers.is_empty() {
        Report::with_found_papers(sources, folders)
    } else {
        Report::new(sources, &arguments.papers)?
    };
    if !folders.iter().any(|folder| is_same_folder(folder, output)) {
        check_nothing_lost(output, &report.sources.records)?;
    }
    // What can be wrong with the README, before anything is written.
    let spliced = arguments.readme.as_deref().map(|path| splice(path, &report)).transpose()?;
    make_writable(output)?;
    if !folders.iter().any(|folder| is_same_folder(folder, output)) {
        let path = output.join(RECORDS);
        write_records(&path, &report.sources.without_pictures())
            .map_err(|error| Failure::Run(format!("can't write {}: {error}", path.display())))?;
    }
    report.write(output)?;
    let mut text: String = report.sources.notes.iter().map(|note| format!("note: {note}\n")).collect();
    let records = &report.sources.records;
    let main: Vec<_> = records.iter().filter(|record| record.study == Study::Main).cloned().collect();
    text += &format!("{}\n{}", table::table(&main), table::legend(&main));
    text += &format!("wrote {}\n", output.join(report::PAGE).display());
    if let (Some(path), Some(readme)) = (&arguments.readme, spliced) {
        write_whole(path, |file| file.write_all(readme.as_bytes())).map_err(|error: std::io::Error| {
            Failure::Run(format!("can't write {}: {error}", path.display()))
        })?;
        text += &format!("wrote {}\n", path.display());
    }
    Ok(text)
}

/// Fails where the folder has other things, or measurements of its own, that would be replaced.
fn check_nothing_lost(output: &Path, records: &[Record]) -> Result<(), Failure> {
    check_replaceable(output, &[RECORDS])?;
    if !output.join(RECORDS).exists() {
        return Ok(());
    }
    let (own, _) = read_tolerant(output)?;
    let same = |a: &Record, b: &Record| a.key() == b.key() && a.date == b.date;
    let lost = own.iter().filter(|own| !records.iter().any(|record| same(own, record))).count();
    if lost == 0 {
        return Ok(());
    }
    Err(Failure::Input(format!(
        "{} holds {lost} measurements that are in none of the runs; name another folder by -o",
        output.display()
    )))
}

fn is_same_folder(a: &Path, b: &Path) -> bool {
    a.canonicalize().ok().zip(b.canonicalize().ok()).is_some_and(|(a, b)| a == b)
}

/// The README with its tables in place.
fn splice(path: &Path, report: &Report) -> Result<String, Failure> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| Failure::Input(format!("can't read {}: {error}", path.display())))?;
    let cases = cases(&report.sources.records);
    readme::splice(&text, &readme::blocks(&cases))
        .map_err(|what| Failure::Input(format!("{}: {what}", PathBuf::from(path).display())))
}
