//! What fills the hall and breaks up its light: balustrades, fans, a grille, chains, a spiral stair,
//! stools, vases, hoops, cages.

use std::f32::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec2, Vec3};

use super::complex::{
    ARCADE, ARCH, BRASS, CLAY, END_Z, GLAZE, IRON, OPENING, SIDES, STONE, WOOD, bays, block, columns_of,
};
use super::props::{rod, smooth, turned, vessel};
use super::solids::{arc, circle, cuboid, extrude, lathe, merged, moved, placed, sweep, torus};
use super::tessellate::{Fineness, Part};
use crate::scene::Mesh;

/// What the hall has from a few thousand triangles on.
pub(super) fn large(fineness: Fineness) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    vec![
        part("plinths", STONE, columns_of(|x, z| block(x, z, 0.31, [-0.1, 0.17]))),
        part("abaci", STONE, columns_of(|x, z| block(x, z, 0.32, [1.93, 2.11]))),
        part("transoms", IRON, merged(SIDES.map(transom))),
        part("bars", IRON, merged(bars(fineness))),
        part("cross bars", IRON, merged(cross_bars())),
        part("stair pole", IRON, rod(stair(-0.1), stair(5.1), 0.07, fineness.segments(0.07, TAU, 5))),
        part("steps", WOOD, merged((0..STEPS).map(|step| tread(step as f32)))),
        part("pedestal", STONE, moved(pedestal(fineness), HOOPS)),
        part("hoops", BRASS, moved(hoops(fineness), HOOPS + Vec3::Y * 1.62)),
        part("hoop axis", IRON, moved(hoop_axis(fineness), HOOPS + Vec3::Y * 1.62)),
        part("seats", WOOD, at_stools(&seat(fineness))),
        part("legs", WOOD, at_stools(&legs(fineness))),
        part("jars", CLAY, merged(JARS.map(|[x, z]| moved(jar(fineness), Vec3::new(x, 0.0, z))))),
    ]
}

/// What the hall has from some ten thousand triangles on.
pub(super) fn small(fineness: Fineness) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    vec![
        part("rails", STONE, merged(rails())),
        part("balusters", STONE, merged(balusters(fineness))),
        part("fan rings", IRON, merged(fan_rings(fineness))),
        part("spokes", IRON, merged(spokes(fineness))),
        part("grille rings", IRON, merged(grille_rings(fineness))),
        part("chains", IRON, merged(curtain(fineness))),
        part("stair rods", IRON, merged((0..STEPS).map(|step| stair_rod(step as f32, fineness)))),
        part("handrail", WOOD, handrail(fineness)),
        part("stretchers", WOOD, at_stools(&stretcher(fineness))),
        part("lamp chain", IRON, moved(chain(6, fineness), LAMP + Vec3::Y * 1.62)),
        part("lamp", BRASS, moved(lamp_ring(fineness), LAMP)),
        part("lamp rods", IRON, moved(lamp_rods(fineness), LAMP)),
        part("lamp cups", BRASS, moved(lamp_cups(fineness), LAMP)),
    ]
}

/// What the hall has besides where the camera moves.
pub(super) fn more(fineness: Fineness) -> Vec<Part> {
    let part = |name, material, mesh| Part { name, material, mesh };
    let lattice = |side: f32| moved(slats(side), SCREEN + Vec3::Z * (0.01 * side));
    vec![
        part("frame", WOOD, moved(frame(), SCREEN)),
        part("slats", WOOD, lattice(1.0)),
        part("counter slats", WOOD, lattice(-1.0)),
        part("cage", BRASS, moved(cage(fineness), CAGE)),
        part("cage floor", BRASS, moved(cage_floor(fineness), CAGE)),
        part("cage chain", IRON, moved(chain(19, fineness), CAGE + Vec3::Y * 1.06)),
        part("table", WOOD, moved(table_top(fineness), TABLE)),
        part("table legs", WOOD, moved(table_legs(fineness), TABLE)),
        part("vases", GLAZE, moved(vases(fineness), TABLE)),
        part("ladder rails", WOOD, ladder_rails(fineness)),
        part("rungs", WOOD, rungs(fineness)),
    ]
}

fn point(x: f32, y: f32) -> Vec2 {
    Vec2::new(x, y)
}

/// The bar across the arches where they spring, from end to end.
fn transom(side: f32) -> Mesh {
    let x = side * ARCADE[0];
    cuboid(Vec3::new(x - 0.028, 2.005, -6.1), Vec3::new(x + 0.028, 2.075, 6.1))
}

/// A tie beam from arcade to arcade, which hides the light behind it from below.
pub(super) fn beam() -> Mesh {
    cuboid(Vec3::new(-3.1, 3.08, -2.45), Vec3::new(3.1, 3.25, -2.35))
}

/// Posts and handrails between the columns; the middle bay is a passage.
fn rails() -> Vec<Mesh> {
    let rail = |x: f32, z: f32, half: f32, [low, high]: [f32; 2]| {
        cuboid(Vec3::new(x - half, low, z - 1.2), Vec3::new(x + half, high, z + 1.2))
    };
    let places = SIDES.iter().flat_map(|side| bays().map(move |z| (side * ARCADE[0], z)));
    places
        .filter(|(_, z)| z.abs() > 1.0)
        // The outer bays end in the walls.
        .flat_map(|(x, z)| [rail(x, z * 1.003, 0.10, [-0.05, 0.12]), rail(x, z * 1.003, 0.09, [0.80, 0.89])])
        .collect()
}

fn balusters(fineness: Fineness) -> Vec<Mesh> {
    let line = [
        (0.055, 0.08),
        (0.05, 0.16),
        (0.028, 0.20),
        (0.062, 0.33),
        (0.030, 0.55),
        (0.026, 0.66),
        (0.045, 0.71),
        (0.04, 0.83),
    ];
    let one = lathe(&smooth(&line, fineness.cuts(0.18, 1)), fineness.segments(0.06, TAU, 4));
    let places = SIDES.iter().flat_map(|side| bays().map(move |z| (side * ARCADE[0], z)));
    places
        .filter(|(_, z)| z.abs() > 1.0)
        .flat_map(|(x, z)| (0..6).map(move |i| (x, z + 0.29 * (i as f32 - 2.5))))
        .map(|(x, z)| moved(one.clone(), Vec3::new(x, 0.0, z)))
        .collect()
}

/// Bays whose arches have a fan: all but the middle one, on both sides.
fn fans() -> impl Iterator<Item = Vec3> {
    let places = SIDES.iter().flat_map(|side| bays().map(move |z| Vec3::new(side * ARCADE[0], 2.04, z)));
    places.filter(|place| place.z.abs() > 1.0)
}

fn fan_rings(fineness: Fineness) -> Vec<Mesh> {
    let section = circle(0.017, fineness.segments(0.02, TAU, 3));
    let ring = |radius: f32, place: Vec3| {
        let path: Vec<Vec3> = arc(Vec2::ZERO, radius, 0.0, PI, fineness.segments(radius, PI, 4))
            .iter()
            .map(|p| place + Vec3::new(0.0, p.y, p.x))
            .collect();
        sweep(&path, &section, Vec3::X, false)
    };
    fans().flat_map(|place| [0.31, 0.64].map(|radius| ring(radius, place))).collect()
}

fn spokes(fineness: Fineness) -> Vec<Mesh> {
    let sides = fineness.segments(0.02, TAU, 3);
    let spoke = |angle: f32, place: Vec3| {
        let out = Vec3::new(0.0, angle.sin(), angle.cos());
        rod(place + 0.31 * out, place + (ARCH[1] + 0.06) * out, 0.013, sides)
    };
    fans().flat_map(|place| (1..8).map(move |i| spoke(PI * i as f32 / 8.0, place))).collect()
}

/// Distance between the bars of the grille \[m\].
const BAR_PITCH: f32 = 0.22;

/// Places of the grille's bars: from its middle \[m\].
fn bar_places() -> impl Iterator<Item = f32> + Clone {
    (0..11).map(|i| BAR_PITCH * (i as f32 - 5.0))
}

fn bars(fineness: Fineness) -> Vec<Mesh> {
    let [middle, half, sill, spring] = OPENING;
    let sides = fineness.segments(0.02, TAU, 4);
    bar_places()
        .map(|x| {
            let top = spring + (half * half - x * x).sqrt() + 0.08;
            let at = |y: f32| Vec3::new(middle + x, y, END_Z);
            rod(at(sill - 0.1), at(top), 0.017, sides)
        })
        .collect()
}

fn cross_bars() -> Vec<Mesh> {
    let [middle, half, _, spring] = OPENING;
    [0.85, 1.12, 1.93, 2.2]
        .map(|y: f32| {
            let half = (half * half - (y - spring).max(0.0).powi(2)).sqrt() + 0.09;
            let (low, high) = (Vec3::new(-half, -0.021, -0.012), Vec3::new(half, 0.021, 0.012));
            moved(cuboid(low, high), Vec3::new(middle, y, END_Z))
        })
        .into()
}

/// Rings between the bars, in two rows between cross bars.
fn grille_rings(fineness: Fineness) -> Vec<Mesh> {
    let [middle, ..] = OPENING;
    let ring = torus(0.097, 0.010, fineness.segments(0.097, TAU, 6), fineness.segments(0.01, TAU, 3));
    let upright = placed(ring, Affine3A::from_rotation_x(0.5 * PI));
    bar_places()
        .take(10)
        .flat_map(|x| [0.985, 2.065].map(|y| Vec3::new(middle + x + 0.5 * BAR_PITCH, y, END_Z)))
        .map(|place| moved(upright.clone(), place))
        .collect()
}

/// A link's half length and thickness along the chain, and the distance of links \[m\].
const LINK: [f32; 2] = [0.066, 0.017];
const LINK_PITCH: f32 = 2.0 * (LINK[0] - LINK[1]) - 0.006;

/// Links that pass through each other without touching, from the origin upwards.
fn chain(links: u32, fineness: Fineness) -> Mesh {
    let ring = torus(0.044, 0.0113, fineness.segments(0.05, TAU, 6), fineness.segments(0.012, TAU, 3));
    let stretch = Affine3A::from_scale(Vec3::new(1.0, 1.0, LINK[0] / 0.044));
    let upright = placed(placed(ring, stretch), Affine3A::from_rotation_x(0.5 * PI));
    merged((0..links).map(|link| {
        let quarter = 0.5 * PI * (link % 2) as f32 + 0.3;
        turned(upright.clone(), quarter, Vec3::Y * LINK_PITCH * link as f32)
    }))
}

/// Chains that hang in the passage on the left; the uppermost links end inside the arch.
fn curtain(fineness: Fineness) -> Vec<Mesh> {
    (0..9)
        .map(|i| {
            let z = 0.19 * (i as f32 - 4.0);
            let links = if i % 2 == 0 { 19 } else { 16 };
            let top = ARCH[0] + (ARCH[1] * ARCH[1] - z * z).sqrt() + 0.03;
            let foot = top - LINK_PITCH * (links - 1) as f32;
            moved(chain(links, fineness), Vec3::new(-ARCADE[0] + 0.11, foot, z))
        })
        .collect()
}

const STEPS: u32 = 20;
const STEP_RISE: f32 = 0.2;
const STEP_TURN: f32 = 0.36;
const STAIR_RADIUS: f32 = 0.92;

/// The stair's axis at a height.
fn stair(y: f32) -> Vec3 {
    Vec3::new(1.87, y, -4.37)
}

/// A point of the stair at `step` (which may be between two), `radius` from its axis.
fn on_stair(step: f32, radius: f32, above: f32) -> Vec3 {
    let (sin, cos) = (1.9 + STEP_TURN * step).sin_cos();
    stair(STEP_RISE * (step + 1.0) + above) + radius * Vec3::new(cos, 0.0, sin)
}

/// A wedge of wood that ends inside the pole.
fn tread(step: f32) -> Mesh {
    let half = 0.5 * STEP_TURN + 0.03;
    let inner = Vec2::from_angle(half) * 0.05;
    let outer = Vec2::from_angle(half) * STAIR_RADIUS;
    let outline = [inner, point(inner.x, -inner.y), point(outer.x, -outer.y), outer];
    let flat = placed(extrude(&outline, &[], 0.05), Affine3A::from_rotation_x(-0.5 * PI));
    let height = STEP_RISE * (step + 1.0) - 0.05;
    turned(flat, -(1.9 + STEP_TURN * step), stair(height))
}

fn stair_rod(step: f32, fineness: Fineness) -> Mesh {
    let radius = STAIR_RADIUS - 0.07;
    let at = |above: f32| on_stair(step, radius, above);
    rod(at(-0.03), at(0.85), 0.013, fineness.segments(0.02, TAU, 4))
}

/// A rail that winds over the ends of the rods.
fn handrail(fineness: Fineness) -> Mesh {
    let turn = STEP_TURN * (STEPS as f32 - 0.2);
    let segments = fineness.segments(STAIR_RADIUS, turn, 12);
    let section = circle(0.032, fineness.segments(0.03, TAU, 4));
    // Wound flat first, then lifted ring by ring.
    let step = |ring: u32| -0.4 + (STEPS as f32 - 0.2) * ring as f32 / segments as f32;
    let path: Vec<Vec3> = (0..=segments)
        .map(|ring| Vec3 { y: 0.0, ..on_stair(step(ring), STAIR_RADIUS - 0.07, 0.0) })
        .collect();
    let mut mesh = sweep(&path, &section, Vec3::Y, false);
    for (index, position) in mesh.positions.iter_mut().enumerate() {
        position.y += on_stair(step(index as u32 / section.len() as u32), 0.0, 0.86).y;
    }
    mesh
}

/// Where the pedestal with the hoops stands.
const HOOPS: Vec3 = Vec3::new(-0.93, 0.0, -0.71);

fn pedestal(fineness: Fineness) -> Mesh {
    let line = [(0.20, 0.1), (0.13, 0.22), (0.10, 0.55), (0.13, 0.86), (0.21, 0.94), (0.21, 1.02)];
    let mut profile = vec![point(0.26, -0.05), point(0.26, 0.1)];
    profile.extend(smooth(&line, fineness.cuts(0.3, 1)));
    lathe(&profile, fineness.segments(0.2, TAU, 6))
}

/// Nested hoops like an armillary sphere's.
fn hoops(fineness: Fineness) -> Mesh {
    let tilts = [[0.1, 0.0], [1.5, 0.2], [0.6, 1.1], [2.2, 0.5], [1.1, 2.1], [2.7, 1.6]];
    merged(tilts.iter().enumerate().map(|(i, [about_x, about_z])| {
        let radius = 0.47 - 0.06 * i as f32;
        let ring = torus(radius, 0.017, fineness.segments(radius, TAU, 8), fineness.segments(0.02, TAU, 3));
        placed(ring, Affine3A::from_quat(Quat::from_rotation_z(*about_z) * Quat::from_rotation_x(*about_x)))
    }))
}

fn hoop_axis(fineness: Fineness) -> Mesh {
    let (low, high) = (Vec3::new(0.0, -0.65, 0.0), Vec3::new(0.0, 0.55, 0.0));
    rod(low, high, 0.014, fineness.segments(0.02, TAU, 4))
}

/// Where stools stand (x, z), and how they are turned.
const STOOLS: [[f32; 3]; 7] = [
    [1.33, 0.97, 0.2],
    [2.21, 0.43, 1.3],
    [-1.92, 1.18, 0.7],
    [-2.37, 0.31, 2.0],
    [0.61, -2.29, 0.4],
    [-1.83, -2.93, 1.6],
    [-0.51, -3.87, 2.4],
];

fn at_stools(mesh: &Mesh) -> Mesh {
    merged(STOOLS.map(|[x, z, angle]| turned(mesh.clone(), angle, Vec3::new(x, 0.0, z))))
}

fn seat(fineness: Fineness) -> Mesh {
    let line = [(0.17, 0.44), (0.20, 0.46), (0.20, 0.48), (0.17, 0.5)];
    lathe(&smooth(&line, fineness.cuts(0.15, 1)), fineness.segments(0.2, TAU, 6))
}

/// A point of a stool's leg, `y` above the floor.
fn on_leg(leg: u32, y: f32) -> Vec3 {
    let (sin, cos) = (TAU * leg as f32 / 3.0).sin_cos();
    let radius = 0.22 - 0.2 * y;
    Vec3::new(radius * cos, y, radius * sin)
}

fn legs(fineness: Fineness) -> Mesh {
    let sides = fineness.segments(0.02, TAU, 4);
    merged((0..3).map(|leg| rod(on_leg(leg, -0.02), on_leg(leg, 0.46), 0.019, sides)))
}

fn stretcher(fineness: Fineness) -> Mesh {
    let ring = torus(0.18, 0.011, fineness.segments(0.18, TAU, 6), fineness.segments(0.011, TAU, 3));
    moved(ring, Vec3::Y * 0.2)
}

/// Where jars stand on the floor (x, z) \[m\].
const JARS: [[f32; 2]; 4] = [[2.43, -1.37], [2.17, -2.33], [2.31, 2.61], [-2.41, 3.31]];

fn jar(fineness: Fineness) -> Mesh {
    let outside =
        [(0.14, -0.02), (0.20, 0.16), (0.27, 0.42), (0.22, 0.68), (0.11, 0.84), (0.10, 0.92), (0.16, 0.99)];
    let inside =
        [(0.14, 1.0), (0.08, 0.92), (0.09, 0.83), (0.20, 0.66), (0.24, 0.42), (0.17, 0.18), (0.1, 0.05)];
    lathe(&vessel(&outside, &inside, fineness.cuts(0.2, 1)), fineness.segments(0.25, TAU, 6))
}

/// Middle of the hanging lamp's ring.
const LAMP: Vec3 = Vec3::new(0.13, 2.98, -1.47);

fn lamp_ring(fineness: Fineness) -> Mesh {
    torus(0.58, 0.028, fineness.segments(0.58, TAU, 8), fineness.segments(0.03, TAU, 3))
}

/// From the ring to a knob below the chain.
fn lamp_rods(fineness: Fineness) -> Mesh {
    let sides = fineness.segments(0.02, TAU, 3);
    let knob =
        moved(lathe(&[(0.0, 0.0), (0.05, 0.05), (0.03, 0.21)].map(Vec2::from), 2 * sides), Vec3::Y * 1.48);
    let rods = (0..6).map(|i| {
        let (sin, cos) = (0.2 + TAU * i as f32 / 6.0).sin_cos();
        let at = |radius: f32, y: f32| Vec3::new(radius * cos, y, radius * sin);
        rod(at(0.58, 0.0), at(0.075, 1.5), 0.011, sides)
    });
    merged(rods.chain([knob]))
}

fn lamp_cups(fineness: Fineness) -> Mesh {
    let outside = [(0.02, 0.01), (0.035, 0.06), (0.06, 0.10)];
    let inside = [(0.053, 0.102), (0.028, 0.065), (0.014, 0.05)];
    let cup = lathe(&vessel(&outside, &inside, fineness.cuts(0.15, 1)), fineness.segments(0.05, TAU, 5));
    merged((0..12).map(|i| {
        let (sin, cos) = (TAU * i as f32 / 12.0).sin_cos();
        moved(cup.clone(), Vec3::new(0.58 * cos, 0.0, 0.58 * sin))
    }))
}

/// Middle of the foot of a lattice screen across the hall.
const SCREEN: Vec3 = Vec3::new(1.93, 0.0, -0.77);

/// Half width, lower and upper edge of the lattice \[m\].
const LATTICE: [f32; 3] = [0.62, 0.35, 1.75];

fn frame() -> Mesh {
    let [half, low, high] = LATTICE;
    let rect = |half: f32, low: f32, high: f32| {
        vec![point(-half, low), point(half, low), point(half, high), point(-half, high)]
    };
    let outline = rect(half + 0.05, -0.06, high + 0.05);
    moved(extrude(&outline, &[rect(half, low, high)], 0.06), Vec3::Z * -0.03)
}

/// Slats that rise to the right (`side` = 1) or to the left, their ends inside the frame.
fn slats(side: f32) -> Mesh {
    let [half, low, high] = LATTICE;
    let (low, high) = (low - 0.02, high + 0.02);
    let half = half + 0.02;
    let slat = |c: f32| {
        // The line y = x + c cut to the lattice.
        let (from, to) = ((low - c).max(-half), (high - c).min(half));
        (to - from > 0.08).then(|| {
            let (from, to) = (point(from, from + c), point(to, to + c));
            let across = point(-0.012, 0.012);
            let outline = [from - across, to - across, to + across, from + across];
            moved(extrude(&outline, &[], 0.016), Vec3::Z * -0.008)
        })
    };
    let all = merged((0..20).filter_map(|i| slat(low - half + 0.137 * (i as f32 + 0.6))));
    placed(all, Affine3A::from_scale(Vec3::new(side, 1.0, 1.0)))
}

/// Where a cage hangs from the ceiling.
const CAGE: Vec3 = Vec3::new(-1.41, 2.33, -2.13);

/// Bars bent together at the top, without touching.
fn cage(fineness: Fineness) -> Mesh {
    let section = circle(0.009, fineness.segments(0.012, TAU, 3));
    let line = [(0.30, 0.0), (0.30, 0.3), (0.29, 0.55), (0.22, 0.75), (0.09, 0.86), (0.055, 0.95)];
    let line = smooth(&line, fineness.cuts(0.2, 1));
    merged((0..18).map(|i| {
        let (sin, cos) = (TAU * i as f32 / 18.0).sin_cos();
        let path: Vec<Vec3> = line.iter().map(|p| Vec3::new(p.x * cos, p.y, p.x * sin)).collect();
        sweep(&path, &section, Vec3::new(-sin, 0.0, cos), false)
    }))
}

/// The cage's floor, a hoop around its bars and the cap that holds them.
fn cage_floor(fineness: Fineness) -> Mesh {
    let sides = fineness.segments(0.3, TAU, 6);
    let floor = lathe(&[(0.33, -0.03), (0.33, 0.03)].map(Vec2::from), sides);
    let hoop = moved(torus(0.30, 0.014, sides, fineness.segments(0.014, TAU, 3)), Vec3::Y * 0.37);
    let cap = lathe(&[(0.08, 0.91), (0.07, 0.98), (0.02, 1.02), (0.02, 1.08)].map(Vec2::from), sides);
    merged([floor, hoop, cap])
}

/// Where the round table stands.
const TABLE: Vec3 = Vec3::new(1.71, 0.0, 1.77);

fn table_top(fineness: Fineness) -> Mesh {
    let line = [(0.36, 0.70), (0.40, 0.72), (0.40, 0.74), (0.38, 0.76)];
    lathe(&smooth(&line, fineness.cuts(0.15, 1)), fineness.segments(0.4, TAU, 6))
}

fn table_legs(fineness: Fineness) -> Mesh {
    let sides = fineness.segments(0.03, TAU, 4);
    merged((0..4).map(|leg| {
        let (sin, cos) = (0.5 + TAU * leg as f32 / 4.0).sin_cos();
        rod(Vec3::new(0.33 * cos, -0.02, 0.33 * sin), Vec3::new(0.26 * cos, 0.73, 0.26 * sin), 0.024, sides)
    }))
}

fn vases(fineness: Fineness) -> Mesh {
    let outside = [(0.05, 0.0), (0.09, 0.09), (0.08, 0.2), (0.03, 0.3), (0.03, 0.36), (0.055, 0.4)];
    let inside = [(0.045, 0.402), (0.02, 0.36), (0.02, 0.3), (0.066, 0.2), (0.075, 0.09), (0.04, 0.02)];
    let vase = lathe(&vessel(&outside, &inside, fineness.cuts(0.2, 1)), fineness.segments(0.08, TAU, 6));
    let places = [[-0.19, 0.07, 1.0], [0.06, -0.17, 0.8], [0.17, 0.13, 0.6]];
    merged(places.map(|[x, z, size]| {
        let small = placed(vase.clone(), Affine3A::from_scale(Vec3::splat(size)));
        moved(small, Vec3::new(x, 0.75, z))
    }))
}

/// A point of the ladder that leans on the right arcade, `along` from its foot, `side` of its middle.
fn on_ladder(along: f32, side: f32) -> Vec3 {
    let lean = Vec3::new(0.27, 0.96, 0.05);
    Vec3::new(1.97, -0.02, 3.73) + along * lean + side * Vec3::new(-0.06, 0.0, 1.0)
}

fn ladder_rails(fineness: Fineness) -> Mesh {
    let sides = fineness.segments(0.03, TAU, 4);
    merged(SIDES.map(|side| rod(on_ladder(0.0, 0.2 * side), on_ladder(3.66, 0.2 * side), 0.024, sides)))
}

fn rungs(fineness: Fineness) -> Mesh {
    let sides = fineness.segments(0.02, TAU, 4);
    merged((1..12).map(|rung| {
        let at = |side: f32| on_ladder(0.3 * rung as f32, side);
        rod(at(-0.2), at(0.2), 0.014, sides)
    }))
}
