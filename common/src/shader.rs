//! Shared WGSL, as text: chunks of pure functions that are joined with a pass's own entry points.

/// The eye: rays and distances.
pub const VIEW: &str = include_str!("../shaders/view.wgsl");
/// Phase functions.
pub const PHASE: &str = include_str!("../shaders/phase.wgsl");
/// The medium.
pub const MEDIUM: &str = include_str!("../shaders/medium.wgsl");
/// Lights.
pub const LIGHT: &str = include_str!("../shaders/light.wgsl");
/// The kind of light that a pipeline is made for; needs [`LIGHT`].
pub const KIND: &str = include_str!("../shaders/kind.wgsl");
/// Light that arrives at a surface, and what it reflects; needs [`LIGHT`], its global, and [`KIND`].
pub const ARRIVAL: &str = include_str!("../shaders/arrival.wgsl");
/// Shadow maps; needs [`LIGHT`].
pub const SHADOW: &str = include_str!("../shaders/shadow.wgsl");
/// Unshadowed airlight by quadrature; needs [`PHASE`], [`MEDIUM`], [`LIGHT`], their globals, [`KIND`] and [`HAZE`].
pub const AIRLIGHT: &str = include_str!("../shaders/airlight.wgsl");
/// Where on a view ray light can be, and which way it came; needs [`LIGHT`].
pub const RAY: &str = include_str!("../shaders/ray.wgsl");
/// The medium, its kind fixed when a pipeline is made; needs [`PHASE`], [`MEDIUM`] and the global of the medium.
pub const HAZE: &str = include_str!("../shaders/haze.wgsl");
/// Table look-up.
pub const TABLE: &str = include_str!("../shaders/table.wgsl");
/// A triangle that covers the target: vertex stage `vs_fullscreen`.
pub const FULLSCREEN: &str = include_str!("../shaders/fullscreen.wgsl");

/// Shadow maps of other programs: fragment stage `fs_foreign`; needs [`FULLSCREEN`], [`LIGHT`] and [`SHADOW`].
pub const FOREIGN: &str = include_str!("../shaders/foreign.wgsl");

/// Adds accumulated airlight to a target: fragment stage `fs_add`; needs [`FULLSCREEN`].
pub(crate) const ADD: &str = include_str!("../shaders/add.wgsl");

/// One shader text from chunks, each listed once and in the order of dependency.
pub fn compose(chunks: &[&str]) -> String {
    chunks.join("\n")
}
