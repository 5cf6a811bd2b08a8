//! The page's sections.

use serde_json::{Value, json};

use crate::falsecolor::css_stops;
use crate::record::Record;
use crate::report::chart::{Chart, NARROW, WIDE, error_against_time};
use crate::report::equal::{Curve, equal_error, equal_time, winners};
use crate::report::frontier::{Point, dominated};
use crate::report::html::escaped;
use crate::report::looks::Looks;
use crate::report::passes::{by_pass, health, model_errors as model_table, with_model_error};
use crate::report::pictures::Album;
use crate::report::presets::{everything, improvements, over_yardstick, pairs, presets};
use crate::report::scaling::{Scaling, table as exponents};
use crate::report::sources::Case;
use crate::report::{UNIFORM, digits, lines, percent};

/// A section, and what its script needs.
pub(crate) struct Section {
    pub html: String,
    pub data: Value,
}

/// One case: chart, which one to use, pictures, tables.
pub(crate) fn case(
    index: usize,
    case: &Case<'_>,
    all: &[Case<'_>],
    looks: &Looks<'_>,
    album: &Album,
) -> Result<Section, String> {
    let first = case.first;
    let title = case.title(all);
    let mut text = format!("<section id=\"case-{index}\" class=\"case\">\n<h2>{}</h2>\n", escaped(&title));
    text += "<figure class=\"main-chart\">\n";
    let heading = chart_title(case);
    for (class, size) in [("wide", WIDE), ("narrow", NARROW)] {
        let heading = if size == NARROW { &title } else { &heading };
        let chart = error_against_time(case, heading, looks, size)?;
        text += &format!("<div class=\"{class}\">{}</div>\n", with_hits(&chart, index, case));
    }
    text += &format!(
        "<figcaption>{} triangles, {} ({}), {} × {}. Reference: {}, sure to {}. Point at a mark for its figures and \
         picture; choose two to compare them below.</figcaption>\n</figure>\n",
        first.triangles,
        if first.lights == 1 { "1 light".into() } else { format!("{} lights", first.lights) },
        escaped(&first.light_kinds.join(", ")),
        first.width,
        first.height,
        escaped(&first.reference.terms.join(" + ")),
        percent(first.reference.uncertainty),
    );
    text += &advice(case);
    text += &viewer(index, case, album);
    for (heading, table) in [
        ("Equal error: the cheapest setting of each", equal_error(case)),
        ("Equal time: the least error of each", equal_time(case)),
        ("Papers' settings and defaults", presets(case)),
        ("What each improvement is worth", improvements(case)),
        ("Everything that was measured", everything(case)),
    ] {
        text += &table.html(heading);
    }
    Ok(Section { html: text + "</section>\n", data: data(case, album) })
}

/// Scene, size and adapter.
pub(crate) fn chart_title(case: &Case<'_>) -> String {
    let Record { scene, width, height, adapter, software, .. } = case.first;
    format!("{scene}, {width} × {height}, {adapter}{}", if *software { ": SOFTWARE ADAPTER" } else { "" })
}

/// The chart with something to point at over each mark.
fn with_hits(chart: &Chart<'_>, case_index: usize, case: &Case<'_>) -> String {
    let hits: String = chart
        .places
        .iter()
        .filter_map(|(record, (x, y))| {
            let index = case.records.iter().position(|other| std::ptr::eq(*other, *record))?;
            let label = format!(
                "{}, {}: {} ms, error {}",
                record.technique,
                case.setting(record),
                digits(record.technique_ms.p50),
                percent(record.error.rel_rmse)
            );
            Some(format!(
                "<circle class=\"hit\" cx=\"{x}\" cy=\"{y}\" r=\"12\" tabindex=\"0\" role=\"button\" data-case=\"{case_index}\" \
                 data-point=\"{index}\" aria-label=\"{}\"/>\n",
                escaped(&label)
            ))
        })
        .collect();
    match chart.svg.rsplit_once("</svg>") {
        Some((drawing, _)) => format!("{drawing}<g>\n{hits}</g>\n</svg>"),
        None => chart.svg.clone(),
    }
}

/// Which one to use, in plain sentences.
fn advice(case: &Case<'_>) -> String {
    let mut lines: Vec<String> = winners(case)
        .iter()
        .map(|w| format!("At most {}: <strong>{}</strong> {}.", w.bound, escaped(&w.who), escaped(&w.how)))
        .collect();
    for pair in pairs(case) {
        let (paper, default) = (pair.paper, pair.default);
        lines.push(format!(
            "The default of <strong>{}</strong>{}: {} ({} of its time, {} of its error).",
            escaped(&default.record.technique),
            case.maps(default.record).map_or(String::new(), |maps| format!(" with a {maps}")),
            pair.standing().text(),
            digits(default.time / paper.time),
            digits(default.error / paper.error),
        ));
    }
    let curves = Curve::all(case);
    let marching = curves.iter().find(|curve| curve.technique == UNIFORM);
    if let Some(order) = marching.and_then(Curve::order) {
        lines.push(format!("Uniform marching: its error falls as N<sup>−{order:.2}</sup> here."));
    }
    if lines.is_empty() {
        return String::new();
    }
    let lines: String = lines.iter().map(|line| format!("<li>{line}</li>\n")).collect();
    format!("<h3>Which one should I use?</h3>\n<ul class=\"advice\">\n{lines}</ul>\n")
}

/// Pictures to choose two of, and the two beside each other.
fn viewer(index: usize, case: &Case<'_>, album: &Album) -> String {
    let button = |picture: Option<usize>, point: &str, name: &str, small: &str| {
        let Some(picture) = picture else { return String::new() };
        format!(
            "<button type=\"button\" class=\"pick\" aria-pressed=\"false\" data-case=\"{index}\" data-point=\"{point}\">\
             <img data-picture=\"{picture}\" alt=\"\" loading=\"lazy\"><span>{}</span><small>{}</small></button>\n",
            escaped(name),
            escaped(small)
        )
    };
    let reference = button(album.get(&case.first.pictures.reference), "reference", "CPU reference", "");
    let pictures: String = (0..)
        .zip(&case.records)
        .map(|(point, record): (usize, _)| {
            let small = format!(
                "{}: {} ms, {}",
                case.setting(record),
                digits(record.technique_ms.p50),
                percent(record.error.rel_rmse)
            );
            let picture = album.get(&record.pictures.picture);
            button(picture, &point.to_string(), &record.technique, &small)
        })
        .collect();
    if pictures.is_empty() {
        return String::new();
    }
    let (stops, title) = (css_stops(), escaped(&case.first.scene));
    format!(
        "<h3>Pictures</h3>\n<p class=\"hint\">The two that were chosen last are compared; drag the divide, or move it by arrow \
         keys.</p>\n<div class=\"viewer\" data-case=\"{index}\">\n<figure>\n<div class=\"stage\"><img class=\"under\" alt=\"{title}, left\">\
         <img class=\"over\" alt=\"{title}, right\"><span class=\"divide\"></span>\
         <input type=\"range\" min=\"0\" max=\"1000\" value=\"500\" aria-label=\"Divide between the two pictures\"></div>\n\
         <figcaption><span class=\"left\"></span><span class=\"right\"></span></figcaption>\n</figure>\n<figure>\n\
         <canvas role=\"img\" aria-label=\"False-colour difference of the two pictures\"></canvas>\n\
         <figcaption><span class=\"difference\"></span></figcaption>\n<div class=\"scale\"><span class=\"bar\" \
         style=\"background:linear-gradient(to right,{stops})\"></span><span class=\"marks\"><span>1</span><span>4</span>\
         <span>16</span><span>64</span><span>255 codes</span></span></div>\n</figure>\n</div>\n\
         <div class=\"strip\">\n{reference}{pictures}</div>\n"
    )
}

/// What the script shows of each point.
fn data(case: &Case<'_>, album: &Album) -> Value {
    let points: Vec<Point<'_>> = case.records.iter().copied().filter_map(Point::of).collect();
    let hollow = dominated(&points);
    let is_dominated = |record: &Record| {
        points.iter().position(|point| std::ptr::eq(point.record, record)).is_some_and(|index| hollow[index])
    };
    let all = case.records.iter().map(|record| {
        let settings: Vec<String> = record
            .settings
            .iter()
            .map(|(name, value)| format!("{} = {}", name.replace('_', " "), value.to_string().replace('"', "")))
            .collect();
        let ratio = over_yardstick(case, record).map_or(String::new(), |ratio| format!(", {} × 64 steps", digits(ratio)));
        json!({
            "name": record.technique,
            "setting": case.setting(record),
            "preset": record.preset,
            "settings": settings,
            "time": format!("{} ms (p95 {}, max {}){ratio}", digits(record.technique_ms.p50), digits(record.technique_ms.p95), digits(record.technique_ms.max)),
            "error": format!("{} (worst tile {}, bias {})", percent(record.error.rel_rmse), percent(record.error.worst_tile), percent(record.error.bias)),
            "flip": digits(record.error.flip),
            "dominated": is_dominated(record),
            "picture": album.get(&record.pictures.picture),
        })
    });
    // What is compared at first: the reference and the best default.
    let defaults = (0..)
        .zip(&case.records)
        .filter(|(_, record)| record.preset == "default" && album.get(&record.pictures.picture).is_some());
    let best: Option<usize> =
        defaults.min_by(|a, b| a.1.error.rel_rmse.total_cmp(&b.1.error.rel_rmse)).map(|d| d.0);
    json!({
        "points": all.collect::<Vec<_>>(),
        "reference": album.get(&case.first.pictures.reference),
        "start": best,
    })
}

/// Time over what the studies vary.
pub(crate) fn scaling(scalings: &[Scaling<'_>], looks: &Looks<'_>) -> Result<String, String> {
    if scalings.is_empty() {
        return Ok(String::new());
    }
    let mut text = String::from("<section id=\"scaling\">\n<h2>Scaling</h2>\n<div class=\"charts\">\n");
    for scaling in scalings {
        let heading = format!("{}: {}", scaling.title, scaling.what);
        text += &format!(
            "<figure>\n<h3>{}</h3>\n<div class=\"scroll\">{}</div>\n<figcaption>Solid: the technique's own passes; dashed: with \
             shadow maps, depth and surfaces. Hollow: the paper's setting.</figcaption>\n{}</figure>\n",
            escaped(&heading),
            lines::growth(scaling, looks)?,
            exponents(scaling).html("Exponents: time grows as this power")
        );
    }
    Ok(text + "</div>\n</section>\n")
}

/// Where the time goes, case by case.
pub(crate) fn passes(cases: &[Case<'_>]) -> String {
    let tables: String = cases
        .iter()
        .map(|case| {
            let title = case.title(cases);
            by_pass(case).html(&format!("{title}: time by pass, CPU beside device"))
                + &health(case).html(&format!("{title}: clocks, memory, worst tile"))
        })
        .collect();
    if tables.is_empty() {
        return tables;
    }
    format!("<section id=\"passes\">\n<h2>Time by pass</h2>\n{tables}</section>\n")
}

/// What models miss, beside what implementations do.
pub(crate) fn model_errors(cases: &[Case<'_>], looks: &Looks<'_>) -> Result<String, String> {
    let mut text = String::new();
    for case in cases {
        let records = with_model_error(case);
        if records.is_empty() {
            continue;
        }
        let title = case.title(cases);
        text += &format!(
            "<div class=\"charts\"><figure>\n<h3>{}</h3>\n<div class=\"scroll\">{}</div>\n<figcaption>On the grey line nothing is \
             missing from the model; far above it a better implementation gains nothing. Hollow: the paper's \
             setting.</figcaption>\n</figure></div>\n{}",
            escaped(&title),
            lines::model(&records, looks)?,
            model_table(case).html(&format!("{title}: error of the implementation, and of the model"))
        );
    }
    if text.is_empty() {
        return Ok(text);
    }
    Ok(format!(
        "<section id=\"model\">\n<h2>Model error beside implementation error</h2>\n{text}</section>\n"
    ))
}
