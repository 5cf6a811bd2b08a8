//! In how many shadows of one light a place may be.

use std::f64::consts::TAU;

use glam::DVec3;

use crate::bsp::{Picture, Piece};
use crate::silhouette::Origin;

/// Half planes that are looked at, at most.
const MOST_RAYS: usize = 256;

/// Most shadows over each other, as far as half planes through the light meet them: each counts what it crosses, from a
/// `pole` on that lies in `at_pole` shadows (of a parallel light: in none). Shadows go on without end, so that
/// nowhere are more than far away from the light, and what the light sees says it all.
pub(crate) fn deepest(
    origin: Origin,
    pieces: &[Piece],
    pole: DVec3,
    at_pole: impl FnOnce() -> u32,
    enough: u32,
) -> u32 {
    // A shadow is bounded by three edges or more.
    let weight: u64 = pieces.iter().map(|piece| u64::from(piece.weight)).sum();
    if weight <= 3 * u64::from(enough) {
        return 0;
    }
    let picture = Picture::new(origin, pieces.iter().flat_map(|piece| [piece.from, piece.to]));
    let parallel = origin.0.w == 0.0;
    // Beside all that a parallel light sees, which is about 1 large and lies around 0.
    let seen = DVec3::new(-3.0, -2.3, 1.0);
    let (pole, start) = if parallel { (DVec3::Z, 0) } else { (pole.normalize(), i64::from(at_pole())) };
    let (u, v) = pole.any_orthonormal_pair();
    let flat = |q: DVec3| if parallel { q - seen } else { q.normalize_or_zero() };
    let azimuth = |q: DVec3| q.dot(v).atan2(q.dot(u)).rem_euclid(TAU);
    let arcs: Vec<([DVec3; 2], [f64; 2], i64)> = pieces
        .iter()
        .map(|piece| {
            let ends = [piece.from, piece.to].map(|p| flat(picture.of(p.as_dvec3())));
            (ends, ends.map(azimuth), i64::from(piece.weight))
        })
        .collect();
    // Between the ends of arcs, so that none is met at its end.
    let mut ends: Vec<f64> = arcs.iter().flat_map(|(_, azimuths, _)| *azimuths).collect();
    ends.sort_unstable_by(f64::total_cmp);
    ends.dedup();
    let between: Vec<f64> = ends.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let stride = between.len().div_ceil(MOST_RAYS).max(1);
    let rays: Vec<f64> = between.into_iter().step_by(stride).collect();

    let mut met: Vec<Vec<(f64, i64)>> = vec![Vec::new(); rays.len()];
    for ([a, b], azimuths, weight) in arcs {
        let [low, high] = if azimuths[0] <= azimuths[1] { azimuths } else { [azimuths[1], azimuths[0]] };
        // The shorter way round.
        let parts =
            if high - low <= 0.5 * TAU { [[low, high], [0.0, 0.0]] } else { [[0.0, low], [high, TAU]] };
        for [from, to] in parts {
            let first = rays.partition_point(|ray| *ray < from);
            for (ray, met) in rays.iter().zip(&mut met).skip(first).take_while(|(ray, _)| **ray < to) {
                let towards = ray.cos() * u + ray.sin() * v;
                let across = pole.cross(towards);
                let (da, db) = (across.dot(a), across.dot(b));
                let at = a.lerp(b, (da / (da - db)).clamp(0.0, 1.0));
                let place = if parallel { at.dot(towards) } else { at.dot(towards).atan2(at.dot(pole)) };
                // Seen from the light, the shadow lies to the left of the edge; a parallel light's picture is mirrored.
                met.push((place, if (da < db) == parallel { -weight } else { weight }));
            }
        }
    }
    let deepest = |crossings: &mut Vec<(f64, i64)>| {
        crossings.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let depths = crossings.iter().scan(start, |depth, (_, change)| {
            *depth += change;
            Some(*depth)
        });
        depths.max().unwrap_or(start)
    };
    let most = met.iter_mut().map(deepest).max().unwrap_or(start).max(start);
    u32::try_from(most).unwrap_or(0)
}
