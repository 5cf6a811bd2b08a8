//! One file per command.

pub(crate) mod diff;
pub(crate) mod list;
pub(crate) mod render;
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod targets;

use std::path::PathBuf;

use common::gpu::{Context, ContextError, ContextOptions};
use common::reference::{self, IndirectModel, Options, Reference, Rendered};
use common::{Scene, Terms, View};

use crate::cli;
use crate::failure::Failure;
use crate::interrupt;

/// The innermost cause of an error: what the system said, without what wrapped it.
pub(crate) fn cause(error: &(dyn std::error::Error + 'static)) -> String {
    std::iter::successors(Some(error), |error| error.source()).last().unwrap_or(error).to_string()
}

/// Loads a scene and says what the loader has to say.
pub(crate) fn load(name: &str, triangles: Option<u32>, say: impl Fn(&str)) -> Result<Scene, Failure> {
    let scene =
        common::scene::load::load(name, triangles).map_err(|error| Failure::Input(error.to_string()))?;
    for note in &scene.notes {
        say(&format!("note: {note}"));
    }
    if scene.lights.is_empty() {
        return Err(Failure::Input(format!(
            "{name}: the scene has no light, so there is nothing to draw; give it one in a JSON scene file \
             (docs/scene-format.md)"
        )));
    }
    if let Some(problem) = scene.problem() {
        return Err(Failure::Input(format!("{name}: {problem}")));
    }
    Ok(scene)
}

/// Opens the device.
pub(crate) fn open(ground: &cli::Ground) -> Result<Context, Failure> {
    open_adapter(ground.adapter.as_deref())
}

/// Opens the device of the adapter whose name contains `wanted`, or of the best.
pub(crate) fn open_adapter(wanted: Option<&str>) -> Result<Context, Failure> {
    let options = ContextOptions { adapter: wanted.map(str::to_owned) };
    Context::new(&options).map_err(|error| match error {
        ContextError::NoSuchAdapter { .. } => Failure::Input(error.to_string()),
        other => Failure::Run(other.to_string()),
    })
}

/// Texels on a side of a shadow map: as asked for, or what suits the adapter.
pub(crate) fn shadow_map_size(ground: &cli::Ground, context: &Context) -> u32 {
    ground.shadow_map_size.unwrap_or(if context.software { 512 } else { 1024 })
}

/// A reference picture, from the cache if it has been drawn before.
pub(crate) fn reference(
    scene: &Scene,
    view: &View,
    terms: Terms,
    report: &(dyn Fn(f32) + Sync),
) -> Result<Rendered, Failure> {
    reference_by(scene, view, terms, IndirectModel::default(), report)
}

/// The same with a choice of how indirect airlight is computed.
fn reference_by(
    scene: &Scene,
    view: &View,
    terms: Terms,
    indirect: IndirectModel,
    report: &(dyn Fn(f32) + Sync),
) -> Result<Rendered, Failure> {
    reference_with(scene, view, terms, Options { indirect, ..Options::default() }, report)
}

/// The same with all settings.
pub(crate) fn reference_with(
    scene: &Scene,
    view: &View,
    terms: Terms,
    options: Options,
    report: &(dyn Fn(f32) + Sync),
) -> Result<Rendered, Failure> {
    let failed = |error| reference_failure(&scene.name, error);
    let reference = Reference::with_options(scene, options).map_err(failed)?;
    reference.render_cached(&cache_folder(), view, terms, report, interrupt::flag()).map_err(failed)
}

/// Why there is no reference picture of a scene.
pub(crate) fn reference_failure(scene: &str, error: reference::Error) -> Failure {
    match error {
        reference::Error::Cancelled => Failure::Interrupted("stopped".into()),
        other => Failure::Input(format!("{scene}: {other}")),
    }
}

/// Where reference pictures are kept: in the target folder that this program lies in, else among the
/// system's temporary files.
fn cache_folder() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    let target = program.ancestors().find(|folder| folder.join("CACHEDIR.TAG").is_file());
    target.map_or_else(|| std::env::temp_dir().join("light-in-fog"), PathBuf::from).join("reference")
}
