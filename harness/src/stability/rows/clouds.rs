//! Clouds: the medium, the light, and the network's own parameters.

use common::scene::builtin;
use common::{Lobe, Scene};
use glam::Vec3;

use crate::stability::row::{COLUMNS, Entry, Parameter, Part, Row, Setup, Truth, clouds};
use crate::stability::scenes::{lamp, scaled};
use crate::techniques::{CloudSetting, cloud_method, find_one};

/// Size of the pictures: paths take their time.
const SIZE: (u32, u32) = (49, 39);

fn drawn(change: impl FnOnce(&mut Scene)) -> Setup {
    let mut scene = builtin::sphere();
    change(&mut scene);
    Setup::of(scene).of_size(SIZE).on_maps_of(16)
}

fn cloud(scene: &mut Scene, change: impl FnOnce(&mut common::Cloud)) {
    if let Some(cloud) = &mut scene.cloud {
        change(cloud);
    }
}

/// Optical depth across the sphere.
fn thickness(depth: f64) -> Setup {
    drawn(|scene| cloud(scene, |cloud| cloud.sigma_t = (depth / 2.0) as f32))
}

fn albedo(albedo: f64) -> Setup {
    drawn(|scene| cloud(scene, |cloud| cloud.albedo = Vec3::splat(albedo as f32)))
}

fn peaked(g: f64) -> Setup {
    drawn(|scene| {
        cloud(scene, |cloud| {
            cloud.phase = Lobe::HenyeyGreenstein { g }.into();
            // What a peak does to few scatterings is seen where there are few.
            cloud.sigma_t = 4.0;
        });
    })
}

/// A lamp at so many radii from the sphere's centre.
fn lit_from(radii: f64) -> Setup {
    drawn(|scene| {
        let at = radii as f32 * Vec3::new(0.6, 0.5, 0.62).normalize();
        scene.lights = vec![lamp(at, (1.0 + radii * radii) as f32)];
    })
}

/// Nobody moves but the unit.
fn scale(scale: f64) -> Setup {
    let mut scene = scaled(builtin::sphere(), scale as f32);
    cloud(&mut scene, |cloud| {
        cloud.sigma_t /= scale as f32;
        cloud.density = common::Density::Sphere { centre: Vec3::ZERO, radius: scale as f32 };
    });
    Setup::of(scene).of_size(SIZE).against(Truth::Of(Box::new(builtin::sphere())))
}

fn plain(_: f64) -> Setup {
    drawn(|_| {})
}

/// Both settings, changed alike.
fn both(change: impl Fn(&mut CloudSetting)) -> Vec<Entry> {
    [COLUMNS[3], COLUMNS[8]]
        .into_iter()
        .filter_map(|column| {
            let mut setting = find_one(column).ok()?.cloud_setting()?;
            change(&mut setting);
            // The name tells renderers of other settings apart.
            let name = format!(
                "{column}-{}-{}-{:?}",
                setting.particles, setting.options.directions, setting.options.window
            );
            Some(Entry { column, method: cloud_method(&name, setting) })
        })
        .collect()
}

pub(super) fn rows() -> Vec<Row> {
    let number = |name, values| Parameter::Number { name, unit: "", values };
    let row = || Row { methods: clouds, ..Row::of(Part::Clouds) };
    vec![
        Row {
            id: "cloud-thickness",
            title: "thin and dense clouds",
            why: "Particles are transparent or opaque, links short or long; all light comes from the rim of a dense \
                  cloud.",
            parameter: number("optical depth across", &[20.0, 5.0, 1.0, 0.1, 1e-2, 1e-4, 50.0, 100.0, 200.0]),
            quick: &[0.1],
            build: thickness,
            ..row()
        },
        Row {
            id: "cloud-albedo",
            title: "dark and white clouds",
            why: "With an albedo near 1 light is scattered on and on: the iteration takes long, and what grows by \
                  rounding grows without end.",
            parameter: number("albedo", &[0.9, 0.5, 0.1, 0.0, 0.99, 0.999, 1.0]),
            quick: &[1.0],
            build: albedo,
            ..row()
        },
        Row {
            id: "cloud-peak",
            title: "clouds that scatter forward and backward",
            why: "A peak narrower than the angle between directions is missed or counted whole: light grows from step \
                  to step.",
            parameter: number(
                "g of Henyey and Greenstein",
                &[0.0, 0.3, 0.5, 0.8, 0.9, 0.95, -0.5, -0.8, -0.95],
            ),
            quick: &[0.9],
            build: peaked,
            ..row()
        },
        Row {
            id: "cloud-lamp",
            title: "a lamp near, at the edge of and inside a cloud",
            why: "Direct light changes by much from particle to particle.",
            parameter: number("radii from the centre", &[10.0, 3.0, 2.0, 1.5, 1.2, 1.0, 0.5, 0.01]),
            quick: &[2.0],
            build: lit_from,
            ..row()
        },
        Row {
            id: "cloud-scale",
            title: "a cloud in another unit",
            why: "Constants in metres show.",
            parameter: number("scale", &[1.0, 1e-3, 1e-6, 1e3, 1e6]),
            quick: &[1e-6],
            build: scale,
            ..row()
        },
        Row {
            id: "cloud-particles",
            title: "few particles",
            why: "A cloud is as good as its particles: with few one sees them.",
            parameter: number("particles", &[4096.0, 1024.0, 512.0, 128.0, 32.0, 8.0, 1.0]),
            quick: &[512.0],
            build: plain,
            methods: |value| both(|setting| setting.particles = value as u32),
            law: |particles| (4096.0 / particles).powf(1.0 / 3.0).max(1.0),
            ..row()
        },
        Row {
            id: "cloud-directions",
            title: "few directions",
            why: "Light goes along rays: few directions make stars.",
            parameter: number("directions", &[128.0, 512.0, 64.0, 32.0, 16.0, 8.0, 4.0, 2.0]),
            quick: &[16.0],
            build: plain,
            methods: |value| both(|setting| setting.options.directions = value as u32),
            law: |directions| (128.0 / directions).max(1.0),
            ..row()
        },
        Row {
            id: "cloud-window",
            title: "coarse and fine windows",
            why: "Many pixels: most links pass the cloud by, and light escapes. Few: particles are linked that do not \
                  face each other.",
            parameter: number("pixels on a side", &[16.0, 8.0, 4.0, 1.0, 32.0, 64.0, 128.0, 512.0]),
            quick: &[128.0],
            build: plain,
            methods: |value| both(|setting| setting.options.window = Some(value as u32)),
            ..row()
        },
        Row {
            id: "cloud-eye",
            title: "the eye before, at and inside a cloud",
            why: "Splats around the eye cover the picture; those behind it are cut.",
            parameter: number("radii from the centre", &[4.0, 2.0, 1.2, 1.0, 0.9, 0.5, 0.01]),
            quick: &[0.5],
            build: |radii| drawn(|scene| scene.camera.eye = Vec3::new(0.0, 0.0, radii as f32)),
            ..row()
        },
    ]
}
