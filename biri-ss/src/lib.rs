//! **Analytic single scattering with sorted shadow planes**, after V. Biri, "Real time single scattering
//! effects" (CGAMES 2006), with the printed slips put right.
//!
//! Along a view ray, airlight has a closed form but for one integral, which is tabulated once. Where a caster
//! stands between light and ray, the ray is in shadow between two *shadow planes*: quads from the caster's
//! silhouette edges away from the light, endless. Drawn in the order in which a ray meets them, with the
//! number of shadows kept in the stencil, those that part light from shadow add and take away the airlight up
//! to them. The shadows are exact, to the pixel, for any triangles: no shadow map, no steps, no noise. What
//! the medium scatters lights surfaces, too (*indirect single scattering*), by tables again.
//!
//! # Passes
//!
//! On the CPU, for each light: silhouettes, a binary space partition of the planes (both only where something
//! moved), the order for this eye, and in how many shadows the eye is. On the GPU, for each light: what the planes of
//! a ray have in common; all planes in one call and the airlight up to lit surfaces; direct light on them; indirect light. At last, add the
//! sum to the target.
//!
//! # What it can draw
//!
//! Point, spot and directional lights, any number; homogeneous media, coloured; every phase function of
//! `common`; casters of any kind of mesh, moving or not, the eye anywhere. Refused with an error that names
//! it: light maps; spots where indirect light is asked for, and soft-edged ones for [`Airlight::Gamma`].
//!
//! # Approximations
//!
//! 1. Single scattering; an ambient radiance stands for the rest if one is given.
//! 2. Indirect light is that of a medium without end or shadow: too bright where walls are near or in the way.
//! 3. A Phong lobe gathers indirect light with the cosine law taken at its axis, also below the horizon.
//! 4. A place in 256 shadows of one light, or a multiple of that, is drawn as lit: the stencil has 8 bits. Where so many
//!    lie over each other is warned about.
//!
//! # The contract
//!
//! | | |
//! |---|---|
//! | depth | depth-only view of any depth format, `TEXTURE_BINDING`, one sample, the view's size; standard or reversed, with or without a far plane, as [`common::View::depth`] says |
//! | casters | [`common::scene::Object`]: everything that casts, seen or not; the same mesh `Arc` every frame |
//! | surfaces | three textures, see [`Surfaces`]; needed for light on surfaces only |
//! | outputs | views of [`Options::target_format`], `RENDER_ATTACHMENT`, the view's size; each term is added, linear radiance \[W m⁻² sr⁻¹\] |
//!
//! One [`Renderer::prepare`] per submit: what it writes lands at the next one.
#![doc = ""]
#![doc = include_str!("../domain.md")]

mod bsp;
mod connectivity;
mod deepest;
mod error;
mod gpu_tables;
mod light;
mod options;
mod order;
mod pipelines;
mod refuse;
mod renderer;
mod shadows;
mod silhouette;
pub mod table;
#[cfg(test)]
mod tests;

pub use bsp::{Bsp, Piece};
pub use common::gpu::Accumulation;
pub use connectivity::{Connectivity, Report};
pub use error::Error;
pub use options::{Airlight, Counting, Indirect, Options, Order};
pub use order::violations;
pub use renderer::{Inputs, Outputs, Renderer, Statistics, Surfaces};
pub use silhouette::{Origin, Silhouette, SilhouetteEdge};

/// The WGSL of this crate, composed: for validation without a GPU.
pub mod shaders {
    use common::shader::{
        AIRLIGHT, ARRIVAL, FULLSCREEN, HAZE, KIND, LIGHT, MEDIUM, PHASE, TABLE, VIEW, compose,
    };

    const GAMMA: &str = include_str!("../shaders/gamma.wgsl");
    const VOLUME: &str = include_str!("../shaders/volume.wgsl");
    const PLANES: &str = include_str!("../shaders/planes.wgsl");
    const REST: &str = include_str!("../shaders/rest.wgsl");
    const SURFACES: &str = include_str!("../shaders/surfaces.wgsl");

    /// Shadow planes and caps, and the airlight up to them.
    pub fn planes() -> String {
        compose(&[VIEW, PHASE, MEDIUM, LIGHT, KIND, HAZE, AIRLIGHT, TABLE, VOLUME, GAMMA, PLANES, REST])
    }

    /// Light on surfaces.
    pub fn surfaces() -> String {
        compose(&[FULLSCREEN, VIEW, PHASE, MEDIUM, LIGHT, KIND, HAZE, ARRIVAL, TABLE, VOLUME, SURFACES])
    }
}
