//! What the peers draw, against the reference and against each other.

use std::sync::Arc;

use common::gpu::bench::{context, eval_wgsl, scenes};
use common::gpu::shadow_projection;
use common::image::Image;
use common::light::LightMap;
use common::{Light, Lobe, Medium, Phase, PointLight, Scene, shader};
use glam::{Vec3, Vec4};

use crate::measure::{Drawn, Stage};
use crate::techniques::find_one;

const SIZE: (u32, u32) = (48, 40);

/// The airlight of a method.
fn drawn(scene: &Scene, method: &str) -> Image {
    let mut stage = Stage::new(context(), scene, SIZE, 256).unwrap();
    let method = find_one(method).unwrap();
    let mut technique = method.make(&context().device, &context().queue, stage.format(), SIZE).unwrap();
    let image = stage.picture(Some(technique.as_mut()), 0.0, Drawn::Airlight).unwrap();
    scenes::assert_sane(&image, &method.name);
    image
}

fn reference(scene: &Scene) -> Image {
    scenes::reference(scene, &scene.camera.view(SIZE.0, SIZE.1))
}

fn error(image: &Image, reference: &Image) -> f64 {
    scenes::errors(image, reference).0
}

/// A spot that throws a picture.
fn tinted_spot() -> Light {
    let Light::Spot(mut spot) = scenes::spot(0.3, 0.5) else { unreachable!("a spot is a spot") };
    let texels = (0..16).map(|i| Vec3::new(i as f32 / 15.0, 0.4, 1.0 - i as f32 / 30.0)).collect();
    spot.light_map = Some(Arc::new(LightMap { width: 4, height: 4, texels }));
    Light::Spot(spot)
}

/// One light of each kind, a spot with a soft edge.
fn lights() -> [Light; 4] {
    [scenes::point(), scenes::spot(0.3, 0.5), tinted_spot(), scenes::sun()]
}

/// A coloured medium with two lobes.
fn coloured(scene: &mut Scene) {
    let sigma_s = Vec3::new(0.05, 0.08, 0.12);
    let phase = Phase::mixture(vec![
        (Vec3::new(0.2, 0.3, 0.5), Lobe::Rayleigh),
        (Vec3::ONE, Lobe::HenyeyGreenstein { g: 0.5 }),
    ]);
    scene.medium = Medium { sigma_s, sigma_a: 0.1 * sigma_s, phase };
}

#[test]
fn faces_of_the_cube_need_no_matrix() {
    let light = Light::Point(PointLight { position: Vec3::ZERO, intensity: Vec3::ONE });
    let layers = shadow_projection(&light, None, 8).layers;
    let mut state = 1;
    let mut uniform = || {
        state = (1_103_515_245 * state + 12_345) & 0x7fff_ffff_u64;
        state as f32 / 2f32.powi(30) - 1.0
    };
    let inputs: Vec<Vec4> = (0..300).map(|_| Vec4::new(uniform(), uniform(), uniform(), 0.0)).collect();
    let chunks = [shader::LIGHT, shader::SHADOW, shader::RAY];
    let eval =
        |expression| eval_wgsl(context(), &chunks, &[], "let at = cube_face(x.xyz);", expression, &inputs);
    let frames = eval("vec4f(at.frame, f32(at.face))");
    let faces = eval("vec4f(f32(shadow_face(x.xyz)))");
    for ((input, frame), face) in inputs.iter().zip(frames).zip(faces) {
        assert_eq!(frame.w, face.x, "{input}");
        let (away, layer) = (input.truncate(), layers[face.x as usize]);
        let expected = Vec3::new(away.dot(layer.right), away.dot(layer.up), away.dot(layer.forward));
        assert!((frame.truncate() - expected).length() < 1e-6, "{input}: {frame}, not {expected}");
    }
}

#[test]
fn marches_come_to_the_reference_for_every_kind_of_light() {
    for light in lights() {
        let mut scene = scenes::boxes(light.clone(), 0.15);
        coloured(&mut scene);
        let reference = reference(&scene);
        // What is left is the shadow map's 256 texels on a side, and beside a point light equal steps of distance.
        for (method, bound) in [("ray-march-512", 0.1), ("ray-march-equiangular-512", 0.04)] {
            let error = error(&drawn(&scene, method), &reference);
            assert!(error < bound, "{}, {method}: {error}", light.kind());
        }
    }
}

#[test]
fn a_march_with_offsets_comes_to_the_march() {
    let scene = scenes::boxes(scenes::spot(0.4, 0.5), 0.15);
    for technique in ["ray-march", "ray-march-equiangular"] {
        let exact = drawn(&scene, &format!("{technique}-2048"));
        let errors = [8, 64, 512].map(|n| error(&drawn(&scene, &format!("{technique}-offset-{n}")), &exact));
        assert!(errors[1] < 0.4 * errors[0] && errors[2] < 0.4 * errors[1], "{technique}: {errors:?}");
        assert!(errors[2] < 0.01, "{technique}: {errors:?}");
        // It is another picture than without offsets.
        let plain = error(&drawn(&scene, &format!("{technique}-8")), &exact);
        assert!((plain / errors[0] - 1.0).abs() > 1e-3, "{technique}: {plain}");
    }
}

#[test]
fn froxels_come_to_the_reference_as_the_grid_is_refined() {
    for light in lights() {
        let mut scene = scenes::boxes(light.clone(), 0.15);
        coloured(&mut scene);
        let reference = reference(&scene);
        let errors = ["froxels-16x16", "froxels-4x64", "froxels-1x256"]
            .map(|method| error(&drawn(&scene, method), &reference));
        let name = light.kind();
        assert!(errors[1] < 0.8 * errors[0] && errors[2] < 0.8 * errors[1], "{name}: {errors:?}");
        // Point and spot are in the picture, where radiance rises as the inverse of the distance from them.
        let bound = if name == "directional" { 0.08 } else { 0.35 };
        assert!(errors[2] < bound, "{name}: {errors:?}");
    }
}

#[test]
fn froxels_hold_any_unit_of_light() {
    let scene = scenes::boxes(scenes::point(), 0.15);
    let image = drawn(&scene, "froxels-8x32");
    for factor in [1e-6f32, 1e6] {
        let mut other = scene.clone();
        let Light::Point(light) = &mut other.lights[0] else { unreachable!("a point is a point") };
        light.intensity *= factor;
        let mut scaled = drawn(&other, "froxels-8x32");
        scaled.pixels.iter_mut().for_each(|pixel| *pixel /= factor);
        assert!(error(&scaled, &image) < 1e-4, "{factor}");
    }
}

#[test]
fn the_floor_is_the_airlight_where_nothing_throws_a_shadow() {
    for light in lights() {
        // Inside a box, which is convex.
        let mut scene = scenes::boxes(light.clone(), 0.15);
        scene.objects = vec![scenes::cuboid(Vec3::new(-6.0, -1.0, -6.0), Vec3::new(6.0, 5.0, 9.0))];
        for colour in [false, true] {
            if colour {
                coloured(&mut scene);
            }
            // A sun from outside would be shut out; over a floor it is not.
            if light.kind() == "directional" {
                scene.objects = vec![scenes::cuboid(Vec3::new(-6.0, -1.0, -6.0), Vec3::new(6.0, 0.0, 9.0))];
            }
            let reference = reference(&scene);
            let found = error(&drawn(&scene, "unshadowed"), &reference);
            assert!(found < 0.012, "{}, {colour}: {found}", light.kind());
        }
    }
    // All of them at once, more than one draw holds.
    let mut scene = scenes::boxes(scenes::sun(), 0.15);
    scene.objects.clear();
    scene.lights = lights().into_iter().cycle().take(28).collect();
    let one = {
        let mut one = scene.clone();
        one.lights = lights().into();
        drawn(&one, "unshadowed")
    };
    let mut all = drawn(&scene, "unshadowed");
    all.pixels.iter_mut().for_each(|pixel| *pixel /= 7.0);
    assert!(error(&all, &one) < 1e-5);
}
