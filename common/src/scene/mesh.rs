//! Triangle meshes, and what their topology is like.

use glam::Vec3;

/// Triangles over shared vertices, in object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions \[m\]; finite.
    pub positions: Vec<Vec3>,
    /// Unit shading normals, one per vertex, or none at all for flat shading.
    pub normals: Vec<Vec3>,
    /// Corners, counter-clockwise seen from outside; each below `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
    /// Material of each triangle (index into `Scene::materials`), or empty: all of material 0.
    pub materials: Vec<u32>,
}
