//! Silhouettes of all kinds of meshes, and the order of their planes.

use std::sync::Arc;

use common::gpu::bench::scenes::{cuboid, object};
use common::scene::builtin::{self, solids};
use common::scene::{Mesh, Object};
use common::{Light, PointLight};
use glam::{Affine3A, DVec3, Quat, Vec2, Vec3};

use crate::Order;
use crate::connectivity::{Connectivity, Report};
use crate::order::violations;
use crate::shadows::{Meshes, Shadows};
use crate::silhouette::{Origin, Silhouette};

fn lamp(position: Vec3) -> Origin {
    Origin::of(&Light::Point(PointLight { position, intensity: Vec3::ONE }))
}

fn sun(direction: DVec3) -> Origin {
    Origin((-direction.normalize()).extend(0.0))
}

/// Numbers in [−1, 1), the same ones every time.
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed ^ 0x2545_f491_4f6c_dd1d;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Triangles between `point` and the light, one by one (Möller and Trumbore 1997).
fn hits(mesh: &Mesh, origin: Origin, point: DVec3) -> u32 {
    let direction = origin.from(point);
    let end = if origin.0.w == 0.0 { f64::INFINITY } else { 1.0 };
    let hit = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| mesh.positions[v as usize].as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let p = direction.cross(ac);
        let scale = ab.dot(p);
        let q = (point - a).cross(ab);
        let (u, v) = ((point - a).dot(p) / scale, direction.dot(q) / scale);
        let t = ac.dot(q) / scale;
        u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < end
    };
    mesh.triangles.iter().filter(|corners| hit(corners)).count() as u32
}

/// Shadows at `point` as the planes and caps count them: a ray from far away adds one where it enters and takes
/// one away where it leaves.
fn counted(mesh: &Connectivity, found: &Silhouette, origin: Origin, point: DVec3) -> i32 {
    // Beyond the light, where there is no shadow unless the light is enclosed.
    let far = point + origin.from(point).normalize() * 1e5 + DVec3::new(31.0, -17.0, 23.0);
    let along = point - far;
    let mut count = found.depth_at(mesh, origin, far) as i32;
    let at = |v: u32| mesh.positions[v as usize].as_dvec3();
    for edge in &found.edges {
        let (a, b) = (at(edge.from), at(edge.to));
        let (out_a, out_b) = (-origin.from(a), -origin.from(b));
        let normal = if origin.0.w == 0.0 { out_a.cross(b - a) } else { a_normal(out_a, out_b) };
        let t = normal.dot(a - far) / normal.dot(along);
        if !(0.0..1.0).contains(&t) {
            continue;
        }
        // Where the light sees the point, between the two ends and beyond the edge.
        let place = far + t * along;
        let beyond = {
            let into = normal.cross(b - a);
            (place - a).dot(into) * out_a.dot(into) > 0.0
        };
        let between = if origin.0.w == 0.0 {
            let across = normal.cross(out_a);
            (place - a).dot(across) * (b - a).dot(across) > 0.0
                && (b - place).dot(across) * (b - a).dot(across) > 0.0
        } else {
            let seen = -origin.from(place);
            out_a.cross(seen).dot(normal) > 0.0 && seen.cross(out_b).dot(normal) > 0.0
        };
        if beyond && between {
            count += if normal.dot(along) < 0.0 { 1 } else { -1 } * edge.weight as i32;
        }
    }
    for t in 0..mesh.triangles.len() {
        if found.casts(mesh, t as u32) {
            let [a, b, c] = mesh.triangles[t].map(at);
            let normal = (b - a).cross(c - a);
            let s = normal.dot(a - far) / normal.dot(along);
            let place = far + s * along;
            let inside = |p: DVec3, q: DVec3| (q - p).cross(place - p).dot(normal) >= 0.0;
            if (0.0..1.0).contains(&s) && inside(a, b) && inside(b, c) && inside(c, a) {
                let towards = if found.facing[t] { normal } else { -normal };
                count += if towards.dot(along) < 0.0 { 1 } else { -1 };
            }
        }
    }
    count
}

fn a_normal(a: DVec3, b: DVec3) -> DVec3 {
    a.cross(b)
}

fn tetrahedron() -> Mesh {
    Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        ..Mesh::default()
    }
}

/// Meshes with every fault that models have, and a name each.
fn faulty() -> Vec<(&'static str, Mesh)> {
    let ball = || {
        let arc: Vec<Vec2> =
            (0..=8).map(|i| Vec2::from_angle(std::f32::consts::PI * (i as f32 / 8.0 - 0.5))).collect();
        let mut profile = arc;
        profile[0].x = 0.0;
        profile[8].x = 0.0;
        solids::lathe(&profile, 14)
    };
    let change = |f: fn(&mut Mesh)| {
        let mut mesh = ball();
        f(&mut mesh);
        mesh
    };
    let leaf = Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.3), Vec3::Y],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    // Two squares side by side, one of them cut where the other is not.
    let junction = Mesh {
        positions: [[0, 0], [2, 0], [2, 2], [0, 2], [4, 0], [4, 2], [2, 1]]
            .map(|[x, y]| Vec3::new(x as f32, y as f32, 0.3))
            .into(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [1, 4, 6], [4, 5, 6], [5, 2, 6]],
        ..Mesh::default()
    };
    vec![
        ("closed", ball()),
        ("open", change(|mesh| mesh.triangles.truncate(mesh.triangles.len() - 20))),
        ("flipped", change(|mesh| mesh.triangles.iter_mut().step_by(5).for_each(|t| t.swap(0, 1)))),
        ("inside out", change(|mesh| mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1)))),
        ("duplicate", change(|mesh| mesh.triangles.extend(mesh.triangles[..30].to_vec()))),
        ("degenerate", change(|mesh| mesh.triangles.extend([[1, 1, 5], [3, 4, 3], [2, 2, 2]]))),
        ("non-manifold", change(|mesh| mesh.triangles.extend([[1, 2, 40], [1, 2, 60]]))),
        ("leaf", leaf),
        ("T-junction", junction),
    ]
}

#[test]
fn any_soup_of_triangles_is_counted_exactly() {
    let mut random = random(7);
    let mut place = |scale: f64| scale * DVec3::new(random(), random(), random());
    for (name, mesh) in faulty() {
        let connectivity = Connectivity::new(&mesh);
        let closed = connectivity.report().open_components == 0;
        let (mut shadowed, mut tried) = (0, 0);
        for origin in [
            lamp(Vec3::new(0.4, 2.3, 1.1)),
            lamp(Vec3::new(0.13, 0.21, 0.07)),
            lamp(Vec3::new(-5.0, 0.3, 40.0)),
            sun(DVec3::new(0.3, -0.8, 0.2)),
        ] {
            let found = Silhouette::new(&connectivity, origin);
            for chain in found.loops() {
                assert_eq!(chain[0].from, chain[chain.len() - 1].to, "{name}: a silhouette is open");
                assert!(chain.windows(2).all(|pair| pair[0].to == pair[1].from), "{name}");
            }
            let linked: usize = found.loops().iter().map(Vec::len).sum();
            let weights: u32 = found.edges.iter().map(|edge| edge.weight).sum();
            assert_eq!(linked, weights as usize, "{name}: every edge is in a loop");
            for _ in 0..400 {
                let point = place(3.0);
                let (truth, depth) =
                    (hits(&mesh, origin, point), found.depth_at(&connectivity, origin, point));
                // Inside a solid a closed one counts its near side only.
                assert_eq!(
                    depth > 0,
                    truth > 0,
                    "{name}: {point} from {origin:?}: {depth}, {truth} triangles"
                );
                if !closed {
                    assert_eq!(depth, truth, "{name}: {point} from {origin:?}");
                }
                assert_eq!(
                    counted(&connectivity, &found, origin, point),
                    depth as i32,
                    "{name}: {point} from {origin:?}: planes and caps"
                );
                shadowed += u32::from(truth > 0);
                tried += 1;
            }
        }
        assert!(shadowed > tried / 50 && shadowed < tried, "{name}: {shadowed} of {tried} in shadow");
    }
}

#[test]
fn faults_are_reported() {
    let report = |name: &str| {
        let mesh = faulty().into_iter().find(|(found, _)| *found == name).expect("a name of the list").1;
        Connectivity::new(&mesh).report()
    };
    let whole = report("closed");
    assert_eq!(whole, Report { triangles: whole.triangles, closed_components: 1, ..Report::default() });
    assert_eq!(report("inside out"), whole, "turned right side out");
    assert_eq!(report("degenerate"), Report { collapsed: 3, ..whole });
    for name in ["open", "flipped", "duplicate", "non-manifold", "leaf"] {
        let found = report(name);
        assert!(found.open_components == 1 && found.closed_components == 0, "{name}: {found:?}");
        assert!(found.general_edges > 0, "{name}: {found:?}");
    }
    let junction = report("T-junction");
    assert_eq!((junction.t_junctions, junction.open_components), (1, 1));
}

#[test]
fn closed_solids_take_one_plane_for_each_edge() {
    let connectivity = Connectivity::new(&tetrahedron());
    let outside = Silhouette::new(&connectivity, lamp(Vec3::splat(2.0)));
    assert_eq!(outside.edges.len(), 3);
    assert!(outside.edges.iter().all(|edge| edge.weight == 1));
    // From inside there is no silhouette at all, but everything outside is in shadow.
    let origin = lamp(Vec3::splat(0.1));
    let inside = Silhouette::new(&connectivity, origin);
    assert!(inside.edges.is_empty());
    assert_eq!(inside.depth_at(&connectivity, origin, DVec3::splat(3.0)), 1);
    assert_eq!(inside.depth_at(&connectivity, origin, DVec3::splat(0.05)), 0);
}

#[test]
fn only_what_moved_is_found_anew() {
    let mut casters = vec![cuboid(Vec3::NEG_ONE, Vec3::ONE), cuboid(Vec3::splat(2.0), Vec3::splat(3.0))];
    let mut meshes = Meshes::default();
    let mut shadows = Shadows::default();
    let mut update = |casters: &[Object], origin, shadows: &mut Shadows| {
        let found = meshes.of(casters).expect("valid meshes");
        shadows.update(origin, casters, &found, Order::Exact, f64::INFINITY)
    };
    let (here, there) = (lamp(Vec3::splat(9.0)), lamp(Vec3::new(9.0, 8.0, 9.0)));
    assert!(update(&casters, here, &mut shadows));
    assert!(!update(&casters, here, &mut shadows), "nothing moved");
    let before = shadows.pieces().to_vec();
    casters[1].world_from_object = Affine3A::from_translation(Vec3::X);
    assert!(update(&casters, here, &mut shadows), "an object moved");
    assert_ne!(shadows.pieces(), before);
    assert!(update(&casters, there, &mut shadows), "the light moved");
    casters.pop();
    assert!(update(&casters, there, &mut shadows), "an object went");
    let mut fresh = Shadows::default();
    update(&casters, there, &mut fresh);
    assert_eq!(shadows.pieces(), fresh.pieces(), "as if found for the first time");
    let all = shadows.edges();
    let found = Meshes::default().of(&casters).expect("valid meshes");
    shadows.update(there, &casters, &found, Order::Exact, 5.0);
    assert!(all > 0 && shadows.edges() == 0, "out of the light's reach");
    casters[0].mesh = Arc::new(Mesh { positions: vec![], ..(*casters[0].mesh).clone() });
    let error = Meshes::default().of(&casters).expect_err("an error");
    assert!(error.to_string().contains("caster 0"), "{error}");
}

#[test]
fn turned_and_mirrored_objects_cast_as_they_stand() {
    // The same solid placed in the world, and moved there by its placement.
    let turn = Affine3A::from_scale_rotation_translation(
        Vec3::new(-1.5, 0.7, 2.0),
        Quat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.4),
        Vec3::new(0.5, -1.0, 2.0),
    );
    let placed = Object { world_from_object: turn, ..object(tetrahedron()) };
    let moved = object(solids::placed(tetrahedron(), turn));
    let origin = lamp(Vec3::new(1.0, 7.0, -3.0));
    let shadows = |object: &Object| {
        let casters = [object.clone()];
        let mut shadows = Shadows::default();
        let meshes = Meshes::default().of(&casters).expect("valid meshes");
        shadows.update(origin, &casters, &meshes, Order::Exact, f64::INFINITY);
        shadows
    };
    let (a, b) = (shadows(&placed), shadows(&moved));
    assert_eq!(a.edges(), b.edges());
    for piece in a.pieces() {
        let same = |other: &&crate::Piece| {
            other.from.distance(piece.from) < 1e-5 && other.to.distance(piece.to) < 1e-5
        };
        assert!(b.pieces().iter().any(|other| same(&other)), "{piece:?}");
    }
    let mut random = random(3);
    for _ in 0..300 {
        let point = 4.0 * Vec3::from_array([0; 3].map(|_| random() as f32));
        assert_eq!(a.walk(point, 0.0).depth, b.walk(point, 0.0).depth, "{point}");
    }
}

/// Shadows of a scene's lights, whole or split.
fn of_scene(scene: &common::Scene, order: Order) -> Vec<Shadows> {
    let meshes = Meshes::default().of(&scene.objects).expect("valid meshes");
    let of_light = |light: &Light| {
        let mut shadows = Shadows::default();
        shadows.update(Origin::of(light), &scene.objects, &meshes, order, f64::INFINITY);
        shadows
    };
    scene.lights.iter().map(of_light).collect()
}

#[test]
fn planes_are_in_order_on_every_built_in_scene() {
    let mut by_angle = 0;
    for (name, _) in builtin::NAMES {
        let scene = builtin::build(name, None).expect("a name of the list");
        for time in [0.0, 1.7] {
            let scene = scene.at(time);
            let eye = scene.camera.eye;
            let wrong: Vec<usize> =
                of_scene(&scene, Order::Exact).iter().map(|shadows| shadows.violations(eye, 720)).collect();
            assert!(wrong.iter().all(|&wrong| wrong == 0), "{name} at {time}: {wrong:?}");
        }
        by_angle +=
            of_scene(&scene, Order::Angle).iter().map(|s| s.violations(scene.camera.eye, 720)).sum::<usize>();
    }
    // The measure can fail: the paper's sort makes mistakes.
    assert!(by_angle > 1000, "{by_angle}");
}

#[test]
fn cyclic_planes_are_split() {
    // Three boards, each in front of the next as the light sees them: no order of whole planes is right.
    let board = |turn: f32| {
        let mut board = cuboid(Vec3::new(-0.2, -0.05, -3.0), Vec3::new(0.2, 0.05, 3.0));
        board.world_from_object = Affine3A::from_rotation_y(turn)
            * Affine3A::from_translation(Vec3::new(1.0, 0.0, 0.0))
            * Affine3A::from_rotation_x(0.25);
        board
    };
    let casters = [0.0, 2.1, 4.2].map(board);
    let meshes = Meshes::default().of(&casters).expect("valid meshes");
    for origin in [lamp(Vec3::new(0.1, 5.0, 0.2)), sun(DVec3::new(0.1, -1.0, 0.05))] {
        let mut shadows = Shadows::default();
        shadows.update(origin, &casters, &meshes, Order::Exact, f64::INFINITY);
        let mut random = random(11);
        for _ in 0..40 {
            let eye = 6.0 * Vec3::from_array([0; 3].map(|_| random() as f32));
            assert_eq!(shadows.violations(eye, 500), 0, "{eye}");
            let mut backwards = shadows.walk(eye, 0.0).order;
            backwards.reverse();
            assert!(violations(origin, shadows.pieces(), &backwards, eye, 500) > 0);
        }
    }
}

#[test]
fn the_eye_is_moved_out_of_planes() {
    // Eye, light and an edge in one plane, exactly.
    let casters = [cuboid(Vec3::new(0.0, 1.0, -1.0), Vec3::new(1.0, 2.0, 1.0))];
    let meshes = Meshes::default().of(&casters).expect("valid meshes");
    let mut shadows = Shadows::default();
    shadows.update(lamp(Vec3::new(0.0, 4.0, 0.0)), &casters, &meshes, Order::Exact, f64::INFINITY);
    let walk = shadows.walk(Vec3::new(0.0, 0.5, 0.3), 1e-5);
    assert!(walk.eye.x != 0.0 && walk.eye.distance(Vec3::new(0.0, 0.5, 0.3)) < 1e-3, "{}", walk.eye);
    assert_eq!(walk.depth, u32::from(walk.eye.x > 0.0), "counted from where it is now");
    assert_eq!(shadows.walk(Vec3::new(0.5, 0.5, 0.3), 1e-5).eye, Vec3::new(0.5, 0.5, 0.3));
}

/// Shadows of objects, found.
fn shadows(origin: Origin, casters: &[Object]) -> Shadows {
    let meshes = Meshes::default().of(casters).unwrap();
    let mut shadows = Shadows::default();
    shadows.update(origin, casters, &meshes, Order::Angle, f64::INFINITY);
    shadows
}

#[test]
fn shadows_over_each_other_are_counted_wherever_they_are() {
    let plate = |x: f32, z: f32| cuboid(Vec3::new(x, 0.4, z), Vec3::new(x + 0.002, 1.6, z + 0.5));
    let stack: Vec<Object> = (0..300).map(|i| plate(0.004 * i as f32, -0.3)).collect();
    let light = lamp(Vec3::new(-1.1, 1.013, 0.017));
    assert_eq!(shadows(light, &stack).deepest(), 300);
    assert_eq!(shadows(sun(DVec3::new(1.0, 0.02, 0.01)), &stack).deepest(), 300);
    // From the side there is but one or the other.
    assert!(shadows(sun(DVec3::new(0.01, 0.02, 1.0)), &stack).deepest() < 20);
    let row: Vec<Object> = (0..300).map(|i| plate(0.0, 0.6 * i as f32 - 90.0)).collect();
    assert!(shadows(light, &row).deepest() <= 2);
    // So few that they need not be counted.
    assert_eq!(shadows(light, &stack[..60]).deepest(), 0);
}

#[test]
fn the_deepest_shadow_of_a_soup_is_that_of_many_places() {
    let mut next = random(11);
    let mut corner = || Vec3::new(next() as f32, next() as f32, next() as f32);
    let positions: Vec<Vec3> = (0..3000)
        .flat_map(|_| {
            let at = 0.3 * corner();
            [at + corner(), at + corner(), at + corner()]
        })
        .collect();
    let triangles = (0..3000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let normals = vec![Vec3::Y; positions.len()];
    let mesh = Mesh { positions, normals, triangles, ..Mesh::default() };
    let casters = [object(mesh)];
    for (origin, far) in [(lamp(Vec3::new(0.2, 4.0, -0.3)), true), (sun(DVec3::new(0.3, -1.0, 0.2)), false)] {
        let shadows = shadows(origin, &casters);
        let most = (0..2000)
            .map(|_| {
                let beside = DVec3::new(next(), 0.0, next());
                let place = if far {
                    let light = origin.0.truncate();
                    light + 20.0 * (beside - light)
                } else {
                    beside - 30.0 * origin.0.truncate() / origin.0.y
                };
                shadows.depth_at(place)
            })
            .max()
            .unwrap();
        let found = shadows.deepest();
        println!("{most} by places, {found} by half planes");
        assert!(most > 300 && found.abs_diff(most) * 20 < most, "{most} {found}");
    }
}
