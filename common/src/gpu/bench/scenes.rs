//! Small scenes that the techniques' tests draw, and what to hold a picture against.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::{Affine3A, Vec3};

use crate::image::Image;
use crate::reference::Reference;
use crate::scene::builtin::solids;
use crate::scene::{Mesh, Object, Scene};
use crate::{Camera, DirectionalLight, Light, Medium, Phase, PointLight, SpotLight, Term, View};

/// An object of a mesh that stays where it is.
pub fn object(mesh: Mesh) -> Object {
    Object { name: "object".into(), mesh: Arc::new(mesh), world_from_object: Affine3A::IDENTITY }
}

/// An axis-aligned box, closed, counter-clockwise from outside.
pub fn cuboid(low: Vec3, high: Vec3) -> Object {
    object(solids::cuboid(low, high))
}

/// Fog of extinction `sigma_t` and albedo .9 with three boxes on a floor, seen from the front.
pub fn boxes(light: Light, sigma_t: f32) -> Scene {
    let mut scene = Scene::empty("boxes");
    scene.objects = vec![
        cuboid(Vec3::new(-6.0, -0.5, -6.0), Vec3::new(6.0, 0.0, 6.0)),
        cuboid(Vec3::new(-0.5, 1.0, -0.4), Vec3::new(0.3, 1.8, 0.5)),
        cuboid(Vec3::new(0.9, 0.0, -1.0), Vec3::new(1.3, 2.5, 0.2)),
        cuboid(Vec3::new(-2.5, 2.0, -1.0), Vec3::new(-1.2, 2.2, 1.0)),
    ];
    scene.lights = vec![light];
    scene.medium = Medium::grey(sigma_t, 0.9, Phase::isotropic());
    scene.camera =
        Camera { eye: Vec3::new(0.4, 1.6, 6.3), target: Vec3::new(0.0, 1.3, 0.0), up: Vec3::Y, fov_y: 0.9 };
    scene
}

/// A point light over and behind the boxes, out of the camera's sight of pixel centres.
pub fn point() -> Light {
    Light::Point(PointLight { position: Vec3::new(0.31, 3.17, -0.73), intensity: Vec3::new(9.0, 10.0, 11.0) })
}

/// A spot from the upper left with a hard edge unless `inner` is below `outer` \[rad\].
pub fn spot(inner: f32, outer: f32) -> Light {
    Light::Spot(SpotLight {
        position: Vec3::new(-3.0, 4.2, 1.0),
        direction: Vec3::new(0.62, -0.7, -0.2).normalize(),
        up: Vec3::Y,
        intensity: Vec3::splat(30.0),
        inner_angle: inner,
        outer_angle: outer,
        light_map: None,
    })
}

/// The sun from the upper right.
pub fn sun() -> Light {
    Light::Directional(DirectionalLight {
        direction: Vec3::new(-0.5, -0.8, 0.31).normalize(),
        irradiance: Vec3::new(3.0, 2.8, 2.5),
    })
}

/// The airlight of the CPU reference.
///
/// # Panics
/// When the scene is not valid.
pub fn reference(scene: &Scene, view: &View) -> Image {
    let reference = Reference::new(scene).expect("valid scene");
    let rendered = reference
        .render(view, Term::Airlight.into(), &|_| {}, &AtomicBool::new(false))
        .expect("not cancelled");
    rendered.airlight.expect("airlight was asked for")
}

/// RMS difference where the reference is lit, and the largest anywhere, over the reference's mean there.
///
/// # Panics
/// When the pictures are of different sizes.
pub fn errors(image: &Image, reference: &Image) -> (f64, f64) {
    let errors = crate::metrics::compare(image, reference).expect("pictures of one size");
    (errors.rel_rmse, errors.max)
}

/// Fails where a pixel is not finite, or negative by more than the rounding of what is added up.
///
/// # Panics
/// With the pixel.
pub fn assert_sane(image: &Image, name: &str) {
    let least = -1e-5 * image.pixels.iter().map(|p| p.max_element()).fold(0.0, f32::max);
    for (i, p) in image.pixels.iter().enumerate() {
        assert!(p.is_finite(), "{name}: pixel {i} is {p}");
        assert!(p.min_element() >= least, "{name}: pixel {i} is {p}");
    }
}
