//! Multiple scattering in clouds by **illumination networks**, after L. Szirmay-Kalos, M. Sbert and T. Umenhoffer,
//! "Real-Time Multiple Scattering in Participating Media with Illumination Networks" (2005), with the printed slips put
//! right.

mod directions;
mod error;
mod network;
mod options;
mod particles;
mod phase_matrix;
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
