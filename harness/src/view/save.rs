//! Files that the window leaves: a picture, the scene, the settings. None takes the place of another.

use std::path::{Path, PathBuf};

use common::Camera;
use common::files::write_whole;
use common::scene::builtin;
use glam::Vec3;
use serde_json::{Map, Value, json};

use super::subject::Subject;
use crate::cmd::cause;
use crate::techniques::settings::{Settings, written};

/// The first of `stem`-1, `stem`-2, … of which there are no files with any of `extensions` in the folder.
pub(super) fn free(folder: &Path, stem: &str, extensions: &[&str]) -> PathBuf {
    let taken = |name: &Path| extensions.iter().any(|extension| name.with_extension(extension).exists());
    let mut names = (1..).map(|number| folder.join(format!("{stem}-{number}")));
    names.find(|name| !taken(name)).unwrap_or_else(|| folder.join(stem))
}

/// Writes JSON for people to read; whole or not at all.
pub(super) fn write_json(path: &Path, value: &impl serde::Serialize) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("can't write {}: {error}", path.display());
    let mut text = serde_json::to_string_pretty(value).map_err(|error| failed(&error))?;
    text.push('\n');
    let written = write_whole(path, |file| std::io::Write::write_all(file, text.as_bytes()));
    written.map_err(|error: std::io::Error| failed(&cause(&error)))
}

/// Settings, as `harness render --settings` reads them.
pub(super) fn settings(path: &Path, settings: &Settings) -> Result<(), String> {
    write_json(path, settings)
}

/// The scene with its changes, as a scene file that names the models where they are.
pub(super) fn scene(subject: &Subject) -> Result<Value, String> {
    let mut file = match Path::new(&subject.name).extension() {
        Some(json) if json.eq_ignore_ascii_case("json") => own_file(Path::new(&subject.name))?,
        _ => {
            let builtin = builtin::NAMES.iter().any(|(name, _)| *name == subject.name);
            let mut object = Map::new();
            if builtin {
                object.insert("builtin".into(), subject.name.clone().into());
            } else {
                object.insert("file".into(), absolute(Path::new(""), &subject.name)?.into());
            }
            if let Some(triangles) = subject.triangles.filter(|_| builtin) {
                object.insert("triangles".into(), triangles.into());
            }
            Map::from_iter([("version".into(), 1.into()), ("objects".into(), json!([object]))])
        }
    };
    if let Some(camera) = subject.changes.camera {
        file.insert("camera".into(), of_camera(&camera));
    }
    file.insert("name".into(), subject.base().name.clone().into());
    let tracks = written(&subject.tracks());
    if tracks.as_array().is_some_and(|tracks| !tracks.is_empty()) {
        file.insert("animation".into(), tracks);
    }
    Ok(file.into())
}

/// A scene file as it is, but the files in it by their whole names.
fn own_file(path: &Path) -> Result<Map<String, Value>, String> {
    let failed = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| failed(&error))?;
    let mut file: Map<String, Value> = serde_json::from_str(&text).map_err(|error| failed(&error))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    name_files(&mut file, folder)?;
    Ok(file)
}

/// Fields that name a file, wherever they stand.
const FILES: [&str; 3] = ["file", "light_map", "picture"];

fn name_files(fields: &mut Map<String, Value>, folder: &Path) -> Result<(), String> {
    for (name, value) in fields {
        match value {
            Value::String(file) if FILES.contains(&name.as_str()) => *file = absolute(folder, file)?,
            Value::Object(fields) => name_files(fields, folder)?,
            Value::Array(items) => {
                for item in items.iter_mut().filter_map(Value::as_object_mut) {
                    name_files(item, folder)?;
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// The whole name of a file, which a scene file in any folder may use.
fn absolute(folder: &Path, file: &str) -> Result<String, String> {
    let path = std::path::absolute(folder.join(file)).map_err(|error| format!("{file}: {error}"))?;
    path.to_str().map(str::to_owned).ok_or_else(|| format!("{file}: its name is no text"))
}

fn of_camera(camera: &Camera) -> Value {
    let vector = |v: Vec3| written(&v.to_array());
    json!({
        "eye": vector(camera.eye),
        "target": vector(camera.target),
        "up": vector(camera.up),
        "fov_y_degrees": written(&camera.fov_y.to_degrees()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::techniques::{find_one, settings::read};

    #[test]
    fn a_saved_scene_is_the_changed_one() {
        let folder = tempfile::tempdir().unwrap();
        let mut subject = Subject::load("window", Some(2000)).unwrap();
        subject.changes.lights[0] = 0.25;
        subject.changes.density = 2.0;
        subject.changes.camera = Some(Camera { eye: Vec3::new(0.5, 1.0, 3.0), ..subject.base().camera });
        let first = folder.path().join("first.json");
        write_json(&first, &scene(&subject).unwrap()).unwrap();
        let mut again = Subject::load(first.to_str().unwrap(), None).unwrap();
        let (wanted, found) = (subject.now(), again.now());
        assert_eq!(found.lights, wanted.lights);
        assert_eq!(found.medium, wanted.medium);
        assert_eq!((found.camera.eye, found.camera.target), (wanted.camera.eye, wanted.camera.target));
        assert!((found.camera.fov_y - wanted.camera.fov_y).abs() < 1e-6);
        assert_eq!(found.triangle_count(), wanted.triangle_count());
        // What was saved can be changed and saved again.
        again.changes.lights[0] = 2.0;
        let second = folder.path().join("second.json");
        write_json(&second, &scene(&again).unwrap()).unwrap();
        let twice = Subject::load(second.to_str().unwrap(), None).unwrap().now();
        assert_eq!(twice.lights[0].strength(), 0.5 * subject.base().lights[0].strength());
    }

    #[test]
    fn files_of_a_scene_file_are_found_from_elsewhere() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let own = folder.path().join("own.json");
        std::fs::write(&own, r#"{"version": 1, "objects": [{"file": "a.obj"}]}"#).unwrap();
        let subject = Subject::load(own.to_str().unwrap(), None).unwrap();
        let elsewhere = tempfile::tempdir().unwrap();
        let saved = elsewhere.path().join("saved.json");
        write_json(&saved, &scene(&subject).unwrap()).unwrap();
        assert_eq!(Subject::load(saved.to_str().unwrap(), None).unwrap().base().triangle_count(), 1);
    }

    #[test]
    fn saved_settings_are_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let method = find_one("chen-planes-32x8").unwrap();
        let path = folder.path().join("settings.json");
        let saved = Settings::of(&method, &Default::default());
        settings(&path, &saved).unwrap();
        let (read, model) = read(&path).unwrap();
        assert_eq!(Settings::of(&read, &model), saved);
    }

    #[test]
    fn no_file_takes_the_place_of_another() {
        let folder = tempfile::tempdir().unwrap();
        let name = |path: PathBuf| path.file_name().unwrap().to_str().unwrap().to_owned();
        assert_eq!(name(free(folder.path(), "view", &["png", "exr"])), "view-1");
        std::fs::write(folder.path().join("view-1.exr"), "").unwrap();
        assert_eq!(name(free(folder.path(), "view", &["png", "exr"])), "view-2");
        assert_eq!(name(free(folder.path(), "view", &["json"])), "view-1");
    }
}
