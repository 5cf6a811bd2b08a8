//! One way to draw a scene, shared by the tests.
#![allow(dead_code, unused_imports, reason = "each test program uses its own part")]

use chen_planes::{Error, Inputs, Options, Renderer, reach};
pub(crate) use common::gpu::bench::scenes::{
    assert_sane, boxes, cuboid, errors, point, reference, spot, sun,
};
use common::gpu::{Ground, PassTimer, Targets, bench, read_image};
use common::image::Image;
use common::{Scene, View};

/// Format of the pictures: 32 bits where the adapter blends them.
pub(crate) fn format() -> wgpu::TextureFormat {
    bench::context().radiance_format()
}

/// The default, for [`format`].
pub(crate) fn best() -> Options {
    Options::best(format())
}

/// The paper's setting, for [`format`].
pub(crate) fn paper() -> Options {
    Options::paper(format())
}

/// Draws the airlight of a scene.
pub(crate) fn draw(scene: &Scene, view: &View, options: &Options, shadow_size: u32) -> Result<Image, Error> {
    let reach = reach(view, scene.bounds(), &scene.lights, &scene.medium);
    draw_to(scene, view, options, shadow_size, reach)
}

/// As [`draw`], with planes up to `reach` \[m\].
pub(crate) fn draw_to(
    scene: &Scene,
    view: &View,
    options: &Options,
    shadow_size: u32,
    reach: f32,
) -> Result<Image, Error> {
    let context = bench::context();
    let (device, queue) = (&context.device, &context.queue);
    let targets = Targets::new(device, view.width, view.height, options.target_format);
    let mut ground =
        Ground::new(device, queue, scene, options.target_format, shadow_size).expect("valid scene");
    let mut renderer = Renderer::new(device, queue, options)?;
    ground.prepare(device, queue, scene, view).expect("valid lights");
    let inputs =
        Inputs { view, medium: &scene.medium, lights: ground.lights(), depth: &targets.depth, reach };
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
    Ok(image)
}
