//! Light shafts by **virtual sampling planes**. Planes parallel to the screen cut the fog into slabs. Each is drawn as
//! a lattice, all of them by one instanced draw, and adds what its slab scatters towards the eye. In the paper's form
//! the smooth factor of the integrand (attenuation on both ways over the squared distance from the light) is found at
//! lattice points and interpolated; shadow, light map and phase function are looked up for each fragment. It needs a
//! shadow map and the scene's depth, and it draws what closed forms can't: stained glass.
//!
//! After S. Chen, S. Li and G. Wang, "Real-Time Rendering of Light Shafts on GPU" (2006), with the printed slips put
//! right.
//!
#![doc = include_str!("../picture.md")]
//!
//! # The smallest program
//!
//! Device, depth, shadow maps and target are yours; `examples/minimal.rs` is a whole program.
//!
//! ```no_run
//! use chen_planes::{Error, Inputs, Options, Renderer};
//! use common::gpu::{LightBinding, PassTimer};
//! use common::{Medium, View};
//!
//! /// Once.
//! fn make(
//!     device: &wgpu::Device,
//!     queue: &wgpu::Queue,
//!     target_format: wgpu::TextureFormat,
//! ) -> Result<Renderer, Error> {
//!     Renderer::new(device, queue, &Options { target_format, ..Options::default() })
//! }
//!
//! /// In every frame, into an encoder that has drawn depth and shadow maps;
//! /// the caller submits it. `reach` [m] is the depth of the farthest surface.
//! fn draw(
//!     planes: &mut Renderer,
//!     (device, queue): (&wgpu::Device, &wgpu::Queue),
//!     encoder: &mut wgpu::CommandEncoder,
//!     (view, medium, lights, reach): (&View, &Medium, &[LightBinding], f32),
//!     depth: &wgpu::TextureView,
//!     target: &wgpu::TextureView,
//! ) -> Result<(), Error> {
//!     planes.prepare(device, queue, &Inputs { view, medium, lights, depth, reach })?;
//!     planes.encode(encoder, target, &mut PassTimer::off());
//!     Ok(())
//! }
//! ```
//!
//! # The contract
//!
//! | what | format | usage | size | unit, meaning | who makes it |
//! |---|---|---|---|---|---|
//! | [`view`](Inputs::view) | [`View`](common::View) | | that of depth and target \[pixels\] | eye \[m\], near plane \[m\], what depth means | you, for every frame: by [`View::from_matrices`](common::View::from_matrices) of your own |
//! | [`medium`](Inputs::medium) | [`Medium`](common::Medium) | | all of space | `sigma_s`, `sigma_a` \[1/m\], RGB; phase function \[1/sr\] | you |
//! | [`lights`](Inputs::lights) | [`LightBinding`](common::gpu::LightBinding), any number | | | \[W/sr\], directional \[W/m²\] | you, or [`Ground`](common::gpu::Ground) |
//! | their shadow maps | array of `Depth32Float`, six layers around a point light, else one | `TEXTURE_BINDING` | square, 2 texels up to the device's limit | reversed depth as [`shadow_projection`](common::gpu::shadow_projection) has it | `Ground`'s, or yours by [`ForeignMap`](common::gpu::ForeignMap); drawn before in the same or an earlier encoder |
//! | a spot's light map, optional | [`LightMap`](common::LightMap) | | any | linear RGB, tints the intensity | you |
//! | [`depth`](Inputs::depth) | any depth format, a depth-only view, one sample | `TEXTURE_BINDING`; also `RENDER_ATTACHMENT`, and [`early_end`](Options::early_end) saves work | the view's | standard or reversed, with or without a far plane, as [`View::depth`](common::View::depth) says | your depth pass, or `Ground`'s |
//! | [`reach`](Inputs::reach) | `f32` | | above the near plane, finite | depth of the farthest surface \[m\] | [`reach`], or you |
//! | `target` | [`target_format`](Options::target_format) | `RENDER_ATTACHMENT` | the view's | linear radiance \[W m⁻² sr⁻¹\], RGB: airlight is **added**, alpha stays | you; surfaces in it are attenuated by you |
//! | `encoder` | `CommandEncoder` | | | passes go in, nothing is submitted | you |
//! | `timer` | [`PassTimer`](common::gpu::PassTimer) | | | time of each pass \[ms\] | you; `PassTimer::off()` measures nothing |
//!
//! One [`Renderer::prepare`] per submit: what it writes lands at the next one. It draws point, spot and directional
//! lights, any number, spots with soft edges and light maps; homogeneous media, coloured; every phase function of
//! `common`. Nothing of that is refused; a reach or an option out of its range is. No device feature is needed;
//! [`Accumulation::F32`] and targets of `Rgba32Float` use `FLOAT32_BLENDABLE`.
//!
#![doc = include_str!("../domain.md")]
//!
//! # Cost
//!
//! Times as multiples of a ray march of 64 steps through the same 1024² maps in the same run, and error of the
//! airlight (relative RMSE), everything moving: llvmpipe, a **software** adapter, 2 cores, 640×512, 2026-11-29. They
//! say little about a GPU.
//!
//! | | cathedral | amphora |
//! |---|---|---|
//! | [`Options::default`] | 6.13 × at 1.83 % | 10.3 × at 0.761 % |
//! | [`Options::paper`] | 10.4 × at 18.3 % | 9.26 × at 11.4 % |
//! | the march itself | 1 at 7.38 % | 1 at 48.8 % |
//!
//! In proportion to planes (R² 0.9997) and pixels; a finer lattice costs vertices. The CPU's part is 2 ms or less.
//!
//! # Passes
//!
//! Clear; for each light all its planes; at last, add the sum to the target.
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
pub use placement::reach;
pub use renderer::{Inputs, Renderer};

// Hidden: a step of `Renderer::prepare`, for benches.
#[doc(hidden)]
pub use placement::slabs;

/// The WGSL of this crate, composed. Hidden: it is for the tests, which validate it without a GPU, and changes with the
/// passes.
#[doc(hidden)]
pub mod shaders {
    use common::shader::{AIRLIGHT, HAZE, KIND, LIGHT, MEDIUM, PHASE, SHADOW, VIEW, compose};

    const PLANES: &str = include_str!("../shaders/planes.wgsl");

    /// Drawing of planes.
    pub fn planes() -> String {
        compose(&[VIEW, PHASE, MEDIUM, LIGHT, KIND, HAZE, AIRLIGHT, SHADOW, PLANES])
    }
}
