//! JSON scene files: model files and built-in scenes put together, with lights, a medium, a camera
//! and motion. The format is described in docs/scene-format.md.

mod cloud;
mod format;

use std::path::Path;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};

use super::animation::Target;
use super::builtin::{self, BuiltinError};
use super::load::{LoadError, MAX_TRIANGLES, Part, light_map, load_model, read, short};
use super::{Material, Mesh, Scene};
use crate::{Camera, DirectionalLight, Light, Medium, Phase, PointLight, SpotLight};
use format::{CameraEntry, LightEntry, MaterialEntry, MediumEntry, ObjectEntry, SceneFile, SpotEntry};

/// Largest scene file that is read \[bytes\].
const MAX_BYTES: u64 = 64 << 20;

/// Most objects that a scene file may list.
const MAX_OBJECTS: usize = 10_000;

/// Loads a scene file; also its own name for the scene. `triangles` goes to built-in scenes that
/// have no count of their own.
pub(super) fn load(path: &Path, triangles: Option<u32>) -> Result<(Part, Option<String>), LoadError> {
    let bytes = read(path, MAX_BYTES)?;
    let file = parse(path, &bytes)?;
    if file.objects.len() > MAX_OBJECTS {
        let problem = format!("{} objects; expected at most {MAX_OBJECTS}", file.objects.len());
        return Err(LoadError::invalid(path, "objects", problem));
    }
    let mut whole = Part::default();
    for (index, entry) in file.objects.iter().enumerate() {
        let mut part = object(path, index, entry, triangles)?;
        // What the file says itself takes the place of what its parts bring along.
        if file.lights.is_some() {
            part.lights = None;
            part.animation.retain(|track| light_of(&track.target).is_none());
        }
        if file.camera.is_some() || whole.camera.is_some() {
            part.camera = None;
            part.animation.retain(|track| !matches!(track.target, Target::CameraEye | Target::CameraTarget));
        }
        if file.medium.is_some() || whole.medium.is_some() {
            part.medium = None;
            part.animation.retain(|track| track.target != Target::MediumDensity);
        }
        append(&mut whole, part);
        let total: usize = whole.objects.iter().map(|object| object.mesh.triangles.len()).sum();
        if total > MAX_TRIANGLES {
            let problem =
                format!("more than {MAX_TRIANGLES} triangles by now; expected fewer or smaller models");
            return Err(LoadError::invalid(path, format!("objects[{index}]"), problem));
        }
    }
    if let Some(entries) = &file.lights {
        let lights = entries.iter().enumerate().map(|(index, entry)| light(path, index, entry));
        whole.lights = Some(lights.collect::<Result<_, _>>()?);
    }
    if let Some(entry) = &file.medium {
        whole.medium = Some(medium(path, entry)?);
    }
    if let Some(entry) = &file.cloud {
        whole.cloud = Some(cloud::cloud(path, entry)?);
    }
    if let Some(entry) = &file.sky {
        whole.sky = Some(cloud::sky(path, entry)?);
    }
    if let Some(entry) = &file.camera {
        whole.camera = Some(camera(path, entry)?);
    }
    if let Some(tracks) = file.animation {
        whole.animation = tracks;
    }
    check_tracks(path, &whole)?;
    Ok((whole, file.name.as_deref().map(short)))
}

fn parse(path: &Path, bytes: &[u8]) -> Result<SceneFile, LoadError> {
    let mut text = serde_json::Deserializer::from_slice(bytes);
    let file: SceneFile = serde_path_to_error::deserialize(&mut text).map_err(|error| {
        let place = error.path().to_string();
        // At the top, the path is a lone dot.
        let place = if place == "." { String::new() } else { place };
        LoadError::invalid(path, place, error.inner().to_string())
    })?;
    text.end().map_err(|error| LoadError::invalid(path, "after the scene", error.to_string()))?;
    if file.version != 1 {
        let problem = format!("{}; expected 1, the only version that there is", file.version);
        return Err(LoadError::invalid(path, "version", problem));
    }
    Ok(file)
}

/// Loads one of the objects and puts it into its place.
fn object(path: &Path, index: usize, entry: &ObjectEntry, triangles: Option<u32>) -> Result<Part, LoadError> {
    let place = |field: &str| format!("objects[{index}]{field}");
    let invalid = |field: &str, problem: String| LoadError::invalid(path, place(field), problem);
    let mut part = match (&entry.file, &entry.builtin) {
        (Some(file), None) => {
            if entry.triangles.is_some() {
                return Err(invalid(".triangles", "is for built-in scenes only; expected none".into()));
            }
            let extension = Path::new(file).extension().and_then(|e| e.to_str()).unwrap_or_default();
            if !["obj", "gltf", "glb"].contains(&extension.to_ascii_lowercase().as_str()) {
                return Err(invalid(
                    ".file",
                    format!("`{}`; expected a .obj, .gltf or .glb file", short(file)),
                ));
            }
            let model = path.with_file_name("").join(file);
            load_model(&model).map_err(|error| invalid(".file", error.to_string()))?
        }
        (None, Some(name)) => {
            let built = match builtin::build(name, entry.triangles.or(triangles)) {
                // The count from outside is for those that have a choice.
                Err(BuiltinError::NoTriangleChoice { .. }) if entry.triangles.is_none() => {
                    builtin::build(name, None)
                }
                built => built,
            };
            part_of(built.map_err(|error| invalid(".builtin", error.to_string()))?)
        }
        _ => return Err(invalid("", "expected either `file` or `builtin`".into())),
    };

    let transform = transform(entry).map_err(|(field, problem)| invalid(field, problem))?;
    if transform != Affine3A::IDENTITY {
        apply_transform(&mut part, transform);
    }
    if let Some(name) = &entry.name {
        for object in &mut part.objects {
            object.name.clone_from(name);
        }
        part.animation.retain(|track| object_of(&track.target).is_none());
    }
    if let Some(material) = &entry.material {
        part.materials = vec![material_from(material).map_err(|(f, p)| invalid(f, p))?];
        for object in &mut part.objects {
            let mesh = Arc::make_mut(&mut object.mesh);
            mesh.materials.clear();
        }
    }
    Ok(part)
}

fn part_of(scene: Scene) -> Part {
    Part {
        objects: scene.objects,
        materials: scene.materials,
        lights: Some(scene.lights),
        medium: Some(scene.medium),
        cloud: scene.cloud,
        sky: Some(scene.sky),
        camera: Some(scene.camera),
        animation: scene.animation,
        notes: scene.notes,
    }
}

/// World from part: first scaled, then turned, then shifted.
fn transform(entry: &ObjectEntry) -> Result<Affine3A, (&'static str, String)> {
    let scale = entry.scale.map_or(Vec3::ONE, |scale| scale.0);
    if scale.min_element() <= 0.0 {
        return Err((".scale", format!("{scale}; expected factors above 0")));
    }
    let rotation = match &entry.rotate_degrees {
        None => Quat::IDENTITY,
        Some(rotation) => match rotation.axis.0.try_normalize() {
            Some(axis) => Quat::from_axis_angle(axis, rotation.angle.0.to_radians()),
            None => return Err((".rotate_degrees.axis", "is zero; expected a direction".into())),
        },
    };
    let translation = entry.translate.map_or(Vec3::ZERO, |translate| translate.0);
    let transform = Affine3A::from_scale_rotation_translation(scale, rotation, translation);
    if transform.is_finite() && transform.inverse().is_finite() {
        Ok(transform)
    } else {
        Err(("", "its scale, rotation and translation can't be undone; expected moderate numbers".into()))
    }
}

/// Moves objects and lights; a camera and motion stay as they are.
fn apply_transform(part: &mut Part, transform: Affine3A) {
    for object in &mut part.objects {
        object.world_from_object = transform * object.world_from_object;
    }
    let turned = |v: Vec3| transform.transform_vector3(v).normalize_or_zero();
    for light in part.lights.iter_mut().flatten() {
        match light {
            Light::Point(light) => light.position = transform.transform_point3(light.position),
            Light::Spot(light) => {
                light.position = transform.transform_point3(light.position);
                light.direction = turned(light.direction);
                light.up = turned(light.up);
            }
            Light::Directional(light) => light.direction = turned(light.direction),
        }
    }
    if !part.animation.is_empty() {
        part.notes.push("an object that moves was placed anew; its motion is still in its old axes".into());
    }
}

/// Adds a part's content to the whole, with its indices moved behind what is there.
fn append(whole: &mut Part, mut part: Part) {
    let first_material = whole.materials.len() as u32;
    for object in &mut part.objects {
        if first_material > 0 {
            let mesh: &mut Mesh = Arc::make_mut(&mut object.mesh);
            mesh.materials.resize(mesh.triangles.len(), 0);
            mesh.materials.iter_mut().for_each(|material| *material += first_material);
        }
    }
    let first_light = whole.lights.as_ref().map_or(0, Vec::len);
    for track in &mut part.animation {
        if let Some(light) = light_of_mut(&mut track.target) {
            *light += first_light;
        }
    }
    if part.materials.is_empty() {
        part.materials.push(Material::default());
    }
    whole.objects.append(&mut part.objects);
    whole.materials.append(&mut part.materials);
    whole.animation.append(&mut part.animation);
    whole.notes.append(&mut part.notes);
    if let Some(mut lights) = part.lights {
        whole.lights.get_or_insert_default().append(&mut lights);
    }
    whole.medium = whole.medium.take().or(part.medium);
    whole.cloud = whole.cloud.take().or(part.cloud);
    whole.sky = whole.sky.take().or(part.sky);
    whole.camera = whole.camera.take().or(part.camera);
}

fn light_of_mut(target: &mut Target) -> Option<&mut usize> {
    match target {
        Target::LightPosition { light }
        | Target::LightDirection { light }
        | Target::LightIntensity { light } => Some(light),
        _ => None,
    }
}

fn light_of(target: &Target) -> Option<usize> {
    light_of_mut(&mut target.clone()).copied()
}

fn object_of(target: &Target) -> Option<&str> {
    match target {
        Target::ObjectTranslation { object } | Target::ObjectRotation { object, .. } => Some(object),
        _ => None,
    }
}

/// A place below an object and a clause.
type Problem = (&'static str, String);

fn material_from(entry: &MaterialEntry) -> Result<Material, Problem> {
    let default = Material::default();
    let material = Material {
        name: entry.name.as_deref().map_or(default.name, short),
        k_d: entry.k_d.map_or(default.k_d, |k| k.0),
        k_s: entry.k_s.map_or(default.k_s, |k| k.0),
        exponent: entry.exponent.map_or(default.exponent, |exponent| exponent.0),
    };
    let total = material.k_d + material.k_s;
    if material.k_d.min(material.k_s).min_element() < 0.0 || total.max_element() > 1.0 {
        let problem = format!(
            "k_d {} and k_s {}; expected none negative and k_d + k_s at most 1",
            material.k_d, material.k_s
        );
        return Err((".material", problem));
    }
    if material.exponent < 0.0 {
        return Err((".material.exponent", format!("{}; expected 0 or more", material.exponent)));
    }
    Ok(material)
}

fn light(path: &Path, index: usize, entry: &LightEntry) -> Result<Light, LoadError> {
    let place = format!("lights[{index}]");
    let light = match entry {
        LightEntry::Point(light) => {
            Light::Point(PointLight { position: light.position.0, intensity: light.intensity.0 })
        }
        LightEntry::Directional(light) => {
            let Some(direction) = light.direction.0.try_normalize() else {
                let problem = "is zero; expected the way that the light travels";
                return Err(LoadError::invalid(path, format!("{place}.directional.direction"), problem));
            };
            Light::Directional(DirectionalLight { direction, irradiance: light.irradiance.0 })
        }
        LightEntry::Spot(light) => Light::Spot(spot(path, &format!("{place}.spot"), light)?),
    };
    match light.problem() {
        Some(problem) => {
            Err(LoadError::invalid(path, place, format!("the {} light {problem}", light.kind())))
        }
        None => Ok(light),
    }
}

fn spot(path: &Path, place: &str, entry: &SpotEntry) -> Result<SpotLight, LoadError> {
    let position = entry.position.0;
    let towards = match (entry.direction, entry.target) {
        (Some(direction), None) => direction.0,
        (None, Some(target)) => target.0 - position,
        _ => return Err(LoadError::invalid(path, place, "expected either `direction` or `target`")),
    };
    let Some(direction) = towards.try_normalize() else {
        let problem = "has no direction; expected one that is not zero, or a target away from its position";
        return Err(LoadError::invalid(path, place, problem));
    };
    let up = entry.up.map_or_else(|| if direction.y.abs() < 0.99 { Vec3::Y } else { Vec3::X }, |up| up.0);
    let outer = entry.outer_angle_degrees.0;
    let inner = entry.inner_angle_degrees.map_or(0.8 * outer, |inner| inner.0);
    let map = entry.light_map.as_ref().map(|name| {
        light_map("the light map", &path.with_file_name("").join(name), path, &format!("{place}.light_map"))
    });
    Ok(SpotLight {
        position,
        direction,
        up,
        intensity: entry.intensity.0,
        inner_angle: inner.to_radians(),
        outer_angle: outer.to_radians(),
        light_map: map.transpose()?,
    })
}

fn medium(path: &Path, entry: &MediumEntry) -> Result<Medium, LoadError> {
    let invalid = |place: &str, problem: String| LoadError::invalid(path, place, problem);
    let phase = match &entry.phase {
        None => Phase::isotropic(),
        Some(phase) => phase.phase().map_err(|problem| invalid("medium.phase", problem))?,
    };
    let (sigma_s, sigma_a) = match (entry.sigma_s, entry.sigma_a, entry.sigma_t, entry.albedo) {
        (Some(scattering), absorption, None, None) => (scattering.0, absorption.map_or(Vec3::ZERO, |a| a.0)),
        (None, Some(absorption), None, None) => (Vec3::ZERO, absorption.0),
        (None, None, Some(extinction), albedo) => {
            let albedo = albedo.map_or(Vec3::ONE, |albedo| albedo.0);
            if !(extinction.0.is_finite() && extinction.0.min_element() >= 0.0) {
                return Err(invalid("medium.sigma_t", format!("{}; expected 0 or more [1/m]", extinction.0)));
            }
            if !(albedo.min_element() >= 0.0 && albedo.max_element() <= 1.0) {
                return Err(invalid("medium.albedo", format!("{albedo}; expected 0 to 1")));
            }
            (extinction.0 * albedo, extinction.0 * (1.0 - albedo))
        }
        _ => {
            let problem =
                "expected `sigma_s` and `sigma_a`, or `sigma_t` and `albedo`, and no mixture of the two";
            return Err(invalid("medium", problem.into()));
        }
    };
    let medium = Medium { sigma_s, sigma_a, phase };
    match medium.problem() {
        Some(problem) => Err(invalid("medium", format!("the medium {problem}"))),
        None => Ok(medium),
    }
}

fn camera(path: &Path, entry: &CameraEntry) -> Result<Camera, LoadError> {
    let default = Camera::default();
    let camera = Camera {
        eye: entry.eye.0,
        target: entry.target.0,
        up: entry.up.map_or(default.up, |up| up.0),
        fov_y: entry.fov_y_degrees.map_or(default.fov_y, |fov| fov.0.to_radians()),
    };
    match camera.problem() {
        Some(problem) => Err(LoadError::invalid(path, "camera", format!("the camera {problem}"))),
        None => Ok(camera),
    }
}

/// Checks the tracks against the lights and objects that there will be.
fn check_tracks(path: &Path, whole: &Part) -> Result<(), LoadError> {
    let mut scene = Scene::empty("");
    scene.objects.clone_from(&whole.objects);
    // Without any, one is made up: a file that moves it should say which.
    scene.lights = whole.lights.clone().unwrap_or_default();
    for (index, track) in whole.animation.iter().enumerate() {
        if let Some(problem) = track.problem(&scene) {
            let place = format!("animation[{index}]");
            return Err(LoadError::invalid(path, place, format!("the track {problem}")));
        }
    }
    Ok(())
}
