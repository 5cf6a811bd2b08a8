//! wip
#![allow(missing_docs)]
mod bsp;
mod connectivity;
mod error;
mod light;
mod options;
mod order;
mod pipelines;
mod renderer;
mod shadows;
mod silhouette;
pub mod table;
#[cfg(test)]
mod tests;

pub use bsp::{Bsp, Piece};
pub use connectivity::{Connectivity, Report};
pub use error::Error;
pub use options::{Accumulation, Airlight, Counting, Indirect, Options, Order};
pub use order::violations;
pub use renderer::{Inputs, Outputs, Renderer, Statistics, Surfaces};
pub use silhouette::{Origin, Silhouette, SilhouetteEdge};

/// The WGSL of this crate, composed: for validation without a GPU.
pub mod shaders {
    use common::shader::{ADD, AIRLIGHT, ARRIVAL, FULLSCREEN, LIGHT, MEDIUM, PHASE, TABLE, VIEW, compose};

    /// Airlight by the paper's tables; needs the chunks phase, medium, light, airlight and table before it.
    pub const GAMMA: &str = include_str!("../shaders/gamma.wgsl");
    const VOLUME: &str = include_str!("../shaders/volume.wgsl");
    const PLANES: &str = include_str!("../shaders/planes.wgsl");
    const SURFACES: &str = include_str!("../shaders/surfaces.wgsl");

    /// Shadow planes and caps, and the airlight up to them.
    pub fn planes() -> String {
        compose(&[VIEW, PHASE, MEDIUM, LIGHT, AIRLIGHT, TABLE, VOLUME, GAMMA, PLANES])
    }

    /// Light on surfaces.
    pub fn surfaces() -> String {
        compose(&[FULLSCREEN, VIEW, PHASE, MEDIUM, LIGHT, ARRIVAL, TABLE, VOLUME, SURFACES])
    }

    /// Adding to the target.
    pub fn add() -> String {
        compose(&[FULLSCREEN, ADD])
    }
}
