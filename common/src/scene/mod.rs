//! Scenes as plain data: meshes, materials, lights, a medium, a camera and their motion.

pub mod animation;
pub mod builtin;
#[cfg(feature = "files")]
pub(crate) mod content;
#[cfg(feature = "files")]
mod gltf;
#[cfg(feature = "files")]
mod json;
#[cfg(feature = "files")]
pub mod load;
pub mod mesh;
#[cfg(feature = "files")]
mod obj;

use std::sync::Arc;

use glam::{Affine3A, Vec3};

pub use animation::Track;
pub use mesh::Mesh;

use crate::{Camera, Cloud, Light, Medium, Sky};

/// Everything that a frame is made of.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name, as shown in tables.
    pub name: String,
    /// What stands in the scene.
    pub objects: Vec<Object>,
    /// What the triangles refer to; never empty.
    pub materials: Vec<Material>,
    /// Light sources.
    pub lights: Vec<Light>,
    /// The medium that fills all space.
    pub medium: Medium,
    /// A cloud in it, if there is one.
    pub cloud: Option<Cloud>,
    /// Light from all around; only the cloud sees it.
    pub sky: Sky,
    /// Where the eye is.
    pub camera: Camera,
    /// How things move; see [`Scene::at`].
    pub animation: Vec<Track>,
    /// What the loader wants the user to know, one sentence each.
    pub notes: Vec<String>,
}

/// A mesh at a place.
#[derive(Clone, Debug)]
pub struct Object {
    /// Name, for messages and animation.
    pub name: String,
    /// Shape, in object space.
    pub mesh: Arc<Mesh>,
    /// Placement in the world; its linear part is invertible.
    pub world_from_object: Affine3A,
}

/// How a surface reflects: `k_d/π + k_s (n+2)/2π cosⁿ`, and nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name, for messages.
    pub name: String,
    /// Diffuse reflectance, RGB in [0, 1].
    pub k_d: Vec3,
    /// Specular reflectance, RGB in [0, 1].
    pub k_s: Vec3,
    /// Phong exponent, at least 0.
    pub exponent: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self { name: "default".into(), k_d: Vec3::splat(0.5), k_s: Vec3::ZERO, exponent: 1.0 }
    }
}

/// A triangle in world space, with what shading needs.
#[derive(Clone, Copy, Debug)]
pub struct WorldTriangle {
    /// Corners \[m\].
    pub positions: [Vec3; 3],
    /// Unit shading normals at the corners.
    pub normals: [Vec3; 3],
    /// Index into [`Scene::materials`].
    pub material: u32,
}

impl Scene {
    /// A scene without anything in it.
    pub fn empty(name: &str) -> Self {
        Self {
            name: name.into(),
            objects: Vec::new(),
            materials: vec![Material::default()],
            lights: Vec::new(),
            medium: Medium::vacuum(),
            cloud: None,
            sky: Sky::Black,
            camera: Camera::default(),
            animation: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Number of triangles of all objects.
    pub fn triangle_count(&self) -> usize {
        self.objects.iter().map(|object| object.mesh.triangles.len()).sum()
    }

    /// The scene at `time` \[s\]: the same meshes, everything that moves put in its place.
    pub fn at(&self, time: f32) -> Self {
        let mut scene = self.clone();
        for track in &self.animation {
            track.apply(&mut scene, time);
        }
        scene
    }

    /// All triangles in world space, in the order of objects and of their triangles. Where a mesh
    /// has no normals, the corners carry the triangle's own.
    pub fn world_triangles(&self) -> Vec<WorldTriangle> {
        let mut all = Vec::with_capacity(self.triangle_count());
        for object in &self.objects {
            let place = object.world_from_object;
            // Normals transform by the inverse transpose.
            let normal_from_object = place.matrix3.inverse().transpose();
            for (index, &corners) in object.mesh.triangles.iter().enumerate() {
                let positions = corners.map(|v| place.transform_point3(object.mesh.positions[v as usize]));
                let flat =
                    (positions[1] - positions[0]).cross(positions[2] - positions[0]).normalize_or_zero();
                let normals = if object.mesh.normals.is_empty() {
                    [flat; 3]
                } else {
                    corners.map(|v| {
                        let normal = normal_from_object * object.mesh.normals[v as usize];
                        normal.try_normalize().unwrap_or(flat)
                    })
                };
                let material = object.mesh.materials.get(index).copied().unwrap_or(0);
                all.push(WorldTriangle { positions, normals, material });
            }
        }
        all
    }

    /// Smallest box around all triangles, lowest and highest corner \[m\]; `None` without triangles.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let mut bounds: Option<(Vec3, Vec3)> = None;
        for object in &self.objects {
            for &position in &object.mesh.positions {
                let p = object.world_from_object.transform_point3(position);
                bounds = Some(bounds.map_or((p, p), |(low, high)| (low.min(p), high.max(p))));
            }
        }
        bounds
    }

    /// What is wrong with this scene, if anything: one sentence.
    pub fn problem(&self) -> Option<String> {
        for (index, light) in self.lights.iter().enumerate() {
            if let Some(problem) = light.problem() {
                return Some(format!("light {index} ({}) {problem}", light.kind()));
            }
        }
        if let Some(problem) = self.medium.problem() {
            return Some(format!("the medium {problem}"));
        }
        if let Some(problem) = self.cloud.as_ref().and_then(Cloud::problem) {
            return Some(format!("the cloud {problem}"));
        }
        if let Some(problem) = self.sky.problem() {
            return Some(format!("the sky {problem}"));
        }
        if let Some(problem) = self.camera.problem() {
            return Some(format!("the camera {problem}"));
        }
        for (index, track) in self.animation.iter().enumerate() {
            if let Some(problem) = track.problem(self) {
                return Some(format!("motion track {index}: {problem}"));
            }
        }
        None
    }
}
