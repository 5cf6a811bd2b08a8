//! The chart of error against time, as SVG text.

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::record::Record;

type Drawing<T> = Result<T, DrawingAreaErrorKind<std::io::Error>>;

/// Size of the chart \[SVG pixels\].
const SIZE: (u32, u32) = (760, 460);

/// Colours that people with any kind of colour vision can tell apart (Okabe and Ito 2008).
pub(crate) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// Error over time, both logarithmic: a curve through each technique's settings of one scene. What
/// lies below the reference's own uncertainty is drawn there, hollow: a bound, not a point. Lines and
/// letters have the colour `currentColor`, so that a page can choose it.
pub(crate) fn error_against_time(records: &[&Record]) -> Result<String, String> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        draw(&area, records).and_then(|()| area.present()).map_err(|error| error.to_string())?;
    }
    Ok(svg.replace("#000000", "currentColor"))
}

/// The chart for a file of its own: black on white.
pub(crate) fn with_background(svg: &str) -> String {
    let Some(end) = svg.find('>') else { return svg.to_owned() };
    let (head, rest) = svg.split_at(end + 1);
    format!("{head}\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>{rest}")
}

/// Where a record lies: time \[ms\], error, and whether the error is only a bound.
fn place(record: &Record) -> Option<(f64, f64, bool)> {
    let (time, error) = (record.technique_ms.p50, record.error.rel_rmse);
    let bound = error <= record.reference.uncertainty;
    let error = error.max(record.reference.uncertainty);
    (time > 0.0 && error > 0.0 && time.is_finite() && error.is_finite()).then_some((time, error, bound))
}

fn draw(area: &DrawingArea<SVGBackend<'_>, Shift>, records: &[&Record]) -> Drawing<()> {
    let places: Vec<_> = records.iter().filter_map(|record| place(record)).collect();
    let text = |size: i32| ("sans-serif", size).into_font().color(&BLACK);
    let Some(&(time, error, _)) = places.first() else {
        return area.draw(&Text::new("no finite measurement", (20, 20), text(16)));
    };
    let span = |values: &mut dyn Iterator<Item = f64>, start: f64| {
        values.fold((start, start), |(low, high), value| (low.min(value), high.max(value)))
    };
    let times = span(&mut places.iter().map(|place| place.0), time);
    let errors = span(&mut places.iter().map(|place| place.1), error);
    let (x, y) = ((times.0 / 2.0, times.1 * 2.0), (errors.0 / 2.0, errors.1 * 2.0));
    let mut chart =
        ChartBuilder::on(area).margin(12).x_label_area_size(44).y_label_area_size(80).build_cartesian_2d(
            (x.0..x.1).log_scale().with_key_points(marks(x)),
            (y.0..y.1).log_scale().with_key_points(marks(y)),
        )?;
    chart
        .configure_mesh()
        .x_desc("the technique's own passes per frame [ms], median")
        .y_desc("relative RMSE of the airlight")
        .axis_desc_style(text(17))
        .label_style(text(15))
        .axis_style(BLACK)
        .bold_line_style(RGBColor(128, 128, 128).mix(0.35))
        .light_line_style(TRANSPARENT)
        .x_label_formatter(&|time| number(*time))
        .y_label_formatter(&|error| format!("{} %", number(100.0 * error)))
        .draw()?;

    let mut taken = Vec::new();
    for (index, technique) in techniques(records).into_iter().enumerate() {
        let colour = COLOURS[index % COLOURS.len()];
        let mut points: Vec<_> = records
            .iter()
            .filter(|record| record.technique == technique)
            .filter_map(|record| place(record).map(|place| (place, record.label.as_str())))
            .collect();
        points.sort_by(|a, b| a.0.0.total_cmp(&b.0.0));
        let line = points.iter().map(|((time, error, _), _)| (*time, *error));
        chart
            .draw_series(LineSeries::new(line, colour.stroke_width(2)))?
            .label(technique)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2)));
        let at = |point: &(f64, f64, bool)| chart.backend_coord(&(point.0, point.1));
        let offsets: Vec<_> =
            points.iter().map(|(place, label)| label_offset(at(place), label, &mut taken)).collect();
        chart.draw_series(points.iter().zip(offsets).map(|(((time, error, bound), label), offset)| {
            let dot = if *bound { colour.stroke_width(2) } else { colour.filled() };
            EmptyElement::at((*time, *error))
                + Circle::new((0, 0), 5, dot)
                + Text::new((*label).to_owned(), offset, text(15))
        }))?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .label_font(text(16))
        .border_style(TRANSPARENT)
        .draw()
}

/// Where the label of a dot goes, relative to it: the first of a few places around it that is free.
fn label_offset(dot: (i32, i32), label: &str, taken: &mut Vec<(i32, i32, i32)>) -> (i32, i32) {
    let width = 7 * label.chars().count() as i32;
    let places = [(8, -16), (8, 6), (-8 - width, -16), (-8 - width, 6), (8, -32), (8, 22)];
    let free = |(x, y): (i32, i32)| {
        let left = dot.0 + x;
        taken.iter().all(|&(from, to, top)| left > to || left + width < from || (dot.1 + y - top).abs() > 14)
    };
    let offset = places.into_iter().find(|place| free(*place)).unwrap_or(places[0]);
    taken.push((dot.0 + offset.0, dot.0 + offset.0 + width, dot.1 + offset.1));
    offset
}

/// Where a logarithmic axis has its lines: 1, 2 and 5 times a power of ten, or only the powers where
/// there are many.
pub(crate) fn marks((low, high): (f64, f64)) -> Vec<f64> {
    let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let steps: &[f64] = if high / low > 1e4 { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let all = decades.flat_map(|decade| steps.iter().map(move |step| step * 10f64.powi(decade)));
    all.filter(|mark| (low..=high).contains(mark)).collect()
}

/// Techniques, each once, in the order of the records.
fn techniques<'a>(records: &[&'a Record]) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for record in records {
        if !names.contains(&record.technique.as_str()) {
            names.push(&record.technique);
        }
    }
    names
}

/// Short form of a number on a logarithmic axis.
pub(crate) fn number(value: f64) -> String {
    if (0.001..10_000.0).contains(&value) {
        let text = format!("{value:.4}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{value:.0e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_dots_in_one_place_do_not_cover_each_other() {
        let mut taken = Vec::new();
        let offsets: Vec<_> = (0..4).map(|_| label_offset((300, 200), "64 steps", &mut taken)).collect();
        assert_eq!(offsets, [(8, -16), (8, 6), (-64, -16), (-64, 6)]);
        assert_eq!(label_offset((300, 400), "64 steps", &mut taken), (8, -16));
    }

    #[test]
    fn an_axis_has_a_few_round_marks() {
        assert_eq!(marks((30.0, 700.0)), [50.0, 100.0, 200.0, 500.0]);
        assert_eq!(marks((0.5, 90_000.0)).len(), 5);
        assert_eq!([0.01, 0.5, 20.0, 1e-7].map(number), ["0.01", "0.5", "20", "1e-7"]);
    }
}
