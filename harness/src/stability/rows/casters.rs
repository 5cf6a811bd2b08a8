//! What casts shadows: meshes as they come, and nothing at all.

use common::scene::builtin::solids;
use common::scene::{Mesh, Object};
use common::{Light, Medium, Scene};
use glam::{Affine3A, Vec3};

use crate::stability::row::{Parameter, Part, Row, Setup, Truth, all, all_and_unshadowed};
use crate::stability::scenes::{boxed, lamp, object, posts, posts_with, sun};

/// Makes a row's objects, and changes its scene.
type Objects = fn() -> Vec<Object>;
type Change = fn(&mut Scene);

/// A mesh and what makes it a bad one.
const FAULTS: &[(&str, Objects)] = &[
    ("closed", || vec![crate_of(solid())]),
    ("a face missing", || vec![crate_of(Mesh { triangles: solid().triangles.split_off(2), ..solid() })]),
    ("one triangle missing", || {
        vec![crate_of(Mesh { triangles: solid().triangles.split_off(1), ..solid() })]
    }),
    ("all triangles inside out", || {
        let mesh = solid();
        let triangles = mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        vec![crate_of(Mesh { triangles, ..mesh })]
    }),
    ("some triangles inside out", || {
        let mut mesh = solid();
        mesh.triangles.iter_mut().step_by(3).for_each(|corners| corners.swap(1, 2));
        vec![crate_of(mesh)]
    }),
    ("every triangle twice", || {
        let mut mesh = solid();
        mesh.triangles.extend(mesh.triangles.clone());
        vec![crate_of(mesh)]
    }),
    ("a fin of one triangle on an edge", || {
        let mut mesh = solid();
        mesh.positions.push(Vec3::new(-0.9, 1.6, 0.9));
        mesh.triangles.push([2, 3, 8]);
        vec![crate_of(mesh)]
    }),
    ("triangles without area", || {
        let mut mesh = solid();
        mesh.triangles.extend([[0, 0, 1], [1, 1, 1], [0, 1, 0]]);
        vec![crate_of(mesh)]
    }),
    ("a T-junction", || vec![crate_of(with_a_t_junction())]),
    ("a leaf of two triangles", || vec![crate_of(leaf(false))]),
    ("a leaf with both sides", || vec![crate_of(leaf(true))]),
    ("a solid twice in one place", || vec![crate_of(solid()), crate_of(solid())]),
    ("solids through each other", || {
        let other = Affine3A::from_rotation_y(0.7) * Affine3A::from_translation(Vec3::new(0.3, 0.1, 0.2));
        vec![crate_of(solid()), crate_of(solids::placed(solid(), other))]
    }),
    ("solids that share a face", || {
        vec![boxed([-0.9, 0.2, 0.3], [-0.3, 1.1, 0.9]), boxed([-0.3, 0.2, 0.3], [0.2, 1.1, 0.9])]
    }),
    ("three planks over each other in a ring", || {
        let plank = Mesh { ..solids::cuboid(Vec3::new(-0.9, -0.03, -0.1), Vec3::new(0.9, 0.03, 0.1)) };
        let turned = |third: f32| {
            let turn = Affine3A::from_rotation_y(third * std::f32::consts::TAU / 3.0);
            // Each rises along its length, over the next and under the one before.
            turn * Affine3A::from_translation(Vec3::new(0.1, 0.0, 0.4)) * Affine3A::from_rotation_z(0.12)
        };
        let place = Affine3A::from_translation(Vec3::new(-0.3, 0.6, 0.4));
        (0..3).map(|i| crate_of(solids::placed(plank.clone(), place * turned(i as f32)))).collect()
    }),
    ("a needle of a thousand to one", || {
        vec![boxed([-0.9, 0.2, 0.4], [-0.898, 2.2, 0.402]), boxed([-1.2, 0.9, 0.5], [0.8, 0.902, 0.502])]
    }),
];

const NAMES: [&str; 16] = {
    let mut names = [""; 16];
    let mut index = 0;
    while index < FAULTS.len() {
        names[index] = FAULTS[index].0;
        index += 1;
    }
    names
};

fn solid() -> Mesh {
    solids::cuboid(Vec3::new(-0.9, 0.2, 0.3), Vec3::new(0.2, 1.1, 0.9))
}

fn crate_of(mesh: Mesh) -> Object {
    object("crate", mesh)
}

/// The crate with an edge cut in two on one of its sides only.
fn with_a_t_junction() -> Mesh {
    let mut mesh = solid();
    let [a, b, c] = mesh.triangles.swap_remove(0);
    let middle = mesh.positions.len() as u32;
    mesh.positions.push(mesh.positions[a as usize].lerp(mesh.positions[b as usize], 0.37));
    mesh.triangles.extend([[a, middle, c], [middle, b, c]]);
    mesh
}

fn leaf(both: bool) -> Mesh {
    let positions = [[-0.9, 0.3, 0.3], [0.3, 0.2, 0.6], [0.4, 1.2, 0.5], [-0.8, 1.1, 0.4]].map(Vec3::from);
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    if both {
        triangles.extend([[0, 2, 1], [0, 3, 2]]);
    }
    Mesh { positions: positions.into(), triangles, ..Mesh::default() }
}

fn faulty(which: f64) -> Setup {
    let (_, make) = FAULTS[which as usize % FAULTS.len()];
    Setup::of(posts_with(|scene| {
        scene.objects.truncate(1);
        scene.objects.extend(make());
    }))
}

/// What a scene can lack.
const LACKS: &[(&str, Change)] = &[
    ("nothing", |_| {}),
    ("objects", |scene| scene.objects.clear()),
    ("triangles", |scene| scene.objects = vec![crate_of(Mesh::default())]),
    ("a medium", |scene| scene.medium = Medium::vacuum()),
    ("power of its lights", |scene| scene.lights = vec![lamp(Vec3::new(0.1, 1.3, -0.6), 0.0)]),
    ("lights", |scene| scene.lights.clear()),
    ("anything", |scene| *scene = Scene { camera: scene.camera, ..Scene::empty("nothing") }),
    ("anything in its sun's way", |scene| {
        scene.objects.clear();
        scene.lights = vec![sun(Vec3::new(0.3, -0.8, 0.2))];
    }),
    ("anything before the eye", |scene| {
        let behind = 2.0 * scene.camera.eye - scene.camera.target;
        scene.camera.target = behind.with_y(9.0);
    }),
];

const LACKING: [&str; 9] = {
    let mut names = [""; 9];
    let mut index = 0;
    while index < LACKS.len() {
        names[index] = LACKS[index].0;
        index += 1;
    }
    names
};

fn lacking(which: f64) -> Setup {
    let (_, change) = LACKS[which as usize % LACKS.len()];
    let mut scene = posts();
    change(&mut scene);
    let dark = scene.medium == Medium::vacuum()
        || scene.lights.iter().all(|light: &Light| light.strength() == Vec3::ZERO);
    let truth = if dark { Truth::Black(Box::new(posts())) } else { Truth::Own };
    Setup::of(scene).against(truth)
}

pub(super) fn rows() -> Vec<Row> {
    vec![
        Row {
            id: "casters",
            title: "meshes as they come from modellers",
            why: "Shadow volumes count silhouette edges: an open, doubled or flipped one leaves light or darkness \
                  behind to the end of the world.",
            parameter: Parameter::Choice { name: "the mesh", values: &NAMES },
            quick: &[1.0, 5.0, 9.0],
            build: faulty,
            methods: all,
            ..Row::of(Part::Casters)
        },
        Row {
            id: "nothing",
            title: "scenes that lack something",
            why: "Empty buffers, empty shadow maps, divisions by nothing.",
            parameter: Parameter::Choice { name: "what is missing", values: &LACKING },
            quick: &[1.0, 5.0],
            build: lacking,
            methods: all_and_unshadowed,
            ..Row::of(Part::Casters)
        },
    ]
}
