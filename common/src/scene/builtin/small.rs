//! Scenes of a few boxes whose answer is known.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::{matte, solids};
use crate::scene::{Object, Scene};
use crate::{Camera, DirectionalLight, Light, Medium, Phase, PointLight};

fn boxed(name: &str, material: u32, low: Vec3, high: Vec3) -> Object {
    let mut mesh = solids::cuboid(low, high);
    mesh.materials = vec![material; mesh.triangles.len()];
    Object { name: name.into(), mesh: Arc::new(mesh), world_from_object: Affine3A::IDENTITY }
}

fn point(position: Vec3, intensity: f32) -> Light {
    Light::Point(PointLight { position, intensity: Vec3::splat(intensity) })
}

/// A point light in fog and nothing else. The light lies on the ray of no pixel's centre, whatever
/// the resolution: its place on the image plane is no fraction.
pub fn empty() -> Scene {
    Scene {
        lights: vec![point(Vec3::new(0.137_3, 0.291_7, 0.0), 20.0)],
        medium: Medium::grey(0.1, 0.9, Phase::isotropic()),
        camera: Camera { eye: Vec3::new(0.0, 0.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 1.0 },
        ..Scene::empty("empty")
    }
}

/// What is known of the scene [`knife_edge`]: beyond the slab, light reaches a point (x, y, z) with
/// x > [`KnifeEdge::X`] exactly where y − [`KnifeEdge::LIGHT`].y > [`KnifeEdge::SLOPE`] · x. That
/// holds as far as the slab reaches: 40 m to both sides and below.
#[derive(Debug)]
pub enum KnifeEdge {}

impl KnifeEdge {
    /// The light \[m\].
    pub const LIGHT: Vec3 = Vec3::new(0.0, 1.0, 0.0);
    /// The slab's face towards the light \[m\].
    pub const X: f32 = 1.0;
    /// Height of the slab's upper edge \[m\].
    pub const TOP: f32 = 1.2;
    /// Thickness of the slab \[m\].
    pub const THICKNESS: f32 = 0.02;
    /// Rise of the shadow's boundary over its run.
    pub const SLOPE: f32 = (Self::TOP - Self::LIGHT.y) / Self::X;
}

/// One thin upright slab that keeps a point light from about half of the space beyond it, along the
/// plane that [`KnifeEdge`] gives. The camera looks along the edge.
pub fn knife_edge() -> Scene {
    let low = Vec3::new(KnifeEdge::X, -40.0, -40.0);
    let high = Vec3::new(KnifeEdge::X + KnifeEdge::THICKNESS, KnifeEdge::TOP, 40.0);
    Scene {
        objects: vec![boxed("slab", 0, low, high)],
        materials: vec![matte("grey", Vec3::splat(0.5))],
        lights: vec![point(KnifeEdge::LIGHT, 20.0)],
        medium: Medium::grey(0.1, 0.9, Phase::isotropic()),
        camera: Camera {
            eye: Vec3::new(2.913, 1.871, 7.0),
            target: Vec3::new(2.431, 1.517, 0.0),
            up: Vec3::Y,
            fov_y: 0.9,
        },
        ..Scene::empty("knife-edge")
    }
}

/// Triangles of [`grating`], unless told otherwise: a hundred bars.
pub const GRATING_TRIANGLES: u32 = 1_200;

/// Upright bars, as wide as the gaps between them, in front of a lamp: nothing but silhouette edges, four to
/// each bar's twelve triangles, in a frame of always the same size.
pub fn grating(triangles: u32) -> Scene {
    let count = (triangles + 6) / 12;
    let period = 4.0 / count as f32;
    let bars = (0..count).map(|bar| {
        let left = bar as f32 * period - 2.0;
        solids::cuboid(Vec3::new(left, 0.0, -0.02), Vec3::new(left + 0.5 * period, 2.0, 0.02))
    });
    let mut mesh = solids::merged(bars);
    mesh.materials = vec![0; mesh.triangles.len()];
    let bars = Object { name: "bars".into(), mesh: Arc::new(mesh), world_from_object: Affine3A::IDENTITY };
    Scene {
        objects: vec![bars],
        materials: vec![matte("grey", Vec3::splat(0.5))],
        lights: vec![point(Vec3::new(0.137_3, 1.291_7, -1.513), 20.0)],
        medium: Medium::grey(0.1, 0.9, Phase::isotropic()),
        camera: Camera {
            eye: Vec3::new(3.513, 1.871, 4.371),
            target: Vec3::new(0.0, 0.917, 0.5),
            up: Vec3::Y,
            fov_y: 0.9,
        },
        ..Scene::empty("grating")
    }
}

/// The inside of a closed room of thick walls, 4 m by 6 m and 3 m high, full of fog. A point light
/// and the sun are outside: no light at all gets in, so whatever a renderer shows has leaked.
pub fn sealed_room() -> Scene {
    // Walls end inside each other, so that no two faces lie in one plane and no crack is left.
    let walls = [
        ("floor", 1, [-2.4, -0.30, -3.4], [2.4, 0.0, 3.4]),
        ("ceiling", 0, [-2.4, 3.0, -3.4], [2.4, 3.3, 3.4]),
        ("wall west", 0, [-2.3, -0.15, -3.25], [-2.0, 3.15, 3.25]),
        ("wall east", 0, [2.0, -0.15, -3.25], [2.3, 3.15, 3.25]),
        ("wall north", 0, [-2.15, -0.15, -3.3], [2.15, 3.15, -3.0]),
        ("wall south", 0, [-2.15, -0.15, 3.0], [2.15, 3.15, 3.3]),
    ];
    let sun = DirectionalLight {
        direction: Vec3::new(-0.8, -0.5, 0.33).normalize(),
        irradiance: Vec3::new(20.0, 18.0, 15.0),
    };
    Scene {
        objects: walls
            .map(|(name, material, low, high)| boxed(name, material, low.into(), high.into()))
            .into(),
        materials: vec![matte("plaster", Vec3::splat(0.6)), matte("tiles", Vec3::new(0.4, 0.35, 0.3))],
        lights: vec![point(Vec3::new(3.5, 1.7, 0.4), 30.0), Light::Directional(sun)],
        medium: Medium::grey(0.1, 0.9, Phase::isotropic()),
        camera: Camera {
            eye: Vec3::new(-1.5, 1.6, 2.2),
            target: Vec3::new(-0.5, 1.2, -2.5),
            up: Vec3::Y,
            fov_y: 1.0,
        },
        ..Scene::empty("sealed-room")
    }
}

/// [`sealed_room`] without its wall towards the lights: what a leak is measured against.
pub fn open_room() -> Scene {
    let mut scene = Scene { name: "open-room".into(), ..sealed_room() };
    scene.objects.retain(|object| object.name != "wall east");
    scene
}
