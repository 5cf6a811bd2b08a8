//! How sampling planes are known to fail: each failure provoked, and cured by the default or held to its formula.

mod support;

use chen_planes::{Accumulation, Factor, Options, Placement, Visibility};
use common::image::Image;
use common::{Camera, DirectionalLight, Light, Lobe, Medium, Phase, PointLight, Scene, SpotLight, View};
use glam::Vec3;
use support::{assert_sane, best, boxes, cuboid, draw, draw_to, errors, paper, point, reference, spot, sun};

/// Air so thin that only 1/r² matters, the eye at the origin looking along −z, a light at `position`.
fn thin_air(position: Vec3) -> Scene {
    let mut scene = Scene::empty("thin air");
    scene.lights = vec![Light::Point(PointLight { position, intensity: Vec3::ONE })];
    scene.medium = Medium::grey(1e-5, 1.0, Phase::isotropic());
    scene.camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov_y: 1.0 };
    scene
}

/// What a single ray straight ahead gets, with planes up to `reach`.
fn straight_ahead(scene: &Scene, options: &Options, reach: f32) -> f64 {
    let view = scene.camera.view(1, 1);
    f64::from(draw_to(scene, &view, options, 2, reach).unwrap().pixels[0].x)
}

#[test]
fn bands_near_a_light_are_as_high_as_the_formula_says() {
    // Planes at half metres, the light on one of them and in the middle between two.
    let options = Options { planes: 64, factor: Factor::Attenuation, lattice: [2, 2], ..paper() };
    let options = Options { accumulation: Accumulation::F32, ..options };
    for height in [1.0f64, 0.5, 0.25, 0.125] {
        let measure = |depth: f32, options: &Options| {
            let scene = thin_air(Vec3::new(0.0, height as f32, -depth));
            let truth = f64::from(reference(&scene, &scene.camera.view(1, 1)).pixels[0].x);
            straight_ahead(&scene, options, 64.0) / truth - 1.0
        };
        let (on, between) = (measure(32.5, &options), measure(33.0, &options));
        let argument = std::f64::consts::PI * height;
        let (over, under) = (1.0 / argument.tanh() - 1.0, argument.tanh() - 1.0);
        println!("h/Δ {height}: {on:+.4} of {over:+.4}, {between:+.4} of {under:+.4}");
        // The planes end at 64 m: (2 / 32) / (π / h) of the light lies beyond.
        let cut = 0.02 * height + 0.001;
        assert!((on - over).abs() < 0.01 * over + cut, "on a plane {on}, {over}");
        assert!((between - under).abs() < cut, "between planes {between}, {under}");
        // The default has no bands: moving the light through a slab changes nothing.
        for depth in [32.5, 32.75, 33.0] {
            let off = measure(depth, &best());
            assert!(off.abs() < 2e-3, "{height} at {depth}: {off}");
        }
    }
}

#[test]
fn interpolation_of_the_whole_factor_loses_what_the_formula_says() {
    // One plane, 2 × 2 cells, 2 × 2 pixels in the middle of each; the light before the middle of one of them.
    let depth = 4.0f32;
    let half = depth * 0.5f32.tan();
    for nearness in [1.0f32, 2.0, 4.0] {
        let a = half / nearness;
        let mut scene = thin_air(Vec3::new(0.5 * half, 0.5 * half, a - depth));
        scene.camera.fov_y = 1.0;
        let view = scene.camera.view(2, 2);
        let value = |options: &Options| {
            // Row 0 is at the top.
            f64::from(draw_to(&scene, &view, options, 2, 2.0 * depth).unwrap().pixels[1].x)
        };
        let whole = Options { planes: 1, lattice: [3, 3], accumulation: Accumulation::F32, ..paper() };
        let exact = value(&Options { factor: Factor::Attenuation, ..whole });
        let left = value(&whole) / exact;
        let (a2, s2) = (f64::from(a * a), f64::from(half * half));
        let formula = a2 / (a2 + 0.5 * s2);
        println!("s/a {nearness}: {left:.4} of the light is left, formula {formula:.4}");
        assert!((left - formula).abs() < 0.01, "{left} {formula}");
    }
}

/// The sun in the back of an eye that looks along −z.
fn sun_behind() -> Light {
    Light::Directional(DirectionalLight { direction: Vec3::NEG_Z, irradiance: Vec3::ONE })
}

/// A horizontal ceiling with a slit of `width` along the view, the sun above, a wall behind.
fn slit(width: f32, at: f32) -> Scene {
    let mut scene = Scene::empty("slit");
    scene.objects = vec![
        cuboid(Vec3::new(-8.0, 4.0, -12.0), Vec3::new(at, 4.3, 2.0)),
        cuboid(Vec3::new(at + width, 4.0, -12.0), Vec3::new(8.0, 4.3, 2.0)),
        cuboid(Vec3::new(-8.0, -8.0, -12.5), Vec3::new(8.0, 8.0, -12.0)),
    ];
    scene.lights = vec![Light::Directional(DirectionalLight {
        direction: Vec3::new(0.0, -1.0, -0.02).normalize(),
        irradiance: Vec3::ONE,
    })];
    scene.medium = Medium::grey(0.05, 1.0, Phase::isotropic());
    scene.camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov_y: 0.8 };
    scene
}

fn total(image: &Image) -> f64 {
    image.pixels.iter().map(|p| f64::from(p.x)).sum()
}

#[test]
fn shadows_at_lattice_points_miss_narrow_shafts() {
    let ratios = |width: f32, options: &Options| -> Vec<f64> {
        // The shaft at several places relative to the lattice.
        let at = [-0.31, -0.12, 0.09, 0.22];
        at.iter()
            .map(|&at| {
                let scene = slit(width, at);
                let view = scene.camera.view(96, 64);
                total(&draw(&scene, &view, options, 2048).unwrap()) / total(&reference(&scene, &view))
            })
            .collect()
    };
    // Cells are 1.4 m across on the farthest plane and smaller in front.
    let per_point = Options { visibility: Visibility::PerLatticePoint, lattice: [12, 9], ..paper() };
    let worst = |ratios: &[f64]| ratios.iter().map(|ratio| (ratio - 1.0).abs()).fold(0.0, f64::max);
    let narrow = ratios(0.1, &per_point);
    let wide = ratios(2.0, &per_point);
    let fragment = ratios(0.1, &paper());
    println!("per lattice point: {narrow:.2?} at 0.1 m, {wide:.2?} at 2 m; per fragment {fragment:.2?}");
    assert!(worst(&narrow) > 0.2, "what this test is about");
    assert!(worst(&wide) < 0.1, "{wide:?}");
    // Planes are 0.12 m apart.
    assert!(worst(&fragment) < 0.1, "{fragment:?}");
    let default = ratios(0.1, &best());
    assert!(worst(&default) < 0.1, "{default:?}");
}

/// Exponent of `error ∝ planes^e`, by least squares.
fn order(planes: &[u32], errors: &[f64]) -> f64 {
    let (x, y): (Vec<f64>, Vec<f64>) =
        planes.iter().zip(errors).map(|(&n, &e)| (f64::from(n).ln(), e.ln())).unzip();
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (mx, my) = (mean(&x), mean(&y));
    let above: f64 = x.iter().zip(&y).map(|(x, y)| (x - mx) * (y - my)).sum();
    above / x.iter().map(|x| (x - mx).powi(2)).sum::<f64>()
}

#[test]
fn errors_fall_with_planes_by_one_order_at_edges_and_two_where_it_is_smooth() {
    let mut scene = boxes(sun(), 0.2);
    scene.objects.push(cuboid(Vec3::new(-20.0, -12.0, -7.0), Vec3::new(20.0, 14.0, -6.5)));
    let mut open = scene.clone();
    open.objects.drain(..4);
    open.lights = vec![sun_behind()];
    let planes = [4, 8, 16, 32];
    let of = |scene: &Scene, options: &Options| {
        let view = scene.camera.view(48, 36);
        let truth = reference(scene, &view);
        let error = |&planes: &u32| {
            errors(&draw(scene, &view, &Options { planes, ..*options }, 1024).unwrap(), &truth).0
        };
        planes.iter().map(error).collect::<Vec<f64>>()
    };
    let f32 = Options { accumulation: Accumulation::F32, ..paper() };
    let (edges, smooth) = (of(&scene, &f32), of(&open, &f32));
    println!(
        "edges {edges:.4?} {:.2}, smooth {smooth:.6?} {:.2}",
        order(&planes, &edges),
        order(&planes, &smooth)
    );
    assert!((-1.3..-0.7).contains(&order(&planes, &edges)), "{edges:?}");
    assert!((-2.2..-1.8).contains(&order(&planes, &smooth)), "{smooth:?}");
    let found = of(&scene, &best());
    println!("default {found:.4?}");
    assert!(found[0] < edges[3], "four slabs of the default beat 32 planes: {found:?}");
}

#[test]
fn steps_grow_towards_the_corners_of_a_wide_view() {
    let mut scene = thin_air(Vec3::ZERO);
    scene.lights = vec![sun_behind()];
    scene.objects = vec![cuboid(Vec3::new(-40.0, -40.0, -10.5), Vec3::new(40.0, 40.0, -10.0))];
    scene.camera.fov_y = 1.8;
    let view = scene.camera.view(40, 30);
    let truth = reference(&scene, &view);
    // With the step of the middle everywhere, the corner would get this much.
    let cosine = view.ray_direction(0, 0).dot(Vec3::NEG_Z);
    assert!(cosine < 0.6);
    for options in [Options { accumulation: Accumulation::F32, ..paper() }, best()] {
        let image = draw(&scene, &view, &options, 64).unwrap();
        let off = |i: usize| f64::from(image.pixels[i].x / truth.pixels[i].x - 1.0);
        assert!(off(0).abs() < 3e-3 && off(15 * 40 + 20).abs() < 3e-3, "{} {}", off(0), off(620));
    }
}

#[test]
fn walls_between_planes_make_no_steps() {
    // A wall moves through one spacing: the light in front of it grows by as much as it should.
    for options in [paper(), Options { planes: 20, ..paper() }, best()] {
        let options = Options { accumulation: Accumulation::F32, ..options };
        for step in 0..8 {
            let wall = -9.0 - 0.08 * step as f32;
            let mut scene = thin_air(Vec3::ZERO);
            scene.lights = vec![sun_behind()];
            scene.objects = vec![cuboid(Vec3::new(-40.0, -40.0, wall - 0.5), Vec3::new(40.0, 40.0, wall))];
            let view = scene.camera.view(9, 9);
            let truth = reference(&scene, &view);
            let image = draw_to(&scene, &view, &options, 64, 13.0).unwrap();
            for (a, b) in image.pixels.iter().zip(&truth.pixels) {
                let off = a.x / b.x - 1.0;
                assert!(off.abs() < 2e-3, "wall at {wall}: {off}");
            }
        }
    }
}

#[test]
fn sixteen_bits_lose_more_the_more_planes_there_are() {
    let mut scene = boxes(sun(), 0.2);
    scene.objects.push(cuboid(Vec3::new(-20.0, -12.0, -7.0), Vec3::new(20.0, 14.0, -6.5)));
    let view = scene.camera.view(48, 36);
    let bias = |planes: u32| {
        let wide = Options { planes, accumulation: Accumulation::F32, ..paper() };
        let narrow = Options { accumulation: Accumulation::F16, ..wide };
        total(&draw(&scene, &view, &narrow, 256).unwrap()) / total(&draw(&scene, &view, &wide, 256).unwrap())
            - 1.0
    };
    let (few, many) = (bias(50), bias(800));
    println!("bias of 16 bits: {few:+.4} with 50 planes, {many:+.4} with 800");
    assert!(few.abs() < 0.01 && many.abs() < 0.15, "{few} {many}");
    assert!(many.abs() > 2.0 * few.abs(), "what this test is about: {few} {many}");
}

/// RMS of what the picture changes by from frame to frame less what the reference does, over its mean.
fn flicker(frames: &[(Image, Image)]) -> f64 {
    let mut square = 0.0;
    let mut mean = 0.0;
    let mut count = 0.0;
    for pair in frames.windows(2) {
        let [(image, truth), (next, next_truth)] = pair else { continue };
        for i in 0..image.pixels.len() {
            let off = (next.pixels[i] - image.pixels[i]) - (next_truth.pixels[i] - truth.pixels[i]);
            square += f64::from(off.length_squared()) / 3.0;
            mean += f64::from(truth.pixels[i].element_sum()) / 3.0;
            count += 1.0;
        }
    }
    (square / count).sqrt() / (mean / count)
}

#[test]
fn a_moving_eye_makes_planes_swim_but_not_the_default_s() {
    let mut scene = boxes(spot(0.5, 0.5), 0.1);
    scene.objects.push(cuboid(Vec3::new(-20.0, -12.0, -7.0), Vec3::new(20.0, 14.0, -6.5)));
    let measure = |options: &Options| {
        let frame = |i: i32| {
            let mut scene = scene.clone();
            // An eighth of the distance between 24 planes.
            let moved = Vec3::new(0.0, 0.0, -0.07 * i as f32);
            scene.camera.eye += moved;
            scene.camera.target += moved;
            let view = scene.camera.view(48, 36);
            (draw(&scene, &view, options, 512).unwrap(), reference(&scene, &view))
        };
        flicker(&(0..4).map(frame).collect::<Vec<_>>())
    };
    let planes = measure(&Options { planes: 24, ..paper() });
    let default = measure(&best());
    println!("flicker: {planes:.4} with 24 of the paper's planes, {default:.4} by default");
    assert!(default < 0.01 && default < 0.25 * planes, "{planes} {default}");
}

#[test]
fn peaked_phase_functions_keep_their_peaks() {
    // The light ahead: the peak is as narrow as a step of the angle at the light.
    for (g, bound) in [(0.7, 0.002), (0.95, 0.01), (-0.95, 0.002)] {
        let mut scene = boxes(spot(0.6, 0.6), 0.1);
        scene.medium.phase = Lobe::HenyeyGreenstein { g }.into();
        let light = scene.lights[0].position().unwrap();
        scene.camera.eye = light + 2.5 * Vec3::new(0.62, -0.7, -0.2).normalize() + Vec3::new(0.3, 0.4, 0.1);
        scene.camera.target = light;
        let view = scene.camera.view(48, 36);
        let truth = reference(&scene, &view);
        let error = |options: &Options| errors(&draw(&scene, &view, options, 256).unwrap(), &truth).0;
        let (found, coarse) = (error(&best()), error(&Options { phase_texels: 16, ..best() }));
        let many = error(&Options { planes: 64, ..best() });
        println!("g {g}: {found:.5}, with 64 planes {many:.5}, with a texture of 16 texels {coarse:.3}");
        assert!(found < bound && many < 0.25 * bound, "g {g}: {found} {many}");
        assert!(coarse > 2.0 * found, "what this test is about");
    }
}

#[test]
fn lights_anywhere_leave_no_pixel_broken() {
    let at = |depth: f32, x: f32| Vec3::new(x, 0.0, -depth);
    let all = [best(), paper(), Options { factor: Factor::Attenuation, ..paper() }, Options::default()];
    let per_point =
        Options { visibility: Visibility::PerLatticePoint, lattice: [3, 3], planes: 10, ..paper() };
    let all = all.into_iter().chain([per_point, Options { lattice: [3, 3], planes: 10, ..paper() }]);
    for (turn, options) in all.enumerate() {
        // Planes are at whole half metres for ten planes up to ten metres; 9 × 9 pixels have one straight ahead.
        for (place, position) in [
            at(5.5, 0.0),
            at(5.0, 0.0),
            at(5.2, 0.01),
            at(-2.0, 0.0),
            at(0.0, 0.0),
            at(1e-4, 0.0),
            at(10.0, 1.0),
        ]
        .into_iter()
        .enumerate()
        {
            // Points and spots by turns: each set of options meets both, and both are in each place.
            let light = if (turn + place) % 2 == 0 {
                Light::Point(PointLight { position, intensity: Vec3::splat(100.0) })
            } else {
                Light::Spot(SpotLight {
                    position,
                    direction: Vec3::Z,
                    up: Vec3::Y,
                    intensity: Vec3::splat(100.0),
                    inner_angle: 0.2,
                    outer_angle: 0.7,
                    light_map: None,
                })
            };
            let mut scene = thin_air(position);
            scene.medium = Medium::grey(0.1, 0.9, Phase::isotropic());
            scene.objects = vec![cuboid(Vec3::new(-9.0, -9.0, -10.5), Vec3::new(9.0, 9.0, -10.0))];
            scene.lights = vec![light];
            let view = scene.camera.view(9, 9);
            let image = draw_to(&scene, &view, &options, 16, 10.0).unwrap();
            assert_sane(&image, &format!("light at {position}"));
            assert!(image.pixels.iter().all(|p| p.min_element() >= 0.0));
        }
    }
}

#[test]
fn early_end_and_lattice_change_cost_alone() {
    let scene = boxes(spot(0.5, 0.6), 0.1);
    let view = scene.camera.view(64, 48);
    let truth = draw(&scene, &view, &best(), 128).unwrap();
    for options in [Options { early_end: false, ..best() }, Options { lattice: [33, 17], ..best() }] {
        let (rms, worst) = errors(&draw(&scene, &view, &options, 128).unwrap(), &truth);
        assert!(rms < 1e-5 && worst < 1e-3, "{options:?}: {rms} {worst}");
    }
}

#[test]
fn offsets_turn_bands_into_noise_without_bias() {
    // Few planes and no halving: what offsets are for.
    let mut scene = boxes(spot(0.5, 0.5), 0.1);
    scene.objects.push(cuboid(Vec3::new(-20.0, -12.0, -7.0), Vec3::new(20.0, 14.0, -6.5)));
    let view = scene.camera.view(96, 72);
    let truth = reference(&scene, &view);
    let coarse = Options { planes: 8, visibility: Visibility::PerFragment { samples: 1 }, ..best() };
    // Bands are errors that neighbours share; noise is not.
    let shared = |offset: bool| {
        let image = draw(&scene, &view, &Options { offset, ..coarse }, 512).unwrap();
        let off = |i: usize| f64::from(image.pixels[i].x - truth.pixels[i].x);
        let width = view.width as usize;
        let pairs = (0..off_count(&view)).filter(|i| i % width + 1 < width);
        let (mut product, mut square) = (0.0, 0.0);
        for i in pairs {
            product += off(i) * off(i + 1);
            square += off(i) * off(i);
        }
        (product / square, common::metrics::compare(&image, &truth).unwrap())
    };
    let ((bands, without), (noise, with)) = (shared(false), shared(true));
    println!(
        "shared by neighbours: {bands:.2} without offset, {noise:.2} with; rms {:.4}, {:.4}; bias {:+.4}, {:+.4}",
        without.rel_rmse, with.rel_rmse, without.bias, with.bias
    );
    assert!(noise < 0.5 * bands, "{noise} {bands}");
    assert!(with.rel_rmse < 1.5 * without.rel_rmse && with.bias.abs() < 0.02);
}

fn off_count(view: &View) -> usize {
    (view.width * view.height) as usize
}

#[test]
fn far_views_need_planes_where_light_comes_from() {
    // A kilometre of fog of which the eye sees a few tens of metres.
    let mut scene = slit(4.0, -2.0);
    scene.objects.push(cuboid(Vec3::new(-900.0, -900.0, -1000.0), Vec3::new(900.0, 900.0, -999.0)));
    scene.objects.remove(2);
    scene.medium = Medium::grey(0.05, 1.0, Phase::isotropic());
    let view = scene.camera.view(48, 36);
    let truth = reference(&scene, &view);
    let error = |placement| {
        let options = Options { placement, planes: 50, accumulation: Accumulation::F32, ..paper() };
        errors(&draw_to(&scene, &view, &options, 2048, 1000.0).unwrap(), &truth).0
    };
    let (even, transmittance, integrand) =
        (error(Placement::Even), error(Placement::Transmittance), error(Placement::Integrand));
    println!(
        "50 planes over a kilometre: even {even:.4}, transmittance {transmittance:.4}, integrand {integrand:.4}"
    );
    assert!(transmittance < 0.5 * even && integrand < 0.5 * even);
}

#[test]
fn many_lights_and_a_single_pixel() {
    let mut scene = boxes(point(), 0.1);
    let light = |i: usize| {
        let position =
            Vec3::new((i % 8) as f32 - 3.5, 2.5 + 0.1 * (i / 8) as f32, 0.3 * (i / 8) as f32 - 1.0);
        Light::Point(PointLight { position, intensity: Vec3::splat(0.2) })
    };
    scene.lights = (0..64).map(light).collect();
    let view = scene.camera.view(16, 12);
    let image = draw(&scene, &view, &best(), 64).unwrap();
    assert_sane(&image, "64 lights");
    let (rms, _) = errors(&image, &reference(&scene, &view));
    println!("64 lights: {rms:.5}");
    assert!(rms < 0.02, "{rms}");
    let one = scene.camera.view(1, 1);
    let (rms, _) = errors(&draw(&scene, &one, &best(), 64).unwrap(), &reference(&scene, &one));
    assert!(rms < 0.02, "{rms}");
    let limit = common::gpu::bench::context().device.limits().max_texture_dimension_2d;
    assert!(
        common::gpu::Accumulator::check_size(&common::gpu::bench::context().device, (limit + 1, 1)).is_err()
    );
}

#[test]
fn coarse_maps_cost_accuracy_and_nothing_else() {
    let scene = boxes(spot(0.5, 0.5), 0.1);
    let view = scene.camera.view(64, 48);
    let truth = reference(&scene, &view);
    let by_depth_map =
        [32, 128, 512].map(|size| errors(&draw(&scene, &view, &best(), size).unwrap(), &truth).0);
    // Light maps of fewer texels against the picture that they are made from.
    let glass = |size: u32| common::scene::builtin::window_with_map(1_000, size);
    let fine = glass(512);
    let view = fine.camera.view(64, 52);
    let truth = reference(&fine, &view);
    let by_light_map =
        [16, 64, 256].map(|size| errors(&draw(&glass(size), &view, &best(), 1024).unwrap(), &truth).0);
    println!("depth maps of 32, 128, 512: {by_depth_map:.4?}; light maps of 16, 64, 256: {by_light_map:.4?}");
    for errors in [by_depth_map, by_light_map] {
        assert!(errors[1] < 0.7 * errors[0] && errors[2] < 0.7 * errors[1], "{errors:?}");
    }
}
