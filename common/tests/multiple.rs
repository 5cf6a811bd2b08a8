//! The path tracer against golden values, closed forms, energy balance, the exact reference of single
//! scattering and the simple tracer.
#![cfg(feature = "reference")]

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use common::cloud::Grid;
use common::reference::multiple::{Estimate, Options, Pictures, beam, scattered_power, simple};
use common::reference::{self, Reference};
use common::scene::builtin;
use common::{
    Camera, Cloud, Density, DirectionalLight, Light, Lobe, Medium, Phase, PointLight, Scene, Sky, SpotLight,
    Term,
};
use glam::{DVec3, UVec3, Vec3};
use serde_json::Value;

fn golden() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/slab_halfspace.json");
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Deviations in standard errors.
#[derive(Default)]
struct Deviations(Vec<f64>);

impl Deviations {
    fn add(&mut self, what: &str, found: f64, error: f64, expected: f64) {
        let deviation = (found - expected) / error;
        assert!(deviation.abs() < 3.0, "{what}: {found} ± {error}, not {expected}");
        self.0.push(deviation);
    }

    /// Errors that are said too large are as wrong as errors that are said too small.
    fn check(&self) {
        let rms = (self.0.iter().map(|d| d * d).sum::<f64>() / self.0.len() as f64).sqrt();
        println!("{} values, deviations of {rms:.2} standard errors", self.0.len());
        let slack = 3.0 / (2.0 * self.0.len() as f64).sqrt();
        assert!((rms - 1.0).abs() < slack, "{rms}");
    }
}

fn slab(thickness: f32, albedo: f64, g: f64) -> Cloud {
    Cloud {
        density: Density::Slab { low: -thickness, high: 0.0 },
        sigma_t: 1.0,
        albedo: Vec3::splat(albedo as f32),
        phase: if g == 0.0 { Phase::isotropic() } else { Lobe::HenyeyGreenstein { g }.into() },
        emission: Vec3::ZERO,
    }
}

/// Downwards, with the cosine `mu` to the vertical.
fn down(mu: f64) -> DVec3 {
    DVec3::new((1.0 - mu * mu).sqrt(), -mu, 0.0)
}

#[test]
fn half_spaces_reflect_what_chandrasekhar_says() {
    let golden = golden();
    let mut deviations = Deviations::default();
    for (index, case) in golden["half_space"].as_array().unwrap().iter().enumerate() {
        let (albedo, mu, expected) =
            (number(&case["albedo"]), number(&case["mu0"]), number(&case["plane_albedo"]));
        // What has absorption is a half-space at some depth; what has none reflects all.
        if albedo > 0.995 || index % 2 == 1 {
            continue;
        }
        let found = beam(&slab(400.0, albedo, 0.0), DVec3::Y, down(mu), 300_000, index as u64).unwrap();
        let Estimate { mean, error } = found.upwards;
        assert!(error.x < 0.003 * expected, "{albedo}, {mu}: {error}");
        deviations.add(&format!("albedo {albedo}, cosine {mu}"), mean.x, error.x, expected);
        assert_eq!(found.downwards.mean, DVec3::ZERO);
    }
    assert!(deviations.0.len() >= 12);
    deviations.check();
}

#[test]
fn slabs_reflect_and_transmit_what_adding_and_doubling_says() {
    let golden = golden();
    let mut deviations = Deviations::default();
    for (index, case) in golden["slabs"].as_array().unwrap().iter().enumerate() {
        let (albedo, tau, g) = (number(&case["albedo"]), number(&case["tau"]), number(&case["g"]));
        for i in [2 + index % 6] {
            let at = |name: &str| number(&case[name][i]);
            let mu = at("mu0");
            let seed = (10 * index + i) as u64;
            let found = beam(&slab(tau as f32, albedo, g), DVec3::Y, down(mu), 200_000, seed).unwrap();
            for (what, part, expected) in [
                ("reflected", found.upwards, at("plane_albedo")),
                ("transmitted", found.downwards, at("diffuse_transmittance")),
                ("straight", found.unscattered, at("direct_transmittance")),
            ] {
                let what = format!("{what} of albedo {albedo}, depth {tau}, g {g}, cosine {mu}");
                let (mean, error) = (part.mean.x, part.error.x);
                // Very little comes of few paths.
                if expected > 1e-3 {
                    assert!(error < 0.003 * expected || expected < 0.35, "{what}: {error} of {expected}");
                    deviations.add(&what, mean, error, expected);
                }
            }
        }
    }
    assert!(deviations.0.len() >= 35);
    deviations.check();
}

fn paths(scene: &Scene, width: u32, height: u32, options: Options) -> Pictures {
    let reference = Reference::new(scene).unwrap();
    let view = scene.camera.view(width, height);
    reference.paths(&view, &options, &|_| {}, &AtomicBool::new(false)).unwrap()
}

fn samples(samples: u32) -> Options {
    Options { samples, ..Options::default() }
}

/// All pixels of one colour as one estimate; they are of one value each or of one mean.
fn mean(picture: &common::image::Image, error: &common::image::Image) -> (DVec3, DVec3) {
    let count = picture.pixels.len() as f64;
    let sum: DVec3 = picture.pixels.iter().map(|p| p.as_dvec3()).sum();
    let squares: DVec3 = error.pixels.iter().map(|e| e.as_dvec3() * e.as_dvec3()).sum();
    (sum / count, DVec3::from_array(squares.to_array().map(f64::sqrt)) / count)
}

#[test]
fn half_spaces_are_as_bright_as_they_should_be() {
    let golden = golden();
    let mut deviations = Deviations::default();
    for (index, case) in golden["half_space"].as_array().unwrap().iter().enumerate() {
        let (albedo, mu0) = (number(&case["albedo"]), number(&case["mu0"]));
        if albedo > 0.96 || index % 4 != 1 {
            continue;
        }
        for i in [2, 9] {
            let mu = number(&case["brdf_mu"][i]);
            let mut scene = Scene::empty("half-space");
            scene.cloud = Some(slab(400.0, albedo, 0.0));
            scene.lights = vec![Light::Directional(DirectionalLight {
                direction: down(mu0).as_vec3(),
                irradiance: Vec3::ONE,
            })];
            let eye = -10.0 * down(mu).as_vec3();
            scene.camera = Camera { eye, target: Vec3::ZERO, up: Vec3::Z, fov_y: 1e-4 };
            let pictures = paths(&scene, 4, 8, Options { seed: index as u64, ..samples(11_000) });
            let (found, error) = mean(&pictures.airlight.plus(&pictures.multiple), &pictures.error);
            let expected = number(&case["brdf"][i]) * mu0;
            assert!(error.x < 0.003 * expected, "{} of {expected}", error.x);
            let what = format!("albedo {albedo}, in by {mu0}, out by {mu}");
            deviations.add(&what, found.x, error.x, expected);
        }
    }
    deviations.check();
}

/// A ball of radius 1 m about the origin, seen from 3 m.
fn ball(cloud: Cloud) -> Scene {
    let mut scene = Scene::empty("ball");
    scene.cloud = Some(cloud);
    scene.camera = Camera { eye: Vec3::new(0.0, 0.0, 3.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.6 };
    scene
}

fn cloud(sigma_t: f32, albedo: Vec3, phase: impl Into<Phase>) -> Cloud {
    Cloud {
        density: Density::Sphere { centre: Vec3::ZERO, radius: 1.0 },
        sigma_t,
        albedo,
        phase: phase.into(),
        emission: Vec3::ZERO,
    }
}

fn coloured() -> Phase {
    Phase::mixture(vec![
        (Vec3::new(1.0, 2.0, 4.0), Lobe::Rayleigh),
        (Vec3::new(3.0, 2.0, 1.0), Lobe::HenyeyGreenstein { g: 0.7 }),
        (Vec3::new(1.0, 0.0, 2.0), Lobe::MieHazy),
    ])
}

#[test]
fn in_a_white_furnace_nothing_is_to_be_seen() {
    let sky = Vec3::new(1.0, 2.0, 3.0);
    let density = Density::TwoDensity { centre: Vec3::ZERO, core: 0.5, radius: 1.0, shell: 0.3 };
    let grid = Density::Grid(Arc::new(Grid::of(&density, 10)));
    for density in [density, grid] {
        let mut scene = ball(Cloud { density, ..cloud(4.0, Vec3::ONE, coloured()) });
        scene.sky = Sky::Constant(sky);
        let pictures = paths(&scene, 16, 16, samples(600));
        let mut sum = pictures.airlight.plus(&pictures.multiple);
        for (pixel, transmittance) in sum.pixels.iter_mut().zip(&pictures.transmittance.pixels) {
            *pixel = (*pixel + transmittance * sky) / sky;
        }
        let (found, error) = mean(&sum, &pictures.error);
        println!("{found} ± {error}");
        assert!((found - 1.0).abs().cmplt(3.0 * error + 0.002).all(), "{found} ± {error}");
        assert!(error.x < 0.003);
    }
}

#[test]
fn emission_is_the_closed_form() {
    let mut scene = ball(cloud(1.5, Vec3::ZERO, Lobe::Isotropic));
    let emission = Vec3::new(1.0, 2.0, 0.5);
    scene.cloud.as_mut().unwrap().emission = emission;
    let pictures = paths(&scene, 1, 1, samples(200_000));
    let expected = f64::from(emission.x) / 1.5 * (1.0 - (-3.0f64).exp());
    let (found, error) = mean(&pictures.multiple, &pictures.multiple_error);
    assert!((found.x - expected).abs() < 3.0 * error.x && error.x < 0.003 * expected, "{found}, {expected}");
    assert_eq!(pictures.airlight.pixels[0], Vec3::ZERO);
    assert!((f64::from(pictures.transmittance.pixels[0].x) - (-3.0f64).exp()).abs() < 1e-6);
}

#[test]
fn a_sphere_lets_out_what_is_known() {
    let scene = builtin::build("sphere", None).unwrap();
    let found = scattered_power(&scene, 400_000, 3).unwrap();
    let incident = found.incident.mean.x;
    let Light::Directional(light) = &scene.lights[0] else { panic!("a directional light") };
    let area = PI;
    assert!((incident / (area * f64::from(light.irradiance.x)) - 1.0).abs() < 1e-6, "{incident}");
    let scattered = found.scattered.mean.x / incident;
    let unscattered = found.unscattered.mean.x / incident;
    println!("{scattered} ± {}, {unscattered}", found.scattered.error.x / incident);
    // The known values are sure to .001.
    assert!((scattered + unscattered - 0.5415).abs() < 0.003 || (scattered - 0.5415).abs() < 0.003);
    // ∫ exp(−2Rτ cos) 2 sin cos over the disc.
    let exact = 2.0 / 400.0 * (1.0 - 21.0 * (-20.0f64).exp());
    assert!(
        (unscattered - exact).abs() < 3.0 * found.unscattered.error.x / incident,
        "{unscattered}, {exact}"
    );
    let sum = found.upwards.mean + found.downwards.mean;
    assert!((sum / found.scattered.mean - 1.0).abs().max_element() < 1e-9);
}

#[test]
fn a_point_light_in_a_sphere_loses_nothing() {
    let intensity = Vec3::new(1.0, 2.0, 3.0);
    let mut scene = ball(cloud(2.0, Vec3::new(1.0, 0.8, 0.5), Lobe::HenyeyGreenstein { g: 0.4 }));
    scene.lights = vec![Light::Point(PointLight { position: Vec3::ZERO, intensity })];
    let power = scattered_power(&scene, 200_000, 1).unwrap();
    let all = 4.0 * PI * intensity.as_dvec3();
    let straight = all * (-2.0f64).exp();
    assert!((power.unscattered.mean - straight).abs().cmplt(3.0 * power.unscattered.error).all());
    assert!((power.scattered.mean.x + power.unscattered.mean.x - all.x).abs() < 1e-6 * all.x);
    // The same from the eye: at a distance the sphere is a point light of what it scatters.
    scene.camera.eye = Vec3::new(0.0, 0.0, 20.0);
    scene.camera.fov_y = 0.102;
    let pictures = paths(&scene, 48, 48, samples(100));
    let sum = pictures.airlight.plus(&pictures.multiple);
    let view = scene.camera.view(48, 48);
    let (mut found, mut variance) = (DVec3::ZERO, DVec3::ZERO);
    let pixel_area = (2.0 * (0.5 * f64::from(scene.camera.fov_y)).tan() / 48.0).powi(2);
    for y in 0..48 {
        for x in 0..48 {
            let cos = f64::from(-view.ray_direction(x, y).z);
            // Irradiance on a plane that faces the sphere, times the area of the sphere around it.
            let weight = 4.0 * PI * 400.0 * pixel_area * cos.powi(4);
            let index = (48 * y + x) as usize;
            found += weight * sum.pixels[index].as_dvec3();
            let error = weight * pictures.error.pixels[index].as_dvec3();
            variance += error * error;
        }
    }
    let error = DVec3::from_array(variance.to_array().map(f64::sqrt));
    println!("{found} ± {error}, not {}", power.scattered.mean);
    // The edge of the sphere falls between pixels, so some allowance.
    let allowed = 3.0 * error + 3.0 * power.scattered.error + 0.003 * power.scattered.mean;
    assert!((found - power.scattered.mean).abs().cmplt(allowed).all());
    assert!((error / found).max_element() < 0.02);
}

#[test]
fn the_simple_tracer_agrees() {
    let density = Density::TwoDensity { centre: Vec3::ZERO, core: 0.5, radius: 1.0, shell: 0.3 };
    let grid = Density::Grid(Arc::new(Grid {
        cells: UVec3::new(2, 2, 1),
        low: -Vec3::ONE,
        high: Vec3::ONE,
        values: vec![0.2, 1.0, 0.7, 0.0],
    }));
    let mut deviations = Deviations::default();
    for density in [density, grid] {
        let mut scene = ball(Cloud { density, ..cloud(3.0, Vec3::new(0.95, 0.8, 0.5), coloured()) });
        scene.cloud.as_mut().unwrap().emission = Vec3::new(0.1, 0.2, 0.3);
        scene.lights = vec![
            Light::Directional(DirectionalLight {
                direction: Vec3::new(0.6, -0.8, 0.0),
                irradiance: Vec3::new(3.0, 2.0, 1.0),
            }),
            Light::Point(PointLight {
                position: Vec3::new(0.5, 1.1, 0.3),
                intensity: Vec3::new(0.5, 0.6, 0.7),
            }),
            Light::Spot(SpotLight {
                position: Vec3::new(-1.5, 0.2, 1.0),
                direction: Vec3::new(1.5, -0.2, -1.0).normalize(),
                up: Vec3::Y,
                intensity: Vec3::new(2.0, 3.0, 4.0),
                inner_angle: 0.2,
                outer_angle: 0.5,
                light_map: None,
            }),
        ];
        let texels = (0..8).map(|i| Vec3::new(1.0, 0.5, 0.1) * i as f32 * 0.2).collect();
        scene.sky = Sky::Picture(Arc::new(common::LightMap { width: 4, height: 2, texels }));
        let pictures = paths(&scene, 3, 3, samples(30_000));
        let sum = pictures.airlight.plus(&pictures.multiple);
        let view = scene.camera.view(3, 3);
        for (x, y) in [(1, 1), (0, 1), (2, 1), (1, 0)] {
            let index = (3 * y + x) as usize;
            let (eye, direction) = (scene.camera.eye.as_dvec3(), view.ray_direction(x, y).as_dvec3());
            let plain = simple(&scene, eye, direction, 30_000, u64::from(x)).unwrap();
            for colour in 0..3 {
                let own = f64::from(pictures.error.pixels[index][colour]);
                let error = own.hypot(plain.error[colour]);
                let found = f64::from(sum.pixels[index][colour]);
                deviations.add(&format!("{x}, {y}, {colour}"), found, error, plain.mean[colour]);
            }
        }
    }
    // Colours of one pixel go together, so this is a wide bound.
    deviations.check();
}

/// Without reflection, so that nothing else is in the picture.
fn black(mut scene: Scene) -> Scene {
    for material in &mut scene.materials {
        (material.k_d, material.k_s) = (Vec3::ZERO, Vec3::ZERO);
    }
    scene
}

#[test]
fn parallel_light_in_a_thin_cloud_is_not_missed() {
    // One path in a million collides here.
    let mut scene = ball(cloud(5e-7, Vec3::splat(0.9), Phase::isotropic()));
    scene.lights = vec![Light::Directional(DirectionalLight {
        direction: Vec3::new(-0.7, -0.5, -0.5).normalize(),
        irradiance: Vec3::splat(std::f32::consts::PI),
    })];
    let pictures = paths(&scene, 3, 3, samples(16));
    let [found, error] = [&pictures.airlight, &pictures.error].map(|image| f64::from(image.pixels[4].x));
    // Albedo, optical depth of a diameter, phase function, irradiance.
    let expected = 0.9 * (2.0 * 5e-7) / (4.0 * PI) * PI;
    println!("{found:e} ± {error:e}, expected {expected:e}");
    assert!((found / expected - 1.0).abs() < 1e-3 && error < 1e-3 * expected);
}

#[test]
fn single_scattering_is_that_of_the_lit_intervals() {
    for name in ["knife-edge", "amphora"] {
        let scene = black(builtin::build(name, None).unwrap());
        let view = scene.camera.view(32, 26);
        let exact = Reference::new(&scene)
            .unwrap()
            .render(&view, Term::Airlight.into(), &|_| {}, &AtomicBool::new(false))
            .unwrap()
            .airlight
            .unwrap();
        let found = paths(&scene, 32, 26, Options { max_scatterings: Some(1), ..samples(250) });
        let (want, _) = mean(&exact, &found.direct_error);
        let (have, error) = mean(&found.airlight, &found.direct_error);
        assert!((have - want).abs().cmplt(3.0 * error).all(), "{name}: {have} ± {error}, not {want}");
        assert!((error / want).max_element() < 0.006, "{name}: {error}");
        let residuals: Vec<f64> = (0..exact.pixels.len())
            .filter(|i| found.direct_error.pixels[*i].x > 0.0)
            .map(|i| {
                f64::from((found.airlight.pixels[i].x - exact.pixels[i].x) / found.direct_error.pixels[i].x)
            })
            .collect();
        let rms = (residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len() as f64).sqrt();
        println!("{name}: {have} ± {error}, not {want}; residuals {rms:.3}");
        assert!((rms - 1.0).abs() < 0.15, "{name}: {rms}");
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let mut scene = builtin::build("amphora", None).unwrap();
    scene.medium.phase = coloured();
    let many = paths(&scene, 12, 10, samples(4));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| paths(&scene, 12, 10, samples(4))), many);
    assert_ne!(paths(&scene, 12, 10, Options { seed: 1, ..samples(4) }).multiple, many.multiple);
}

/// A medium without end is a sphere that is large enough, and its colours are those of grey media.
#[test]
fn a_medium_without_end_is_a_large_cloud() {
    let sigma_t = Vec3::new(0.5, 1.0, 2.0);
    let albedo = Vec3::new(0.9, 0.8, 0.95);
    let phase = coloured();
    let mut scene = Scene::empty("endless");
    scene.lights =
        vec![Light::Point(PointLight { position: Vec3::new(0.4, 1.5, 3.0), intensity: Vec3::ONE })];
    scene.camera = Camera { eye: Vec3::new(0.0, 0.0, 2.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 1.0 };
    let mut endless = scene.clone();
    endless.medium =
        Medium { sigma_s: albedo * sigma_t, sigma_a: (Vec3::ONE - albedo) * sigma_t, phase: phase.clone() };
    let found = paths(&endless, 6, 6, samples(4000));
    let (multiple, found_error) = mean(&found.multiple, &found.multiple_error);
    for colour in 0..3 {
        let mut grey = scene.clone();
        grey.cloud = Some(Cloud {
            density: Density::Sphere { centre: Vec3::ZERO, radius: 60.0 / sigma_t[colour] },
            ..cloud(sigma_t[colour], albedo, phase.clone())
        });
        let other = paths(&grey, 6, 6, samples(2000));
        let (want, other_error) = mean(&other.multiple, &other.multiple_error);
        let error = found_error[colour].hypot(other_error[colour]);
        println!(
            "endless {colour}: {} ± {}, not {} ± {}",
            multiple[colour], found_error[colour], want[colour], other_error[colour]
        );
        assert!((multiple[colour] - want[colour]).abs() < 3.0 * error);
        assert!(error < 0.06 * want[colour]);
    }
}

#[test]
fn what_makes_no_sense_is_said() {
    let mut scene = ball(cloud(1.0, Vec3::ONE, Lobe::Isotropic));
    scene.medium = Medium::grey(0.1, 0.5, Phase::isotropic());
    let Err(reference::Error::Scene(text)) = Reference::new(&scene) else { panic!("accepted") };
    assert!(text.contains("clear air"), "{text}");
    scene.medium = Medium::vacuum();
    assert!(scattered_power(&scene, 10, 0).is_err(), "no light");
    scene.lights = vec![Light::Directional(DirectionalLight { direction: Vec3::X, irradiance: Vec3::ONE })];
    assert!(scattered_power(&scene, 10, 0).is_ok());
    scene.cloud.as_mut().unwrap().density = Density::Slab { low: 0.0, high: 1.0 };
    assert!(scattered_power(&scene, 10, 0).is_err(), "endless");
    scene.cloud = None;
    assert!(scattered_power(&scene, 10, 0).is_err(), "no cloud");
}

#[test]
fn the_colours_of_a_mixture_are_those_of_its_lobes() {
    let [ahead, back] = [Lobe::HenyeyGreenstein { g: 0.8 }, Lobe::HenyeyGreenstein { g: -0.6 }];
    let phase = Phase::mixture(vec![(Vec3::new(1.0, 0.0, 1.0), ahead), (Vec3::new(0.0, 1.0, 1.0), back)]);
    let through = |phase: Phase, seed: u64| {
        let cloud = Cloud { phase, ..slab(2.0, 0.9, 0.0) };
        beam(&cloud, DVec3::Y, down(0.8), 200_000, seed).unwrap().downwards
    };
    let found = through(phase, 1);
    for (colour, lobe) in [(0, ahead), (1, back)] {
        let expected = through(lobe.into(), 2);
        let error = found.error[colour].hypot(expected.error.x);
        let off = (found.mean[colour] - expected.mean.x).abs();
        assert!(off < 3.0 * error && error < 0.02 * expected.mean.x, "{off}, {error}");
    }
    assert!(found.mean.x > 1.5 * found.mean.y);
}
