//! One way to draw a scene, shared by the tests.
#![allow(dead_code, unused_imports, reason = "each test program uses its own part")]

use biri_ss::{Error, Inputs, Options, Outputs, Renderer, Statistics, Surfaces};
use common::gpu::bench::{self, context};
use common::gpu::{Ground, PassTimer, SurfaceData, Targets, read_image};
use common::image::Image;
use common::{Light, Scene, View};
use glam::Vec3;

pub(crate) use common::gpu::bench::scenes::{
    assert_sane, boxes, cuboid, errors, object, point, reference, spot, sun,
};

/// All terms of a scene, each by itself.
pub(crate) struct Pictures {
    pub(crate) airlight: Image,
    pub(crate) surfaces: Image,
    pub(crate) indirect: Image,
    pub(crate) statistics: Statistics,
}

/// The default in 32 bits where the adapter has them, nothing clamped.
pub(crate) fn best() -> Options {
    Options { clamp_negative: false, ..Options::best(context().radiance_format()) }
}

/// A renderer that draws one scene after the other.
pub(crate) struct Drawer {
    pub(crate) renderer: Renderer,
    options: Options,
}

impl Drawer {
    pub(crate) fn new(options: &Options) -> Self {
        let context = context();
        let renderer = Renderer::new(&context.device, &context.queue, options).expect("valid options");
        Self { renderer, options: *options }
    }

    pub(crate) fn draw(&mut self, scene: &Scene, view: &View, ambient: Vec3) -> Result<Pictures, Error> {
        let context = context();
        let (device, queue) = (&context.device, &context.queue);
        let format = self.options.target_format;
        let targets = || Targets::new(device, view.width, view.height, format);
        let [airlight, surfaces, indirect] = [targets(), targets(), targets()];
        let data = SurfaceData::new(device, view.width, view.height);
        let spots = scene.lights.iter().any(|light| matches!(light, Light::Spot(_)));
        let inputs = Inputs {
            view,
            medium: &scene.medium,
            lights: &scene.lights,
            casters: &scene.objects,
            depth: &airlight.depth,
            surfaces: Some(Surfaces {
                normal: &data.normal,
                diffuse: &data.diffuse,
                specular: &data.specular,
                indirect: !spots,
            }),
            ambient,
        };
        self.renderer.prepare(device, queue, &inputs)?;
        // Shadow maps play no part.
        let mut ground = Ground::new(device, queue, scene, format, 2).expect("valid scene");
        ground.prepare(device, queue, scene, view).expect("valid lights");
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut timer = PassTimer::off();
        [&airlight, &surfaces, &indirect].iter().for_each(|target| target.encode_clear(&mut encoder));
        ground.encode_depth(&mut encoder, &airlight, &mut timer);
        ground.encode_surface_data(&mut encoder, &airlight, &data, &mut timer);
        let outputs = Outputs {
            airlight: &airlight.radiance_view,
            surfaces: Some(&surfaces.radiance_view),
            indirect: Some(&indirect.radiance_view),
        };
        self.renderer.encode(&mut encoder, &outputs, &mut timer);
        queue.submit([encoder.finish()]);
        let [airlight, surfaces, indirect] = [airlight, surfaces, indirect]
            .map(|target| read_image(device, queue, &target.radiance).expect("the device is there"));
        assert_eq!(context.take_error(), None, "the device reports nothing");
        Ok(Pictures { airlight, surfaces, indirect, statistics: self.renderer.statistics() })
    }
}

/// All terms of a scene.
pub(crate) fn draw(scene: &Scene, view: &View, options: &Options) -> Result<Pictures, Error> {
    Drawer::new(options).draw(scene, view, Vec3::ZERO)
}

/// The airlight alone.
pub(crate) fn airlight(scene: &Scene, view: &View, options: &Options) -> Image {
    draw(scene, view, options).expect("drawn").airlight
}

/// As [`errors`], without the few pixels at edges where the rasteriser, which rounds corners to 1/256 pixel, sees
/// another surface than the ray through the pixel's centre: their number, and the error of the others.
pub(crate) fn errors_off_edges(image: &Image, reference: &Image) -> (usize, f64) {
    let mean = reference.pixels.iter().map(|p| p.max_element()).sum::<f32>() / reference.pixels.len() as f32;
    let far = |a: Vec3, b: Vec3| (a - b).abs().max_element() > 0.02 * b.max_element().max(0.1 * mean);
    let mut without = image.clone();
    let mut count = 0;
    for (a, b) in without.pixels.iter_mut().zip(&reference.pixels) {
        if far(*a, *b) {
            *a = *b;
            count += 1;
        }
    }
    (count, errors(&without, reference).0)
}
