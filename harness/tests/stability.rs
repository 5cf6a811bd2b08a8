//! The atlas of what breaks, in its quick form: every promise holds, and the page leads from cell to picture.

use std::path::Path;
use std::process::{Command, Output};

fn stability(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_harness"));
    command.current_dir(folder).arg("stability").args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn promises_hold_in_the_quick_form() {
    let folder = tempfile::tempdir().unwrap();
    let output = stability(folder.path(), &["--quick", "-o", "atlas"]);
    let said = text(&output.stderr);
    if said.contains("no graphics adapter") {
        eprintln!("skipped: {said}");
        return;
    }
    assert!(output.status.success(), "{}\n{said}", text(&output.stdout));
    let atlas = folder.path().join("atlas");
    let page = std::fs::read_to_string(atlas.join("index.html")).unwrap();
    let shown = |page: &str| {
        let names = page.split("src=\"").skip(1).filter_map(|rest| rest.split_once('"'));
        names.filter(|(name, _)| atlas.join(name).is_file()).count()
    };
    assert!(page.contains("Every promise holds") && shown(&page) > 100, "{} pictures", shown(&page));
    let records = std::fs::read_to_string(atlas.join("records.jsonl")).unwrap();
    // All rows (the refusal of one that is not there names them) but the one in which nothing is promised.
    let named = text(&stability(folder.path(), &["--row", "nonsense"]).stderr);
    let (_, named) = named.trim().split_once("; there are: ").unwrap();
    let rows: Vec<&str> = named.split(", ").collect();
    assert!(rows.len() > 50, "{named}");
    for row in rows.into_iter().filter(|row| *row != "lattice") {
        assert!(records.lines().any(|line| line.contains(&format!("\"row\":\"{row}\""))), "{row}");
    }

    // Page and tables come from the records alone, and go where the markers are.
    std::fs::write(
        folder.path().join("README.md"),
        "before\n<!-- harness:domain-biri-ss -->\n<!-- /harness:domain-biri-ss -->\nafter\n",
    )
    .unwrap();
    let output = stability(folder.path(), &["--from-records", "-o", "atlas", "--readme", "README.md"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let again = std::fs::read_to_string(atlas.join("index.html")).unwrap();
    assert!(again.contains("Every promise holds") && shown(&again) == shown(&page));
    let readme = std::fs::read_to_string(folder.path().join("README.md")).unwrap();
    assert!(
        readme.starts_with("before\n") && readme.contains("| the whole scene in another unit (scale)"),
        "{readme}"
    );
}

#[test]
fn what_is_not_there_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        (&["--row", "nonsense"][..], "there is no row `nonsense`; there are: light-near-ray"),
        (&["--only", "nonsense"], "there is no column `nonsense`; there are: billeter-plv-default"),
        (&["--from-records", "-o", "nowhere"], "can't read nowhere/records.jsonl"),
    ] {
        let output = stability(folder.path(), arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(expected) && !said.contains("panicked"), "{arguments:?}: {said}");
    }
    assert_eq!(folder.path().read_dir().unwrap().count(), 0);
}
