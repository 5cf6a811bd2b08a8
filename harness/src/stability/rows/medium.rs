//! The medium.

use common::{Lobe, Medium};
use glam::Vec3;

use crate::stability::row::{Parameter, Part, Row, Setup};
use crate::stability::scenes::{ALBEDO, SIGMA_T, boxed, posts_with, sun};

/// A length across the scene \[m\].
const ACROSS: f64 = 10.0;

fn thickness(depth: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        scene.medium = Medium::grey((depth / ACROSS) as f32, ALBEDO, scene.medium.phase.clone());
    }))
}

fn thickness_in_the_sun(depth: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        scene.medium = Medium::grey((depth / ACROSS) as f32, ALBEDO, scene.medium.phase.clone());
        scene.lights = vec![sun(Vec3::new(0.5, -0.7, -0.3))];
        // Without an end rays are brighter than all else.
        scene.objects.push(boxed([-14.0, -0.2, -4.6], [9.0, 8.0, -4.2]));
        scene.objects.push(boxed([-14.0, -0.2, -4.6], [-13.6, 8.0, 6.0]));
    }))
}

fn albedo(albedo: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        scene.medium = Medium::grey(SIGMA_T, albedo as f32, scene.medium.phase.clone());
    }))
}

fn peaked(g: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        scene.medium.phase = Lobe::HenyeyGreenstein { g }.into();
    }))
}

fn coloured(ratio: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        let sigma_t = Vec3::new(1.0, ratio.sqrt() as f32, ratio as f32) * 0.01;
        (scene.medium.sigma_s, scene.medium.sigma_a) = (ALBEDO * sigma_t, (1.0 - ALBEDO) * sigma_t);
    }))
}

pub(super) fn rows() -> Vec<Row> {
    const DEPTHS: &[f64] = &[1.0, 0.1, 1e-2, 1e-3, 1e-4, 3.0, 6.0, 10.0, 30.0, 100.0];
    let number = |name, unit, values| Parameter::Number { name, unit, values };
    vec![
        Row {
            id: "optical-thickness",
            title: "thin air to soup, around a lamp",
            why: "Tables have an end; in thin air sums of 16 bits lose everything, in dense fog all light comes from a \
                  few centimetres, far less than a step.",
            parameter: number("optical depth of 10 m", "", DEPTHS),
            quick: &[1e-4, 100.0],
            build: thickness,
            ..Row::of(Part::Medium)
        },
        Row {
            id: "optical-thickness-sun",
            title: "thin air to soup, in the sun",
            why: "The same in parallel light, which no distance makes weaker.",
            parameter: number("optical depth of 10 m", "", DEPTHS),
            quick: &[1e-4, 100.0],
            build: thickness_in_the_sun,
            ..Row::of(Part::Medium)
        },
        Row {
            id: "albedo",
            title: "from black smoke to pure scattering",
            why: "Nothing scatters, or nothing is absorbed: a division by either breaks.",
            parameter: number("albedo", "", &[0.9, 0.5, 0.1, 0.01, 0.0, 0.99, 1.0]),
            quick: &[1.0],
            build: albedo,
            ..Row::of(Part::Medium)
        },
        Row {
            id: "peak",
            title: "backward and forward peaks",
            why: "A narrow peak of the phase function falls between samples and texels of tables.",
            parameter: number(
                "g of Henyey and Greenstein",
                "",
                &[0.0, 0.3, 0.6, 0.8, 0.9, 0.95, -0.3, -0.6, -0.8, -0.95],
            ),
            quick: &[0.95, -0.95],
            build: peaked,
            ..Row::of(Part::Medium)
        },
        Row {
            id: "coloured",
            title: "extinction that differs between colours",
            why: "One colour's domain is another's outside.",
            parameter: number("blue over red extinction", "", &[1.0, 3.0, 10.0, 100.0, 1e3, 1e4]),
            quick: &[1e4],
            build: coloured,
            ..Row::of(Part::Medium)
        },
    ]
}
