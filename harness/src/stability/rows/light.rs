//! Where light and eye are.

use common::Scene;
use common::scene::builtin;
use glam::Vec3;

use crate::stability::row::{
    Measure, Parameter, Part, Row, SIZE, Setup, Truth, all_and_unshadowed, defaults,
};
use crate::stability::scenes::{INTENSITY, LAMP, crate_around, lamp, look, posts, posts_with, spot, sun};

const MIDDLE: (u32, u32) = (SIZE.0 / 2, SIZE.1 / 2);

/// Distances, to none at all \[m\].
const NEARER: &[f64] = &[1.0, 0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0];

/// A lamp 5 m ahead in empty air, `beside` the ray through the picture's middle.
fn beside_the_ray(beside: f64) -> Setup {
    let mut scene = builtin::empty();
    let (eye, forward) = look(&scene);
    let (right, up, _) = scene.camera.basis();
    scene.lights = vec![lamp(eye + 5.0 * forward + beside as f32 * (0.8 * right + 0.6 * up), INTENSITY)];
    // Nearer than the reference tells apart, the ray's radiance has no bound.
    let hit = if beside < 1e-5 { Truth::OwnBut(vec![MIDDLE]) } else { Truth::Own };
    Setup::of(scene).against(hit)
}

fn at_the_eye(distance: f64) -> Setup {
    let scene = posts_with(|scene| {
        let (eye, forward) = look(scene);
        let (right, up, _) = scene.camera.basis();
        let way = (0.3 * right + 0.2 * up + 0.5 * forward).normalize();
        scene.lights = vec![lamp(eye + distance as f32 * way, 1.0)];
    });
    let truth = if distance < 1e-5 { Truth::Unknown } else { Truth::Own };
    Setup::of(scene).against(truth)
}

fn over_the_floor(height: f64) -> Setup {
    let scene = posts_with(|scene| scene.lights = vec![lamp(LAMP.with_y(height as f32), INTENSITY)]);
    // In the floor's own plane light goes up or not; both are right.
    let truth = match height {
        0.0 => Truth::Unknown,
        h if h < 0.0 => Truth::Black(Box::new(posts())),
        _ => Truth::Own,
    };
    Setup::of(scene).against(truth)
}

fn around_the_eye(degrees: f64) -> Setup {
    let scene = posts_with(|scene| {
        let (eye, forward) = look(scene);
        let (right, ..) = scene.camera.basis();
        let angle = (degrees as f32).to_radians();
        let way = angle.cos() * forward + angle.sin() * right;
        scene.lights = vec![lamp(eye + 2.0 * way.with_y(way.y + 0.05), INTENSITY)];
    });
    Setup::of(scene)
}

/// The eye crosses the boundary of a slab's shadow, whose plane goes through it at 0.
fn across_a_boundary(above: f64) -> Setup {
    let mut scene = builtin::knife_edge();
    let x = scene.camera.eye.x;
    let boundary = builtin::KnifeEdge::LIGHT.y + builtin::KnifeEdge::SLOPE * x;
    let shift = boundary + above as f32 - scene.camera.eye.y;
    scene.camera.eye.y += shift;
    scene.camera.target.y += shift;
    Setup::of(scene)
}

fn from_afar(factor: f64) -> Setup {
    let factor = factor as f32;
    let scene = posts_with(|scene| {
        let (eye, target) = (scene.camera.eye, scene.camera.target);
        scene.camera.eye = target + factor * (eye - target);
        scene.camera.fov_y = 2.0 * ((0.5 * scene.camera.fov_y).tan() / factor).atan();
        // As much fog as before lies between.
        scene.medium.sigma_s /= factor;
        scene.medium.sigma_a /= factor;
        scene.lights = vec![lamp(LAMP, INTENSITY * factor)];
    });
    Setup::of(scene)
}

fn cone(degrees: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        scene.lights = vec![spot(Vec3::new(-2.313, 2.917, 2.119), Vec3::new(0.3, 0.4, -0.2), degrees as f32)];
    }))
}

fn in_the_apex(distance: f64) -> Setup {
    let scene = posts_with(|scene| {
        let (eye, forward) = look(scene);
        let (right, up, _) = scene.camera.basis();
        let apex = eye + distance as f32 * (0.9 * right - 0.3 * up + 0.1 * forward);
        scene.lights = vec![spot(apex, apex + forward + 0.13 * up, 50.0)];
    });
    let truth = if distance < 1e-5 { Truth::Unknown } else { Truth::Own };
    Setup::of(scene).against(truth)
}

fn grazing(degrees: f64) -> Setup {
    Setup::of(posts_with(|scene| {
        let angle = (degrees as f32).to_radians();
        scene.lights = vec![sun(Vec3::new(0.8 * angle.cos(), -angle.sin(), 0.6 * angle.cos()))];
    }))
}

fn near_plane(distance: f64) -> Setup {
    // The near plane follows the distance to what is looked at.
    Setup::of(posts_with(|scene| {
        let (eye, forward) = look(scene);
        scene.camera.target = eye + 1e3 * distance as f32 * forward;
    }))
}

const CLOSED: &[&str] = &["lamp outside a room", "sun outside a room", "lamp in a box", "lamp in a wall"];

fn closed(which: f64) -> Setup {
    let room = builtin::sealed_room();
    let open = builtin::open_room();
    let only = |mut scene: Scene, light: usize| {
        scene.lights = vec![scene.lights.swap_remove(light)];
        scene
    };
    let walled = |at: Vec3| {
        let mut scene = Scene { lights: vec![lamp(at, INTENSITY)], ..posts() };
        scene.objects.extend(crate_around(LAMP, 0.31, 0.02));
        scene
    };
    let (scene, lit) = match which as usize {
        0 => (only(room, 0), only(open, 0)),
        1 => (only(room, 1), only(open, 1)),
        2 => (walled(LAMP), posts()),
        _ => (walled(LAMP + Vec3::new(0.32, 0.0, 0.0)), posts()),
    };
    Setup::of(scene).against(Truth::Black(Box::new(lit)))
}

/// A room's wall as thin as that, the lamp 0.5 m outside.
fn thin_wall(thickness: f64) -> Setup {
    let mut scene = Scene { lights: vec![lamp(LAMP, INTENSITY)], ..posts() };
    scene.objects.extend(crate_around(LAMP, 0.5, thickness as f32));
    Setup::of(scene).against(Truth::Black(Box::new(posts())))
}

pub(super) fn rows() -> Vec<Row> {
    let metres = |name, values| Parameter::Number { name, unit: "m", values };
    let degrees = |name, values| Parameter::Number { name, unit: "°", values };
    vec![
        Row {
            id: "light-near-ray",
            title: "a light on and near a view ray",
            why: "The radiance of a ray grows as one over its distance from the light; formulas divide by that \
                  distance, and the difference of two large numbers loses it.",
            parameter: metres("distance from the ray", NEARER),
            quick: &[0.0],
            build: beside_the_ray,
            measure: Measure::Relative,
            methods: all_and_unshadowed,
            ..Row::of(Part::Light)
        },
        Row {
            id: "light-at-eye",
            title: "a light near the eye",
            why: "All rays pass the light closely; nearly all airlight comes from the first centimetres of each ray, \
                  where the near plane, slabs and shadow maps begin. In the light itself radiance has no bound.",
            parameter: metres("distance from the eye", NEARER),
            quick: &[1e-3, 0.0],
            build: at_the_eye,
            measure: Measure::Relative,
            ..Row::of(Part::Light)
        },
        Row {
            id: "light-on-surface",
            title: "a light over, on and under a floor",
            why: "Shadow maps begin at a near plane; a caster nearer than it throws no shadow. In the surface itself \
                  it is open which side is lit; below it there is no light.",
            parameter: Parameter::Number {
                name: "height over the floor",
                unit: "m",
                values: &[1.0, 0.3, 0.1, 0.03, 1e-2, 1e-3, 1e-4, 1e-5, 0.0, -0.1],
            },
            quick: &[1e-4, -0.1],
            build: over_the_floor,
            ..Row::of(Part::Light)
        },
        Row {
            id: "closed",
            title: "closed things around light or eye",
            why: "Signed sums of planes or faces have to cancel to nothing; shadow maps have seams, and walls a \
                  thickness of less than a texel.",
            parameter: Parameter::Choice { name: "what is closed", values: CLOSED },
            quick: &[0.0, 2.0],
            build: closed,
            ..Row::of(Part::Light)
        },
        Row {
            id: "thin-wall",
            title: "a lamp behind ever thinner walls",
            why: "Depth biases let light through what is thinner than they are.",
            parameter: metres("thickness", &[0.1, 0.03, 0.01, 1e-3, 1e-4, 1e-5]),
            quick: &[1e-5],
            build: thin_wall,
            ..Row::of(Part::Light)
        },
        Row {
            id: "light-around-eye",
            title: "a light ahead, beside and behind the eye",
            why: "Methods that work in the picture lose a light outside of it; angles at the light turn over behind \
                  the eye.",
            parameter: degrees(
                "angle off the viewing direction",
                &[10.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0],
            ),
            quick: &[90.0, 180.0],
            build: around_the_eye,
            ..Row::of(Part::Light)
        },
        Row {
            id: "eye-across-shadow",
            title: "the eye crosses the boundary of a shadow",
            why: "Signs turn over where the eye enters a shadow volume; the near plane cuts faces that pass the eye.",
            parameter: Parameter::Number {
                name: "height over the boundary",
                unit: "m",
                values: &[1.0, 0.3, 0.1, 0.01, 1e-3, 1e-4, 0.0, -1e-4, -1e-3, -0.01, -0.1, -0.3],
            },
            quick: &[0.0, -0.1],
            build: across_a_boundary,
            ..Row::of(Part::Light)
        },
        Row {
            id: "near-plane",
            title: "the view's near plane",
            why: "What lies before it is cut away: faces of volumes, first slabs, shadows that the eye is in.",
            parameter: metres("distance of the near plane", &[1e-3, 1e-2, 0.1, 0.3, 1.0, 1e-5, 1e-7]),
            quick: &[0.3],
            build: near_plane,
            ..Row::of(Part::Light)
        },
        Row {
            id: "eye-outside",
            title: "the eye far outside the scene",
            why: "Places are differences of large numbers, angles at the eye are small, and slabs lie far apart.",
            parameter: Parameter::Number {
                name: "distance, in widths of the scene",
                unit: "",
                values: &[1.0, 3.0, 10.0, 100.0, 1e3, 1e4],
            },
            quick: &[1e3],
            build: from_afar,
            ..Row::of(Part::Light)
        },
        Row {
            id: "spot-angle",
            title: "narrow and wide cones",
            why: "A narrow cone is missed between samples; a wide one stretches the shadow map's texels at its rim.",
            parameter: degrees("half angle", &[30.0, 60.0, 75.0, 85.0, 10.0, 3.0, 1.0]),
            quick: &[85.0, 1.0],
            build: cone,
            ..Row::of(Part::Light)
        },
        Row {
            id: "eye-in-apex",
            title: "the eye near a spot's apex",
            why: "The cone closes in the eye: its walls are cut by the near plane, and rays run along them.",
            parameter: metres("distance from the apex", NEARER),
            quick: &[0.0],
            build: in_the_apex,
            measure: Measure::Relative,
            methods: defaults,
            ..Row::of(Part::Light)
        },
        Row {
            id: "sun-grazing",
            title: "a sun that sets",
            why: "Parallel light along a floor: the floor fills no texel of the shadow map, shadows have no end.",
            parameter: degrees("height over the floor", &[60.0, 30.0, 10.0, 3.0, 1.0, 0.1, 0.0]),
            quick: &[1.0, 0.0],
            build: grazing,
            ..Row::of(Part::Light)
        },
    ]
}
