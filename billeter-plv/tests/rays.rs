//! Exact lit intervals per ray.

mod support;

use billeter_plv::{Options, shaders};
use common::gpu::bench::validate_wgsl;
use support::{assert_sane, boxes, draw, errors, point, reference, spot, sun};

fn rays() -> Options {
    Options::rays(common::gpu::bench::context().radiance_format())
}

#[test]
fn shaders_are_valid_without_optional_features() {
    for source in [shaders::finest_level(), shaders::coarser_level(), shaders::rays()] {
        validate_wgsl(&source).unwrap();
    }
}

#[test]
fn boxes_are_drawn_as_by_the_reference() {
    for (name, light, bound) in [
        ("point", point(), 0.01),
        ("spot", spot(0.6, 0.6), 0.01),
        ("soft", spot(0.3, 0.6), 0.015),
        ("sun", sun(), 0.01),
    ] {
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(80, 60);
        let truth = reference(&scene, &view);
        let image = draw(&scene, &view, &rays(), 256).unwrap();
        assert_sane(&image, name);
        let (rms, worst) = errors(&image, &truth);
        println!("{name}: {rms:.5} rms, {worst:.3} worst");
        assert!(rms < bound, "{name}: {rms}");
        let mut open = scene.clone();
        open.objects.clear();
        let truth = reference(&open, &view);
        let (rms, worst) = errors(&draw(&open, &view, &rays(), 256).unwrap(), &truth);
        println!("{name}, open: {rms:.6} rms, {worst:.6} worst");
    }
}
