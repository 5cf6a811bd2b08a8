//! The program as a user meets it: exit codes, sentences, files. What needs a graphics adapter says
//! so and fails where there is none.

use std::path::Path;
use std::process::{Command, Output};

fn harness(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_harness")).current_dir(folder).args(arguments).output().unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Runs it and expects `code` and, on stderr, one sentence with `expected` in it and no panic.
fn refused(folder: &Path, arguments: &[&str], code: i32, expected: &str) {
    let output = harness(folder, arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {text}");
    assert!(text.contains(expected), "{arguments:?}: {text}");
    assert!(!text.contains("panicked"), "{arguments:?}: {text}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
}

#[test]
fn a_run_of_nothing_is_refused_and_takes_no_results_away() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for arguments in [
        &["--study", "edges"][..],
        &["--full", "--scene", "cathedral", "--study", "lights"],
        &["--full", "--only", "szk-network", "--study", "triangles", "--size", "8x8"],
    ] {
        refused(at, arguments, 2, "nothing to measure");
    }
    assert_eq!(at.read_dir().unwrap().count(), 0);
}

#[test]
fn help_is_enough_to_work_from() {
    let folder = tempfile::tempdir().unwrap();
    let output = harness(folder.path(), &["--help"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success());
    for wanted in [
        "render",
        "list",
        "targets",
        "papers",
        "--improvements",
        "report",
        "--scene",
        "--size",
        "EXAMPLES",
        "EXIT CODES",
        "130",
    ] {
        assert!(text.contains(wanted), "{wanted}");
    }
}

#[test]
fn list_names_everything() {
    let folder = tempfile::tempdir().unwrap();
    let output = harness(folder.path(), &["list"]);
    let text = String::from_utf8(output.stdout).unwrap();
    for wanted in [
        "cathedral",
        "amphora",
        "billeter-plv-paper-upright",
        "ray-march-64",
        "airlight",
        "henyey-greenstein",
    ] {
        assert!(text.contains(wanted), "{wanted}");
    }
}

#[test]
fn wrong_usage_is_refused_before_any_work() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    refused(at, &["--size", "0x0"], 2, "at least one pixel");
    refused(at, &["--size", "large"], 2, "640x512");
    refused(at, &["--size", "100000x100000"], 2, "at most");
    refused(at, &["--frames", "0"], 2, "frames");
    refused(at, &["--technique", "fog"], 2, "no technique `fog`");
    let names = stderr(&harness(at, &["--technique", "fog"]));
    for name in ["lit-intervals", "unshadowed", "froxels-8x64"] {
        assert_eq!(names.split([' ', ',']).filter(|word| *word == name).count(), 1, "{name}: {names}");
    }
    refused(at, &["--no-such-flag"], 2, "no-such-flag");
    refused(at, &["--only", "ray-march-64@0"], 2, "from 2 to 16384 behind the @");
    refused(at, &["--full", "--quick"], 2, "cannot be used with");
    refused(at, &["--resume"], 2, "without --resume");
    refused(at, &["report", "nowhere"], 2, "can't read");
    refused(at, &["report"], 2, "DIR");
    refused(at, &["compare", "nowhere", "elsewhere"], 2, "can't read");
    refused(at, &["compare", "nowhere", "elsewhere", "--threshold", "much"], 2, "5%");
    refused(at, &["targets", "--size", "0x0"], 2, "at least one pixel");
    refused(at, &["targets", "--technique", "fog"], 2, "billeter-plv");
    refused(at, &["targets", "--technique", "szk-network", "--sibenik", "nofile.obj"], 2, "nofile.obj");
    refused(at, &["papers"], 2, "PAPER");
    refused(at, &["papers", "fog"], 2, "billeter, biri, chen");
    refused(at, &["papers", "chen", "--size", "0x0"], 2, "at least one pixel");
    refused(at, &["papers", "biri", "--frames", "0"], 2, "frames");
    refused(at, &["--improvements", "--technique", "fog"], 2, "no technique `fog`");
    refused(at, &["choose", "--scene", "pen", "--technique", "fog"], 2, "expected lit-intervals");
    refused(at, &["view", "--scene", "no-such-scene"], 2, "cathedral");
    refused(at, &["view", "--scene", "empty", "--against", "fog"], 2, "no technique `fog`");
    let render = ["render", "--scene", "empty", "--technique", "reference", "-o"];
    let with = |rest: &[&'static str]| [&render[..], rest].concat();
    refused(at, &with(&["picture.jpg"]), 2, ".exr");
    refused(at, &with(&["no/such/folder/picture.png"]), 2, "no folder");
    refused(at, &with(&["a.png", "--terms", "fog"]), 2, "surface");
    refused(at, &with(&["a.png", "--terms", ""]), 2, "at least one");
    refused(at, &with(&["a.png", "--time", "NaN"]), 2, "seconds");
    let indirect = ["render", "--scene", "knife-edge", "-o", "a.png", "--terms", "indirect_airlight"];
    for technique in ["billeter-plv", "ray-march-16"] {
        let arguments = [&indirect[..], &["--technique", technique]].concat();
        refused(at, &arguments, 2, "can't draw indirect_airlight");
    }
    assert_eq!(at.read_dir().unwrap().count(), 0, "nothing is left behind");
}

#[test]
fn bad_scenes_are_refused_with_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("noise.glb"), [0xff, 0x00, 0x13, 0x37].repeat(100)).unwrap();
    std::fs::write(at.join("cut.json"), "{\"version\": 1, \"objects\": [").unwrap();
    std::fs::write(
        at.join("dark.json"),
        "{\"version\": 1, \"objects\": [{\"builtin\": \"empty\"}], \"lights\": []}",
    )
    .unwrap();
    std::fs::write(at.join("negative.json"), r#"{"version": 1, "medium": {"sigma_t": -1}}"#).unwrap();
    for (scene, expected) in [
        ("no-such-scene", "cathedral"),
        ("missing.obj", "missing.obj"),
        ("noise.glb", "noise.glb"),
        ("cut.json", "cut.json"),
        ("dark.json", "no light"),
        ("negative.json", "medium.sigma_t: [-1, -1, -1]; expected 0 or more"),
    ] {
        let arguments = ["render", "--scene", scene, "--technique", "reference", "-o", "a.png"];
        refused(at, &arguments, 2, expected);
    }
    assert!(!at.join("a.png").exists());
}

#[test]
fn the_reference_is_drawn_without_an_adapter() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let arguments = ["render", "--scene", "knife-edge", "--technique", "reference", "--size", "24x16", "-o"];
    let output = harness(at, &[&arguments[..], &["a.exr", "--terms", "airlight"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let picture = common::image::Image::read_exr(&at.join("a.exr")).unwrap();
    assert_eq!((picture.width, picture.height), (24, 16));
    assert!(picture.pixels.iter().any(|pixel| pixel.max_element() > 0.0));
    let output = harness(at, &[&arguments[..], &["a.png"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(at.join("a.png").exists());
    for (technique, file) in [("reference", "b.exr"), ("reference-unbounded", "c.exr")] {
        let arguments = ["render", "--scene", "knife-edge", "--technique", technique, "--size", "12x8"];
        let more = ["--terms", "indirect_airlight", "-o", file];
        let output = harness(at, &[&arguments[..], &more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stderr(&output).contains("of indirect_airlight"), "{}", stderr(&output));
    }
    assert_ne!(std::fs::read(at.join("b.exr")).unwrap(), std::fs::read(at.join("c.exr")).unwrap());
}

#[test]
fn a_technique_draws_what_the_reference_draws() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let draw = |technique: &str, file: &str| {
        let arguments =
            ["render", "--scene", "knife-edge", "--size", "48x32", "--terms", "airlight", "-o", file];
        let more = ["--technique", technique, "--shadow-map-size", "128"];
        let output = harness(at, &[&arguments[..], &more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        common::image::Image::read_exr(&at.join(file)).unwrap()
    };
    let reference = draw("reference", "reference.exr");
    // What is left is the shadow map's 128 texels on a side of each face.
    for technique in ["ray-march-equiangular-256", "billeter-plv-default", "billeter-plv-paper"] {
        let picture = draw(technique, "picture.exr");
        let error = common::metrics::compare(&picture, &reference).unwrap();
        assert!(error.rel_rmse < 0.02, "{technique}: {error:?}");
        assert_eq!(error.nan + error.inf + error.negative, 0, "{technique}");
        // The comparison can fail: the same picture turned about is far off.
        let turned = common::image::Image { pixels: picture.pixels.into_iter().rev().collect(), ..picture };
        assert!(common::metrics::compare(&turned, &reference).unwrap().rel_rmse > 0.1);
    }
    let surfaces =
        ["render", "--scene", "knife-edge", "--size", "48x32", "--terms", "surface", "-o", "surface.exr"];
    let output = harness(at, &[&surfaces[..], &["--technique", "ray-march-16"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
}

#[test]
fn a_cloud_is_drawn_by_what_draws_clouds_and_by_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let draw = |technique: &str, more: &[&str]| {
        let arguments = ["render", "--scene", "sphere", "--size", "32x24", "-o", "picture.exr"];
        let output = harness(at, &[&arguments[..], &["--technique", technique], more].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        common::image::Image::read_exr(&at.join("picture.exr")).unwrap()
    };
    let picture = draw("szk-network-2048x32", &[]);
    let reference = draw("reference", &["--terms", "airlight,multiple"]);
    let error = common::metrics::compare(&picture, &reference).unwrap();
    assert!(error.rel_rmse < 0.3 && error.bias.abs() < 0.1, "{error:?}");
    let other = ["render", "--size", "32x24", "-o", "other.exr", "--technique"];
    refused(
        at,
        &[&other[..], &["ray-march-16", "--scene", "sphere"]].concat(),
        2,
        "which only szk-network draws",
    );
    refused(at, &[&other[..], &["szk-network-512x32", "--scene", "knife-edge"]].concat(), 2, "has no cloud");
}

#[test]
fn a_comparison_leaves_a_whole_folder_and_spares_what_is_not_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let arguments = [
        "--scene",
        "knife-edge",
        "--technique",
        "ray-march-16",
        "--size",
        "32x24",
        "--frames",
        "2",
        "--output",
    ];
    let output = harness(at, &[&arguments[..], &["out/new"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(table.contains("ray-march-16") && table.contains("rel. RMSE"), "{table}");
    let run = at.join("out/new");
    for file in ["records.jsonl", "records.csv", "index.html", "images"] {
        assert!(run.join(file).exists(), "{file}");
    }
    let line = std::fs::read_to_string(run.join("records.jsonl")).unwrap();
    let record: serde_json::Value = serde_json::from_str(line.lines().next().unwrap()).unwrap();
    assert_eq!(record["schema"], 2);
    assert_eq!(record["width"], 32);
    assert_eq!(record["frames"], 2);
    assert!(record["error"]["rel_rmse"].is_f64() && record["technique_ms"]["p50"].is_f64());
    for picture in ["picture", "error_map", "reference", "airlight_exr"] {
        assert!(run.join(record["pictures"][picture].as_str().unwrap()).is_file(), "{picture}");
    }
    assert_eq!(at.join("out").read_dir().unwrap().count(), 1, "nothing but the run");

    // The page again, from the records alone.
    std::fs::remove_file(run.join("index.html")).unwrap();
    assert!(harness(at, &["report", "out/new"]).status.success());
    assert!(run.join("index.html").exists());

    // A failing run leaves the results of the one before; a folder of other things is not touched.
    refused(at, &[&arguments[..], &["out/new", "--scene", "missing.obj"]].concat(), 2, "missing.obj");
    assert!(run.join("records.jsonl").exists());
    std::fs::create_dir(at.join("mine")).unwrap();
    std::fs::write(at.join("mine/thesis.txt"), "years of work").unwrap();
    refused(at, &[&arguments[..], &["mine"]].concat(), 2, "other things");
    refused(at, &["papers", "chen", "--output", "mine"], 2, "other things");
    refused(at, &["targets", "--output", "mine"], 2, "other things");
    assert_eq!(at.join("mine").read_dir().unwrap().count(), 1);
    refused(at, &[&arguments[..], &["mine/thesis.txt"]].concat(), 2, "is a file");
    refused(at, &[&arguments[..], &["mine/thesis.txt/below"]].concat(), 2, "can't write results");
    refused(at, &["--scene", "empty", "--size", "60000x1"], 2, "can't be made");
    refused(at, &["--scene", "empty", "--shadow-map-size", "1"], 2, "shadow map");
    refused(at, &["--scene", "empty", "--shadow-map-size", "1000000"], 2, "shadow map");
    refused(at, &["--scene", "cathedral", "--triangles", "7"], 2, "triangles");
    assert!(!at.join("results/latest").exists());
}

#[test]
fn a_run_in_which_nothing_can_be_drawn_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--scene", "knife-edge", "--only", "szk-network", "--size", "8x8", "--output", "run"];
    let output = harness(folder.path(), &arguments);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("nothing was measured") && !text.contains("--resume"), "{text}");
    assert_eq!(folder.path().read_dir().unwrap().count(), 0);
}

#[test]
fn a_run_does_not_go_on_with_an_edited_scene() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scene = |sigma_s: f32| {
        let text = format!(
            r#"{{"version": 1, "objects": [{{"builtin": "knife-edge"}}], "medium": {{"sigma_s": {sigma_s}}}}}"#
        );
        std::fs::write(at.join("fog.json"), text).unwrap();
    };
    let arguments =
        ["--scene", "fog.json", "--only", "ray-march-8", "--size", "8x8", "--frames", "1", "--output"];
    scene(0.1);
    let first = harness(at, &[&arguments[..], &["first"]].concat());
    assert!(first.status.success(), "{}", stderr(&first));
    std::fs::rename(at.join("first"), at.join("second.partial-1")).unwrap();
    scene(0.2);
    let resume = [&arguments[..], &["second", "--resume"]].concat();
    refused(at, &resume, 2, "fog.json has changed since then");
    scene(0.1);
    let second = harness(at, &resume);
    assert!(second.status.success(), "{}", stderr(&second));
}

#[test]
fn a_run_that_was_stopped_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let common =
        ["--scene", "knife-edge", "--size", "32x24", "--only", "ray-march-16@64", "--only", "ray-march-8"];
    let first = harness(at, &[&common[..], &["--frames", "2", "--output", "first"]].concat());
    assert!(first.status.success(), "{}", stderr(&first));
    // As if it had been killed while it wrote its second record.
    let stopped = at.join("second.partial-1");
    std::fs::rename(at.join("first"), &stopped).unwrap();
    let both = std::fs::read_to_string(stopped.join("records.jsonl")).unwrap();
    let taken = &both[..=both.find('\n').unwrap()];
    std::fs::write(stopped.join("records.jsonl"), &both[..taken.len() + taken.len() / 2]).unwrap();
    // Not with what another run would be.
    let other = ["--frames", "3", "--output", "second", "--resume"];
    refused(at, &[&common[..], &other].concat(), 2, "give the same options");
    let more = ["--frames", "2", "--output", "second", "--resume"];
    let second = harness(at, &[&common[..], &more].concat());
    assert!(second.status.success(), "{}", stderr(&second));
    let records = std::fs::read_to_string(at.join("second/records.jsonl")).unwrap();
    assert!(records.starts_with(taken), "what was measured stays as it was");
    let names: Vec<serde_json::Value> = records
        .lines()
        .map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()["name"].clone())
        .collect();
    assert_eq!(names, ["ray-march-16@64", "ray-march-8"]);
    assert_eq!(at.read_dir().unwrap().count(), 1, "nothing but the run");
    refused(at, &[&common[..], &more].concat(), 2, "no run into second that was stopped");
}

#[test]
fn the_results_of_a_paper_are_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let output = harness(at, &["papers", "biri", "--size", "64x48", "--frames", "1", "--output", "out"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let text = std::fs::read_to_string(at.join("out/table-2.json")).unwrap();
    let table: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&table["schema"], &table["width"]), (&1.into(), &64.into()));
    let rows = table["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    for row in rows {
        assert!(row["measured"][1]["fps"].as_f64().unwrap() > 0.0, "{row}");
        assert!(row["silhouette_edges"].as_f64().unwrap() > 0.0, "{row}");
    }
    // Every file that the page shows is there, and nothing else.
    assert_eq!(shown_files(&at.join("out")), 6);
    assert_eq!(at.join("out").read_dir().unwrap().count(), 6 + 4 + 2);
    assert_eq!(judged(&at.join("out")), 8);
    std::fs::write(at.join("file"), "years of work").unwrap();
    refused(at, &["papers", "biri", "--output", "file"], 2, "can't write results");
}

/// Every claim of a paper has a measurement and a verdict; gives how many there are.
fn judged(folder: &Path) -> usize {
    let text = std::fs::read_to_string(folder.join("claims.json")).unwrap();
    let claims: serde_json::Value = serde_json::from_str(&text).unwrap();
    let claims = claims["claims"].as_array().unwrap();
    for claim in claims {
        let measured = claim["measured"].as_str().unwrap();
        assert!(!measured.is_empty() && !measured.contains("NaN"), "{claim}");
        assert!(claim["verdict"].is_string(), "{claim}");
    }
    claims.len()
}

/// Every file that a paper's page shows is there; gives how many there are.
fn shown_files(folder: &Path) -> usize {
    let page = std::fs::read_to_string(folder.join("index.md")).unwrap();
    let shown: Vec<&str> = page.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect();
    for file in &shown {
        assert!(folder.join(file).is_file(), "{file}");
    }
    shown.len()
}

#[test]
fn the_results_of_the_sampling_planes_are_made_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let output = harness(at, &["papers", "chen", "--size", "16x12", "--frames", "1", "--output", "out"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let read = |name: &str| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(at.join("out").join(name)).unwrap()).unwrap()
    };
    let table = read("table-1.json");
    assert_eq!((&table["schema"], &table["width"]), (&1.into(), &16.into()));
    let rows = table["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 7);
    for row in rows {
        for setting in ["paper", "default"] {
            assert!(row[setting]["fps"].as_f64().unwrap() > 0.0, "{row}");
            assert!(row[setting]["rel_rmse"].as_f64().unwrap() < 1.0, "{row}");
        }
    }
    let claims = read("claims.json");
    assert_eq!(claims["claims"].as_array().unwrap().len(), 7);
    assert_eq!(claims["series"].as_array().unwrap().len(), 5);
    assert_eq!(read("convergence.json")["scenes"].as_array().unwrap().len(), 3);
    // Formulas that are exact, whatever the size.
    for band in read("banding.json")["bands"].as_array().unwrap() {
        let number = |name: &str, at: usize| band[name][at].as_f64().unwrap();
        for i in 0..2 {
            assert!((number("measured", i) - number("formula", i)).abs() < 0.02, "{band}");
            assert!(number("default", i).abs() < 0.002, "{band}");
        }
    }
    let shown = shown_files(&at.join("out"));
    assert_eq!(shown, 4 + 8 + 2);
    assert_eq!(at.join("out").read_dir().unwrap().count(), shown + 4 + 3 + 1, "and numbers, and texts");
}

#[test]
fn surfaces_of_the_shadow_planes_are_the_references() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let draw = |technique: &str| {
        let file = format!("{technique}.exr");
        let scene = ["render", "--scene", "knife-edge", "--size", "48x32", "--terms", "surface", "-o"];
        let output = harness(at, &[&scene[..], &[&file, "--technique", technique]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        common::image::Image::read_exr(&at.join(file)).unwrap()
    };
    let error = common::metrics::compare(&draw("biri-ss-default"), &draw("reference")).unwrap();
    assert!(error.rel_rmse < 0.02, "{error:?}");
}

#[test]
fn an_unknown_adapter_is_named() {
    let folder = tempfile::tempdir().unwrap();
    refused(folder.path(), &["--adapter", "no such thing"], 2, "no such thing");
    assert_eq!(folder.path().read_dir().unwrap().count(), 0);
}

#[test]
fn settings_that_do_not_fit_are_refused_and_an_empty_scene_is_noted() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for (name, settings) in [
        ("lights", r#"{"technique": "biri-ss", "model": {"lights": ["shadowed", "shadowed", "shadowed"]}}"#),
        ("maps", r#"{"technique": "chen-planes", "shadow_map_size": 64}"#),
        (
            "table",
            r#"{"technique": "biri-ss", "options": {"airlight": {"gamma": {"width": 1, "height": 8, "format": "f32"}}}}"#,
        ),
    ] {
        std::fs::write(at.join(format!("{name}.json")), settings).unwrap();
    }
    let render = ["render", "--scene", "empty", "--size", "16x16", "-o", "a.png", "--settings"];
    let with = |rest: &[&'static str]| [&render[..], rest].concat();
    refused(at, &with(&["lights.json"]), 2, "lights.json: the model says what to do with 3 lights");
    refused(at, &with(&["maps.json", "--shadow-map-size", "32"]), 2, "maps.json has shadow maps of 64²");
    refused(at, &with(&["table.json"]), 2, "table.json");
    let light = r#"{"point": {"position": [0, 1, 0], "intensity": 1}}"#;
    std::fs::write(at.join("bare.json"), format!(r#"{{"version": 1, "objects": [], "lights": [{light}]}}"#))
        .unwrap();
    let drawn = harness(
        at,
        &["render", "--scene", "bare.json", "--technique", "reference", "--size", "8x8", "-o", "a.png"],
    );
    assert!(drawn.status.success() && stderr(&drawn).contains("there is no object"), "{}", stderr(&drawn));
}

/// A machine without a display gets a sentence, not a panic.
#[cfg(target_os = "linux")]
#[test]
fn without_a_display_the_sentence_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_harness"))
        .current_dir(folder.path())
        .args(["view", "--scene", "empty"])
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("needs a display") && text.contains("harness render"), "{text}");
    assert!(text.trim().lines().count() == 1 && !text.contains("panicked"), "{text}");
    assert!(output.stdout.is_empty());
}

/// An empty list of drivers is as good as none installed.
#[cfg(target_os = "linux")]
#[test]
fn without_an_adapter_the_sentence_says_what_to_install() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_harness"))
        .current_dir(folder.path())
        .env_remove("VK_ADD_DRIVER_FILES")
        .env("VK_DRIVER_FILES", "/nowhere.json")
        .env("VK_ICD_FILENAMES", "/nowhere.json")
        .output()
        .unwrap();
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("mesa-vulkan-drivers") && !text.contains("panicked"), "{text}");
    assert_eq!(folder.path().read_dir().unwrap().count(), 0);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_records_and_the_earlier_results() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::create_dir(at.join("run")).unwrap();
    std::fs::write(at.join("run/records.jsonl"), "earlier").unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_harness"))
        .current_dir(at)
        .args(["--scene", "knife-edge", "--technique", "ray-march-16", "--technique", "ray-march-64"])
        .args(["--size", "16x16", "--frames", "100000", "--output", "run"])
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // Once a measurement is under way there is a folder with a reference picture in it.
    let measuring = || {
        let mut entries = at.read_dir().unwrap().flatten();
        entries.any(|entry| entry.path().join("images/1-knife-edge-reference.png").exists())
    };
    let started = std::time::Instant::now();
    while !measuring() && started.elapsed().as_secs() < 120 {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let killed = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let mut text = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut text).unwrap();
    assert!(text.contains("stopped") && !text.contains("panicked"), "{text}");
    assert_eq!(std::fs::read_to_string(at.join("run/records.jsonl")).unwrap(), "earlier");
}
