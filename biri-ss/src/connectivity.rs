//! What a mesh's triangles share, found once: the ground of every silhouette.
//!
//! Vertices at one position count as one. An edge between exactly two triangles that run it in opposite
//! ways is *simple*; every other edge (open, non-manifold, flipped) keeps a list of its triangles.
//! Triangles hang together in components over their edges; a component of simple edges only is *closed*.
//! Open edges are cut where another open edge's end lies on them (T-junctions), so that what looks closed
//! is closed.

use std::collections::HashMap;

use common::scene::Mesh;
use glam::{DVec3, DVec4, Vec3};

/// An edge between two triangles: `forward` runs it from `low` to `high`, `backward` the other way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SimpleEdge {
    pub(crate) low: u32,
    pub(crate) high: u32,
    pub(crate) forward: u32,
    pub(crate) backward: u32,
}

/// Any other edge: its triangles are `incidents[first..first + count]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GeneralEdge {
    pub(crate) low: u32,
    pub(crate) high: u32,
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// Triangles that hang together.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    pub(crate) closed: bool,
    pub(crate) triangles: Vec<u32>,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
}

/// A run of triangles and the box around them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
}

/// Triangles of one [`Block`].
pub(crate) const BLOCK: usize = 64;

/// A mesh's connectivity, in object space.
#[derive(Clone, Debug)]
pub struct Connectivity {
    /// Positions by welded vertex; some are used by no triangle.
    pub(crate) positions: Vec<Vec3>,
    /// Corners, counter-clockwise seen from outside; closed components are right side out.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Plane of each triangle: normal and offset; positive on the side it faces.
    pub(crate) planes: Vec<DVec4>,
    pub(crate) simple: Vec<SimpleEdge>,
    pub(crate) general: Vec<GeneralEdge>,
    /// Triangle, and whether it runs the edge from `low` to `high`.
    pub(crate) incidents: Vec<(u32, bool)>,
    pub(crate) component_of: Vec<u32>,
    pub(crate) components: Vec<Component>,
    pub(crate) blocks: Vec<Block>,
    report: Report,
}

/// What a mesh is like as a caster of shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Triangles that cast shadows.
    pub triangles: usize,
    /// Triangles left out because they are collapsed to an edge or a point.
    pub collapsed: usize,
    /// Pieces of closed surface: these take the classical rule, one plane for each silhouette edge.
    pub closed_components: usize,
    /// Pieces that are not closed: every triangle of these throws a shadow of its own.
    pub open_components: usize,
    /// Edges that are not between two triangles of one orientation.
    pub general_edges: usize,
    /// Places where the end of one open edge lies on another.
    pub t_junctions: usize,
}

impl Connectivity {
    /// Finds what the triangles of `mesh` share. The mesh is valid ([`Mesh::validate`]).
    pub fn new(mesh: &Mesh) -> Self {
        let welded = mesh.welded_vertices();
        let all = mesh.triangles.iter().map(|corners| corners.map(|v| welded[v as usize]));
        let mut triangles: Vec<[u32; 3]> = all.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        let positions = mesh.positions.clone();
        let mut halves = half_edges(&triangles);
        let t_junctions = cut_at_junctions(&mut halves, &positions);
        let mut edges = Edges::of(&halves);
        let mut components = components(&edges, triangles.len());
        for component in &mut components {
            let mut bounds = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let corners = |&t: &u32| triangles[t as usize].map(|v| positions[v as usize].as_dvec3());
            for p in component.triangles.iter().flat_map(corners) {
                bounds = (bounds.0.min(p), bounds.1.max(p));
            }
            (component.low, component.high) = bounds;
            let middle = 0.5 * (bounds.0 + bounds.1);
            let volume: f64 = component
                .triangles
                .iter()
                .map(|t| {
                    let [a, b, c] = corners(t).map(|p| p - middle);
                    a.dot(b.cross(c))
                })
                .sum();
            if component.closed && volume < 0.0 {
                for &t in &component.triangles {
                    triangles[t as usize].swap(1, 2);
                }
                edges.turn(&component.triangles);
            }
        }
        let mut component_of = vec![0; triangles.len()];
        for (index, component) in components.iter().enumerate() {
            component.triangles.iter().for_each(|&t| component_of[t as usize] = index as u32);
        }
        let corners = |corners: &[u32; 3]| corners.map(|v| positions[v as usize].as_dvec3());
        let planes = triangles.iter().map(|t| {
            let [a, b, c] = corners(t);
            let normal = (b - a).cross(c - a);
            normal.extend(-normal.dot(a))
        });
        let blocks = triangles.chunks(BLOCK).map(|run| {
            let points = run.iter().flat_map(corners);
            let empty = Block { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
            points.fold(empty, |b, p| Block { low: b.low.min(p), high: b.high.max(p) })
        });
        let closed = components.iter().filter(|component| component.closed).count();
        Self {
            planes: planes.collect(),
            blocks: blocks.collect(),
            report: Report {
                triangles: triangles.len(),
                collapsed: mesh.triangles.len() - triangles.len(),
                closed_components: closed,
                open_components: components.len() - closed,
                general_edges: edges.general.len(),
                t_junctions,
            },
            positions,
            triangles,
            simple: edges.simple,
            general: edges.general,
            incidents: edges.incidents,
            component_of,
            components,
        }
    }

    /// Position of a welded vertex, in object space.
    pub fn position(&self, vertex: u32) -> Vec3 {
        self.positions[vertex as usize]
    }

    /// What was found.
    pub fn report(&self) -> Report {
        self.report
    }

    /// Lowest and highest corner of the box around all triangles.
    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.components.iter().fold(empty, |(low, high), c| (low.min(c.low), high.max(c.high)))
    }

    /// Corners of a triangle, in object space.
    pub(crate) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }
}

/// One side of one triangle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Half {
    low: u32,
    high: u32,
    triangle: u32,
    forward: bool,
}

fn half(from: u32, to: u32, triangle: u32) -> Half {
    Half { low: from.min(to), high: from.max(to), triangle, forward: from < to }
}

/// All sides of all triangles, those of one edge side by side.
fn half_edges(triangles: &[[u32; 3]]) -> Vec<Half> {
    let mut halves = Vec::with_capacity(3 * triangles.len());
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        halves.extend([(a, b), (b, c), (c, a)].map(|(from, to)| half(from, to, index as u32)));
    }
    halves.sort_unstable();
    halves
}

fn same_edge(a: &Half, b: &Half) -> bool {
    (a.low, a.high) == (b.low, b.high)
}

/// Whether the triangles on this edge leave it open.
fn is_open(edge: &[Half]) -> bool {
    2 * edge.iter().filter(|half| half.forward).count() != edge.len()
}

/// Cuts open edges where ends of other open edges lie on them; gives how many such places there are.
fn cut_at_junctions(halves: &mut Vec<Half>, positions: &[Vec3]) -> usize {
    let open: Vec<(u32, u32)> =
        halves.chunk_by(same_edge).filter(|edge| is_open(edge)).map(|e| (e[0].low, e[0].high)).collect();
    if open.is_empty() {
        return 0;
    }
    let mut ends: Vec<u32> = open.iter().flat_map(|&(a, b)| [a, b]).collect();
    ends.sort_unstable();
    ends.dedup();
    let at = |v: u32| positions[v as usize].as_dvec3();
    let (low, high) = ends
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &v| (low.min(at(v)), high.max(at(v))));
    // Cells of which a line crosses few and a cell holds few ends.
    let side = (high - low).max_element().max(f64::MIN_POSITIVE) / (ends.len() as f64).cbrt().max(1.0);
    let cell = |p: DVec3| ((p - low) / side).floor().as_i64vec3();
    let mut grid: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for &v in &ends {
        grid.entry(cell(at(v)).to_array()).or_default().push(v);
    }
    // What f32 coordinates of this size resolve.
    let tolerance = 4e-7 * low.abs().max(high.abs()).max_element();
    let mut cuts: HashMap<(u32, u32), Vec<u32>> = HashMap::new();
    let mut junctions = 0;
    for &(a, b) in &open {
        let (from, to) = (at(a), at(b));
        let (length, along) = (from.distance(to), (to - from).normalize_or_zero());
        let (first, last) = (cell(from.min(to) - tolerance), cell(from.max(to) + tolerance));
        let mut on: Vec<(f64, u32)> = Vec::new();
        for x in first.x..=last.x {
            for y in first.y..=last.y {
                for z in first.z..=last.z {
                    for &v in grid.get(&[x, y, z]).map_or(&[][..], Vec::as_slice) {
                        let offset = at(v) - from;
                        let t = offset.dot(along);
                        let inside = t > tolerance && t < length - tolerance;
                        if v != a && v != b && inside && (offset - t * along).length() < tolerance {
                            on.push((t, v));
                        }
                    }
                }
            }
        }
        on.sort_by(|a, b| a.0.total_cmp(&b.0));
        junctions += on.len();
        if !on.is_empty() {
            cuts.insert((a, b), on.into_iter().map(|(_, v)| v).collect());
        }
    }
    if junctions > 0 {
        let pieces = |whole: &Half| {
            let Some(cuts) = cuts.get(&(whole.low, whole.high)) else { return vec![*whole] };
            let chain = std::iter::once(&whole.low).chain(cuts).chain([&whole.high]);
            let chain: Vec<u32> = chain.copied().collect();
            let piece = |pair: &[u32]| {
                let [from, to] = if whole.forward { [pair[0], pair[1]] } else { [pair[1], pair[0]] };
                half(from, to, whole.triangle)
            };
            chain.windows(2).map(piece).collect()
        };
        *halves = halves.iter().flat_map(pieces).collect();
        halves.sort_unstable();
    }
    junctions
}

/// All edges.
struct Edges {
    simple: Vec<SimpleEdge>,
    general: Vec<GeneralEdge>,
    incidents: Vec<(u32, bool)>,
}

impl Edges {
    fn of(halves: &[Half]) -> Self {
        let mut edges = Self { simple: Vec::new(), general: Vec::new(), incidents: Vec::new() };
        for edge in halves.chunk_by(same_edge) {
            let Half { low, high, .. } = edge[0];
            match edge {
                [a, b] if a.forward != b.forward => {
                    let (f, b) = if a.forward { (a, b) } else { (b, a) };
                    edges.simple.push(SimpleEdge { low, high, forward: f.triangle, backward: b.triangle });
                }
                _ => {
                    let first = edges.incidents.len() as u32;
                    edges.incidents.extend(edge.iter().map(|half| (half.triangle, half.forward)));
                    edges.general.push(GeneralEdge { low, high, first, count: edge.len() as u32 });
                }
            }
        }
        edges
    }

    /// Turns the edges of closed components whose triangles were turned.
    fn turn(&mut self, triangles: &[u32]) {
        let turned: std::collections::HashSet<u32> = triangles.iter().copied().collect();
        for edge in self.simple.iter_mut().filter(|edge| turned.contains(&edge.forward)) {
            std::mem::swap(&mut edge.forward, &mut edge.backward);
        }
    }
}

/// Triangles that hang together, in the order of their first triangle; boxes are left empty.
fn components(edges: &Edges, triangles: usize) -> Vec<Component> {
    let mut parent: Vec<u32> = (0..triangles as u32).collect();
    fn root(parent: &mut [u32], mut t: u32) -> u32 {
        while parent[t as usize] != t {
            parent[t as usize] = parent[parent[t as usize] as usize];
            t = parent[t as usize];
        }
        t
    }
    let mut join = |a: u32, b: u32| {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[a.max(b) as usize] = a.min(b);
    };
    edges.simple.iter().for_each(|edge| join(edge.forward, edge.backward));
    let incidents = |edge: &GeneralEdge| &edges.incidents[edge.first as usize..][..edge.count as usize];
    for edge in &edges.general {
        incidents(edge).windows(2).for_each(|pair| join(pair[0].0, pair[1].0));
    }
    let mut index_of = vec![u32::MAX; triangles];
    let mut found: Vec<Component> = Vec::new();
    for t in 0..triangles as u32 {
        let root = root(&mut parent, t) as usize;
        if index_of[root] == u32::MAX {
            index_of[root] = found.len() as u32;
            let (low, high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            found.push(Component { closed: true, triangles: Vec::new(), low, high });
        }
        found[index_of[root] as usize].triangles.push(t);
    }
    for edge in &edges.general {
        let root = root(&mut parent, incidents(edge)[0].0) as usize;
        found[index_of[root] as usize].closed = false;
    }
    found
}
