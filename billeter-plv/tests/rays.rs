//! Exact lit intervals per ray: against a dense march through the same shadow map, the CPU reference and the mesh.

#[path = "support/march.rs"]
mod march;
mod support;

use billeter_plv::{Error, Options, Renderer, shaders};
use common::gpu::bench::{context, uniform_branches, validate_wgsl};
use common::{Camera, Light, LightMap, Lobe, Medium, PointLight, Scene};
use glam::Vec3;
use march::march;
use support::{assert_sane, boxes, draw, errors, point, reference, spot, sun};

fn rays() -> Options {
    Options::rays(context().radiance_format())
}

fn lights() -> [(&'static str, Light); 4] {
    [("point", point()), ("spot", spot(0.6, 0.6)), ("soft", spot(0.3, 0.6)), ("sun", sun())]
}

/// Coloured, scattering forwards.
fn coloured() -> Medium {
    Medium {
        sigma_s: Vec3::new(0.1, 0.12, 0.15),
        sigma_a: Vec3::new(0.0, 0.05, 0.02),
        phase: Lobe::HenyeyGreenstein { g: 0.5 }.into(),
    }
}

#[test]
fn shaders_are_valid_without_optional_features() {
    for source in [shaders::finest_level(), shaders::coarser_level(), shaders::rays()] {
        validate_wgsl(&source).unwrap();
        assert_eq!(uniform_branches(&source).unwrap(), [""; 0]);
    }
}

#[test]
fn lit_intervals_are_those_of_the_map() {
    // Sizes that are no power of two, and maps so small that a wrong texel is a large error.
    for (name, light) in lights() {
        for (size, medium) in [(2, None), (7, Some(coloured())), (64, None), (500, Some(coloured()))] {
            let mut scene = boxes(light.clone(), 0.1);
            scene.medium = medium.unwrap_or(scene.medium);
            let view = scene.camera.view(24, 18);
            let truth = march(&scene, &view, size);
            let image = draw(&scene, &view, &rays(), size).unwrap();
            assert_sane(&image, name);
            let (rms, worst) = errors(&image, &truth);
            println!("{name}, {size}: {rms:.1e} rms, {worst:.1e} worst");
            assert!(rms < 2e-3, "{name} {size}: {rms}");
            if size == 500 {
                // The comparison can fail: a map of half the size is another lit volume.
                let other = draw(&scene, &view, &rays(), size / 2).unwrap();
                assert!(errors(&other, &truth).0 > 2.0 * rms, "{name}");
            }
        }
    }
}

#[test]
fn boxes_are_drawn_as_by_the_reference_and_the_mesh() {
    for (name, light) in lights() {
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(48, 36);
        let image = draw(&scene, &view, &rays(), 256).unwrap();
        let (truth, _) = errors(&image, &reference(&scene, &view));
        let best = Options::best(rays().target_format);
        let (mesh, _) = errors(&image, &draw(&scene, &view, &best, 256).unwrap());
        println!("{name}: {truth:.5} off the reference, {mesh:.5} off the mesh");
        assert!(truth < 0.008 && mesh < 0.008, "{name}: {truth} {mesh}");
    }
}

#[test]
fn empty_air_is_the_closed_form() {
    for (name, light) in lights() {
        for medium in [boxes(light.clone(), 0.1).medium, coloured()] {
            let mut scene = boxes(light.clone(), 0.1);
            scene.objects.clear();
            scene.medium = medium;
            let view = scene.camera.view(48, 36);
            let truth = reference(&scene, &view);
            for size in [2, 64] {
                let (rms, worst) = errors(&draw(&scene, &view, &rays(), size).unwrap(), &truth);
                println!("{name}, {size}: {rms:.1e} rms, {worst:.1e} worst");
                assert!(rms < 5e-4, "{name} {size}: {rms}");
            }
        }
    }
}

#[test]
fn the_eye_may_be_anywhere() {
    for (name, light) in lights() {
        let scene = boxes(light, 0.1);
        let apex = scene.lights[0].position().unwrap_or(Vec3::new(4.0, 9.0, -2.0));
        let looks = [
            (Vec3::new(-2.0, 0.8, -0.3), Vec3::new(0.1, 0.9, 0.2)),
            // Straight at the light, at it, beside it, behind it along its axis, and far away.
            (Vec3::new(0.4, 1.6, 6.3), apex),
            (apex, apex + Vec3::NEG_Z),
            (apex + Vec3::new(1e-4, 0.0, 2e-4), Vec3::ZERO),
            (apex - Vec3::new(0.62, -0.7, -0.2), apex),
            (Vec3::new(30.0, 20.0, 45.0), Vec3::ZERO),
        ];
        for (i, (eye, target)) in looks.into_iter().enumerate() {
            let mut scene = scene.clone();
            scene.camera = Camera { eye, target, up: Vec3::Y, fov_y: 1.0 };
            // An odd size: the middle pixel's ray goes through the target itself.
            let view = scene.camera.view(25, 17);
            let image = draw(&scene, &view, &rays(), 100).unwrap();
            for pixel in &image.pixels {
                assert!(pixel.is_finite() && pixel.min_element() >= 0.0, "{name}, place {i}: {pixel}");
            }
            assert_eq!(image, draw(&scene, &view, &rays(), 100).unwrap(), "{name}, place {i}: the same bits");
        }
    }
}

#[test]
fn lights_of_both_kinds_share_the_levels() {
    // Six layers, then one, then none that is lit: what one light leaves behind must not show in the next.
    let both = Scene { lights: vec![point(), sun(), spot(0.6, 0.6)], ..boxes(point(), 0.1) };
    let view = both.camera.view(32, 24);
    let all = draw(&both, &view, &rays(), 100).unwrap();
    let mut sum = vec![Vec3::ZERO; all.pixels.len()];
    for light in &both.lights {
        let one = Scene { lights: vec![light.clone()], ..both.clone() };
        for (sum, pixel) in sum.iter_mut().zip(draw(&one, &view, &rays(), 100).unwrap().pixels) {
            *sum += pixel;
        }
    }
    for (a, b) in all.pixels.iter().zip(sum) {
        assert!((*a - b).abs().max_element() <= 1e-5 * b.max_element(), "{a} {b}");
    }
}

#[test]
fn what_can_not_be_drawn_is_refused() {
    let mut scene = boxes(spot(0.6, 0.6), 0.1);
    if let Light::Spot(spot) = &mut scene.lights[0] {
        let map = LightMap { width: 1, height: 1, texels: vec![Vec3::X] };
        spot.light_map = Some(std::sync::Arc::new(map));
    }
    let view = scene.camera.view(16, 12);
    let error = draw(&scene, &view, &rays(), 32).unwrap_err();
    assert!(matches!(error, Error::Unsupported { light: 0, .. }), "{error}");
    let target = Options::rays(wgpu::TextureFormat::Rgba8Unorm);
    assert!(Renderer::new(&context().device, &context().queue, &target).is_err());
    scene.lights = vec![Light::Point(PointLight { position: Vec3::Y, intensity: Vec3::ZERO })];
    let dark = draw(&scene, &view, &rays(), 32).unwrap();
    assert!(dark.pixels.iter().all(|p| *p == Vec3::ZERO));
}
