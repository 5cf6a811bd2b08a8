//! Two failures of the paper's method that have formulas: bands about a light near a ray, and light lost between
//! lattice points; each held against what is measured, and against the default.

use std::f64::consts::PI;

use chen_planes::{Accumulation, Factor, Inputs, Options, Renderer};
use common::gpu::{Ground, PassTimer, Targets, read_image};
use common::{Camera, Light, Medium, Phase, PointLight, Scene, Term};
use glam::Vec3;
use serde::Serialize;

use super::super::plot::{Axis, Chart, Curve, Look, Numbers};
use super::super::{Origin, Press};
use super::{best, heading, paper};
use crate::cmd::reference;
use crate::failure::Failure;
use crate::interrupt;

/// Version of `banding.json`, described in results/README.md.
const SCHEMA: u32 = 1;

/// Steps of progress: two failures.
pub(super) const STEPS: u64 = 2;

/// Distances of the light from the ray over the spacing of planes.
const HEIGHTS: [f64; 9] = [0.125, 0.1875, 0.25, 0.375, 0.5, 0.75, 1.0, 1.5, 2.0];
/// Spacings of lattice points over the light's distance from the plane.
const NEARNESSES: [f64; 9] = [0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0];

/// Planes up to a reach \[m\] that leaves next to no light beyond.
const PLANES: u32 = 1024;
const REACH: f32 = 64.0;

/// Depth of the one plane that the light is before \[m\].
const DEPTH: f32 = 4.0;
/// Half the view's height there, which is the spacing of its 3x3 lattice points \[m\].
const SPACING: f32 = 2.0;

#[derive(Debug, Serialize)]
struct Failures {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    bands: Vec<Band>,
    interpolation: Vec<Lost>,
}

/// Relative errors of one ray.
#[derive(Debug, Serialize)]
struct Band {
    height_over_spacing: f64,
    /// With the light on a plane, and in the middle between two.
    formula: [f64; 2],
    measured: [f64; 2],
    default: [f64; 2],
}

/// Share of the light that is left.
#[derive(Debug, Serialize)]
struct Lost {
    spacing_over_distance: f64,
    formula: f64,
    measured: f64,
    default: f64,
}

/// Air so thin that only 1/r² matters, the eye at the origin looking along −z, a light at `position`.
fn thin_air(position: Vec3) -> Scene {
    let mut scene = Scene::empty("thin air");
    scene.lights = vec![Light::Point(PointLight { position, intensity: Vec3::ONE })];
    scene.medium = Medium::grey(1e-5, 1.0, Phase::isotropic());
    let fov_y = 2.0 * (SPACING / DEPTH).atan();
    scene.camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov_y };
    scene
}

/// Draws thin air in one setting, in pictures of `side`² pixels.
struct Bench<'a> {
    press: &'a Press<'a>,
    ground: Ground,
    targets: Targets,
    side: u32,
}

impl<'a> Bench<'a> {
    fn new(press: &'a Press<'a>, side: u32) -> Result<Self, Failure> {
        let context = press.context;
        let (device, format) = (&context.device, context.radiance_format());
        let ground = Ground::new(device, &context.queue, &thin_air(Vec3::ONE), format, 2)
            .map_err(|error| Failure::Run(error.to_string()))?;
        Ok(Self { press, ground, targets: Targets::new(device, side, side, format), side })
    }

    fn renderer(&self, options: Options) -> Result<Renderer, Failure> {
        let context = self.press.context;
        let options = Options { target_format: context.radiance_format(), ..options };
        Renderer::new(&context.device, &context.queue, &options)
            .map_err(|error| Failure::Run(error.to_string()))
    }

    /// The red of pixel `index` of what `renderer` draws with planes up to `reach` \[m\].
    fn draw(
        &mut self,
        renderer: &mut Renderer,
        scene: &Scene,
        reach: f32,
        index: usize,
    ) -> Result<f64, Failure> {
        interrupt::check()?;
        let failed = |error: &dyn std::fmt::Display| Failure::Run(format!("{}: {error}", scene.name));
        let context = self.press.context;
        let (device, queue) = (&context.device, &context.queue);
        let view = scene.camera.view(self.side, self.side);
        self.ground.prepare(device, queue, scene, &view).map_err(|error| failed(&error))?;
        let inputs = Inputs {
            view: &view,
            medium: &scene.medium,
            lights: self.ground.lights(),
            depth: &self.targets.depth,
            reach,
        };
        renderer.prepare(device, queue, &inputs).map_err(|error| failed(&error))?;
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut timer = PassTimer::off();
        self.targets.encode_clear(&mut encoder);
        self.ground.encode_shadows(&mut encoder, &mut timer);
        self.ground.encode_depth(&mut encoder, &self.targets, &mut timer);
        renderer.encode(&mut encoder, &self.targets.radiance_view, &mut timer);
        queue.submit([encoder.finish()]);
        context.wait().map_err(|error| failed(&error))?;
        let image = read_image(device, queue, &self.targets.radiance);
        image.map(|image| f64::from(image.pixels[index].x)).ok_or_else(|| failed(&"the device was lost"))
    }

    /// The same by the reference.
    fn truth(&self, scene: &Scene, index: usize) -> Result<f64, Failure> {
        let view = scene.camera.view(self.side, self.side);
        let rendered = reference(scene, &view, Term::Airlight.into(), &|_| ())?;
        let image = rendered.airlight.ok_or_else(|| Failure::Run("the reference lacks a term".into()))?;
        Ok(f64::from(image.pixels[index].x))
    }
}

/// Measures, draws and writes; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    press.progress.doing("bands");
    let bands = bands(press)?;
    press.progress.step();
    press.progress.doing("interpolation");
    let interpolation = interpolation(press)?;
    press.progress.step();
    let draw = |file: &str, chart: Chart| {
        let svg = chart.svg().map_err(|error| Failure::Run(format!("{file}: {error}")))?;
        press.text(file, &svg)
    };
    draw("banding.svg", chart_of_bands(&bands))?;
    draw("interpolation.svg", chart_of_interpolation(&interpolation))?;
    press.json("banding.json", &Failures { schema: SCHEMA, origin: press.origin(), bands, interpolation })?;
    let text = "![bands](banding.svg)\n\nA light at a distance h from a ray, planes Δ apart, in air so thin that only \
                1/r² matters: on a plane the ray gets coth(πh/Δ) − 1 too much, between planes 1 − tanh(πh/Δ) too \
                little. Measured on one ray with `Factor::Attenuation`; the default integrates each slab and has no \
                bands.\n\n\
                ![interpolation](interpolation.svg)\n\nA light at a distance a before a plane, over the middle of a \
                cell whose points are s apart: interpolated, a²/(a² + s²/2) of what the plane adds there is left. \
                Measured with `Factor::Whole`; the default interpolates nothing.\n"
        .to_owned();
    press.text("banding.md", &format!("# Two failures and their formulas\n\n{}\n{text}", heading(press)))?;
    Ok(text)
}

fn bands(press: &Press<'_>) -> Result<Vec<Band>, Failure> {
    let mut bench = Bench::new(press, 1)?;
    let wide = Options { accumulation: Accumulation::F32, ..paper(PLANES, 2) };
    let mut planes = bench.renderer(Options { factor: Factor::Attenuation, ..wide })?;
    let mut default = bench.renderer(best())?;
    let spacing = f64::from(REACH / PLANES as f32);
    let mut bands = Vec::new();
    for ratio in HEIGHTS {
        let (mut measured, mut by_default) = ([0.0; 2], [0.0; 2]);
        // Planes lie in the middles of slabs.
        for (i, shift) in [0.5, 0.0].into_iter().enumerate() {
            let depth = 0.5 * f64::from(REACH) + shift * spacing;
            let scene = thin_air(Vec3::new(0.0, (ratio * spacing) as f32, -depth as f32));
            let truth = bench.truth(&scene, 0)?;
            measured[i] = bench.draw(&mut planes, &scene, REACH, 0)? / truth - 1.0;
            by_default[i] = bench.draw(&mut default, &scene, REACH, 0)? / truth - 1.0;
        }
        let tanh = (PI * ratio).tanh();
        let formula = [1.0 / tanh - 1.0, tanh - 1.0];
        bands.push(Band { height_over_spacing: ratio, formula, measured, default: by_default });
    }
    Ok(bands)
}

fn interpolation(press: &Press<'_>) -> Result<Vec<Lost>, Failure> {
    // One plane, 2 x 2 cells, a pixel in the middle of each; the light before the middle of the upper right one.
    const PIXEL: usize = 1;
    let mut bench = Bench::new(press, 2)?;
    let whole = Options { accumulation: Accumulation::F32, ..paper(1, 3) };
    let mut interpolated = bench.renderer(whole)?;
    let mut exact = bench.renderer(Options { factor: Factor::Attenuation, ..whole })?;
    let mut default = bench.renderer(best())?;
    let mut lost = Vec::new();
    for nearness in NEARNESSES {
        let distance = SPACING / nearness as f32;
        let scene = thin_air(Vec3::new(0.5 * SPACING, 0.5 * SPACING, distance - DEPTH));
        let reach = 2.0 * DEPTH;
        let of_plane = bench.draw(&mut exact, &scene, reach, PIXEL)?;
        let measured = bench.draw(&mut interpolated, &scene, reach, PIXEL)? / of_plane;
        let by_default = bench.draw(&mut default, &scene, reach, PIXEL)? / bench.truth(&scene, PIXEL)?;
        lost.push(Lost {
            spacing_over_distance: nearness,
            formula: 1.0 / (1.0 + 0.5 * nearness * nearness),
            measured,
            default: by_default,
        });
    }
    Ok(lost)
}

/// A curve of `value` for every item.
fn curve<T>(
    items: &[T],
    label: &str,
    (look, colour): (Look, usize),
    value: impl Fn(&T) -> (f64, f64),
) -> Curve {
    Curve { label: label.into(), points: items.iter().map(value).collect(), look, colour }
}

fn chart_of_bands(bands: &[Band]) -> Chart {
    // Formulas are smooth between what was measured.
    let heights: Vec<f64> = (0..=32).map(|i| 0.125 * 16f64.powf(f64::from(i) / 32.0)).collect();
    let tanh = |height: f64| (PI * height).tanh();
    let [over, under, default] = [1, 0, 2];
    let of = |label: &str, look, value: fn(&Band) -> f64| {
        curve(bands, label, look, |band| (band.height_over_spacing, value(band)))
    };
    Chart {
        axes: [
            Axis {
                title: "distance of light and ray over spacing of planes, h/Δ",
                logarithmic: true,
                numbers: Numbers::Plain,
            },
            Axis { title: "relative error of the ray", logarithmic: false, numbers: Numbers::Percent },
        ],
        curves: vec![
            curve(&heights, "coth(πh/Δ) − 1", (Look::Line, over), |h| (*h, 1.0 / tanh(*h) - 1.0)),
            of("measured, light on a plane", (Look::Dots, over), |band| band.measured[0]),
            curve(&heights, "tanh(πh/Δ) − 1", (Look::Line, under), |h| (*h, tanh(*h) - 1.0)),
            of("measured, light between planes", (Look::Dots, under), |band| band.measured[1]),
            of("default, the worse of both", (Look::Both, default), |band| {
                if band.default[0].abs() > band.default[1].abs() { band.default[0] } else { band.default[1] }
            }),
        ],
    }
}

fn chart_of_interpolation(lost: &[Lost]) -> Chart {
    let ratios: Vec<f64> = (0..=32).map(|i| 0.5 * 16f64.powf(f64::from(i) / 32.0)).collect();
    let of = |label: &str, look, value: fn(&Lost) -> f64| {
        curve(lost, label, look, |lost| (lost.spacing_over_distance, value(lost) - 1.0))
    };
    Chart {
        axes: [
            Axis {
                title: "spacing of lattice points over distance of light and plane, s/a",
                logarithmic: true,
                numbers: Numbers::Plain,
            },
            Axis {
                title: "relative error in the middle of a cell",
                logarithmic: false,
                numbers: Numbers::Percent,
            },
        ],
        curves: vec![
            curve(&ratios, "a²/(a² + s²/2) − 1", (Look::Line, 0), |s| {
                (*s, 1.0 / (1.0 + 0.5 * s * s) - 1.0)
            }),
            of("measured", (Look::Dots, 0), |lost| lost.measured),
            of("default", (Look::Both, 2), |lost| lost.default),
        ],
    }
}
