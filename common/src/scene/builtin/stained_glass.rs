//! A picture of stained glass, drawn point by point, for lights that shine through a window.
//!
//! The window's own coordinates: half its width is 1, x from its middle line, y up from where its arch
//! springs. Its tracery is drawn to the same numbers ([`ROSE`], [`LANCETS`]).

use std::f32::consts::{FRAC_PI_3, PI, TAU};
use std::sync::Arc;

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::solids::arc;
use super::tessellate::Fineness;
use crate::{Light, LightMap, SpotLight};

/// The rose's middle height and radius.
pub(super) const ROSE: [f32; 2] = [0.95, 0.53];
/// The two lights below it: middle, half width, sill and spring of their arches.
pub(super) const LANCETS: [[f32; 4]; 2] = [[-0.5, 0.42, SILL + 0.08, -0.25], [0.5, 0.42, SILL + 0.08, -0.25]];
/// The window's sill.
pub(super) const SILL: f32 = -1.55;
/// Height of the panels that the lancets are divided into.
pub(super) const PANEL: f32 = 0.6;

/// Half the map's width and height in the window's coordinates: light from 28° above sees the window
/// foreshortened.
const HALF_MAP: Vec2 = Vec2::new(2.083, 2.083 / 0.883);
/// Height of the map's middle.
const MIDDLE: f32 = 0.09;
/// Half the width of the lead between panes.
const LEAD: f32 = 0.016;
/// The picture of the window goes so far beyond its opening; around it is plain glass.
const MARGIN: f32 = 1.12;

const RUBY: Vec3 = Vec3::new(0.90, 0.03, 0.02);
const COBALT: Vec3 = Vec3::new(0.03, 0.13, 0.95);
const GOLD: Vec3 = Vec3::new(1.00, 0.58, 0.05);
const EMERALD: Vec3 = Vec3::new(0.04, 0.62, 0.13);
const VIOLET: Vec3 = Vec3::new(0.45, 0.06, 0.62);
const PALE: Vec3 = Vec3::new(0.95, 0.88, 0.70);

/// Medallion and ground of each panel, from below, of the left and the right lancet: like colours at
/// like heights, which so stay pure in the air of a room.
const PANELS: [[[Vec3; 2]; 3]; 2] =
    [[[GOLD, RUBY], [RUBY, GOLD], [VIOLET, COBALT]], [[COBALT, RUBY], [GOLD, EMERALD], [PALE, COBALT]]];

/// A leaded window, two lancets under a rose, as a light map of `size` × `size` texels (brought into 2
/// to 4096). The window fills the middle half of the map's width and seven tenths of its height, and
/// plain quarries of glass the rest. Each texel is the mean of 4 × 4 points, so that a small map
/// is a fair copy of a large one.
pub fn stained_glass(size: u32) -> LightMap {
    const POINTS: u32 = 4;
    let size = size.clamp(2, 4096);
    let fine = (size * POINTS) as f32;
    let texel = |column: u32, row: u32| -> Vec3 {
        let points = (0..POINTS * POINTS).map(|i| {
            let at = Vec2::new((column * POINTS + i % POINTS) as f32, (row * POINTS + i / POINTS) as f32);
            let on_map = (at + 0.5) / fine * 2.0 - 1.0;
            glass(Vec2::new(on_map.x, -on_map.y) * HALF_MAP + Vec2::Y * MIDDLE)
        });
        points.sum::<Vec3>() / (POINTS * POINTS) as f32
    };
    let rows = (0..size).into_par_iter();
    let texels = rows.flat_map_iter(|row| (0..size).map(move |column| texel(column, row))).collect();
    LightMap { width: size, height: size, texels }
}

/// A spot light that throws the glass of `map_size` texels through a window: its axis passes through
/// `through`, `distance` from the light, where the map reaches `radius` to every side \[m\].
pub(super) fn projector(
    through: Vec3,
    direction: Vec3,
    [distance, radius]: [f32; 2],
    intensity: Vec3,
    map_size: u32,
) -> Light {
    let direction = direction.normalize();
    let outer_angle = (radius / distance).atan();
    Light::Spot(SpotLight {
        position: through - distance * direction,
        direction,
        up: Vec3::Y,
        intensity,
        inner_angle: 0.9 * outer_angle,
        outer_angle,
        light_map: Some(Arc::new(stained_glass(map_size))),
    })
}

/// Outline of a light with a pointed arch whose sides are arcs about each other's feet.
pub(super) fn pointed([middle, half, sill, spring]: [f32; 4], fineness: Fineness) -> Vec<Vec2> {
    // A coarser arch would cut the rose.
    let segments = fineness.segments(half, FRAC_PI_3, 3);
    let mut outline = vec![Vec2::new(middle - half, sill), Vec2::new(middle + half, sill)];
    outline.extend(arc(Vec2::new(middle - half, spring), 2.0 * half, 0.0, FRAC_PI_3, segments));
    let left = arc(Vec2::new(middle + half, spring), 2.0 * half, 2.0 * FRAC_PI_3, PI, segments);
    outline.extend(&left[1..]);
    outline
}

/// Whether the point is in that outline.
fn in_pointed(p: Vec2, [middle, half, sill, spring]: [f32; 4]) -> bool {
    let x = (p.x - middle).abs();
    let under_arch = p.y <= spring || Vec2::new(x + half, p.y - spring).length() < 2.0 * half;
    x < half && p.y > sill && under_arch
}

/// The light that the glass lets through at a point of the window.
fn glass(p: Vec2) -> Vec3 {
    let from_rose = p - Vec2::Y * ROSE[0];
    if from_rose.length() < 1.06 * ROSE[1] {
        return rose(from_rose / ROSE[1]);
    }
    if !in_pointed(p, [0.0, MARGIN, SILL * MARGIN, 0.0]) {
        return quarries(p, [GOLD * 0.8, COBALT * 0.8], 0.34);
    }
    for (lancet, panels) in LANCETS.iter().zip(&PANELS) {
        let [middle, half, sill, spring] = *lancet;
        if in_pointed(p, [middle, half + 0.03, sill - 0.03, spring]) {
            return panel(p - Vec2::new(middle, sill), half, panels);
        }
    }
    quarries(p, [EMERALD, COBALT], 0.22)
}

/// The rose, of radius 1: an eye, eight petals and a rim of sixteen panes.
fn rose(p: Vec2) -> Vec3 {
    const RINGS: [f32; 3] = [0.26, 0.64, 1.0];
    let (radius, turn) = (p.length(), p.to_angle() / TAU + 0.5);
    let lead = LEAD / ROSE[1];
    if RINGS.iter().any(|ring| (radius - ring).abs() < lead) {
        return Vec3::ZERO;
    }
    if radius < RINGS[0] {
        return GOLD;
    }
    let (panes, colours, inner) =
        if radius < RINGS[1] { (8.0, [RUBY, GOLD], 0.0) } else { (16.0, [VIOLET, RUBY], 100.0) };
    let at = turn * panes;
    // Distance along the ring to the nearest seam.
    if (at - at.round()).abs() * TAU * radius / panes < lead {
        return Vec3::ZERO;
    }
    colours[at as usize % 2] * shade(Vec2::new(at.floor(), inner))
}

/// A lancet's panels, from the middle of its sill: medallions on a ground of quarries, in a border.
fn panel(p: Vec2, half: f32, panels: &[[Vec3; 2]; 3]) -> Vec3 {
    let border = half - 0.09;
    if (p.x.abs() - border).abs() < LEAD {
        return Vec3::ZERO;
    }
    if p.x.abs() > border {
        let bead = p.y / 0.15;
        if (bead - bead.round()).abs() * 0.15 < LEAD {
            return Vec3::ZERO;
        }
        return if bead.floor() as i32 % 2 == 0 { RUBY } else { PALE };
    }
    let row = (p.y / PANEL).floor().clamp(0.0, 2.0);
    let [medallion, ground] = panels[row as usize];
    let from_middle = p - Vec2::Y * PANEL * (row + 0.5);
    let radius = from_middle.length();
    let edge = |distance: f32| distance.abs() < LEAD;
    if edge(radius - 0.25) || edge(radius - 0.10) || (row > 0.0 && edge(p.y - row * PANEL)) {
        return Vec3::ZERO;
    }
    if radius < 0.10 {
        return PALE;
    }
    if radius < 0.25 {
        let diagonal = (from_middle.x.abs() - from_middle.y.abs()).abs() * 0.707;
        return if edge(diagonal) { Vec3::ZERO } else { medallion };
    }
    quarries(p, [ground, ground * 0.8], 0.16)
}

/// Diamonds `wide` across, in two colours by turns.
fn quarries(p: Vec2, colours: [Vec3; 2], wide: f32) -> Vec3 {
    let at = Vec2::new(p.x + 0.6 * p.y, p.x - 0.6 * p.y) / wide;
    let seam = (at - at.round()).abs().min_element() * wide * 0.86;
    if seam < LEAD {
        return Vec3::ZERO;
    }
    let cell = at.floor();
    colours[(cell.x as i32 + cell.y as i32).rem_euclid(2) as usize] * shade(cell)
}

/// No two panes of hand-made glass are alike: a factor from 0.7 to 1 for each.
fn shade(pane: Vec2) -> f32 {
    let mixed = (pane.x as i32).wrapping_mul(73).wrapping_add((pane.y as i32).wrapping_mul(151));
    0.7 + 0.3 * (mixed.rem_euclid(17) as f32 / 16.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean(map: &LightMap) -> Vec3 {
        map.texels.iter().sum::<Vec3>() / map.texels.len() as f32
    }

    #[test]
    fn a_small_map_is_a_fair_copy_of_a_large_one() {
        let large = stained_glass(512);
        let whole = mean(&large);
        for size in [64, 128, 256] {
            let map = stained_glass(size);
            assert_eq!((map.width, map.height, map.texels.len()), (size, size, (size * size) as usize));
            assert!((mean(&map) - whole).abs().max_element() < 0.01 * whole.max_element(), "{size}");
            // Texel by texel: the mean of those that it covers.
            let part = 512 / size;
            let mut off = 0.0;
            for (index, texel) in map.texels.iter().enumerate() {
                let (column, row) = (index as u32 % size * part, index as u32 / size * part);
                let covered = (0..part * part)
                    .map(|i| large.texels[((row + i / part) * 512 + column + i % part) as usize]);
                off += (covered.sum::<Vec3>() / (part * part) as f32 - texel).length_squared();
            }
            let off = (off / (size * size) as f32).sqrt();
            assert!(off < 0.05, "{size}: {off} from the large map");
        }
        assert_eq!(stained_glass(0).width, 2);
        let outside = |v: Vec3| v.min_element() < 0.0 || v.max_element() > 1.0;
        assert!(!large.texels.iter().any(|&texel| outside(texel)));
    }

    #[test]
    fn glass_is_coloured_and_leaded() {
        let map = stained_glass(1024);
        let saturated = |v: &Vec3| v.max_element() > 0.4 && v.min_element() < 0.3 * v.max_element();
        let share = |test: &dyn Fn(&Vec3) -> bool| {
            map.texels.iter().filter(|texel| test(texel)).count() as f32 / map.texels.len() as f32
        };
        assert!(share(&saturated) > 0.5, "{} of it is coloured", share(&saturated));
        let lead = share(&|v| *v == Vec3::ZERO);
        assert!(lead > 0.05 && lead < 0.4, "{lead} of it is lead");
        // The rose's eye is in the upper half.
        let (x, y) = (0.5, 0.5 - 0.5 * (ROSE[0] - MIDDLE) / HALF_MAP.y);
        assert!((map.sample(Vec2::new(x, y)) - GOLD).length() < 1e-5);
    }
}
