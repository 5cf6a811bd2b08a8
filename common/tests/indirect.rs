//! Indirect single scattering: the integrals of the infinite medium against values of high precision,
//! brute force and closed forms, their tables against them, and the reference's two models against each
//! other.
#![cfg(all(feature = "files", feature = "reference"))]

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use common::airlight::airlight_point;
use common::indirect::{ParallelTable, Table, gloss, irradiance, parallel};
use common::reference::{Error, IndirectModel, Options, Reference, Rendered};
use common::scene::{Material, Mesh, Object};
use common::{Camera, DirectionalLight, Light, Lobe, Medium, Phase, PointLight, Scene, SpotLight, Term};
use glam::{Affine3A, DVec3, Vec3};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    let text = || value.as_str().and_then(|text| text.parse().ok());
    value.as_f64().or_else(text).unwrap_or_else(|| panic!("{value} is no number"))
}

fn cases(file: &str) -> Vec<Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(file);
    let json: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    json["cases"].as_array().unwrap().clone()
}

#[test]
fn golden_irradiance() {
    let cases = cases("iss_lambert.json");
    assert_eq!(cases.len(), 58);
    let mut unlike_net_flux = 0;
    for case in &cases {
        let cos = number(&case["phi_n_deg"]).to_radians().cos();
        let (lam, exact) = (number(&case["lam"]), number(&case["exact_str"]));
        let found = irradiance(Lobe::Isotropic, lam, cos);
        assert!((found / exact - 1.0).abs() < 1e-10, "{case}: {found}");
        unlike_net_flux += usize::from((found / number(&case["unclamped_str"]) - 1.0).abs() > 0.01);
    }
    // The test can fail: the unclamped formula is off in every case.
    assert_eq!(unlike_net_flux, cases.len());
}

#[test]
fn golden_gloss() {
    let cases = cases("iss_phong.json");
    assert_eq!(cases.len(), 97);
    for case in &cases {
        let cos = number(&case["phi_s_deg"]).to_radians().cos();
        let (lam, n, exact) = (number(&case["lam"]), number(&case["n"]), number(&case["exact_str"]));
        let found = gloss(Lobe::Isotropic, n, lam, cos);
        assert!((found / exact - 1.0).abs() < 1e-10, "{case}: {found}");
        assert!((gloss(Lobe::Isotropic, n + 0.5, lam, cos) / exact - 1.0).abs() > 1e-3, "{case}");
    }
}

/// `Γ_n` as it is meant: radiance by [`airlight_point`] times the weight, summed over directions. The
/// golden values are isotropic only; this says which way round the phase function goes.
#[test]
fn other_phase_functions_by_brute_force() {
    let henyey_greenstein = |g: f64| Lobe::HenyeyGreenstein { g };
    for (lobe, turned, n, lam, angle) in [
        (henyey_greenstein(0.6), henyey_greenstein(-0.6), 1.0, 0.5, 0.7_f64),
        (henyey_greenstein(-0.4), henyey_greenstein(0.4), 1.0, 2.0, 2.0),
        (Lobe::MieMurky, Lobe::Isotropic, 3.5, 1.0, 1.2),
        (Lobe::Rayleigh, Lobe::Isotropic, 8.0, 0.1, 0.4),
    ] {
        // Rings about the light, which is 1 m away; midpoints both ways.
        let count = 300;
        let step = PI / f64::from(count);
        let middle = |i: i32| (f64::from(i) + 0.5) * step;
        let ring = |lobe: Lobe, phi: f64| {
            let (sigma_t, sigma_s) = (DVec3::splat(lam), DVec3::splat(4.0 * PI));
            let (t, h) = (phi.cos(), phi.sin());
            let seen = airlight_point(sigma_t, sigma_s, &lobe.into(), t, h, 0.0, f64::INFINITY, 1e-8).x;
            let weight =
                |psi: f64| (angle.cos() * phi.cos() + angle.sin() * phi.sin() * psi.cos()).max(0.0).powf(n);
            seen * phi.sin() * step * 2.0 * step * (0..count).map(|k| weight(middle(k))).sum::<f64>()
        };
        let total = |lobe: Lobe| (0..count).map(|i| ring(lobe, middle(i))).sum::<f64>();
        let found = gloss(lobe, n, lam, angle.cos());
        let error = (found / total(lobe) - 1.0).abs();
        assert!(error < 1e-4, "{lobe:?}, {n}: {error:e}");
        assert!((found / total(turned) - 1.0).abs() > 0.02, "{lobe:?}");
    }
}

#[test]
fn parallel_light_in_closed_form() {
    for i in 0..10 {
        let cos = -1.0 + 2.0 * f64::from(i) / 9.0;
        // Isotropic: the weight alone, 2π/(n + 1) over 4π.
        for n in [0.0, 1.0, 7.0, 12.5, 300.0] {
            let exact = 0.5 / (n + 1.0);
            let found = parallel(Lobe::Isotropic, n, cos);
            assert!((found / exact - 1.0).abs() < 1e-8, "{n}, {cos}: {found}, not {exact}");
        }
        // Rayleigh: the second moment of the clamped cosine, ∫ c (1 + (u·d)²), is π + π/4 (1 + cos²).
        let exact = 3.0 / 16.0 * (1.0 + 0.25 * (1.0 + cos * cos));
        assert!((parallel(Lobe::Rayleigh, 1.0, cos) / exact - 1.0).abs() < 1e-9, "{cos}");
    }
}

#[test]
fn tables_are_what_they_stand_for() {
    let forward = |g: f64| Lobe::HenyeyGreenstein { g };
    for (lobe, n) in [
        (Lobe::Isotropic, 1.0),
        (Lobe::MieMurky, 1.0),
        (forward(0.9), 1.0),
        (forward(-0.5), 1.0),
        (Lobe::Isotropic, 0.5),
        (Lobe::CornetteShanks { g: 0.7 }, 7.5),
        (Lobe::Isotropic, 30.0),
        (forward(0.76), 200.0),
    ] {
        let (table, beside) = (Table::new(lobe, n), ParallelTable::new(lobe, n));
        let mut worst = [0.0_f64; 3];
        for i in 0..40 {
            let angle = PI * (f64::from(i) + 0.37) / 40.0;
            let lam = [3e-5, 0.02, 0.3, 1.1, 4.0, 14.0, 40.0][i as usize % 7];
            let exact = gloss(lobe, n, lam, angle.cos());
            worst[0] = worst[0].max((table.eval(lam, angle) / exact - 1.0).abs());
            worst[1] = worst[1].max((beside.eval(angle) / parallel(lobe, n, angle.cos()) - 1.0).abs());
            worst[2] = worst[2].max((table.eval(lam, angle + 0.01) / exact - 1.0).abs());
        }
        println!("{lobe:?}, {n}: {worst:?}");
        assert!(worst[0] < Table::ERROR && worst[1] < Table::ERROR, "{lobe:?}, {n}: {worst:?}");
        // It can fail: half a degree away it is another value.
        assert!(worst[2] > 100.0 * Table::ERROR, "{lobe:?}, {n}");
    }
    // Beyond all that can be seen it ends quietly.
    let table = Table::new(Lobe::Isotropic, 1.0);
    assert!(table.eval(1e3, 0.1) < 1e-300 && table.eval(f64::INFINITY, 3.0) == 0.0);
    assert!(table.eval(0.0, 0.0).is_finite() && table.eval(0.0, PI).is_finite());
}

fn material(k_d: f32, k_s: f32, exponent: f32) -> Material {
    Material { name: "floor".into(), k_d: Vec3::new(k_d, 0.5 * k_d, k_d), k_s: Vec3::splat(k_s), exponent }
}

/// A huge floor at y = 0, seen from 1 m above it, and a light.
fn floor(light: Light, material: Material) -> Scene {
    let mut scene = Scene::empty("floor");
    let far = 1e4;
    let positions =
        vec![Vec3::new(-far, 0.0, -far), Vec3::new(3.0 * far, 0.0, -far), Vec3::new(-far, 0.0, 3.0 * far)];
    let mesh = Arc::new(Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() });
    scene.objects = vec![Object { name: "floor".into(), mesh, world_from_object: Affine3A::IDENTITY }];
    scene.materials = vec![material];
    scene.lights = vec![light];
    scene.medium = Medium {
        sigma_s: Vec3::new(0.25, 0.5, 1.0),
        sigma_a: Vec3::new(0.125, 0.0, 0.5),
        phase: Lobe::HenyeyGreenstein { g: 0.3 }.into(),
    };
    scene.camera =
        Camera { eye: Vec3::new(0.0, 1.0, 0.0), target: Vec3::new(1.0, 0.4, 0.0), up: Vec3::Y, fov_y: 0.6 };
    scene
}

fn lamp(position: Vec3) -> Light {
    Light::Point(PointLight { position, intensity: Vec3::new(10.0, 20.0, 30.0) })
}

fn sun() -> Light {
    let direction = Vec3::new(0.6, -0.8, 0.0);
    Light::Directional(DirectionalLight { direction, irradiance: Vec3::new(1.0, 2.0, 3.0) })
}

fn render(scene: &Scene, indirect: IndirectModel, seed: u64) -> Rendered {
    render_at((8, 6), scene, indirect, seed)
}

fn render_at(size: (u32, u32), scene: &Scene, indirect: IndirectModel, seed: u64) -> Rendered {
    let options = Options { indirect, seed, ..Options::default() };
    let reference = Reference::with_options(scene, options).unwrap();
    let view = scene.camera.view(size.0, size.1);
    reference.render(&view, Term::IndirectAirlight.into(), &|_| {}, &AtomicBool::new(false)).unwrap()
}

const EXACT: IndirectModel = IndirectModel::Exact { directions: 512 };

/// RMS difference relative to the mean, and the mean.
fn apart(a: &Rendered, b: &Rendered) -> (f64, f64) {
    let (a, b) = (a.total(), b.total());
    let count = a.pixels.len() as f64;
    let squares: f64 =
        a.pixels.iter().zip(&b.pixels).map(|(a, b)| (*a - *b).as_dvec3().length_squared()).sum();
    let mean = b.pixels.iter().map(|b| b.as_dvec3().element_sum()).sum::<f64>() / (3.0 * count);
    ((squares / (3.0 * count)).sqrt() / mean, mean)
}

/// Above a floor without end nothing hides anything, and what is below it lights nothing: both models
/// are the same.
#[test]
fn above_a_floor_both_models_agree() {
    let matte = material(0.8, 0.0, 1.0);
    // The lobe about the mirrored direction is narrow and points up, so that all of it is above the
    // floor and has about the same cosine; what is left falls with the exponent.
    let steep = |mut scene: Scene| {
        scene.camera.target = Vec3::new(0.3, 0.0, 0.0);
        scene
    };
    let shiny = material(0.0, 0.5, 800.0);
    for (name, directions, bound, scene) in [
        ("lamp", 512, 0.01, floor(lamp(Vec3::new(1.5, 0.8, 0.2)), matte.clone())),
        ("sun", 512, 0.001, floor(sun(), matte.clone())),
        ("shiny sun", 512, 0.005, steep(floor(sun(), shiny.clone()))),
        ("shiny lamp", 4096, 0.02, steep(floor(lamp(Vec3::new(1.3, 1.2, 0.5)), shiny))),
    ] {
        let draw = |scene: &Scene, model| render_at((4, 3), scene, model, 0);
        let exact = draw(&scene, IndirectModel::Exact { directions });
        let unbounded = draw(&scene, IndirectModel::Unbounded);
        let (difference, mean) = apart(&exact, &unbounded);
        println!("{name}: {difference:.4}, uncertain by {:.4}", exact.indirect_uncertainty);
        assert!(mean > 1e-4 && difference < bound, "{name}: {difference}, mean {mean}");
        assert_eq!(unbounded.indirect_uncertainty, Table::ERROR);
        // It can fail: with another phase function they are apart.
        let other = Scene { medium: Medium { phase: Phase::isotropic(), ..scene.medium.clone() }, ..scene };
        let (difference, _) = apart(&exact, &draw(&other, IndirectModel::Unbounded));
        assert!(difference > 2.0 * bound, "{name}: {difference}");
    }
}

#[test]
fn sunlight_on_a_floor_in_closed_form() {
    let mut scene = floor(sun(), material(0.8, 0.0, 1.0));
    scene.medium.phase = Phase::isotropic();
    let found = render(&scene, IndirectModel::Unbounded, 0).total();
    let view = scene.camera.view(8, 6);
    let (sigma_t, sigma_s) = (scene.medium.sigma_t().as_dvec3(), scene.medium.sigma_s.as_dvec3());
    for (i, pixel) in found.pixels.iter().enumerate() {
        let down = -f64::from(view.ray_direction(i as u32 % 8, i as u32 / 8).y);
        assert!(down > 0.0, "every pixel sees the floor");
        let received = DVec3::new(1.0, 2.0, 3.0) * sigma_s / sigma_t * 0.25;
        let expected = DVec3::new(0.8, 0.4, 0.8) / PI * received * (-sigma_t / down).exp();
        let error = (pixel.as_dvec3() / expected - 1.0).abs().max_element();
        assert!(error < 2e-5, "{pixel}, not {expected}: {error:e}");
    }
}

#[test]
fn twice_the_light_or_the_reflectance_is_twice_as_bright() {
    let scene = floor(lamp(Vec3::new(1.5, 0.8, 0.2)), material(0.3, 0.2, 20.0));
    let mut brighter = scene.clone();
    brighter.lights = vec![Light::Point(PointLight {
        position: Vec3::new(1.5, 0.8, 0.2),
        intensity: 2.0 * Vec3::new(10.0, 20.0, 30.0),
    })];
    let mut whiter = scene.clone();
    whiter.materials = vec![material(0.6, 0.4, 20.0)];
    let mut both = scene.clone();
    both.lights.extend(brighter.lights.clone());
    for model in [IndirectModel::Exact { directions: 64 }, IndirectModel::Unbounded] {
        let one = render(&scene, model, 0).total();
        let of = |scene: &Scene| render(scene, model, 0).total();
        for (a, b) in
            one.pixels.iter().zip(of(&brighter).pixels).chain(one.pixels.iter().zip(of(&whiter).pixels))
        {
            assert!((b - 2.0 * *a).abs().max_element() <= 1e-5 * b.max_element(), "{a} {b}");
        }
        // Lights add up; the exact model takes other directions for the second one.
        let bound = if model == IndirectModel::Unbounded { 1e-5 } else { 0.2 };
        for (a, b) in one.pixels.iter().zip(of(&both).pixels) {
            assert!((b - 3.0 * *a).abs().max_element() <= bound * b.max_element(), "{a} {b}");
        }
    }
}

/// A room of `size` m about the eye.
fn room(size: f32) -> Scene {
    let mut scene = floor(lamp(Vec3::new(0.4, 0.3, 0.1)), material(0.5, 0.1, 10.0));
    let corner = |i: u32| size * (Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) - 0.5);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let mesh = Arc::new(Mesh { positions: (0..8).map(corner).collect(), triangles, ..Mesh::default() });
    scene.objects = vec![Object { name: "room".into(), mesh, world_from_object: Affine3A::IDENTITY }];
    scene.camera = Camera { eye: Vec3::ZERO, target: Vec3::X, up: Vec3::Y, fov_y: 1.2 };
    scene
}

#[test]
fn walls_leave_less_than_there_is_without_them() {
    let mut scene = room(2.0);
    scene.medium = Medium::grey(0.2, 0.9, Phase::isotropic());
    let (exact, unbounded) = (render(&scene, EXACT, 0), render(&scene, IndirectModel::Unbounded, 0));
    for (a, b) in exact.total().pixels.iter().zip(&unbounded.total().pixels) {
        assert!(a.min_element() > 0.0 && a.cmplt(*b).all(), "{a} {b}");
    }
    let sum = |rendered: &Rendered| rendered.total().pixels.iter().sum::<Vec3>();
    let ratio = sum(&exact) / sum(&unbounded);
    assert!(ratio.max_element() < 0.95, "{ratio}");
    // Light from outside does not come in.
    let dark = Scene { lights: vec![lamp(Vec3::new(4.0, 3.0, 0.0)), sun()], ..scene };
    assert!(render(&dark, EXACT, 0).total().pixels.iter().all(|pixel| *pixel == Vec3::ZERO));
    assert!(render(&dark, IndirectModel::Unbounded, 0).total().pixels.iter().all(|pixel| pixel.x > 0.0));
}

#[test]
fn other_directions_make_no_more_difference_than_is_said() {
    let spot = Light::Spot(SpotLight {
        position: Vec3::new(-0.6, 0.5, 0.0),
        direction: Vec3::new(1.0, -0.4, 0.3).normalize(),
        up: Vec3::Y,
        intensity: Vec3::splat(30.0),
        inner_angle: 0.1,
        outer_angle: 0.25,
        light_map: None,
    });
    let mut scene = room(2.0);
    for lights in [scene.lights.clone(), vec![spot]] {
        scene.lights = lights;
        let coarse = IndirectModel::Exact { directions: 256 };
        let [a, b] = [0, 1].map(|seed| render(&scene, coarse, seed));
        let (difference, _) = apart(&a, &b);
        println!("{difference:.4}, said to be {:.4}", a.indirect_uncertainty);
        assert!(difference < 1.5 * a.indirect_uncertainty && difference > 0.3 * a.indirect_uncertainty);
        assert!(a.indirect_uncertainty < 0.06, "{}", a.indirect_uncertainty);
        // More directions, less uncertain, and the same picture; the same seed gives the same bits.
        let fine = render(&scene, IndirectModel::Exact { directions: 1024 }, 2);
        assert!(fine.indirect_uncertainty < 0.6 * a.indirect_uncertainty, "{}", fine.indirect_uncertainty);
        assert!(apart(&a, &fine).0 < 1.5 * a.indirect_uncertainty);
        assert_eq!(render(&scene, coarse, 0).total(), a.total());
    }
}

/// A spot is a point light in a shade that leaves the same cone open.
#[test]
fn a_spot_is_a_point_light_in_a_shade() {
    let (position, half) = (Vec3::new(0.5, 0.8, 0.0), 0.6_f32);
    let mut scene = floor(
        Light::Spot(SpotLight {
            position,
            direction: Vec3::NEG_Y,
            up: Vec3::X,
            intensity: Vec3::new(10.0, 20.0, 30.0),
            inner_angle: half,
            outer_angle: half,
            light_map: None,
        }),
        material(0.8, 0.0, 1.0),
    );
    let many = IndirectModel::Exact { directions: 1024 };
    let spot = render(&scene, many, 0);
    // Above the light a pointed hat whose rim lies on the cone.
    scene.lights = vec![lamp(position)];
    let rim = 0.01 * half.tan();
    let shade = |ring: u32, i: u32| {
        let turn = std::f32::consts::TAU * i as f32 / 64.0;
        let r = rim / (std::f32::consts::PI / 64.0).cos().sqrt();
        position
            + [Vec3::new(r * turn.cos(), -0.01, r * turn.sin()), Vec3::new(0.0, 0.01, 0.0)][ring as usize]
    };
    let positions = (0..64).map(|i| shade(0, i)).chain([shade(1, 0)]).collect();
    let triangles = (0..64).map(|i| [i, (i + 1) % 64, 64]).collect();
    let mesh = Arc::new(Mesh { positions, triangles, ..Mesh::default() });
    scene.objects.push(Object { name: "shade".into(), mesh, world_from_object: Affine3A::IDENTITY });
    let (difference, mean) = apart(&render(&scene, many, 0), &spot);
    println!("{difference}, mean {mean}");
    assert!(difference < 0.03 && mean > 1e-3, "{difference}, {mean}");
}

#[test]
fn no_medium_no_surface_no_light_or_no_promise() {
    let lit = floor(lamp(Vec3::new(1.5, 0.8, 0.2)), material(0.8, 0.2, 5.0));
    for model in [EXACT, IndirectModel::Unbounded] {
        let black = |scene: Scene| {
            let rendered = render(&scene, model, 0);
            assert!(rendered.total().pixels.iter().all(|pixel| *pixel == Vec3::ZERO));
        };
        black(Scene { medium: Medium::vacuum(), ..lit.clone() });
        black(Scene { objects: vec![], ..lit.clone() });
        black(Scene { lights: vec![], ..lit.clone() });
        black(Scene { materials: vec![material(0.0, 0.0, 1.0)], ..lit.clone() });
        // Green alone scatters: red and blue are dark.
        let mut green = lit.clone();
        green.medium.sigma_s = Vec3::Y;
        let pixels = render(&green, model, 0).total().pixels;
        assert!(pixels.iter().all(|p| p.x == 0.0 && p.z == 0.0 && p.y > 0.0 && p.is_finite()));
    }
    let never = AtomicBool::new(false);
    let unbounded = Options { indirect: IndirectModel::Unbounded, ..Options::default() };
    let mut spot = lit.clone();
    spot.lights = vec![Light::Spot(SpotLight {
        position: Vec3::Y,
        direction: Vec3::NEG_Y,
        up: Vec3::X,
        intensity: Vec3::ONE,
        inner_angle: 0.1,
        outer_angle: 0.2,
        light_map: None,
    })];
    let reference = Reference::with_options(&spot, unbounded).unwrap();
    let view = spot.camera.view(2, 2);
    let error = reference.render(&view, Term::IndirectAirlight.into(), &|_| {}, &never).unwrap_err();
    assert!(error.to_string().contains("no spots"), "{error}");
    assert!(reference.render(&view, Term::Surface.into(), &|_| {}, &never).is_ok());

    // It stops when it is told to, and it is kept like any other picture.
    let reference = Reference::new(&lit).unwrap();
    let view = lit.camera.view(16, 16);
    let cancel = AtomicBool::new(false);
    let stop = |_| cancel.store(true, Ordering::Relaxed);
    let stopped = reference.render(&view, Term::IndirectAirlight.into(), &stop, &cancel);
    assert!(matches!(stopped, Err(Error::Cancelled)));
    let folder = tempfile::tempdir().unwrap();
    let options = Options { indirect: IndirectModel::Unbounded, ..Options::default() };
    let reference = Reference::with_options(&lit, options).unwrap();
    let [first, again] = [(); 2].map(|()| {
        reference.render_cached(folder.path(), &view, common::Terms::ALL, &|_| {}, &never).unwrap()
    });
    assert_eq!(again, Rendered { cached: true, ..first.clone() });
    let single =
        first.surface.unwrap().plus(&first.airlight.unwrap()).plus(&first.indirect_airlight.unwrap());
    assert_eq!(again.total(), single.plus(&first.multiple.unwrap()));
}
