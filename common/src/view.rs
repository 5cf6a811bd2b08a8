//! Where the eye is and which ray belongs to which pixel.

use glam::camera::rh;
use glam::{Mat4, Vec2, Vec3};
use serde::{Deserialize, Serialize};

mod depth;
mod matrices;

pub use depth::DepthRange;
pub use matrices::ViewError;

/// A pinhole camera without a resolution: part of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Position of the eye \[m\].
    pub eye: Vec3,
    /// A point that the camera looks at \[m\]; differs from `eye`.
    pub target: Vec3,
    /// Roughly up; not parallel to the viewing direction.
    pub up: Vec3,
    /// Vertical field of view \[rad\], above 0 and below 3.1.
    pub fov_y: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self { eye: Vec3::new(0.0, 1.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 1.0 }
    }
}

impl Camera {
    /// This camera with a resolution \[pixels\].
    pub fn view(&self, width: u32, height: u32) -> View {
        // Reversed float depth keeps its relative precision at any distance, so the plane can be near
        // enough never to matter; in proportion to the scene, so that scale makes no difference.
        let depth = DepthRange::reversed(1e-3 * self.eye.distance(self.target));
        View { camera: *self, width, height, depth }
    }

    /// Unit vectors right, up and forward.
    pub fn basis(&self) -> (Vec3, Vec3, Vec3) {
        let forward = (self.target - self.eye).normalize();
        let right = forward.cross(self.up).normalize();
        (right, right.cross(forward), forward)
    }

    /// What is wrong with this camera, if anything: one clause, to be put behind its name.
    pub fn problem(&self) -> Option<String> {
        let (eye, target, up) = (self.eye, self.target, self.up);
        if !(eye.is_finite() && target.is_finite() && up.is_finite()) {
            return Some("has a position or direction that is not a finite number".into());
        }
        if !(self.fov_y > 0.0 && self.fov_y < 3.1) {
            return Some(format!(
                "has a vertical field of view of {} rad; expected 0 < fov_y < 3.1",
                self.fov_y
            ));
        }
        let forward = (target - eye).normalize_or_zero();
        if forward == Vec3::ZERO {
            return Some("looks at its own position".into());
        }
        if forward.cross(up.normalize_or_zero()).length() < 1e-4 {
            return Some("has an `up` that is zero or parallel to its viewing direction".into());
        }
        None
    }
}

/// A camera with a resolution: what a frame is drawn for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position, direction and field of view.
    pub camera: Camera,
    /// Width \[pixels\].
    pub width: u32,
    /// Height \[pixels\].
    pub height: u32,
    /// What the depth buffer of the scene means.
    pub depth: DepthRange,
}

impl View {
    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.width as f32 / self.height as f32
    }

    /// Rigid transform into view space: x right, y up, −z forward.
    pub fn view_from_world(&self) -> Mat4 {
        rh::view::look_to_mat4(self.camera.eye, self.camera.basis().2, self.camera.up.normalize())
    }

    /// Perspective projection that techniques draw with: reversed depth from the same near plane on, without a far
    /// plane, whatever [`View::depth`] says of the scene's depth buffer.
    pub fn clip_from_view(&self) -> Mat4 {
        rh::proj::directx::perspective_infinite_reverse(self.camera.fov_y, self.aspect(), self.depth.near)
    }

    /// Product of the two above.
    pub fn clip_from_world(&self) -> Mat4 {
        self.clip_from_view() * self.view_from_world()
    }

    /// Half extents of the image plane at distance 1.
    pub fn half_extent(&self) -> Vec2 {
        let y = (0.5 * self.camera.fov_y).tan();
        Vec2::new(y * self.aspect(), y)
    }

    /// Distance \[m\] from the eye, along the ray of pixel (`x`, `y`), of what the depth buffer holds there; infinite
    /// where it holds nothing.
    pub fn distance(&self, depth: f32, x: u32, y: u32) -> f32 {
        self.depth.distance(depth) / self.ray_direction(x, y).dot(self.camera.basis().2)
    }

    /// Unit direction of the ray through the centre of pixel (`x`, `y`); row 0 is at the top.
    pub fn ray_direction(&self, x: u32, y: u32) -> Vec3 {
        let (right, up, forward) = self.camera.basis();
        let half = self.half_extent();
        let u = (2.0 * (x as f32 + 0.5) / self.width as f32 - 1.0) * half.x;
        let v = (1.0 - 2.0 * (y as f32 + 0.5) / self.height as f32) * half.y;
        (forward + u * right + v * up).normalize()
    }
}
