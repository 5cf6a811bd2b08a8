//! Shared WGSL, as text: chunks of pure functions that are joined with a pass's own entry points.

/// The eye: rays and distances.
pub const VIEW: &str = include_str!("../shaders/view.wgsl");
/// Phase functions.
pub const PHASE: &str = include_str!("../shaders/phase.wgsl");
/// The medium; needs [`PHASE`].
pub const MEDIUM: &str = include_str!("../shaders/medium.wgsl");
/// Lights.
pub const LIGHT: &str = include_str!("../shaders/light.wgsl");
/// Shadow maps; needs [`LIGHT`].
pub const SHADOW: &str = include_str!("../shaders/shadow.wgsl");
/// Table look-up.
pub const TABLE: &str = include_str!("../shaders/table.wgsl");
/// A triangle that covers the target: vertex stage `vs_fullscreen`.
pub const FULLSCREEN: &str = include_str!("../shaders/fullscreen.wgsl");

/// One shader text from chunks, each listed once and in the order of dependency.
pub fn compose(chunks: &[&str]) -> String {
    chunks.join("\n")
}
