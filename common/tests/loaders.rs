//! Loading real files of other people's making, and bad files of our own.
#![cfg(feature = "files")]

#[path = "loaders/gltf.rs"]
mod gltf;
#[path = "loaders/json.rs"]
mod json;

use std::fs;
use std::path::{Path, PathBuf};

use common::Scene;
use common::scene::load::load;
use glam::Vec3;

/// The folder of real models, or nothing (said aloud) where it is not.
fn real_models() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: {} is not here", folder.display());
    None
}

fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(folder)
        .expect("folder can be listed")
        .map(|entry| entry.expect("entry").path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files_below(&path, found);
        } else if path.extension().is_some_and(|e| ["obj", "gltf", "glb"].iter().any(|known| e == *known)) {
            found.push(path);
        }
    }
}

/// A folder with files of these names and contents.
fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    for (name, content) in files {
        fs::write(folder.path().join(name), content).expect("file can be written");
    }
    folder
}

/// Loads the first of these files.
fn load_files(files: &[(&str, &[u8])]) -> Result<Scene, String> {
    let folder = folder(files);
    let path = folder.path().join(files[0].0);
    load(path.to_str().expect("UTF-8"), None).map_err(|error| error.to_string())
}

#[track_caller]
fn loads(files: &[(&str, &[u8])]) -> Scene {
    let scene = load_files(files).expect("loads");
    assert_eq!(scene.problem(), None);
    assert!(scene.world_triangles().iter().all(|t| t.normals.iter().all(|n| n.is_finite())));
    scene
}

/// The file is refused in one sentence with its name and all of `parts`.
#[track_caller]
fn refused(files: &[(&str, &[u8])], parts: &[&str]) {
    let message = load_files(files).err().unwrap_or_else(|| panic!("{:?} was not refused", files[0].0));
    for part in parts.iter().chain([&files[0].0]) {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
    assert!(
        !message.contains('\n') && !message.ends_with('.') && message.len() < 600,
        "one sentence: {message}"
    );
}

#[track_caller]
fn notes(scene: &Scene, part: &str) {
    assert!(
        scene.notes.iter().any(|note| note.contains(part)),
        "no note with `{part}` in {:#?}",
        scene.notes
    );
}

const TRIANGLE: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A PNG of one colour.
fn png(width: u32, height: u32, colour: [u8; 3]) -> Vec<u8> {
    let picture = image::RgbImage::from_pixel(width, height, image::Rgb(colour));
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).expect("PNG can be encoded");
    bytes.into_inner()
}

// What is asked for.

#[test]
fn names_that_are_neither_file_nor_scene_are_refused() {
    for (name, part) in
        [("no-such-scene", "cathedral"), ("no/such.obj", "can't read no/such.obj"), ("", "no file")]
    {
        let message = load(name, None).expect_err("refused").to_string();
        assert!(message.contains(part), "{message}");
    }
    refused(&[("picture.png", b"x")], &["a file of another kind", ".gltf"]);
    let empty = folder(&[]);
    assert!(
        load(empty.path().to_str().expect("UTF-8"), None)
            .expect_err("refused")
            .to_string()
            .contains("a folder")
    );
    assert_eq!(load("empty", None).expect("a built-in scene").triangle_count(), 0);
    assert!(load("empty", Some(5)).expect_err("refused").to_string().contains("empty"));
}

#[test]
fn extensions_count_in_any_case() {
    assert_eq!(loads(&[("A.OBJ", TRIANGLE)]).triangle_count(), 1);
}

#[test]
fn binary_garbage_and_nothing_are_refused_as_any_kind() {
    let mut state = 1u32;
    let mut garbage = vec![0u8; 5000];
    for byte in &mut garbage {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        *byte = (state >> 24) as u8;
    }
    for name in ["a.obj", "a.gltf", "a.glb", "a.json"] {
        refused(&[(name, &garbage)], &["expected"]);
        refused(&[(name, b"")], &[]);
        refused(&[(name, &[0; 100])], &[]);
    }
}

#[cfg(unix)]
#[test]
fn devices_are_not_read() {
    let folder = folder(&[]);
    let path = folder.path().join("endless.obj");
    std::os::unix::fs::symlink("/dev/zero", &path).expect("link");
    let message = load(path.to_str().expect("UTF-8"), None).expect_err("refused").to_string();
    assert!(message.contains("not a regular file"), "{message}");
}

// OBJ and MTL.

#[test]
fn obj_defaults_suit_the_size_and_are_noted() {
    let scene = loads(&[("big.obj", b"v -30 0 0\nv 30 0 0\nv 0 80 0\nf 1 2 3\n")]);
    let radius = 50.0;
    assert!((scene.medium.sigma_t().x - 0.5 / radius).abs() < 1e-6);
    assert_eq!(scene.lights[0].strength(), Vec3::splat(2.0 * radius * radius));
    let light = scene.lights[0].position().expect("a point light");
    let centre = Vec3::new(0.0, 40.0, 0.0);
    assert!((light.distance(centre) / radius - 1.2).abs() < 1e-3, "outside: {light}");
    let (right, up, forward) = scene.camera.basis();
    assert!(
        (light - centre).dot(right) < 0.0 && (light - centre).dot(up) > 0.0,
        "to the left and above: {light}"
    );
    for corner in [Vec3::new(-30.0, 0.0, 0.0), Vec3::new(30.0, 0.0, 0.0), Vec3::new(0.0, 80.0, 0.0)] {
        let angle = (corner - scene.camera.eye).normalize().dot(forward).acos();
        assert!(angle < 0.5 * scene.camera.fov_y, "the camera frames all");
    }
    for part in ["no medium", "no camera", "no light", "3 open edges"] {
        notes(&scene, part);
    }
}

#[test]
fn obj_forms_of_faces_and_vertices() {
    let text = b"# comment\r\nv 0 0 0 1 0 0\r\nv 2 0 0 2\r\nv 0 1 0 # remark\nvt 0 0\nvn 0 0 1\n\
        f -3/1/1 -2//1 \\\n  3\ng group\nl 1 2\np 1\nf 1 2\nfoo bar\nvt x\n";
    let scene = loads(&[("forms.obj", text)]);
    assert_eq!(scene.triangle_count(), 1);
    assert_eq!(scene.objects[0].mesh.positions[1], Vec3::new(1.0, 0.0, 0.0), "w divides");
    assert_eq!(scene.objects[0].mesh.normals.len(), 3);
    notes(&scene, "3 lines and points were dropped");
    notes(&scene, "unknown lines were passed over, first line 13: `foo bar`");
}

#[test]
fn obj_material_splits_leave_the_surface_whole() {
    let cube = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
        usemtl red\nf 4 3 2 1\nf 5 6 7 8\ng side\nusemtl blue\nf 1 2 6 5\no x\nf 3 4 8 7\nusemtl red\nf 1 5 8 4\nf 2 3 7 6\n";
    let mtl = b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 .5\nKs .2 .2 .2\nNs 30\nillum 2\n";
    let scene = loads(&[("cube.obj", cube), ("a.mtl", mtl)]);
    assert_eq!(scene.objects.len(), 1);
    let mesh = &scene.objects[0].mesh;
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
    assert!(mesh.topology().is_closed_manifold());
    let blue = scene.materials.iter().position(|m| m.name == "blue").expect("blue");
    assert_eq!(mesh.materials.iter().filter(|&&m| m as usize == blue).count(), 4);
    let blue = &scene.materials[blue];
    assert_eq!((blue.k_d.z, blue.k_s.x, blue.exponent), (0.5, 0.2, 30.0));
    assert!(!scene.notes.iter().any(|note| note.contains("object")), "{:?}", scene.notes);
}

#[test]
fn obj_bad_numbers_are_dropped_and_odd_triangles_reported() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 1e39 0 0\nv -1.#IND 0 0\nv 1e30 0 0\n\
        f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 6\nf 1 2 7\nf 1 1 2\nf 3 1 2\n";
    let scene = loads(&[("odd.obj", text)]);
    assert_eq!(scene.triangle_count(), 3);
    notes(&scene, "dropped 4 triangles");
    notes(&scene, "1 degenerate triangle");
    notes(&scene, "1 duplicate triangle");
    refused(&[("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")], &["has no triangles"]);
}

#[test]
fn obj_errors_name_the_line() {
    let bad = |text: &str, parts: &[&str]| refused(&[("bad.obj", text.as_bytes())], parts);
    bad("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", &["line 5", "vertex 4", "3"]);
    bad("v 0 0 0\nv 1 0 0\nf 1 2 9\nv 0 1 0\n", &["line 3", "vertex 9"]);
    bad("v 0 0 0\nf -1 -2 -3\n", &["line 2", "-2"]);
    bad("v 0 0 0\nf 0 0 0\n", &["line 2", "vertex 0"]);
    bad("v 0 0 0\nf 1 1 99999999999999999999\n", &["line 2", "99999999999999999999", "integers"]);
    bad("v 0 0 0\nf 1 1 9223372036854775807\n", &["line 2"]);
    bad("v 0 0 0\nf 1 1 -9223372036854775808\n", &["line 2"]);
    bad("v 0 0 0\nf 1 a 1\n", &["line 2", "`a`"]);
    bad("v 0 0 zero\nf 1 1 1\n", &["line 1", "v x y z"]);
    bad("v 0 0\n", &["line 1", "v x y z"]);
    bad("v 0 0 0 0\n", &["line 1", "w"]);
    bad("vn 0 0\n", &["line 1", "vn x y z"]);
    bad("solid stl\nfacet normal 0 0 1\n", &["has no triangles"]);
}

#[test]
fn obj_normals_that_are_missing_or_odd_are_the_triangles_own() {
    let text =
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 0\nvn nan 0 0\nvn 0 0 0\nf 1//1 2//2 3//3\nf 1//9 2 3//0\n";
    let scene = loads(&[("normals.obj", text)]);
    let triangles = scene.world_triangles();
    assert_eq!(triangles[0].normals, [Vec3::Y, Vec3::Z, Vec3::Z]);
    assert_eq!(triangles[1].normals, [Vec3::Z; 3]);
    notes(&scene, "2 corners name normals");
}

#[test]
fn obj_concave_polygons_keep_their_area() {
    let text = b"v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 3 4 5 6 1 2\nf 2 3 4 5 6 1\n";
    let scene = loads(&[("l.obj", text)]);
    let area = |t: &common::scene::WorldTriangle| {
        let [a, b, c] = t.positions;
        0.5 * (b - a).cross(c - a).z
    };
    let areas: Vec<f32> = scene.world_triangles().iter().map(area).collect();
    assert!(areas.iter().all(|&a| a > 0.0) && (areas.iter().sum::<f32>() - 6.0).abs() < 1e-6, "{areas:?}");
}

#[test]
fn mtl_odd_lines_are_noted_and_never_fatal() {
    let obj = b"mtllib a.mtl\nmtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\nusemtl unknown\nf 1 2 3\n";
    let mtl = b"newmtl m\nKd .9\nKs 2 -1 .5\nNs x\nKe 1 1 1\nTr .5\nmap_Kd none.png\nnewmtl\nKd a b c\nillum 99\n\xff\xfe";
    let scene = loads(&[("a.obj", obj), ("a.mtl", mtl)]);
    let m = &scene.materials[0];
    assert!((m.k_d + m.k_s).max_element() <= 1.0 + 1e-6 && m.k_s.min_element() >= 0.0, "{m:?}");
    for part in [
        "none.mtl",
        "line 4: Ns x",
        "line 8: newmtl",
        "outside 0 to 1",
        "above 1",
        "none.png",
        "emit",
        "opaque",
        "`unknown`",
    ] {
        notes(&scene, part);
    }
    let binary = loads(&[("a.obj", obj), ("a.mtl", &[0xff; 300])]);
    notes(&binary, "no library has material `m`, `unknown`");
}

#[test]
fn textures_count_as_their_linear_mean() {
    let obj = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    let mtl = b"newmtl m\nKd .5 .5 1\nmap_Kd -s 1 1 1 -clamp on my picture.png\n";
    let scene = loads(&[("a.obj", obj), ("a.mtl", mtl), ("my picture.png", &png(3, 2, [255, 188, 0]))]);
    let k_d = scene.materials[0].k_d;
    assert!((k_d - Vec3::new(0.5, 0.5 * 0.5029, 0.0)).length() < 1e-3, "{k_d}");
    notes(&scene, "mean colour");
    let broken = loads(&[("a.obj", obj), ("a.mtl", mtl), ("my picture.png", &png(3, 2, [0; 3])[..40])]);
    notes(&broken, "without the texture `my picture.png`");
    assert_eq!(broken.materials[0].k_d, Vec3::new(0.5, 0.5, 1.0));
}

// Real models.

fn load_real(name: &str) -> Option<Scene> {
    Some(load(real_models()?.join(name).to_str().expect("UTF-8"), None).expect("loads"))
}

#[test]
fn every_real_model_loads_or_says_why_not() {
    let Some(folder) = real_models() else { return };
    let mut files = Vec::new();
    files_below(&folder, &mut files);
    for path in files {
        let name = path.strip_prefix(&folder).expect("below").display().to_string();
        let start = std::time::Instant::now();
        match load(path.to_str().expect("UTF-8"), None) {
            Ok(scene) => {
                println!("{name}: {} triangles, {:?}", scene.triangle_count(), start.elapsed());
                scene.notes.iter().for_each(|note| println!("    {note}"));
                assert_eq!(scene.problem(), None);
                assert!(scene.objects.iter().all(|object| object.mesh.validate().is_ok()), "{name}");
            }
            Err(error) => {
                println!("{name}: refused: {error}");
                assert!(error.to_string().contains(&name), "{error}");
            }
        }
    }
}

#[test]
fn known_counts_of_real_models() {
    for (name, triangles) in [
        ("sibenik/sibenik.obj", 75_284),
        ("bunny/stanford-bunny.obj", 69_451),
        ("damaged_helmet/DamagedHelmet.gltf", 15_452),
        ("loader_tests_gltf/test/testfiles/gltf/Box/glTF-Binary/Box.glb", 12),
    ] {
        let Some(scene) = load_real(name) else { return };
        assert_eq!(scene.triangle_count(), triangles, "{name}");
    }
    let Some(sibenik) = load_real("sibenik/sibenik.obj") else { return };
    assert_eq!(sibenik.materials.len(), 15);
    let (low, high) = sibenik.bounds().expect("triangles");
    assert!((low.y + 15.3).abs() < 0.05 && high.y > 10.0, "the floor is at −15.3: {low}");
}
