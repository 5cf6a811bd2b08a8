//! Small renders against the CPU reference and against known answers.

mod support;

use std::sync::Arc;

use chen_planes::{Error, Factor, Options, Placement, Renderer, Visibility, shaders};
use common::gpu::bench;
use common::{Camera, Light, LightMap, Lobe, Medium, Phase, PointLight, Scene};
use glam::Vec3;
use support::{assert_sane, best, boxes, cuboid, draw, errors, format, paper, point, reference, spot, sun};

#[test]
fn the_shader_is_valid_without_optional_features() {
    bench::validate_wgsl(&shaders::planes()).unwrap();
    assert_eq!(bench::uniform_branches(&shaders::planes()).unwrap(), [""; 0]);
}

#[test]
fn boxes_are_drawn_as_by_the_reference() {
    for (name, light, bound) in [
        ("point", point(), 0.004),
        ("spot", spot(0.6, 0.6), 0.004),
        ("soft", spot(0.3, 0.6), 0.006),
        ("sun", sun(), 0.004),
    ] {
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(80, 60);
        let truth = reference(&scene, &view);
        let measure = |scene: &Scene, options: &Options| {
            let image = draw(scene, &view, options, 256).unwrap();
            assert_sane(&image, name);
            errors(&image, &truth).0
        };
        let found = measure(&scene, &best());
        println!("{name}: {found:.5} by default");
        assert!(found < bound, "{name}: {found}");
        // The comparison can fail: the same scene without one of its boxes.
        let mut open = scene.clone();
        open.objects.remove(3);
        assert!(measure(&open, &best()) > 2.0 * bound, "{name}");
    }
}

#[test]
fn each_improvement_is_right_by_itself() {
    // A light that no ray passes near and a wall that ends all rays: what is left is the edges of shadows.
    let mut scene = boxes(sun(), 0.2);
    scene.objects.push(cuboid(Vec3::new(-20.0, -12.0, -7.0), Vec3::new(20.0, 14.0, -6.5)));
    let view = scene.camera.view(64, 48);
    let truth = reference(&scene, &view);
    let mut base = 0.0;
    for (name, options, gain) in [
        ("paper", paper(), 1.0),
        ("placement", Options { placement: Placement::Transmittance, ..paper() }, 1.5),
        ("integrand", Options { placement: Placement::Integrand, ..paper() }, 1.5),
        ("attenuation", Options { factor: Factor::Attenuation, ..paper() }, 1.01),
        ("integrated", Options { factor: Factor::Integrated, ..paper() }, 1.01),
        ("samples", Options { visibility: Visibility::PerFragment { samples: 4 }, ..paper() }, 0.6),
        ("offset", Options { offset: true, ..paper() }, 1.5),
        ("early end", Options { early_end: true, ..paper() }, 1.0),
    ] {
        let image = draw(&scene, &view, &Options { planes: 24, ..options }, 512).unwrap();
        assert_sane(&image, name);
        let (rms, _) = errors(&image, &truth);
        println!("{name}: {rms:.5}");
        base = if name == "paper" { rms } else { base };
        assert!(rms <= gain * base, "{name}: {rms}, paper {base}");
    }
    assert!(base < 0.04, "{base}");
}

#[test]
fn light_through_stained_glass_has_its_colours() {
    // Four panes of different colour and size; edges between them within the cone.
    let mut scene = boxes(spot(0.5, 0.5), 0.15);
    scene.medium.phase = Lobe::HenyeyGreenstein { g: 0.3 }.into();
    let panes =
        [Vec3::new(1.0, 0.1, 0.0), Vec3::new(0.0, 0.8, 0.2), Vec3::new(0.1, 0.2, 1.0), Vec3::splat(0.6)];
    let texel = |i: usize| panes[(i / 16 / 7).min(1) * 2 + usize::from(i % 16 > 9)];
    let map = LightMap { width: 16, height: 16, texels: (0..256).map(texel).collect() };
    if let Light::Spot(spot) = &mut scene.lights[0] {
        spot.light_map = Some(Arc::new(map));
    }
    let view = scene.camera.view(64, 48);
    let truth = reference(&scene, &view);
    let image = draw(&scene, &view, &best(), 256).unwrap();
    let (rms, _) = errors(&image, &truth);
    println!("stained glass: {rms:.5}");
    assert!(rms < 0.01, "{rms}");
    // It can fail: the picture turned about.
    if let Light::Spot(spot) = &mut scene.lights[0] {
        spot.up = Vec3::NEG_Y;
    }
    assert!(errors(&draw(&scene, &view, &best(), 256).unwrap(), &truth).0 > 0.1);
}

#[test]
fn several_lights_in_coloured_air_add_up() {
    let mut scene = boxes(point(), 0.1);
    scene.lights.extend([spot(0.3, 0.6), sun()]);
    let weights = [Vec3::new(0.2, 0.4, 0.9), Vec3::new(0.8, 0.7, 0.6)];
    scene.medium = Medium {
        sigma_s: Vec3::new(0.08, 0.1, 0.16),
        sigma_a: Vec3::new(0.02, 0.05, 0.0),
        phase: Phase::mixture(vec![(weights[0], Lobe::Rayleigh), (weights[1], Lobe::MieHazy)]),
    };
    let view = scene.camera.view(64, 48);
    let truth = reference(&scene, &view);
    let image = draw(&scene, &view, &best(), 256).unwrap();
    assert_sane(&image, "three lights");
    let (rms, _) = errors(&image, &truth);
    println!("three lights: {rms:.5}");
    assert!(rms < 0.005, "{rms}");
    let alone = scene.lights.iter().map(|light| {
        let scene = Scene { lights: vec![light.clone()], ..scene.clone() };
        draw(&scene, &view, &best(), 256).unwrap()
    });
    let sum = alone.reduce(|sum, image| sum.plus(&image)).unwrap();
    let (rms, _) = errors(&image, &sum);
    assert!(rms < 1e-5, "one by one {rms}");
}

#[test]
fn the_eye_may_be_anywhere() {
    let scene = boxes(spot(0.5, 0.6), 0.1);
    let light = scene.lights[0].position().unwrap();
    let places = [
        ("inside the shaft", Vec3::new(-1.4, 2.4, 0.5), 0.01),
        ("in shadow", Vec3::new(-1.2, 1.0, 0.2), 0.01),
        ("behind the light", light + Vec3::new(-0.5, 0.5, 0.4), 0.01),
        ("at the apex", light + Vec3::new(0.01, 0.013, 0.02), 0.02),
        ("outside the scene", Vec3::new(30.0, 20.0, 45.0), 0.03),
    ];
    for (name, eye, bound) in places {
        let mut scene = scene.clone();
        scene.camera = Camera { eye, target: Vec3::new(0.1, 0.9, 0.2), up: Vec3::Y, fov_y: 1.0 };
        let view = scene.camera.view(64, 48);
        let truth = reference(&scene, &view);
        let image = draw(&scene, &view, &best(), 512).unwrap();
        assert_sane(&image, name);
        let (rms, _) = errors(&image, &truth);
        println!("{name}: {rms:.5}");
        assert!(rms < bound, "{name}: {rms}");
    }
}

#[test]
fn rays_that_meet_nothing_go_on_for_ever() {
    for light in [point(), spot(0.7, 0.7), sun()] {
        let kind = light.kind();
        let mut scene = boxes(light, 0.1);
        scene.objects.truncate(2);
        scene.camera.target.y = 6.0;
        let view = scene.camera.view(48, 36);
        let (rms, worst) = errors(&draw(&scene, &view, &best(), 256).unwrap(), &reference(&scene, &view));
        println!("{kind}: {rms:.5}, worst {worst:.5}");
        assert!(rms < 0.003, "{kind}: {rms}");
    }
}

#[test]
fn one_frame_twice_is_the_same_bits() {
    let scene = boxes(point(), 0.1);
    let view = scene.camera.view(64, 48);
    for options in [best(), paper()] {
        let first = draw(&scene, &view, &options, 128).unwrap();
        assert_eq!(first, draw(&scene, &view, &options, 128).unwrap());
    }
}

#[test]
fn scale_makes_no_difference() {
    // Lengths times s, coefficients over s, intensity times s: the same optical depths, the same picture.
    let scaled = |s: f32, options: &Options| {
        let mut scene = boxes(point(), 0.1);
        for object in &mut scene.objects {
            object.world_from_object = glam::Affine3A::from_scale(Vec3::splat(s));
        }
        scene.medium = Medium::grey(0.1 / s, 0.9, Phase::isotropic());
        scene.camera.eye *= s;
        scene.camera.target *= s;
        if let Light::Point(light) = &mut scene.lights[0] {
            light.position *= s;
            light.intensity *= s * s;
        }
        let view = scene.camera.view(48, 36);
        draw(&scene, &view, options, 128).unwrap()
    };
    for options in [best(), paper()] {
        let truth = scaled(1.0, &options);
        for s in [1e-6, 1e-3, 1e3, 1e6] {
            let (rms, worst) = errors(&scaled(s, &options), &truth);
            println!("scale {s:e}: {rms:.1e} {worst:.1e}");
            assert!(rms < 2e-3, "scale {s}: {rms} {worst}");
        }
    }
}

#[test]
fn nothing_comes_of_nothing() {
    for (name, change) in [
        ("no lights", (|scene| scene.lights.clear()) as fn(&mut Scene)),
        ("no medium", |scene| scene.medium = Medium::vacuum()),
        ("pure absorption", |scene| scene.medium = Medium::grey(0.5, 0.0, Phase::isotropic())),
        ("dark light", |scene| {
            scene.lights = vec![Light::Point(PointLight { position: Vec3::Y, intensity: Vec3::ZERO })];
        }),
    ] {
        for light in [point(), sun()] {
            let mut scene = boxes(light, 0.1);
            scene.objects.truncate(1);
            change(&mut scene);
            for options in [best(), paper()] {
                let image = draw(&scene, &scene.camera.view(16, 12), &options, 32).unwrap();
                assert!(image.pixels.iter().all(|p| *p == Vec3::ZERO), "{name}");
            }
        }
    }
}

#[test]
fn what_can_not_be_drawn_is_refused() {
    let context = bench::context();
    for (part, options) in [
        ("Rgba8Unorm", Options { target_format: wgpu::TextureFormat::Rgba8Unorm, ..best() }),
        ("planes is 0", Options { planes: 0, ..best() }),
        ("planes is 5000", Options { planes: 5000, ..best() }),
        ("lattice is 1×8", Options { lattice: [1, 8], ..best() }),
        ("(samples) is 0", Options { visibility: Visibility::PerFragment { samples: 0 }, ..best() }),
        ("phase_texels is 3", Options { phase_texels: 3, ..best() }),
    ] {
        let error = Renderer::new(&context.device, &context.queue, &options).err().unwrap().to_string();
        assert!(error.contains(part), "{error}");
    }
    let scene = boxes(point(), 0.1);
    let view = scene.camera.view(16, 12);
    for reach in [f32::NAN, f32::INFINITY, 0.0, -1.0] {
        let error = support::draw_to(&scene, &view, &best(), 32, reach).unwrap_err();
        assert!(matches!(error, Error::Reach { .. }), "{error}");
    }
    let half = Options::default();
    assert_eq!(half.target_format, wgpu::TextureFormat::Rgba16Float);
    assert!(draw(&scene, &view, &half, 32).is_ok(), "{:?}", format());
}
