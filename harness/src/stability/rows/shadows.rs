//! Shadows: resolution, crossings, overlaps.

use common::Scene;
use glam::Vec3;

use crate::stability::row::{Entry, Parameter, Part, Row, Setup, all, defaults, named};
use crate::stability::scenes::{bars, boxed, posts, posts_with};

fn map(texels: f64) -> Setup {
    Setup::of(bars(16)).on_maps_of(texels as u32)
}

/// Texels on a side of the map that thin bars are measured in.
const MAP: u32 = 128;
/// From the lamp to the bars \[m\]; a face of the map is twice that wide there.
const TO_BARS: f64 = 1.513;

fn thin_bars(texels: f64) -> Setup {
    let width = texels * 2.0 * TO_BARS / f64::from(MAP);
    Setup::of(bars((4.0 / (2.0 * width)).round() as u32)).on_maps_of(MAP)
}

/// Bars seen along their row, so that rays cross many shadows.
fn crossings(count: f64) -> Setup {
    let mut scene = bars(count as u32);
    scene.camera.eye = Vec3::new(5.513, 1.071, 0.617);
    scene.camera.target = Vec3::new(0.0, 0.917, 1.2);
    Setup::of(scene).on_maps_of(2048)
}

fn crossers(_: f64) -> Vec<Entry> {
    let mut entries = defaults(0.0);
    entries.extend(named(&["billeter-plv-paper", "biri-ss-paper"]));
    entries
}

/// Plates behind each other, a lamp on one side, the eye on the other.
fn stacked(count: f64) -> Setup {
    let mut scene = posts();
    let plate = |index: u32| {
        let x = -1.0 + 0.004 * index as f32;
        boxed([x, 0.35, -1.5], [x + 0.002, 1.75, 0.3])
    };
    scene.objects = (0..count as u32).map(plate).collect();
    scene.lights = vec![crate::stability::scenes::lamp(Vec3::new(-2.113, 1.013, -0.611), 20.0)];
    scene.camera.eye = Vec3::new(3.113, 1.217, 0.207);
    scene.camera.target = Vec3::new(-1.0, 0.957, -0.4);
    Setup::of(scene)
}

/// The same from aside, in none of these shadows.
fn stacked_aside(count: f64) -> Setup {
    let mut setup = stacked(count);
    let camera = &mut setup.frames[0].scene.camera;
    camera.eye = Vec3::new(0.713, 1.317, 4.207);
    camera.target = Vec3::new(0.4, 0.957, -0.6);
    setup
}

/// A floor that a lamp grazes: the mesh of the light volume lies in it.
fn grazed(height: f64) -> Setup {
    Setup::of(posts_with(|scene: &mut Scene| {
        scene.objects.truncate(3);
        scene.lights = vec![crate::stability::scenes::lamp(Vec3::new(-3.617, height as f32, 2.711), 20.0)];
    }))
}

pub(super) fn rows() -> Vec<Row> {
    let number = |name, unit, values| Parameter::Number { name, unit, values };
    vec![
        Row {
            id: "shadow-map",
            title: "the shadow map's resolution",
            why: "Edges of shadows are as sharp as a texel: the error falls in proportion to it.",
            parameter: number(
                "texels on a side",
                "",
                &[4096.0, 2048.0, 1024.0, 512.0, 256.0, 128.0, 64.0, 16.0, 2.0],
            ),
            quick: &[1024.0, 64.0],
            build: map,
            law: |texels| (1024.0 / texels).max(1.0),
            ..Row::of(Part::Shadows)
        },
        Row {
            id: "thin-bars",
            title: "bars thinner than a texel of the shadow map",
            why: "What falls between texel centres is not in the map: too much light, or too little.",
            parameter: number("width in texels", "", &[10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1]),
            quick: &[10.0, 0.5],
            build: thin_bars,
            law: |texels| (10.0 / texels).max(1.0),
            ..Row::of(Part::Shadows)
        },
        Row {
            id: "crossings",
            title: "rays that cross many shadows",
            why: "Signed sums of 16 bits gather rounding with each crossing.",
            parameter: number("bars", "", &[8.0, 32.0, 128.0, 512.0]),
            quick: &[32.0],
            build: crossings,
            methods: crossers,
            ..Row::of(Part::Shadows)
        },
        Row {
            id: "stacked",
            title: "shadows upon shadows",
            why: "A stencil of 8 bits counts to 255.",
            parameter: number("plates behind each other", "", &[1.0, 10.0, 100.0, 250.0, 260.0, 400.0]),
            quick: &[260.0],
            build: stacked,
            methods: all,
            ..Row::of(Part::Shadows)
        },
        Row {
            id: "stacked-aside",
            title: "shadows upon shadows, seen from aside",
            why: "Eight bits again, where the eye itself is in no shadow.",
            parameter: number("plates behind each other", "", &[1.0, 10.0, 100.0, 250.0, 260.0, 400.0]),
            quick: &[260.0],
            build: stacked_aside,
            methods: all,
            ..Row::of(Part::Shadows)
        },
        Row {
            id: "grazed",
            title: "light along a floor",
            why: "The boundary of the lit volume lies in the surface: the depth test has no side to take, and depths \
                  change by much from texel to texel.",
            parameter: number("height of the lamp", "m", &[1.0, 0.3, 0.1, 0.03, 0.01]),
            quick: &[0.01],
            build: grazed,
            ..Row::of(Part::Shadows)
        },
    ]
}
