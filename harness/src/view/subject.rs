//! What is looked at: a scene, and what was changed about it in the window.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use common::scene::Track;
use common::scene::animation::{Key, Motion, Target, Value};
use common::{Camera, Scene};

use crate::cmd::load;
use crate::failure::Failure;

/// A scene with its changes.
pub(super) struct Subject {
    /// As it was asked for: a built-in name or a file.
    pub name: String,
    /// Triangles of a built-in scene, where they were asked for.
    pub triangles: Option<u32>,
    base: Arc<Scene>,
    /// Tells one loaded scene from another.
    id: u64,
    pub changes: Changes,
    /// Time in the scene's motion \[s\].
    pub time: f32,
}

/// What was changed: the scene file's own words, so that it can be saved.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Changes {
    /// Factor on the strength of each light; 0 is off.
    pub lights: Vec<f32>,
    /// Factor on the medium's coefficients.
    pub density: f32,
    /// Where the eye was flown to; `None` goes where the scene's does.
    pub camera: Option<Camera>,
}

impl Changes {
    fn none(scene: &Scene) -> Self {
        Self { lights: vec![1.0; scene.lights.len()], density: 1.0, camera: None }
    }
}

impl Subject {
    /// Loads a scene, without changes.
    pub(super) fn load(name: &str, triangles: Option<u32>) -> Result<Self, Failure> {
        let base = load(name, triangles, |_| ())?;
        static LOADED: AtomicU64 = AtomicU64::new(0);
        let (changes, id) = (Changes::none(&base), LOADED.fetch_add(1, Ordering::Relaxed));
        Ok(Self { name: name.into(), triangles, base: Arc::new(base), id, changes, time: 0.0 })
    }

    /// What the scene that was loaded is known by.
    pub(super) fn id(&self) -> u64 {
        self.id
    }

    /// The scene as it was loaded.
    pub(super) fn base(&self) -> &Arc<Scene> {
        &self.base
    }

    /// Takes all changes back.
    pub(super) fn reset(&mut self) {
        self.changes = Changes::none(&self.base);
        self.time = 0.0;
    }

    /// The scene's motion and the changes, as tracks.
    pub(super) fn tracks(&self) -> Vec<Track> {
        let flown = self.changes.camera.is_some();
        let of_camera = |track: &&Track| matches!(track.target, Target::CameraEye | Target::CameraTarget);
        let own = self.base.animation.iter().filter(|track| !(flown && of_camera(track))).cloned();
        let always = |target, factor| Track {
            target,
            motion: Motion::Keyframes { keys: vec![Key { time: 0.0, value: Value::Scalar(factor) }] },
        };
        let lights = self.changes.lights.iter().enumerate().filter(|(_, factor)| **factor != 1.0);
        let lights = lights.map(|(light, factor)| always(Target::LightIntensity { light }, *factor));
        let density =
            (self.changes.density != 1.0).then(|| always(Target::MediumDensity, self.changes.density));
        own.chain(lights).chain(density).collect()
    }

    /// The scene with its changes, everything at rest.
    pub(super) fn changed(&self) -> Scene {
        let mut scene = Scene::clone(&self.base);
        scene.animation = self.tracks();
        if let Some(camera) = self.changes.camera {
            scene.camera = camera;
        }
        scene
    }

    /// The scene with its changes, everything where it is now.
    pub(super) fn now(&self) -> Scene {
        self.changed().at(self.time)
    }

    /// Where the eye is now.
    pub(super) fn camera(&self) -> Camera {
        self.changes.camera.unwrap_or_else(|| self.base.at(self.time).camera)
    }

    /// Half the diagonal of the scene, or the distance that the eye looks over \[m\].
    pub(super) fn radius(&self) -> f32 {
        let camera = &self.base.camera;
        let bounds = self.base.bounds().map_or(0.0, |(low, high)| 0.5 * low.distance(high));
        bounds.max(camera.eye.distance(camera.target))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_what_a_scene_file_can_say() {
        let mut subject = Subject::load("amphora", Some(2000)).unwrap();
        assert_eq!(subject.changed().animation, subject.base().animation);
        subject.changes.lights = vec![0.0, 2.0];
        subject.changes.density = 0.5;
        let camera = Camera { eye: glam::Vec3::new(0.0, 3.0, 9.0), ..Camera::default() };
        subject.changes.camera = Some(camera);
        let now = subject.now();
        assert_eq!(now.problem(), None);
        assert_eq!(now.camera, camera);
        assert_eq!(now.lights[0].strength(), glam::Vec3::ZERO);
        assert_eq!(now.lights[1].strength(), 2.0 * subject.base().lights[1].strength());
        assert_eq!(now.medium.sigma_s, 0.5 * subject.base().medium.sigma_s);
        subject.reset();
        assert_eq!(subject.now().lights, subject.base().at(0.0).lights);
    }

    #[test]
    fn a_flown_eye_is_not_led_away_by_the_scene() {
        let mut subject = Subject::load("complex-camera", Some(2000)).unwrap();
        subject.time = 2.0;
        let led = subject.camera();
        assert_ne!(led, subject.base().camera);
        subject.changes.camera = Some(led);
        subject.time = 3.0;
        assert_eq!(subject.now().camera, led);
    }
}
