//! Multiple scattering in clouds by **illumination networks**. A cloud is a set of particles. For each of D directions
//! the particles are projected onto a window of M × M pixels; those of one pixel are a column, in which light goes from
//! each to the next: the visibility network. The illumination network holds the radiance that comes in at each particle
//! in each direction. A step of the iteration hands light on along all links and scatters it at all particles; one step
//! a frame from the last solution is enough where lights move slowly. The picture is drawn by splats from back to
//! front.
//!
//! After L. Szirmay-Kalos, M. Sbert and T. Umenhoffer, "Real-Time Multiple Scattering in Participating Media with
//! Illumination Networks" (2005), with the printed slips put right.
//!
#![doc = include_str!("../picture.md")]
//!
//! # The smallest program
//!
//! Device, depth, shadow maps and target are yours; `examples/minimal.rs` is a whole program.
//!
//! ```no_run
//! use common::gpu::{LightBinding, PassTimer};
//! use common::{Cloud, Sky, View};
//! use szk_network::{Error, Inputs, Options, Particles, Renderer, Sampling};
//!
//! /// Once for a cloud.
//! fn make(
//!     device: &wgpu::Device,
//!     queue: &wgpu::Queue,
//!     target_format: wgpu::TextureFormat,
//!     cloud: &Cloud,
//! ) -> Result<Renderer, Error> {
//!     let particles = Particles::sample(cloud, 4096, Sampling::Even)?;
//!     let options = Options { target_format, ..Options::default() };
//!     let mut network = Renderer::new(device, &options)?;
//!     network.load(device, queue, &particles)?;
//!     Ok(network)
//! }
//!
//! /// In every frame, into an encoder that has drawn depth and shadow maps;
//! /// the caller submits it.
//! fn draw(
//!     network: &mut Renderer,
//!     (device, queue): (&wgpu::Device, &wgpu::Queue),
//!     encoder: &mut wgpu::CommandEncoder,
//!     (view, lights, sky): (&View, &[LightBinding], &Sky),
//!     depth: &wgpu::TextureView,
//!     target: &wgpu::TextureView,
//! ) -> Result<(), Error> {
//!     // A step a frame, each from where the last one ended.
//!     let (relight, steps, residual) = (true, 1, 0.0);
//!     let inputs = Inputs { view, lights, sky, depth, relight, steps, residual };
//!     network.prepare(device, queue, &inputs)?;
//!     network.encode(encoder, target, &mut PassTimer::off());
//!     Ok(())
//! }
//! ```
//!
//! # The contract
//!
//! | what | format | usage | size | unit, meaning | who makes it |
//! |---|---|---|---|---|---|
//! | the cloud | [`Particles`] | | 1 to [`MOST`](Particles::MOST) | places and sizes \[m\], extinction \[1/m\], emission \[W m⁻³ sr⁻¹\] | [`Particles::sample`] of a [`Cloud`](common::Cloud), [`Particles::new`], or `Particles::read` (feature `files`) |
//! | [`view`](Inputs::view) | [`View`](common::View) | | that of depth and target \[pixels\] | eye \[m\], near plane \[m\], what depth means | you, for every frame: by [`View::from_matrices`](common::View::from_matrices) of your own |
//! | [`lights`](Inputs::lights) | [`LightBinding`](common::gpu::LightBinding), any number | | | \[W/sr\], directional \[W/m²\] | you, or [`Ground`](common::gpu::Ground) |
//! | their shadow maps | array of `Depth32Float`, six layers around a point light, else one | `TEXTURE_BINDING` | square, 2 texels up to the device's limit | reversed depth as [`shadow_projection`](common::gpu::shadow_projection) has it | `Ground`'s, or yours by [`ForeignMap`](common::gpu::ForeignMap); drawn before in the same or an earlier encoder |
//! | [`sky`](Inputs::sky) | [`Sky`](common::Sky) | | all around | radiance \[W m⁻² sr⁻¹\], RGB | you |
//! | [`depth`](Inputs::depth) | any depth format, a depth-only view, one sample | `TEXTURE_BINDING` | the view's | standard or reversed, with or without a far plane, as [`View::depth`](common::View::depth) says | your depth pass, or `Ground`'s |
//! | `target` | [`target_format`](Options::target_format) | `RENDER_ATTACHMENT` | the view's | linear radiance \[W m⁻² sr⁻¹\], RGB: the cloud is drawn **over** it: what is behind is attenuated, its own light added; alpha is covered by 1 − transmittance | you |
//! | `encoder` | `CommandEncoder` | | | passes go in, nothing is submitted | you |
//! | `timer` | [`PassTimer`](common::gpu::PassTimer) | | | time of each pass \[ms\] | you; `PassTimer::off()` measures nothing |
//!
//! One [`Renderer::prepare`] per submit: what it writes lands at the next one. It draws one cloud of grey extinction,
//! coloured albedo and emission, up to [`Particles::MOST_PHASES`] phase functions, each any of `common` as long as it is
//! the same for all colours. Point, spot and directional lights, any number, inside or outside, with shadows and light
//! maps; a sky of one colour or a picture. Networks whose light would grow are refused: [`Error::Diverges`]. No device
//! feature is needed; targets of `Rgba32Float` use `FLOAT32_BLENDABLE`.
//!
#![doc = include_str!("../domain.md")]
//!
//! # Cost
//!
//! A frame with one step of the iteration and all direct light found anew, and error of the picture (relative RMSE):
//! `sphere`, llvmpipe, a **software** adapter, 2 cores, 160×128, 2026-11-29. It says little about a GPU.
//!
//! | | particles, directions | time | error | memory |
//! |---|---|---|---|---|
//! | [`Options::paper`] | 1024, 128 | 1 (134 ms) | 34.8 % | 9 MB |
//! | [`Options::default`] | 1024, 128 | 2.46 × | 17.2 % | 8 MB |
//! | [`Options::default`] | 4096, 128 | 5.88 × | 8.27 % | 32 MB |
//! | [`Options::default`] | 16384, 128 | 8.99 × | 4.91 % | 72 MB |
//!
//! A step is in proportion to the number of particles (to the power of 0.96) and, by components, about to that of
//! directions (to the power of 1.21; by whole matrices 1.94). Most of the default's time here is that of its splats'
//! pixels.
//!
//! # Passes
//!
//! Linking of all directions, once for a cloud (or of some of them, where particles move); direct light, where it
//! changed; steps; what particles send to the eye and their order; splats.
//!
//! # Approximations
//!
//! 1. Light moves in D directions, and sideways by up to a pixel of the window on its way.
//! 2. Direct light is found in voxels, half as fine as those of the density.
//! 3. Splats that overlap are drawn one after the other, each as if it was alone.
//! 4. The scene's shadows fall on the cloud; the cloud's don't fall on the scene, and surfaces reflect nothing into it.

mod directions;
mod error;
#[cfg(feature = "files")]
mod file;
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

pub use directions::DirectionSet;
pub use error::{Error, Warning};
pub use options::{Colours, Incidence, Opacity, Options, Scattering};
pub use particles::{Particle, Particles, Sampling};
pub use phase_matrix::Quadrature;
pub use plan::Plan;
pub use renderer::{Inputs, Renderer};

// Hidden: what a network is made of, for tests, benches and measurements.
#[doc(hidden)]
pub use directions::Window;
#[doc(hidden)]
pub use phase_matrix::{Components, PhaseMatrix};
#[doc(hidden)]
pub use plan::Kernel;
#[doc(hidden)]
pub use renderer::Buffers;

/// The WGSL of this crate, composed. Hidden: it is for the tests, which validate it without a GPU, and changes with the
/// passes.
#[doc(hidden)]
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
