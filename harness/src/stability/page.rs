//! The atlas as a page, and as text.

use super::cell::{Cell, Verdict};
use super::row::{COLUMNS, PROMISED, Part, Row};
use super::{bounds, coverage, curve, domain};
use crate::failure::Failure;
use crate::report::html::escaped;
use crate::report::looks::Looks;
use crate::report::markdown::{self, table};
use crate::report::table::SOFTWARE;

const STYLE: &str = "
.matrix td { padding: 0; text-align: center; min-width: 4.6rem; }
.matrix td a { display: block; padding: 0.3rem 0.4rem; color: #111; text-decoration: none; }
.matrix th a { text-decoration: none; }
.matrix thead th { max-width: 6rem; white-space: normal; overflow-wrap: anywhere; text-align: center; }
.matrix .part th { padding-top: 1rem; color: var(--faint); }
.good { background: #7fc97f; } .near { background: #d9ef8b; } .far { background: #fee08b; } .beyond { background: #f46d43; }
.broken { background: #c51b7d; } .broken a { color: #fff !important; } .none { background: var(--line); }
.told a { background-image: repeating-linear-gradient(135deg, transparent 0 6px, rgb(255 255 255 / 0.55) 6px 9px); }
.key span { padding: 0.1rem 0.6rem; color: #111; margin-right: 0.4rem; }
.key span.broken { color: #fff; } .key span.told { background: #eee repeating-linear-gradient(135deg, transparent 0 6px, #999 6px 9px); }
.worst { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(22rem, 100%), 1fr)); gap: 0.8rem 1.2rem; }
.worst figure { margin: 0; } .worst img { width: 100%; image-rendering: pixelated; }
.worst figure:target { outline: 3px solid var(--accent); outline-offset: 3px; }
";

/// A share as a percentage.
pub(super) fn percent(value: f64) -> String {
    match value {
        value if value.is_nan() => "–".into(),
        value if value.is_infinite() => "∞".into(),
        value if value != 0.0 && value.abs() < 5e-6 => format!("{:.0e} %", 100.0 * value),
        value => format!("{} %", crate::report::digits(100.0 * value)),
    }
}

/// A figure of a measure.
pub(super) fn amount(measure: &str, value: f64) -> String {
    if measure.contains("bytes") && !value.is_nan() { format!("{} B", value.round()) } else { percent(value) }
}

/// The columns that were measured, in order.
fn columns<'a>(cells: &[&'a Cell]) -> Vec<&'a str> {
    COLUMNS
        .into_iter()
        .filter_map(|column| cells.iter().find(|cell| cell.column == column).map(|cell| cell.column.as_str()))
        .collect()
}

fn of<'a>(row: &Row, cells: &'a [Cell]) -> Vec<&'a Cell> {
    cells.iter().filter(|cell| cell.row == row.id).collect()
}

/// The whole page; its pictures lie beside it.
pub(super) fn page(rows: &[Row], cells: &[Cell]) -> Result<String, Failure> {
    let mut body = head(cells);
    body += &matrix(rows, cells);
    let looks = Looks::named(&COLUMNS, PROMISED.len() - 1);
    for part in Part::ALL {
        let of_part: Vec<&Row> = rows.iter().filter(|row| row.part == part).collect();
        if of_part.iter().all(|row| of(row, cells).is_empty()) {
            continue;
        }
        body += &format!("<section>\n<h2>{}</h2>\n", part.title());
        for row in of_part {
            body += &section(row, &of(row, cells), &looks)?;
        }
        body += "</section>\n";
    }
    body += "<section id=\"domains\">\n<h2>Domains of validity</h2>\n<p>Where the defaults stay under two and five percent.</p>\n";
    for (name, text) in domain::blocks(rows, cells) {
        let title = name.trim_start_matches("domain-");
        body += &format!("<h3>{title}</h3>\n<div class=\"scroll\">{}</div>\n", html_of(&text));
    }
    body += "</section>\n";
    body += &known_failures(rows);
    let style = include_str!("../report/style.css");
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>Light in fog: what breaks</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>\n{style}{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    ))
}

/// Where each known failure is looked at.
fn known_failures(rows: &[Row]) -> String {
    let mut text = String::from(
        "<section id=\"known\">\n<h2>Known failures</h2>\n<p>Where each is provoked and measured: in a row above, in a crate's tests, or by a command.</p>\n",
    );
    for (technique, failures) in coverage::FAILURES {
        text += &format!("<h3>{technique}</h3>\n<div class=\"scroll\"><table class=\"words-2\"><tbody>\n");
        for (failure, places) in *failures {
            let place = |place: &&str| match rows.iter().any(|row| row.id == *place) {
                true => format!("<a href=\"#{place}\">{place}</a>"),
                false => format!("<code>{place}</code>"),
            };
            let places: Vec<String> = places.iter().map(place).collect();
            text += &format!("<tr><th>{}</th><td>{}</td></tr>\n", escaped(failure), places.join(", "));
        }
        text += "</tbody></table></div>\n";
    }
    text + "</section>\n"
}

/// Markdown as HTML.
fn html_of(text: &str) -> String {
    let mut html = String::new();
    let parser = pulldown_cmark::Parser::new_ext(text, pulldown_cmark::Options::ENABLE_TABLES);
    pulldown_cmark::html::push_html(&mut html, parser);
    html
}

fn head(cells: &[Cell]) -> String {
    let mut text = String::from("<header>\n<h1>Light in fog: what breaks</h1>\n");
    if let Some(cell) = cells.first() {
        if cell.software {
            text += "<p class=\"software\">SOFTWARE ADAPTER</p>\n";
        }
        let Cell { adapter, driver, machine, commit, date, .. } = cell;
        let day = date.split('T').next().unwrap_or_default();
        let label = format!(
            "{adapter} ({driver}) · {}, {} cores, {} · commit {commit} · {day}",
            machine.cpu, machine.cores, machine.os
        );
        text += &format!("<p class=\"label\">{}</p>\n", escaped(&label));
        if cell.software {
            text += &format!("<p class=\"note\">{SOFTWARE}</p>\n");
        }
    }
    let problems: Vec<String> = cells
        .iter()
        .filter_map(|cell| {
            Some(format!("{} at {} ({}): {}", cell.column, cell.label, cell.row, cell.problem()?))
        })
        .collect();
    text += &match problems.as_slice() {
        [] => "<p class=\"note\">Every promise holds: no figure is above its bound but where the method refuses or warns, \
               and no pixel is NaN, infinite or negative.</p>\n"
            .to_owned(),
        some => format!("<p class=\"wrong\"><strong>Promises that do not hold.</strong> {}</p>\n", escaped(&some.join("; "))),
    };
    text += "<p>Every row is one way to break a method: a parameter swept from harmless to absurd. A cell shows the worst \
             figure of a method in that row of all that it draws <em>without a word</em>; it leads to the row's curve, its figures and \
             the worst picture. The first five columns are promised to stay below a bound, or to refuse or to warn; of the \
             others (the papers' own settings, and what one would otherwise use) nothing is promised but sound \
             pixels.</p>\n";
    text += "<p class=\"key\"><span class=\"good\">at most half the bound</span><span class=\"near\">within the bound</span>\
             <span class=\"far\">up to four times</span><span class=\"beyond\">more</span><span class=\"broken\">broken \
             pixels</span><span class=\"told\">in part refused or warned about</span> Without a bound of its own a column \
             is coloured by 5 %.</p>\n";
    text + "<nav><a href=\"#domains\">Domains of validity</a>\n<a href=\"#known\">Known failures</a></nav>\n</header>\n"
}

/// What a cell of the matrix says of a method in a row.
struct Summary {
    text: String,
    class: &'static str,
    told: bool,
}

/// Where nothing is promised a column is coloured by this bound.
const NO_BOUND: f64 = 0.05;

fn summary(row: &Row, cells: &[&Cell]) -> Summary {
    let told = cells.iter().any(|cell| cell.told());
    let broken: u32 = cells.iter().map(|cell| cell.broken).sum();
    if let Some(fault) = cells.iter().find_map(|cell| cell.fault.as_ref()) {
        let _ = fault;
        return Summary { text: "fails".into(), class: "broken", told };
    }
    if broken > 0 {
        return Summary { text: format!("{broken} px"), class: "broken", told };
    }
    let untold = cells.iter().filter(|cell| !cell.told() && !cell.figure().is_nan());
    let ratio = |cell: &&&Cell| {
        let bound = cell.bound.filter(|bound| bound.is_finite()).unwrap_or_else(|| {
            if row.measure.relative() { NO_BOUND * (row.law)(cell.value) } else { f64::INFINITY }
        });
        if cell.figure() == 0.0 { 0.0 } else { cell.figure() / bound }
    };
    let Some(worst) = untold.max_by(|a, b| ratio(a).total_cmp(&ratio(b))) else {
        let text = if cells.iter().all(|cell| cell.refused.is_some()) { "refuses" } else { "sound" };
        return Summary { text: text.into(), class: if text == "sound" { "good" } else { "none" }, told };
    };
    let class = match ratio(&worst) {
        ratio if ratio <= 0.5 => "good",
        ratio if ratio <= 1.0 => "near",
        ratio if ratio <= 4.0 => "far",
        _ => "beyond",
    };
    Summary { text: amount(&worst.measure, worst.figure()), class, told }
}

fn matrix(rows: &[Row], cells: &[Cell]) -> String {
    let all: Vec<&Cell> = cells.iter().collect();
    let columns = columns(&all);
    let heads: String =
        columns.iter().map(|column| format!("<th>{}</th>", column.replace('-', "-<wbr>"))).collect();
    let mut text = format!(
        "<div class=\"scroll\"><table class=\"matrix\"><thead><tr><th></th>{heads}</tr></thead><tbody>\n"
    );
    for part in Part::ALL {
        let of_part: Vec<&Row> =
            rows.iter().filter(|row| row.part == part && !of(row, cells).is_empty()).collect();
        if !of_part.is_empty() {
            text += &format!(
                "<tr class=\"part\"><th colspan=\"{}\">{}</th></tr>\n",
                columns.len() + 1,
                part.title()
            );
        }
        for row in of_part {
            text += &format!("<tr><th><a href=\"#{0}\">{1}</a></th>", row.id, row.title);
            for column in &columns {
                let own: Vec<&Cell> =
                    of(row, cells).into_iter().filter(|cell| cell.column == *column).collect();
                if own.is_empty() {
                    text += "<td></td>";
                    continue;
                }
                let Summary { text: words, class, told } = summary(row, &own);
                let told = if told { " told" } else { "" };
                let anchor = match own.iter().any(|cell| cell.picture.is_some()) {
                    true => format!("{}--{column}", row.id),
                    false => row.id.to_owned(),
                };
                text += &format!("<td class=\"{class}{told}\"><a href=\"#{anchor}\">{words}</a></td>");
            }
            text += "</tr>\n";
        }
    }
    text + "</tbody></table></div>\n"
}

fn section(row: &Row, cells: &[&Cell], looks: &Looks<'_>) -> Result<String, Failure> {
    if cells.is_empty() {
        return Ok(String::new());
    }
    let columns = columns(cells);
    let mut text =
        format!("<h3 id=\"{}\">{}</h3>\n<p>{}</p>\n", row.id, escaped(row.title), escaped(row.why));
    if cells.iter().any(|cell| !cell.figure().is_nan()) {
        let svg = curve::curve(row, cells, &columns, looks).map_err(Failure::Run)?;
        text += &format!(
            "<figure><div class=\"scroll\">{svg}</div><figcaption>{}; hollow where the method refuses or warns.</figcaption></figure>\n",
            row.measure.title()
        );
    }
    text += &format!("<div class=\"scroll\">{}</div>\n", html_of(&figures(row, cells, &columns)));
    let mut words: Vec<String> = Vec::new();
    for cell in cells {
        let said = cell.refused.iter().chain(&cell.fault).chain(&cell.warnings);
        words.extend(said.map(|said| {
            format!("<li>{} at {}: {}</li>\n", cell.column, escaped(&cell.label), escaped(said))
        }));
    }
    if !words.is_empty() {
        text += &format!(
            "<details class=\"note\"><summary>What the methods said ({})</summary><ul>{}</ul></details>\n",
            words.len(),
            words.concat()
        );
    }
    text += "<div class=\"worst\">\n";
    for cell in cells {
        let Some(name) = &cell.picture else { continue };
        let caption = format!("{} at {}: {}", cell.column, cell.label, amount(&cell.measure, cell.figure()));
        text += &format!(
            "<figure id=\"{}--{}\"><img alt=\"picture, what it should be, error\" loading=\"lazy\" \
             src=\"{}\"><figcaption>{}</figcaption></figure>\n",
            row.id,
            cell.column,
            escaped(name),
            escaped(&caption)
        );
    }
    Ok(text + "</div>\n")
}

/// Figures of a row: a line for each value, a column for each method, and the bounds of what is promised.
fn figures(row: &Row, cells: &[&Cell], columns: &[&str]) -> String {
    let mut labels: Vec<&str> = cells.iter().map(|cell| cell.label.as_str()).collect();
    labels.dedup();
    let mut head = vec![row.id.to_owned()];
    head.extend(columns.iter().map(|column| (*column).to_owned()));
    let mut lines = vec![head];
    for label in labels {
        let mut line = vec![if label.is_empty() { "–".into() } else { label.to_owned() }];
        for column in columns {
            let cell = cells.iter().find(|cell| cell.column == *column && cell.label == label);
            line.push(cell.map_or(String::new(), |cell| words(cell)));
        }
        lines.push(line);
    }
    let harmless = row.parameter.values().first().copied().unwrap_or(0.0);
    let bounds: Vec<Option<f64>> =
        columns.iter().map(|column| bounds::bound(row, column, harmless)).collect();
    if bounds.iter().any(Option::is_some) {
        let mut line = vec!["bound".to_owned()];
        line.extend(
            bounds
                .iter()
                .map(|bound| bound.map_or(String::new(), |bound| amount(row.measure.title(), bound))),
        );
        lines.push(line);
    }
    table(&lines)
}

fn words(cell: &Cell) -> String {
    let figure = amount(&cell.measure, cell.figure());
    match cell.verdict() {
        Verdict::Kept => figure,
        Verdict::Told if cell.refused.is_some() => "refused".into(),
        Verdict::Told => format!("{figure} (warned)"),
        Verdict::Silent => format!("**{figure}**"),
        Verdict::Broken if cell.fault.is_some() => "**fails**".into(),
        Verdict::Broken => format!("**{} broken pixels**", cell.broken),
    }
}

/// The matrix as text.
pub(super) fn text(rows: &[Row], cells: &[Cell]) -> String {
    let all: Vec<&Cell> = cells.iter().collect();
    let columns = columns(&all);
    let short = |column: &&str| column.replace("-default", "");
    let mut lines =
        vec![std::iter::once("worst".to_owned()).chain(columns.iter().map(short)).collect::<Vec<_>>()];
    for row in rows {
        let own = of(row, cells);
        if own.is_empty() {
            continue;
        }
        let mut line = vec![row.id.to_owned()];
        for column in &columns {
            let cells: Vec<&Cell> = own.iter().copied().filter(|cell| cell.column == *column).collect();
            line.push(if cells.is_empty() {
                String::new()
            } else {
                let Summary { text, class, told } = summary(row, &cells);
                let mark = match class {
                    "broken" => " BROKEN",
                    "far" | "beyond" if PROMISED.contains(column) => " !",
                    _ => "",
                };
                format!("{text}{}{mark}", if told { "*" } else { "" })
            });
        }
        lines.push(line);
    }
    markdown::table(&lines) + "\n* in part refused or warned about; ! above its bound without a word\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::cell::tests::example;
    use crate::stability::rows;

    #[test]
    fn the_page_leads_from_each_cell_to_its_row_and_says_what_does_not_hold() {
        let rows = rows::all();
        let bad = Cell { label: "1e6".into(), ..example("scale", "biri-ss-default", 1e6, 0.3) };
        let cells = [example("scale", "biri-ss-default", 1.0, 0.001), bad];
        let page = page(&rows, &cells).unwrap();
        for words in [
            "href=\"#scale\"",
            "id=\"scale\"",
            "Promises that do not hold",
            "30.0 %",
            "class=\"beyond\"",
            "<svg",
        ] {
            assert!(page.contains(words), "{words}");
        }
        assert!(!page.contains("<script") && !page.contains("src=\"http"), "nothing may be fetched");
        let text = text(&rows, &cells);
        assert!(text.contains("| scale | 30.0 % !"), "{text}");
    }

    #[test]
    fn margins_have_colours() {
        let rows = rows::all();
        let row = rows.iter().find(|row| row.id == "scale").unwrap();
        let class = |cell: &Cell| summary(row, &[cell]).class;
        let cell = |figure| example("scale", "biri-ss-default", 1.0, figure);
        let classes = [0.01, 0.02, 0.08, 0.1].map(|figure| class(&cell(figure)));
        assert_eq!(classes, ["good", "near", "far", "beyond"]);
        assert_eq!(class(&Cell { broken: 3, ..cell(0.0) }), "broken");
        assert!(summary(row, &[&Cell { warnings: vec!["far".into()], ..cell(0.5) }]).told);
    }
}
