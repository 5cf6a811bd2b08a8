//! Motion and repetition.

use common::{Light, Scene};
use glam::{Affine3A, Vec3};

use crate::stability::row::{Measure, Parameter, Part, Row, Setup, all, clouds, defaults};
use crate::stability::scenes::{LAMP, lamp, look, posts, posts_with, sun};

/// Frames of a motion.
const FRAMES: u32 = 6;
const MAP: u32 = 512;

fn frames(of: impl Fn(f32) -> Scene) -> Setup {
    Setup::moving(FRAMES, |index| of(index as f32)).on_maps_of(MAP)
}

/// A lamp drifts by parts of a texel of its shadow map at the distance of a metre.
fn drift(texels: f64) -> Setup {
    let step = texels as f32 * 2.0 / MAP as f32;
    frames(|index| {
        let at = LAMP + index * step * Vec3::new(0.7, 0.1, 0.7);
        posts_with(|scene| scene.lights = vec![lamp(at, 20.0)])
    })
}

fn turning_sun(degrees: f64) -> Setup {
    frames(|index| {
        let angle = 0.6 + index * (degrees as f32).to_radians();
        posts_with(|scene| scene.lights = vec![sun(Vec3::new(angle.cos(), -0.9, angle.sin()))])
    })
}

fn dolly(metres: f64) -> Setup {
    frames(|index| {
        posts_with(|scene| {
            let (_, forward) = look(scene);
            let by = index * metres as f32 * forward;
            scene.camera.eye += by;
            scene.camera.target += by;
        })
    })
}

/// A light that turns about a cloud.
fn turning_about_a_cloud(degrees: f64) -> Setup {
    let scene = |index: u32| {
        let mut scene = common::scene::builtin::sphere();
        let angle = index as f32 * (degrees as f32).to_radians();
        let turn = Affine3A::from_rotation_y(angle);
        for light in &mut scene.lights {
            if let Light::Directional(light) = light {
                light.direction = turn.transform_vector3(light.direction).normalize();
            }
        }
        scene
    };
    // The way back goes over the same places.
    Setup::returning((0..3).chain([1, 0]), scene).on_maps_of(16)
}

const THINGS: &[&str] = &["light", "eye", "object", "fog", "number of lights"];

/// There and back again: what is seen at a place must not depend on where one came from.
fn there_and_back(which: f64) -> Setup {
    let scene = |index: u32| {
        let by = 0.13 * index as f32;
        let mut scene = moving_posts();
        match which as usize {
            0 => scene.lights = vec![lamp(LAMP + Vec3::new(by, 0.3 * by, -by), 20.0)],
            1 => scene.camera.eye += Vec3::new(by, 0.2 * by, 0.0),
            2 => {
                let place = Affine3A::from_translation(Vec3::new(by, 0.0, 0.3 * by));
                scene.objects[1].world_from_object = place;
            }
            3 => scene.medium.sigma_s *= 1.0 + by,
            _ => {
                let more = (0..index).map(|i| lamp(Vec3::new(0.4 * i as f32, 1.1, 0.7), 5.0));
                scene.lights.extend(more);
            }
        }
        scene
    };
    Setup::returning([0, 1, 2, 3, 2, 1, 0], scene).on_maps_of(MAP)
}

/// The same meshes in all frames, as a program keeps them.
fn moving_posts() -> Scene {
    static POSTS: std::sync::OnceLock<Scene> = std::sync::OnceLock::new();
    POSTS.get_or_init(posts).clone()
}

fn again(times: f64) -> Setup {
    Setup::returning((0..times as u32).map(|_| 0), |_| moving_posts()).on_maps_of(MAP)
}

/// Many frames, all different but the first and the last.
fn soak(count: f64) -> Setup {
    let count = count as u32;
    let scene = |index: u32| {
        let turn = 0.37 * index as f32;
        let mut scene = moving_posts();
        scene.lights = vec![lamp(LAMP + 0.4 * Vec3::new(turn.sin(), 0.0, turn.cos() - 1.0), 20.0)];
        scene.camera.eye.x += 0.2 * turn.sin();
        scene
    };
    Setup::returning((0..count - 1).chain([0]), scene).of_size((33, 27)).on_maps_of(128)
}

pub(super) fn rows() -> Vec<Row> {
    let number = |name, unit, values| Parameter::Number { name, unit, values };
    vec![
        Row {
            id: "drift",
            title: "a lamp that creeps",
            why: "Edges of shadows jump from texel to texel of the shadow map where they should glide.",
            parameter: number(
                "texels of a map of 512² a frame, at 1 m",
                "",
                &[0.125, 0.03125, 0.5, 1.0, 4.0],
            ),
            quick: &[0.125],
            build: drift,
            measure: Measure::Flicker,
            methods: all,
            ..Row::of(Part::Motion)
        },
        Row {
            id: "turning-sun",
            title: "a sun that turns",
            why: "The same for parallel light, whose map turns with it.",
            parameter: number("degrees a frame", "°", &[0.1, 0.01, 1.0]),
            quick: &[0.1],
            build: turning_sun,
            measure: Measure::Flicker,
            methods: all,
            ..Row::of(Part::Motion)
        },
        Row {
            id: "dolly",
            title: "an eye that creeps forward",
            why: "Slabs, slices and steps move with the eye: bands swim.",
            parameter: number("metres a frame", "m", &[0.01, 0.001, 0.1]),
            quick: &[0.01],
            build: dolly,
            measure: Measure::Flicker,
            methods: all,
            ..Row::of(Part::Motion)
        },
        Row {
            id: "there-and-back",
            title: "there and back along one path",
            why: "What is kept from frame to frame shows: a picture must not depend on the frames before it.",
            parameter: Parameter::Choice { name: "what moves", values: THINGS },
            quick: &[4.0],
            build: there_and_back,
            measure: Measure::Return,
            methods: all,
            ..Row::of(Part::Motion)
        },
        Row {
            id: "again",
            title: "the same frame again and again",
            why: "Sums whose order is open differ in their last bits.",
            parameter: number("frames", "", &[2.0, 10.0, 100.0]),
            quick: &[2.0],
            build: again,
            measure: Measure::Return,
            methods: all,
            ..Row::of(Part::Motion)
        },
        Row {
            id: "drift-soak",
            title: "a thousand frames",
            why: "Errors add up from frame to frame; the last frame is the first one's place.",
            parameter: number("frames", "", &[10.0, 100.0, 1000.0]),
            quick: &[10.0],
            build: soak,
            measure: Measure::Return,
            methods: defaults,
            ..Row::of(Part::Motion)
        },
        Row {
            id: "memory",
            title: "memory over a thousand frames",
            why: "What is made for a frame has to go with it. (What a driver keeps for itself is not counted.)",
            parameter: number("frames", "", &[100.0, 1000.0]),
            quick: &[100.0],
            build: soak,
            measure: Measure::Memory,
            methods: defaults,
            ..Row::of(Part::Motion)
        },
        Row {
            id: "cloud-there-and-back",
            title: "a light that turns about a cloud, and back",
            why: "A network keeps its light from frame to frame: one step a frame is behind.",
            parameter: number("degrees a frame", "°", &[0.1, 1.0, 10.0]),
            quick: &[0.1],
            build: turning_about_a_cloud,
            measure: Measure::Return,
            methods: clouds,
            ..Row::of(Part::Motion)
        },
    ]
}
