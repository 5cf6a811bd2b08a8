//! Smaller charts: how time grows, and what models miss.

use plotters::prelude::*;

use crate::record::Record;
use crate::report::chart::{Drawing, Sheet, draw_line, draw_mark, extent, ink, sheet, span};
use crate::report::labels::{Area, Labels};
use crate::report::looks::{Look, Looks, marks, number};
use crate::report::scaling::Scaling;

const SIZE: (u32, u32) = (640, 440);

/// An empty chart with two logarithmic axes; gives its place finder.
type Finder = Box<dyn Fn(f64, f64) -> (i32, i32)>;

fn axes(
    area: &Sheet<'_>,
    (x, x_title): ((f64, f64), &str),
    (y, y_title): ((f64, f64), &str),
    as_percent: bool,
) -> Drawing<(Finder, Labels)> {
    let mut chart =
        ChartBuilder::on(area).margin(10).x_label_area_size(44).y_label_area_size(80).build_cartesian_2d(
            (x.0..x.1).log_scale().with_key_points(marks(x)),
            (y.0..y.1).log_scale().with_key_points(marks(y)),
        )?;
    let text = |value: f64| if as_percent { format!("{} %", number(100.0 * value)) } else { number(value) };
    chart
        .configure_mesh()
        .x_desc(x_title)
        .y_desc(y_title)
        .axis_desc_style(ink(17))
        .label_style(ink(16))
        .axis_style(BLACK)
        .bold_line_style(RGBColor(128, 128, 128).mix(0.25))
        .light_line_style(TRANSPARENT)
        .x_label_formatter(&|value| if as_percent { text(*value) } else { number(*value) })
        .y_label_formatter(&|value| text(*value))
        .draw()?;
    let (left, bottom) = chart.backend_coord(&(x.0, y.0));
    let (right, top) = chart.backend_coord(&(x.1, y.1));
    let place = move |value: f64, (low, high): (f64, f64), from: i32, to: i32| {
        from + ((value / low).ln() / (high / low).ln() * f64::from(to - from)).round() as i32
    };
    let finder = move |across: f64, up: f64| (place(across, x, left, right), place(up, y, bottom, top));
    Ok((
        Box::new(finder),
        Labels::new(Area { left: left + 2, top: top + 2, right: right - 2, bottom: bottom - 2 }),
    ))
}

/// Time over what a study varies: solid the technique's own passes, dashed with the ground.
pub(crate) fn growth(scaling: &Scaling<'_>, looks: &Looks<'_>) -> Result<String, String> {
    sheet(SIZE, |area| {
        let all = || scaling.curves.iter().flat_map(|curve| &curve.points);
        let (Some(x), Some(y)) = (span(all().map(|p| p.0)), span(all().flat_map(|p| [p.1, p.2]))) else {
            return area.draw(&Text::new("no finite measurement", (20, 20), ink(16)));
        };
        let (at, mut labels) = axes(area, (x, scaling.axis), (y, "median time [ms]"), false)?;
        let mut ends = Vec::new();
        for curve in &scaling.curves {
            let look = looks.get(curve.technique);
            let line = |time: fn(&(f64, f64, f64)) -> f64| -> Vec<(i32, i32)> {
                curve.points.iter().map(|point| at(point.0, time(point))).collect()
            };
            let (own, total) = (line(|point| point.1), line(|point| point.2));
            draw_line(area, &own, Look { dash: None, ..look })?;
            draw_line(area, &total, Look { dash: Some((5, 5)), ..look })?;
            for place in &own {
                draw_mark(area, *place, look, curve.name.contains("-paper"), false)?;
                labels.block(Area::about(*place, 7));
            }
            for line in [&own, &total] {
                line.windows(2).for_each(|two| labels.block_line(two[0], two[1]));
            }
            ends.push((curve.name, own));
        }
        for (name, own) in ends {
            let anchors: Vec<_> = own.into_iter().rev().collect();
            if let Some(place) = labels.place(&anchors, extent(name, 16), true) {
                area.draw(&Text::new(name.to_owned(), place, ink(16)))?;
            }
        }
        Ok(())
    })
}

/// What is missed of all light over what is wrong with the terms that are drawn; on the diagonal the model is whole.
pub(crate) fn model(records: &[&Record], looks: &Looks<'_>) -> Result<String, String> {
    sheet(SIZE, |area| {
        let errors = |record: &&Record| {
            let model = record.model_error.as_ref()?;
            let own = record.error.rel_rmse.max(record.reference.uncertainty);
            (own > 0.0 && own.is_finite() && model.rel_rmse > 0.0).then_some((own, model.rel_rmse))
        };
        let points: Vec<(f64, f64)> = records.iter().filter_map(errors).collect();
        let (Some(x), Some(y)) = (span(points.iter().map(|p| p.0)), span(points.iter().map(|p| p.1))) else {
            return area.draw(&Text::new("no finite measurement", (20, 20), ink(16)));
        };
        let titles = ("against its own terms: rel. RMSE", "against all terms: rel. RMSE");
        let (at, mut labels) = axes(area, (x, titles.0), (y, titles.1), true)?;
        let (from, to) = (x.0.max(y.0), x.1.min(y.1));
        if from < to {
            let line = [at(from, from), at(to, to)];
            area.draw(&PathElement::new(line, RGBColor(128, 128, 128).stroke_width(1)))?;
            labels.block_line(line[0], line[1]);
        }
        let mut names: Vec<(&str, Vec<(i32, i32)>)> = Vec::new();
        for record in records {
            let Some((own, all)) = errors(record) else { continue };
            let place = at(own, all);
            draw_mark(area, place, looks.get(&record.technique), record.preset == "paper", false)?;
            labels.block(Area::about(place, 8));
            match names.iter_mut().find(|(name, _)| *name == record.technique) {
                Some((_, places)) => places.push(place),
                None => names.push((&record.technique, vec![place])),
            }
        }
        for (name, places) in names {
            if let Some(place) = labels.place(&places, extent(name, 16), true) {
                area.draw(&Text::new(name.to_owned(), place, ink(16)))?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::example;
    use crate::record::{ModelError, Study};
    use crate::report::scaling::scalings;

    #[test]
    fn a_study_is_drawn_with_and_without_the_ground() {
        let record = |triangles, time| Record {
            study: Study::Triangles,
            triangles,
            ..example("biri-ss-default", time, 0.01)
        };
        let records = [record(100, 1.0), record(1000, 2.0)];
        let svg = growth(&scalings(&records)[0], &Looks::of(&records)).unwrap();
        assert!(svg.contains("triangles") && svg.contains("biri-ss-default"));
        assert_eq!(svg.matches("<polygon").count(), 2);
    }

    #[test]
    fn models_are_drawn_where_they_are_known() {
        let model = ModelError { terms: vec!["multiple".into()], rel_rmse: 0.4, bias: -0.3, noise: 0.01 };
        let record = Record { model_error: Some(model), ..example("biri-ss", 2.0, 0.01) };
        let svg = super::model(&[&record], &Looks::of(std::slice::from_ref(&record))).unwrap();
        assert_eq!(svg.matches("<polygon").count(), 1);
        assert!(super::model(&[], &Looks::of(&[])).unwrap().contains("no finite"));
    }
}
