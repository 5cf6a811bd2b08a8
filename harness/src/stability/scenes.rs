//! Small scenes that the rows vary.

use std::sync::Arc;

use common::scene::builtin::solids;
use common::scene::{Mesh, Object};
use common::{Camera, DirectionalLight, Light, Medium, Phase, PointLight, Scene, SpotLight};
use glam::{Affine3A, Vec3};

/// A mesh as an object.
pub(super) fn object(name: &str, mesh: Mesh) -> Object {
    Object { name: name.into(), mesh: Arc::new(mesh), world_from_object: Affine3A::IDENTITY }
}

/// A box between two corners \[m\].
pub(super) fn boxed(low: [f32; 3], high: [f32; 3]) -> Object {
    object("box", solids::cuboid(low.into(), high.into()))
}

pub(super) fn lamp(position: Vec3, intensity: f32) -> Light {
    Light::Point(PointLight { position, intensity: Vec3::splat(intensity) })
}

pub(super) fn spot(position: Vec3, towards: Vec3, degrees: f32) -> Light {
    let direction = (towards - position).normalize();
    let up = if direction.y.abs() < 0.9 { Vec3::Y } else { Vec3::X };
    let outer_angle = degrees.to_radians();
    let intensity = Vec3::splat(20.0);
    Light::Spot(SpotLight {
        position,
        direction,
        up,
        intensity,
        inner_angle: outer_angle,
        outer_angle,
        light_map: None,
    })
}

pub(super) fn sun(direction: Vec3) -> Light {
    Light::Directional(DirectionalLight { direction: direction.normalize(), irradiance: Vec3::splat(3.0) })
}

/// Where the lamp of [`posts`] is \[m\].
pub(super) const LAMP: Vec3 = Vec3::new(0.137, 1.313, -0.611);
/// Its intensity \[W/sr\].
pub(super) const INTENSITY: f32 = 20.0;
/// Its fog: extinction \[1/m\] and albedo.
pub(super) const SIGMA_T: f32 = 0.08;
pub(super) const ALBEDO: f32 = 0.9;

/// Five posts and a lintel on a floor of 8 m, a lamp among them that one of the posts hides (its own pixel would be
/// brighter than all others together), thin fog all around.
pub(super) fn posts() -> Scene {
    let post = |x: f32, z: f32| boxed([x - 0.17, -0.05, z - 0.15], [x + 0.16, 1.9, z + 0.18]);
    let mut objects = vec![boxed([-4.0, -0.2, -4.0], [4.0, 0.0, 4.0])];
    objects.extend(
        [(-1.53, -0.71), (0.732, 0.553), (-0.61, 1.17), (2.11, -1.87), (-2.29, 0.93)]
            .map(|(x, z)| post(x, z)),
    );
    objects.push(boxed([-2.6, 2.03, -1.1], [2.4, 2.31, -0.83]));
    Scene {
        objects,
        lights: vec![lamp(LAMP, INTENSITY)],
        medium: Medium::grey(SIGMA_T, ALBEDO, Phase::isotropic()),
        camera: Camera {
            eye: Vec3::new(3.113, 1.917, 5.207),
            target: Vec3::new(0.031, 0.857, 0.017),
            up: Vec3::Y,
            fov_y: 0.9,
        },
        ..Scene::empty("posts")
    }
}

/// [`posts`] with what a change makes of it.
pub(super) fn posts_with(change: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene = posts();
    change(&mut scene);
    scene
}

/// A lamp before a wall in which light passes between upright bars: as wide as the gaps between them, `count` of them
/// over 4 m, 1.5 m from the lamp.
pub(super) fn bars(count: u32) -> Scene {
    common::scene::builtin::grating(12 * count)
}

/// Everything `scale` times as large, and its picture the same: lengths grow, extinction falls, and so that radiance
/// stays, intensities grow with the square.
pub(super) fn scaled(mut scene: Scene, scale: f32) -> Scene {
    for object in &mut scene.objects {
        object.world_from_object = Affine3A::from_scale(Vec3::splat(scale)) * object.world_from_object;
    }
    for light in &mut scene.lights {
        match light {
            Light::Point(light) => {
                light.position *= scale;
                light.intensity *= scale * scale;
            }
            Light::Spot(light) => {
                light.position *= scale;
                light.intensity *= scale * scale;
            }
            Light::Directional(_) => {}
        }
    }
    scene.medium.sigma_s /= scale;
    scene.medium.sigma_a /= scale;
    scene.camera.eye *= scale;
    scene.camera.target *= scale;
    scene
}

/// Everything moved.
pub(super) fn shifted(mut scene: Scene, by: Vec3) -> Scene {
    for object in &mut scene.objects {
        object.world_from_object = Affine3A::from_translation(by) * object.world_from_object;
    }
    for light in &mut scene.lights {
        match light {
            Light::Point(light) => light.position += by,
            Light::Spot(light) => light.position += by,
            Light::Directional(_) => {}
        }
    }
    scene.camera.eye += by;
    scene.camera.target += by;
    scene
}

/// The centre of the picture's rays starts here and goes there.
pub(super) fn look(scene: &Scene) -> (Vec3, Vec3) {
    let camera = &scene.camera;
    (camera.eye, (camera.target - camera.eye).normalize())
}

/// Six walls around a place, as far from it and as thick as that \[m\].
pub(super) fn crate_around(at: Vec3, half: f32, thickness: f32) -> Vec<Object> {
    // Walls end inside each other, so that no crack is left.
    let (inner, outer) = (half, half + thickness);
    let wall = |axis: usize, sign: f32| {
        let (mut low, mut high) =
            (Vec3::splat(-inner - 0.5 * thickness), Vec3::splat(inner + 0.5 * thickness));
        (low[axis], high[axis]) = if sign > 0.0 { (inner, outer) } else { (-outer, -inner) };
        object("wall", solids::cuboid(at + low, at + high))
    };
    (0..3).flat_map(|axis| [wall(axis, 1.0), wall(axis, -1.0)]).collect()
}
