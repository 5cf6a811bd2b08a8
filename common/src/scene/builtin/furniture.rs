//! What makes the bare nave a cathedral: plinths and capitals, ribs, archivolts, tracery, steps, a
//! canopy over the altar, pews and lamps.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::cathedral::{
    AISLE_WINDOW, AISLE_X, ARCADE_RADIUS, ARCADE_Y, CLERESTORY, FLOOR, HALF_LENGTH, IRON, MARBLE, NAVE_WALL,
    NAVE_X, SIDES, STONE, VAULT_RADIUS, VAULT_Y, WOOD, bays, columns, columns_of,
};
use super::solids::{across_x, arc, cuboid, extrude, lathe, merged, moved, sweep};
use super::tessellate::{Fineness, Part};
use crate::scene::Mesh;

pub(super) fn parts(fineness: Fineness) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    vec![
        part("plinths", STONE, columns_of(|x, z| block(x, z, 0.82, [-0.1, 0.25]))),
        part("abaci", STONE, columns_of(|x, z| block(x, z, 0.80, [4.2, 4.5]))),
        part("wall shafts", STONE, columns_of(|x, z| wall_shaft(x, z, fineness))),
        part("corbels", STONE, columns_of(corbel)),
        part("ribs", STONE, merged(columns().map(|z| rib(z, fineness)))),
        part("archivolts", STONE, merged(archivolts(fineness))),
        part("cornices", STONE, merged(SIDES.map(|side| cornice(side, 7.55, 7.8, 0.16)))),
        part("vault cornices", STONE, merged(SIDES.map(|side| cornice(side, 10.75, 11.0, 0.22)))),
        part("mullions", STONE, merged(mullions())),
        part("transoms", STONE, merged(transoms())),
        part("pilasters", STONE, merged(pilasters())),
        part("aisle beams", WOOD, merged(aisle_beams())),
        part("steps", FLOOR, steps()),
        part("canopy columns", MARBLE, merged(canopy_columns(fineness))),
        part("canopy slab", MARBLE, canopy_slab()),
        part("canopy dome", MARBLE, canopy_dome(fineness)),
        part("cross", WOOD, cross()),
        part("pews", WOOD, merged(pews())),
        part("lamp rings", IRON, merged(LAMPS.map(|z| lamp_ring(z, fineness)))),
        part("lamp bars", IRON, merged(LAMPS.map(lamp_bar))),
        part("lamp rods", IRON, merged(LAMPS.map(|z| lamp_rod(z, fineness)))),
    ]
}

fn point(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

fn block(x: f32, z: f32, half: f32, [low, high]: [f32; 2]) -> Mesh {
    cuboid(Vec3::new(x - half, low, z - half), Vec3::new(x + half, high, z + half))
}

/// A half-round shaft up the nave's wall, from the arcade's cornice to the rib.
fn wall_shaft(x: f32, z: f32, fineness: Fineness) -> Mesh {
    let x = x - x.signum() * NAVE_WALL;
    let cuts = fineness.cuts(0.4, 1);
    let mut profile = vec![point(0.17, 4.3), point(0.17, 10.3)];
    profile.extend(super::solids::curve(point(0.17, 10.3), point(0.19, 10.6), point(0.34, 10.7), cuts));
    moved(lathe(&profile, fineness.segments(0.17, TAU, 6)), Vec3::new(x, 0.0, z))
}

/// The block between a wall shaft and its rib.
fn corbel(x: f32, z: f32) -> Mesh {
    let x = x - x.signum() * NAVE_WALL;
    cuboid(Vec3::new(x - 0.42, 10.65, z - 0.42), Vec3::new(x + 0.42, 10.9, z + 0.42))
}

/// A rib across the vault.
fn rib(z: f32, fineness: Fineness) -> Mesh {
    let from = -0.04;
    let path: Vec<Vec3> =
        arc(point(0.0, VAULT_Y), VAULT_RADIUS, from, PI - from, fineness.segments(VAULT_RADIUS, PI, 6))
            .iter()
            .map(|p| p.extend(z))
            .collect();
    // Chamfered: narrower towards the nave.
    let section = [
        point(-0.32, -0.1),
        point(0.32, -0.1),
        point(0.32, 0.16),
        point(0.2, 0.3),
        point(-0.2, 0.3),
        point(-0.32, 0.16),
    ];
    sweep(&path, &inward(&section), Vec3::Z, false)
}

/// Sweeping along an arc about z, a section's y axis points away from the centre; this turns it.
fn inward(section: &[Vec2]) -> Vec<Vec2> {
    section.iter().map(|p| -*p).collect()
}

/// Mouldings around the arcade's arches, on both faces of the wall.
fn archivolts(fineness: Fineness) -> Vec<Mesh> {
    let segments = fineness.segments(ARCADE_RADIUS, PI, 4);
    let round = fineness.segments(0.12, TAU, 4);
    let faces = SIDES.iter().flat_map(|side| [-1.0, 1.0].map(|face| side * NAVE_X + face * NAVE_WALL));
    faces
        .flat_map(|x| {
            bays().map(move |z| {
                let path: Vec<Vec3> = arc(Vec2::ZERO, ARCADE_RADIUS + 0.16, 0.0, PI, segments)
                    .iter()
                    .map(|p| Vec3::new(x, ARCADE_Y + p.y, z + p.x))
                    .collect();
                let section: Vec<Vec2> = super::solids::circle(0.12, round);
                sweep(&path, &section, Vec3::X, false)
            })
        })
        .collect()
}

/// A ledge along the nave's wall.
fn cornice(side: f32, low: f32, high: f32, depth: f32) -> Mesh {
    let (wall, out) = (side * (NAVE_X - NAVE_WALL + 0.1), HALF_LENGTH + 0.3);
    let edge = wall - side * (0.1 + depth);
    let outline = [point(wall, low), point(wall, high), point(edge, high), point(edge, 0.5 * (low + high))];
    moved(extrude(&outline, &[], 2.0 * out), Vec3::Z * -out)
}

/// Upright bars in the middle of the windows, inside the wall.
fn mullions() -> Vec<Mesh> {
    let bar = |x: f32, z: f32, [_, sill, spring]: [f32; 3], half: f32, top: f32| {
        cuboid(Vec3::new(x - half, sill - 0.1, z - half), Vec3::new(x + half, spring + top, z + half))
    };
    SIDES
        .iter()
        .flat_map(|side| {
            bays().flat_map(move |z| {
                [
                    bar(side * NAVE_X, z, CLERESTORY, 0.09, CLERESTORY[0] + 0.1),
                    bar(side * (AISLE_X + 0.4), z, AISLE_WINDOW, 0.07, AISLE_WINDOW[0] + 0.1),
                ]
            })
        })
        .collect()
}

/// Bars across the windows where their arches spring.
fn transoms() -> Vec<Mesh> {
    let bar = |x: f32, z: f32, [half, _, spring]: [f32; 3], thick: f32| {
        let low = Vec3::new(x - thick, spring - thick, z - half - 0.1);
        cuboid(low, Vec3::new(x + thick, spring + thick, z + half + 0.1))
    };
    SIDES
        .iter()
        .flat_map(|side| {
            bays().flat_map(move |z| {
                [bar(side * NAVE_X, z, CLERESTORY, 0.07), bar(side * (AISLE_X + 0.4), z, AISLE_WINDOW, 0.05)]
            })
        })
        .collect()
}

/// Flat pillars on the outer walls, opposite the columns.
fn pilasters() -> Vec<Mesh> {
    let pillar = |side: f32, z: f32| {
        let (wall, face) = (side * (AISLE_X + 0.2), side * (AISLE_X - 0.3));
        cuboid(Vec3::new(wall.min(face), -0.1, z - 0.4), Vec3::new(wall.max(face), 5.75, z + 0.4))
    };
    SIDES.iter().flat_map(|&side| columns().map(move |z| pillar(side, z))).collect()
}

/// Beams under the aisles' roofs, from column to pilaster.
fn aisle_beams() -> Vec<Mesh> {
    let beam = |side: f32, z: f32| {
        let (inner, outer) = (side * (NAVE_X + 0.2), side * (AISLE_X + 0.3));
        let outline = [point(inner, 6.6), point(outer, 5.3), point(outer, 5.8), point(inner, 7.2)];
        moved(extrude(&outline, &[], 0.5), Vec3::Z * (z - 0.25))
    };
    SIDES.iter().flat_map(|&side| columns().map(move |z| beam(side, z))).collect()
}

/// Three steps up to the altar, across the nave.
fn steps() -> Mesh {
    let back = -HALF_LENGTH - 0.2;
    let edge = |step: f32| -HALF_LENGTH + 5.4 - 0.45 * step;
    let mut outline = vec![point(back, -0.1), point(edge(0.0), -0.1)];
    for step in 0..3 {
        let (step, top) = (step as f32, 0.16 * (step + 1) as f32);
        outline.extend([point(edge(step), top), point(edge(step + 1.0), top)]);
    }
    outline.pop();
    outline.push(point(back, 0.48));
    moved(across_x(extrude(&outline, &[], 7.2), 0.0), Vec3::X * -3.6)
}

const CANOPY_Z: f32 = -HALF_LENGTH + 2.6;

fn canopy_columns(fineness: Fineness) -> Vec<Mesh> {
    let cuts = fineness.cuts(0.4, 1);
    let mut profile = vec![point(0.2, 0.4), point(0.2, 0.62)];
    for (control, to) in
        [((0.2, 0.7), (0.13, 0.72)), ((0.14, 2.2), (0.115, 3.6)), ((0.12, 3.72), (0.21, 3.8))]
    {
        let last = profile[profile.len() - 1];
        profile.extend(super::solids::curve(last, control.into(), to.into(), cuts));
    }
    profile.push(point(0.21, 3.95));
    let column = lathe(&profile, fineness.segments(0.16, TAU, 6));
    [(-1.9, -1.2), (1.9, -1.2), (-1.9, 1.2), (1.9, 1.2)]
        .map(|(x, z)| moved(column.clone(), Vec3::new(x, 0.0, CANOPY_Z + z)))
        .into()
}

fn canopy_slab() -> Mesh {
    cuboid(Vec3::new(-2.25, 3.88, CANOPY_Z - 1.55), Vec3::new(2.25, 4.2, CANOPY_Z + 1.55))
}

fn canopy_dome(fineness: Fineness) -> Mesh {
    let cuts = fineness.segments(1.3, 0.5 * PI, 2);
    let mut profile = vec![point(1.4, 4.1), point(1.4, 4.35)];
    profile.extend(super::solids::curve(point(1.4, 4.35), point(1.3, 5.35), point(0.12, 5.6), cuts));
    profile.extend([point(0.1, 5.9), point(0.0, 6.1)]);
    moved(lathe(&profile, fineness.segments(1.4, TAU, 8)), Vec3::Z * CANOPY_Z)
}

/// A cross on the wall behind the altar.
fn cross() -> Mesh {
    let (thin, wide, foot, arms, top) = (0.16, 0.95, 6.2, 8.0, 9.3);
    let half = [
        (thin, foot),
        (thin, arms - thin),
        (wide, arms - thin),
        (wide, arms + thin),
        (thin, arms + thin),
        (thin, top),
    ];
    let mut outline: Vec<Vec2> = half.map(Vec2::from).into();
    outline.extend(half.iter().rev().map(|&(x, y)| point(-x, y)));
    moved(extrude(&outline, &[], 0.4), Vec3::Z * (-HALF_LENGTH - 0.2))
}

/// Rows of benches on both sides of the middle way, facing the altar.
fn pews() -> Vec<Mesh> {
    // Seen from the side, (z, y): the back to the right.
    let outline = [
        (-0.28, -0.05),
        (-0.20, -0.05),
        (-0.20, 0.38),
        (0.16, 0.36),
        (0.20, -0.05),
        (0.28, -0.05),
        (0.36, 0.95),
        (0.30, 0.95),
        (0.22, 0.43),
        (-0.28, 0.45),
    ]
    .map(Vec2::from);
    let bench = across_x(extrude(&outline, &[], 2.5), 0.0);
    let rows = (0..9).map(|row| -5.2 + 1.45 * row as f32);
    rows.flat_map(|z| [-3.4, 0.9].map(|x| moved(bench.clone(), Vec3::new(x, 0.0, z)))).collect()
}

/// Where the hanging lamps are, along the nave \[m\].
const LAMPS: [f32; 2] = [-BAY_OF_LAMPS, BAY_OF_LAMPS];
const BAY_OF_LAMPS: f32 = 5.6;
const LAMP_Y: f32 = 6.3;

fn lamp_ring(z: f32, fineness: Fineness) -> Mesh {
    let ring =
        super::solids::torus(1.1, 0.06, fineness.segments(1.1, TAU, 8), fineness.segments(0.06, TAU, 4));
    moved(ring, Vec3::new(0.0, LAMP_Y, z))
}

/// A bar across the ring.
fn lamp_bar(z: f32) -> Mesh {
    cuboid(Vec3::new(-1.1, LAMP_Y - 0.035, z - 0.035), Vec3::new(1.1, LAMP_Y + 0.035, z + 0.035))
}

/// The rod from the vault down to the bar.
fn lamp_rod(z: f32, fineness: Fineness) -> Mesh {
    let profile = [point(0.03, LAMP_Y - 0.02), point(0.03, VAULT_Y + VAULT_RADIUS + 0.2)];
    moved(lathe(&profile, fineness.segments(0.03, TAU, 4)), Vec3::new(0.0, 0.0, z))
}
