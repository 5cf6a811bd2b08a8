//! Shadowed single scattering by **polygonal light volumes**. The shadow map of a light, turned into a mesh and
//! closed by the light's frustum, bounds the lit part of space. Along a view ray, airlight is the sum over the
//! mesh's faces of the unshadowed airlight from the eye to the face, added where the ray leaves the light and
//! taken away where it enters. So the mesh is drawn without depth test, in any order, with additive blending, and
//! the result is exact to the resolution of the shadow map: no steps, no noise, no history.
//!
//! After M. Billeter, E. Sintorn and U. Assarson, "Real time volumetric shadows using polygonal light volumes"
//! (High Performance Graphics 2010), and its supplement of 2012, with the printed slips put right.
//!
#![doc = include_str!("../picture.md")]
//!
//! # The smallest program
//!
//! Device, depth, shadow maps and target are yours; `examples/minimal.rs` is a whole program.
//!
//! ```no_run
//! use billeter_plv::{Error, Inputs, Options, Renderer};
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
//! /// the caller submits it.
//! fn draw(
//!     volumes: &mut Renderer,
//!     (device, queue): (&wgpu::Device, &wgpu::Queue),
//!     encoder: &mut wgpu::CommandEncoder,
//!     (view, medium, lights): (&View, &Medium, &[LightBinding]),
//!     depth: &wgpu::TextureView,
//!     target: &wgpu::TextureView,
//! ) -> Result<(), Error> {
//!     volumes.prepare(device, queue, &Inputs { view, medium, lights, depth })?;
//!     volumes.encode(encoder, target, &mut PassTimer::off());
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
//! | [`depth`](Inputs::depth) | any depth format, a depth-only view, one sample | `TEXTURE_BINDING` | the view's | standard or reversed, with or without a far plane, as [`View::depth`](common::View::depth) says | your depth pass, or `Ground`'s |
//! | `target` | [`target_format`](Options::target_format) | `RENDER_ATTACHMENT` | the view's | linear radiance \[W m⁻² sr⁻¹\], RGB: airlight is **added**, alpha stays | you; surfaces in it are attenuated by you |
//! | `encoder` | `CommandEncoder` | | | passes go in, nothing is submitted | you |
//! | `timer` | [`PassTimer`](common::gpu::PassTimer) | | | time of each pass \[ms\] | you; `PassTimer::off()` measures nothing |
//!
//! One [`Renderer::prepare`] per submit: what it writes lands at the next one. It draws point, spot and directional
//! lights, any number; homogeneous media, coloured; every phase function of `common`; the eye anywhere. Refused
//! with an [`Error`] that names it: light maps; spots with a soft edge when a mesh by table is asked for. No device
//! feature is needed; [`Accumulation::F32`] and targets of `Rgba32Float` use `FLOAT32_BLENDABLE`.
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
//! | [`Options::default`] | 18.7 × at 0.995 % | 18.4 × at 0.309 % |
//! | [`Options::paper`] | 15.1 × at 2.51 % | 15.6 × at 0.738 % |
//! | [`Options::rays`] | 1.55 × at 0.944 % | 1.68 × at 0.249 % |
//! | the march itself | 1 at 7.38 % | 1 at 48.8 % |
//!
//! The mesh costs what its faces' pixels cost, and grows with the map's resolution (here as its side to the power of
//! 0.85); the scene's triangles do not matter (sixteen times as many: −7 ± 7 %). The CPU's part is below half a
//! millisecond.
//!
//! # Passes
//!
//! For each light and each projection of its shadow map: (adaptive only) measure how flat the map is,
//! emit triangles; draw the mesh and the walls that close it; at last, add the sum to the target.
//!
//! # Exact lit intervals per ray
//!
//! [`Options::rays`] computes the same lit volume without a mesh, the strongest published alternative: a min-max
//! quadtree of the shadow map (Tevs, Ihrke and Seidel 2008; in epipolar 1-D form Chen, Baran, Durand and Jarosz
//! 2011), walked along each view ray; lit segments summed analytically (Wyman and Ramsey 2008) or, here, by
//! quadrature in the angle at the light (Kulla and Fajardo 2012). In a projection of the map a ray is a straight
//! line in texels *and* in reversed depth, so a texel's crossing has a closed form. A ray walks to the end of its
//! next lit interval, then all rays of a SIMD group integrate together: the shape of the loop is what makes it
//! fast. Passes for each light: build the levels, walk and integrate. Airlight is added straight to the target:
//! nothing is ever taken away, so nothing cancels.
//!
//! Differs from the mesh: texels are steps, not slopes (no upright walls, no tessellation, no accumulation
//! texture); an empty texel lets light through to infinity; a ray ends at an optical depth of 20.
//!
//! # Approximations
//!
//! 1. Single scattering.
//! 2. The lit volume is that of the shadow map: its edges are off by a fraction of a texel, and what is
//!    thinner than a texel may be missed.
//! 3. An empty texel stands for a distance of 1000 scene radii (mesh only).

mod error;
mod levels;
mod mesh;
mod options;
mod pipelines;
mod rays;
mod renderer;
// Hidden: the twin of what shaders look up, for tests and benches.
#[doc(hidden)]
pub mod table;
mod tessellation;

pub use common::gpu::Accumulation;
pub use error::Error;
pub use options::{Evaluation, Options, Tessellation, Volume};
pub use renderer::{Inputs, Renderer};

/// The WGSL of this crate, composed. Hidden: it is for the tests, which validate it without a GPU, and changes with the
/// passes.
#[doc(hidden)]
pub mod shaders {
    use common::shader::{self, FULLSCREEN, HAZE, KIND, LIGHT, MEDIUM, PHASE, SHADOW, TABLE, VIEW, compose};

    /// Airlight by table alone; needs the chunks phase, medium, light, kind, haze, common's airlight and table before it.
    pub const AIRLIGHT: &str = include_str!("../shaders/airlight.wgsl");
    const GRID: &str = include_str!("../shaders/grid.wgsl");
    const VOLUME: &str = include_str!("../shaders/volume.wgsl");
    const TESSELLATE: &str = include_str!("../shaders/tessellate.wgsl");

    /// Drawing of faces.
    pub fn volume() -> String {
        compose(&[
            VIEW,
            PHASE,
            MEDIUM,
            LIGHT,
            KIND,
            HAZE,
            shader::AIRLIGHT,
            SHADOW,
            TABLE,
            AIRLIGHT,
            GRID,
            VOLUME,
        ])
    }

    /// Adaptive tessellation.
    pub fn tessellate() -> String {
        compose(&[VIEW, LIGHT, SHADOW, GRID, TESSELLATE])
    }

    const LEVELS: &str = include_str!("../shaders/levels.wgsl");
    const FINEST_LEVEL: &str = include_str!("../shaders/finest_level.wgsl");
    const COARSER_LEVEL: &str = include_str!("../shaders/coarser_level.wgsl");
    const SEGMENT: &str = include_str!("../shaders/segment.wgsl");
    const RUN: &str = include_str!("../shaders/run.wgsl");
    const RAYS: &str = include_str!("../shaders/rays.wgsl");

    /// The two finest min-max levels of a shadow map.
    pub fn finest_level() -> String {
        compose(&[LIGHT, LEVELS, FINEST_LEVEL])
    }

    /// The coarser min-max levels.
    pub fn coarser_level() -> String {
        compose(&[LEVELS, COARSER_LEVEL])
    }

    /// Lit runs of rays.
    pub fn rays() -> String {
        compose(&[
            FULLSCREEN,
            VIEW,
            PHASE,
            MEDIUM,
            LIGHT,
            KIND,
            HAZE,
            shader::AIRLIGHT,
            SHADOW,
            SEGMENT,
            RUN,
            RAYS,
        ])
    }
}
