//! **Analytic single scattering with sorted shadow planes.** Along a view ray, airlight has a closed form but for one
//! integral, which is tabulated once. Where a caster stands between light and ray, the ray is in shadow between two
//! *shadow planes*: quads from the caster's silhouette edges away from the light, endless. Drawn in the order in
//! which a ray meets them, with the number of shadows kept in the stencil, those that part light from shadow add and
//! take away the airlight up to them. The shadows are exact, to the pixel, for any triangles: no shadow map, no
//! steps, no noise. What the medium scatters lights surfaces, too (*indirect single scattering*), by tables again.
//!
//! After V. Biri, "Real time single scattering effects" (CGAMES 2006), with the printed slips put right.
//!
#![doc = include_str!("../picture.md")]
//!
//! # The smallest program
//!
//! Device, depth, casters and target are yours; `examples/minimal.rs` is a whole program, with light on surfaces.
//!
//! ```no_run
//! use biri_ss::{Error, Inputs, Options, Outputs, Renderer};
//! use common::gpu::PassTimer;
//! use common::scene::Object;
//! use common::{Light, Medium, View};
//! use glam::Vec3;
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
//! /// In every frame, into an encoder that has drawn depth; the caller submits it.
//! fn draw(
//!     fog: &mut Renderer,
//!     (device, queue): (&wgpu::Device, &wgpu::Queue),
//!     encoder: &mut wgpu::CommandEncoder,
//!     (view, medium, lights, casters): (&View, &Medium, &[Light], &[Object]),
//!     depth: &wgpu::TextureView,
//!     airlight: &wgpu::TextureView,
//! ) -> Result<(), Error> {
//!     let ambient = Vec3::ZERO;
//!     let inputs = Inputs { view, medium, lights, casters, depth, surfaces: None, ambient };
//!     fog.prepare(device, queue, &inputs)?;
//!     let outputs = Outputs { airlight, surfaces: None, indirect: None };
//!     fog.encode(encoder, &outputs, &mut PassTimer::off());
//!     Ok(())
//! }
//! ```
//!
//! # The contract
//!
//! | what | format | usage | size | unit, meaning | who makes it |
//! |---|---|---|---|---|---|
//! | [`view`](Inputs::view) | [`View`](common::View) | | that of all textures \[pixels\] | eye \[m\], near plane \[m\], what depth means | you, for every frame: by [`View::from_matrices`](common::View::from_matrices) of your own |
//! | [`medium`](Inputs::medium) | [`Medium`](common::Medium) | | all of space | `sigma_s`, `sigma_a` \[1/m\], RGB; phase function \[1/sr\] | you |
//! | [`lights`](Inputs::lights) | [`Light`](common::Light), any number | | | \[W/sr\], directional \[W/m²\] | you |
//! | [`casters`](Inputs::casters) | [`Object`](common::scene::Object) | | all that casts, seen or not | meshes \[m\]; the same mesh `Arc` in every frame | you |
//! | [`depth`](Inputs::depth) | any depth format, a depth-only view, one sample | `TEXTURE_BINDING` | the view's | standard or reversed, with or without a far plane, as [`View::depth`](common::View::depth) says | your depth pass, or [`Ground`](common::gpu::Ground)'s |
//! | [`normal`](Surfaces::normal), optional | any float format, four channels | `TEXTURE_BINDING` | the view's | xyz: shading normal in the world, 0 without a surface; w: Phong exponent | your G-buffer, or [`SurfaceData`](common::gpu::SurfaceData) |
//! | [`diffuse`](Surfaces::diffuse), [`specular`](Surfaces::specular) | any float format, RGB | `TEXTURE_BINDING` | the view's | reflectances in \[0, 1\] | the same |
//! | [`ambient`](Inputs::ambient) | RGB | | | radiance \[W m⁻² sr⁻¹\]; 0 without | you |
//! | [`Outputs`]: up to three targets, which may be one | [`target_format`](Options::target_format) | `RENDER_ATTACHMENT` | the view's | linear radiance \[W m⁻² sr⁻¹\], RGB: each term is **added**, alpha stays | you |
//! | `encoder` | `CommandEncoder` | | | passes go in, nothing is submitted | you |
//! | `timer` | [`PassTimer`](common::gpu::PassTimer) | | | time of each pass \[ms\] | you; `PassTimer::off()` measures nothing |
//!
//! One [`Renderer::prepare`] per submit: what it writes lands at the next one. It draws point, spot and directional
//! lights, any number; homogeneous media, coloured; every phase function of `common`; casters of any kind of mesh,
//! moving or not, the eye anywhere. Refused with an [`Error`] that names it: light maps; spots where indirect light
//! is asked for, and soft-edged ones for [`Airlight::Gamma`]. No device feature is needed; [`Accumulation::F32`] and
//! targets of `Rgba32Float` use `FLOAT32_BLENDABLE`.
//!
#![doc = include_str!("../domain.md")]
//!
//! # Cost
//!
//! Times as multiples of a ray march of 64 steps through 1024² shadow maps in the same run, and error of the airlight
//! (relative RMSE), everything moving: llvmpipe, a **software** adapter, 2 cores, 640×512, 2026-11-29. They say little
//! about a GPU.
//!
//! | | cathedral | amphora |
//! |---|---|---|
//! | [`Options::default`] | 4.54 × at 0.016 % | 0.75 × at 0.004 % |
//! | [`Options::paper`] | 5.96 × at 29.9 % | 1.08 × at 0.544 % |
//! | the march itself | 1 at 7.38 % | 1 at 48.8 % |
//!
//! In proportion to the pixels that planes cover, and to silhouette edges: a scene of many small or fine casters is
//! dear, and no shadow map is to be drawn. The CPU sorts only when lights or casters have moved, and walks the tree in
//! every frame (cathedral, 75 000 triangles, all moving: 16 ms a frame on two cores).
//!
//! # Passes
//!
//! On the CPU, for each light: silhouettes, a binary space partition of the planes (both only where something
//! moved), the order for this eye, and in how many shadows the eye is. On the GPU, for each light: what the planes of
//! a ray have in common; all planes in one call and the airlight up to lit surfaces; direct light on them; indirect
//! light. At last, add the sum to the target.
//!
//! # Approximations
//!
//! 1. Single scattering; an ambient radiance stands for the rest if one is given.
//! 2. Indirect light is that of a medium without end or shadow: too bright where walls are near or in the way.
//! 3. A Phong lobe gathers indirect light with the cosine law taken at its axis, also below the horizon.
//! 4. A place in 256 shadows of one light, or a multiple of that, is drawn as lit: the stencil has 8 bits. Where so
//!    many lie over each other is warned about.

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
// Hidden: the integrals and their tables, for tests, benches and measurements of what they cost.
#[doc(hidden)]
pub mod table;
#[cfg(test)]
mod tests;

pub use common::gpu::Accumulation;
pub use connectivity::{Connectivity, Report};
pub use error::Error;
pub use options::{Airlight, Counting, Indirect, Options, Order};
pub use renderer::{Inputs, Outputs, Renderer, Statistics, Surfaces};

// Hidden: steps of `Renderer::prepare`, for benches and measurements of what they cost.
#[doc(hidden)]
pub use bsp::{Bsp, Piece};
#[doc(hidden)]
pub use silhouette::{Origin, Silhouette, SilhouetteEdge};

/// The WGSL of this crate, composed. Hidden: it is for the tests, which validate it without a GPU, and changes with the
/// passes.
#[doc(hidden)]
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
