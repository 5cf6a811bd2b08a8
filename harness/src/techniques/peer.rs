//! Adapter of the peers: what a user would otherwise pick, and the floor.

use std::ops::RangeInclusive;

use common::gpu::{PassTimer, Unshadowed, UnshadowedInputs};
use serde_json::{Map, Value};

use super::settings::placed;
use super::{Frame, Kind, Method, Technique};
use crate::peers::froxels::{Fineness, Froxels};
use crate::peers::raymarch::{Marching, RayMarch};

/// A peer's setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Setting {
    March(Marching),
    Froxels(Fineness),
    Unshadowed,
}

/// A peer, driven by the harness.
pub(super) enum Peer {
    March(Box<RayMarch>),
    /// With the target's format, to be made anew for views of another size.
    Froxels(Box<Froxels>, wgpu::TextureFormat),
    Unshadowed(Box<Unshadowed>),
}

impl Peer {
    pub(super) fn new(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
        setting: Setting,
        size: (u32, u32),
    ) -> Result<Self, String> {
        Ok(match setting {
            Setting::March(marching) => Self::March(Box::new(RayMarch::new(device, format, marching))),
            Setting::Froxels(fineness) => {
                Self::Froxels(Box::new(Froxels::new(device, format, fineness, size)?), format)
            }
            Setting::Unshadowed => Self::Unshadowed(Box::new(Unshadowed::new(device, format))),
        })
    }
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
        kind: Kind::Peer(setting),
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

/// Settings by name.
pub(super) fn settings(setting: Setting) -> Map<String, Value> {
    match setting {
        Setting::March(Marching { steps, equiangular, offset }) => {
            let spacing = if equiangular { "equi-angular" } else { "uniform" };
            Map::from_iter([
                ("steps".into(), steps.into()),
                ("spacing".into(), spacing.into()),
                ("offset".into(), offset.into()),
            ])
        }
        Setting::Froxels(Fineness { tile, slices, samples }) => Map::from_iter([
            ("tile".into(), tile.into()),
            ("slices".into(), slices.into()),
            ("samples".into(), samples.into()),
        ]),
        Setting::Unshadowed => Map::new(),
    }
}

/// Options of a march: how it spaces its steps is in its name.
#[derive(serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Steps {
    steps: u32,
}

/// What a file of settings says of a peer.
pub(super) fn options(setting: &Setting) -> Value {
    let value = match setting {
        Setting::March(marching) => serde_json::to_value(Steps { steps: marching.steps }),
        Setting::Froxels(fineness) => serde_json::to_value(fineness),
        Setting::Unshadowed => Ok(Value::Object(Map::new())),
    };
    value.unwrap_or_default()
}

/// The peer with the options that `value` are read as.
pub(super) fn with_options(usual: Setting, value: &Value) -> Result<Setting, String> {
    let bounded = |name: &str, number: u32, range: RangeInclusive<u32>| {
        let (least, most) = (*range.start(), *range.end());
        let wrong = format!("options.{name}: {number}; expected {least} to {most}");
        if range.contains(&number) { Ok(()) } else { Err(wrong) }
    };
    Ok(match usual {
        Setting::March(marching) => {
            let Steps { steps } = placed(value.clone(), "options")?;
            bounded("steps", steps, STEPS)?;
            Setting::March(Marching { steps, ..marching })
        }
        Setting::Froxels(_) => {
            let fineness: Fineness = placed(value.clone(), "options")?;
            bounded("tile", fineness.tile, TILES)?;
            bounded("slices", fineness.slices, SLICES)?;
            bounded("samples", fineness.samples, PLACES)?;
            Setting::Froxels(fineness)
        }
        Setting::Unshadowed => {
            let _: Map<String, Value> = placed(value.clone(), "options")?;
            Setting::Unshadowed
        }
    })
}
