//! Motion: lights, objects, camera and medium as functions of time.

use super::Scene;

/// One thing that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {}

impl Track {
    /// Puts the thing into its place at `time` \[s\].
    pub fn apply(&self, _scene: &mut Scene, _time: f32) {}
}
