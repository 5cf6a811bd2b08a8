//! What is drawn: a hall with slits in one wall, a lamp behind a grille, and the sun outside.

use glam::camera::rh::view;
use glam::{Mat4, Vec3};

use crate::depth::Depth;

/// Position \[m\], normal and diffuse reflectance.
pub type Vertex = [Vec3; 3];

/// Extinction coefficient of the fog \[1/m\].
pub const SIGMA_T: f32 = 0.07;

/// Vertical field of view \[rad\].
const FOV_Y: f32 = 0.95;

/// A lamp that shines into a cone.
#[derive(Clone, Copy, Debug)]
pub struct Lamp {
    /// Apex \[m\].
    pub position: Vec3,
    /// Axis, the way the light travels; unit length.
    pub direction: Vec3,
    /// Radiant intensity \[W/sr\].
    pub intensity: Vec3,
    /// Half angles of whole and of no intensity \[rad\].
    pub angles: [f32; 2],
    /// What its shadow map is drawn with.
    pub clip_from_world: Mat4,
}

/// Parallel light.
#[derive(Clone, Copy, Debug)]
pub struct Sun {
    /// The way the light travels; unit length.
    pub direction: Vec3,
    /// Irradiance \[W/m²\].
    pub irradiance: Vec3,
    /// What its shadow map is drawn with.
    pub clip_from_world: Mat4,
}

/// All that changes from frame to frame.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Where the eye is \[m\].
    pub eye: Vec3,
    /// From world to view: x right, y up, −z forward.
    pub view_from_world: Mat4,
    /// From view to clip space.
    pub clip_from_view: Mat4,
    /// One light.
    pub lamp: Lamp,
    /// The other one.
    pub sun: Sun,
    /// Low and high corner of the scene \[m\].
    pub bounds: (Vec3, Vec3),
}

impl Moment {
    /// The scene at a time \[s\], for a picture of that aspect.
    pub fn at(time: f32, aspect: f32, depth: Depth, bounds: (Vec3, Vec3)) -> Self {
        let eye = Vec3::new(-0.6 + 0.4 * (0.3 * time).sin(), 1.7, 5.6);
        let forward = (Vec3::new(0.1, 1.5, -2.0) - eye).normalize();

        let position = Vec3::new(-3.4, 3.1, 0.6);
        let direction = Vec3::new(0.8, -0.45 + 0.08 * time.sin(), -0.35).normalize();
        let angles = [0.42, 0.5];
        // A cone's map: twice the half angle, no more.
        let lens = depth.perspective(2.0 * angles[1], 1.0, [0.05, 40.0]);
        let lamp = Lamp {
            position,
            direction,
            intensity: Vec3::new(60.0, 42.0, 22.0),
            angles,
            clip_from_world: lens * view::look_to_mat4(position, direction, Vec3::Y),
        };

        // A map that has the whole scene in it.
        let (low, high) = bounds;
        let (centre, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
        let direction = Vec3::new(-0.8, -0.55, -0.12).normalize();
        let sun = Sun {
            direction,
            irradiance: Vec3::new(3.0, 3.4, 4.2),
            clip_from_world: depth.parallel(radius, [0.0, 2.0 * radius])
                * view::look_to_mat4(centre - radius * direction, direction, Vec3::Y),
        };
        Self {
            eye,
            view_from_world: view::look_to_mat4(eye, forward, Vec3::Y),
            clip_from_view: depth.perspective(FOV_Y, aspect, [0.1, 60.0]),
            lamp,
            sun,
            bounds,
        }
    }
}

/// The hall's triangles.
pub fn hall() -> Vec<Vertex> {
    let (stone, wood) = (Vec3::new(0.55, 0.5, 0.45), Vec3::new(0.4, 0.25, 0.15));
    let mut all = Vec::new();
    let mut cuboid = |low: [f32; 3], high: [f32; 3], colour| add_cuboid(&mut all, low, high, colour);
    cuboid([-4.5, -0.3, -5.3], [4.5, 0.0, 6.5], stone);
    cuboid([-4.5, 4.0, -5.3], [4.5, 4.3, 6.5], stone);
    cuboid([-4.5, 0.0, -5.3], [4.5, 4.0, -5.0], stone);
    cuboid([-4.8, 0.0, -5.3], [-4.5, 4.0, 6.5], stone);
    // The wall to the right: solid below and above, slits between.
    cuboid([4.2, 0.0, -5.3], [4.5, 1.2, 6.5], stone);
    cuboid([4.2, 3.4, -5.3], [4.5, 4.0, 6.5], stone);
    for i in 0..10 {
        let z = -5.3 + 1.25 * i as f32;
        cuboid([4.2, 1.2, z], [4.5, 3.4, z + 0.85], stone);
    }
    // What stands in the way of the light.
    cuboid([1.2, 0.0, -1.6], [1.7, 2.6, -1.1], stone);
    cuboid([-1.6, 0.0, -3.2], [-1.1, 4.0, -2.7], stone);
    cuboid([-0.6, 0.0, 0.2], [0.2, 0.8, 1.0], wood);
    // The lamp's grille.
    for i in 0..5 {
        let y = 2.55 + 0.22 * i as f32;
        cuboid([-2.75, y, -0.5], [-2.7, y + 0.08, 1.2], wood);
    }
    all
}

/// Low and high corner of what vertices span.
pub fn bounds(vertices: &[Vertex]) -> (Vec3, Vec3) {
    let span = |(low, high): (Vec3, Vec3), &[position, ..]: &Vertex| (low.min(position), high.max(position));
    vertices.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), span)
}

fn add_cuboid(all: &mut Vec<Vertex>, low: [f32; 3], high: [f32; 3], colour: Vec3) {
    let (low, high) = (Vec3::from(low), Vec3::from(high));
    for axis in 0..3 {
        let [normal, u, v] = [0, 1, 2].map(|i| Vec3::AXES[(axis + i) % 3]);
        for (from, normal) in [(low, -normal), (high, normal)] {
            let (u, v) = (u * (high - low), v * (high - low));
            let corner = from * normal.abs() + low * (Vec3::ONE - normal.abs());
            let quad = [corner, corner + u, corner + u + v, corner, corner + u + v, corner + v];
            all.extend(quad.map(|position| [position, normal, colour]));
        }
    }
}
