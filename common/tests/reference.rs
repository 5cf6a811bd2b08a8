//! The CPU reference against closed forms, hand-computed shadows and its own second method.
#![cfg(all(feature = "files", feature = "reference"))]

use std::f64::consts::PI;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use common::airlight::{airlight_directional, airlight_point};
use common::image::Image;
use common::reference::{Error, Options, Reference, Rendered};
use common::scene::{Material, Mesh, Object};
use common::{
    Camera, DirectionalLight, Light, Lobe, Medium, Phase, PointLight, Scene, SpotLight, Term, Terms,
};
use glam::{Affine3A, DVec3, Vec3};

/// Radiance at the eye that f32 pictures can hold.
const STORED: f64 = 2e-6;

fn medium() -> Medium {
    Medium {
        sigma_s: Vec3::new(0.125, 0.25, 0.5),
        sigma_a: Vec3::new(0.125, 0.0, 0.25),
        phase: Lobe::HenyeyGreenstein { g: 0.5 }.into(),
    }
}

/// Extinction, scattering and phase function as [`airlight_point`] takes them.
fn optics(medium: &Medium) -> (DVec3, DVec3, &Phase) {
    (medium.sigma_t().as_dvec3(), medium.sigma_s.as_dvec3(), &medium.phase)
}

fn point(position: Vec3) -> Light {
    Light::Point(PointLight { position, intensity: Vec3::new(10.0, 20.0, 30.0) })
}

/// A scene with the eye at the origin, looking along +x, y up.
fn scene(lights: Vec<Light>) -> Scene {
    let mut scene = Scene::empty("test");
    scene.medium = medium();
    scene.lights = lights;
    scene.camera = Camera { eye: Vec3::ZERO, target: Vec3::X, up: Vec3::Y, fov_y: 0.8 };
    scene
}

fn add(scene: &mut Scene, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) {
    let mesh = Arc::new(Mesh { positions, triangles, ..Mesh::default() });
    scene.objects.push(Object { name: "mesh".into(), mesh, world_from_object: Affine3A::IDENTITY });
}

/// A parallelogram from a corner and two edges.
fn add_quad(scene: &mut Scene, corner: Vec3, u: Vec3, v: Vec3) {
    add(scene, vec![corner, corner + u, corner + u + v, corner + v], vec![[0, 1, 2], [0, 2, 3]]);
}

/// A closed box.
fn add_box(scene: &mut Scene, low: Vec3, high: Vec3) {
    let corner = |i: u32| Vec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), high, low);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    add(scene, (0..8).map(corner).collect(), triangles);
}

fn render(scene: &Scene, width: u32, height: u32, terms: Terms) -> Rendered {
    let reference = Reference::new(scene).unwrap();
    reference.render(&scene.camera.view(width, height), terms, &|_| {}, &AtomicBool::new(false)).unwrap()
}

/// Airlight along +x, through the only pixel.
fn airlight(scene: &Scene) -> DVec3 {
    let rendered = render(scene, 1, 1, Term::Airlight.into());
    assert!(rendered.uncertainty < 2e-6, "{}", rendered.uncertainty);
    rendered.airlight.unwrap().pixels[0].as_dvec3()
}

fn near(found: DVec3, expected: DVec3, tolerance: f64) {
    let error = (found - expected).abs().max_element() / expected.abs().max_element();
    assert!(error <= tolerance, "{found}, not {expected}: {error:e}");
}

#[test]
fn without_anything_in_it_the_scene_is_the_closed_form() {
    let light = Vec3::new(4.0, 2.0, 0.0);
    let scene = scene(vec![point(light)]);
    let medium = scene.medium.clone();
    let (sigma_t, sigma_s, phase) = optics(&medium);
    let intensity = DVec3::new(10.0, 20.0, 30.0);
    let expected = intensity * airlight_point(sigma_t, sigma_s, phase, 4.0, 2.0, 0.0, f64::INFINITY, 1e-10);
    near(airlight(&scene), expected, STORED);

    // The same through every pixel of a picture, by the direction of the view.
    let view = scene.camera.view(8, 6);
    let picture = render(&scene, 8, 6, Term::Airlight.into()).total();
    for y in 0..6 {
        for x in 0..8 {
            let direction = view.ray_direction(x, y).as_dvec3();
            let t = light.as_dvec3().dot(direction);
            let h = light.as_dvec3().cross(direction).length();
            let expected =
                intensity * airlight_point(sigma_t, sigma_s, phase, t, h, 0.0, f64::INFINITY, 1e-9);
            near(picture.pixels[(y * 8 + x) as usize].as_dvec3(), expected, 1e-5);
        }
    }
}

#[test]
fn a_shadow_computed_by_hand() {
    // Light at (4, 2, 0). A strip at y = 1 from x = 2.5 to 3.5 shades x = 1 to 3; a wall at
    // x = 6 ends the ray.
    let mut scene = scene(vec![point(Vec3::new(4.0, 2.0, 0.0))]);
    add_quad(&mut scene, Vec3::new(2.5, 1.0, -1.0), Vec3::X, 2.0 * Vec3::Z);
    add_quad(&mut scene, Vec3::new(6.0, -9.0, -9.0), 18.0 * Vec3::Y, 18.0 * Vec3::Z);
    let medium = scene.medium.clone();
    let (sigma_t, sigma_s, phase) = optics(&medium);
    let part =
        |a, b| DVec3::new(10.0, 20.0, 30.0) * airlight_point(sigma_t, sigma_s, phase, 4.0, 2.0, a, b, 1e-10);
    near(airlight(&scene), part(0.0, 1.0) + part(3.0, 6.0), STORED);

    // A sheet that reaches to the light's height and beyond shades one side for ever.
    add_quad(&mut scene, Vec3::new(3.5, 1.0, -1.0), 9.0 * Vec3::Y, 2.0 * Vec3::Z);
    near(airlight(&scene), part(3.0, 6.0), STORED);
    // The other side of the light does not matter, nor does what is below the ray.
    add_quad(&mut scene, Vec3::new(1.0, 2.5, -1.0), 5.0 * Vec3::X, 2.0 * Vec3::Z);
    add_quad(&mut scene, Vec3::new(1.0, -0.5, -1.0), 5.0 * Vec3::X, 2.0 * Vec3::Z);
    near(airlight(&scene), part(3.0, 6.0), STORED);
}

#[test]
fn a_ray_through_the_light_sees_all_of_it_or_nothing() {
    let behind = scene(vec![point(Vec3::new(-2.0, 0.0, 0.0))]);
    let (sigma_t, sigma_s, phase) = optics(&behind.medium);
    let open = DVec3::new(10.0, 20.0, 30.0)
        * airlight_point(sigma_t, sigma_s, phase, -2.0, 0.0, 0.0, f64::INFINITY, 1e-10);
    near(airlight(&behind), open, STORED);
    let mut shut = behind.clone();
    add_quad(&mut shut, Vec3::new(-1.0, -1.0, -1.0), 2.0 * Vec3::Y, 2.0 * Vec3::Z);
    assert_eq!(airlight(&shut), DVec3::ZERO);

    // Ahead of the eye: finite, positive and bright; behind a wall: dark.
    let ahead = scene(vec![point(Vec3::new(3.0, 0.0, 0.0))]);
    let found = airlight(&ahead);
    assert!(found.is_finite() && found.min_element() > 1e3, "{found}");
    let mut hidden = ahead.clone();
    add_quad(&mut hidden, Vec3::new(2.0, -1.0, -1.0), 2.0 * Vec3::Y, 2.0 * Vec3::Z);
    assert_eq!(airlight(&hidden), DVec3::ZERO);
}

#[test]
fn a_sealed_box_lets_nothing_out() {
    let light = Vec3::new(5.0, 0.3, -0.2);
    let mut sealed = scene(vec![
        point(light),
        Light::Spot(SpotLight {
            position: light,
            direction: Vec3::NEG_X,
            up: Vec3::Y,
            intensity: Vec3::splat(100.0),
            inner_angle: 0.2,
            outer_angle: 1.0,
            light_map: None,
        }),
    ]);
    add_box(&mut sealed, Vec3::new(4.1, -0.7, -1.3), Vec3::new(6.3, 1.1, 0.9));
    let rendered = render(&sealed, 96, 80, Terms::DIRECT);
    assert_eq!(rendered.total(), Image::black(96, 80));
    assert_eq!(rendered.uncertainty, Options::default().tolerance);

    // And nothing in: the eye sits inside, the light is outside.
    sealed.camera.eye = Vec3::new(5.0, 0.1, 0.0);
    sealed.lights = vec![
        point(Vec3::new(20.0, 30.0, 1.0)),
        Light::Directional(DirectionalLight { direction: Vec3::new(0.6, -0.8, 0.0), irradiance: Vec3::ONE }),
    ];
    assert_eq!(render(&sealed, 96, 80, Terms::DIRECT).total(), Image::black(96, 80));
}

#[test]
fn directional_light_and_a_slab() {
    // Light comes down at 45° along +x; a slab at y = 2 over x in [0, 1] shades x = 2 to 3.
    let travel = Vec3::new(1.0, -1.0, 0.0).normalize();
    let irradiance = Vec3::new(1.0, 2.0, 3.0);
    let mut scene = scene(vec![Light::Directional(DirectionalLight { direction: travel, irradiance })]);
    let medium = scene.medium.clone();
    let (sigma_t, sigma_s, phase) = optics(&medium);
    let part = |a, b| {
        // Scattered towards the eye the light travels along −x.
        let cos_theta = -f64::from(travel.x);
        irradiance.as_dvec3() * airlight_directional(sigma_t, sigma_s, phase, cos_theta, a, b)
    };
    near(airlight(&scene), part(0.0, f64::INFINITY), STORED);
    add_quad(&mut scene, Vec3::new(0.0, 2.0, -1.0), Vec3::X, 2.0 * Vec3::Z);
    near(airlight(&scene), part(0.0, 2.0) + part(3.0, f64::INFINITY), STORED);

    // Along the ray: lit from behind unless something stands behind the eye.
    scene.lights = vec![Light::Directional(DirectionalLight { direction: Vec3::X, irradiance })];
    let whole =
        irradiance.as_dvec3() * airlight_directional(sigma_t, sigma_s, phase, -1.0, 0.0, f64::INFINITY);
    near(airlight(&scene), whole, STORED);
    add_quad(&mut scene, Vec3::new(-3.0, -1.0, -1.0), 2.0 * Vec3::Y, 2.0 * Vec3::Z);
    assert_eq!(airlight(&scene), DVec3::ZERO);
    // From ahead it shines on all of a ray that nothing ends.
    scene.lights = vec![Light::Directional(DirectionalLight { direction: Vec3::NEG_X, irradiance })];
    assert!(airlight(&scene).min_element() > 0.0);
}

#[test]
fn a_spot_lights_what_lies_in_its_cone() {
    // Apex 2 m above the ray, cone of 45°: it covers 2 m on either side.
    let (half, position) = (PI as f32 / 4.0, Vec3::new(5.0, 2.0, 0.0));
    let spot = SpotLight {
        position,
        direction: Vec3::NEG_Y,
        up: Vec3::X,
        intensity: Vec3::new(10.0, 20.0, 30.0),
        inner_angle: half,
        outer_angle: half,
        light_map: None,
    };
    let mut scene = scene(vec![Light::Spot(spot.clone())]);
    let medium = scene.medium.clone();
    let (sigma_t, sigma_s, phase) = optics(&medium);
    let part =
        |a, b| DVec3::new(10.0, 20.0, 30.0) * airlight_point(sigma_t, sigma_s, phase, 5.0, 2.0, a, b, 1e-10);
    near(airlight(&scene), part(3.0, 7.0), STORED);
    // A point light in a tube of the same cone: the same with a strip in the way.
    add_quad(&mut scene, Vec3::new(5.0, 1.0, -1.0), 0.5 * Vec3::X, 2.0 * Vec3::Z);
    near(airlight(&scene), part(3.0, 5.0) + part(6.0, 7.0), STORED);

    // With a falloff: between the whole inner cone and the whole outer one.
    let soft = SpotLight { inner_angle: 0.3, ..spot };
    scene.objects.clear();
    scene.lights = vec![Light::Spot(soft)];
    let inner = 2.0 * 0.3_f64.tan();
    let found = airlight(&scene);
    assert!(found.cmpgt(part(5.0 - inner, 5.0 + inner)).all() && found.cmplt(part(3.0, 7.0)).all());
}

/// A reproducible number in [0, 1).
fn random(state: &mut u64) -> f32 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 40) as f32 / (1 << 24) as f32
}

#[test]
fn both_methods_agree_in_a_soup_of_triangles() {
    for (seed, count, size) in [(1, 60, 2.0), (2, 300, 0.8), (3, 300, 3.0), (4, 12, 6.0)] {
        let mut state = seed;
        let mut place = |range: f32| Vec3::from_array([0; 3].map(|_| (random(&mut state) - 0.5) * range));
        let mut soup = scene(Vec::new());
        for _ in 0..count {
            let centre = place(10.0) + Vec3::new(6.0, 0.0, 0.0);
            let corners = [0; 3].map(|_| centre + place(size));
            add(&mut soup, corners.to_vec(), vec![[0, 1, 2]]);
        }
        let position = place(4.0) + Vec3::new(6.0, 2.0, 0.0);
        let lights = [
            point(position),
            point(Vec3::new(-4.0, 2.0, 1.0)),
            Light::Directional(DirectionalLight {
                direction: place(2.0).normalize(),
                irradiance: Vec3::new(1.0, 0.5, 0.25),
            }),
            Light::Spot(SpotLight {
                position,
                direction: place(2.0).normalize(),
                up: Vec3::Y,
                intensity: Vec3::splat(20.0),
                inner_angle: 0.4,
                outer_angle: 1.2,
                light_map: None,
            }),
        ];
        for light in lights {
            soup.lights = vec![light];
            let options = Options { checked_rays: 150, ..Options::default() };
            let reference = Reference::with_options(&soup, options).unwrap();
            let rendered = reference
                .render(&soup.camera.view(12, 12), Term::Airlight.into(), &|_| {}, &AtomicBool::new(false))
                .unwrap();
            assert_eq!(rendered.checked_rays, 144, "every pixel is checked");
            assert!(
                rendered.uncertainty < 1e-4,
                "soup {seed}, {}: {:e}",
                soup.lights[0].kind(),
                rendered.uncertainty
            );
        }
    }
}

#[test]
fn a_floor_in_closed_form() {
    // Straight down on a floor 3 m below the eye; a light 2 m above it and 1.5 m aside, so 2.5 m
    // away from the point that is seen.
    let mut scene = scene(vec![point(Vec3::new(1.5, -1.0, 0.0))]);
    scene.camera.target = Vec3::NEG_Y;
    scene.camera.up = Vec3::X;
    scene.materials = vec![Material {
        name: "floor".into(),
        k_d: Vec3::new(0.5, 0.25, 1.0),
        k_s: Vec3::new(0.1, 0.2, 0.3),
        exponent: 4.0,
    }];
    // Wound so that its own normal points down: surfaces have two sides.
    add_quad(&mut scene, Vec3::new(-9.0, -3.0, -9.0), 18.0 * Vec3::X, 18.0 * Vec3::Z);
    let cos: f64 = 2.0 / 2.5;
    let sigma_t = scene.medium.sigma_t().as_dvec3();
    let [k_d, k_s] = [scene.materials[0].k_d, scene.materials[0].k_s].map(Vec3::as_dvec3);
    // The mirrored direction is straight up, so the lobe's cosine is the light's.
    let reflected = k_d / PI + k_s * (6.0 / (2.0 * PI) * cos.powi(4));
    let expected = DVec3::new(10.0, 20.0, 30.0) / 6.25 * cos * reflected * (-sigma_t * (2.5 + 3.0)).exp();
    let seen = |scene: &Scene| render(scene, 1, 1, Term::Surface.into()).total().pixels[0].as_dvec3();
    near(seen(&scene), expected, STORED);

    // Directional light is not attenuated on its way.
    let mut sunny = scene.clone();
    sunny.lights = vec![Light::Directional(DirectionalLight {
        direction: Vec3::new(-0.6, -0.8, 0.0),
        irradiance: Vec3::splat(7.0),
    })];
    near(seen(&sunny), 7.0 * cos * reflected * (-sigma_t * 3.0).exp(), STORED);

    // In the shadow, and with the light below the floor, there is none.
    let mut shadowed = scene.clone();
    add_quad(&mut shadowed, Vec3::new(0.4, -2.2, -1.0), 0.5 * Vec3::X, 2.0 * Vec3::Z);
    assert_eq!(seen(&shadowed), DVec3::ZERO);
    scene.lights = vec![point(Vec3::new(0.5, -4.0, 0.0))];
    assert_eq!(seen(&scene), DVec3::ZERO);
}

#[test]
fn odd_scenes_are_pictures_or_errors_but_never_panics() {
    let empty = scene(Vec::new());
    assert_eq!(render(&empty, 3, 2, Terms::DIRECT).total(), Image::black(3, 2));
    let vacuum = Scene { medium: Medium::vacuum(), ..scene(vec![point(Vec3::Y)]) };
    assert_eq!(render(&vacuum, 3, 2, Terms::DIRECT).total(), Image::black(3, 2));
    // Degenerate triangles are no surfaces.
    let mut flat = scene(vec![point(Vec3::new(4.0, 2.0, 0.0))]);
    let lit = airlight(&flat);
    add(&mut flat, vec![Vec3::new(2.0, 1.0, 0.0); 3], vec![[0, 1, 2]]);
    add(&mut flat, vec![Vec3::X, 2.0 * Vec3::X, 3.0 * Vec3::X], vec![[0, 1, 2]]);
    assert_eq!(airlight(&flat), lit);

    let no_pixels = Reference::new(&empty).unwrap();
    let never = AtomicBool::new(false);
    assert!(no_pixels.render(&empty.camera.view(0, 4), Terms::DIRECT, &|_| {}, &never).is_err());
    assert!(no_pixels.render(&empty.camera.view(4, 4), Terms::NONE, &|_| {}, &never).is_err());
    let mut broken = scene(vec![point(Vec3::new(f32::NAN, 0.0, 0.0))]);
    assert!(Reference::new(&broken).is_err());
    broken.lights.clear();
    add(&mut broken, vec![Vec3::new(f32::INFINITY, 0.0, 0.0); 3], vec![[0, 1, 2]]);
    assert!(Reference::new(&broken).is_err());
}

/// A scene of which a picture takes no time.
fn small() -> Scene {
    let mut scene = scene(vec![point(Vec3::new(4.0, 2.0, 0.5))]);
    add_box(&mut scene, Vec3::new(3.0, 0.5, 0.0), Vec3::new(3.5, 1.0, 0.4));
    scene
}

fn cached(scene: &Scene, directory: &Path, terms: Terms) -> Rendered {
    let reference = Reference::new(scene).unwrap();
    let view = scene.camera.view(16, 12);
    reference.render_cached(directory, &view, terms, &|_| {}, &AtomicBool::new(false)).unwrap()
}

fn files(directory: &Path) -> Vec<std::path::PathBuf> {
    std::fs::read_dir(directory).unwrap().map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn a_cached_picture_is_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let directory = folder.path().join("made/on/demand");
    let scene = small();
    let first = cached(&scene, &directory, Terms::DIRECT);
    assert!(!first.cached && first.cache_problem.is_none());
    let second = cached(&scene, &directory, Terms::DIRECT);
    assert_eq!(second, Rendered { cached: true, ..first.clone() });
    let path = match &files(&directory)[..] {
        [path] => path.clone(),
        other => panic!("{other:?}"),
    };

    // Cut short or with one bit wrong it is rebuilt.
    let whole = std::fs::read(&path).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    for broken in [&whole[..whole.len() / 2], &whole[..whole.len() - 1], &[], &flipped[..]] {
        std::fs::write(&path, broken).unwrap();
        let rebuilt = cached(&scene, &directory, Terms::DIRECT);
        assert!(!rebuilt.cached);
        assert_eq!(rebuilt.airlight, first.airlight);
        assert!(cached(&scene, &directory, Terms::DIRECT).cached);
    }

    // Whatever changes the picture is another entry.
    let mut others = vec![small(), small(), small(), small(), small()];
    others[0].lights = vec![point(Vec3::new(4.0, 2.0, 0.6))];
    others[1].medium.phase = Phase::isotropic();
    others[2].materials[0].k_d.x = 0.25;
    others[3].camera.fov_y = 0.81;
    add_quad(&mut others[4], Vec3::ONE, Vec3::X, Vec3::Y);
    for other in &others {
        assert!(!cached(other, &directory, Terms::DIRECT).cached);
    }
    assert!(!cached(&scene, &directory, Term::Surface.into()).cached);
    assert_eq!(files(&directory).len(), 7);
}

#[test]
fn a_cache_that_can_not_be_written_does_not_lose_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let blocked = folder.path().join("file");
    std::fs::write(&blocked, "in the way").unwrap();
    let rendered = cached(&small(), &blocked, Terms::DIRECT);
    assert!(rendered.cache_problem.is_some_and(|problem| problem.contains("file")));
    assert!(rendered.airlight.is_some());
}

#[test]
fn stopped_half_way_it_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let scene = small();
    let reference = Reference::new(&scene).unwrap();
    let view = scene.camera.view(64, 64);
    let cancel = AtomicBool::new(false);
    let stop = |fraction: f32| {
        if fraction > 0.3 {
            cancel.store(true, Ordering::Relaxed);
        }
    };
    let result = reference.render_cached(folder.path(), &view, Terms::DIRECT, &stop, &cancel);
    assert!(matches!(result, Err(Error::Cancelled)));
    assert!(files(folder.path()).is_empty());
}

#[test]
fn a_depth_buffer_says_where_rays_end() {
    let open = scene(vec![point(Vec3::new(4.0, 0.5, 0.2))]);
    // A wall behind the lamp throws its shadow on nothing that is seen.
    let mut walled = open.clone();
    add_quad(&mut walled, Vec3::new(6.0, -9.0, -9.0), Vec3::Y * 18.0, Vec3::Z * 18.0);
    let view = open.camera.view(8, 6);
    let never = AtomicBool::new(false);
    let [without, with] =
        [&open, &walled].map(|scene| render(scene, 8, 6, Term::Airlight.into()).airlight.unwrap());
    let wall = |x, y| 6.0 / view.ray_direction(x, y).x;
    let distances: Vec<f32> = (0..48).map(|i| wall(i % 8, i / 8)).collect();
    // As the wall's own depth buffer would hold it.
    for (i, distance) in (0..).zip(&distances) {
        let depth = view.depth.near / 6.0;
        near(DVec3::splat(view.distance(depth, i % 8, i / 8).into()), DVec3::splat((*distance).into()), 1e-6);
    }

    let reference = Reference::new(&open).unwrap();
    let (seen, changed) = reference.airlight_as_seen(&view, &without, &distances, &never).unwrap();
    assert_eq!(changed, 48);
    for (seen, with) in seen.pixels.iter().zip(&with.pixels) {
        near(seen.as_dvec3(), with.as_dvec3(), STORED);
    }
    assert!(seen.pixels.iter().zip(&without.pixels).all(|(seen, without)| seen.x < 0.9999 * without.x));

    // Where the buffer sees what the rays see nothing changes, and else those pixels alone.
    let reference = Reference::new(&walled).unwrap();
    let (same, changed) = reference.airlight_as_seen(&view, &with, &distances, &never).unwrap();
    assert_eq!((&same, changed), (&with, 0));
    let mut nearer = distances.clone();
    nearer[20] *= 0.5;
    nearer[30] = f32::INFINITY;
    let (other, changed) = reference.airlight_as_seen(&view, &with, &nearer, &never).unwrap();
    let different: Vec<usize> = (0..48).filter(|&i| other.pixels[i] != with.pixels[i]).collect();
    // Behind the wall there is no light, so that a ray through it gains nothing.
    assert_eq!((changed, different), (2, vec![20]));
    let stopped = reference.airlight_as_seen(&view, &with, &distances, &AtomicBool::new(true));
    assert!(matches!(stopped, Err(Error::Cancelled)));
}

#[test]
fn the_same_scene_gives_the_same_bits() {
    let scene = small();
    let [a, b] = [(); 2].map(|()| render(&scene, 32, 32, Terms::DIRECT));
    assert_eq!((a.surface, a.airlight), (b.surface, b.airlight));
    assert_eq!(a.uncertainty, b.uncertainty);
}
