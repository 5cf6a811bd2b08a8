//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use common::terms::{Term, Terms};

const AFTER_HELP: &str = "\
EXAMPLES (in a checkout, `harness` is `cargo run --release -p harness --`):
  harness                                    compare all techniques on the built-in scenes
  harness --scene church.obj --size 640x512  the same on your own model
  harness --technique billeter-plv --technique ray-march-64 --frames 100
  harness render --scene cathedral --technique billeter-plv -o cathedral.png
  harness render --scene amphora --technique reference --terms airlight -o airlight.exr
  harness --improvements                     each improvement on the paper by itself, too
  harness targets                            are the promises kept? (a few minutes)
  harness papers biri                        a paper's table and figures, made again (or: billeter, chen, szk)
  harness list                               names of scenes, techniques and phase functions
  harness report results/latest              make the page again from the records

A scene is the name of a built-in one or a file: .obj, .gltf, .glb or a .json scene file, which can
also say what the others can't (lights, medium, camera, motion).

EXIT CODES:
  0    all measured and every picture right
  1    something failed on the way (no graphics adapter, a full disk), or a picture was wrong (NaN,
       or an error above its bound), or a target was missed
  2    wrong usage, or a file, a scene, a size or a folder that can't be worked with
  130  stopped by Ctrl-C";

/// Measures and compares techniques for light in fog: speed, error against a CPU reference, pictures.
///
/// Without a command it compares: every technique on every scene, its time per frame and its error,
/// as a table here and as a page with pictures, charts and records in the output folder.
#[derive(Debug, Parser)]
#[command(name = "harness", version, after_help = AFTER_HELP, args_conflicts_with_subcommands = true)]
pub(crate) struct Cli {
    /// What to do instead of comparing.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// What to compare.
    #[command(flatten)]
    pub compare: Compare,
}

/// Everything but the comparison.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Draw one picture by one technique or by the CPU reference.
    Render(Render),
    /// Make the tables and figures of a paper again, by its method and by the best we know.
    Papers(Papers),
    /// List the names of scenes, techniques, terms and phase functions.
    List,
    /// Measure what is promised of the techniques, and fail if a promise does not hold.
    Targets(Targets),
    /// Make a run's page, charts and table again, from its records alone.
    Report {
        /// A run's folder, which holds records.jsonl.
        folder: PathBuf,
    },
}

/// The comparison.
#[derive(Clone, Debug, Args)]
pub(crate) struct Compare {
    /// Scene: a built-in name or a file; may be given several times [default: cathedral and amphora].
    #[arg(long = "scene", value_name = "NAME|FILE")]
    pub scenes: Vec<String>,
    /// Technique, or all settings of one (`ray-march`); may be given several times [default: all that can
    /// draw the scene: szk-network one with a cloud, the others one without].
    #[arg(long = "technique", value_name = "NAME")]
    pub techniques: Vec<String>,
    /// Measure the paper's setting with one improvement each too.
    #[arg(long)]
    pub improvements: bool,
    /// Size of the pictures in pixels [default: 256x208 on a software adapter, else 1280x1024].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// Frames that are timed, everything moving [default: up to 12 on a software adapter, else up to
    /// 300, as many as fit into a few seconds].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Folder for records, table, pictures and page; replaced when the run is finished.
    #[arg(long, value_name = "DIR", default_value = "results/latest")]
    pub output: PathBuf,
    /// What the run is measured on.
    #[command(flatten)]
    pub ground: Ground,
}

/// One picture.
#[derive(Clone, Debug, Args)]
pub(crate) struct Render {
    /// Scene: a built-in name or a file.
    #[arg(long, value_name = "NAME|FILE")]
    pub scene: String,
    /// Technique (see `harness list`), or `reference`, or `reference-unbounded`: the reference with
    /// indirect airlight as in a medium without walls and shadows.
    #[arg(long, value_name = "NAME")]
    pub technique: String,
    /// Terms of light transport to add up: airlight, surface, (of the reference and of biri-ss)
    /// `indirect_airlight`, airlight that lights a surface, and (of the reference) `multiple`, the rest.
    #[arg(long, value_name = "TERM,...", default_value = "airlight,surface", value_parser = parse_terms)]
    pub terms: Terms,
    /// Time in the scene's motion, in seconds.
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = parse_time, allow_negative_numbers = true)]
    pub time: f32,
    /// Size in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x512", value_parser = parse_size)]
    pub size: (u32, u32),
    /// File: .exr for linear radiance (32-bit floats, row 0 at the top) or .png, tone-mapped.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Exposure of a PNG: factor before the tone curve [default: from the picture].
    #[arg(long, value_name = "X", value_parser = parse_exposure)]
    pub exposure: Option<f32>,
    /// What it is drawn on.
    #[command(flatten)]
    pub ground: Ground,
}

/// The promises.
#[derive(Clone, Debug, Args)]
pub(crate) struct Targets {
    /// Folder for targets.json and targets.md.
    #[arg(long, value_name = "DIR", default_value = "results/targets")]
    pub output: PathBuf,
    /// Use the first adapter whose name contains this [default: the fastest kind].
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Size of the pictures in pixels.
    #[arg(long, value_name = "WxH", default_value = "640x512", value_parser = parse_size)]
    pub size: (u32, u32),
    /// Technique; may be given several times [default: both].
    #[arg(long = "technique", value_name = "NAME")]
    pub techniques: Vec<Promised>,
    /// A model of Sibenik cathedral, to bound the error of biri-ss on as well.
    #[arg(long, value_name = "FILE")]
    pub sibenik: Option<String>,
}

/// Techniques of which something is promised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Promised {
    /// Polygonal light volumes.
    BilleterPlv,
    /// Sorted shadow planes.
    BiriSs,
    /// Sampling planes.
    ChenPlanes,
    /// Illumination networks.
    SzkNetwork,
}

/// A paper's results.
#[derive(Clone, Debug, Args)]
pub(crate) struct Papers {
    /// The paper.
    pub paper: Paper,
    /// Folder for tables and figures [default: results/papers/ and the paper's name].
    #[arg(long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Size of the pictures in pixels [default: the paper's].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// Frames that are timed, everything moving [default: as many as suit the adapter].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Use the first adapter whose name contains this [default: the fastest kind].
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Papers whose results can be made again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Paper {
    /// Billeter, Sintorn and Assarson 2010, supplement of 2012: polygonal light volumes.
    Billeter,
    /// Biri et al. 2006: single scattering with shadow planes.
    Biri,
    /// Chen, Li and Wang 2006: light shafts by sampling planes.
    Chen,
    /// Szirmay-Kalos, Sbert and Umenhoffer 2005: multiple scattering in clouds by illumination networks.
    Szk,
}

/// What comparing and drawing share.
#[derive(Clone, Debug, Args)]
pub(crate) struct Ground {
    /// Triangles of built-in scenes [default: the scene's own count].
    #[arg(long, value_name = "N")]
    pub triangles: Option<u32>,
    /// Texels on a side of each shadow map (of each face around a point light) [default: 512 on a
    /// software adapter, else 1024].
    #[arg(long, value_name = "N")]
    pub shadow_map_size: Option<u32>,
    /// Use the first adapter whose name contains this [default: the fastest kind].
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Most pixels of a picture: 8192².
const MAX_PIXELS: u64 = 1 << 26;

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let expected = "expected WIDTHxHEIGHT in pixels, such as 640x512";
    let (width, height) = text.split_once(['x', 'X']).ok_or(expected)?;
    let side = |text: &str| text.trim().parse::<u32>().map_err(|_| expected.to_owned());
    let size = (side(width)?, side(height)?);
    if size.0 == 0 || size.1 == 0 {
        return Err("a picture has at least one pixel each way".into());
    }
    if u64::from(size.0) * u64::from(size.1) > MAX_PIXELS {
        return Err(format!("a picture has at most {MAX_PIXELS} pixels"));
    }
    Ok(size)
}

fn parse_terms(text: &str) -> Result<Terms, String> {
    let terms: Terms = text.parse().map_err(|error| format!("{error}"))?;
    let names = Term::ALL.map(Term::name).join(", ");
    if terms.is_empty() { Err(format!("expected at least one of: {names}")) } else { Ok(terms) }
}

fn parse_time(text: &str) -> Result<f32, String> {
    let finite = text.parse::<f32>().ok().filter(|time| time.is_finite());
    finite.ok_or_else(|| "expected a number of seconds".into())
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    let positive = text.parse::<f32>().ok().filter(|x| x.is_finite() && *x > 0.0);
    positive.ok_or_else(|| "expected a number above 0".into())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_well_formed() {
        Cli::command().debug_assert();
    }

    #[test]
    fn sizes_have_two_sides_and_neither_is_zero() {
        assert_eq!(parse_size("640x512"), Ok((640, 512)));
        for bad in ["", "640", "0x0", "640x", "x", "640x0", "-1x5", "1e3x5", "99999999999x1", "65536x65536"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }
}
