//! The chart of error against time, as SVG text.

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;

use crate::record::Record;
use crate::report::frontier::{Point, dominated, frontier};
use crate::report::labels::{Area, Labels};
use crate::report::looks::{Look, Looks, marks, marks_beyond, number};
use crate::report::sources::Case;

pub(crate) type Drawing<T> = Result<T, DrawingAreaErrorKind<std::io::Error>>;
pub(crate) type Sheet<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Sizes of the chart \[SVG pixels\]: on a desk, and on a telephone.
pub(crate) const WIDE: (u32, u32) = (1000, 640);
pub(crate) const NARROW: (u32, u32) = (460, 560);

/// Rough width of a letter over the size of the font that plotters is told.
const LETTER: f64 = 0.46;

/// A chart, and where on it each point lies.
#[derive(Clone, Debug)]
pub(crate) struct Chart<'a> {
    pub svg: String,
    pub places: Vec<(&'a Record, (i32, i32))>,
}

/// Error over time, both logarithmic. Lines and letters have the colour `currentColor`, so that a page can choose
/// it.
pub(crate) fn error_against_time<'a>(
    case: &Case<'a>,
    title: &str,
    looks: &Looks<'_>,
    size: (u32, u32),
) -> Result<Chart<'a>, String> {
    let mut places = Vec::new();
    let svg = sheet(size, |area| draw(area, case, title, looks, &mut places))?;
    Ok(Chart { svg, places })
}

/// Draws an SVG of `size` whose black is the page's ink.
pub(crate) fn sheet(
    size: (u32, u32),
    draw: impl FnOnce(&Sheet<'_>) -> Drawing<()>,
) -> Result<String, String> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        draw(&area).and_then(|()| area.present()).map_err(|error| error.to_string())?;
    }
    Ok(svg.replace("#000000", "currentColor"))
}

/// The chart for a file of its own: black on white.
pub(crate) fn with_background(svg: &str) -> String {
    let Some(end) = svg.find('>') else { return svg.to_owned() };
    let (head, rest) = svg.split_at(end + 1);
    format!("{head}\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>{rest}")
}

/// Text of the page's ink.
pub(crate) fn ink(size: i32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&BLACK)
}

/// About how much room words take.
pub(crate) fn extent(text: &str, size: i32) -> (i32, i32) {
    ((LETTER * f64::from(size) * text.chars().count() as f64).ceil() as i32 + 4, size - 2)
}

/// From half the least to twice the largest.
pub(crate) fn span(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (low, high) =
        values.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), value| (low.min(value), high.max(value)));
    (low <= high).then_some((low / 1.8, high * 1.8))
}

fn draw<'a>(
    area: &Sheet<'_>,
    case: &Case<'a>,
    title: &str,
    looks: &Looks<'_>,
    places: &mut Vec<(&'a Record, (i32, i32))>,
) -> Drawing<()> {
    let points: Vec<Point<'a>> = case.records.iter().copied().filter_map(Point::of).collect();
    let (Some(x), Some(y)) = (span(points.iter().map(|p| p.time)), span(points.iter().map(|p| p.error)))
    else {
        return area.draw(&Text::new("no finite measurement", (20, 20), ink(17)));
    };
    // Room for the arrows of bounds.
    let y = (y.0 / 1.8, y.1);
    let (width, height) = area.dim_in_pixel();
    let narrow = width < 700;
    let keys = if narrow { NARROW_KEYS } else { WIDE_KEYS };
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .margin_top(36)
        .margin_right(28)
        .margin_bottom(14 + 19 * keys.len() as i32)
        .x_label_area_size(44)
        .y_label_area_size(if narrow { 70 } else { 80 })
        .build_cartesian_2d(
            (x.0..x.1).log_scale().with_key_points(marks_beyond(x, if narrow { 200.0 } else { 1e4 })),
            (y.0..y.1).log_scale().with_key_points(marks(y)),
        )?;
    chart
        .configure_mesh()
        .x_desc("the technique's own passes, median [ms]")
        .y_desc("relative RMSE of the airlight")
        .axis_desc_style(ink(18))
        .label_style(ink(17))
        .axis_style(BLACK)
        .bold_line_style(RGBColor(128, 128, 128).mix(0.25))
        .light_line_style(TRANSPARENT)
        .x_label_formatter(&|time| number(*time))
        .y_label_formatter(&|error| format!("{} %", number(100.0 * error)))
        .draw()?;
    area.draw(&Text::new(title.to_owned(), (12, 10), ink(20)))?;
    for (line, text) in (0..).zip(keys) {
        area.draw(&Text::new(*text, (14, height as i32 - 19 * (keys.len() as i32 - line) - 2), ink(16)))?;
    }

    let at = |time: f64, error: f64| chart.backend_coord(&(time, error));
    let (left, bottom) = at(x.0, y.0);
    let (right, top) = at(x.1, y.1);
    let mut labels = Labels::new(Area { left: left + 2, top: top + 2, right: right - 2, bottom: bottom - 2 });

    // The frontier of all, as steps: within each time, the least error to be had.
    let all = frontier(&points);
    let mut steps = Vec::new();
    let mut level = top;
    for point in &all {
        let (x, y) = at(point.time, point.error);
        steps.extend([(x, level), (x, y)]);
        level = y;
    }
    steps.push((right, level));
    area.draw(&PathElement::new(steps.clone(), RGBColor(128, 128, 128).mix(0.45).stroke_width(6)))?;
    steps.windows(2).for_each(|two| labels.block_line(two[0], two[1]));

    let hollow = dominated(&points);
    let mut curves = Vec::new();
    for technique in case.techniques() {
        let look = looks.get(technique);
        let own: Vec<Point<'a>> =
            points.iter().filter(|p| p.record.technique == technique).copied().collect();
        let line: Vec<(i32, i32)> = frontier(&own).iter().map(|point| at(point.time, point.error)).collect();
        draw_line(area, &line, look)?;
        line.windows(2).for_each(|two| labels.block_line(two[0], two[1]));
        curves.push((technique, own, line));
    }
    for (point, hollow) in points.iter().zip(hollow) {
        let place = at(point.time, point.error);
        draw_mark(area, place, looks.get(&point.record.technique), hollow, point.bound)?;
        let preset = matches!(point.record.preset.as_str(), "paper" | "default");
        if preset {
            let colour = looks.get(&point.record.technique).colour;
            area.draw(&Circle::new(place, 11, colour.stroke_width(2)))?;
        }
        labels.block(Area::about(place, if preset { 12 } else { 8 }));
        if point.bound {
            labels.block(Area { left: place.0 - 5, top: place.1, right: place.0 + 5, bottom: place.1 + 24 });
        }
        places.push((point.record, place));
    }

    // Words last: the technique's name somewhere along its curve, then the presets, then the settings at the ends.
    let name = if narrow { 17 } else { 19 };
    for (technique, own, line) in &curves {
        let middles = line.windows(2).map(|two| ((two[0].0 + two[1].0) / 2, (two[0].1 + two[1].1) / 2));
        let marks = own.iter().map(|point| at(point.time, point.error));
        let anchors: Vec<(i32, i32)> = line.iter().rev().copied().chain(middles).chain(marks).collect();
        if let Some(place) = labels.place(&anchors, extent(technique, name), true) {
            let colour = looks.get(technique).colour;
            let (wide, high) = extent(technique, name);
            let under = place.1 + high + 1;
            area.draw(&Text::new((*technique).to_owned(), place, ink(name)))?;
            draw_line(
                area,
                &[(place.0, under), (place.0 + wide - 4, under)],
                Look { colour, ..looks.get(technique) },
            )?;
        }
    }
    for point in &points {
        let letter = match point.record.preset.as_str() {
            "paper" => "P",
            "default" => "D",
            _ => continue,
        };
        let place = at(point.time, point.error);
        if let Some(place) = labels.place(&[place], extent(letter, 19), true) {
            area.draw(&Text::new(
                letter,
                place,
                ("sans-serif", 19, FontStyle::Bold).into_font().color(&BLACK),
            ))?;
        }
    }
    for (_, own, _) in &curves {
        let own = frontier(own);
        let last = own.last().filter(|_| own.len() > 1);
        let ends = own.first().into_iter().chain(last);
        for point in ends.filter(|point| point.record.preset == "sweep") {
            let text = short(&case.setting(point.record));
            if let Some(place) = labels.place(&[at(point.time, point.error)], extent(&text, 16), false) {
                area.draw(&Text::new(text, place, ink(16)))?;
            }
        }
    }
    Ok(())
}

/// A setting without what would make it too long for a chart.
fn short(setting: &str) -> String {
    const MOST: usize = 24;
    let cut = |text: &str, at: &str| text.split(at).next().unwrap_or(text).to_owned();
    let text = cut(setting, " (");
    if text.chars().count() > MOST { cut(&text, ", ") } else { text }
}

const WIDE_KEYS: &[&str] = &[
    "Lower left is better. P the paper's setting, D the default, both ringed. Hollow: another point is faster or better and in neither worse, beyond the noise.",
    "Arrow: at most this, the reference is no surer. Lines: each one's own frontier, dashed for peers. Grey steps: the frontier of all.",
];
const NARROW_KEYS: &[&str] = &[
    "Lower left is better. P paper, D default, both ringed.",
    "Hollow: dominated by another point, beyond the noise.",
    "Arrow: at most this. Dashed: peers. Grey: frontier of all.",
];

/// A polyline in a technique's colour and dashes.
pub(crate) fn draw_line(area: &Sheet<'_>, line: &[(i32, i32)], look: Look) -> Drawing<()> {
    let style = look.colour.stroke_width(2);
    if line.len() < 2 {
        return Ok(());
    }
    match look.dash {
        Some((dash, gap)) => area.draw(&DashedPathElement::new(line.to_vec(), dash, gap, style)),
        None => area.draw(&PathElement::new(line.to_vec(), style)),
    }
}

/// A mark of a technique's shape: hollow, with an arrow down.
pub(crate) fn draw_mark(
    area: &Sheet<'_>,
    (x, y): (i32, i32),
    look: Look,
    hollow: bool,
    bound: bool,
) -> Drawing<()> {
    let corners = || look.shape.iter().map(|(dx, dy)| (x + dx, y + dy));
    if bound {
        for line in [[(x, y), (x, y + 22)], [(x - 4, y + 16), (x, y + 22)], [(x + 4, y + 16), (x, y + 22)]] {
            area.draw(&PathElement::new(line, look.colour.stroke_width(2)))?;
        }
    }
    if hollow {
        let outline: Vec<_> = corners().chain(corners().take(1)).collect();
        area.draw(&PathElement::new(outline, look.colour.stroke_width(2)))
    } else {
        area.draw(&Polygon::new(corners().collect::<Vec<_>>(), look.colour.filled()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::example;
    use crate::report::sources::cases;

    #[test]
    fn the_chart_names_everyone_and_marks_presets_and_bounds() {
        let preset = |name: &str, preset: &str, time: f64, error: f64| Record {
            preset: preset.into(),
            ..example(name, time, error)
        };
        let records = vec![
            example("ray-march-16", 0.5, 0.3),
            example("ray-march-64", 2.0, 0.08),
            preset("billeter-plv", "paper", 3.0, 0.1),
            preset("billeter-plv", "default", 1.0, 1e-9),
        ];
        let looks = Looks::of(&records);
        let draw = |records: &[Record]| {
            let cases = cases(records);
            let chart = error_against_time(&cases[0], "here", &looks, WIDE).unwrap();
            assert_eq!(chart.places.len(), records.len());
            chart.svg
        };
        let svg = draw(&records);
        // One name each, the two presets, and the ends of the march's curve.
        for (wanted, times) in [
            (">\nray-march\n", 1),
            (">\nbilleter-plv\n", 1),
            (">\nP\n", 1),
            (">\nD\n", 1),
            (">\n64 steps\n", 2),
            ("r=\"11\"", 2),
        ] {
            assert_eq!(svg.matches(wanted).count(), times, "{wanted}");
        }
        assert!(!svg.contains("#000000"));
        assert!(with_background(&svg).contains("fill=\"white\""));
        // An arrow's three strokes more where the reference is no surer.
        let shapes = |svg: &str| (svg.matches("<polyline").count(), svg.matches("<polygon").count());
        let mut sure = records.clone();
        sure[3].error.rel_rmse = 1.000_001e-4;
        assert_eq!(shapes(&svg).0, shapes(&draw(&sure)).0 + 3);
        // The paper's setting is dominated, so hollow; nothing else is but 64 steps.
        assert_eq!(shapes(&svg).1, 2, "{svg}");
    }

    #[test]
    fn a_long_setting_is_cut() {
        let long = "8² pixels × 64 slices, 4 samples (the engines' usual)";
        assert_eq!(
            [short(long), short("64 steps, 512² map")],
            ["8² pixels × 64 slices", "64 steps, 512² map"]
        );
    }

    #[test]
    fn no_measurement_is_no_panic() {
        let records = [Record { refused: Some("no".into()), ..example("a", 0.0, f64::NAN) }];
        let chart = error_against_time(&cases(&records)[0], "here", &Looks::of(&records), NARROW).unwrap();
        assert!(chart.svg.contains("no finite measurement"));
    }
}
