//! Scenes that need no file; of some there is nothing but a cloud. Every object of them is a closed 2-manifold solid (or several that do
//! not touch), so that they suit every kind of shadow and light volume.

mod amphora;
mod cathedral;
mod clouds;
mod clutter;
mod complex;
mod furniture;
mod hall;
mod pen;
mod polygon;
mod props;
mod small;
pub mod solids;
mod stained_glass;
mod still_life;
mod tessellate;
mod window;

use glam::Vec3;

pub use amphora::{DEFAULT_TRIANGLES as AMPHORA_TRIANGLES, amphora};
pub use cathedral::{DEFAULT_TRIANGLES as CATHEDRAL_TRIANGLES, cathedral};
pub use clouds::{cloud, sphere};
pub use complex::{COMPLEX_CAMERA_TRIANGLES, COMPLEX_TRIANGLES, complex, complex_camera};
pub use hall::{DEFAULT_TRIANGLES as HALL_TRIANGLES, hall, hall_with_map};
pub use pen::{DEFAULT_TRIANGLES as PEN_TRIANGLES, pen};
pub use small::{GRATING_TRIANGLES, KnifeEdge, empty, grating, knife_edge, open_room, sealed_room};
pub use stained_glass::stained_glass;
pub use still_life::{DEFAULT_TRIANGLES as STILL_LIFE_TRIANGLES, still_life};
pub use window::{DEFAULT_TRIANGLES as WINDOW_TRIANGLES, window, window_with_map};

use super::{Material, Scene};

/// Fewest triangles that a scene with a choice of them can be made of.
pub const MIN_TRIANGLES: u32 = 1_000;
/// Most triangles that a scene with a choice of them can be made of.
pub const MAX_TRIANGLES: u32 = 1_000_000;

/// The built-in scenes: name, and what it shows.
pub const NAMES: &[(&str, &str)] = &[
    ("cathedral", "nave with aisles: the sun through clerestory windows, a lamp behind columns"),
    ("amphora", "pierced jug on a floor: a light inside, a spot light outside"),
    ("pen", "a pen that hops about a desk in front of two lights"),
    ("complex", "hall full of small things: a light behind a beam, one that moves behind a grille"),
    ("complex-camera", "the same hall with more in it: a walk through fog of changing density"),
    ("still-life", "a matte jug, a glossy vase and fruit on a table, a light behind them"),
    ("window", "a room with a traceried window: a light throws the picture of its stained glass"),
    ("hall", "the hall of `complex` in light through stained glass, seen from within a shaft of it"),
    ("empty", "a point light in fog and nothing else"),
    ("knife-edge", "a thin slab that cuts a point light's light along a known plane"),
    ("grating", "upright bars in front of a point light"),
    ("sealed-room", "the inside of a closed room, a point light and the sun outside: no light at all"),
    ("open-room", "the sealed room without the wall towards the lights"),
    ("sphere", "a homogeneous sphere in clear air, of known power"),
    ("cloud", "a cumulus in the sun under a blue sky, seen from all around"),
];

/// Why a built-in scene was not built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuiltinError {
    /// There is no such scene.
    #[error("there is no built-in scene `{name}`; choose one of: {}", names())]
    UnknownName {
        /// What was asked for.
        name: String,
    },
    /// The scene can't be made of so many or so few triangles.
    #[error(
        "the scene `{name}` can't be made of {triangles} triangles; choose a number from {MIN_TRIANGLES} \
         to {MAX_TRIANGLES}"
    )]
    TrianglesOutOfRange {
        /// The scene.
        name: String,
        /// What was asked for.
        triangles: u32,
    },
    /// The scene is what it is.
    #[error("the scene `{name}` has no choice of triangle count; leave the count out")]
    NoTriangleChoice {
        /// The scene.
        name: String,
    },
}

fn names() -> String {
    NAMES.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

/// Builds the scene of that name (see [`NAMES`]), of about `triangles` triangles: at most 0.5 % from
/// it. Without a number it has as many as suit it.
///
/// # Errors
/// For a name that no scene has, and for a number out of the scene's range.
pub fn build(name: &str, triangles: Option<u32>) -> Result<Scene, BuiltinError> {
    let counted = |default: u32, scene: fn(u32) -> Scene| match triangles {
        Some(triangles) if !(MIN_TRIANGLES..=MAX_TRIANGLES).contains(&triangles) => {
            Err(BuiltinError::TrianglesOutOfRange { name: name.into(), triangles })
        }
        wanted => Ok(scene(wanted.unwrap_or(default))),
    };
    let fixed = |scene: fn() -> Scene| match triangles {
        Some(_) => Err(BuiltinError::NoTriangleChoice { name: name.into() }),
        None => Ok(scene()),
    };
    match name {
        "cathedral" => counted(CATHEDRAL_TRIANGLES, cathedral),
        "amphora" => counted(AMPHORA_TRIANGLES, amphora),
        "pen" => counted(PEN_TRIANGLES, pen),
        "complex" => counted(COMPLEX_TRIANGLES, complex),
        "complex-camera" => counted(COMPLEX_CAMERA_TRIANGLES, complex_camera),
        "still-life" => counted(STILL_LIFE_TRIANGLES, still_life),
        "window" => counted(WINDOW_TRIANGLES, window),
        "hall" => counted(HALL_TRIANGLES, hall),
        "grating" => counted(GRATING_TRIANGLES, grating),
        "empty" => fixed(empty),
        "knife-edge" => fixed(knife_edge),
        "sealed-room" => fixed(sealed_room),
        "open-room" => fixed(open_room),
        "sphere" => fixed(sphere),
        "cloud" => fixed(cloud),
        _ => Err(BuiltinError::UnknownName { name: name.into() }),
    }
}

fn matte(name: &str, k_d: Vec3) -> Material {
    Material { name: name.into(), k_d, ..Material::default() }
}

#[cfg(test)]
mod tests;
