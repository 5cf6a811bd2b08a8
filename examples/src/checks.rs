//! What has to hold of the sequence's pictures.

use std::fmt;

use anyhow::Result;

use crate::depth::Depth;
use crate::engine::Settings;
use crate::gpu::Gpu;
use crate::picture::Picture;
use crate::sequence::{Pictures, draw};

/// Figures of a sequence, and of the same one drawn with the other depth and the other width of radiance.
#[derive(Clone, Debug)]
pub struct Checks {
    /// Mean radiance of each part \[W m⁻² sr⁻¹\].
    pub means: Vec<(&'static str, f32)>,
    /// Whether every pixel is finite and none negative.
    pub sane: bool,
    /// Largest difference after a resize back, over the mean radiance.
    pub resized_back: f32,
    /// Largest difference between techniques switched off and none at all.
    pub off: f32,
    /// Largest difference after switching both off and on again.
    pub again: f32,
    /// Light in fog with shadows over that without.
    pub shadowed: f32,
    /// What the two techniques add by themselves, against what they add together: largest difference over the mean.
    pub sum: f32,
    /// Root mean square and largest difference between standard and reversed depth, over the mean radiance.
    pub depth: [f32; 2],
    /// Largest difference between 16 and 32 bits as a share of a number; none where the device can't blend 32.
    pub bits: Option<f32>,
}

impl Checks {
    /// Takes the figures of `pictures`, drawn with these settings, size and number of frames; draws the other two.
    pub fn new(
        gpu: &Gpu,
        settings: Settings,
        size: [u32; 2],
        frames: u32,
        pictures: &Pictures,
    ) -> Result<Self> {
        let Pictures { bare, lamp, small, resized_back, both, sun, off, again, bare_open, open } = pictures;
        let parts = [
            ("no technique", bare),
            ("lamp", lamp),
            ("lamp, smaller", small),
            ("lamp, resized back", resized_back),
            ("lamp and sun", both),
            ("sun", sun),
            ("switched off", off),
            ("on again", again),
            ("no shadows, no technique", bare_open),
            ("no shadows", open),
        ];
        let depth = match settings.depth {
            Depth::Standard => Depth::Reversed,
            Depth::Reversed => Depth::Standard,
        };
        let (_, other_depth) = draw(gpu, Settings { depth, ..settings }, size, frames)?;
        let (narrow, wide) = (wgpu::TextureFormat::Rgba16Float, wgpu::TextureFormat::Rgba32Float);
        let blends = gpu.device.features().contains(wgpu::Features::FLOAT32_BLENDABLE);
        let radiance = if settings.radiance == wide { narrow } else { wide };
        let bits = if blends {
            let (_, other) = draw(gpu, Settings { radiance, ..settings }, size, frames)?;
            Some(both.relative_difference(&other.both))
        } else {
            None
        };
        Ok(Self {
            means: parts.iter().map(|(name, picture)| (*name, picture.mean())).collect(),
            sane: parts.iter().all(|(_, picture)| picture.is_sane()),
            resized_back: lamp.difference(resized_back)[1],
            off: bare.difference(off)[1],
            again: both.difference(again)[1],
            shadowed: (both.mean() - bare.mean()) / (open.mean() - bare_open.mean()),
            sum: sum(lamp, sun, bare).difference(both)[1],
            depth: both.difference(&other_depth.both),
            bits,
        })
    }
}

/// How far apart pictures of the two kinds of depth may be, root mean square and at one pixel, over the mean radiance: a
/// pixel on an edge may fall to either side.
pub const DEPTH: [f32; 2] = [0.002, 0.5];
/// How far apart 16 and 32 bits may be, as a share of a number: surfaces and two additions are rounded, or cut off, to 11
/// bits each.
pub const BITS: f32 = 3.0 / 1024.0;

impl Checks {
    /// What does not hold.
    pub fn problems(&self) -> Vec<&'static str> {
        let Self { sane, resized_back, off, again, shadowed, sum, depth, bits, .. } = self;
        let checks = [
            (*sane, "a pixel is negative or not finite"),
            (*resized_back == 0.0, "the picture is another one after a resize back"),
            (*off == 0.0, "techniques that are switched off add something"),
            (*again == 0.0, "the picture is another one after a technique was off and on again"),
            (*shadowed > 0.02 && *shadowed < 0.8, "light in fog has no shadows, or there is none"),
            (*sum < 0.02, "two techniques do not add what each adds by itself"),
            (depth[0] < DEPTH[0] && depth[1] < DEPTH[1], "standard and reversed depth differ"),
            (bits.is_none_or(|bits| bits < BITS), "16 and 32 bits differ by more than rounding"),
        ];
        checks.iter().filter(|(holds, _)| !holds).map(|(_, problem)| *problem).collect()
    }
}

impl fmt::Display for Checks {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { resized_back, off, again, shadowed, sum, depth, bits, .. } = self;
        writeln!(out, "mean radiance [W/m²/sr]")?;
        for (name, mean) in &self.means {
            writeln!(out, "  {name:25} {mean:.6}")?;
        }
        writeln!(out, "largest difference, over the mean radiance")?;
        writeln!(out, "  before and after a resize back        {resized_back:.2e}")?;
        writeln!(out, "  switched off and never made           {off:.2e}")?;
        writeln!(out, "  before and after off and on again     {again:.2e}")?;
        writeln!(out, "  together and each by itself           {sum:.2e}")?;
        writeln!(out, "  standard and reversed depth           {:.2e} ({:.2e} rms)", depth[1], depth[0])?;
        match bits {
            Some(bits) => writeln!(out, "16 and 32 bits, share of a number       {bits:.2e}")?,
            None => writeln!(out, "16 and 32 bits: this adapter can't blend into 32")?,
        }
        write!(out, "light in fog with shadows over without  {shadowed:.3}")
    }
}

/// What two techniques would make together of what each makes by itself.
fn sum(one: &Picture, other: &Picture, bare: &Picture) -> Picture {
    let numbers = one.pixels.iter().zip(&other.pixels).zip(&bare.pixels);
    Picture { size: one.size, pixels: numbers.map(|((one, other), bare)| *one + *other - *bare).collect() }
}
