//! Triangulation of plane polygons with holes: holes are joined to the outline by bridges, ears are
//! cut off, and edges are flipped until the triangles are as round as they can be.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

use glam::Vec2;

/// Triangles over the points of an outline and its holes.
pub(super) struct Triangulation {
    /// All points: outline, then hole by hole.
    pub points: Vec<Vec2>,
    /// Counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
    /// First point of each loop, and the end.
    starts: Vec<u32>,
}

impl Triangulation {
    /// The edges of outline and holes, each with the inside to its left.
    pub(super) fn loop_edges(&self) -> impl Iterator<Item = (u32, u32)> {
        self.starts.windows(2).flat_map(|ends| {
            let (start, end) = (ends[0], ends[1]);
            (start..end).map(move |i| (i, if i + 1 == end { start } else { i + 1 }))
        })
    }
}

/// Triangulates a simple polygon with holes that lie inside and apart; either orientation will do.
pub(super) fn triangulate(outline: &[Vec2], holes: &[Vec<Vec2>]) -> Triangulation {
    let mut points = Vec::new();
    let mut starts = vec![0];
    for (index, points_of_loop) in std::iter::once(outline).chain(holes.iter().map(Vec::as_slice)).enumerate()
    {
        let counter_clockwise = area(points_of_loop) > 0.0;
        if counter_clockwise == (index == 0) {
            points.extend_from_slice(points_of_loop);
        } else {
            points.extend(points_of_loop.iter().rev());
        }
        starts.push(points.len() as u32);
    }
    let mut triangulation = Triangulation { points, triangles: Vec::new(), starts };
    let ring = bridged(&triangulation);
    triangulation.triangles = cut_ears(&triangulation.points, ring);
    make_round(&triangulation.points, &mut triangulation.triangles);
    triangulation
}

fn area(points: &[Vec2]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| a.as_dvec2().perp_dot(b.as_dvec2())).sum()
}

/// Twice the area of a triangle, positive where it runs counter-clockwise.
fn turn(a: Vec2, b: Vec2, c: Vec2) -> f64 {
    let (a, b, c) = (a.as_dvec2(), b.as_dvec2(), c.as_dvec2());
    (b - a).perp_dot(c - a)
}

/// Whether two segments have a point in common, ends included.
fn meet(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> bool {
    let apart = |p: f64, q: f64| (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0);
    let boxes_overlap = a.min(b).cmple(c.max(d)).all() && c.min(d).cmple(a.max(b)).all();
    boxes_overlap && !apart(turn(a, b, c), turn(a, b, d)) && !apart(turn(c, d, a), turn(c, d, b))
}

/// One ring of points, outline and holes joined by bridges that it runs both ways.
fn bridged(flat: &Triangulation) -> Vec<u32> {
    let points = &flat.points;
    let at = |i: u32| points[i as usize];
    let mut walls: Vec<(u32, u32)> = flat.loop_edges().collect();
    let mut ring: Vec<u32> = (flat.starts[0]..flat.starts[1]).collect();
    let mut left: Vec<(u32, u32)> = flat.starts[1..].windows(2).map(|ends| (ends[0], ends[1])).collect();
    while !left.is_empty() {
        // Shortest first. A point that has a bridge already would leave open where to insert.
        let mut pairs: Vec<(Reverse<u32>, usize, u32, usize)> = Vec::new();
        for (place, &from) in ring.iter().enumerate() {
            if ring.iter().filter(|&&other| other == from).count() > 1 {
                continue;
            }
            for (hole, &(start, end)) in left.iter().enumerate() {
                // Bits of floats that are not negative are ordered as the floats are.
                let length = |to: u32| Reverse(at(from).distance_squared(at(to)).to_bits());
                pairs.extend((start..end).map(|to| (length(to), place, to, hole)));
            }
        }
        let mut pairs = BinaryHeap::from(pairs);
        let free = |from: u32, to: u32| {
            walls.iter().all(|&(a, b)| {
                let shares = |i: u32| i == from || i == to;
                shares(a) || shares(b) || !meet(at(from), at(to), at(a), at(b))
            })
        };
        let bridge = std::iter::from_fn(|| pairs.pop()).find(|&(_, place, to, _)| free(ring[place], to));
        let Some((_, place, to, hole)) = bridge else {
            debug_assert!(false, "a hole that no bridge reaches");
            break;
        };
        let (start, end) = left.swap_remove(hole);
        let from = ring[place];
        let around = (to..end).chain(start..to).chain([to, from]);
        ring.splice(place + 1..place + 1, around);
        walls.push((from, to));
    }
    ring
}

fn cut_ears(points: &[Vec2], mut ring: Vec<u32>) -> Vec<[u32; 3]> {
    let at = |i: u32| points[i as usize];
    let mut triangles = Vec::with_capacity(ring.len().saturating_sub(2));
    let mut place = 0;
    let mut tried = 0;
    while ring.len() > 2 && tried < ring.len() {
        let count = ring.len();
        let corner = [ring[(place + count - 1) % count], ring[place % count], ring[(place + 1) % count]];
        let [a, b, c] = corner.map(at);
        let inside = |p: Vec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
        let is_ear = turn(a, b, c) > 1e-9 && !ring.iter().any(|&i| !corner.contains(&i) && inside(at(i)));
        if is_ear {
            triangles.push(corner);
            ring.remove(place % count);
            tried = 0;
        } else {
            tried += 1;
        }
        // Going on by two corners keeps one point from becoming the hub of a fan.
        place = (place + 1) % ring.len().max(1);
    }
    debug_assert!(ring.len() <= 2, "{} points that no ear holds", ring.len());
    triangles
}

/// Flips inner edges whose opposite angles are together more than half a turn (Lawson).
fn make_round(points: &[Vec2], triangles: &mut [[u32; 3]]) {
    let at = |i: u32| points[i as usize];
    // The triangle to the left of each directed edge.
    let mut left_of: HashMap<(u32, u32), usize> = HashMap::new();
    let mut stack = Vec::new();
    let edges = |[a, b, c]: [u32; 3]| [(a, b), (b, c), (c, a)];
    for (index, &corners) in triangles.iter().enumerate() {
        for edge in edges(corners) {
            left_of.insert(edge, index);
            stack.push(edge);
        }
    }
    let third = |corners: [u32; 3], (a, b): (u32, u32)| corners.into_iter().find(|&v| v != a && v != b);
    // The number of flips has a bound; the limit only guards against rounding.
    let mut flips = 0;
    while let Some((a, b)) = stack.pop() {
        let (Some(&t), Some(&s)) = (left_of.get(&(a, b)), left_of.get(&(b, a))) else { continue };
        let (Some(c), Some(d)) = (third(triangles[t], (a, b)), third(triangles[s], (a, b))) else { continue };
        let cosine = |at_corner: u32| {
            let (u, v) = ((at(a) - at(at_corner)).as_dvec2(), (at(b) - at(at_corner)).as_dvec2());
            u.normalize().dot(v.normalize())
        };
        // Angles γ + δ > π exactly where cos γ < -cos δ.
        let convex = turn(at(c), at(d), at(b)) > 1e-9 && turn(at(d), at(c), at(a)) > 1e-9;
        if !(convex && cosine(c) + cosine(d) < -1e-6) || flips > 20 * points.len() * points.len() {
            continue;
        }
        flips += 1;
        left_of.remove(&(a, b));
        left_of.remove(&(b, a));
        triangles[t] = [c, d, b];
        triangles[s] = [d, c, a];
        for index in [t, s] {
            for edge in edges(triangles[index]) {
                left_of.insert(edge, index);
                stack.push(edge);
            }
        }
    }
}
