//! Multiple scattering in clouds by **illumination networks**, after L. Szirmay-Kalos, M. Sbert and T. Umenhoffer,
//! "Real-Time Multiple Scattering in Participating Media with Illumination Networks" (2005), with the printed slips put
//! right.
//!
//! A cloud is a set of particles. For each of D directions the particles are projected onto a window of M × M pixels;
//! those of one pixel are a column, in which light goes from each to the next: the visibility network. The illumination
//! network holds the radiance that comes in at each particle in each direction. A step of the iteration hands light on
//! along all links and scatters it at all particles; one step a frame from the last solution is enough where lights move
//! slowly. The picture is drawn by splats from back to front.
//!
//! # Passes
//!
//! Linking of all directions, once for a cloud (or of some of them, where particles move); direct light, where it
//! changed; steps; what particles send to the eye and their order; splats.
//!
//! # What it can draw
//!
//! One cloud of at most [`Particles::MOST`] particles, grey extinction, coloured albedo and emission, up to
//! [`Particles::MOST_PHASES`] phase functions, each any of `common` as long as it is the same for all colours. Point,
//! spot and directional lights, any number, inside or outside, with shadows and light maps; a sky of one colour or a
//! picture. Networks whose light would grow are refused: [`Error::Diverges`].
//!
//! # Approximations
//!
//! 1. Light moves in D directions, and sideways by up to a pixel of the window on its way.
//! 2. Direct light is found in voxels, half as fine as those of the density.
//! 3. Splats that overlap are drawn one after the other, each as if it was alone.
//! 4. The scene's shadows fall on the cloud; the cloud's don't fall on the scene, and surfaces reflect nothing into it.
//!
//! # The contract
//!
//! | | |
//! |---|---|
//! | depth | depth-only view of any depth format, `TEXTURE_BINDING`, one sample, the view's size; standard or reversed, with or without a far plane, as [`common::View::depth`] says |
//! | lights | [`common::gpu::LightBinding`], shadow maps drawn earlier in the same or a previous encoder |
//! | target | view of [`Options::target_format`], `RENDER_ATTACHMENT`, the view's size; the cloud is drawn **over** it: what is behind is attenuated, and linear radiance \[W m⁻² sr⁻¹\] added |
//!
//! One [`Renderer::prepare`] per submit: what it writes lands at the next one.
#![doc = ""]
#![doc = include_str!("../domain.md")]

mod directions;
mod error;
mod lighting;
mod linking;
mod network;
mod options;
mod particles;
mod phase_matrix;
mod pipelines;
mod plan;
mod renderer;
mod sort;
mod splats;
pub mod twin;

pub use directions::{DirectionSet, Window};
pub use error::{Error, Warning};
pub use options::{Colours, Incidence, Opacity, Options, Scattering};
pub use particles::{Particle, Particles, Sampling};
pub use phase_matrix::{Components, PhaseMatrix, Quadrature};
pub use plan::{Kernel, Plan};
pub use renderer::{Buffers, Inputs, Renderer};

/// The WGSL of this crate, composed: for validation without a GPU.
pub mod shaders {
    use common::shader::{LIGHT, PHASE, SHADOW, VIEW, compose};

    const CLOUD: &str = include_str!("../shaders/cloud.wgsl");
    const DIRECT: &str = include_str!("../shaders/light.wgsl");

    /// Sorting.
    pub fn sort() -> String {
        include_str!("../shaders/sort.wgsl").into()
    }

    /// Links between particles.
    pub fn links() -> String {
        compose(&[CLOUD, include_str!("../shaders/links.wgsl")])
    }

    /// Direct light in voxels.
    pub fn voxels() -> String {
        compose(&[PHASE, LIGHT, SHADOW, CLOUD, DIRECT, include_str!("../shaders/voxels.wgsl")])
    }

    /// Direct light at particles.
    pub fn arrivals() -> String {
        compose(&[PHASE, LIGHT, CLOUD, DIRECT, include_str!("../shaders/arrivals.wgsl")])
    }

    /// Sums of direct light.
    pub fn sums() -> String {
        compose(&[CLOUD, include_str!("../shaders/sums.wgsl")])
    }

    /// Steps of the iteration.
    pub fn scatter() -> String {
        compose(&[CLOUD, include_str!("../shaders/scatter.wgsl")])
    }

    /// Radiance to the eye, and the order of splats.
    pub fn view() -> String {
        compose(&[VIEW, CLOUD, include_str!("../shaders/view.wgsl")])
    }

    /// Splats.
    pub fn splat() -> String {
        compose(&[VIEW, PHASE, LIGHT, CLOUD, include_str!("../shaders/splat.wgsl")])
    }
}
