//! Other orders of shadow planes, and how many mistakes an order makes.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use crate::bsp::{Picture, Piece};
use crate::silhouette::Origin;

/// Directions of a piece's ends, seen from the light.
fn ends(picture: &Picture, piece: &Piece) -> [DVec3; 2] {
    [piece.from, piece.to].map(|p| picture.of(p.as_dvec3()))
}

/// Indices of whole planes in the order of the angle at the light between the eye and the middle of their
/// edge: near ones first. What the paper does; planes that cross or interleave have no such order.
pub(crate) fn by_angle(origin: Origin, pieces: &[Piece], eye: DVec3) -> Vec<u32> {
    let picture = Picture::new(origin, pieces.iter().flat_map(|piece| [piece.from, piece.to]));
    let towards_eye = origin.from(eye);
    let mut keyed: Vec<(f64, u32)> = pieces
        .iter()
        .zip(0..)
        .map(|(piece, index)| {
            let middle = 0.5 * (piece.from.as_dvec3() + piece.to.as_dvec3());
            let key = if origin.0.w == 0.0 {
                // The sun is at every point's zenith: what counts is the distance across its direction.
                (picture.of(middle) - picture.of(eye)).length()
            } else {
                towards_eye.angle_between(origin.from(middle))
            };
            (key, index)
        })
        .collect();
    keyed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    keyed.into_iter().map(|(_, index)| index).collect()
}

/// Pairs of planes that follow each other along some view ray but are drawn the other way round, found on
/// `rays` half planes through light and eye, turned evenly about the line between them.
///
/// All rays of such a half plane meet the shadow planes that it cuts in the order of their angle at the
/// light, so that one look at the half plane judges all of them.
pub(crate) fn violations(origin: Origin, pieces: &[Piece], order: &[u32], eye: Vec3, rays: u32) -> usize {
    let picture = Picture::new(origin, pieces.iter().flat_map(|piece| [piece.from, piece.to]));
    let seen = picture.of(eye.as_dvec3());
    let directional = origin.0.w == 0.0;
    // Azimuth about the eye as the light sees it.
    let pole = if directional { DVec3::Z } else { seen.normalize_or_zero() };
    let (u, v) = pole.any_orthonormal_pair();
    let flat = |q: DVec3| if directional { q - seen } else { q };
    // For each half plane: place along it, in the order of drawing.
    let mut met: Vec<Vec<f64>> = vec![Vec::new(); rays as usize];
    for &index in order {
        let [a, b] = ends(&picture, &pieces[index as usize]).map(flat);
        let azimuth = |q: DVec3| q.dot(v).atan2(q.dot(u)).rem_euclid(TAU);
        let (mut low, mut high) = (azimuth(a), azimuth(b));
        if low > high {
            std::mem::swap(&mut low, &mut high);
        }
        // The shorter way round.
        let (from, to) = if high - low <= 0.5 * TAU { (low, high) } else { (high, low + TAU) };
        let step = TAU / f64::from(rays);
        // Half planes lie at odd places, so that no symmetry of a scene meets them.
        let first = (from / step - 0.381_966).ceil() as i64;
        for ray in first.. {
            let angle = (ray as f64 + 0.381_966) * step;
            if angle >= to {
                break;
            }
            let towards = angle.cos() * u + angle.sin() * v;
            let across = pole.cross(towards);
            let (da, db) = (across.dot(a), across.dot(b));
            let at = a.lerp(b, (da / (da - db)).clamp(0.0, 1.0));
            let place = if directional { at.dot(towards) } else { at.dot(towards).atan2(at.dot(pole)) };
            met[ray.rem_euclid(i64::from(rays)) as usize].push(place);
        }
    }
    let scale = if directional { seen.length().max(1.0) } else { 1.0 };
    let wrong = |places: &Vec<f64>| {
        let mut farthest = f64::NEG_INFINITY;
        let mut count = 0;
        for &place in places {
            count += usize::from(place < farthest - 2e-6 * scale);
            farthest = farthest.max(place);
        }
        count
    };
    met.iter().map(wrong).sum()
}
