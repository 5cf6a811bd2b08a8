//! The page: one HTML file that needs nothing but the pictures beside it.

use crate::falsecolor::{MARKS, css_stops};
use crate::record::Record;
use crate::report::table::SOFTWARE;
use crate::report::{YARDSTICK, digits, percent, relative_time, scenes};

/// The page of a run; `charts` holds each scene's SVG, in the order of [`scenes`].
pub(crate) fn page(records: &[Record], charts: &[String]) -> String {
    let mut body = head(records);
    for (scene, chart) in scenes(records).into_iter().zip(charts) {
        let of_scene: Vec<&Record> = records.iter().filter(|record| record.scene == scene).collect();
        body += &section(&of_scene, records, chart);
    }
    body += DEFINITIONS;
    let style = include_str!("style.css");
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>Light in fog: measurements</title>\n\
         <style>\n{style}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}

/// Title, what it was measured on, and how to read it.
fn head(records: &[Record]) -> String {
    let Some(first) = records.first() else { return "<h1>No records</h1>\n".into() };
    let mut text = String::from("<h1>Light in fog: speed and error</h1>\n");
    if records.iter().any(|record| record.software) {
        text += &format!(
            "<p class=\"note\"><strong>{SOFTWARE}</strong> The column “time ratio” is the time relative to \
             <code>{YARDSTICK}</code> on the same scene.</p>\n"
        );
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
    let facts = [
        ("adapter", format!("{} ({})", first.adapter, first.driver)),
        ("machine", format!("{}, {} cores, {}", first.machine.cpu, first.machine.cores, first.machine.os)),
        ("pictures", format!("{} × {} pixels", first.width, first.height)),
        (
            "timed",
            format!(
                "up to {} frames after {} of warm-up",
                records.iter().map(|r| r.frames).max().unwrap_or(0),
                first.warm_up
            ),
        ),
        ("commit", first.commit.clone()),
        ("date", first.date.clone()),
    ];
    text += "<dl class=\"facts\">\n";
    for (name, value) in facts {
        text += &format!("<div><dt>{name}</dt><dd>{}</dd></div>\n", escaped(&value));
    }
    text + "</dl>\n<p>Raw figures: <a href=\"records.jsonl\">records.jsonl</a>, <a href=\"records.csv\">records.csv</a>.</p>\n"
}

/// One scene: chart, table, pictures side by side.
fn section(of_scene: &[&Record], records: &[Record], chart: &str) -> String {
    let Some(first) = of_scene.first() else { return String::new() };
    let mut text = format!(
        "<section>\n<h2>{}</h2>\n<p>{} triangles; {} {} ({}). Reference: {}, own uncertainty {}, {}. Moving while timed: {}.</p>\n",
        escaped(&first.scene),
        first.triangles,
        first.lights,
        if first.lights == 1 { "light" } else { "lights" },
        escaped(&first.light_kinds.join(", ")),
        escaped(&first.reference.terms.join(" + ")),
        percent(first.reference.uncertainty),
        if first.reference.cached {
            "from the cache".into()
        } else {
            format!("{} s", digits(first.reference.seconds))
        },
        escaped(&first.moving),
    );
    text += &format!(
        "<div class=\"overview\">\n<figure>\n{chart}\n<figcaption>Error against time; lower left is better. \
         Hollow: at or below the reference's own uncertainty.</figcaption>\n</figure>\n\
         <figure>\n<img src=\"{0}\" alt=\"CPU reference of {1}\">\n<figcaption>CPU reference: surfaces and \
         airlight.</figcaption>\n</figure>\n</div>\n",
        escaped(&first.pictures.reference),
        escaped(&first.scene),
    );
    text += "<div class=\"scroll\"><table>\n<thead><tr><th>technique</th><th>settings</th><th>ms p50</th><th>p95</th>\
         <th>max</th><th>fps</th><th>time ratio</th><th>CPU ms</th><th>frame ms</th><th>rel. RMSE</th><th>bias</th>\
         <th>p99</th><th>max</th><th>worst tile</th><th>leak</th><th>FLIP</th><th>energy</th><th>NaN</th><th>inf</th><th>neg.</th></tr></thead>\n<tbody>\n";
    for record in of_scene {
        text += &row(record, records);
    }
    text += "</tbody></table></div>\n";
    text += &format!(
        "<div class=\"scale\"><span class=\"bar\" style=\"background:linear-gradient(to right,{})\"></span>\
         <span class=\"marks\">{}</span></div>\n",
        css_stops(),
        MARKS.map(|(_, mark)| format!("<span>{mark}</span>")).concat()
    );
    text += "<div class=\"pictures\">\n<div class=\"columns\"><span>CPU reference</span><span>technique</span>\
         <span>relative error of the airlight</span></div>\n";
    for record in of_scene.iter().filter(|record| record.refused.is_none()) {
        text += &pictures(record);
    }
    text + "</div>\n</section>\n"
}

fn row(record: &Record, records: &[Record]) -> String {
    let (time, error) = (&record.technique_ms, &record.error);
    let cells = [
        digits(time.p50),
        digits(time.p95),
        digits(time.max),
        digits(1000.0 / time.p50),
        relative_time(record, records).map_or("–".into(), digits),
        digits(record.cpu_ms.p50),
        digits(record.frame_ms.p50),
        percent(error.rel_rmse),
        percent(error.bias),
        percent(error.p99),
        percent(error.max),
        percent(error.worst_tile),
        percent(error.leak),
        digits(error.flip),
        digits(error.energy_ratio),
        error.nan.to_string(),
        error.inf.to_string(),
        error.negative.to_string(),
    ];
    let settings: Vec<String> =
        record.settings.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let passes: Vec<String> =
        record.passes.iter().map(|(name, time)| format!("{name}: {} ms", digits(time.p50))).collect();
    if let Some(refused) = &record.refused {
        let (name, refused) = (escaped(&record.name), escaped(refused));
        return format!(
            "<tr><td>{name}</td><td class=\"refused\" colspan=\"19\">refused: {refused}</td></tr>\n"
        );
    }
    format!(
        "<tr{}><td title=\"{}\">{}</td><td title=\"{}\">{}</td>{}</tr>\n",
        if record.problem().is_some() { " class=\"wrong\"" } else { "" },
        escaped(&passes.join("\n")),
        escaped(&record.name),
        escaped(&settings.join("\n")),
        escaped(&record.label),
        cells.map(|cell| format!("<td>{cell}</td>")).concat()
    )
}

fn pictures(record: &Record) -> String {
    let (scene, name) = (escaped(&record.scene), escaped(&record.name));
    let picture = |file: &str, what: &str| {
        let file = escaped(file);
        format!(
            "<a href=\"{file}\"><img src=\"{file}\" alt=\"{scene}: {what}\" width=\"{}\"></a>\n",
            record.width
        )
    };
    let Record { pictures, error, .. } = record;
    format!(
        "<figure>\n{}{}{}<figcaption><strong>{name}</strong> {}: {} ms, relative RMSE {}, FLIP {} \
         (linear radiance: <a href=\"{}\">airlight</a>, <a href=\"{}\">reference</a>)</figcaption>\n</figure>\n",
        picture(&pictures.reference, "CPU reference"),
        picture(&pictures.picture, &name),
        picture(&pictures.error_map, &format!("error of {name}")),
        escaped(&record.label),
        digits(record.technique_ms.p50),
        percent(error.rel_rmse),
        digits(error.flip),
        escaped(&pictures.airlight_exr),
        escaped(&pictures.reference_airlight_exr),
    )
}

/// Text as HTML, also inside quotes.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const DEFINITIONS: &str = "<section>\n<h2>What the figures are</h2>\n<dl class=\"definitions\">
<dt>ms p50, p95, max</dt><dd>Time of the technique's own passes on the device: median, 95th percentile (nearest rank) and largest over all timed frames. Shadow maps, depth and surfaces, which every technique needs alike, are not in it; they are in the records as <code>ground_passes</code>.</dd>
<dt>fps</dt><dd>1000 / ms p50: how often these passes alone could run in a second.</dd>
<dt>time ratio</dt><dd>ms p50 over that of the ray march of 64 steps, same scene, same run.</dd>
<dt>CPU ms</dt><dd>Median time that preparing and encoding the technique takes on the CPU.</dd>
<dt>frame ms</dt><dd>Median wall-clock time of a whole frame, with the ground and with waiting for the device.</dd>
<dt>rel. RMSE, bias, p99, max</dt><dd>Errors of the airlight in linear radiance at time 0, against the reference of the same term, where the reference is lit, relative to its mean there: root of the mean squared error, mean signed error, 99th percentile and largest absolute error (of all pixels).</dd>
<dt>worst tile, leak</dt><dd>Largest RMS error of any tile of 64 × 64 pixels; RMS of the light where the reference has none. Both relative to the same mean.</dd>
<dt>FLIP</dt><dd>Mean of the FLIP difference evaluator (Andersson et al. 2020), 0 to 1, on tone-mapped pictures of reference surfaces with this airlight against the same with the reference's, at the reference's exposure, 67 pixels per degree.</dd>
<dt>energy</dt><dd>Sum of the airlight over the reference's sum.</dd>
<dt>NaN, inf, neg.</dt><dd>Pixels that are not a number, infinite, negative. Anything but 0 fails the run.</dd>
<dt>pictures</dt><dd>Surface and airlight together, exposure from the reference, tone curve 1 − exp(−x), sRGB. The error maps show |airlight − reference| relative to the reference at each pixel, on a logarithmic scale; magenta is not a number.</dd>
</dl>\n</section>\n";
