//! Error against the number of planes and against time, for the paper's method and for each change to it.

use chen_planes::{Accumulation, Factor, Options, Placement, Visibility};
use common::gpu::bench::scenes::{boxes, cuboid};
use common::{DirectionalLight, Light, Scene};
use glam::Vec3;
use serde::Serialize;

use super::super::plot::{Axis, Chart, Curve, Look, Numbers};
use super::super::{Origin, Press, cells};
use super::{PLANES, best, errors, paper, technique, truth};
use crate::cmd::load;
use crate::failure::Failure;
use crate::fit::Fit;
use crate::interrupt;
use crate::measure::{Drawn, Stage};
use crate::report::{digits, markdown, percent};

/// Version of `convergence.json`, described in results/README.md.
const SCHEMA: u32 = 1;

/// Steps of progress: one for each scene.
pub(super) const STEPS: u64 = 3;

const COUNTS: [u32; 8] = [4, 8, 16, 32, 64, 128, 256, 512];

/// Texels on a side of shadow maps: so fine that planes are to blame for the errors.
const SHADOW_MAP: u32 = 2048;

/// Lattice points each way at most: as in rows 4(a) and 4(e).
const POINTS: u32 = 32;

/// The default is tried with 8 places where shadows are looked up in each slab, so that more slabs show: 64 of its planes
/// look as often as 512 of the paper's.
const DEFAULT_MOST: u32 = 64;
const PLACES: Visibility = Visibility::PerFragment { samples: 8 };

/// With a doubling of the planes the error of a curve that falls goes below this part of it.
const FALLING: f64 = 0.8;

/// What is timed is drawn again while it took less than this \[ms\].
const AGAIN_BELOW: f64 = 1000.0;

/// A setting in a chart: the paper's with one change, its most planes, and whether its times are wanted.
struct Setting {
    name: &'static str,
    options: Options,
    most: u32,
    timed: bool,
}

/// The paper's, each placement, each factor, other shadows, and the default.
fn settings(points: u32) -> [Setting; 9] {
    let paper = Options { accumulation: Accumulation::F32, ..paper(1, points) };
    let setting = |name, options| Setting { name, options, most: 512, timed: false };
    [
        Setting { timed: true, ..setting("paper", paper) },
        setting("equi-angular", Options { placement: Placement::EquiAngular, ..paper }),
        setting("transmittance", Options { placement: Placement::Transmittance, ..paper }),
        setting("integrand", Options { placement: Placement::Integrand, ..paper }),
        setting("attenuation", Options { factor: Factor::Attenuation, ..paper }),
        setting("integrated", Options { factor: Factor::Integrated, ..paper }),
        setting("lattice shadows", Options { visibility: Visibility::PerLatticePoint, ..paper }),
        Setting { most: DEFAULT_MOST, ..setting("8 places", Options { visibility: PLACES, ..paper }) },
        Setting {
            most: DEFAULT_MOST,
            timed: true,
            ..setting("default, 8 places", Options { visibility: PLACES, ..best() })
        },
    ]
}

/// Without shadows there is less to tell apart.
const OPEN_AIR: &[&str] = &["paper", "transmittance", "integrated", "default, 8 places"];

/// The charts of a scene: part of the file's name, and which settings are in it.
const CHARTS: [(&str, &[&str]); 2] = [
    ("placement", &["paper", "equi-angular", "transmittance", "integrand", "default, 8 places"]),
    ("method", &["paper", "attenuation", "integrated", "lattice shadows", "8 places", "default, 8 places"]),
];

#[derive(Debug, Serialize)]
struct Convergence {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    shadow_map_size: u32,
    lattice: [u32; 2],
    scenes: Vec<OfScene>,
}

#[derive(Debug, Serialize)]
struct OfScene {
    scene: String,
    /// Relative RMS error that the reference itself may have.
    uncertainty: f64,
    curves: Vec<OfSetting>,
}

#[derive(Debug, Serialize)]
struct OfSetting {
    setting: &'static str,
    points: Vec<Point>,
    /// Line through the logarithms of the first few points, until the curve flattens: its slope is the order.
    order: Option<Fit>,
    order_points: usize,
}

#[derive(Debug, Serialize)]
struct Point {
    planes: u32,
    rel_rmse: f64,
    bias: f64,
    /// The planes' pass, the least of a few; null where it was not taken.
    planes_ms: Option<f64>,
}

/// Nothing but air between an eye and a wall, the sun from behind: no edge of a shadow anywhere.
fn open_air() -> Scene {
    let sun = DirectionalLight { direction: Vec3::NEG_Z, irradiance: Vec3::ONE };
    let mut scene = boxes(Light::Directional(sun), 0.2);
    scene.name = "open air".into();
    scene.objects = vec![cuboid(Vec3::new(-20.0, -12.0, -7.0), Vec3::new(20.0, 14.0, -6.5))];
    scene
}

/// Measures and draws; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let named = |name| load(name, None, |note| press.progress.say(note));
    // Cells finer than pixels would be work for nothing.
    let lattice = POINTS.min(press.timed_size.0.min(press.timed_size.1)).max(2);
    let all = settings(lattice).map(|setting| setting.name);
    let mut scenes = Vec::new();
    for (scene, wanted) in [(named("cathedral")?, &all[..]), (named("window")?, &all), (open_air(), OPEN_AIR)]
    {
        scenes.push(of_scene(press, &scene, wanted, lattice)?);
        press.progress.step();
    }
    let mut text = format!(
        "Relative RMSE of the airlight with 4 to 512 planes, shadow maps of {SHADOW_MAP}². The paper's setting has \
         lattices of {lattice}x{lattice} here and sums in 32 bits; each other curve changes one thing of it, and \
         \"default\" is the best that we know with so many planes (up to {DEFAULT_MOST}, which with its 8 places \
         each is as much work as 512 of the paper's). In the legends: the order, which is the slope of a line through \
         the points until the curve flattens, that is without the doublings at the end that each take less than a \
         fifth of the error away. An edge of a shadow is off by up to half a spacing, which makes −1; where all is \
         smooth the midpoint rule has −2. A curve that flattens has met what more planes hardly help: the lattice, rays that pass \
         a light nearer than planes are to each other, or the texels of the shadow map.\n\n"
    );
    for of_scene in &scenes {
        text += &charts(press, of_scene)?;
    }
    text += &orders(&scenes);
    let all = Convergence {
        schema: SCHEMA,
        origin: press.origin(),
        shadow_map_size: SHADOW_MAP,
        lattice: [lattice; 2],
        scenes,
    };
    press.json("convergence.json", &all)?;
    Ok(text)
}

fn of_scene(press: &Press<'_>, scene: &Scene, wanted: &[&str], lattice: u32) -> Result<OfScene, Failure> {
    press.progress.doing(&format!("convergence: {}", scene.name));
    let truth = truth(press, scene)?;
    let mut stage = Stage::new(press.context, scene, press.timed_size, SHADOW_MAP)?;
    // All pictures share its shadow maps and depth.
    stage.picture(None, 0.0, Drawn::Airlight)?;
    let mut curves = Vec::new();
    let settings = settings(lattice).into_iter().filter(|setting| wanted.contains(&setting.name));
    for Setting { name, options, most, timed } in settings {
        let mut points = Vec::new();
        for planes in COUNTS.into_iter().filter(|planes| *planes <= most) {
            interrupt::check()?;
            press.progress.detail(format!("convergence: {}, {name}, {planes} planes", scene.name));
            let mut technique = technique(press, Options { planes, ..options }, press.timed_size)?;
            let (image, passes) = stage.airlight_again(technique.as_mut(), 0.0)?;
            let mut least = passes.get(PLANES).copied();
            for _ in 0..2 {
                if let Some(ms) = least.filter(|ms| timed && *ms < AGAIN_BELOW) {
                    let (_, passes) = stage.airlight_again(technique.as_mut(), 0.0)?;
                    least = passes.get(PLANES).map(|again| again.min(ms));
                }
            }
            let error = errors(&image, &truth)?;
            points.push(Point {
                planes,
                rel_rmse: error.rel_rmse,
                bias: error.bias,
                planes_ms: least.filter(|_| timed),
            });
        }
        let places: Vec<_> = points.iter().map(|p| (f64::from(p.planes), p.rel_rmse)).collect();
        let falling = falling(&places);
        let order = Fit::power(falling).filter(|_| falling.len() > 2);
        curves.push(OfSetting { setting: name, points, order, order_points: falling.len() });
    }
    Ok(OfScene { scene: scene.name.clone(), uncertainty: truth.uncertainty, curves })
}

/// The points without the flat end of their curve.
fn falling(points: &[(f64, f64)]) -> &[(f64, f64)] {
    let last = points.windows(2).rposition(|pair| pair[1].1 < FALLING * pair[0].1);
    &points[..last.map_or(0, |last| last + 2)]
}

/// An order with its sign.
fn order_text(order: Fit) -> String {
    format!("{:.2}", order.slope).replace('-', "−")
}

const ERROR: Axis =
    Axis { title: "relative RMSE of the airlight", logarithmic: true, numbers: Numbers::Percent };
const PLANES_AXIS: Axis = Axis { title: "planes for each light", logarithmic: true, numbers: Numbers::Plain };
const TIME: Axis = Axis { title: "the planes' pass [ms]", logarithmic: true, numbers: Numbers::Plain };

/// Writes a scene's charts; gives the lines that show them.
fn charts(press: &Press<'_>, of_scene: &OfScene) -> Result<String, Failure> {
    let scene = &of_scene.scene;
    let mut text = format!("### {scene}\n\n");
    let mut show = |kind: &str, chart: Chart| -> Result<(), Failure> {
        let file = format!("convergence-{}-{kind}.svg", scene.replace(' ', "-"));
        let svg = chart.svg().map_err(|error| Failure::Run(format!("{file}: {error}")))?;
        press.text(&file, &svg)?;
        text += &format!("![{scene}, {kind}]({file})\n\n");
        Ok(())
    };
    // Open air has but one of placement, in the chart of methods.
    let open = of_scene.curves.len() == OPEN_AIR.len();
    let kinds: &[(&str, &[&str])] = if open { &[("method", OPEN_AIR)] } else { &CHARTS };
    for (kind, names) in kinds {
        let of = |name: &&str| of_scene.curves.iter().find(|curve| curve.setting == *name);
        let curves = names.iter().filter_map(of).enumerate().map(|(colour, curve)| Curve {
            label: curve
                .order
                .map_or(curve.setting.into(), |order| format!("{}, {}", curve.setting, order_text(order))),
            points: curve.points.iter().map(|point| (f64::from(point.planes), point.rel_rmse)).collect(),
            look: Look::Both,
            colour,
        });
        show(kind, Chart { axes: [PLANES_AXIS, ERROR], curves: curves.collect() })?;
    }
    let timed = |curve: &OfSetting| -> Vec<(f64, f64)> {
        curve.points.iter().filter_map(|point| Some((point.planes_ms?, point.rel_rmse))).collect()
    };
    let curves = of_scene.curves.iter().filter(|curve| !timed(curve).is_empty()).enumerate();
    let curves = curves.map(|(colour, curve)| Curve {
        label: curve.setting.into(),
        points: timed(curve),
        look: Look::Both,
        colour,
    });
    show("time", Chart { axes: [TIME, ERROR], curves: curves.collect() })?;
    Ok(text)
}

/// The orders and a few of the errors.
fn orders(scenes: &[OfScene]) -> String {
    let mut rows =
        vec![cells(["scene", "setting", "order", "R²", "of points", "8 planes", "64 planes", "512 planes"])];
    for of_scene in scenes {
        for curve in &of_scene.curves {
            let error = |planes: u32| {
                let point = curve.points.iter().find(|point| point.planes == planes);
                point.map_or("–".into(), |point| percent(point.rel_rmse))
            };
            let (order, r2) =
                curve.order.map_or(("–".into(), "–".into()), |fit| (order_text(fit), digits(fit.r2)));
            let (scene, setting) = (of_scene.scene.clone(), curve.setting.to_owned());
            let count = curve.order_points.to_string();
            rows.push(vec![scene, setting, order, r2, count, error(8), error(64), error(512)]);
        }
    }
    markdown::table(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_of_a_chart_is_a_setting() {
        let all = settings(POINTS).map(|setting| setting.name);
        assert!(CHARTS.iter().flat_map(|(_, names)| *names).all(|name| all.contains(name)));
        assert!(all.iter().all(|name| CHARTS.iter().any(|(_, names)| names.contains(name))));
    }

    #[test]
    fn an_order_is_of_what_falls() {
        let points = [(4.0, 1.0), (8.0, 0.9), (16.0, 0.4), (32.0, 0.2), (64.0, 0.19), (128.0, 0.19)];
        assert_eq!(falling(&points), &points[..4]);
        assert_eq!(falling(&points[4..]), &[]);
    }
}
