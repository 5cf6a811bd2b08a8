//! Flying: keys move the eye, the mouse turns it.

use common::Camera;
use eframe::egui::{Key, Response, Ui};
use glam::{Quat, Vec3};

/// What keys do.
pub(super) const HELP: &str = "W A S D: forward, left, back, right · E, Q: up, down · shift: four times as fast · \
                               drag: look around · wheel: speed · drag the line: divide the picture elsewhere";

/// Radians that a drag over the picture's height turns.
const TURN: f32 = 1.5;
/// Steepest sight: cosine of its angle with up.
const STEEPEST: f32 = 0.995;

/// How the eye is to be moved in this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Steering {
    /// Right, up and forward, each in −1 to 1.
    pub go: Vec3,
    /// Turn to the right and downwards \[rad\].
    pub turn: [f32; 2],
    /// Factor on the speed.
    pub faster: f32,
}

/// Reads mouse and keys: those of the mouse while it is on the picture, keys unless somebody types.
pub(super) fn steering(ui: &Ui, picture: &Response, fov_y: f32) -> Steering {
    let mut steering = Steering { faster: 1.0, ..Steering::default() };
    if picture.dragged() {
        let per_point = TURN * fov_y / picture.rect.height().max(1.0);
        let drag = picture.drag_delta();
        steering.turn = [drag.x * per_point, drag.y * per_point];
    }
    if ui.ctx().text_edit_focused() {
        return steering;
    }
    ui.input(|input| {
        let axis = |more: Key, less: Key| {
            f32::from(u8::from(input.key_down(more))) - f32::from(u8::from(input.key_down(less)))
        };
        steering.go = Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S));
        if input.modifiers.shift {
            steering.go *= 4.0;
        }
        if picture.contains_pointer() {
            steering.faster = (0.005 * input.smooth_scroll_delta.y).exp();
        }
    });
    steering
}

/// The camera after `way` \[m\] of full speed; `None` where it stays.
pub(super) fn moved(camera: &Camera, steering: &Steering, way: f32) -> Option<Camera> {
    if steering.go == Vec3::ZERO && steering.turn == [0.0; 2] {
        return None;
    }
    let up = camera.up.normalize();
    let (right, _, forward) = camera.basis();
    let turned =
        Quat::from_axis_angle(up, -steering.turn[0]) * Quat::from_axis_angle(right, -steering.turn[1]);
    let mut ahead = (turned * forward).normalize();
    if ahead.dot(up).abs() > STEEPEST {
        // As far to the side, but no steeper.
        ahead = (Quat::from_axis_angle(up, -steering.turn[0]) * forward).normalize();
    }
    let (right, _, forward) = Camera { target: camera.eye + ahead, ..*camera }.basis();
    let eye = camera.eye + way * (steering.go.x * right + steering.go.y * up + steering.go.z * forward);
    // What is looked at stays as far away: it says how near the near plane is.
    let distance = camera.eye.distance(camera.target);
    let moved = Camera { eye, target: eye + distance * forward, ..*camera };
    moved.problem().is_none().then_some(moved)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STILL: Steering = Steering { go: Vec3::ZERO, turn: [0.0; 2], faster: 1.0 };

    #[test]
    fn the_eye_goes_where_the_keys_say() {
        let camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z * 4.0, up: Vec3::Y, fov_y: 1.0 };
        assert_eq!(moved(&camera, &STILL, 1.0), None);
        let forward = moved(&camera, &Steering { go: Vec3::Z, ..STILL }, 2.0).unwrap();
        assert!(forward.eye.distance(Vec3::NEG_Z * 2.0) < 1e-6);
        let right = moved(&camera, &Steering { go: Vec3::X, ..STILL }, 2.0).unwrap();
        assert!(right.eye.distance(Vec3::X * 2.0) < 1e-6);
        let turned = moved(&camera, &Steering { turn: [0.5, 0.0], ..STILL }, 2.0).unwrap();
        assert_eq!(turned.eye, camera.eye);
        assert!(turned.target.x > 1.0 && (turned.target.length() - 4.0).abs() < 1e-5);
        let down = moved(&camera, &Steering { turn: [0.0, 0.5], ..STILL }, 2.0).unwrap();
        assert!(down.target.y < -1.0);
    }

    #[test]
    fn no_drag_makes_a_camera_that_cannot_see() {
        let mut camera = Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov_y: 1.0 };
        for step in 0..200 {
            let turn = [0.3, if step < 100 { 0.2 } else { -0.2 }];
            if let Some(next) = moved(&camera, &Steering { turn, ..STILL }, 1.0) {
                camera = next;
            }
            assert_eq!(camera.problem(), None);
        }
    }
}
