//! Small renders against the CPU reference and against known answers.

mod support;

use biri_ss::table::lambert;
use biri_ss::{Accumulation, Airlight, Counting, Error, Indirect, Options, Order};
use common::gpu::{TableFormat, TargetError};
use common::reference::Reference;
use common::{Camera, Light, LightMap, Lobe, Medium, Phase, PointLight, Scene, Term};
use glam::{Affine3A, DVec3, Vec3};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use support::{
    Drawer, airlight, assert_sane, best, boxes, cuboid, draw, errors, errors_off_edges, point, reference,
    spot, sun,
};

#[test]
fn shaders_are_valid_without_optional_features() {
    use biri_ss::shaders;
    for source in [shaders::planes(), shaders::surfaces()] {
        common::gpu::bench::validate_wgsl(&source).unwrap();
        assert_eq!(common::gpu::bench::uniform_branches(&source).unwrap(), [""; 0]);
    }
}

#[test]
fn boxes_are_drawn_as_by_the_reference() {
    for (name, light) in
        [("point", point()), ("spot", spot(0.6, 0.6)), ("soft spot", spot(0.3, 0.6)), ("sun", sun())]
    {
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(160, 120);
        let truth = reference(&scene, &view);
        let pictures = draw(&scene, &view, &best()).unwrap();
        assert_sane(&pictures.airlight, name);
        let (rms, worst) = errors(&pictures.airlight, &truth);
        let (edges, elsewhere) = errors_off_edges(&pictures.airlight, &truth);
        println!(
            "{name}: {rms:.2e} rms, {worst:.2e} worst, {edges} pixels at edges, {elsewhere:.2e} elsewhere"
        );
        assert!(edges < 5 && elsewhere < 3e-4, "{name}: {edges} {elsewhere}");
        // The comparison can fail: the same scene without one of its boxes.
        let mut open = scene.clone();
        open.objects.remove(3);
        assert!(errors(&airlight(&open, &view, &best()), &truth).0 > 0.01, "{name}");
        // Surfaces: exact shadows on them, too.
        let judge = Reference::new(&scene).unwrap();
        let lit = judge.render(&view, Term::Surface.into(), &|_| {}, &AtomicBool::new(false)).unwrap();
        let (edges, elsewhere) = errors_off_edges(&pictures.surfaces, &lit.surface.unwrap());
        println!("{name}: surfaces: {edges} pixels at edges, {elsewhere:.2e} elsewhere");
        assert!(edges < 12 && elsewhere < 3e-3, "{name}: surfaces {edges} {elsewhere}");
    }
}

#[test]
fn counting_from_either_end_is_the_same() {
    for light in [point(), spot(0.6, 0.6), sun()] {
        let mut scene = boxes(light, 0.2);
        scene.objects.push(cuboid(Vec3::new(-0.2, 2.2, 0.0), Vec3::new(0.9, 2.3, 0.8)));
        // Seen from the light, from a shadow, and past a box that a light grazes.
        for eye in [Vec3::new(0.4, 1.6, 6.3), Vec3::new(-2.0, 0.8, -0.3), Vec3::new(-0.7, 0.3, 2.0)] {
            scene.camera.eye = eye;
            let view = scene.camera.view(120, 90);
            let from_eye = draw(&scene, &view, &best()).unwrap();
            let depth_fail = draw(
                &scene,
                &view,
                &Options { counting: Counting::DepthFail, shared_beginning: false, ..best() },
            )
            .unwrap();
            let kind = scene.lights[0].kind();
            for (a, b, what) in [
                (&depth_fail.airlight, &from_eye.airlight, "airlight"),
                (&depth_fail.surfaces, &from_eye.surfaces, "surfaces"),
            ] {
                let (edges, elsewhere) = errors_off_edges(a, b);
                assert!(edges < 6 && elsewhere < 1e-4, "{kind} from {eye}: {what} {edges} {elsewhere}");
            }
        }
    }
}

#[test]
fn airlight_by_table_and_by_quadrature_is_the_integral() {
    let (width, height, format) = (256, 512, TableFormat::F32);
    let forms = [
        ("Γ", Airlight::Gamma { width, height, format }, false),
        ("its rest", Airlight::GammaRest { width, height, format }, false),
        ("its rest, beginnings shared", Airlight::GammaRest { width, height, format }, true),
        ("quadrature", Airlight::Quadrature { panels: 1 }, false),
    ];
    let bound = 1e-3;
    let g = 0.6;
    for (lobe, light) in [
        (Lobe::Isotropic, point()),
        (Lobe::MieHazy, spot(0.5, 0.5)),
        (Lobe::HenyeyGreenstein { g }, point()),
        (Lobe::HenyeyGreenstein { g }, spot(0.5, 0.5)),
    ] {
        let mut scene = boxes(light, 0.1);
        scene.medium = Medium {
            sigma_s: Vec3::new(0.05, 0.1, 0.2),
            sigma_a: Vec3::new(0.01, 0.05, 0.0),
            phase: lobe.into(),
        };
        let view = scene.camera.view(96, 72);
        let truth = reference(&scene, &view);
        for (name, airlight, shared_beginning) in forms {
            let options = Options { airlight, shared_beginning, ..best() };
            let found = support::airlight(&scene, &view, &options);
            let (edges, elsewhere) = errors_off_edges(&found, &truth);
            println!("{lobe:?} {}: {name} {edges} {elsewhere:.2e}", scene.lights[0].kind());
            assert!(edges < 12 && elsewhere < bound, "{lobe:?} {name}: {edges} {elsewhere}");
        }
    }
}

#[test]
fn the_paper_is_right_where_its_order_is() {
    // One box: no planes that cross. What is left is the table and 16 bits.
    let mut scene = boxes(point(), 0.1);
    scene.objects.truncate(2);
    let view = scene.camera.view(96, 72);
    let truth = reference(&scene, &view);
    let format = common::gpu::bench::context().radiance_format();
    let (edges, elsewhere) = errors_off_edges(&airlight(&scene, &view, &Options::paper(format)), &truth);
    assert!(edges < 6 && elsewhere < 4e-3, "{edges} {elsewhere}");
    // With more of them it is not, and the exact order is what mends it.
    let scene = common::scene::builtin::build("cathedral", Some(6_000)).unwrap();
    let view = scene.camera.view(96, 72);
    let truth = reference(&scene, &view);
    let of = |options: Options| errors(&airlight(&scene, &view, &options), &truth).0;
    let paper = of(Options::paper(format));
    let ordered = of(Options { order: Order::Exact, ..Options::paper(format) });
    let sum = Accumulation::F32;
    let wide = of(Options { order: Order::Exact, accumulation: sum, ..Options::paper(format) });
    println!("cathedral: paper {paper:.2e}, in order {ordered:.2e}, and in 32 bits {wide:.2e}");
    assert!(paper > 0.3 && ordered < 0.15 && wide < 5e-3, "{paper} {ordered} {wide}");
    assert!(of(best()) < 5e-3);
}

#[test]
fn the_eye_may_be_anywhere() {
    let scene = boxes(point(), 0.1);
    let light = scene.lights[0].position().unwrap();
    for (name, eye) in [
        ("in light", Vec3::new(1.5, 1.5, 2.0)),
        ("in shadow", Vec3::new(-2.0, 0.8, -0.3)),
        ("behind the light", light + Vec3::new(0.3, 1.0, -2.0)),
        ("near the light", light + Vec3::new(0.01, 0.013, 0.02)),
        ("outside the scene", Vec3::new(30.0, 20.0, 45.0)),
        // On a shadow plane: over the edge x = 0.3, z = 0.5 of a box, as the light sees it, to a rounding.
        ("on a plane", light + 1.4 * (Vec3::new(0.3, 1.4, 0.5) - light)),
    ] {
        let mut scene = scene.clone();
        scene.camera = Camera { eye, target: Vec3::new(0.1, 0.9, 0.2), up: Vec3::Y, fov_y: 1.0 };
        let view = scene.camera.view(96, 72);
        let (found, truth) = (airlight(&scene, &view, &best()), reference(&scene, &view));
        assert_sane(&found, name);
        let (edges, elsewhere) = errors_off_edges(&found, &truth);
        println!("{name}: {edges} {elsewhere:.2e}");
        assert!(edges < 6 && elsewhere < 1e-3, "{name}: {edges} {elsewhere}");
    }
}

#[test]
fn eye_light_and_edges_in_one_plane() {
    // Everything at x = 0: shadow planes are seen edge-on, and the eye is in them.
    let mut scene = boxes(point(), 0.1);
    scene.objects.truncate(1);
    scene.objects.push(cuboid(Vec3::new(0.0, 1.0, -0.5), Vec3::new(0.8, 1.6, 0.5)));
    scene.lights =
        vec![Light::Point(PointLight { position: Vec3::new(0.0, 3.0, -1.0), intensity: Vec3::ONE })];
    for eye in [Vec3::new(0.0, 0.7, 0.6), Vec3::new(0.0, 0.2, 6.0), Vec3::new(0.0, 4.0, 3.0)] {
        scene.camera = Camera { eye, target: Vec3::new(0.0, 1.0, -3.0), up: Vec3::Y, fov_y: 1.2 };
        let view = scene.camera.view(97, 71);
        let (found, truth) = (airlight(&scene, &view, &best()), reference(&scene, &view));
        let mut differs = 0;
        for (i, (a, b)) in found.pixels.iter().zip(&truth.pixels).enumerate() {
            // The middle column looks along the plane itself: either answer will do.
            if i % 97 != 48 && (*a - *b).abs().max_element() > 0.01 * b.max_element().max(1e-4) {
                differs += 1;
            }
        }
        assert!(differs < 8, "from {eye}: {differs} pixels differ");
    }
}

#[test]
fn broken_meshes_cast_exact_shadows() {
    // Open, single-sided, flipped, doubled: whatever it is, the picture is that of its triangles.
    let mut scene = boxes(point(), 0.1);
    let change = |f: &dyn Fn(&mut common::scene::Mesh)| {
        let mut mesh = common::scene::builtin::solids::torus(0.8, 0.3, 16, 8);
        f(&mut mesh);
        let mut torus = support::object(mesh);
        torus.world_from_object =
            Affine3A::from_translation(Vec3::new(0.2, 1.5, 0.3)) * Affine3A::from_rotation_x(0.7);
        torus
    };
    scene.objects.truncate(1);
    for (name, torus) in [
        ("open", change(&|mesh| mesh.triangles.truncate(150))),
        ("flipped", change(&|mesh| mesh.triangles.iter_mut().step_by(3).for_each(|t| t.swap(0, 1)))),
        ("inside out", change(&|mesh| mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1)))),
        ("doubled", change(&|mesh| mesh.triangles.extend(mesh.triangles[..80].to_vec()))),
        ("soup", change(&|mesh| mesh.triangles.retain(|t| t[0] % 3 != 1))),
    ] {
        let mut scene = scene.clone();
        scene.objects.push(torus);
        let view = scene.camera.view(120, 90);
        let pictures = draw(&scene, &view, &best()).unwrap();
        assert_sane(&pictures.airlight, name);
        let (edges, elsewhere) = errors_off_edges(&pictures.airlight, &reference(&scene, &view));
        println!("{name}: {edges} {elsewhere:.2e}");
        assert!(edges < 8 && elsewhere < 1e-3, "{name}: {edges} {elsewhere}");
        // What the paper's counting makes of the same.
        let other = draw(
            &scene,
            &view,
            &Options { counting: Counting::DepthFail, shared_beginning: false, ..best() },
        )
        .unwrap();
        let (edges, elsewhere) = errors_off_edges(&other.airlight, &pictures.airlight);
        assert!(edges < 12 && elsewhere < 1e-3, "{name}, depth-fail: {edges} {elsewhere}");
    }
}

#[test]
fn a_sealed_room_is_dark_and_its_surfaces_too() {
    let room = common::scene::builtin::build("sealed-room", None).unwrap();
    let open = common::scene::builtin::build("open-room", None).unwrap();
    let view = room.camera.view(96, 72);
    let sum = |image: &common::image::Image| -> f64 {
        image.pixels.iter().map(|p| p.as_dvec3().element_sum()).sum()
    };
    let (dark, light) = (draw(&room, &view, &best()).unwrap(), draw(&open, &view, &best()).unwrap());
    for (dark, light) in [(&dark.airlight, &light.airlight), (&dark.surfaces, &light.surfaces)] {
        assert!(sum(dark) <= 1e-5 * sum(light), "{} of {}", sum(dark), sum(light));
    }
}

#[test]
fn indirect_light_is_the_tables_own_integral() {
    // A floor and one light: every pixel from the f64 function, at its own distance and angle.
    let mut scene = boxes(point(), 0.25);
    scene.objects.truncate(1);
    scene.materials = vec![common::scene::Material { k_d: Vec3::new(0.8, 0.5, 0.2), ..Default::default() }];
    scene.medium = Medium {
        sigma_s: Vec3::new(0.1, 0.2, 0.4),
        sigma_a: Vec3::new(0.05, 0.0, 0.1),
        phase: Lobe::HenyeyGreenstein { g: 0.4 }.into(),
    };
    let view = scene.camera.view(40, 30);
    for (clamped, indirect) in [(true, Indirect::Clamped), (false, Indirect::Unclamped)] {
        let found = draw(&scene, &view, &Options { indirect, ..best() }).unwrap().indirect;
        let light = scene.lights[0].position().unwrap().as_dvec3();
        let (eye, mut checked) = (view.camera.eye.as_dvec3(), 0);
        for (x, y) in (20..30).flat_map(|y| (y % 3..40).step_by(3).map(move |x| (x, y))) {
            let direction = view.ray_direction(x, y).as_dvec3();
            let distance = -eye.y / direction.y;
            let at = eye + distance * direction;
            if direction.y >= 0.0 || at.x.abs() > 5.9 || at.z.abs() > 5.9 {
                continue;
            }
            let l = at.distance(light);
            let expected = DVec3::from_array([0, 1, 2].map(|c| {
                let sigma_t = f64::from(scene.medium.sigma_t()[c]);
                let e = f64::from(scene.lights[0].strength()[c] * scene.medium.sigma_s[c])
                    / (4.0 * std::f64::consts::PI * l)
                    * (-sigma_t * l).exp()
                    * lambert(Lobe::HenyeyGreenstein { g: 0.4 }, sigma_t * l, light.y / l, clamped);
                f64::from(scene.materials[0].k_d[c]) / std::f64::consts::PI * e * (-sigma_t * distance).exp()
            }));
            let got = found.pixels[(y * 40 + x) as usize].as_dvec3();
            assert!(((got - expected) / expected).abs().max_element() < 3e-3, "{x} {y}: {got}, {expected}");
            checked += 1;
        }
        assert!(checked > 70);
    }
}

#[test]
fn a_white_furnace_stays_white() {
    // (1) put right: air and surfaces that all send L_a look like L_a at any depth of the medium.
    let mut scene = boxes(sun(), 0.3);
    scene.materials = vec![common::scene::Material { k_d: Vec3::ONE, ..Default::default() }];
    // The sun is at no distance that counts, so that surfaces get all of the ambient radiance.
    scene.lights = vec![match sun() {
        Light::Directional(sun) => {
            Light::Directional(common::DirectionalLight { irradiance: Vec3::ZERO, ..sun })
        }
        other => other,
    }];
    let ambient = Vec3::new(0.3, 0.5, 0.7);
    for sigma_t in [1e-3, 0.1, 3.0] {
        scene.medium = Medium::grey(sigma_t, 0.5, Phase::isotropic());
        let view = scene.camera.view(40, 30);
        let pictures = Drawer::new(&best()).draw(&scene, &view, ambient).unwrap();
        for (air, surface) in pictures.airlight.pixels.iter().zip(&pictures.surfaces.pixels) {
            let total = *air + *surface;
            let sky = *surface == Vec3::ZERO;
            assert!(sky || (total / ambient - 1.0).abs().max_element() < 1e-3, "σ_t {sigma_t}: {total}");
        }
        // Printed, the air's part falls with the depth instead.
        assert!(pictures.airlight.pixels[0].x > 0.0);
    }
}

#[test]
fn nothing_moves_between_two_frames_of_one_scene() {
    let scene = boxes(point(), 0.1);
    let view = scene.camera.view(80, 60);
    let mut drawer = Drawer::new(&best());
    let bits = |image: &common::image::Image| -> Vec<[u32; 3]> {
        image.pixels.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
    };
    let first = drawer.draw(&scene, &view, Vec3::ZERO).unwrap();
    // Other scenes, other sizes and none in between leave nothing behind.
    let mut other = boxes(sun(), 0.2);
    other.objects.truncate(2);
    other.lights.push(point());
    drawer.draw(&other, &other.camera.view(1, 1), Vec3::ONE).unwrap();
    drawer.draw(&Scene::empty("empty"), &view, Vec3::ZERO).unwrap();
    let again = drawer.draw(&scene, &view, Vec3::ZERO).unwrap();
    assert_eq!(bits(&first.airlight), bits(&again.airlight));
    assert_eq!(bits(&first.surfaces), bits(&again.surfaces));
    assert_eq!(first.statistics, again.statistics);
}

#[test]
fn little_or_nothing_is_no_trouble() {
    let black = |scene: &Scene| {
        let pictures = draw(scene, &scene.camera.view(8, 6), &best()).unwrap();
        pictures.airlight.pixels.iter().all(|p| *p == Vec3::ZERO)
    };
    assert!(black(&Scene::empty("empty")));
    let mut scene = boxes(point(), 0.1);
    scene.medium = Medium::vacuum();
    assert!(black(&scene));
    scene.lights.clear();
    assert!(black(&scene));
    // Casters without triangles, and light alone.
    let mut scene = boxes(point(), 0.1);
    scene.objects = vec![support::object(common::scene::Mesh::default())];
    assert!(!black(&scene));
}

#[test]
fn sixteen_lights_and_sixteen_bits() {
    let mut scene = boxes(point(), 0.05);
    scene.lights = (0..16)
        .map(|i| {
            let turn = 0.39 * i as f32;
            let position = Vec3::new(3.1 * turn.cos(), 2.3 + 0.1 * i as f32, 3.3 * turn.sin());
            Light::Point(PointLight { position, intensity: Vec3::splat(0.5 + 0.1 * i as f32) })
        })
        .collect();
    let view = scene.camera.view(80, 60);
    let truth = reference(&scene, &view);
    let (edges, elsewhere) = errors_off_edges(&airlight(&scene, &view, &best()), &truth);
    assert!(edges < 20 && elsewhere < 1e-3, "{edges} {elsewhere}");
    let small = Options {
        target_format: wgpu::TextureFormat::Rgba16Float,
        accumulation: Accumulation::F16,
        ..Options::default()
    };
    let coarse = airlight(&scene, &view, &small);
    assert_sane(&coarse, "16 bits");
    assert!(errors(&coarse, &truth).0 < 0.03, "{}", errors(&coarse, &truth).0);
}

#[test]
fn what_is_not_modelled_is_refused() {
    let view = boxes(point(), 0.1).camera.view(8, 6);
    let refused = |scene: &Scene, options: &Options| {
        let error = draw(scene, &view, options).err().expect("an error");
        assert!(matches!(error, Error::Unsupported { .. }), "{error}");
        error.to_string()
    };
    let Light::Spot(mut light) = spot(0.5, 0.6) else { unreachable!() };
    light.light_map = Some(Arc::new(LightMap { width: 1, height: 1, texels: vec![Vec3::ONE] }));
    let scene = boxes(Light::Spot(light), 0.1);
    assert!(refused(&scene, &best()).contains("light map"));
    assert!(refused(&boxes(spot(1e-3, 1e-3), 0.1), &best()).contains("narrow"));
    let dark = Scene { lights: vec![], ..boxes(point(), 0.1) };
    let error = Drawer::new(&best()).draw(&dark, &view, Vec3::ONE).err().expect("an error");
    assert!(error.to_string().contains("ambient"), "{error}");
    let soft = boxes(spot(0.3, 0.6), 0.1);
    assert!(refused(&soft, &Options::paper(best().target_format)).contains("soft"));
    let mut bad = boxes(point(), 0.1);
    bad.objects[1].world_from_object = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    assert!(refused(&bad, &best()).contains("caster 1"));
    let mut bad = boxes(point(), 0.1);
    bad.lights.push(Light::Point(PointLight { position: Vec3::NAN, intensity: Vec3::ONE }));
    assert!(refused(&bad, &best()).contains("light 1"));
    let mut bad = boxes(point(), 0.1);
    bad.medium.sigma_s.x = -1.0;
    assert!(refused(&bad, &best()).contains("medium"));
    let context = common::gpu::bench::context();
    for options in [
        Options { faintest: 0.5, ..best() },
        Options { airlight: Airlight::Quadrature { panels: 0 }, ..best() },
        Options { airlight: Airlight::Gamma { width: 2, height: 8, format: TableFormat::F32 }, ..best() },
    ] {
        let error =
            biri_ss::Renderer::new(&context.device, &context.queue, &options).err().expect("an error");
        assert!(matches!(error, Error::Option { .. }), "{error}");
    }
    let options = Options { target_format: wgpu::TextureFormat::Rgba8Unorm, ..best() };
    let error = biri_ss::Renderer::new(&context.device, &context.queue, &options).err().expect("an error");
    assert!(matches!(error, Error::Target(TargetError::UnsupportedFormat { .. })), "{error}");
}

#[test]
fn culling_changes_nothing() {
    let scene = common::scene::builtin::build("cathedral", Some(6_000)).unwrap();
    let view = scene.camera.view(64, 48);
    let all = draw(&scene, &view, &Options { cull: false, faintest: 0.0, ..best() }).unwrap();
    let culled = draw(&scene, &view, &best()).unwrap();
    assert!(errors(&culled.airlight, &all.airlight).0 < 1e-6);
    let (drawn, whole) = (culled.statistics.drawn, all.statistics.drawn);
    println!("{drawn} of {whole} planes drawn");
    assert!(drawn < whole * 9 / 10, "{drawn} of {whole}");
    // Thick fog: a far caster out of the light's reach.
    let mut thick = boxes(point(), 2.0);
    thick.objects.push(cuboid(Vec3::new(-1.0, 0.0, -40.0), Vec3::new(1.0, 2.0, -38.0)));
    let view = thick.camera.view(64, 48);
    let all = draw(&thick, &view, &Options { faintest: 0.0, ..best() }).unwrap();
    let near = draw(&thick, &view, &best()).unwrap();
    assert!(near.statistics.silhouette_edges < all.statistics.silhouette_edges);
    assert!(errors(&near.airlight, &all.airlight).0 < 1e-3);
}
