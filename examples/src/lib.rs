//! A small renderer of its own, as yours may be, that takes in two techniques for light shafts.
//!
//! It has its own meshes, pipelines and WGSL, its own depth buffer (standard or reversed), its own shadow maps, its own
//! target and its own tone mapping; of this workspace it uses what a user of a technique has to. All that is
//! about light in fog is in [`fog`]; start there. The rest stands for your program.
//!
//! `cargo run --release -p engine-example -- --help`

#![allow(clippy::missing_errors_doc, reason = "all that fails here ends the program, with one sentence")]

pub mod checks;
pub mod depth;
pub mod engine;
pub mod fog;
pub mod gpu;
pub mod passes;
pub mod picture;
pub mod scene;
pub mod sequence;
#[cfg(feature = "window")]
pub mod window;
