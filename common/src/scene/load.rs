//! Loading scenes: OBJ + MTL, glTF / GLB, JSON scene files and the built-in scenes, by one call.
//!
//! A file seldom says everything that a scene needs. What it leaves out is filled in to suit its
//! size ([`load`] says how), and each assumption is a sentence in [`Scene::notes`]. Approximations:
//! (1) a texture counts as its mean colour; (2) surfaces are opaque and do not emit light.

mod build;
mod picture;

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use glam::Vec3;

pub(super) use build::{MaterialNotes, MeshBuilder, raw_material};
pub(super) use picture::{Mean, Pictures, light_map};

use super::{Material, Object, Scene, Track, builtin, gltf, json, obj};
use crate::{Camera, Cloud, Light, Medium, Phase, PointLight, Sky};

/// Most triangles that a scene may have.
pub const MAX_TRIANGLES: usize = 20_000_000;

/// Largest file that is read \[bytes\].
pub const MAX_BYTES: u64 = 2 << 30;

/// Largest coordinate \[m\]; beyond it, squares of distances stop being useful in 32 bits.
pub const MAX_COORDINATE: f32 = 1e9;

/// Why a scene can't be loaded; each message is one sentence that names the file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file can't be opened or read.
    #[error("can't read {}: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// Neither a file of a known kind nor the name of a built-in scene.
    #[error(
        "{name} is {what}; expected a .obj, .gltf, .glb or .json file or the name of a built-in scene{names}"
    )]
    UnknownKind {
        /// What was asked for.
        name: String,
        /// What it is instead.
        what: &'static str,
        /// The names of the built-in scenes.
        names: String,
    },
    /// The file is larger than is read.
    #[error("{} is larger than {limit} bytes; expected a smaller model", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Most bytes that are read of a file of this kind.
        limit: u64,
    },
    /// The file's content is not what its kind asks for.
    #[error("{}{}{place}: {problem}", path.display(), if place.is_empty() { "" } else { ", " })]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Where in the file: a line, a field, an index; may be empty.
        place: String,
        /// What is wrong there, and what was expected.
        problem: String,
    },
    /// A built-in scene can't be made.
    #[error("built-in scene {name}: {problem}")]
    Builtin {
        /// Name of the built-in scene.
        name: String,
        /// What is wrong, and what was expected.
        problem: String,
    },
}

impl LoadError {
    pub(super) fn invalid(path: &Path, place: impl Into<String>, problem: impl Into<String>) -> Self {
        // What the file says may be part of the message; keep that to a line.
        Self::Invalid { path: path.into(), place: short(&place.into()), problem: line(&problem.into(), 400) }
    }
}

/// What a file gave. `None` is filled in by [`finish`].
#[derive(Default)]
pub(super) struct Part {
    pub(super) objects: Vec<Object>,
    pub(super) materials: Vec<Material>,
    pub(super) lights: Option<Vec<Light>>,
    pub(super) medium: Option<Medium>,
    pub(super) cloud: Option<Cloud>,
    pub(super) sky: Option<Sky>,
    pub(super) camera: Option<Camera>,
    pub(super) animation: Vec<Track>,
    pub(super) notes: Vec<String>,
}

/// Loads a scene from a file (`.obj`, `.gltf`, `.glb`, `.json`, in any case) or, where there is no
/// such file, makes the built-in scene of that name with about `triangles` triangles.
///
/// With `r` half the diagonal of the scene's bounds, what a file leaves out becomes: a grey
/// isotropic medium of `σ_t` = 0.5/r and albedo 0.9; a camera that frames the bounds; a point light
/// outside beside that camera, or, where the file has a camera of its own, in the middle of the
/// scene. [`Scene::notes`] says so, and reports everything that was dropped, changed or is odd about
/// the meshes.
///
/// # Errors
/// One sentence that names the file, the place in it and what was expected.
pub fn load(path_or_builtin: &str, triangles: Option<u32>) -> Result<Scene, LoadError> {
    let path = Path::new(path_or_builtin);
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let known = matches!(extension.as_str(), "obj" | "gltf" | "glb" | "json");
    if !path.is_file() && !known {
        return load_builtin(path_or_builtin, triangles);
    }
    let (part, name) = match extension.as_str() {
        "json" => {
            let (part, name) = json::load(path, triangles)?;
            (part, name.unwrap_or_else(|| stem(path)))
        }
        _ if known => {
            let mut part = load_model(path)?;
            if triangles.is_some() {
                part.notes.push(format!(
                    "{} has the triangles that it has; a triangle count is for built-in scenes only",
                    path.display()
                ));
            }
            (part, stem(path))
        }
        _ => {
            let what = "a file of another kind";
            return Err(LoadError::UnknownKind { name: path_or_builtin.into(), what, names: String::new() });
        }
    };
    finish(part, &name, path)
}

/// Loads an OBJ or glTF file as it is.
pub(super) fn load_model(path: &Path) -> Result<Part, LoadError> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    if extension.eq_ignore_ascii_case("obj") { obj::load(path) } else { gltf::load(path) }
}

fn load_builtin(name: &str, triangles: Option<u32>) -> Result<Scene, LoadError> {
    let what = if Path::new(name).is_dir() { "a folder" } else { "no file" };
    if !builtin::NAMES.iter().any(|(known, _)| *known == name) {
        let names: Vec<&str> = builtin::NAMES.iter().map(|(known, _)| *known).collect();
        let names = format!(" ({})", names.join(", "));
        return Err(LoadError::UnknownKind { name: name.into(), what, names });
    }
    builtin::build(name, triangles)
        .map_err(|error| LoadError::Builtin { name: name.into(), problem: error.to_string() })
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Reads a whole regular file of at most `limit` bytes.
pub(super) fn read(path: &Path, limit: u64) -> Result<Vec<u8>, LoadError> {
    let failed = |error| LoadError::Read { path: path.into(), error };
    // A pipe or a device could make us wait or read for ever.
    if !std::fs::metadata(path).map_err(failed)?.is_file() {
        return Err(failed(io::Error::new(io::ErrorKind::InvalidInput, "it is not a regular file")));
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(limit + 1).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() as u64 > limit {
        return Err(LoadError::TooLarge { path: path.into(), limit });
    }
    Ok(bytes)
}

/// Makes a scene of what a file gave, fills in what it left out, and checks all.
fn finish(part: Part, name: &str, path: &Path) -> Result<Scene, LoadError> {
    let Part { objects, materials, lights, medium, cloud, sky, camera, animation, notes } = part;
    let sky = sky.unwrap_or_default();
    let mut scene = Scene { objects, materials, cloud, sky, animation, notes, ..Scene::empty(name) };
    if scene.materials.is_empty() {
        scene.materials.push(Material::default());
    }
    let total = scene.triangle_count();
    if total > MAX_TRIANGLES {
        let problem = format!("{total} triangles; expected at most {MAX_TRIANGLES}");
        return Err(LoadError::invalid(path, "", problem));
    }
    for object in &scene.objects {
        let place = object.world_from_object;
        if let Some(&p) =
            object.mesh.positions.iter().find(|&&p| !build::is_usable(place.transform_point3(p)))
        {
            let at = place.transform_point3(p);
            let problem =
                format!("object {} reaches to {at}; expected coordinates within ±1e9 m", object.name);
            return Err(LoadError::invalid(path, "", problem));
        }
    }
    if total == 0 && scene.cloud.is_none() && lights.is_some() {
        scene.notes.push("there is no object, so nothing but fog is to be seen".into());
    }
    note_topology(&scene.objects, &mut scene.notes);

    // Fill in what is missing.
    let of_cloud = || scene.cloud.as_ref().map(|cloud| cloud.density.bounds());
    let of_cloud = || of_cloud().filter(|(low, high)| (*high - *low).is_finite());
    let (low, high) = scene.bounds().or_else(of_cloud).unwrap_or((Vec3::NEG_ONE, Vec3::ONE));
    let centre = 0.5 * (low + high);
    let radius = (0.5 * (high - low).length()).max(1e-3);
    let assumed = |what: String| {
        format!(
            "{} gives no {what}; give another in a JSON scene file (docs/scene-format.md)",
            path.file_name().unwrap_or(path.as_os_str()).to_string_lossy()
        )
    };
    scene.medium = medium.unwrap_or_else(|| {
        // A cloud hangs in clear air.
        if scene.cloud.is_some() {
            return Medium::vacuum();
        }
        let sigma_t = 0.5 / radius;
        scene.notes.push(assumed(format!(
            "medium: assumed a grey isotropic one of σ_t = {sigma_t:.3e} 1/m and albedo 0.9"
        )));
        Medium::grey(sigma_t, 0.9, Phase::isotropic())
    });
    let from_outside = camera.is_none();
    scene.camera = camera.unwrap_or_else(|| {
        let camera = framing_camera(centre, radius);
        scene.notes.push(assumed(format!("camera: assumed one at {:.3} that frames all", camera.eye)));
        camera
    });
    scene.lights = lights.unwrap_or_else(|| {
        // A camera of the file may be inside, and so is the light then. Beside the assumed camera it is
        // outside: in the middle of a closed model it would light nothing that can be seen.
        let (position, intensity) = if from_outside {
            (centre + 1.2 * radius * Vec3::new(-0.6, 0.65, 0.47).normalize(), 2.0 * radius * radius)
        } else {
            (Vec3::new(centre.x, low.y + 0.8 * (high.y - low.y), centre.z), 0.5 * radius * radius)
        };
        scene
            .notes
            .push(assumed(format!("light: assumed a point light of {intensity:.3e} W/sr at {position:.3}")));
        vec![Light::Point(PointLight { position, intensity: Vec3::splat(intensity) })]
    });

    match scene.problem() {
        Some(problem) => Err(LoadError::invalid(path, "", problem)),
        None => Ok(scene),
    }
}

/// A camera that sees the whole of a sphere, obliquely from above.
fn framing_camera(centre: Vec3, radius: f32) -> Camera {
    let fov_y: f32 = 0.9;
    let distance = radius / (0.5 * fov_y).sin();
    let eye = centre + distance * Vec3::new(0.55, 0.35, 0.75).normalize();
    Camera { eye, target: centre, up: Vec3::Y, fov_y }
}

/// Says what is odd about the meshes: one sentence for each that is not a closed manifold.
fn note_topology(objects: &[Object], notes: &mut Vec<String>) {
    const SAID: usize = 20;
    let mut odd = 0;
    for object in objects {
        let topology = object.mesh.topology();
        if !topology.is_closed_manifold() {
            odd += 1;
            if odd <= SAID {
                notes.push(format!("object {}: {topology}", object.name));
            }
        }
    }
    if odd > SAID {
        notes.push(format!("{} more objects are not closed 2-manifolds either", odd - SAID));
    }
}

/// A few of many names, for a note.
pub(super) fn some_of(names: &[String]) -> String {
    const SHOWN: usize = 5;
    let shown =
        names.iter().take(SHOWN).map(|name| format!("`{}`", short(name))).collect::<Vec<_>>().join(", ");
    let more = names.len().saturating_sub(SHOWN);
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}

/// A name from a file, cut to a length that a message can bear and free of control characters.
pub(super) fn short(name: &str) -> String {
    line(name, 150)
}

/// At most `length` characters on one line, none of them a control character.
fn line(text: &str, length: usize) -> String {
    let plain = |c: char| match c {
        '\n' | '\r' | '\t' => ' ',
        c if c.is_control() => '\u{fffd}',
        c => c,
    };
    let text = text.trim();
    let mut kept: String = text.chars().take(length).map(plain).collect();
    if text.chars().nth(length).is_some() {
        kept.push('…');
    }
    kept
}
