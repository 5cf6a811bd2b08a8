//! The shared ground of the workspace: scenes, lights, media, phase functions, tables, image
//! errors, a CPU reference for light in fog, and the wgpu side of the same things. No technique is
//! named here.
//!
//! # What is in it
//!
//! | | feature | what |
//! |---|---|---|
//! | [`Scene`], [`mod@scene`] | | plain data: meshes, materials, lights, medium, camera, motion; built-in scenes |
//! | [`Light`], [`Medium`], [`Cloud`], [`Sky`], [`Phase`], [`View`], [`Terms`] | | what a frame is drawn from |
//! | [`airlight`], [`indirect`] | | single scattering in f64: closed forms and adaptive quadrature |
//! | [`table`], [`quadrature`], [`panels`], [`random`] | | tabulated functions, integrals, numbers by chance |
//! | [`mod@image`], [`metrics`] | | pictures of linear radiance, and how far two are apart |
//! | [`Warning`] | | what a technique draws, but not well |
//! | [`reference`](mod@reference), [`need`] | `reference` | the CPU reference, and what a scene needs by it |
//! | [`scene::load`], [`files`] | `files` | OBJ, glTF and JSON scenes; PNG and `OpenEXR` pictures; the reference's cache |
//! | [`gpu`], [`mod@shader`] | `gpu` | device, depth, shadow maps, surfaces, pass timer, read-back, WGSL and a bench for it |
//!
//! All features are on by default. Without `gpu` there is no wgpu in the tree, and the reference stands
//! alone; the techniques take `gpu` and nothing else.
//!
//! # The smallest program
//!
//! A picture that techniques are judged by, drawn on the CPU: light of one scattering and of surfaces,
//! with exact shadows. `examples/reference.rs` writes it to a file.
//!
//! ```
//! # #[cfg(feature = "reference")]
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use std::sync::atomic::AtomicBool;
//!
//! use common::reference::Reference;
//! use common::scene::builtin;
//! use common::Terms;
//!
//! let scene = builtin::knife_edge();
//! let view = scene.camera.view(32, 24);
//! let never = AtomicBool::new(false);
//! let rendered = Reference::new(&scene)?.render(&view, Terms::DIRECT, &|_done| {}, &never)?;
//! assert!(rendered.uncertainty < 1e-3);
//! let brightest = rendered.total().pixels.iter().map(|pixel| pixel.max_element()).fold(0.0, f32::max);
//! println!("{brightest} W/m²/sr, right to {:.1e}", rendered.uncertainty);
//! # Ok(())
//! # }
//! # #[cfg(not(feature = "reference"))]
//! # fn main() {}
//! ```
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
#[cfg(feature = "files")]
pub mod files;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod image;
pub mod indirect;
pub mod light;
pub mod medium;
pub mod metrics;
#[cfg(feature = "reference")]
pub mod need;
pub mod panels;
pub mod phase;
pub mod quadrature;
pub mod random;
#[cfg(feature = "reference")]
pub mod reference;
pub mod scene;
#[cfg(feature = "gpu")]
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
