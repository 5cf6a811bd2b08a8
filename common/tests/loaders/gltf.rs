//! glTF and GLB files.

use common::Light;
use glam::{Vec3, vec3};
use serde_json::{Value, json};

use super::{load_real, loads, notes, png, refused};

/// Three vertices, three more that make a second triangle of a strip or fan, and indices.
fn buffer() -> Vec<u8> {
    let positions: [f32; 12] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.];
    let mut bytes: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend([0u8, 1, 2, 3]);
    bytes.extend([0u16, 1, 2, 3].iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0u32, 1, 2, 3].iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

pub(super) fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().enumerate().fold(0u32, |word, (i, &b)| word | u32::from(b) << (16 - 8 * i));
        for digit in 0..4 {
            let value = word >> (18 - 6 * digit) & 63;
            text.push(if digit <= chunk.len() { char::from(DIGITS[value as usize]) } else { '=' });
        }
    }
    text
}

/// A document of one triangle, without indices.
fn document() -> Value {
    json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "thing" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "buffers": [{ "byteLength": 76, "uri": format!("data:application/octet-stream;base64,{}", base64(&buffer())) }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 },
            { "buffer": 0, "byteOffset": 48, "byteLength": 4 },
            { "buffer": 0, "byteOffset": 52, "byteLength": 8 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 16 }
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "count": 4, "type": "SCALAR" },
            { "bufferView": 2, "componentType": 5123, "count": 4, "type": "SCALAR" },
            { "bufferView": 3, "componentType": 5125, "count": 4, "type": "SCALAR" }
        ]
    })
}

/// The document with a value put at a JSON pointer; a key that is not there yet is added.
fn with(pointer: &str, value: Value) -> Value {
    edited(document(), pointer, value)
}

fn edited(mut document: Value, pointer: &str, value: Value) -> Value {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    match document.pointer_mut(parent).expect("parent exists") {
        Value::Object(map) => drop(map.insert(key.into(), value)),
        Value::Array(list) => list[key.parse::<usize>().expect("an index")] = value,
        _ => panic!("{pointer}"),
    }
    document
}

fn bytes(document: &Value) -> Vec<u8> {
    document.to_string().into_bytes()
}

fn glb(document: &Value, blob: &[u8]) -> Vec<u8> {
    let mut text = bytes(document);
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let word = |n: usize| (n as u32).to_le_bytes();
    out.extend([word(2), word(12 + 8 + text.len() + 8 + blob.len()), word(text.len()), *b"JSON"].concat());
    out.extend(&text);
    out.extend([word(blob.len()), *b"BIN\0"].concat());
    out.extend(blob);
    out
}

#[track_caller]
fn bad(document: &Value, parts: &[&str]) {
    refused(&[("bad.gltf", &bytes(document))], parts);
}

#[test]
fn primitive_modes_and_index_types() {
    for indices in [2, 3, 4] {
        for (mode, triangles) in [(4, 1), (5, 2), (6, 2)] {
            let primitive = json!({ "attributes": { "POSITION": 1 }, "indices": indices, "mode": mode });
            let scene = loads(&[("a.gltf", &bytes(&with("/meshes/0/primitives/0", primitive)))]);
            assert_eq!(scene.triangle_count(), triangles);
            let facing = scene.world_triangles().iter().filter(|t| t.normals[0] == Vec3::Z).count();
            assert_eq!(facing, if mode == 6 { 1 } else { triangles }, "a strip keeps its winding");
        }
    }
    let unlit = with("/extensionsUsed", json!(["KHR_lights_punctual", "KHR_materials_unlit"]));
    notes(&loads(&[("a.gltf", &bytes(&unlit))]), "not used: `KHR_materials_unlit`");
    let both = json!([{ "attributes": { "POSITION": 0 } }, { "attributes": { "POSITION": 0 }, "mode": 1 }]);
    let scene = loads(&[("a.gltf", &bytes(&with("/meshes/0/primitives", both)))]);
    notes(&scene, "1 primitives of points or lines");
    let lines = json!([{ "attributes": { "POSITION": 0 }, "mode": 1 }]);
    bad(&with("/meshes/0/primitives", lines), &["nothing but points and lines"]);
}

#[test]
fn containers_and_buffers() {
    let mut document = document();
    document["buffers"][0].as_object_mut().expect("object").remove("uri");
    let whole = glb(&document, &buffer());
    assert_eq!(loads(&[("a.glb", &whole)]).triangle_count(), 1);
    for (length, part) in
        [(3, "line 1"), (8, "ends at byte"), (16, "bytes"), (whole.len() - 1, "header says")]
    {
        refused(&[("a.glb", &whole[..length])], &[part]);
    }
    let patched = |at: usize, value: u32| {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    refused(&[("a.glb", &patched(4, 1))], &["version 1; expected 2"]);
    refused(&[("a.glb", &patched(8, u32::MAX))], &["header says"]);
    refused(&[("a.glb", &patched(12, u32::MAX))], &["chunk"]);
    refused(&[("a.glb", &patched(8, 0))], &["buffers[0]", "binary chunk"]);
    refused(&[("a.glb", &glb(&document, &buffer()[..60]))], &["buffers[0]", "60 bytes", "76"]);

    document["buffers"][0]["uri"] = json!("my%20data.bin");
    let text = bytes(&document);
    assert_eq!(loads(&[("a.gltf", &text), ("my data.bin", &buffer())]).triangle_count(), 1);
    refused(&[("a.gltf", &text)], &["buffers[0]", "my data.bin"]);
    bad(&with("/buffers/0/uri", json!("data:;base64,!!!")), &["buffers[0]", "base64"]);
    bad(&with("/buffers/0/uri", json!("data:text/plain,abc")), &["base64"]);
    bad(&with("/buffers/0/uri", json!("https://example.org/a.bin")), &["not a file"]);
}

#[test]
fn offsets_and_indices_out_of_range_are_refused() {
    let huge = json!(u64::MAX);
    bad(&with("/bufferViews/0/byteLength", huge.clone()), &["bufferViews[0]"]);
    bad(&with("/bufferViews/0/byteOffset", huge.clone()), &["bufferViews[0]"]);
    bad(&with("/bufferViews/0/byteOffset", json!(70)), &["bufferViews[0]"]);
    bad(&with("/bufferViews/0/byteStride", json!(40)), &["accessors[0]", "do not fit"]);
    bad(&with("/bufferViews/0/buffer", json!(7)), &["buffer 7"]);
    bad(&with("/accessors/0/count", json!(5)), &["accessors[0]", "do not fit"]);
    bad(&with("/accessors/0/count", huge.clone()), &["accessors[0]"]);
    bad(&with("/accessors/0/byteOffset", huge), &["accessors[0]"]);
    bad(&with("/accessors/0/bufferView", json!(9)), &["bufferViews[9]"]);
    bad(&with("/accessors/0/componentType", json!(1)), &["accessors[0].componentType"]);
    bad(&with("/accessors/0/type", json!("VEC2")), &["accessors[0].type", "VEC3"]);
    bad(&with("/meshes/0/primitives/0/attributes", json!({ "POSITION": 99 })), &["accessors[99]"]);
    bad(&with("/meshes/0/primitives/0/attributes", json!({})), &["POSITION"]);
    bad(&with("/meshes/0/primitives/0/mode", json!(9)), &["mode"]);
    bad(&with("/meshes/0/primitives/0/material", json!(3)), &["material 3"]);
    bad(&with("/meshes/0/primitives/0/indices", json!(0)), &["accessors[0].type", "SCALAR"]);
    // Index 3 of three vertices, in the second triangle of a strip.
    let strip = json!({ "attributes": { "POSITION": 0 }, "indices": 2, "mode": 5 });
    bad(&with("/meshes/0/primitives/0", strip), &["indices", "index 3", "less than 3"]);
    bad(&with("/scene", json!(4)), &["scene 4"]);
    bad(&with("/scenes/0/nodes", json!([8])), &["nodes[8]"]);
    bad(&with("/nodes/0/mesh", json!(8)), &["meshes[8]"]);
    bad(&with("/nodes/0/camera", json!(0)), &["cameras[0]"]);
    bad(&with("/asset/version", json!("1.0")), &["asset", "2.0"]);
    bad(&with("/extensionsRequired", json!(["EXT_meshopt_compression"])), &["EXT_meshopt_compression"]);
    let empty = json!({ "componentType": 5126, "count": 4_000_000_000u64, "type": "VEC3" });
    bad(&with("/accessors/0", empty), &["more than are read"]);
}

#[test]
fn sparse_and_normalised_accessors() {
    let sparse = json!({
        "count": 1,
        "indices": { "bufferView": 1, "byteOffset": 2, "componentType": 5121 },
        "values": { "bufferView": 0, "byteOffset": 12 }
    });
    let scene = loads(&[("a.gltf", &bytes(&with("/accessors/0/sparse", sparse.clone())))]);
    assert_eq!(scene.world_triangles()[0].positions, [Vec3::ZERO, Vec3::X, Vec3::X]);
    bad(
        &with("/accessors/0/sparse", edited(sparse, "/indices/byteOffset", json!(3))),
        &["sparse", "element 3 of 3"],
    );

    let quantised =
        json!({ "bufferView": 1, "componentType": 5121, "normalized": true, "count": 1, "type": "VEC3" });
    let document = with("/accessors/0", quantised);
    let document = edited(
        document,
        "/accessors/3",
        json!({ "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR" }),
    );
    let document = edited(document, "/extensionsRequired", json!(["KHR_mesh_quantization"]));
    let indexed = json!({ "attributes": { "POSITION": 0 }, "indices": 3 });
    bad(&edited(document, "/meshes/0/primitives/0", indexed), &["index 2", "less than 1"]);
}

#[test]
fn hierarchies_place_objects_and_never_hang() {
    let nodes = json!([
        { "children": [1], "translation": [10, 0, 0] },
        { "mesh": 0, "rotation": [0, 0, 2, 2], "scale": [2, 1, 1] }
    ]);
    let scene = loads(&[("a.gltf", &bytes(&with("/nodes", nodes)))]);
    let corner = scene.world_triangles()[0].positions[1];
    assert!((corner - vec3(10.0, 2.0, 0.0)).length() < 1e-5, "{corner}");

    let mirrored = json!([{ "mesh": 0, "scale": [-1, 1, 1] }]);
    let scene = loads(&[("a.gltf", &bytes(&with("/nodes", mirrored)))]);
    assert_eq!(scene.world_triangles()[0].normals[0], Vec3::Z, "a mirror does not turn inside out");

    bad(&with("/nodes", json!([{ "children": [0], "mesh": 0 }])), &["nodes[0]", "tree"]);
    bad(&with("/nodes", json!([{ "children": [1] }, { "children": [0] }])), &["nodes[0]", "tree"]);
    let flat = json!([{ "children": [1], "mesh": 0 }, { "name": "flat", "mesh": 0, "scale": [1, 0, 1] }]);
    notes(&loads(&[("a.gltf", &bytes(&with("/nodes", flat)))]), "`flat`");
    let far = json!([{ "mesh": 0, "translation": [1e30, 0, 0] }]);
    bad(&with("/nodes", far), &["1e9"]);

    // Deep enough to overflow any thread's stack, were it walked by recursion.
    let count = 200_000;
    let mut chain: Vec<Value> = (1..count).map(|next| json!({ "children": [next] })).collect();
    chain.push(json!({ "mesh": 0 }));
    assert_eq!(loads(&[("a.gltf", &bytes(&with("/nodes", json!(chain))))]).triangle_count(), 1);
}

#[test]
fn lights_and_cameras() {
    let turned = std::f32::consts::FRAC_1_SQRT_2;
    let nodes = json!([
        { "mesh": 0 },
        { "camera": 0, "translation": [0, 1, 5] },
        { "translation": [1, 2, 3], "rotation": [-turned, 0, 0, turned], "extensions": { "KHR_lights_punctual": { "light": 0 } } },
        { "extensions": { "KHR_lights_punctual": { "light": 1 } } },
        { "extensions": { "KHR_lights_punctual": { "light": 2 } } }
    ]);
    let lights = json!([
        { "type": "spot", "color": [1, 0.5, 0], "intensity": 10, "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.4 } },
        { "type": "directional", "intensity": 3, "range": 5 },
        { "type": "point" }
    ]);
    let document = with("/nodes", nodes);
    let document = edited(document, "/scenes/0/nodes", json!([0, 1, 2, 3, 4]));
    let document = edited(document, "/extensions", json!({ "KHR_lights_punctual": { "lights": lights } }));
    let camera = json!({ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } });
    let document = edited(document, "/cameras", json!([camera]));
    let scene = loads(&[("a.gltf", &bytes(&document))]);
    assert_eq!((scene.camera.eye, scene.camera.fov_y), (vec3(0.0, 1.0, 5.0), 0.7));
    assert!((scene.camera.basis().2 - Vec3::NEG_Z).length() < 1e-6);
    let [Light::Spot(spot), Light::Directional(sun), Light::Point(point)] = &scene.lights[..] else {
        panic!("{:?}", scene.lights);
    };
    assert!((spot.direction - Vec3::NEG_Y).length() < 1e-5, "{}", spot.direction);
    assert_eq!((spot.position, spot.intensity), (vec3(1.0, 2.0, 3.0), vec3(10.0, 5.0, 0.0)));
    assert_eq!((spot.inner_angle, spot.outer_angle), (0.1, 0.4));
    assert_eq!((sun.direction, sun.irradiance), (Vec3::NEG_Z, Vec3::splat(3.0)));
    assert_eq!(point.intensity, Vec3::ONE);
    notes(&scene, "candela");
    notes(&scene, "ranges");

    let place = "/extensions/KHR_lights_punctual/lights/2";
    let lights = "KHR_lights_punctual.lights[2]";
    bad(
        &edited(document.clone(), place, json!({ "type": "point", "intensity": -1 })),
        &[lights, "none negative"],
    );
    bad(&edited(document.clone(), place, json!({ "type": "torch" })), &[lights]);
    let spot = json!({ "type": "spot", "spot": { "innerConeAngle": -1 } });
    bad(&edited(document.clone(), place, spot), &[lights, "half angles"]);
    bad(&edited(document.clone(), "/cameras/0/perspective/yfov", json!(9)), &["cameras[0]", "field of view"]);
    let flat =
        json!({ "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "zfar": 9, "znear": 0 } });
    notes(&loads(&[("a.gltf", &bytes(&edited(document, "/cameras/0", flat)))]), "orthographic");
}

#[test]
fn materials_keep_their_energy() {
    let pbr = json!({ "baseColorFactor": [0.8, 0.4, -0.5, 1], "metallicFactor": 0.25, "roughnessFactor": 0.5, "baseColorTexture": { "index": 0 } });
    let document = with(
        "/materials",
        json!([{ "name": "m", "pbrMetallicRoughness": pbr, "alphaMode": "BLEND", "emissiveFactor": [1, 0, 0] }]),
    );
    let document = edited(document, "/textures", json!([{ "source": 0 }]));
    let document = edited(document, "/meshes/0/primitives/0/material", json!(0));
    let document = edited(document, "/images", json!([{ "uri": "a.png" }]));
    let scene = loads(&[("a.gltf", &bytes(&document)), ("a.png", &png(2, 2, [255, 188, 255]))]);
    let m = &scene.materials[0];
    assert!((m.k_d.x - 0.6).abs() < 1e-3 && (m.k_s.x - 0.2).abs() < 1e-3, "{m:?}");
    assert!((m.k_d.y - 0.3 * 0.5029).abs() < 1e-3, "{m:?}");
    assert!((m.exponent - 30.0).abs() < 1e-3, "2/0.5⁴ − 2: {}", m.exponent);
    assert!((m.k_d + m.k_s).max_element() <= 1.0 + 1e-6);
    for part in ["outside 0 to 1", "mean", "opaque", "emit"] {
        notes(&scene, part);
    }
    let without = loads(&[("a.gltf", &bytes(&document))]);
    notes(&without, "textures could not be used in material `m: ");
}

#[test]
fn real_files_agree_in_all_their_forms() {
    let folder = "loader_tests_gltf/test/testfiles/gltf";
    for (name, triangles) in
        [("Box", 12), ("BoxInterleaved", 12), ("BoxTextured", 12), ("OrientationTest", 524)]
    {
        for (form, extension) in [("glTF", "gltf"), ("glTF-Binary", "glb"), ("glTF-Embedded", "gltf")] {
            let Some(scene) = load_real(&format!("{folder}/{name}/{form}/{name}.{extension}")) else {
                return;
            };
            assert_eq!(scene.triangle_count(), triangles, "{name} {form}");
        }
    }
}
