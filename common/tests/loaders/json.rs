//! JSON scene files.

use std::path::Path;

use common::Light;
use common::scene::load::load;
use glam::{Vec3, vec3};

use super::{TRIANGLE, loads, notes, png, refused};

/// Refuses a scene file of this text.
#[track_caller]
fn bad(text: &str, parts: &[&str]) {
    refused(&[("bad.json", text.as_bytes()), ("a.obj", TRIANGLE), ("dark.png", b"not a picture")], parts);
}

#[test]
fn the_manuals_examples_load() {
    let manual = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/scene-format.md");
    let manual = std::fs::read_to_string(manual).expect("the manual is there");
    let examples: Vec<&str> =
        manual.split("```json\n").skip(1).map(|rest| rest.split("```").next().unwrap_or_default()).collect();
    assert_eq!(examples.len(), 2);
    let picture = png(4, 4, [200, 100, 50]);
    for example in examples {
        let files = [("scene.json", example.as_bytes()), ("model.obj", TRIANGLE), ("window.png", &picture)];
        let scene = loads(&files);
        assert_eq!(scene.lights.len(), 2);
        for track in &scene.animation {
            assert_eq!(track.problem(&scene), None);
        }
        if scene.name == "foggy-jug" {
            assert!((scene.triangle_count() as f32 / 20_000.0 - 1.0).abs() < 0.005);
            assert!((scene.medium.sigma_t() - 0.08).length() < 1e-6);
            assert!((scene.camera.fov_y.to_degrees() - 45.0).abs() < 1e-3);
            assert!(!scene.notes.iter().any(|note| note.contains("assumed")), "{:?}", scene.notes);
        } else {
            assert_eq!((scene.name.as_str(), scene.objects[0].name.as_str()), ("scene", "statue"));
            assert_eq!(scene.world_triangles()[0].positions[1], vec3(0.01, 0.5, 0.0));
            assert_eq!(scene.materials[0].exponent, 20.0);
            let Light::Spot(spot) = &scene.lights[1] else { panic!("{:?}", scene.lights[1]) };
            assert_eq!(spot.light_map.as_ref().expect("a map").texels.len(), 16);
            notes(&scene, "no camera");
        }
    }
}

#[test]
fn errors_name_the_field() {
    bad("{", &["EOF", "line 1"]);
    bad("[]", &["expected an object with `version`"]);
    bad("{}", &["version"]);
    bad(r#"{"version": 2}"#, &["version", "expected 1"]);
    bad(r#"{"version": 1} x"#, &["after the scene"]);
    bad(r#"{"version": 1, "ligths": []}"#, &["unknown field `ligths`", "expected one of"]);
    bad(&format!(r#"{{"version": 1, "{}": 0}}"#, "x\\n".repeat(10_000)), &["unknown field `x"]);
    let light = |inner: &str| format!(r#"{{"version": 1, "lights": [{{{inner}}}]}}"#);
    bad(
        &light(r#""point": {"position": [0, 0], "intensity": 1}"#),
        &["lights[0].point.position", "three numbers"],
    );
    bad(
        &light(r#""point": {"position": 3, "intensity": 1}"#),
        &["lights[0].point.position", "three numbers"],
    );
    bad(&light(r#""point": {"position": [0, 0, 0, 0], "intensity": 1}"#), &["lights[0].point.position"]);
    bad(
        &light(r#""point": {"position": [0, 0, "x"], "intensity": 1}"#),
        &["lights[0].point.position[2]", "a number"],
    );
    bad(&light(r#""point": {"position": [0, 0, 0]}"#), &["lights[0].point", "intensity"]);
    bad(&light(r#""point": {"position": [0, 0, 0], "intensity": -1}"#), &["lights[0]", "none negative"]);
    bad(
        &light(r#""point": {"position": [0, 0, 0], "intensity": 1e999}"#),
        &["lights[0].point.intensity", "out of range"],
    );
    bad(
        &light(r#""point": {"position": [0, 0, 1e39], "intensity": 1}"#),
        &["lights[0].point.position[2]", "too large"],
    );
    bad(&light(r#""point": {"position": [0, 0, 0], "intensity": NaN}"#), &["expected"]);
    bad(&light(r#""point": 5"#), &["lights[0].point", "expected an object with fields"]);
    bad(&light(r#""torch": {}"#), &["lights[0]", "unknown variant `torch`"]);
    let sun = r#""directional": {"direction": [0, 0, 0], "irradiance": 1}"#;
    bad(&light(sun), &["lights[0].directional.direction", "zero"]);
    let spot = |rest: &str| light(&format!(r#""spot": {{"position": [0, 0, 0], "intensity": 1, {rest}}}"#));
    bad(&spot(r#""outer_angle_degrees": 20"#), &["lights[0].spot", "`direction` or `target`"]);
    bad(&spot(r#""outer_angle_degrees": 120, "direction": [0, 0, 1]"#), &["lights[0]", "85°"]);
    bad(&spot(r#""outer_angle_degrees": 20, "target": [0, 0, 0]"#), &["lights[0].spot", "no direction"]);
    let map = r#""outer_angle_degrees": 20, "direction": [0, 0, 1], "light_map": "#;
    bad(
        &spot(&format!(r#"{map}"dark.png""#)),
        &["lights[0].spot.light_map", "dark.png", "PNG, JPEG or OpenEXR"],
    );
    bad(&spot(&format!(r#"{map}"none.png""#)), &["can't read", "none.png"]);
}

#[test]
fn media_phases_and_cameras_are_checked() {
    let medium = |inner: &str| format!(r#"{{"version": 1, "medium": {{{inner}}}}}"#);
    bad(&medium(r#""sigma_s": -1"#), &["medium", "sigma_s", "none negative"]);
    bad(&medium(r#""sigma_s": 1, "albedo": 0.5"#), &["medium", "no mixture"]);
    bad(&medium(""), &["medium", "sigma_t"]);
    bad(&medium(r#""sigma_t": 1, "albedo": 1.5"#), &["medium.albedo", "0 to 1"]);
    bad(&medium(r#""sigma_t": 1, "phase": "milk""#), &["medium.phase", "unknown variant `milk`"]);
    bad(&medium(r#""sigma_t": 1, "phase": {"henyey-greenstein": {"g": 1.5}}"#), &["g = 1.5"]);
    bad(&medium(r#""sigma_t": 1, "phase": {"mixture": []}"#), &["medium.phase"]);
    bad(&medium(r#""sigma_t": 1, "phase": {"mixture": [{"weight": -1, "phase": "rayleigh"}]}"#), &["weight"]);
    let camera = |inner: &str| format!(r#"{{"version": 1, "camera": {{{inner}}}}}"#);
    bad(&camera(r#""eye": [0, 0, 0], "target": [0, 0, 0]"#), &["camera", "own position"]);
    bad(&camera(r#""eye": [0, 0, 0], "target": [0, 5, 0]"#), &["camera", "`up`"]);
    bad(
        &camera(r#""eye": [0, 0, 0], "target": [0, 0, 1], "fov_y_degrees": 200"#),
        &["camera", "field of view"],
    );

    let text = medium(r#""sigma_t": 0.5, "albedo": 0.8, "phase": {"cornette-shanks": {"g": -0.3}}"#);
    let scene = loads(&[("a.json", text.as_bytes())]);
    assert!((scene.medium.sigma_s.x - 0.4).abs() < 1e-6 && (scene.medium.sigma_a.x - 0.1).abs() < 1e-6);
    let dark = loads(&[("a.json", br#"{"version": 1, "lights": []}"#)]);
    assert!(dark.lights.is_empty(), "no light is what was asked for");
}

#[test]
fn objects_are_placed_and_their_troubles_told() {
    let object = |inner: &str| format!(r#"{{"version": 1, "objects": [{{{inner}}}]}}"#);
    bad(&object(""), &["objects[0]", "`file` or `builtin`"]);
    bad(&object(r#""file": "a.obj", "builtin": "amphora""#), &["objects[0]", "either"]);
    bad(&object(r#""file": "a.obj", "triangles": 5"#), &["objects[0].triangles"]);
    bad(&object(r#""file": "none.obj""#), &["objects[0].file", "none.obj"]);
    bad(&object(r#""file": "bad.json""#), &["objects[0].file", ".glb"]);
    bad(&object(r#""builtin": "no-such-scene""#), &["objects[0].builtin", "no-such-scene"]);
    bad(&object(r#""file": "a.obj", "scale": 0"#), &["objects[0].scale", "above 0"]);
    bad(&object(r#""file": "a.obj", "scale": 1e-30"#), &["objects[0]"]);
    let turn = r#""file": "a.obj", "rotate_degrees": {"axis": [0, 0, 0], "angle": 1}"#;
    bad(&object(turn), &["objects[0].rotate_degrees.axis"]);
    bad(
        &object(r#""file": "a.obj", "material": {"k_d": 0.9, "k_s": 0.2}"#),
        &["objects[0].material", "at most 1"],
    );
    bad(&object(r#""file": "a.obj", "translate": [1e30, 0, 0]"#), &["1e9"]);

    let turn = r#""file": "a.obj", "scale": [2, 1, 1], "rotate_degrees": {"axis": [0, 0, 9], "angle": 90}, "translate": [5, 0, 0]"#;
    let scene = loads(&[("a.json", object(turn).as_bytes()), ("a.obj", TRIANGLE)]);
    assert!((scene.world_triangles()[0].positions[1] - vec3(5.0, 2.0, 0.0)).length() < 1e-5);
}

#[test]
fn parts_are_put_together() {
    let text = br#"{"version": 1, "objects": [
        {"file": "a.obj", "material": {"name": "red", "k_d": [0.7, 0, 0]}},
        {"file": "a.obj", "name": "second", "translate": [0, 0, 1]},
        {"builtin": "amphora", "triangles": 5000},
        {"builtin": "knife-edge"}
    ]}"#;
    let scene = loads(&[("a.json", text), ("a.obj", TRIANGLE)]);
    let jug = load("amphora", Some(5000)).expect("built-in");
    let edge = load("knife-edge", None).expect("built-in");
    assert_eq!(scene.triangle_count(), 2 + jug.triangle_count() + edge.triangle_count());
    assert_eq!(scene.lights, [jug.lights.clone(), edge.lights.clone()].concat());
    assert_eq!((scene.camera, &scene.medium), (jug.camera, &jug.medium));
    // Every triangle still has its own material.
    let triangles = scene.world_triangles();
    let name = |index: usize| scene.materials[triangles[index].material as usize].name.as_str();
    assert_eq!((name(0), name(1)), ("red", "default"));
    let own = jug.world_triangles();
    for (index, triangle) in own.iter().enumerate() {
        assert_eq!(name(2 + index), jug.materials[triangle.material as usize].name);
    }

    let lit = r#"{"version": 1, "objects": [{"builtin": "amphora", "translate": [3, 0, 0]}]}"#;
    let scene = loads(&[("a.json", lit.as_bytes())]);
    let jug = load("amphora", None).expect("built-in");
    for (moved, light) in scene.lights.iter().zip(&jug.lights) {
        let shift = moved.position().zip(light.position()).map(|(a, b)| a - b);
        assert!(shift.is_none_or(|shift| (shift - 3.0 * Vec3::X).length() < 1e-5), "lights move along");
    }
}

#[test]
fn tracks_are_checked() {
    let track = |target: &str, motion: &str| {
        format!(
            r#"{{"version": 1, "lights": [], "animation": [{{"target": {target}, "motion": {motion}}}]}}"#
        )
    };
    let orbit = r#"{"orbit": {"period": 3}}"#;
    bad(&track(r#"{"light_position": {"light": 0}}"#, orbit), &["animation[0]", "light 0"]);
    bad(&track(r#"{"object_translation": {"object": "pen"}}"#, orbit), &["animation[0]", "`pen`"]);
    bad(&track(r#""camera_eye""#, r#"{"orbit": {"period": 0}}"#), &["animation[0]", "period"]);
    bad(&track(r#""camera_eye""#, r#"{"orbit": {"period": 1e39}}"#), &["animation[0]"]);
    bad(&track(r#""camera_eye""#, r#"{"fly": {}}"#), &["animation[0].motion", "fly"]);
}

/// A voxel file of 2×1×1 values.
fn voxels(values: [f32; 2]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    bytes.extend([1i32, 2, 1, 1, 1].into_iter().flat_map(i32::to_le_bytes));
    bytes.extend([-1.0f32, 0.0, 0.0, 1.0, 2.0, 3.0].into_iter().flat_map(f32::to_le_bytes));
    bytes.extend(values.into_iter().flat_map(f32::to_le_bytes));
    bytes
}

#[test]
fn clouds_and_skies_are_read() {
    let shaped = |shape: &str| {
        format!(
            r#"{{"version": 1, "cloud": {{"shape": {shape}, "sigma_t": 2, "albedo": [0.9, 0.8, 0.7],
            "phase": {{"cornette-shanks": {{"g": 0.5}}}}, "emission": 3}},
            "sky": {{"radiance": [1, 2, 3]}}}}"#
        )
    };
    let shapes = [
        r#"{"slab": {"low": 0, "high": 2}}"#,
        r#"{"sphere": {"centre": [0, 1, 0], "radius": 1}}"#,
        r#"{"two-density": {"centre": [0, 1, 0], "core": 0.5, "radius": 1, "shell": 0.2}}"#,
        r#"{"cumulus": {"base": [0, 0, 0], "size": 100, "seed": 4294967295}}"#,
        r#"{"voxels": {"file": "a.vol"}}"#,
    ];
    for shape in shapes {
        let scene = loads(&[("a.json", shaped(shape).as_bytes()), ("a.vol", &voxels([4.0, 1.0]))]);
        let cloud = scene.cloud.as_ref().expect("a cloud");
        assert_eq!(cloud.albedo, vec3(0.9, 0.8, 0.7));
        assert_eq!(scene.sky, common::Sky::Constant(vec3(1.0, 2.0, 3.0)));
        assert_eq!(scene.medium, common::Medium::vacuum(), "a cloud hangs in clear air");
        let common::Density::Grid(grid) = &cloud.density else {
            assert_eq!((cloud.sigma_t, cloud.emission), (2.0, Vec3::splat(3.0)));
            continue;
        };
        assert_eq!((cloud.sigma_t, cloud.emission), (8.0, Vec3::splat(12.0)), "of the largest value");
        assert_eq!(
            (grid.values.as_slice(), grid.low, grid.high),
            (&[1.0, 0.25][..], vec3(-1.0, 0.0, 0.0), vec3(1.0, 2.0, 3.0))
        );
    }
    let bad = |text: &str, file: &[u8], parts: &[&str]| {
        refused(&[("bad.json", text.as_bytes()), ("a.vol", file), ("dark.png", b"no")], parts);
    };
    let whole = voxels([1.0, 0.0]);
    let with = |at: usize, byte: u8| {
        let mut bytes = whole.clone();
        bytes[at] = byte;
        bytes
    };
    let text = shaped(shapes[4]);
    bad(&text, &whole[..20], &["cloud.shape.voxels.file", "a.vol", "header"]);
    bad(&text, &whole[..52], &["a.vol", "4 bytes of values for 2 voxels"]);
    bad(&text, &with(0, b'X'), &["a.vol", "expected `VOL`"]);
    bad(&text, &with(4, 3), &["encoding 3"]);
    bad(&text, &with(11, 0x7f), &["voxels; expected 1 to"]);
    bad(&text, &with(11, 0xff), &["voxels; expected 1 to"]);
    bad(&text, &voxels([f32::NAN, 1.0]), &["NaN"]);
    bad(&text, &voxels([-1.0, 1.0]), &["none negative"]);
    bad(&text, &voxels([0.0, 0.0]), &["is empty"]);
    bad(&shaped(r#"{"voxels": {"file": "none.vol"}}"#), &whole, &["cloud.shape.voxels.file", "none.vol"]);
    bad(&shaped(r#"{"ball": {}}"#), &whole, &["cloud.shape", "unknown variant `ball`"]);
    bad(&shaped(r#"{"slab": {"low": 2, "high": 1}}"#), &whole, &["cloud", "lower one first"]);
    bad(&shaped(r#"{"sphere": {"centre": [0, 0, 0], "radius": -1}}"#), &whole, &["cloud", "radius"]);
    bad(&shaped(r#"{"cumulus": {"base": [0, 0, 0], "size": 0}}"#), &whole, &["cumulus of no size"]);
    bad(r#"{"version": 1, "sky": {"radiance": -1}}"#, &whole, &["sky", "none negative"]);
    bad(
        r#"{"version": 1, "sky": {"picture": "dark.png"}}"#,
        &whole,
        &["sky.picture", "the sky's picture", "dark.png"],
    );
}
