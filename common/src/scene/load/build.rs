//! What the model loaders share: welding triangles into a mesh, and taming materials.

use std::collections::HashMap;
use std::path::Path;

use glam::Vec3;

use super::{LoadError, MAX_COORDINATE, MAX_TRIANGLES, some_of};
use crate::scene::{Material, Mesh};

/// Collects triangles into one mesh. Corners of one position (and one normal, where the file has
/// normals) become one vertex, whatever material or group they belong to.
pub(crate) struct MeshBuilder {
    mesh: Mesh,
    vertices: HashMap<[u32; 6], u32>,
    has_normals: bool,
    /// Triangles dropped: a corner was NaN, infinite or too far out.
    pub(crate) dropped: usize,
}

impl MeshBuilder {
    /// `has_normals`: whether any corner will have one.
    pub(crate) fn new(has_normals: bool) -> Self {
        Self { mesh: Mesh::default(), vertices: HashMap::new(), has_normals, dropped: 0 }
    }

    /// Adds a triangle; a normal that is zero or not finite becomes the triangle's own.
    pub(crate) fn push(
        &mut self,
        positions: [Vec3; 3],
        normals: [Vec3; 3],
        material: u32,
        path: &Path,
    ) -> Result<(), LoadError> {
        if !positions.iter().all(|&p| is_usable(p)) {
            self.dropped += 1;
            return Ok(());
        }
        if self.mesh.triangles.len() >= MAX_TRIANGLES {
            let problem = format!("more than {MAX_TRIANGLES} triangles; expected a smaller model");
            return Err(LoadError::invalid(path, "", problem));
        }
        let flat = face_normal(positions);
        let triangle = [0, 1, 2].map(|corner| {
            let normal = if self.has_normals {
                let given = normals[corner].as_dvec3();
                given.try_normalize().map_or(flat, |n| n.as_vec3())
            } else {
                Vec3::ZERO
            };
            self.vertex(positions[corner], normal)
        });
        self.mesh.triangles.push(triangle);
        self.mesh.materials.push(material);
        Ok(())
    }

    fn vertex(&mut self, position: Vec3, normal: Vec3) -> u32 {
        // Adding zero makes −0 the same as +0.
        let [p, n] = [position + 0.0, normal + 0.0].map(|v| v.to_array().map(f32::to_bits));
        let next = self.mesh.positions.len() as u32;
        *self.vertices.entry([p[0], p[1], p[2], n[0], n[1], n[2]]).or_insert_with(|| {
            self.mesh.positions.push(position);
            if self.has_normals {
                self.mesh.normals.push(normal);
            }
            next
        })
    }

    /// The mesh.
    pub(crate) fn finish(self) -> Mesh {
        self.mesh
    }
}

/// Whether a position is finite and not too far out.
pub(super) fn is_usable(position: Vec3) -> bool {
    // NaN fails this comparison too.
    position.abs().cmple(Vec3::splat(MAX_COORDINATE)).all()
}

/// Unit normal of a triangle, in double precision; some unit vector where it has no area.
fn face_normal(positions: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = positions.map(|p| p.as_dvec3());
    (b - a).cross(c - a).try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
}

/// Names of materials that had to be changed.
#[derive(Default)]
pub(crate) struct MaterialNotes {
    out_of_range: Vec<String>,
    too_bright: Vec<String>,
}

impl MaterialNotes {
    /// Adds what there is to say about the materials of `file`.
    pub(crate) fn say(self, file: &str, notes: &mut Vec<String>) {
        if !self.out_of_range.is_empty() {
            let names = some_of(&self.out_of_range);
            notes.push(format!("{file}: reflectances outside 0 to 1 were clamped in material {names}"));
        }
        if !self.too_bright.is_empty() {
            let names = some_of(&self.too_bright);
            notes.push(format!("{file}: k_d + k_s above 1 was scaled down to 1 in material {names}"));
        }
    }
}

/// A material that keeps to the rules (reflectances in 0 to 1 that add up to at most 1, exponent not
/// negative), from numbers that may not.
pub(crate) fn raw_material(
    name: &str,
    k_d: Vec3,
    k_s: Vec3,
    exponent: f32,
    changed: &mut MaterialNotes,
) -> Material {
    let name: String = name.chars().take(200).collect();
    let clamp =
        |k: Vec3| Vec3::from_array(k.to_array().map(|x| if x.is_nan() { 0.0 } else { x.clamp(0.0, 1.0) }));
    let (mut d, mut s) = (clamp(k_d), clamp(k_s));
    if (d, s) != (k_d, k_s) {
        changed.out_of_range.push(name.clone());
    }
    let most = (d + s).max_element();
    if most > 1.0 {
        // A hair of rounding, as of base colours split by metalness, is not worth a note.
        if most > 1.0 + 1e-5 {
            changed.too_bright.push(name.clone());
        }
        d /= most;
        s /= most;
    }
    let exponent = if exponent.is_nan() { 1.0 } else { exponent.clamp(0.0, 10_000.0) };
    Material { name, k_d: d, k_s: s, exponent }
}
