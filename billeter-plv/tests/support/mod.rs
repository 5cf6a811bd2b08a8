//! Scenes of boxes and one way to draw them, shared by the tests.
#![allow(dead_code, reason = "each test program uses its own part")]

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use billeter_plv::{Error, Inputs, Options, Renderer};
use common::gpu::{Ground, PassTimer, Targets, bench, read_image};
use common::image::Image;
use common::reference::Reference;
use common::scene::{Mesh, Object};
use common::terms::{Term, Terms};
use common::{Camera, DirectionalLight, Light, Medium, Phase, PointLight, Scene, SpotLight, View};
use glam::{Affine3A, Vec3};

/// An axis-aligned box, closed, counter-clockwise from outside.
pub(crate) fn cuboid(low: Vec3, high: Vec3) -> Object {
    let corner = |i: usize| {
        let pick = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    let mesh = Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() };
    Object { name: "box".into(), mesh: Arc::new(mesh), world_from_object: Affine3A::IDENTITY }
}

/// Fog of extinction `sigma_t` and albedo .9 with three boxes on a floor, seen from the front.
pub(crate) fn boxes(light: Light, sigma_t: f32) -> Scene {
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
pub(crate) fn point() -> Light {
    Light::Point(PointLight { position: Vec3::new(0.31, 3.17, -0.73), intensity: Vec3::new(9.0, 10.0, 11.0) })
}

/// A spot from the upper left with a hard edge unless `inner` is below `outer`.
pub(crate) fn spot(inner: f32, outer: f32) -> Light {
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
pub(crate) fn sun() -> Light {
    Light::Directional(DirectionalLight {
        direction: Vec3::new(-0.5, -0.8, 0.31).normalize(),
        irradiance: Vec3::new(3.0, 2.8, 2.5),
    })
}

/// Draws the airlight of a scene.
pub(crate) fn draw(scene: &Scene, view: &View, options: &Options, shadow_size: u32) -> Result<Image, Error> {
    draw_with(scene, view, options, shadow_size, |_| {})
}

/// As [`draw`]; `inspect` sees the renderer afterwards.
pub(crate) fn draw_with(
    scene: &Scene,
    view: &View,
    options: &Options,
    shadow_size: u32,
    inspect: impl FnOnce(&Renderer),
) -> Result<Image, Error> {
    let context = bench::context();
    let (device, queue) = (&context.device, &context.queue);
    let targets = Targets::new(device, view.width, view.height, options.target_format);
    let mut ground =
        Ground::new(device, queue, scene, options.target_format, shadow_size).expect("valid scene");
    let mut renderer = Renderer::new(device, queue, options)?;
    ground.prepare(device, queue, scene, view).expect("valid lights");
    let inputs = Inputs { view, medium: &scene.medium, lights: ground.lights(), depth: &targets.depth };
    renderer.prepare(device, queue, &inputs)?;
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut timer = PassTimer::off();
    targets.encode_clear(&mut encoder);
    ground.encode_shadows(&mut encoder, &mut timer);
    ground.encode_depth(&mut encoder, &targets, &mut timer);
    renderer.encode(&mut encoder, &targets.radiance_view, &mut timer);
    queue.submit([encoder.finish()]);
    let image = read_image(device, queue, &targets.radiance).expect("the device is there");
    assert_eq!(context.take_error(), None, "the device reports nothing");
    inspect(&renderer);
    Ok(image)
}

/// The airlight of the CPU reference.
pub(crate) fn reference(scene: &Scene, view: &View) -> Image {
    let reference = Reference::new(scene).expect("valid scene");
    let terms = Terms::from_iter([Term::Airlight]);
    let rendered = reference.render(view, terms, &|_| {}, &AtomicBool::new(false)).expect("not cancelled");
    rendered.airlight.expect("airlight was asked for")
}

/// RMS difference where the reference is lit, and the largest anywhere, over the reference's mean there.
pub(crate) fn errors(image: &Image, reference: &Image) -> (f64, f64) {
    let errors = common::metrics::compare(image, reference).expect("pictures of one size");
    (errors.rel_rmse, errors.max)
}
