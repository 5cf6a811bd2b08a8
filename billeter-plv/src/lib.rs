//! Shadowed single scattering by **polygonal light volumes**, after M. Billeter, E. Sintorn and
//! U. Assarson, "Real time volumetric shadows using polygonal light volumes" (High Performance
//! Graphics 2010) and its supplement of 2012, with the printed slips put right.
//!
//! The shadow map of a light, turned into a mesh and closed by the light's frustum, bounds the lit
//! part of space. Along a view ray, airlight is the sum over the mesh's faces of the unshadowed
//! airlight from the eye to the face, added where the ray leaves the light and taken away where it
//! enters. So the mesh is drawn without depth test, in any order, with additive blending, and the
//! result is exact to the resolution of the shadow map.
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
//! # What it can draw
//!
//! Point, spot and directional lights, any number; homogeneous media, coloured; every phase function of
//! `common`. Refused: light maps; spots with a soft edge when a mesh by table is asked for.
//!
//! # Approximations
//!
//! 1. Single scattering.
//! 2. The lit volume is that of the shadow map: its edges are off by a fraction of a texel, and what is
//!    thinner than a texel may be missed.
//! 3. An empty texel stands for a distance of 1000 scene radii (mesh only).
//!
//! # The contract
//!
//! | | |
//! |---|---|
//! | depth | depth-only view of any depth format, `TEXTURE_BINDING`, one sample, the view's size; standard or reversed, with or without a far plane, as [`common::View::depth`] says |
//! | lights | [`common::gpu::LightBinding`], shadow maps drawn earlier in the same or a previous encoder |
//! | target | view of [`Options::target_format`], `RENDER_ATTACHMENT`, the view's size; airlight is added, linear radiance \[W m⁻² sr⁻¹\] |
//!
//! One [`Renderer::prepare`] per submit: what it writes lands at the next one.
#![doc = ""]
#![doc = include_str!("../domain.md")]

mod error;
mod levels;
mod mesh;
mod options;
mod pipelines;
mod rays;
mod renderer;
pub mod table;
mod tessellation;

pub use common::gpu::Accumulation;
pub use error::Error;
pub use options::{Evaluation, Options, Tessellation, Volume};
pub use renderer::{Inputs, Renderer};

/// The WGSL of this crate, composed: for validation without a GPU.
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
