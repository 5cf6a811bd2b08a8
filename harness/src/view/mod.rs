//! `harness view`: a window to look through.
//!
//! A [`side::Side`] draws a technique, [`refine::Refining`] computes the reference beside it, [`app::App`] puts both into the
//! picture and the panel beside it. No technique is known here but by its settings file ([`knobs`]).

mod app;
mod fly;
mod history;
mod knobs;
mod panel;
mod picture;
mod present;
mod refine;
mod save;
mod side;
mod subject;
#[cfg(test)]
mod tests;
mod verdict;

use std::panic::{AssertUnwindSafe, catch_unwind};

use common::gpu::Context;
use eframe::{NativeOptions, egui, egui_wgpu};

use crate::cli;
use crate::cmd::open;
use crate::failure::Failure;
use crate::techniques::CLOUDS;
use crate::techniques::settings::{Settings, read};
use app::App;
use side::Side;
use subject::Subject;

/// What is looked at first, where nothing was asked for: the fastest on either kind of adapter.
fn usual_technique(context: &Context, cloud: bool) -> &'static str {
    match (cloud, context.software) {
        (true, _) => CLOUDS,
        (false, true) => "lit-intervals",
        (false, false) => "billeter-plv",
    }
}

/// Opens the window and runs until it is closed.
pub(crate) fn run(arguments: &cli::Window) -> Result<String, Failure> {
    let context = open(&arguments.ground)?;
    let app = from_arguments(arguments, context)?;
    // Who draws needs what the window is drawn with.
    let setup = egui_wgpu::WgpuSetupExisting {
        instance: app.context.instance.clone(),
        adapter: app.context.gpu.clone(),
        device: app.context.device.clone(),
        queue: app.context.queue.clone(),
    };
    let mut options = NativeOptions { centered: true, ..NativeOptions::default() };
    options.wgpu_options.wgpu_setup = egui_wgpu::WgpuSetup::Existing(setup);
    let (width, height) = arguments.size;
    options.viewport = egui::ViewportBuilder::default()
        .with_title("Light in fog")
        .with_inner_size([width as f32, height as f32])
        .with_min_inner_size([640.0, 400.0]);
    // A display library that is missing is a panic of theirs, told like any other reason.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| ()));
    let ended = catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native("light-in-fog", options, Box::new(|_| Ok(Box::new(app))))
    }));
    std::panic::set_hook(hook);
    match ended {
        Ok(Ok(())) => Ok(String::new()),
        Ok(Err(error)) => Err(no_window(&error.to_string())),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().cloned();
            let text = text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned()));
            Err(no_window(&text.unwrap_or_else(|| "the window broke".into())))
        }
    }
}

/// The one sentence of a window that can't be opened.
fn no_window(why: &str) -> Failure {
    let why = why.lines().next().unwrap_or_default().trim_end_matches('.');
    // Where in a library's source it was noticed helps nobody.
    let why = why.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": ")).map_or(why, |(_, why)| why);
    Failure::Run(format!(
        "no window: {why}; `harness view` needs a display (DISPLAY or WAYLAND_DISPLAY on Linux), `harness render` draws \
         into a file without one"
    ))
}

/// The window's content as the command line asks for it.
fn from_arguments(arguments: &cli::Window, context: Context) -> Result<App, Failure> {
    let subject = Subject::load(&arguments.scene, arguments.ground.triangles)?;
    let cloud = subject.base().cloud.is_some();
    let named = |name: &str| Side::of(name).map_err(Failure::Input);
    let usual = usual_technique(&context, cloud);
    let first = match (&arguments.settings, &arguments.technique) {
        (Some(file), _) => {
            let (method, model) = read(file)?;
            Side::with(Settings::of(&method, &model))
        }
        (None, Some(name)) => named(name)?,
        (None, None) => named(usual)?,
    };
    let (against, second) = match arguments.against.as_deref() {
        None => (picture::Against::Nothing, named(usual)?),
        Some("reference") => (picture::Against::Reference, named(usual)?),
        Some(name) => (picture::Against::Technique, named(name)?),
    };
    let shadow_map_size = crate::cmd::shadow_map_size(&arguments.ground, &context);
    let mut app = App::new(context, subject, [first, second], shadow_map_size);
    app.look.against = against;
    Ok(app)
}
