//! How much, and of what size.

use common::{Light, PointLight};
use glam::Vec3;

use crate::stability::row::{
    Entry, Measure, Parameter, Part, Row, SIZE, Setup, Still, Truth, all, all_and_unshadowed, defaults, named,
};
use crate::stability::scenes::{INTENSITY, posts, posts_with};

/// Lamps on a spiral among the posts, all together as bright as one.
fn lights(count: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        let place = |index: u32| {
            let (turn, out) = (2.4 * index as f32, 2.9 * ((index as f32 + 0.5) / count as f32).sqrt());
            Vec3::new(out * turn.cos(), 0.4 + 0.023 * index as f32, out * turn.sin())
        };
        let light = |index| {
            Light::Point(PointLight {
                position: place(index),
                intensity: Vec3::splat(INTENSITY / count as f32),
            })
        };
        scene.lights = (0..count as u32).map(light).collect();
    }))
    .on_maps_of(256)
}

const SIZES: &[(&str, (u32, u32))] = &[
    ("97x77", SIZE),
    ("1x1", (1, 1)),
    ("2x1", (2, 1)),
    ("1x64", (1, 64)),
    ("64x1", (64, 1)),
    ("3x4", (3, 4)),
    ("255x3", (255, 3)),
    ("1023x9", (1023, 9)),
];

const SIZE_NAMES: [&str; 8] = {
    let mut names = [""; 8];
    let mut index = 0;
    while index < SIZES.len() {
        names[index] = SIZES[index].0;
        index += 1;
    }
    names
};

fn sized(which: f64) -> Setup {
    let size = SIZES[which as usize % SIZES.len()].1;
    Setup::of(posts()).of_size(size)
}

/// A picture `times` as fine, of which every so-manieth pixel is the small one's.
fn large(times: f64) -> Setup {
    let times = times as u32;
    Setup::of(posts()).of_size((SIZE.0 * times, SIZE.1 * times)).against(Truth::Thinned(times))
}

/// Larger and smaller and back again by one renderer.
fn resized(which: f64) -> Setup {
    let other = SIZES[which as usize % SIZES.len()].1;
    let still = |(place, size)| Still { scene: posts(), size, place };
    let frames = [(0, SIZE), (1, other), (2, (131, 7)), (1, other), (0, SIZE)].map(still);
    Setup { frames: frames.into(), ..Setup::of(posts()) }.against(Truth::Unknown)
}

const FORMATS: &[(&str, wgpu::TextureFormat)] = &[
    ("32 bits", wgpu::TextureFormat::Rgba32Float),
    ("16 bits", wgpu::TextureFormat::Rgba16Float),
    ("11 and 10 bits", wgpu::TextureFormat::Rg11b10Ufloat),
    ("8 bits", wgpu::TextureFormat::Rgba8Unorm),
    ("integers", wgpu::TextureFormat::Rgba8Uint),
];

const FORMAT_NAMES: [&str; 5] = {
    let mut names = [""; 5];
    let mut index = 0;
    while index < FORMATS.len() {
        names[index] = FORMATS[index].0;
        index += 1;
    }
    names
};

fn format(which: f64) -> Setup {
    Setup { format: Some(FORMATS[which as usize % FORMATS.len()].1), ..Setup::of(posts()) }
}

/// Sixteen bits and a light so bright that they end.
fn dazzling(factor: f64) -> Setup {
    let scene = posts_with(|scene| {
        let Light::Point(light) = &mut scene.lights[0] else { return };
        light.intensity *= factor as f32;
    });
    Setup { format: Some(wgpu::TextureFormat::Rgba16Float), ..Setup::of(scene) }
}

fn our_techniques(value: f64) -> Vec<Entry> {
    let mut entries = defaults(value);
    entries.extend(named(&["ray-march-64", "froxels-8x64"]));
    entries
}

pub(super) fn rows() -> Vec<Row> {
    let number = |name, values| Parameter::Number { name, unit: "", values };
    vec![
        Row {
            id: "lights",
            title: "many lights",
            why: "Sums of many lights gather the rounding of each; buffers have room for so many.",
            parameter: number("lights", &[1.0, 2.0, 4.0, 16.0, 64.0]),
            quick: &[4.0],
            build: lights,
            methods: our_techniques,
            ..Row::of(Part::Load)
        },
        Row {
            id: "sizes",
            title: "pictures of few pixels",
            why: "Tiles, workgroups and levels of detail are larger than the picture.",
            parameter: Parameter::Choice { name: "pixels", values: &SIZE_NAMES },
            quick: &[1.0],
            build: sized,
            methods: all_and_unshadowed,
            ..Row::of(Part::Load)
        },
        Row {
            id: "large",
            title: "pictures of many pixels",
            why: "Buffers and counts overflow; what depends on a pixel's size changes.",
            parameter: number("pixels on a side, in 97x77", &[1.0, 3.0, 11.0, 41.0]),
            quick: &[3.0],
            build: large,
            methods: defaults,
            ..Row::of(Part::Load)
        },
        Row {
            id: "resize",
            title: "a window that is resized",
            why: "What was made for another size is kept: the picture after has to be the one before.",
            parameter: Parameter::Choice { name: "to and back from", values: &SIZE_NAMES },
            quick: &[1.0],
            build: resized,
            measure: Measure::Return,
            methods: all,
            ..Row::of(Part::Load)
        },
        Row {
            id: "formats",
            title: "formats of the target",
            why: "Light is added to the target, which has to hold it and to blend.",
            parameter: Parameter::Choice { name: "target", values: &FORMAT_NAMES },
            quick: &[1.0],
            build: format,
            methods: defaults,
            ..Row::of(Part::Load)
        },
        Row {
            id: "dazzling",
            title: "targets of 16 bits and bright lights",
            why: "Sixteen bits end at 65 504; infinity spreads into all that is computed from it.",
            parameter: number("times the intensity", &[1.0, 1e2, 1e4, 1e6, 1e8]),
            quick: &[1e6],
            build: dazzling,
            measure: Measure::Sound,
            methods: defaults,
            ..Row::of(Part::Load)
        },
    ]
}
