//! The shared ground of the workspace: scenes, lights, media, phase functions, tables, image
//! errors, a CPU reference for light in fog, and (feature `gpu`, on by default) the wgpu side of
//! the same things. No technique is named here.
//!
//! # Conventions
//!
//! | thing | convention |
//! |---|---|
//! | length | metre; coefficients are in 1/m |
//! | world | right-handed, y up |
//! | matrices | `dst_from_src`; reversed depth with an infinite far plane, unless [`View::depth`] says otherwise |
//! | point and spot light | radiant intensity \[W/sr\], RGB |
//! | directional light | irradiance on a facing plane \[W/m²\], RGB, not attenuated on its way into the scene |
//! | phase function | `p(cos θ)` \[1/sr\], integrates to 1 over the sphere; +1 is forward |
//! | radiance | linear, unclamped \[W m⁻² sr⁻¹\] |
//!
//! # The output contract of a technique
//!
//! A technique **adds** linear in-scattered radiance, RGB, to a target of the size of the view.
//! Surfaces are lit and attenuated by the surface pass; the sum of the two is the picture.

pub mod airlight;
pub mod cloud;
pub mod files;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod image;
pub mod indirect;
pub mod light;
pub mod medium;
pub mod metrics;
pub mod need;
pub mod panels;
pub mod phase;
pub mod quadrature;
pub mod random;
pub mod reference;
pub mod scene;
pub mod shader;
pub mod sky;
pub mod table;
pub mod terms;
pub mod view;
pub mod warning;

pub use cloud::{Cloud, Density};
pub use light::{DirectionalLight, Light, LightMap, PointLight, SpotLight};
pub use medium::Medium;
pub use phase::{Lobe, Phase};
pub use scene::Scene;
pub use sky::Sky;
pub use terms::{Term, Terms};
pub use view::{Camera, DepthRange, View, ViewError};
pub use warning::Warning;
