//! The order of shadow planes, exactly: a binary space partition of all directions from the light.
//!
//! Every shadow plane contains the light, so seen from the light it is an arc, and a plane through the light
//! that separates arcs separates their shadow planes, too, for good: what lies on the eye's side of it comes
//! first along every view ray. The tree depends on light and casters alone; an eye anywhere reads its order
//! from one walk, without sorting. (The paper sorts by distance instead, which no order of whole planes can
//! get right: two that cross have none.) The idea is that of shadow volume BSP trees (Chin and Feiner 1989).

use glam::{DMat3, DVec3, Vec3};

use crate::silhouette::Origin;

/// A piece of a shadow plane: it reaches from the edge between two points away from the light, endlessly.
/// Seen from outside the shadow, `from`, its infinite end, and `to` run counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// One end of the edge, in the world \[m\].
    pub from: Vec3,
    /// The other end.
    pub to: Vec3,
    /// Unit normal of the plane; of either sign.
    pub normal: Vec3,
    /// How many times it counts, at least 1.
    pub weight: u32,
}

impl Piece {
    /// The plane over the edge between `ends`; none over an edge that points at the light.
    pub(crate) fn new(origin: Origin, [from, to]: [Vec3; 2], weight: u32) -> Option<Self> {
        let (a, b) = (from.as_dvec3(), to.as_dvec3());
        let (towards, along) = (origin.from(a).normalize_or_zero(), (b - a).normalize_or_zero());
        let normal = towards.cross(along);
        (normal.length() > 1e-12).then(|| Self { from, to, normal: normal.normalize().as_vec3(), weight })
    }

    /// Whether `point` is within `tolerance` \[m\] of the plane, where that reaches.
    pub(crate) fn touches(&self, origin: Origin, point: DVec3, tolerance: f64) -> bool {
        let (a, b, normal) = (self.from.as_dvec3(), self.to.as_dvec3(), self.normal.as_dvec3());
        let middle = 0.5 * (a + b);
        let inside = |side: DVec3| {
            let across = normal.cross((-origin.from(side)).normalize_or_zero());
            let towards_middle = (middle - side).dot(across);
            (point - side).dot(across) * towards_middle.signum() >= -tolerance
        };
        (point - a).dot(normal).abs() <= tolerance && inside(a) && inside(b)
    }
}

/// How the light sees the world: points become directions.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Picture {
    origin: Origin,
    /// Of a directional light: two axes across its direction, as rows, so long that the scene has a size of
    /// about 1, and its middle.
    axes: DMat3,
    middle: DVec3,
}

impl Picture {
    /// Of a world in which `points` are.
    pub(crate) fn new(origin: Origin, points: impl Iterator<Item = Vec3>) -> Self {
        if origin.0.w != 0.0 {
            return Self { origin, axes: DMat3::ZERO, middle: DVec3::ZERO };
        }
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (low, high) = points.fold(empty, |(low, high), p| (low.min(p), high.max(p)));
        let size = f64::from((high - low).length());
        let middle = 0.5 * (low + high).as_dvec3();
        let scale = if size > 0.0 && size.is_finite() { 2.0 / size } else { 1.0 };
        let towards = origin.0.truncate().normalize_or_zero();
        let side = towards.try_normalize().map_or(DVec3::X, |d| d.any_orthonormal_vector());
        let axes = DMat3::from_cols(scale * side, scale * towards.cross(side), DVec3::ZERO).transpose();
        Self { origin, axes, middle: if middle.is_finite() { middle } else { DVec3::ZERO } }
    }

    /// Direction of a point: from the light for a point light, else its place across the sun's direction, and
    /// 1.
    pub(crate) fn of(&self, point: DVec3) -> DVec3 {
        if self.origin.0.w == 0.0 {
            self.axes * (point - self.middle) + DVec3::Z
        } else {
            point - self.origin.0.truncate()
        }
    }

    /// Length of a metre across the plane normals of the picture.
    fn unit(&self) -> f64 {
        if self.origin.0.w == 0.0 { self.axes.row(0).length() } else { 1.0 }
    }
}

/// An arc while the tree grows: directions of the ends of a piece.
#[derive(Clone, Copy, Debug)]
struct Arc {
    from: DVec3,
    to: DVec3,
    /// Unit normal of the arc's plane in the picture.
    normal: DVec3,
    piece: Piece,
}

/// A separating plane through the light: the pieces on it, and what lies on either side.
#[derive(Clone, Copy, Debug)]
struct Node {
    normal: DVec3,
    pieces: [u32; 2],
    negative: u32,
    positive: u32,
}

const NONE: u32 = u32::MAX;

/// The tree of one light.
#[derive(Clone, Debug, Default)]
pub struct Bsp {
    picture: Picture,
    nodes: Vec<Node>,
    pieces: Vec<Piece>,
}

/// Angle \[rad\] within which a direction counts as on a plane: a few roundings of f32 coordinates.
const ON: f64 = 2e-7;
/// From so many arcs on, the two halves of a tree are built side by side.
const PARALLEL: usize = 1500;
/// Arcs that are looked at to rate a separating plane.
const SAMPLE: usize = 40;

fn side(normal: DVec3, direction: DVec3) -> f64 {
    let value = normal.dot(direction);
    if value.abs() <= ON * direction.length() { 0.0 } else { value }
}

impl Bsp {
    /// Builds the tree of the shadow planes over `edges`: ends in the world and weight.
    pub fn new(origin: Origin, edges: &[([Vec3; 2], u32)]) -> Self {
        let picture = Picture::new(origin, edges.iter().flat_map(|(ends, _)| *ends));
        let arcs = edges.iter().filter_map(|&([from, to], weight)| {
            let (a, b) = (picture.of(from.as_dvec3()), picture.of(to.as_dvec3()));
            let piece = Piece::new(origin, [from, to], weight)?;
            // As a difference, which keeps its digits where the edge is short.
            let normal = a.cross(b - a).try_normalize()?;
            Some(Arc { from: a, to: b, normal, piece })
        });
        let mut bsp = Self { picture, ..Self::default() };
        bsp.grow(arcs.collect());
        bsp
    }

    /// The pieces; what [`Bsp::order`] gives are indices into them.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Indices of all pieces in the order in which every ray from `eye` meets them.
    pub fn order(&self, eye: Vec3) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.pieces.len());
        self.front_to_back(eye.as_dvec3(), 0.0, |piece| order.push(piece), |_| {});
        order
    }

    /// Adds a tree of `arcs`; gives its root.
    fn grow(&mut self, arcs: Vec<Arc>) -> u32 {
        if arcs.is_empty() {
            return NONE;
        }
        let normal = separating_plane(&arcs);
        let (mut on, mut negative, mut positive) = (Vec::new(), Vec::new(), Vec::new());
        for arc in arcs {
            let (a, b) = (side(normal, arc.from), side(normal, arc.to));
            match (a, b) {
                _ if a == 0.0 && b == 0.0 => on.push(arc.piece),
                _ if a >= 0.0 && b >= 0.0 => positive.push(arc),
                _ if a <= 0.0 && b <= 0.0 => negative.push(arc),
                _ => {
                    let [first, second] = split(&arc, a / (a - b));
                    let (low, high) = if a < 0.0 { (first, second) } else { (second, first) };
                    negative.push(low);
                    positive.push(high);
                }
            }
        }
        let first = self.pieces.len() as u32;
        self.pieces.extend(on);
        let node = self.nodes.len();
        let pieces = [first, self.pieces.len() as u32];
        self.nodes.push(Node { normal, pieces, negative: NONE, positive: NONE });
        let children = if negative.len().min(positive.len()) > PARALLEL / 2 {
            let tree = |arcs: Vec<Arc>| {
                let mut tree = Self::default();
                tree.grow(arcs);
                tree
            };
            let (a, b) = rayon::join(|| tree(negative), || tree(positive));
            [self.append(a), self.append(b)]
        } else {
            [self.grow(negative), self.grow(positive)]
        };
        [self.nodes[node].negative, self.nodes[node].positive] = children;
        node as u32
    }

    /// Takes another tree in; gives its root.
    fn append(&mut self, other: Self) -> u32 {
        let (nodes, pieces) = (self.nodes.len() as u32, self.pieces.len() as u32);
        let moved = |child: u32| if child == NONE { NONE } else { child + nodes };
        self.nodes.extend(other.nodes.iter().map(|node| Node {
            normal: node.normal,
            pieces: node.pieces.map(|p| p + pieces),
            negative: moved(node.negative),
            positive: moved(node.positive),
        }));
        self.pieces.extend(other.pieces);
        if other.nodes.is_empty() { NONE } else { nodes }
    }

    /// Indices of all pieces in the order in which every ray from `eye` meets them. `near` is told the
    /// pieces whose plane is as good as through the eye: within `tolerance` \[m\].
    pub(crate) fn front_to_back(
        &self,
        eye: DVec3,
        tolerance: f64,
        mut found: impl FnMut(u32),
        mut near: impl FnMut(&Piece),
    ) {
        enum Step {
            Tree(u32),
            Pieces(u32),
        }
        let seen = self.picture.of(eye);
        let tolerance = tolerance * self.picture.unit();
        let mut stack = if self.nodes.is_empty() { vec![] } else { vec![Step::Tree(0)] };
        while let Some(step) = stack.pop() {
            match step {
                Step::Tree(NONE) => {}
                Step::Tree(index) => {
                    let node = &self.nodes[index as usize];
                    let at = node.normal.dot(seen);
                    if at.abs() <= tolerance {
                        (node.pieces[0]..node.pieces[1]).for_each(|p| near(&self.pieces[p as usize]));
                    }
                    let (first, last) = if at >= 0.0 {
                        (node.positive, node.negative)
                    } else {
                        (node.negative, node.positive)
                    };
                    stack.extend([Step::Tree(last), Step::Pieces(index), Step::Tree(first)]);
                }
                Step::Pieces(index) => {
                    let [first, last] = self.nodes[index as usize].pieces;
                    (first..last).for_each(&mut found);
                }
            }
        }
    }
}

/// Two pieces of an arc, cut at `share` of its way; they have the cut's position in common.
fn split(arc: &Arc, share: f64) -> [Arc; 2] {
    let cut = arc.from.lerp(arc.to, share);
    let position = arc.piece.from.as_dvec3().lerp(arc.piece.to.as_dvec3(), share).as_vec3();
    [
        Arc { to: cut, piece: Piece { to: position, ..arc.piece }, ..*arc },
        Arc { from: cut, piece: Piece { from: position, ..arc.piece }, ..*arc },
    ]
}

/// A plane through the light that cuts few arcs and leaves about as many on one side as on the other. The
/// candidates are planes of some arcs, which are then done with, and planes across the middle.
fn separating_plane(arcs: &[Arc]) -> DVec3 {
    if let [arc] = arcs {
        return arc.normal;
    }
    let stride = arcs.len().div_ceil(SAMPLE);
    let sample: Vec<&Arc> = arcs.iter().step_by(stride).collect();
    let mut candidates: Vec<DVec3> = if arcs.len() <= SAMPLE {
        arcs.iter().map(|arc| arc.normal).collect()
    } else {
        sample.iter().step_by(3).map(|arc| arc.normal).collect()
    };
    if arcs.len() > 8 {
        candidates.extend(middle_planes(&sample));
    }
    let rate = |normal: &DVec3| {
        let (mut cut, mut on, mut balance) = (0, 0, 0_i32);
        for arc in &sample {
            let (a, b) = (side(*normal, arc.from), side(*normal, arc.to));
            match (a, b) {
                _ if a == 0.0 && b == 0.0 => on += 1,
                _ if a >= 0.0 && b >= 0.0 => balance += 1,
                _ if a <= 0.0 && b <= 0.0 => balance -= 1,
                _ => cut += 1,
            }
        }
        // Nothing is gained by a plane that everything lies on one side of.
        let idle = on == 0 && cut == 0 && balance.unsigned_abs() as usize == sample.len();
        if idle { i32::MAX } else { 4 * cut + balance.abs() - on }
    };
    let best = candidates.iter().min_by_key(|normal| rate(normal));
    best.copied().unwrap_or(arcs[0].normal)
}

/// Planes through the light that halve the arcs' middles, along a few axes.
fn middle_planes(sample: &[&Arc]) -> Vec<DVec3> {
    let middles: Vec<DVec3> = sample
        .iter()
        .map(|arc| (arc.from.normalize_or_zero() + arc.to.normalize_or_zero()).normalize_or_zero())
        .collect();
    let mean = middles.iter().sum::<DVec3>().normalize_or_zero();
    let mut planes = vec![DVec3::X, DVec3::Y, DVec3::Z];
    // Where the arcs lie to one side of the light, planes about their mean direction.
    if mean != DVec3::ZERO {
        let (across, up) = mean.any_orthonormal_pair();
        for axis in [across, up, (across + up).normalize(), (across - up).normalize()] {
            let mut places: Vec<f64> =
                middles.iter().filter(|m| m.dot(mean) > 1e-3).map(|m| m.dot(axis) / m.dot(mean)).collect();
            if places.len() > 1 {
                let half = places.len() / 2;
                let median = *places.select_nth_unstable_by(half, f64::total_cmp).1;
                planes.push((axis - median * mean).normalize());
            }
        }
    }
    planes
}
