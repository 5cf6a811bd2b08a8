//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use common::terms::{Term, Terms};

use crate::record::Study;

const AFTER_HELP: &str = "\
EXAMPLES (in a checkout, `harness` is `cargo run --release -p harness --`):
  harness                                    compare what draws them on cathedral and amphora
  harness --scene church.obj --size 640x512  the same on your own model
  harness --only billeter-plv --only ray-march-64 --frames 100
  harness --full                             everything, for an hour; stopped by Ctrl-C, it goes on with --resume
  harness render --scene cathedral --technique billeter-plv -o cathedral.png
  harness render --scene amphora --technique reference --terms airlight -o airlight.exr
  harness --improvements                     each improvement on the paper by itself, too
  harness choose --scene pen --max-error 2%  how little is enough: technique and settings for it
  harness targets                            are the promises kept? (a few minutes)
  harness papers biri                        a paper's table and figures, made again (or: billeter, chen, szk)
  harness stability                          where does each method break? (half an hour; --quick: a minute or two)
  harness view --scene amphora               a window to look through; --against reference: the error as it is
  harness list                               names of scenes, techniques and phase functions
  harness report results/latest              make the page again from the records
  harness report run-a run-b -o both         one page of several runs or adapters
  harness compare results/before results/latest   what got slower or worse? (exit code 1)

A scene is the name of a built-in one or a file: .obj, .gltf, .glb or a .json scene file, which can
also say what the others can't (lights, medium, camera, motion).

EXIT CODES:
  0    all measured and every picture right
  1    something failed on the way (no graphics adapter, a full disk), or a picture was wrong (NaN,
       or an error above its bound), or a target was missed, or a run is slower or worse than another
  2    wrong usage, or a file, a scene, a size or a folder that can't be worked with
  130  stopped by Ctrl-C";

/// Measures and compares techniques for light in fog: speed, error against a CPU reference, pictures.
///
/// Without a command it compares: every technique on every scene that it can draw, its time per frame and
/// its error, as a table here and as a page with pictures, charts and records in the output folder.
#[derive(Debug, Parser)]
#[command(name = "harness", version, after_help = AFTER_HELP, args_conflicts_with_subcommands = true)]
pub(crate) struct Cli {
    /// What to do instead of comparing.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// What to measure.
    #[command(flatten)]
    pub run: Run,
}

/// Everything but the comparison.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Open a window to look through: fly, turn every setting, hold techniques against each other and the reference.
    View(Window),
    /// Draw one picture by one technique or by the CPU reference.
    Render(Render),
    /// Say what a scene needs, and the cheapest technique and settings within an error.
    Choose(Choose),
    /// Make the tables and figures of a paper again, by its method and by the best we know.
    Papers(Papers),
    /// List the names of scenes, techniques, terms and phase functions.
    List,
    /// Measure what is promised of the techniques, and fail if a promise does not hold.
    Targets(Targets),
    /// Find where each method breaks: every failure swept from harmless to absurd, held against what is promised; fails
    /// if a promise does not hold.
    Stability(Stability),
    /// Make the page, charts and table again from the records of one run or several.
    Report(Report),
    /// Say what got faster, slower, better or worse from one run to another, beyond the noise; fails if
    /// anything got slower or worse.
    #[command(name = "compare")]
    Diff(Diff),
}

/// A page from records.
#[derive(Clone, Debug, Args)]
pub(crate) struct Report {
    /// Folders of runs, each of which holds records.jsonl; of a measurement that is there twice on one
    /// adapter, the later one counts.
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Folder for the page [default: the run's own; needed where there are several].
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Put Markdown tables into this file, between `<!-- harness:NAME -->` and `<!-- /harness:NAME -->`,
    /// where NAME is equal-error, presets or winners.
    #[arg(long, value_name = "FILE")]
    pub readme: Option<PathBuf>,
    /// Folders that `harness papers` wrote; may be several [default: all papers-* in and beside the runs'
    /// folders].
    #[arg(long, value_name = "DIR", num_args = 1..)]
    pub papers: Vec<PathBuf>,
}

/// The atlas of what breaks.
#[derive(Clone, Debug, Args)]
pub(crate) struct Stability {
    /// A few values of each row and only what something is promised of, in a minute or two.
    #[arg(long)]
    pub quick: bool,
    /// Row of the atlas, such as `light-at-eye`; may be given several times [default: all].
    #[arg(long = "row", value_name = "ID")]
    pub rows: Vec<String>,
    /// Column of the atlas, such as `biri-ss-default` or `froxels-8x64`; may be given several times [default: all].
    #[arg(long = "only", value_name = "NAME")]
    pub only: Vec<String>,
    /// Make page and tables again from the records in the output folder; measure nothing.
    #[arg(long)]
    pub from_records: bool,
    /// Folder for records, curves, pictures and page; replaced when all is measured.
    #[arg(short, long, value_name = "DIR", default_value = "results/stability")]
    pub output: PathBuf,
    /// Put each technique's domain of validity into this file, between `<!-- harness:domain-NAME -->` and
    /// `<!-- /harness:domain-NAME -->`, where NAME is the technique; may be several files.
    #[arg(long, value_name = "FILE", num_args = 1..)]
    pub readme: Vec<PathBuf>,
    /// Use the first adapter whose name contains this [default: the fastest kind].
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
}

/// Two runs.
#[derive(Clone, Debug, Args)]
pub(crate) struct Diff {
    /// The earlier run's folder.
    pub old: PathBuf,
    /// The later run's folder.
    pub new: PathBuf,
    /// Differences of time up to this are none, even where they are beyond the spreads.
    #[arg(long, value_name = "SHARE", default_value = "5%", value_parser = parse_share)]
    pub threshold: f64,
}

/// What is measured.
#[derive(Clone, Debug, Args)]
pub(crate) struct Run {
    /// A few settings of each technique, in about two minutes on a software adapter (default).
    #[arg(long, conflicts_with = "full")]
    pub quick: bool,
    /// Everything, unattended: all settings at full size, each improvement, cost against triangles, lights, pixels, shadow
    /// maps and silhouette edges, what single scattering misses, and the results of all papers. Takes an hour on a software adapter.
    #[arg(long)]
    pub full: bool,
    /// Scene: a built-in name or a file; may be given several times [default: cathedral and amphora].
    #[arg(long = "scene", value_name = "NAME|FILE")]
    pub scenes: Vec<String>,
    /// Technique (`ray-march`), or one setting of it (`ray-march-64`, or `ray-march-64@2048` on shadow maps of
    /// 2048²); may be given several times [default: all that can draw the scene: szk-network one with a cloud, the
    /// others one without].
    #[arg(long = "only", visible_alias = "technique", value_name = "NAME")]
    pub only: Vec<String>,
    /// Measure the paper's setting with one improvement each too.
    #[arg(long)]
    pub improvements: bool,
    /// Measure only what answers this question; may be given several times. All but the first two need --full
    /// [default: all].
    #[arg(long = "study", value_name = "NAME")]
    pub studies: Vec<Study>,
    /// Go on with the run into the same folder that was stopped: measure only what it lacks.
    #[arg(long)]
    pub resume: bool,
    /// Size of the pictures in pixels [default: 1280x1024; on a software adapter 256x208, with --full 640x512].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// Frames that are timed, everything moving [default: as many as fit into half a second, with --full
    /// into a few].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Folder for records, tables, pictures and page; replaced when the run is finished.
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
    #[arg(long, value_name = "NAME", required_unless_present = "settings", conflicts_with = "settings")]
    pub technique: Option<String>,
    /// The technique and its options from a file, as `harness choose` writes it.
    #[arg(long, value_name = "FILE")]
    pub settings: Option<PathBuf>,
    /// Terms of light transport to add up: airlight, surface, (of the reference and of biri-ss)
    /// `indirect_airlight`, airlight that lights a surface, and (of the reference, and of
    /// szk-network together with airlight) `multiple`, the rest.
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

/// A window to look through.
#[derive(Clone, Debug, Args)]
pub(crate) struct Window {
    /// Scene: a built-in name or a file.
    #[arg(long, value_name = "NAME|FILE", default_value = "cathedral")]
    pub scene: String,
    /// Technique (see `harness list`) [default: szk-network for a cloud; else lit-intervals on a software adapter,
    /// billeter-plv on others].
    #[arg(long, value_name = "NAME", conflicts_with = "settings")]
    pub technique: Option<String>,
    /// The technique and its options from a file, as `harness choose` and the window write it.
    #[arg(long, value_name = "FILE")]
    pub settings: Option<PathBuf>,
    /// Hold it against a second technique, or against the CPU `reference`.
    #[arg(long, value_name = "NAME")]
    pub against: Option<String>,
    /// Size of the window in points.
    #[arg(long, value_name = "WxH", default_value = "1280x800", value_parser = parse_size)]
    pub size: (u32, u32),
    /// What it is drawn on.
    #[command(flatten)]
    pub ground: Ground,
}

/// What is to be chosen for.
#[derive(Clone, Debug, Args)]
pub(crate) struct Choose {
    /// Scene: a built-in name or a file; may be given several times.
    #[arg(long = "scene", required = true, value_name = "NAME|FILE")]
    pub scenes: Vec<String>,
    /// Largest error, a relative RMSE of the airlight; may be given several times.
    #[arg(long = "max-error", value_name = "SHARE", default_value = "2%", value_parser = parse_bound)]
    pub max_errors: Vec<f64>,
    /// Longest time of the technique's own passes \[ms\]; fails where nothing under the bound is as fast.
    #[arg(long, value_name = "T", value_parser = parse_milliseconds)]
    pub max_ms: Option<f64>,
    /// Choose among these techniques only; may be given several times.
    #[arg(long = "technique", value_name = "NAME")]
    pub techniques: Vec<String>,
    /// Measure the whole grid of settings too, and write tables and charts of how good the choices are. Takes minutes for
    /// each scene.
    #[arg(long)]
    pub sweep: bool,
    /// Size of the pictures in pixels [default: 1280x1024; on a software adapter 256x208].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// Frames that are timed, everything moving [default: as many as fit into half a second].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: Option<u32>,
    /// Triangles of built-in scenes [default: the scene's own count].
    #[arg(long, value_name = "N")]
    pub triangles: Option<u32>,
    /// Use the first adapter whose name contains this [default: the fastest kind].
    #[arg(long, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Folder for the choice: settings as JSON and as Rust, the text, and choices.jsonl.
    #[arg(short, long, value_name = "DIR", default_value = "results/choice")]
    pub output: PathBuf,
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
    /// Technique; may be given several times [default: all].
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
    /// Size of the pictures in pixels [default: the paper's; on a software adapter a quarter of either side for
    /// what is timed].
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
    /// software adapter, else 1024; 1024 with --full].
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

fn parse_share(text: &str) -> Result<f64, String> {
    let (number, unit) =
        text.trim().strip_suffix('%').map_or((text.trim(), 1.0), |number| (number.trim(), 0.01));
    let share = number.parse::<f64>().ok().map(|number| number * unit);
    share
        .filter(|share| (0.0..1e3).contains(share))
        .ok_or_else(|| "expected a share such as 5% or 0.05".into())
}

fn parse_bound(text: &str) -> Result<f64, String> {
    parse_share(text)
        .ok()
        .filter(|share| *share > 0.0 && *share < 1.0)
        .ok_or_else(|| "expected an error above 0 % and below 100 %, such as 2% or 0.02".into())
}

fn parse_milliseconds(text: &str) -> Result<f64, String> {
    let positive = text.parse::<f64>().ok().filter(|ms| ms.is_finite() && *ms > 0.0);
    positive.ok_or_else(|| "expected a number of milliseconds above 0".into())
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
    fn a_share_is_a_percentage_or_a_number() {
        assert_eq!(
            [parse_share("5%"), parse_share("0.05"), parse_share("0 %")],
            [Ok(0.05), Ok(0.05), Ok(0.0)]
        );
        for bad in ["", "%", "-1%", "NaN", "five"] {
            assert!(parse_share(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn sizes_have_two_sides_and_neither_is_zero() {
        assert_eq!(parse_size("640x512"), Ok((640, 512)));
        for bad in ["", "640", "0x0", "640x", "x", "640x0", "-1x5", "1e3x5", "99999999999x1", "65536x65536"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }
}
