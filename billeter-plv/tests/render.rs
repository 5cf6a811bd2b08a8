//! Small renders against the CPU reference and against known answers.

mod support;

use billeter_plv::{Error, Evaluation, Inputs, Options, Renderer, Tessellation};
use common::gpu::{Ground, PassTimer, Targets, bench, read_image};
use common::{Camera, Light, LightMap, Medium, Phase, PointLight, Scene};
use glam::Vec3;
use support::{assert_sane, boxes, cuboid, draw, draw_with, errors, point, reference, spot, sun};

/// No shortcut at all: full mesh, quadrature, 32 bits where the adapter has them, nothing clamped.
fn exact() -> Options {
    Options {
        target_format: bench::context().radiance_format(),
        tessellation: Tessellation::Full,
        upright_walls: false,
        clamp_negative: false,
        ..Options::default()
    }
}

#[test]
fn boxes_are_drawn_as_by_the_reference() {
    for (name, light, bound) in [
        ("point", point(), 0.006),
        ("spot", spot(0.6, 0.6), 0.01),
        ("soft", spot(0.3, 0.6), 0.015),
        ("sun", sun(), 0.006),
    ] {
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(80, 60);
        let truth = reference(&scene, &view);
        let image = draw(&scene, &view, &exact(), 256).unwrap();
        assert_sane(&image, name);
        let (rms, worst) = errors(&image, &truth);
        println!("{name}: {rms:.5} rms, {worst:.3} worst");
        assert!(rms < bound, "{name}: {rms}");
        // The comparison can fail: the same scene without one of its boxes.
        let mut open = scene.clone();
        open.objects.remove(3);
        assert!(errors(&draw(&open, &view, &exact(), 256).unwrap(), &truth).0 > 2.0 * bound, "{name}");

        let adaptive = Options { tessellation: Tessellation::Adaptive { tolerance: 5e-4 }, ..exact() };
        let image = draw(&scene, &view, &adaptive, 256).unwrap();
        assert_sane(&image, name);
        let (adaptive_rms, _) = errors(&image, &truth);
        assert!(adaptive_rms < 1.1 * rms + 2e-4, "{name}: adaptive {adaptive_rms}, full {rms}");
        // Upright walls are worth their name: nearer to the truth than sloping ones.
        let best =
            Options { clamp_negative: false, target_format: exact().target_format, ..Options::default() };
        let image = draw(&scene, &view, &best, 256).unwrap();
        assert_sane(&image, name);
        let (best_rms, _) = errors(&image, &truth);
        println!("{name}: {best_rms:.5} rms by default");
        assert!(best_rms < 0.85 * rms, "{name}: default {best_rms}, sloping {rms}");
        if name != "soft" {
            let (paper, _) =
                errors(&draw(&scene, &view, &Options::paper(exact().target_format), 256).unwrap(), &truth);
            assert!(paper < bound, "{name}: paper {paper}");
        }
    }
}

#[test]
fn empty_air_is_the_closed_form_across_all_seams() {
    // No occluder: what is left is airlight itself, and whether the volume is closed. The camera looks
    // across edges and a corner of the cube map; a crack would show as a pixel far off.
    for light in [point(), spot(0.7, 0.7), sun()] {
        let mut scene = boxes(light, 0.15);
        scene.objects.clear();
        scene.medium = Medium {
            sigma_s: Vec3::new(0.1, 0.12, 0.15),
            sigma_a: Vec3::new(0.0, 0.05, 0.02),
            phase: common::Lobe::HenyeyGreenstein { g: 0.4 }.into(),
        };
        let kind = scene.lights[0].kind();
        for eye in [Vec3::new(3.0, 6.1, 2.2), Vec3::new(-4.2, 0.3, -4.9)] {
            scene.camera.eye = eye;
            let view = scene.camera.view(72, 54);
            let truth = reference(&scene, &view);
            for (tessellation, upright_walls) in
                [(Tessellation::Full, false), (Tessellation::Adaptive { tolerance: 1e-3 }, true)]
            {
                let image =
                    draw(&scene, &view, &Options { tessellation, upright_walls, ..exact() }, 64).unwrap();
                assert_sane(&image, kind);
                for (i, (a, b)) in image.pixels.iter().zip(&truth.pixels).enumerate() {
                    // An empty texel stands for 1000 radii: a little of an endless ray is missing. Where a
                    // spot's cone is grazed there is hardly any light at all.
                    let scale = b.max_element().max(1e-3 * truth.pixels[i].max_element().max(0.01));
                    let off = (*a - *b).abs().max_element() / scale;
                    assert!(off < 0.01, "{kind} {tessellation:?} from {eye}, pixel {i}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn the_eye_may_be_anywhere() {
    let scene = boxes(point(), 0.1);
    let light = scene.lights[0].position().unwrap();
    let places = [
        ("inside the volume", Vec3::new(1.5, 1.5, 2.0)),
        ("in shadow", Vec3::new(-2.0, 0.8, -0.3)),
        ("behind the light", light + Vec3::new(0.3, 1.0, -2.0)),
        ("at the apex", light + Vec3::new(0.01, 0.013, 0.02)),
        ("outside the scene", Vec3::new(30.0, 20.0, 45.0)),
    ];
    for (name, eye) in places {
        let mut scene = scene.clone();
        scene.camera = Camera { eye, target: Vec3::new(0.1, 0.9, 0.2), up: Vec3::Y, fov_y: 1.0 };
        let view = scene.camera.view(64, 48);
        let truth = reference(&scene, &view);
        let image = draw(&scene, &view, &exact(), 256).unwrap();
        assert_sane(&image, name);
        let (rms, _) = errors(&image, &truth);
        println!("{name}: {rms:.5}");
        assert!(rms < 0.03, "{name}: {rms}");
    }
}

#[test]
fn a_light_in_the_plane_of_the_eye_is_not_black() {
    // The printed tests of sign leave out zero foot distances, and such pixels come out black.
    let mut scene = Scene::empty("plane");
    scene.lights =
        vec![Light::Point(PointLight { position: Vec3::new(0.0, 2.0, 0.0), intensity: Vec3::ONE })];
    scene.medium = Medium::grey(0.2, 1.0, Phase::isotropic());
    scene.camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov_y: 0.6 };
    // An odd height has a row of pixels whose rays are perpendicular to the light's direction.
    let view = scene.camera.view(33, 33);
    let truth = reference(&scene, &view);
    for options in [exact(), Options::paper(exact().target_format)] {
        let image = draw(&scene, &view, &options, 64).unwrap();
        for (a, b) in image.pixels.iter().zip(&truth.pixels) {
            assert!((a.x / b.x - 1.0).abs() < 0.02, "{a} {b}");
        }
    }
}

/// A room of thick walls around the camera, light outside; without its far wall if `open`.
fn room(light: Light, open: bool) -> Scene {
    let mut scene = Scene::empty("room");
    let wall = |low: [f32; 3], high: [f32; 3]| cuboid(Vec3::from(low), Vec3::from(high));
    scene.objects = vec![
        wall([-2.5, -0.5, -2.5], [2.5, 0.0, 2.5]),
        wall([-2.5, 2.5, -2.5], [2.5, 3.0, 2.5]),
        wall([-2.5, -0.5, -2.5], [-2.0, 3.0, 2.5]),
        wall([2.0, -0.5, -2.5], [2.5, 3.0, 2.5]),
        wall([-2.5, -0.5, 2.0], [2.5, 3.0, 2.5]),
    ];
    if !open {
        scene.objects.push(wall([-2.5, -0.5, -2.5], [2.5, 3.0, -2.0]));
    }
    scene.lights = vec![light];
    scene.medium = Medium::grey(0.2, 0.9, Phase::isotropic());
    scene.camera =
        Camera { eye: Vec3::new(0.1, 1.3, 1.7), target: Vec3::new(0.0, 1.2, 0.0), up: Vec3::Y, fov_y: 1.2 };
    scene
}

#[test]
fn a_sealed_room_stays_dark() {
    let outside =
        Light::Point(PointLight { position: Vec3::new(0.9, 2.0, -5.3), intensity: Vec3::splat(50.0) });
    for light in [outside, sun()] {
        let kind = light.kind();
        let scene = room(light.clone(), false);
        let view = scene.camera.view(64, 48);
        let sum = |scene: &Scene, options: &Options| -> f64 {
            let image = draw(scene, &view, options, 128).unwrap();
            image.pixels.iter().map(|p| f64::from(p.x.abs())).sum()
        };
        let open = sum(&room(light, true), &exact());
        for (tessellation, upright_walls) in
            [(Tessellation::Full, false), (Tessellation::Adaptive { tolerance: 5e-4 }, true)]
        {
            let sealed = sum(&scene, &Options { tessellation, upright_walls, ..exact() });
            println!("{kind} {tessellation:?}: sealed {sealed:.2e}, open {open:.2e}");
            assert!(sealed <= 1e-5 * open, "{kind}: {sealed} of {open}");
        }
    }
}

#[test]
fn one_frame_twice_is_the_same_bits() {
    let scene = boxes(point(), 0.1);
    let view = scene.camera.view(64, 48);
    let options = Options { target_format: exact().target_format, ..Options::default() };
    let first = draw(&scene, &view, &options, 256).unwrap();
    assert_eq!(first, draw(&scene, &view, &options, 256).unwrap());
}

#[test]
fn scale_makes_no_difference() {
    // Lengths times s, coefficients over s, intensity times s: the same optical depths, the same picture.
    let scaled = |s: f32| {
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
        draw(
            &scene,
            &view,
            &Options { tessellation: Tessellation::Adaptive { tolerance: 5e-4 }, ..exact() },
            128,
        )
        .unwrap()
    };
    let truth = scaled(1.0);
    for s in [1e-6, 1e-3, 1e3, 1e6] {
        let (rms, worst) = errors(&scaled(s), &truth);
        println!("scale {s:e}: {rms:.1e} {worst:.1e}");
        assert!(rms < 2e-3, "scale {s}: {rms} {worst}");
    }
}

#[test]
fn an_adaptive_mesh_is_small_where_the_map_is_flat() {
    let scene = boxes(sun(), 0.1);
    let view = scene.camera.view(16, 12);
    let count = |tolerance: f32| {
        let options = Options { tessellation: Tessellation::Adaptive { tolerance }, ..exact() };
        let mut triangles = None;
        let context = bench::context();
        draw_with(&scene, &view, &options, 256, |renderer| {
            triangles = renderer.read_adaptive_triangles(&context.device, &context.queue);
        })
        .unwrap();
        triangles.expect("adaptive")
    };
    let full = 2 * 255 * 255;
    let (fine, coarse) = (count(1e-6), count(1e-3));
    println!("{coarse} of {full}, {fine} at the finest");
    assert!(coarse < full / 8 && coarse > 100, "{coarse} of {full}");
    assert!(coarse <= fine && fine <= full);
}

#[test]
fn nothing_comes_of_nothing() {
    let options = exact();
    for (name, change) in [
        ("no lights", (|scene| scene.lights.clear()) as fn(&mut Scene)),
        ("no medium", |scene| scene.medium = Medium::vacuum()),
        ("pure absorption", |scene| scene.medium = Medium::grey(0.5, 0.0, Phase::isotropic())),
        ("dark light", |scene| {
            scene.lights = vec![Light::Point(PointLight { position: Vec3::Y, intensity: Vec3::ZERO })];
        }),
    ] {
        let mut scene = boxes(point(), 0.1);
        change(&mut scene);
        let image = draw(&scene, &scene.camera.view(16, 12), &options, 32).unwrap();
        assert!(image.pixels.iter().all(|p| *p == Vec3::ZERO), "{name}");
    }
}

#[test]
fn light_at_the_eye_is_finite() {
    let mut scene = boxes(point(), 0.1);
    scene.lights = vec![Light::Point(PointLight { position: scene.camera.eye, intensity: Vec3::ONE })];
    for options in [exact(), Options::paper(exact().target_format)] {
        let image = draw(&scene, &scene.camera.view(32, 24), &options, 64).unwrap();
        assert!(image.pixels.iter().all(|p| p.is_finite()), "light at the eye");
    }
}

#[test]
fn odd_map_sizes_are_closed_too() {
    for light in [point(), spot(0.6, 0.6), sun()] {
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(48, 36);
        let truth = reference(&scene, &view);
        for size in [2, 5, 100, 257] {
            let options = Options { target_format: exact().target_format, ..Options::default() };
            let image = draw(&scene, &view, &options, size).unwrap();
            assert_sane(&image, "odd");
            let (rms, _) = errors(&image, &truth);
            // A map of two texels knows nothing; from a hundred on the picture is right.
            assert!(rms < if size < 100 { 2.0 } else { 0.03 }, "{size}: {rms}");
        }
    }
}

#[test]
fn what_can_not_be_drawn_is_refused() {
    let view = Camera::default().view(16, 12);
    let soft = boxes(spot(0.3, 0.6), 0.1);
    let error = draw(&soft, &view, &Options::paper(exact().target_format), 32).unwrap_err();
    assert!(matches!(error, Error::Unsupported { light: 0, .. }), "{error}");

    let mut mapped = boxes(spot(0.6, 0.6), 0.1);
    if let Light::Spot(spot) = &mut mapped.lights[0] {
        let map = LightMap { width: 1, height: 1, texels: vec![Vec3::X] };
        spot.light_map = Some(std::sync::Arc::new(map));
    }
    assert!(draw(&mapped, &view, &exact(), 32).unwrap_err().to_string().contains("light map"));

    let context = bench::context();
    for options in [
        Options { target_format: wgpu::TextureFormat::Rgba8Unorm, ..exact() },
        Options { evaluation: Evaluation::Quadrature { panels: 0 }, ..exact() },
        Options { tessellation: Tessellation::Adaptive { tolerance: f32::NAN }, ..exact() },
        Options {
            evaluation: Evaluation::Table {
                width: 1,
                height: 1 << 20,
                format: common::gpu::TableFormat::F32,
            },
            ..exact()
        },
    ] {
        assert!(Renderer::new(&context.device, &context.queue, &options).is_err(), "{options:?}");
    }
}

#[test]
fn nothing_is_drawn_of_a_frame_that_is_refused() {
    let context = bench::context();
    let (device, queue) = (&context.device, &context.queue);
    let format = exact().target_format;
    let scene = boxes(spot(0.6, 0.6), 0.1);
    let view = scene.camera.view(16, 12);
    let targets = Targets::new(device, view.width, view.height, format);
    let mut ground = Ground::new(device, queue, &scene, format, 32).unwrap();
    ground.prepare(device, queue, &scene, &view).unwrap();
    let mut mapped = ground.lights().to_vec();
    if let Light::Spot(spot) = &mut mapped[0].light {
        let map = LightMap { width: 1, height: 1, texels: vec![Vec3::X] };
        spot.light_map = Some(std::sync::Arc::new(map));
    }
    for options in [exact(), Options::rays(format)] {
        let mut renderer = Renderer::new(device, queue, &options).unwrap();
        let inputs =
            Inputs { view: &view, medium: &scene.medium, lights: ground.lights(), depth: &targets.depth };
        renderer.prepare(device, queue, &inputs).unwrap();
        assert!(renderer.prepare(device, queue, &Inputs { lights: &mapped, ..inputs }).is_err());
        let mut encoder = device.create_command_encoder(&Default::default());
        targets.encode_clear(&mut encoder);
        renderer.encode(&mut encoder, &targets.radiance_view, &mut PassTimer::off());
        queue.submit([encoder.finish()]);
        let image = read_image(device, queue, &targets.radiance).unwrap();
        assert!(image.pixels.iter().all(|pixel| *pixel == Vec3::ZERO), "{:?}", options.volume);
    }
}
