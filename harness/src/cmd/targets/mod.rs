//! `harness targets`: what is promised of the techniques, measured in one run.

mod billeter;
mod biri;
mod biri_bench;
mod chen;
mod szk;

use std::path::Path;

use common::image::Image;
use serde::Serialize;

use crate::cli::{Ground, Promised, Targets};
use crate::cmd::{load, open};
use crate::failure::Failure;
use crate::machine::{self, Machine};
use crate::measure::check_size;
use crate::output::{check_replaceable, make_writable, write_text};
use crate::progress::Progress;
use crate::report::markdown;

/// Version of `targets.json`, described in results/README.md.
const SCHEMA: u32 = 4;

/// Files in the output folder.
const FILES: [&str; 2] = ["targets.json", "targets.md"];

/// A promise and what was measured of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Target {
    technique: &'static str,
    target: String,
    at_most: f64,
    measured: f64,
    /// The measured value as the table shows it.
    text: String,
    holds: bool,
}

impl Target {
    fn new(technique: &'static str, target: String, at_most: f64, measured: f64, text: String) -> Self {
        // Not so for NaN.
        Self { technique, target, at_most, measured, text, holds: measured <= at_most }
    }

    /// Something that is to happen in no picture.
    fn none(technique: &'static str, target: &str, counts: Vec<usize>) -> Self {
        // Of no picture at all nothing is known.
        let total = if counts.is_empty() { f64::NAN } else { counts.iter().sum::<usize>() as f64 };
        Self::new(technique, target.into(), 0.0, total, format!("{total} in {} pictures", counts.len()))
    }
}

/// Pixels that are NaN, infinite or negative.
fn broken(image: &Image) -> usize {
    image.pixels.iter().filter(|pixel| !pixel.is_finite() || pixel.min_element() < 0.0).count()
}

/// Pixels that differ in any bit.
fn unsteady(image: &Image, again: &Image) -> usize {
    let bits = |image: &Image| -> Vec<[u32; 3]> {
        image.pixels.iter().map(|pixel| pixel.to_array().map(f32::to_bits)).collect()
    };
    bits(image).iter().zip(&bits(again)).filter(|(a, b)| a != b).count()
}

/// What is written to `targets.json`.
#[derive(Serialize)]
struct Report<'a> {
    schema: u32,
    date: String,
    commit: String,
    machine: Machine,
    adapter: &'a str,
    driver: &'a str,
    software: bool,
    width: u32,
    height: u32,
    targets: &'a [Target],
    /// Of billeter-plv; empty where it was not measured.
    shots: &'a [billeter::Shot],
    /// Of biri-ss; null where it was not measured.
    shadow_planes: Option<&'a biri::Measured>,
    /// Of chen-planes; empty where it was not measured.
    sampling_planes: &'a [chen::Shot],
    /// Of szk-network; null where it was not measured.
    networks: Option<&'a szk::Measured>,
}

/// Measures, prints and writes; gives what to print, or a failure if a promise does not hold.
pub(crate) fn run(arguments: &Targets) -> Result<String, Failure> {
    // What can be wrong with the command line, before any work.
    if let Some(name) = &arguments.sibenik {
        load(name, None, |_| ())?;
    }
    check_replaceable(&arguments.output, &FILES)?;
    make_writable(&arguments.output)?;
    let ground = Ground { triangles: None, shadow_map_size: None, adapter: arguments.adapter.clone() };
    let context = open(&ground)?;
    check_size(&context, arguments.size)?;
    let wanted = |technique| arguments.techniques.is_empty() || arguments.techniques.contains(&technique);
    let (of_billeter, of_biri) = (wanted(Promised::BilleterPlv), wanted(Promised::BiriSs));
    let (of_chen, of_szk) = (wanted(Promised::ChenPlanes), wanted(Promised::SzkNetwork));
    let steps = |wanted, steps| if wanted { steps } else { 0 };
    let all = [
        (of_billeter, billeter::STEPS),
        (of_biri, biri_bench::STEPS),
        (of_chen, chen::STEPS),
        (of_szk, szk::STEPS),
    ];
    let progress = Progress::new(all.into_iter().map(|(wanted, number)| steps(wanted, number)).sum());
    progress.say(&format!("adapter: {} ({})", context.adapter, context.driver));

    let mut targets = Vec::new();
    let mut shots = Vec::new();
    if of_billeter {
        shots = billeter::Bench { context: &context, size: arguments.size, progress: &progress }.shots()?;
        targets.extend(billeter::targets(&shots));
    }
    let mut shadow_planes = None;
    if of_biri {
        let sibenik = arguments.sibenik.as_deref();
        let bench =
            biri_bench::Bench { context: &context, size: arguments.size, progress: &progress, sibenik };
        let measured = bench.measure()?;
        targets.extend(biri::targets(&measured));
        shadow_planes = Some(measured);
    }
    let mut sampling_planes = Vec::new();
    if of_chen {
        sampling_planes =
            chen::Bench { context: &context, size: arguments.size, progress: &progress }.shots()?;
        targets.extend(chen::targets(&sampling_planes));
    }
    let mut networks = None;
    if of_szk {
        let bench = szk::Bench { context: &context, size: arguments.size, progress: &progress };
        let measured = bench.measure()?;
        targets.extend(szk::targets(&measured));
        networks = Some(measured);
    }
    drop(progress);
    let report = Report {
        schema: SCHEMA,
        date: machine::now(),
        commit: machine::commit(),
        machine: Machine::this(),
        adapter: &context.adapter,
        driver: &context.driver,
        software: context.software,
        width: arguments.size.0,
        height: arguments.size.1,
        targets: &targets,
        shots: &shots,
        shadow_planes: shadow_planes.as_ref(),
        sampling_planes: &sampling_planes,
        networks: networks.as_ref(),
    };
    let json = serde_json::to_string_pretty(&report).map_err(|error| Failure::Run(error.to_string()))?;
    let text = markdown(&report);
    for (name, content) in FILES.iter().zip([json, text.clone()]) {
        write_text(&arguments.output, name, &content)?;
    }
    let missed = targets.iter().filter(|target| !target.holds).count();
    let written = format!("{text}\nwrote {}\n", FILES.map(|f| path(&arguments.output, f)).join(", "));
    if missed == 0 {
        return Ok(written);
    }
    crate::print(&written);
    Err(Failure::Run(format!("{missed} of {} targets missed", targets.len())))
}

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

/// The tables as Markdown.
fn markdown(report: &Report<'_>) -> String {
    let mut text = format!(
        "# Targets\n\n{}x{}, {} ({}), commit {}, {}\n",
        report.width, report.height, report.adapter, report.driver, report.commit, report.date
    );
    for technique in ["billeter-plv", "biri-ss", "chen-planes", "szk-network"] {
        let mut rows = vec![["target", "measured", "holds"].map(str::to_owned).to_vec()];
        for target in report.targets.iter().filter(|target| target.technique == technique) {
            let holds = if target.holds { "yes" } else { "NO" };
            rows.push(vec![target.target.clone(), target.text.clone(), holds.into()]);
        }
        if rows.len() > 1 {
            text += &format!("\n## {technique}\n\n{}", markdown::table(&rows));
        }
    }
    text
}
