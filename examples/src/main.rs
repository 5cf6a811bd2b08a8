//! Draws the hall: headless into a file, with checks, or into a window.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, bail};
use clap::{Parser, ValueEnum};
use engine_example::checks::Checks;
use engine_example::depth::Depth;
use engine_example::engine::Settings;
use engine_example::gpu::Gpu;
use engine_example::{picture, sequence};

/// A small renderer of its own with light shafts by two techniques: a lamp's by light volumes, the sun's by
/// sampling planes.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// How the renderer keeps depth: standard with a far plane in 24 bits, or reversed without one in 32-bit floats
    #[arg(long, value_enum, default_value_t = Depth::Standard)]
    depth: Depth,
    /// Bits of a number of its radiance target
    #[arg(long, value_enum, default_value_t = Hdr::Sixteen)]
    hdr: Hdr,
    /// Pixels, width×height
    #[arg(long, value_parser = size, default_value = "640x400", value_name = "WxH")]
    size: [u32; 2],
    /// Frames of each part of the sequence
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Where the last picture goes
    #[arg(long, default_value = "engine.png", value_name = "FILE.png")]
    out: PathBuf,
    /// Opens a window instead; 1 and 2 switch the lights' shafts, Escape closes it
    #[arg(long, conflicts_with_all = ["out", "frames"])]
    window: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum Hdr {
    #[value(name = "16")]
    Sixteen,
    #[value(name = "32")]
    ThirtyTwo,
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let sides: Option<Vec<u32>> = text.split('x').map(|side| side.parse().ok()).collect();
    match sides.as_deref() {
        Some(&[width, height]) if (1..=8192).contains(&width) && (1..=8192).contains(&height) => {
            Ok([width, height])
        }
        _ => Err("expected two numbers from 1 to 8192, as in 960x600".into()),
    }
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<()> {
    let settings = Settings {
        depth: arguments.depth,
        radiance: match arguments.hdr {
            Hdr::Sixteen => wgpu::TextureFormat::Rgba16Float,
            Hdr::ThirtyTwo => wgpu::TextureFormat::Rgba32Float,
        },
        shadow_size: 1024,
    };
    if arguments.window {
        return window(settings, arguments.size);
    }
    let gpu = Gpu::headless()?;
    let (engine, pictures) = sequence::draw(&gpu, settings, arguments.size, arguments.frames)?;
    picture::write_png(&gpu, &engine, &arguments.out)?;
    let checks = Checks::new(&gpu, settings, arguments.size, arguments.frames, &pictures)?;
    println!("{checks}\n{}, drawn by {}", arguments.out.display(), gpu.adapter.get_info().name);
    match checks.problems()[..] {
        [] => Ok(()),
        ref problems => bail!("{}", problems.join("; ")),
    }
}

#[cfg(feature = "window")]
fn window(settings: Settings, size: [u32; 2]) -> Result<()> {
    engine_example::window::run(settings, size)
}

#[cfg(not(feature = "window"))]
fn window(_: Settings, _: [u32; 2]) -> Result<()> {
    bail!("this program was built without its feature `window`; draw into a file with --out")
}
