//! Chen, Li and Wang 2006: Table 1, Figures 4 and 5, the claims of the text, and how the method converges and fails.

mod banding;
mod claims;
mod convergence;
mod pictures;
mod sweep;
mod table;

use chen_planes::{Options, Renderer};
use common::gpu::Ground;
use common::reference::Rendered;
use common::{Scene, Term};

use super::{PAGE, Press};
use crate::cmd::reference;
use crate::failure::Failure;
use crate::measure::Times;
use crate::record::Spread;
use crate::report::table::SOFTWARE;
use crate::techniques::{self, Technique};

/// The paper's pictures \[pixels\].
pub(super) const SIZE: (u32, u32) = (800, 640);

/// Steps of progress.
pub(super) const STEPS: u64 =
    pictures::STEPS + banding::STEPS + table::STEPS + claims::STEPS + convergence::STEPS;

/// The pass that the planes are drawn in, and that of the shadow maps.
const PLANES: &str = Renderer::PASSES[1];
const SHADOW_MAPS: &str = Ground::PASSES[0];

/// Said beside times of a software adapter.
const BIAS: &str = "It is biased against fine lattices: each of their triangles is set up on the CPU, which costs far \
more than on a GPU of 2006, whose time went into pixels. So rows with fine lattices come out slower here beside \
others than the paper has them.";

/// Makes everything; gives what to print.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let pictures = pictures::make(press)?;
    let banding = banding::make(press)?;
    let table = table::make(press)?;
    let claims = claims::make(press)?;
    let convergence = convergence::make(press)?;
    let page = format!(
        "# Chen 2006: the results again\n\n\
         S. Chen, S. Li, G. Wang, *Real-Time Rendering of Light Shafts on GPU*, 2006, on an ATI X800 GTO at 800x640. \
         The paper's scenes are not to be had: `window` and `hall` are our own, with the same number of triangles \
         where the paper gives one (Figure 5) and the same things to be seen.\n\n{}\n\
         ## Table 1: frames per second\n\n{table}\n\
         ## What the text claims\n\n{claims}\n\
         ## Figures 4 and 5\n\n{pictures}\
         ## How errors fall with the number of planes\n\n{convergence}\n\
         ## Two failures and their formulas\n\n{banding}",
        heading(press)
    );
    press.text(PAGE, &page)?;
    Ok(format!("{table}\n{claims}\npage: {}\n", press.folder.join(PAGE).display()))
}

/// Where and when, and what to know about it.
fn heading(press: &Press<'_>) -> String {
    let software = if press.context.software { format!("\n{SOFTWARE} {BIAS}\n") } else { String::new() };
    format!("{}\n{software}", press.origin().line())
}

/// The sampling planes in any setting, for pictures of `size`.
fn technique(press: &Press<'_>, options: Options, size: (u32, u32)) -> Result<Box<dyn Technique>, Failure> {
    let method = techniques::chen("papers", "sweep", None, options);
    let context = press.context;
    method.make(&context.device, &context.queue, context.radiance_format(), size).map_err(Failure::Run)
}

/// The paper's method with so many planes and lattice points each way.
fn paper(planes: u32, points: u32) -> Options {
    // The target's format is the stage's.
    Options { planes, lattice: [points; 2], ..Options::paper(wgpu::TextureFormat::Rgba16Float) }
}

/// The best that we know.
fn best() -> Options {
    Options::best(wgpu::TextureFormat::Rgba16Float)
}

/// The reference's airlight at time 0, at the size that frames are timed at.
fn truth(press: &Press<'_>, scene: &Scene) -> Result<Rendered, Failure> {
    let still = scene.at(0.0);
    let view = still.camera.view(press.timed_size.0, press.timed_size.1);
    reference(&still, &view, Term::Airlight.into(), &|share| {
        press.progress.detail(format!("{}: reference, {:.0} %", scene.name, 100.0 * share));
    })
}

/// Errors of a picture against the reference's airlight.
fn errors(image: &common::image::Image, truth: &Rendered) -> Result<common::metrics::Errors, Failure> {
    let truth = truth.airlight.as_ref().ok_or_else(|| Failure::Run("the reference lacks a term".into()))?;
    common::metrics::compare(image, truth).map_err(|error| Failure::Run(error.to_string()))
}

/// Times of the planes' pass; of all that the technique does where there are no timestamps.
fn planes_ms(times: &Times) -> Spread {
    Spread::of(times.passes.get(PLANES).unwrap_or(&times.wall))
}

/// Times of drawing shadow maps; none without timestamps.
fn shadow_maps_ms(times: &Times) -> Option<Spread> {
    times.ground_passes.get(SHADOW_MAPS).map(|times| Spread::of(times))
}
