//! Triangle meshes, and what their topology is like.

use std::collections::HashMap;
use std::fmt;

use glam::{DVec3, Vec3};

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

/// What keeps a mesh from being a closed surface, counted. Vertices at exactly the same position
/// count as one, so normals may split them.
///
/// Shadow and light volumes are right only for closed 2-manifold casters: an open or non-manifold
/// edge leaks light, a flipped one counts it twice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Topology {
    /// Triangles looked at.
    pub triangles: usize,
    /// Edges of only one triangle.
    pub open_edges: usize,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges that their two triangles run the same way: one of the two faces the wrong way.
    pub flipped_edges: usize,
    /// Triangles without an area that f32 positions resolve, or with a corner that is not finite.
    pub degenerate_triangles: usize,
    /// Triangles over the same three corners as an earlier one, whichever way round.
    pub duplicate_triangles: usize,
}

impl Topology {
    /// Whether every edge lies between exactly two triangles of the same orientation, and no
    /// triangle is degenerate or there twice.
    pub fn is_closed_manifold(&self) -> bool {
        *self == Self { triangles: self.triangles, ..Self::default() }
    }
}

impl fmt::Display for Topology {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{} triangles, ", self.triangles)?;
        if self.is_closed_manifold() {
            return write!(out, "closed 2-manifold");
        }
        let faults = [
            (self.open_edges, "open edges"),
            (self.non_manifold_edges, "non-manifold edges"),
            (self.flipped_edges, "flipped edges"),
            (self.degenerate_triangles, "degenerate triangles"),
            (self.duplicate_triangles, "duplicate triangles"),
        ];
        let found: Vec<String> =
            faults.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        write!(out, "not a closed 2-manifold: {}", found.join(", "))
    }
}

impl Mesh {
    /// Height over longest edge below which a triangle has no area: what f32 positions resolve.
    const FLATTEST: f64 = 1e-7;

    /// Checks that every index is in range, every position finite and every array as long as it has
    /// to be.
    ///
    /// # Errors
    /// One clause, to be put behind the mesh's name.
    pub fn validate(&self) -> Result<(), String> {
        let vertices = self.positions.len();
        if let Some(index) = self.positions.iter().position(|p| !p.is_finite()) {
            return Err(format!("has a position that is not a finite number (vertex {index})"));
        }
        if !self.normals.is_empty() && self.normals.len() != vertices {
            return Err(format!("has {} normals for {vertices} vertices", self.normals.len()));
        }
        if !self.materials.is_empty() && self.materials.len() != self.triangles.len() {
            let (materials, triangles) = (self.materials.len(), self.triangles.len());
            return Err(format!("has {materials} material indices for {triangles} triangles"));
        }
        let out_of_range =
            |corners: &[u32; 3]| corners.iter().copied().find(|&corner| corner as usize >= vertices);
        for (index, corners) in self.triangles.iter().enumerate() {
            if let Some(corner) = out_of_range(corners) {
                return Err(format!("has a triangle ({index}) that refers to vertex {corner} of {vertices}"));
            }
        }
        Ok(())
    }

    /// Counts what keeps this mesh from being a closed 2-manifold. Triangles with an index out of
    /// range count as degenerate.
    pub fn topology(&self) -> Topology {
        let mut topology = Topology { triangles: self.triangles.len(), ..Topology::default() };
        let welded = self.welded_vertices();
        // An edge is its lower and its higher vertex, and whether it runs from high to low.
        let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * self.triangles.len());
        let mut faces: Vec<[u32; 3]> = Vec::with_capacity(self.triangles.len());
        for corners in &self.triangles {
            topology.degenerate_triangles += usize::from(self.is_degenerate(corners));
            if corners.iter().any(|&corner| corner as usize >= welded.len()) {
                continue;
            }
            let [a, b, c] = corners.map(|corner| welded[corner as usize]);
            // A triangle collapsed to an edge or a point bounds nothing; a flat one may be the
            // filling that keeps its neighbours closed.
            if a == b || b == c || c == a {
                continue;
            }
            edges.extend([(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from > to)));
            let mut face = [a, b, c];
            face.sort_unstable();
            faces.push(face);
        }
        edges.sort_unstable();
        for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            match edge.len() {
                1 => topology.open_edges += 1,
                2 => topology.flipped_edges += usize::from(edge[0].2 == edge[1].2),
                _ => topology.non_manifold_edges += 1,
            }
        }
        faces.sort_unstable();
        topology.duplicate_triangles = faces.chunk_by(|a, b| a == b).map(|same| same.len() - 1).sum();
        topology
    }

    /// Volume inside a closed mesh \[m³\]; negative where it is inside out.
    pub fn signed_volume(&self) -> f64 {
        // Measured from the mesh's own middle, where the least is lost in rounding.
        let count = self.positions.len().max(1) as f64;
        let middle = self.positions.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / count;
        let volume = |corners: &[u32; 3]| {
            let [a, b, c] = self.corners(corners)?.map(|p| p - middle);
            Some(a.dot(b.cross(c)) / 6.0)
        };
        self.triangles.iter().filter_map(volume).sum()
    }

    /// For each vertex, the first vertex at exactly the same position.
    pub fn welded_vertices(&self) -> Vec<u32> {
        let mut first: HashMap<[u32; 3], u32> = HashMap::with_capacity(self.positions.len());
        let weld = |(index, position): (usize, &Vec3)| {
            // Adding zero makes a positive zero of a negative one.
            let bits = (*position + Vec3::ZERO).to_array().map(f32::to_bits);
            *first.entry(bits).or_insert(index as u32)
        };
        self.positions.iter().enumerate().map(weld).collect()
    }

    fn corners(&self, corners: &[u32; 3]) -> Option<[DVec3; 3]> {
        let at = |corner: u32| self.positions.get(corner as usize).map(|p| p.as_dvec3());
        Some([at(corners[0])?, at(corners[1])?, at(corners[2])?])
    }

    fn is_degenerate(&self, corners: &[u32; 3]) -> bool {
        let Some([a, b, c]) = self.corners(corners) else {
            return true;
        };
        let twice_area = (b - a).cross(c - a).length();
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        // Written so that a NaN counts as degenerate.
        !(twice_area.is_finite() && twice_area > Self::FLATTEST * longest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Mesh {
        Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn closed_mesh_is_found_closed() {
        let mesh = tetrahedron();
        assert_eq!(mesh.validate(), Ok(()));
        assert!(mesh.topology().is_closed_manifold(), "{}", mesh.topology());
        assert!((mesh.signed_volume() - 1.0 / 6.0).abs() < 1e-12);
        assert_eq!(mesh.topology().to_string(), "4 triangles, closed 2-manifold");
    }

    #[test]
    fn split_vertices_are_welded_by_position() {
        let mut mesh = tetrahedron();
        let corners: Vec<Vec3> =
            mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect();
        // A negative zero is the same place as a positive one.
        mesh.positions = corners.iter().map(|p| Vec3::select(p.cmpeq(Vec3::ZERO), -*p, *p)).collect();
        mesh.triangles = (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        assert!(mesh.topology().is_closed_manifold(), "{}", mesh.topology());
    }

    #[test]
    fn missing_face_opens_edges() {
        let mut mesh = tetrahedron();
        mesh.triangles.pop();
        let topology = mesh.topology();
        assert_eq!((topology.open_edges, topology.flipped_edges), (3, 0));
        assert!(!topology.is_closed_manifold());
        assert_eq!(topology.to_string(), "3 triangles, not a closed 2-manifold: 3 open edges");
    }

    #[test]
    fn flipped_face_flips_its_edges() {
        let mut mesh = tetrahedron();
        mesh.triangles[3].swap(0, 1);
        let topology = mesh.topology();
        assert_eq!((topology.open_edges, topology.flipped_edges), (0, 3));
        assert!(!topology.is_closed_manifold());
        // All flipped alike is closed again, but inside out.
        let mut inside_out = tetrahedron();
        inside_out.triangles.iter_mut().for_each(|corners| corners.swap(0, 1));
        assert!(inside_out.topology().is_closed_manifold());
        assert!(inside_out.signed_volume() < 0.0);
    }

    #[test]
    fn t_junction_is_open() {
        let mut mesh = tetrahedron();
        // Split one face at the middle of its edge 1-2, but not the face on the other side.
        mesh.positions.push(Vec3::new(0.5, 0.5, 0.0));
        mesh.triangles[3] = [1, 4, 3];
        mesh.triangles.push([4, 2, 3]);
        assert_eq!(mesh.topology().open_edges, 3);
        // A triangle of no area closes it, and is reported.
        mesh.triangles.push([1, 2, 4]);
        let topology = mesh.topology();
        assert_eq!((topology.open_edges, topology.degenerate_triangles), (0, 1));
        assert!(!topology.is_closed_manifold());
    }

    #[test]
    fn duplicates_and_leaves_are_reported() {
        let mut mesh = tetrahedron();
        mesh.triangles.push([2, 3, 1]);
        let topology = mesh.topology();
        assert_eq!((topology.duplicate_triangles, topology.non_manifold_edges), (1, 3));
        // A leaf of two sides has no open edge but is no solid either.
        let leaf = Mesh { triangles: vec![[0, 1, 2], [0, 2, 1]], ..tetrahedron() };
        assert_eq!((leaf.topology().open_edges, leaf.topology().duplicate_triangles), (0, 1));
        assert!(!leaf.topology().is_closed_manifold());
    }

    #[test]
    fn degenerate_triangles_are_counted() {
        let mut mesh = tetrahedron();
        mesh.triangles.push([0, 0, 1]);
        assert_eq!(mesh.topology(), Topology { triangles: 5, degenerate_triangles: 1, ..Default::default() });
        mesh.positions[3].x = f32::NAN;
        assert_eq!(mesh.topology().degenerate_triangles, 4);
    }

    #[test]
    fn validate_names_what_is_wrong() {
        let broken = |change: fn(&mut Mesh)| {
            let mut mesh = tetrahedron();
            change(&mut mesh);
            mesh.validate().expect_err("broken on purpose")
        };
        assert!(broken(|m| m.triangles[2][1] = 4).contains("vertex 4 of 4"));
        assert!(broken(|m| m.positions[1].y = f32::INFINITY).contains("vertex 1"));
        assert!(broken(|m| m.normals = vec![Vec3::X]).contains("1 normals for 4"));
        assert!(broken(|m| m.materials = vec![0; 5]).contains("5 material indices for 4"));
    }
}
