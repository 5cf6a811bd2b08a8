//! Szirmay-Kalos, Sbert and Umenhoffer 2005: Figures 5 to 8, the claims of the text, and what the paper leaves open.

mod animated;
mod claims;
mod convergence;
mod directions;
mod figures;
mod grid;
mod lab;
mod opacities;
mod scattering;
mod timing;

use common::{DirectionalLight, Light, Lobe, Scene, Sky};
use glam::{Quat, Vec3};

use super::plot::{Axis, Chart, Numbers};
use super::{PAGE, Press};
use crate::failure::Failure;
use crate::report::table::SOFTWARE;

/// Of pictures, where frames are timed on a GPU \[pixels\]; the paper does not give its own.
pub(super) const SIZE: (u32, u32) = (640, 512);

/// Steps of progress.
pub(super) const STEPS: u64 = timing::STEPS
    + figures::STEPS
    + convergence::STEPS
    + grid::STEPS
    + directions::STEPS
    + scattering::STEPS
    + opacities::STEPS
    + animated::STEPS;

/// Version of all files of numbers, described in results/README.md.
const SCHEMA: u32 = 1;

/// Makes everything; gives what to print.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let opacities = opacities::make(press)?;
    let scattering = scattering::make(press)?;
    let animated = animated::make(press)?;
    let directions = directions::make(press)?;
    let (grid, grid_text) = grid::make(press)?;
    let (convergence, convergence_text) = convergence::make(press)?;
    let figures = figures::make(press)?;
    let timing = timing::measure(press)?;
    let table = timing.table();
    let claims = claims::make(press, &timing, &convergence, &grid)?;
    let page = format!(
        "# Szirmay-Kalos 2005: the results again\n\n\
         L. Szirmay-Kalos, M. Sbert, T. Umenhoffer, *Real-Time Multiple Scattering in Participating Media with \
         Illumination Networks*, 2005, on an NV6800GT. The paper's cloud is not to be had: `cloud` is our own, of the \
         same albedo (0.9), phase function (g = 0) and optical depth (about 20 through). Where it is lit by white light, \
         the network has one colour; times beside the paper's are of three.\n\n{}\n\
         ## Frames per second\n\n{table}\n\
         ## What the text claims\n\n{claims}\n\
         ## Figures 5 and 8: a moving camera and moving lights\n\n{figures}\
         ## Figure 6: step by step\n\n{convergence_text}\n\
         ## Figure 7: particles and directions\n\n{grid_text}\n\
         ## Opacities by link and by particle\n\n{opacities}\n\
         ## Which directions, and which of them a light comes in by\n\n{directions}\n\
         ## The whole matrix and a few components of it\n\n{scattering}\n\
         ## A cloud that moves\n\n{animated}",
        heading(press)
    );
    press.text(PAGE, &page)?;
    Ok(format!("{table}\n{claims}\npage: {}\n", press.folder.join(PAGE).display()))
}

/// Where and when, and what to know about it.
fn heading(press: &Press<'_>) -> String {
    let software = if press.context.software { format!("\n{SOFTWARE}\n") } else { String::new() };
    format!("{}\n{software}", press.origin().line())
}

/// A built-in scene.
fn built(name: &str) -> Result<Scene, Failure> {
    common::scene::builtin::build(name, None).map_err(|error| Failure::Run(error.to_string()))
}

/// `sphere` with Henyey-Greenstein's phase function.
fn sphere(g: f64) -> Result<Scene, Failure> {
    let mut scene = built("sphere")?;
    if let Some(cloud) = &mut scene.cloud {
        cloud.phase = Lobe::HenyeyGreenstein { g }.into();
    }
    Ok(scene)
}

/// `cloud` in the white light of so many lights and of a grey sky: one from the upper right, one from the lower left
/// that is a quarter as strong, and from there on others from all around.
fn white(lights: usize, sky: f32) -> Result<Scene, Failure> {
    let mut scene = built("cloud")?;
    let directions = [
        Vec3::new(-0.75, -0.6, -0.3),
        Vec3::new(0.8, 0.5, -0.3),
        Vec3::new(0.2, -0.8, 0.6),
        Vec3::new(0.0, 0.4, 0.9),
    ];
    let light = |(index, direction): (usize, &Vec3)| {
        let irradiance = Vec3::splat(if index == 0 { 10.0 } else { 2.5 });
        Light::Directional(DirectionalLight { direction: direction.normalize(), irradiance })
    };
    scene.lights = directions.iter().enumerate().take(lights).map(light).collect();
    scene.sky = Sky::Constant(Vec3::splat(sky));
    scene.animation.clear();
    // The cloud is all that there is to be seen.
    scene.camera.fov_y = 0.56;
    scene.name = format!("cloud, {lights} white lights");
    Ok(scene)
}

/// Turns all lights about the vertical.
fn turn(scene: &mut Scene, degrees: f32) {
    let turn = Quat::from_rotation_y(degrees.to_radians());
    for light in &mut scene.lights {
        if let Light::Directional(light) = light {
            light.direction = (turn * light.direction).normalize();
        }
    }
}

const fn axis(title: &'static str, logarithmic: bool, numbers: Numbers) -> Axis {
    Axis { title, logarithmic, numbers }
}

/// Writes a chart.
fn draw(press: &Press<'_>, file: &str, chart: &Chart) -> Result<(), Failure> {
    let svg = chart.svg().map_err(|error| Failure::Run(format!("{file}: {error}")))?;
    press.text(file, &svg)
}
