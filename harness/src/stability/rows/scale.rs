//! Scale and place.

use glam::Vec3;

use crate::stability::row::{Parameter, Part, Row, Setup, Truth};
use crate::stability::scenes::{INTENSITY, LAMP, boxed, lamp, posts, posts_with, scaled, shifted};

fn scale(scale: f64) -> Setup {
    Setup::of(scaled(posts(), scale as f32)).against(Truth::Of(Box::new(posts())))
}

fn shift(by: f64) -> Setup {
    Setup::of(shifted(posts(), by as f32 * Vec3::new(1.0, 0.0, 0.6))).against(Truth::Of(Box::new(posts())))
}

fn brightness(factor: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        scene.lights = vec![lamp(LAMP, (f64::from(INTENSITY) * factor) as f32)];
    }))
}

fn plain(half: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        let half = half as f32;
        scene.objects[0] = boxed([-half, -0.2, -half], [half, 0.0, half]);
    }))
}

fn far_thing(distance: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        let at = distance as f32;
        scene.objects.push(boxed([at, 0.0, -at - 1.0], [at + 1.0, 1.0, -at]));
    }))
}

fn sunny_plain(half: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        let half = half as f32;
        scene.objects[0] = boxed([-half, -0.2, -half], [half, 0.0, half]);
        scene.lights = vec![crate::stability::scenes::sun(Vec3::new(0.5, -0.7, -0.3))];
    }))
}

pub(super) fn rows() -> Vec<Row> {
    let number = |name, unit, values| Parameter::Number { name, unit, values };
    const AROUND: &[f64] = &[4.0, 10.0, 100.0, 1e3, 1e4, 1e5];
    vec![
        Row {
            id: "scale",
            title: "the whole scene in another unit",
            why: "With the same optical depths the picture is the same; constants in metres show.",
            parameter: number("scale", "", &[1.0, 1e-2, 1e-4, 1e-6, 1e2, 1e4, 1e6]),
            quick: &[1e-6, 1e6],
            build: scale,
            ..Row::of(Part::Scale)
        },
        Row {
            id: "shift",
            title: "the whole scene far from the origin",
            why: "A 32-bit position has 24 bits: at 1 000 km a metre has 16 steps. The reference is of the scene where it \
                  was made.",
            parameter: number("distance from the origin", "m", &[0.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6]),
            quick: &[1e6],
            build: shift,
            ..Row::of(Part::Scale)
        },
        Row {
            id: "brightness",
            title: "lights from nothing to dazzling",
            why: "Sums of 16 bits end at 65 504 and at 6e-8; products of large numbers overflow.",
            parameter: number(
                "times the intensity",
                "",
                &[1.0, 1e-3, 1e-6, 1e-12, 1e-30, 1e3, 1e6, 1e12, 1e28, 1e31],
            ),
            quick: &[1e12],
            build: brightness,
            ..Row::of(Part::Scale)
        },
        Row {
            id: "plain",
            title: "a lamp on a plain",
            why: "Shadow maps reach as far as the scene; begin they must near the lamp.",
            parameter: number("half the plain's width", "m", AROUND),
            quick: &[1e4],
            build: plain,
            ..Row::of(Part::Scale)
        },
        Row {
            id: "plain-sun",
            title: "a plain in the sun",
            why: "A shadow map of the sun covers the whole scene: a thousand times the plain has a thousandth of the \
                  resolution.",
            parameter: number("half the plain's width", "m", AROUND),
            quick: &[1e4],
            build: sunny_plain,
            ..Row::of(Part::Scale)
        },
        Row {
            id: "far-thing",
            title: "one thing far away",
            why: "The reach of planes and maps follows what is farthest.",
            parameter: number("its distance", "m", &[10.0, 100.0, 1e3, 1e4, 1e5, 1e6]),
            quick: &[1e4],
            build: far_thing,
            ..Row::of(Part::Scale)
        },
    ]
}
