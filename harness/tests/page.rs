//! The page in a browser: the one that `HARNESS_BROWSER` names, or a Chromium on the path. Where there is none, the
//! test says so and checks nothing. `HARNESS_SCREENSHOTS` names a folder for pictures of the page.

#![recursion_limit = "256"]

mod browser;

use std::io::Write;
use std::path::Path;
use std::process::Command;

use browser::Browser;
use serde_json::{Value, json};

/// A record as a run writes it.
fn record(technique: &str, preset: &str, steps: u32, milliseconds: f64, error: f64) -> Value {
    let spread = json!({"p50": milliseconds, "p95": 1.02 * milliseconds, "max": 1.1 * milliseconds});
    let name =
        if preset == "sweep" { format!("{technique}-{steps}") } else { format!("{technique}-{preset}") };
    let label = if preset == "sweep" { format!("{steps} steps") } else { preset.to_owned() };
    json!({
        "schema": 2, "study": "main", "date": "2025-01-31T12:00:00Z", "commit": "0123456789ab",
        "machine": {"cpu": "a processor", "cores": 2, "os": "an operating system"},
        "adapter": "llvmpipe", "driver": "Mesa", "software": true, "scene": "room", "triangles": 12, "lights": 1,
        "light_kinds": ["point"], "name": name, "technique": technique, "peer": preset == "sweep", "preset": preset,
        "label": label, "settings": {"steps": steps, "shadow_map_size": 512}, "terms": ["airlight"], "width": 64,
        "height": 48, "frames": 3, "warm_up": 1, "moving": "the camera", "technique_ms": spread,
        "technique_ms_from": "timestamps", "technique_wall_ms": spread, "passes": {"a: draw": spread},
        "ground_passes": {"common: draw": spread}, "cpu_ms": spread, "frame_ms": spread,
        "samples_ms": {"technique": [], "technique_wall": [], "cpu": [], "frame": []},
        "gpu_bytes": 1000, "silhouette_edges": null, "model_error": null, "bound": null, "refused": null,
        "error": {"rel_rmse": error, "bias": 0.0, "p99": error, "max": error, "worst_tile": 2.0 * error, "leak": 0.0,
            "flip": error, "nan": 0, "inf": 0, "negative": 0, "energy_ratio": 1.0},
        "reference": {"terms": ["airlight"], "uncertainty": 1e-5, "seconds": 1.0, "cached": false},
        "pictures": {"picture": format!("{name}.png"), "airlight_exr": "", "error_map": "",
            "reference": "reference.png", "reference_airlight_exr": "", "exposure": 1.0},
        "notes": [], "not_known_yet": true
    })
}

/// A run's folder without a GPU, one of its pictures missing.
fn run(folder: &Path) {
    let records: Vec<Value> = [(8, 1.0, 0.4), (16, 2.0, 0.2), (32, 4.0, 0.1), (64, 8.0, 0.05)]
        .map(|(steps, time, error)| record("ray-march", "sweep", steps, time, error))
        .into_iter()
        .chain([record("biri-ss", "paper", 0, 6.0, 0.03), record("biri-ss", "default", 0, 5.0, 0.004)])
        .collect();
    let lines: String = records.iter().map(|record| format!("{record}\n")).collect();
    std::fs::write(folder.join("records.jsonl"), lines).unwrap();
    let picture = |shade: u8| {
        image::RgbImage::from_fn(64, 48, |x, y| image::Rgb([(3 * x) as u8, (4 * y) as u8, shade]))
    };
    picture(0).save(folder.join("reference.png")).unwrap();
    for (index, record) in records.iter().enumerate().skip(1) {
        let file = folder.join(record["pictures"]["picture"].as_str().unwrap());
        picture(40 * index as u8).save(file).unwrap();
    }
}

#[test]
fn the_page_does_what_it_says() {
    let Some(mut browser) = Browser::start() else {
        // Past the test's capture: a check that was not made is to be seen.
        let note =
            b"SKIPPED: the page in a browser; name one by HARNESS_BROWSER, or put chromium on the path\n";
        std::io::stderr().write_all(note).unwrap();
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    run(folder.path());
    let status = Command::new(env!("CARGO_BIN_EXE_harness"))
        .args(["report", folder.path().to_str().unwrap()])
        .output()
        .unwrap();
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stderr));
    browser.resize(1280, 900);
    browser.open(&folder.path().join("index.html"));

    // The card: by pointing and by focus.
    let hit = ".wide .hit[data-point=\"2\"]";
    assert!(browser.is("document.getElementById('card').hidden"));
    browser.hover(hit);
    assert!(browser.is("!document.getElementById('card').hidden"), "a card where the pointer is");
    let card = browser.text("document.getElementById('card').textContent");
    for wanted in ["ray-march", "32 steps", "4.00 ms", "10.0 %", "steps = 32"] {
        assert!(card.contains(wanted), "{wanted}: {card}");
    }
    assert!(browser.is("document.querySelector('#card img').naturalWidth === 64"));
    browser.hover("h1");
    assert!(browser.is("document.getElementById('card').hidden"));
    browser.evaluate("document.querySelector('.wide .hit[data-point=\"0\"]').focus()");
    let card = browser.text("document.getElementById('card').textContent");
    assert!(card.contains("8 steps"), "{card}");
    assert!(browser.is("document.querySelector('#card img') === null"), "the picture that is missing");

    // By keyboard to a chart out of sight: the card is there when the mark has scrolled into view.
    browser.resize(1280, 300);
    browser.evaluate("window.scrollTo(0, 5000)");
    browser.evaluate("document.querySelector('.wide .hit[data-point=\"3\"]').focus()");
    browser
        .wait_for("document.querySelector('.wide .hit[data-point=\"3\"]').getBoundingClientRect().top < 300");
    browser.evaluate("new Promise(done => setTimeout(done, 500))");
    assert!(browser.is("!document.getElementById('card').hidden"), "the card stays");
    browser.resize(1280, 900);
    browser.evaluate("window.scrollTo(0, 0)");

    // Two pictures: chosen in the chart and below it, compared by a divide and a difference.
    browser.click(hit);
    browser.evaluate("document.querySelector('.pick[data-point=\"3\"]').click()");
    browser.wait_for("document.querySelector('.viewer').dataset.ready === 'true'");
    assert!(browser.text("document.querySelector('.viewer .left').textContent").contains("32 steps"));
    assert!(browser.text("document.querySelector('.viewer .right').textContent").contains("64 steps"));
    assert!(browser.is("document.querySelectorAll('.pick[aria-pressed=true]').length === 2"));
    // Blue differs by 40 codes everywhere.
    let difference = browser.text("document.querySelector('.difference').textContent");
    assert!(difference.contains("mean 40.00, largest 40"), "{difference}");
    let middle = "Array.from(document.querySelector('.viewer canvas').getContext('2d').getImageData(32, 24, 1, 1).data)";
    let pixel = browser.evaluate(middle);
    assert_eq!(pixel[3], 255);
    assert!(pixel[0].as_u64().unwrap() > 60, "the middle of the scale, not its black: {pixel}");
    let divide = "document.querySelector('.viewer').style.getPropertyValue('--divide')";
    assert_eq!(browser.text(divide), "50%");
    browser.evaluate("document.querySelector('.stage input').focus()");
    browser.key("ArrowRight", 39);
    assert_eq!(browser.text(divide), "50.1%");
    let stage = browser
        .evaluate("document.querySelector('.stage').scrollIntoView({block: 'center', behavior: 'instant'})");
    assert!(stage.is_null());
    browser.click_at(".stage", 0.25);
    let share: f64 = browser.text(divide).trim_end_matches('%').parse().unwrap();
    assert!((share - 25.0).abs() < 3.0, "{share}");

    // Tables: by number, both ways.
    let table =
        "[...document.querySelectorAll('table')].find(t => t.caption.textContent.startsWith('Everything'))";
    let times = format!("[...{table}.tBodies[0].rows].map(row => Number(row.cells[2].dataset.key))");
    assert_eq!(browser.evaluate(&times), json!([1, 2, 4, 8, 6, 5]));
    let sort = format!("{table}.querySelectorAll('.sort')[2].click()");
    browser.evaluate(&sort);
    assert_eq!(browser.evaluate(&times), json!([1, 2, 4, 5, 6, 8]));
    browser.evaluate(&sort);
    assert_eq!(browser.evaluate(&times), json!([8, 6, 5, 4, 2, 1]));

    // Nothing wider than the window, on a desk and on a telephone.
    for (name, width, dark) in
        [("desk", 1280, false), ("desk-dark", 1280, true), ("phone", 420, false), ("phone-dark", 420, true)]
    {
        browser.resize(width, 900);
        browser.dark(dark);
        assert!(
            browser.is(&format!("document.documentElement.scrollWidth <= {width}")),
            "{name}: {}",
            browser.evaluate("document.documentElement.scrollWidth")
        );
        let shown = browser.text(
            "['wide', 'narrow'].filter(name => document.querySelector('.' + name).getClientRects().length).join()",
        );
        assert_eq!(shown, if width > 700 { "wide" } else { "narrow" });
        browser.screenshot(name);
    }
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

fn harness(arguments: &[&Path]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_harness")).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_readme_gets_its_tables_and_twice_is_once() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path());
    let readme = folder.path().join("README.md");
    let arguments = [Path::new("report"), folder.path(), Path::new("--readme"), &readme];
    std::fs::write(&readme, "no markers").unwrap();
    let (code, _, error) = harness(&arguments);
    assert!(code == 2 && error.contains("<!-- harness:equal-error -->"), "{code} {error}");
    assert!(!folder.path().join("index.html").exists(), "nothing is written");
    let name = |name: &str| format!("<!-- harness:{name} -->\nold\n<!-- /harness:{name} -->\n");
    let text = format!("# Fog\n{}{}{}end\n", name("equal-error"), name("winners"), name("presets"));
    std::fs::write(&readme, text).unwrap();
    assert_eq!(harness(&arguments).0, 0);
    let once = std::fs::read_to_string(&readme).unwrap();
    for wanted in [
        "# Fog\n",
        "| biri-ss",
        "- at most 2 %: **biri-ss** (default in 5.00 ms)",
        "dominates the paper's",
        "end\n",
    ] {
        assert!(once.contains(wanted), "{wanted}: {once}");
    }
    assert!(!once.contains("old\n"));
    assert_eq!(harness(&arguments).0, 0);
    assert_eq!(std::fs::read_to_string(&readme).unwrap(), once);
}

#[test]
fn runs_are_merged_and_compared() {
    let place = tempfile::tempdir().unwrap();
    let [old, new, both] = ["old", "new", "both"].map(|name| place.path().join(name));
    for folder in [&old, &new] {
        std::fs::create_dir(folder).unwrap();
        run(folder);
    }
    let compare = [Path::new("compare"), &old, &new];
    let (code, text, _) = harness(&compare);
    assert!(code == 0 && text.contains("6 compared, 6 alike"), "{code} {text}");
    // One got slower, and the last line was cut off on the way.
    let path = new.join("records.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let text = text.replace("\"p50\":4.0", "\"p50\":6.0").replace("\"p95\":4.08", "\"p95\":6.12");
    std::fs::write(&path, &text[..text.len() - 20]).unwrap();
    let (code, text, error) = harness(&compare);
    assert!(code == 1 && error.contains("1 of 5 got slower or worse"), "{code} {error}");
    for wanted in ["slower: 1", "ray-march-32", "+50.0 %", "missing: 1", "line 6 is cut off"] {
        assert!(text.contains(wanted), "{wanted}: {text}");
    }
    let (code, _, error) = harness(&[Path::new("report"), &old, &new]);
    assert!(code == 2 && error.contains("-o"), "{error}");
    let (code, text, _) = harness(&[Path::new("report"), &old, &new, Path::new("-o"), &both]);
    assert!(code == 0 && text.contains("measured twice") && text.contains("line 6 is cut off"), "{text}");
    let page = std::fs::read_to_string(both.join("index.html")).unwrap();
    assert!(page.contains("SOFTWARE ADAPTER") && page.len() < 1 << 20);
    // What was merged is kept, may be merged and reported again, and takes no other run's place.
    let merged = || std::fs::read_to_string(both.join("records.jsonl")).unwrap();
    let kept = merged();
    assert_eq!(kept.lines().count(), 6);
    assert!(harness(&[Path::new("report"), &both]).0 == 0);
    assert!(harness(&[Path::new("report"), &old, &new, Path::new("-o"), &both]).0 == 0);
    assert_eq!(merged(), kept);
    let (code, _, error) = harness(&[Path::new("report"), &new, Path::new("-o"), &both]);
    assert!(code == 2 && error.contains("holds 1 measurements"), "{error}");
    let mine = place.path().join("mine");
    std::fs::create_dir(&mine).unwrap();
    std::fs::write(mine.join("index.html"), "years of work").unwrap();
    let (code, _, error) = harness(&[Path::new("report"), &new, Path::new("-o"), &mine]);
    assert!(code == 2 && error.contains("other things"), "{error}");
    assert_eq!(std::fs::read_to_string(mine.join("index.html")).unwrap(), "years of work");
    let (code, _, error) = harness(&[Path::new("report"), &old, &new, Path::new("-o"), &old]);
    assert!(code == 2 && error.contains("one of the runs"), "{error}");
    assert_eq!(merged(), kept);
}

#[test]
fn a_page_that_complains_is_noticed() {
    let Some(mut browser) = Browser::start() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = folder.path().join("a.html");
    std::fs::write(&page, "<script>console.error('one'); missing();</script><img src=\"gone.png\">").unwrap();
    browser.open(&page);
    assert!(browser.complaints().len() >= 2, "{:?}", browser.complaints());
}
