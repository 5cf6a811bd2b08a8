//! Frames one after the other, with techniques that come and go and a picture that changes its size.

use anyhow::Result;

use crate::engine::{Engine, Settings, Show};
use crate::fog::Shafts;
use crate::gpu::Gpu;
use crate::picture::Picture;

/// The last picture of each part of the sequence, all at the same time of the scene.
pub struct Pictures {
    /// No technique has been made yet.
    pub bare: Picture,
    /// The lamp's shafts alone.
    pub lamp: Picture,
    /// The same in a smaller picture.
    pub small: Picture,
    /// The same in its first size again.
    pub resized_back: Picture,
    /// The shafts of lamp and sun, each by its technique, in one frame.
    pub both: Picture,
    /// The lamp's switched off.
    pub sun: Picture,
    /// Both switched off.
    pub off: Picture,
    /// Both on again.
    pub again: Picture,
    /// Neither, and nothing casts shadows.
    pub bare_open: Picture,
    /// Both, and nothing casts shadows.
    pub open: Picture,
}

/// Neither, one, the other, both.
const NONE: Shafts = Shafts { lamp: false, sun: false };
const LAMP: Shafts = Shafts { lamp: true, sun: false };
const SUN: Shafts = Shafts { lamp: false, sun: true };
/// The shafts of both lights.
pub const BOTH: Shafts = Shafts { lamp: true, sun: true };

/// Time of a frame \[s\].
const STEP: f32 = 1.0 / 30.0;

/// Draws the whole sequence, each part of `frames` frames; the engine has drawn `again` last.
pub fn draw(gpu: &Gpu, settings: Settings, size: [u32; 2], frames: u32) -> Result<(Engine, Pictures)> {
    let mut engine = Engine::new(&gpu.device, &gpu.queue, settings, size)?;
    let part = |engine: &mut Engine, shafts, casters| {
        for frame in 1..=frames.max(1) {
            // All parts end at the same time.
            let time = 1.0 - STEP * (frames.max(1) - frame) as f32;
            engine.draw(time, Show { shafts, casters })?;
        }
        Picture::of(gpu, engine)
    };
    let bare = part(&mut engine, NONE, true)?;
    let lamp = part(&mut engine, LAMP, true)?;
    engine.resize(size.map(|side| (3 * side / 4).max(1)));
    let small = part(&mut engine, LAMP, true)?;
    engine.resize(size);
    let resized_back = part(&mut engine, LAMP, true)?;
    let both = part(&mut engine, BOTH, true)?;
    let sun = part(&mut engine, SUN, true)?;
    let off = part(&mut engine, NONE, true)?;
    let bare_open = part(&mut engine, NONE, false)?;
    let open = part(&mut engine, BOTH, false)?;
    let again = part(&mut engine, BOTH, true)?;
    Ok((engine, Pictures { bare, lamp, small, resized_back, both, sun, off, again, bare_open, open }))
}
