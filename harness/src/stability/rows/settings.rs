//! Settings of the methods themselves.

use chen_planes::{Options, Visibility};
use common::scene::builtin;
use glam::Vec3;

use crate::stability::row::{Entry, Parameter, Part, Row, Setup};
use crate::stability::scenes::{INTENSITY, bars, lamp, look};
use crate::techniques::{chen, find_one};

fn entries(methods: impl IntoIterator<Item = (&'static str, String)>) -> Vec<Entry> {
    let of = |(column, name): (&'static str, String)| Some(Entry { column, method: find_one(&name).ok()? });
    methods.into_iter().filter_map(of).collect()
}

/// A lamp 5 m ahead and `share` of the way from one of a hundred planes to the next.
fn between_planes(share: f64) -> Setup {
    let mut scene = builtin::empty();
    let (eye, forward) = look(&scene);
    let (right, up, _) = scene.camera.basis();
    // Planes of the paper's setting are the hundredth part of some 10 m apart.
    let along = 5.0 + 0.1 * share as f32;
    scene.lights = vec![lamp(eye + along * forward + 0.05 * (0.8 * right + 0.6 * up), INTENSITY)];
    Setup::of(scene)
}

/// The paper's planes with shadows looked up at lattice points, so many each way.
fn at_lattice_points(points: f64) -> Vec<Entry> {
    let options = Options {
        lattice: [points as u32; 2],
        visibility: Visibility::PerLatticePoint,
        ..Options::paper(wgpu::TextureFormat::Rgba16Float)
    };
    let method = chen(&format!("paper-lattice-{points}"), "sweep", None, options);
    vec![Entry { column: "chen-planes-paper", method }]
}

fn barred(_: f64) -> Setup {
    let mut scene = bars(12);
    scene.camera.eye = Vec3::new(2.513, 1.471, 4.371);
    Setup::of(scene).on_maps_of(2048)
}

pub(super) fn rows() -> Vec<Row> {
    const COUNTS: &[f64] = &[256.0, 64.0, 16.0, 4.0, 1.0];
    let number = |name, unit, values| Parameter::Number { name, unit, values };
    vec![
        Row {
            id: "between-planes",
            title: "a lamp on and between sampling planes",
            why: "A sum over planes pulses as a light goes through them.",
            parameter: number(
                "share of the way to the next plane",
                "",
                &[0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875],
            ),
            quick: &[0.0, 0.5],
            build: between_planes,
            methods: |_| {
                entries(
                    [
                        "chen-planes-default",
                        "chen-planes-paper",
                        "ray-march-64",
                        "ray-march-equiangular-offset-64",
                        "froxels-8x64",
                    ]
                    .map(|name| (name, name.into())),
                )
            },
            ..Row::of(Part::Settings)
        },
        Row {
            id: "samples",
            title: "few planes, few steps, few slices",
            why: "An edge of a shadow is off by up to half a step.",
            parameter: number("places along a ray", "", COUNTS),
            quick: &[64.0],
            build: barred,
            methods: |value| {
                let count = value as u32;
                let planes = count.div_ceil(8);
                entries([
                    ("chen-planes-default", format!("chen-planes-{planes}x{}", count.min(8))),
                    ("chen-planes-paper", format!("chen-planes-paper-{count}")),
                    ("ray-march-64", format!("ray-march-{count}")),
                    ("ray-march-offset-64", format!("ray-march-offset-{count}")),
                    ("ray-march-equiangular-offset-64", format!("ray-march-equiangular-offset-{count}")),
                    ("froxels-8x64", format!("froxels-8x{count}")),
                ])
            },
            law: |count| (256.0 / count).max(1.0),
            ..Row::of(Part::Settings)
        },
        Row {
            id: "lattice",
            title: "shadows at lattice points",
            why: "A shaft of light that is narrower than a cell of the lattice falls through it.",
            parameter: number("points each way", "", &[256.0, 64.0, 32.0, 16.0, 8.0, 2.0]),
            quick: &[],
            build: barred,
            methods: at_lattice_points,
            ..Row::of(Part::Settings)
        },
    ]
}
