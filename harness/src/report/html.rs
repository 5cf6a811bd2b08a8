//! The page: one HTML file that needs nothing beside it.

use serde_json::json;

use crate::falsecolor;
use crate::record::Record;
use crate::report::looks::Looks;
use crate::report::methodology::{BIAS, DEFINITIONS, METHODOLOGY, Note};
use crate::report::pictures::Album;
use crate::report::sections::{self, Section};
use crate::report::sources::Case;
use crate::report::table::SOFTWARE;
use crate::report::{Report, YARDSTICK, papers, scaling};

/// Nothing may be fetched from anywhere.
const POLICY: &str =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// The whole page; `raw` are names of files beside it that hold the figures.
pub(crate) fn page(
    report: &Report,
    cases: &[Case<'_>],
    looks: &Looks<'_>,
    album: &Album,
    raw: &[&str],
) -> Result<String, String> {
    let sections = (0..)
        .zip(cases)
        .map(|(index, case)| sections::case(index, case, cases, looks, album))
        .collect::<Result<Vec<Section>, String>>()?;
    let records = &report.sources.records;
    let mut body = head(report, cases, raw);
    for section in &sections {
        body += &section.html;
    }
    let scalings = scaling::scalings(records);
    body += &sections::scaling(&scalings, looks)?;
    body += &sections::passes(cases);
    body += &sections::model_errors(cases, looks)?;
    body += &papers_section(report, album);
    body += &notes("methodology", "How it was measured", METHODOLOGY);
    body += &notes("bias", "Whom that favours", BIAS);
    body += &notes("definitions", "What the figures are", DEFINITIONS);
    let scale: Vec<[u8; 3]> = (0..64u8).map(|step| falsecolor::colour(f32::from(step) / 63.0)).collect();
    let data = json!({
        "pictures": album.uris(),
        "cases": sections.iter().map(|section| &section.data).collect::<Vec<_>>(),
        "scale": scale,
    });
    // In a script, only `<` could end it.
    let data = data.to_string().replace('<', "\\u003c");
    let (style, script) = (include_str!("style.css"), include_str!("page.js"));
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>Light in fog: measurements</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n\
         <style>\n{style}</style>\n</head>\n<body>\n<main>\n{body}</main>\n<div id=\"card\" role=\"status\" hidden></div>\n\
         <script id=\"data\" type=\"application/json\">{data}</script>\n<script>\n{script}</script>\n</body>\n</html>\n"
    ))
}

/// Title, what it was measured on, what went wrong, and the way around.
fn head(report: &Report, cases: &[Case<'_>], raw: &[&str]) -> String {
    let records = &report.sources.records;
    let mut text = String::from("<header>\n<h1>Light in fog: error against time</h1>\n");
    for adapter in report.sources.adapters() {
        let of: Vec<&Record> = records.iter().filter(|record| record.adapter == adapter).collect();
        let Some(first) = of.first() else { continue };
        if first.software {
            text += "<p class=\"software\">SOFTWARE ADAPTER</p>\n";
        }
        text += &format!("<p class=\"label\">{}</p>\n", escaped(&label(&of)));
        if first.software {
            text += &format!(
                "<p class=\"note\">{SOFTWARE} “÷ 64 steps” is the time relative to <code>{YARDSTICK}</code>.</p>\n"
            );
        }
    }
    let wrong: Vec<String> = records
        .iter()
        .filter_map(|r| r.problem().map(|problem| format!("{}, {}: {problem}", r.scene, r.name)))
        .collect();
    if !wrong.is_empty() {
        text += &format!(
            "<p class=\"wrong\"><strong>Wrong pictures.</strong> {}</p>\n",
            escaped(&wrong.join("; "))
        );
    }
    let link =
        |case: &Case<'_>, index| format!("<a href=\"#case-{index}\">{}</a>", escaped(&case.title(cases)));
    let mut links: Vec<String> = (0..).zip(cases).map(|(index, case)| link(case, index)).collect();
    let rest = [
        ("scaling", "Scaling", !scaling::scalings(records).is_empty()),
        ("passes", "Time by pass", true),
        (
            "model",
            "Model error",
            cases.iter().any(|case| !crate::report::passes::with_model_error(case).is_empty()),
        ),
        ("papers", "Papers", !report.papers.is_empty()),
        ("methodology", "Methodology", true),
        ("bias", "Bias", true),
    ];
    links.extend(
        rest.iter()
            .filter(|(_, _, there)| *there)
            .map(|(id, name, _)| format!("<a href=\"#{id}\">{name}</a>")),
    );
    links.extend(raw.iter().map(|file| format!("<a href=\"{file}\">{file}</a>")));
    text += &format!("<nav>{}</nav>\n", links.join("\n"));
    if !report.sources.notes.is_empty() {
        let notes: String =
            report.sources.notes.iter().map(|note| format!("<li>{}</li>\n", escaped(note))).collect();
        text += &format!(
            "<details class=\"note\"><summary>{} notes on reading the records</summary><ul>{notes}</ul></details>\n",
            report.sources.notes.len()
        );
    }
    text + "</header>\n"
}

/// One line on where and when an adapter's records were taken.
fn label(records: &[&Record]) -> String {
    let Some(first) = records.first() else { return String::new() };
    let distinct = |value: &dyn Fn(&Record) -> String| {
        let mut all: Vec<String> = records.iter().map(|record| value(record)).collect();
        all.sort();
        all.dedup();
        all.join(", ")
    };
    let day = |record: &Record| record.date.split('T').next().unwrap_or_default().to_owned();
    let frames = |record: &&&Record| record.refused.is_none();
    let most = records.iter().filter(frames).map(|record| record.frames).max().unwrap_or(0);
    let least = records.iter().filter(frames).map(|record| record.frames).min().unwrap_or(0);
    let frames = if least == most { format!("{most}") } else { format!("{least} to {most}") };
    format!(
        "{} ({}) · {}, {} cores, {} · commit {} · {} · {frames} timed frames after {} of warm-up",
        first.adapter,
        first.driver,
        first.machine.cpu,
        first.machine.cores,
        first.machine.os,
        distinct(&|record| record.commit.clone()),
        distinct(&day),
        distinct(&|record| record.warm_up.to_string()),
    )
}

fn papers_section(report: &Report, album: &Album) -> String {
    if report.papers.is_empty() {
        return String::new();
    }
    let mut text = String::from("<section id=\"papers\">\n<h2>Papers</h2>\n");
    let claims = papers::claims(&report.papers);
    if !claims.rows.is_empty() {
        text += &format!("<div class=\"prose\">{}</div>\n", claims.html("Claims of the papers"));
    }
    for paper in &report.papers {
        text += &paper.html(album);
    }
    text + "</section>\n"
}

fn notes(id: &str, title: &str, notes: &[Note]) -> String {
    let list: String = notes
        .iter()
        .map(|(name, text)| format!("<div><dt>{}</dt><dd>{}</dd></div>\n", escaped(name), escaped(text)))
        .collect();
    format!("<section id=\"{id}\">\n<h2>{title}</h2>\n<dl class=\"notes\">\n{list}</dl>\n</section>\n")
}

/// Text as HTML, also inside quotes.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
