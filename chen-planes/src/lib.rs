//! Light shafts by **virtual sampling planes**, after S. Chen, S. Li and G. Wang, "Real-Time Rendering of Light
//! Shafts on GPU" (2006), with the printed slips put right.
//!
//! Planes parallel to the screen cut the fog into slabs. Each is drawn as a lattice, all of them by one instanced
//! draw, and adds what its slab scatters towards the eye. In the paper's form the smooth factor of the integrand
//! (attenuation on both ways over the squared distance from the light) is found at lattice points and interpolated;
//! shadow, light map and phase function are looked up for each fragment.
//!
//! # Passes
//!
//! Clear; for each light all its planes; at last, add the sum to the target.
//!
//! # What it can draw
//!
//! Point, spot and directional lights, any number, spots with soft edges and light maps; homogeneous media, coloured;
//! every phase function of `common`. Nothing is refused.
//!
//! # Approximations
//!
//! 1. Single scattering.
//! 2. Shadows are those of the shadow map.
//! 3. An edge of a shadow is off by up to half the distance of two places where shadows are looked up: the error falls
//!    as one over their number.
//! 4. Without [`Factor::Integrated`] a light near a ray is missed between planes or overshoots on one, by
//!    coth(πh/Δ) − 1 at a distance h from the ray and a spacing Δ of the planes; and interpolation between lattice
//!    points at a distance s leaves a²/(a² + s²/2) of the light of a plane at a distance a from the light.
//!
//! # The contract
//!
//! | | |
//! |---|---|
//! | depth | depth-only view of any depth format, `TEXTURE_BINDING`, one sample, the view's size (where it is also a `RENDER_ATTACHMENT`, [`Options::early_end`] saves work); standard or reversed, with or without a far plane, as [`common::View::depth`] says |
//! | lights | [`common::gpu::LightBinding`], shadow maps drawn earlier in the same or a previous encoder |
//! | target | view of [`Options::target_format`], `RENDER_ATTACHMENT`, the view's size; airlight is added, linear radiance \[W m⁻² sr⁻¹\] |
//!
//! One [`Renderer::prepare`] per submit: what it writes lands at the next one.
#![doc = ""]
#![doc = include_str!("../domain.md")]

mod error;
mod lattice;
mod options;
mod phase;
mod pipelines;
mod placement;
mod renderer;

pub use common::gpu::Accumulation;
pub use error::Error;
pub use options::{Factor, Options, Placement, Visibility};
pub use placement::{reach, slabs};
pub use renderer::{Inputs, Renderer};

/// The WGSL of this crate, composed: for validation without a GPU.
pub mod shaders {
    use common::shader::{AIRLIGHT, HAZE, KIND, LIGHT, MEDIUM, PHASE, SHADOW, VIEW, compose};

    const PLANES: &str = include_str!("../shaders/planes.wgsl");

    /// Drawing of planes.
    pub fn planes() -> String {
        compose(&[VIEW, PHASE, MEDIUM, LIGHT, KIND, HAZE, AIRLIGHT, SHADOW, PLANES])
    }
}
