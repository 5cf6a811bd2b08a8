//! Adapter of the peers: what a user would otherwise pick, and the floor.

use std::ops::RangeInclusive;
use std::sync::Arc;

use common::gpu::{PassTimer, Unshadowed, UnshadowedInputs};
use serde_json::Value;

use super::settings::{merged, written};
use super::{Frame, Method, Recipe, Technique};
use crate::peers::froxels::{Fineness, Froxels};
use crate::peers::raymarch::{Marching, RayMarch};

/// A peer's setting.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Setting {
    March(Marching),
    Froxels(Fineness),
    Unshadowed,
}

/// A peer, driven by the harness.
enum Peer {
    March(Box<RayMarch>),
    /// With the target's format, to be made anew for views of another size.
    Froxels(Box<Froxels>, wgpu::TextureFormat),
    Unshadowed(Box<Unshadowed>),
}

impl Technique for Peer {
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        let Frame { device, queue, scene, view, lights, depth } = frame;
        match self {
            Self::March(march) => march.prepare(device, queue, scene, view, lights, depth),
            Self::Froxels(froxels, format) => {
                let size = (view.width, view.height);
                if !froxels.fits(size) {
                    **froxels = Froxels::new(device, *format, froxels.fineness(), size)?;
                }
                froxels.prepare(device, queue, scene, view, lights, depth);
            }
            Self::Unshadowed(floor) => {
                let (medium, reach) = (&scene.medium, crate::peers::reach(scene, view));
                floor.prepare(device, queue, &UnshadowedInputs { view, medium, lights, depth, reach });
            }
        }
        Ok(())
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer) {
        match self {
            Self::March(march) => march.encode(encoder, target, timer),
            Self::Froxels(froxels, _) => froxels.encode(encoder, target, timer),
            Self::Unshadowed(floor) => floor.encode(encoder, target, timer),
        }
    }
}

/// Places in a froxel where the light is looked up, where none are named.
const SAMPLES: u32 = 4;
/// Tiles and slices along the curve of the froxels; the first is what engines use most.
const FROXELS: [(u32, u32); 5] = [(8, 64), (16, 64), (8, 128), (4, 128), (4, 256)];

/// The peers of a comparison that names none.
pub(super) fn of_comparison() -> Vec<Method> {
    let mut methods: Vec<Method> = [16, 64, 256].map(|steps| march(steps, false, false)).into();
    methods.extend([march(64, false, true), march(64, true, false), march(64, true, true)]);
    methods.extend([froxels(8, 64, SAMPLES), unshadowed()]);
    methods
}

/// The froxels' curve, if it is asked for.
pub(super) fn sweep(wanted: &str) -> Vec<Method> {
    let points = FROXELS.iter().filter(|_| wanted == "froxels");
    points.map(|&(tile, slices)| froxels(tile, slices, SAMPLES)).collect()
}

/// Numbers that make sense.
const STEPS: RangeInclusive<u32> = 1..=4096;
const TILES: RangeInclusive<u32> = 1..=64;
const SLICES: RangeInclusive<u32> = 1..=1024;
const PLACES: RangeInclusive<u32> = 1..=64;

/// The peer of that name.
pub(super) fn find(wanted: &str) -> Option<Method> {
    for (equiangular, offset) in [(true, true), (true, false), (false, true), (false, false)] {
        let (technique, _) = marching(equiangular, offset);
        let rest = wanted.strip_prefix(technique).and_then(|rest| rest.strip_prefix('-'));
        if let Some(steps) = rest.and_then(|digits| number(digits, STEPS)) {
            return Some(march(steps, equiangular, offset));
        }
    }
    let mut parts = wanted.strip_prefix("froxels-")?.split('x');
    let tile = number(parts.next()?, TILES)?;
    let slices = number(parts.next()?, SLICES)?;
    let samples = parts.next().map_or(Some(SAMPLES), |digits| number(digits, PLACES))?;
    parts.next().is_none().then(|| froxels(tile, slices, samples))
}

/// A number in the range, spelt as it is written.
fn number(digits: &str, range: RangeInclusive<u32>) -> Option<u32> {
    digits.parse::<u32>().ok().filter(|n| range.contains(n) && *digits == n.to_string())
}

fn method(name: String, technique: &'static str, label: String, setting: Setting) -> Method {
    Method {
        name,
        technique,
        preset: "sweep",
        label,
        bound: None,
        peer: true,
        shadow_map_size: None,
        recipe: Arc::new(setting),
    }
}

/// Name of a march, and what its steps are called.
fn marching(equiangular: bool, offset: bool) -> (&'static str, &'static str) {
    match (equiangular, offset) {
        (false, false) => ("ray-march", "steps"),
        (false, true) => ("ray-march-offset", "steps, offset per pixel"),
        (true, false) => ("ray-march-equiangular", "equi-angular steps"),
        (true, true) => ("ray-march-equiangular-offset", "equi-angular steps, offset per pixel"),
    }
}

fn march(steps: u32, equiangular: bool, offset: bool) -> Method {
    let (technique, label) = marching(equiangular, offset);
    let setting = Setting::March(Marching { steps, equiangular, offset });
    method(format!("{technique}-{steps}"), technique, format!("{steps} {label}"), setting)
}

fn froxels(tile: u32, slices: u32, samples: u32) -> Method {
    let plain = samples == SAMPLES;
    let name = if plain { String::new() } else { format!("x{samples}") };
    let usual = if plain && (tile, slices) == FROXELS[0] { " (the engines' usual)" } else { "" };
    let label = format!("{tile}² pixels × {slices} slices, {samples} samples{usual}");
    let setting = Setting::Froxels(Fineness { tile, slices, samples });
    method(format!("froxels-{tile}x{slices}{name}"), "froxels", label, setting)
}

fn unshadowed() -> Method {
    let label = "unshadowed analytic airlight (the floor)".into();
    method("unshadowed".into(), "unshadowed", label, Setting::Unshadowed)
}

/// Options of a march: how it spaces its steps is in its name.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Steps {
    steps: u32,
}

/// Options of what has none.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Nothing {}

impl Recipe for Setting {
    fn make(
        &self,
        device: &wgpu::Device,
        _queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        size: (u32, u32),
    ) -> Result<Box<dyn Technique>, String> {
        Ok(Box::new(match *self {
            Self::March(marching) => Peer::March(Box::new(RayMarch::new(device, format, marching))),
            Self::Froxels(fineness) => {
                Peer::Froxels(Box::new(Froxels::new(device, format, fineness, size)?), format)
            }
            Self::Unshadowed => Peer::Unshadowed(Box::new(Unshadowed::new(device, format))),
        }))
    }

    fn options(&self) -> Value {
        match self {
            Self::March(marching) => written(&Steps { steps: marching.steps }),
            Self::Froxels(fineness) => written(fineness),
            Self::Unshadowed => written(&Nothing {}),
        }
    }

    fn with(&self, options: &Value) -> Result<Arc<dyn Recipe>, String> {
        let bounded = |name: &str, number: u32, range: RangeInclusive<u32>| {
            let (least, most) = (*range.start(), *range.end());
            let wrong = format!("options.{name}: {number}; expected {least} to {most}");
            if range.contains(&number) { Ok(()) } else { Err(wrong) }
        };
        Ok(Arc::new(match *self {
            Self::March(marching) => {
                let Steps { steps } = merged(&Steps { steps: marching.steps }, options)?;
                bounded("steps", steps, STEPS)?;
                Self::March(Marching { steps, ..marching })
            }
            Self::Froxels(usual) => {
                let fineness: Fineness = merged(&usual, options)?;
                bounded("tile", fineness.tile, TILES)?;
                bounded("slices", fineness.slices, SLICES)?;
                bounded("samples", fineness.samples, PLACES)?;
                Self::Froxels(fineness)
            }
            Self::Unshadowed => {
                merged(&Nothing {}, options)?;
                Self::Unshadowed
            }
        }))
    }
}
