//! How time grows with triangles, lights, pixels, texels and edges.

use crate::fit::Fit;
use crate::record::{Record, Study};
use crate::report::digits;
use crate::report::sources::once;
use crate::report::tables::{Cell, Table};

/// What is varied in each study: its heading, the axis, and where a record lies on it.
type Axis = (Study, &'static str, &'static str, fn(&Record) -> Option<f64>);

const AXES: [Axis; 5] = [
    (Study::Triangles, "Time against triangles", "triangles", |r| Some(r.triangles as f64)),
    (Study::Lights, "Time against lights", "lights", |r| Some(r.lights as f64)),
    (Study::Resolution, "Time against resolution", "pixels", |r| {
        Some(f64::from(r.width) * f64::from(r.height))
    }),
    (Study::ShadowMap, "Time against the size of shadow maps", "texels on a side of a shadow map", |r| {
        Some(r.shadow_map_size()? as f64)
    }),
    (Study::Edges, "Time against silhouette edges", "silhouette edges", |r| Some(r.silhouette_edges? as f64)),
];

/// One study of one thing.
#[derive(Clone, Debug)]
pub(crate) struct Scaling<'a> {
    pub title: &'static str,
    pub axis: &'static str,
    /// What stays the same: scene, size of pictures and of maps, lights, adapter, but for what is varied.
    pub what: String,
    pub curves: Vec<Growth<'a>>,
}

/// How the time of one technique in one setting grows.
#[derive(Clone, Debug)]
pub(crate) struct Growth<'a> {
    pub name: &'a str,
    pub technique: &'a str,
    /// Where, the technique's own passes, and those with the ground \[ms\].
    pub points: Vec<(f64, f64, f64)>,
}

impl Growth<'_> {
    /// Power laws of the technique's own time and of the total.
    fn laws(&self) -> [Option<Fit>; 2] {
        let of = |time: fn(&(f64, f64, f64)) -> f64| -> Option<Fit> {
            Fit::power(&self.points.iter().map(|point| (point.0, time(point))).collect::<Vec<_>>())
        };
        [of(|point| point.1), of(|point| point.2)]
    }
}

/// All studies of scaling that have records.
pub(crate) fn scalings(records: &[Record]) -> Vec<Scaling<'_>> {
    let mut scalings = Vec::new();
    for (study, title, axis, place) in AXES {
        let of: Vec<&Record> =
            records.iter().filter(|record| record.study == study && record.refused.is_none()).collect();
        let what: Vec<String> = of.iter().map(|record| what(record)).collect();
        for same in once(what.iter().map(String::as_str)) {
            let here = of.iter().zip(&what).filter(|(_, what)| *what == same);
            let of: Vec<&Record> = here.map(|(record, _)| *record).collect();
            let curves: Vec<Growth<'_>> = once(of.iter().map(|record| plain(record)))
                .into_iter()
                .filter_map(|name| growth(&of, name, place))
                .collect();
            if !curves.is_empty() {
                scalings.push(Scaling { title, axis, what: same.to_owned(), curves });
            }
        }
    }
    scalings
}

/// What a study of scaling leaves as it is.
fn what(record: &Record) -> String {
    let Record { study, scene, width, height, lights, adapter, .. } = record;
    let mut text = scene.clone();
    if *study != Study::Resolution {
        text += &format!(", {width} × {height}");
    }
    if let Some(side) = record.shadow_map_size().filter(|_| *study != Study::ShadowMap) {
        text += &format!(", {side}² maps");
    }
    if *study != Study::Lights {
        text += &format!(", {lights} {}", if *lights == 1 { "light" } else { "lights" });
    }
    text + ", " + adapter
}

/// The name without the size of shadow maps behind it.
fn plain(record: &Record) -> &str {
    record.name.split('@').next().unwrap_or(&record.name)
}

/// `None` of less than two places.
fn growth<'a>(records: &[&'a Record], name: &str, place: fn(&Record) -> Option<f64>) -> Option<Growth<'a>> {
    let of: Vec<&'a Record> = records.iter().filter(|record| plain(record) == name).copied().collect();
    let first = *of.first()?;
    let point = |record: &&Record| {
        let own = record.technique_ms.p50;
        let at = place(record).filter(|at| *at > 0.0)?;
        (own > 0.0).then_some((at, own, own + record.ground_ms()))
    };
    let mut points: Vec<(f64, f64, f64)> = of.iter().filter_map(point).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let apart = points.first()?.0 < points.last()?.0;
    apart.then_some(Growth { name: plain(first), technique: &first.technique, points })
}

/// The exponents.
pub(crate) fn table(scaling: &Scaling<'_>) -> Table {
    let head = [
        "setting",
        "exponent",
        "R²",
        "with the ground",
        "R² ",
        "from",
        "to",
        "ms at the start",
        "ms at the end",
    ];
    let mut table = Table::new(1, head);
    for curve in &scaling.curves {
        let (Some(first), Some(last)) = (curve.points.first(), curve.points.last()) else { continue };
        let number = |value: f64| Cell::number(digits(value), value);
        let count = |value: f64| Cell::number(format!("{value:.0}"), value);
        let mut row = vec![curve.name.into()];
        for law in curve.laws() {
            row.extend(match law {
                Some(Fit { slope, r2, .. }) => {
                    let sign = if slope < 0.0 { "−" } else { "" };
                    [
                        Cell::number(format!("{sign}{:.2}", slope.abs()), slope),
                        Cell::number(format!("{r2:.2}"), r2),
                    ]
                }
                None => [(); 2].map(|()| Cell::number("–".into(), f64::INFINITY)),
            });
        }
        row.extend([count(first.0), count(last.0), number(first.1), number(last.1)]);
        table.rows.push(row);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Spread;
    use crate::record::tests::example;

    #[test]
    fn an_exponent_is_found_again() {
        let record = |triangles: usize, time: f64, ground: f64| {
            let mut record = Record { study: Study::Triangles, triangles, ..example("biri-ss", time, 0.01) };
            let pass = Spread { p50: ground, ..Default::default() };
            record.ground_passes.insert("draw".into(), pass);
            record
        };
        let mut records =
            vec![record(100, 1.0, 9.0), record(10_000, 10.0, 0.0), record(1000, 3.162_277_66, 6.8377)];
        let main = Record { study: Study::Main, ..record(5, 9.0, 9.0) };
        records.push(main);
        let scalings = scalings(&records);
        assert_eq!(scalings.len(), 1);
        let table = table(&scalings[0]);
        let row = &table.rows[0];
        let texts: Vec<&str> = row.iter().map(|cell| cell.text.as_str()).collect();
        assert_eq!((texts[1], texts[2], texts[3]), ("0.50", "1.00", "0.00"));
        assert_eq!(texts[5..], ["100", "10000", "1.00", "10.0"]);
    }

    #[test]
    fn shadow_maps_are_no_settings_of_their_own() {
        let on = |texels: u32, time: f64| {
            let mut record = example(&format!("biri-ss-default@{texels}"), time, 0.01);
            record.study = Study::ShadowMap;
            record.settings.insert("shadow_map_size".into(), texels.into());
            record
        };
        let records = [on(256, 1.0), on(512, 2.0), on(1024, 4.0)];
        // Other pictures are another study.
        let large = records.clone().map(|record| Record { width: 1280, ..record });
        let both: Vec<Record> = records.iter().cloned().chain(large).collect();
        let both = scalings(&both);
        assert_eq!((both.len(), both[0].curves[0].points.len()), (2, 3));
        assert!(both[1].what.contains("1280 × 256, 1 light, llvmpipe"), "{}", both[1].what);
        let table = table(&scalings(&records)[0]);
        assert_eq!((table.rows.len(), table.rows[0][0].text.as_str()), (1, "biri-ss-default"));
        assert_eq!(table.rows[0][1].text, "1.00");
    }

    #[test]
    fn one_place_is_no_study() {
        let one = Record { study: Study::Lights, ..example("biri-ss", 1.0, 0.01) };
        assert!(scalings(&[one.clone(), one]).is_empty());
        let edges = Record { study: Study::Edges, silhouette_edges: None, ..example("biri-ss", 1.0, 0.01) };
        assert!(scalings(&[edges]).is_empty());
    }
}
