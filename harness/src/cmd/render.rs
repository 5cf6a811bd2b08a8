//! `harness render`: one picture to a file.

use std::path::Path;

use common::gpu::Context;
use common::image::Image;
use common::need::Model;
use common::reference::IndirectModel;
use common::{Scene, Term};

use crate::cli::Render;
use crate::cmd::{cause, load, open, reference_by, shadow_map_size};
use crate::deferred::{self, Wanted};
use crate::failure::Failure;
use crate::interrupt;
use crate::measure::{Drawn, Stage};
use crate::progress::Progress;
use crate::techniques::{self, settings};

/// Draws and writes the picture; gives what to print.
pub(crate) fn run(arguments: &Render) -> Result<String, Failure> {
    // Everything that can be wrong with the command line, before any work.
    let extension = arguments.output.extension().and_then(|e| e.to_str()).unwrap_or_default();
    let exr = match extension.to_ascii_lowercase().as_str() {
        "exr" => true,
        "png" => false,
        _ => {
            return Err(Failure::Input(format!(
                "can't write {}: expected a name that ends in .exr (linear radiance) or .png (tone-mapped)",
                arguments.output.display()
            )));
        }
    };
    let folder = arguments.output.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if arguments.output.is_dir() || !folder.is_dir() {
        let what = if folder.is_dir() {
            "it is a folder".into()
        } else {
            format!("there is no folder {}", folder.display())
        };
        return Err(Failure::Input(format!("can't write {}: {what}", arguments.output.display())));
    }
    // A picture that takes minutes is not to be lost for want of a place.
    if let Err(error) = tempfile::tempfile_in(folder) {
        return Err(Failure::Input(format!("can't write {}: {error}", arguments.output.display())));
    }
    let image = match arguments.technique.as_deref() {
        Some("reference") => by_cpu(arguments, IndirectModel::default())?,
        Some("reference-unbounded") => by_cpu(arguments, IndirectModel::Unbounded)?,
        name => {
            let (method, model) = match (name, &arguments.settings) {
                (_, Some(file)) => settings::read(file)?,
                (name, None) => {
                    let method = techniques::find_one(name.unwrap_or_default()).map_err(Failure::Input)?;
                    (method, Model::default())
                }
            };
            if arguments.terms.contains(Term::IndirectAirlight)
                && !(method.technique == "biri-ss" && model.is_full())
            {
                return Err(Failure::Input(format!(
                    "{} can't draw {}: only biri-ss with all lights, `reference` and `reference-unbounded` do",
                    method.name,
                    Term::IndirectAirlight
                )));
            }
            if arguments.terms.contains(Term::Multiple)
                && (method.technique != techniques::CLOUDS || !arguments.terms.contains(Term::Airlight))
            {
                return Err(Failure::Input(format!(
                    "{} can't draw {}: only `reference` does, and {}, but only together with {}",
                    method.name,
                    Term::Multiple,
                    techniques::CLOUDS,
                    Term::Airlight
                )));
            }
            by_gpu(arguments, &method, &model)?
        }
    };
    let broken = image.pixels.iter().filter(|pixel| !pixel.is_finite()).count();
    let written = if exr {
        image.write_exr(&arguments.output)
    } else {
        image.write_png(&arguments.output, arguments.exposure.unwrap_or_else(|| image.auto_exposure()))
    };
    written.map_err(|error| {
        Failure::Run(format!("can't write {}: {}", arguments.output.display(), cause(&error)))
    })?;
    if broken > 0 {
        return Err(Failure::Run(format!(
            "{broken} pixels of {} are NaN or infinite",
            arguments.output.display()
        )));
    }
    Ok(format!("wrote {}\n", arguments.output.display()))
}

fn by_cpu(arguments: &Render, indirect: IndirectModel) -> Result<Image, Failure> {
    let scene = load(&arguments.scene, arguments.ground.triangles, |note| eprintln!("{note}"))?;
    let scene = scene.at(arguments.time);
    let view = scene.camera.view(arguments.size.0, arguments.size.1);
    let progress = Progress::new(1000);
    progress.doing("reference");
    let report = |share| progress.set((1000.0 * share) as u64);
    let rendered = reference_by(&scene, &view, arguments.terms, indirect, &report)?;
    let sure = |wanted: bool, of: &str, error: f64| {
        if wanted { format!(", relative uncertainty{of} {error:.1e}") } else { String::new() }
    };
    let indirectly = arguments.terms.contains(Term::IndirectAirlight);
    let multiply = arguments.terms.contains(Term::Multiple);
    let directly = rendered.surface.is_some() || rendered.airlight.is_some();
    progress.say(&format!(
        "reference of {}: {} s{}{}{}{}",
        arguments.terms,
        crate::report::digits(rendered.seconds),
        if rendered.cached { " (from the cache)" } else { "" },
        sure(directly, "", rendered.uncertainty),
        sure(indirectly, " of indirect_airlight", rendered.indirect_uncertainty),
        sure(multiply, " of multiple", rendered.multiple_uncertainty)
    ));
    Ok(rendered.total())
}

fn by_gpu(arguments: &Render, method: &techniques::Method, model: &Model) -> Result<Image, Failure> {
    let context = open(&arguments.ground)?;
    let scene = load(&arguments.scene, arguments.ground.triangles, |note| eprintln!("{note}"))?;
    if let Some(refusal) = method.refusal(&scene) {
        return Err(Failure::Input(format!("{}: {refusal}", method.name)));
    }
    let wrong = |problem: String| match &arguments.settings {
        Some(file) => Failure::Input(format!("{}: {problem}", file.display())),
        None => Failure::Run(format!("{}: {problem}", method.name)),
    };
    if let Some(problem) = model.problem(scene.lights.len()) {
        return Err(wrong(format!("the model {problem}")));
    }
    if let (Some(own), Some(asked)) = (method.shadow_map_size, arguments.ground.shadow_map_size)
        && own != asked
    {
        let by = arguments
            .settings
            .as_ref()
            .map_or_else(|| method.name.clone(), |file| file.display().to_string());
        return Err(Failure::Input(format!(
            "{by} has shadow maps of {own}², and --shadow-map-size asks for {asked}²; leave one of them out"
        )));
    }
    if let Some(options) = method.shadow_planes(context.radiance_format()).filter(|_| model.is_full()) {
        return by_shadow_planes(arguments, &context, &scene, &options);
    }
    let shadow_size = method.shadow_map_size.unwrap_or_else(|| shadow_map_size(&arguments.ground, &context));
    let mut stage = Stage::new(&context, &scene, arguments.size, shadow_size)?;
    let mut technique = method
        .make_reduced(
            &context.device,
            &context.queue,
            stage.format(),
            arguments.size,
            (model, scene.lights.len()),
        )
        .map_err(wrong)?;
    let drawn = match (arguments.terms.contains(Term::Airlight), arguments.terms.contains(Term::Surface)) {
        (true, true) => Drawn::Both,
        (true, false) => Drawn::Airlight,
        _ => Drawn::Surface,
    };
    let picture = stage.picture(Some(technique.as_mut()), arguments.time, drawn)?;
    interrupt::check()?;
    technique.warnings().iter().for_each(|warning| eprintln!("note: {warning}"));
    Ok(picture)
}

/// A technique that lights the surfaces itself, with its own shadows.
fn by_shadow_planes(
    arguments: &Render,
    context: &Context,
    scene: &Scene,
    options: &biri_ss::Options,
) -> Result<Image, Failure> {
    let mut stage = deferred::Stage::new(context, scene, arguments.size)?;
    let mut renderer = stage.renderer(options).map_err(|failure| match &arguments.settings {
        // What the crate refuses of a file's options is the file's fault.
        Some(file) => Failure::Input(format!("{}: {failure}", file.display())),
        None => failure,
    })?;
    let wanted = Wanted { indirect: arguments.terms.contains(Term::IndirectAirlight), ..Default::default() };
    let pictures = stage.pictures(&mut renderer, &scene.at(arguments.time), wanted)?;
    interrupt::check()?;
    renderer.warnings().iter().for_each(|warning| eprintln!("note: {warning}"));
    let black = Image::black(arguments.size.0, arguments.size.1);
    Ok(arguments.terms.iter().fold(black, |sum, term| match term {
        Term::Surface => sum.plus(&pictures.surfaces),
        Term::Airlight => sum.plus(&pictures.airlight),
        Term::IndirectAirlight => sum.plus(&pictures.indirect),
        // Refused before.
        Term::Multiple => sum,
    }))
}
