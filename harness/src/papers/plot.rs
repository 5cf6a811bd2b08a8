//! Charts of curves, as SVG text, in the style of the comparison's.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::*;

use crate::report::looks::{COLOURS, marks, number};

type Drawing<T> = Result<T, DrawingAreaErrorKind<std::io::Error>>;

/// Size of a chart, and what its legend has of the width \[SVG pixels\].
const SIZE: (u32, u32) = (960, 460);
const LEGEND: u32 = 240;

/// How the numbers on an axis are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Numbers {
    Plain,
    Percent,
}

/// One axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    pub title: &'static str,
    pub logarithmic: bool,
    pub numbers: Numbers,
}

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Look {
    /// A formula.
    Line,
    /// Measurements without a line between them.
    Dots,
    /// Measurements, joined.
    Both,
}

/// Some points and what they are.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pub label: String,
    pub points: Vec<(f64, f64)>,
    pub look: Look,
    /// Index of its colour.
    pub colour: usize,
}

/// A whole chart.
#[derive(Clone, Debug)]
pub(super) struct Chart {
    pub axes: [Axis; 2],
    pub curves: Vec<Curve>,
}

impl Axis {
    /// Place on the axis: both kinds of axes are linear ones of these.
    fn place(&self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }

    fn text(&self, place: f64) -> String {
        let value = if self.logarithmic { 10f64.powf(place) } else { place };
        let (value, unit) = match self.numbers {
            Numbers::Plain => (value, ""),
            Numbers::Percent => (100.0 * value, " %"),
        };
        let sign = if value < 0.0 { "−" } else { "" };
        let digits = if value == 0.0 { "0".into() } else { number(value.abs()) };
        format!("{sign}{digits}{unit}")
    }

    /// The part of it that holds all values which have a place.
    fn range(&self, values: impl Iterator<Item = f64>) -> Option<Places> {
        let (low, high) = values
            .filter(|value| self.place(*value).is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low > high {
            return None;
        }
        if self.logarithmic {
            let (low, high) = (low / 1.4, high * 1.4);
            let lines = marks((low, high)).into_iter().map(|mark| self.place(mark)).collect();
            return Some(Places { range: self.place(low)..self.place(high), lines });
        }
        let room = 0.06 * (high - low).max(1e-12);
        let (low, high) = (low - room, high + room);
        let power = 10f64.powf(((high - low) / 5.0).log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|step| step * power)
            .into_iter()
            .find(|step| (high - low) / step <= 8.0)
            .unwrap_or(power);
        let lines = (low / step).ceil() as i64..=(high / step).floor() as i64;
        Some(Places { range: low..high, lines: lines.map(|line| line as f64 * step).collect() })
    }
}

/// From where to where, and the lines between.
struct Places {
    range: Range<f64>,
    lines: Vec<f64>,
}

impl Ranged for Places {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, place: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (place - self.range.start) / (self.range.end - self.range.start);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.lines.clone()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl Chart {
    /// Black on white.
    pub(super) fn svg(&self) -> Result<String, String> {
        let mut svg = String::new();
        {
            let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
            area.fill(&WHITE)
                .and_then(|()| self.draw(&area))
                .and_then(|()| area.present())
                .map_err(|error| error.to_string())?;
        }
        Ok(svg)
    }

    fn draw(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Drawing<()> {
        let text = |size: i32| ("sans-serif", size).into_font().color(&BLACK);
        let all = || self.curves.iter().flat_map(|curve| &curve.points);
        let [across, up] = self.axes;
        let (Some(x), Some(y)) =
            (across.range(all().map(|point| point.0)), up.range(all().map(|point| point.1)))
        else {
            return area.draw(&Text::new("no finite measurement", (20, 20), text(16)));
        };
        let (plot, beside) = area.split_horizontally(SIZE.0 - LEGEND);
        let mut chart = ChartBuilder::on(&plot)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(80)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(across.title)
            .y_desc(up.title)
            .axis_desc_style(text(17))
            .label_style(text(15))
            .axis_style(BLACK)
            .bold_line_style(RGBColor(128, 128, 128).mix(0.35))
            .light_line_style(TRANSPARENT)
            .x_label_formatter(&|place| across.text(*place))
            .y_label_formatter(&|place| up.text(*place))
            .draw()?;
        // Beside the plot, where no curve can run into it.
        for (curve, y) in self.curves.iter().zip((34..).step_by(24)) {
            let colour = COLOURS[curve.colour % COLOURS.len()];
            let points: Vec<(f64, f64)> = curve
                .points
                .iter()
                .map(|point| (across.place(point.0), up.place(point.1)))
                .filter(|(x, y)| x.is_finite() && y.is_finite())
                .collect();
            if curve.look != Look::Line {
                chart.draw_series(points.iter().map(|point| Circle::new(*point, 4, colour.filled())))?;
                beside.draw(&Circle::new((11, y), 4, colour.filled()))?;
            }
            if curve.look != Look::Dots {
                chart.draw_series(LineSeries::new(points, colour.stroke_width(2)))?;
                beside.draw(&PathElement::new([(2, y), (20, y)], colour.stroke_width(2)))?;
            }
            beside.draw(&Text::new(curve.label.as_str(), (28, y - 8), text(15)))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHARE: Axis = Axis { title: "share", logarithmic: false, numbers: Numbers::Percent };

    #[test]
    fn axes_have_round_lines_and_leave_out_what_has_no_place() {
        let planes = Axis { title: "planes", logarithmic: true, numbers: Numbers::Plain };
        let Places { range, lines } = planes.range([4.0, 0.0, 512.0, f64::NAN].into_iter()).unwrap();
        assert!(range.start < 4f64.log10() && range.end > 512f64.log10());
        assert_eq!(lines.iter().map(|line| planes.text(*line)).collect::<Vec<_>>()[..3], ["5", "10", "20"]);
        let lines = SHARE.range([-0.6, 1.7].into_iter()).unwrap().lines;
        let texts: Vec<String> = lines.iter().map(|line| SHARE.text(*line)).collect();
        assert_eq!(texts, ["−50 %", "0 %", "50 %", "100 %", "150 %"]);
        assert!(planes.range([0.0].into_iter()).is_none());
    }

    #[test]
    fn a_chart_holds_its_words_and_one_without_points_says_so() {
        let curve = Curve {
            label: "paper".into(),
            points: vec![(1.0, 0.1), (2.0, 0.3)],
            look: Look::Both,
            colour: 0,
        };
        let chart = |curves| Chart { axes: [Axis { title: "across", ..SHARE }, SHARE], curves };
        let svg = chart(vec![curve]).svg().unwrap();
        assert!(["paper", "across", "share"].iter().all(|word| svg.contains(word)), "{svg}");
        assert!(chart(vec![]).svg().unwrap().contains("no finite measurement"));
    }
}
