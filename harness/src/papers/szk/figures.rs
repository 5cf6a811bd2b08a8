//! Figures 5 and 8: a camera that goes round, lights that turn, one step a frame.

use szk_network::{Options, Sampling};

use super::super::{Picture, Press};
use super::lab::{Lab, RESIDUAL, paper, particles};
use super::{built, turn};
use crate::failure::Failure;
use crate::report::digits;

/// Steps of progress: a row of pictures each.
pub(super) const STEPS: u64 = 3;

/// Frames between two pictures, in which the lights turn by this much each \[degrees\].
const BETWEEN: u32 = 2;
const TURN: f32 = 5.0;
/// Steps before the first picture.
const FIRST: u32 = 24;
/// Time of the scene between two frames \[s\]: the camera goes round in a minute.
const TIME: f32 = 3.0;

/// Draws all; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    let format = press.context.radiance_format();
    let of_paper = (paper(press, 128), Sampling::Random { seed: 1 });
    let best = (Options::best(format), Sampling::Even);
    let five = row(press, "figure-5.png", 1024, of_paper)?;
    let default = row(press, "figure-5-default.png", 4096, best)?;
    let eight = row(press, "figure-8.png", 512, of_paper)?;
    Ok(format!(
        "{five}Figure 5: 1024 particles, 128 directions by the paper's method, {BETWEEN} frames apart on the orbit; \
         both lights turn by {TURN}° a frame, one step a frame from the solution of the frame before.\n\n\
         {default}The same by the default of 4096 particles.\n\n\
         {eight}Figure 8: 512 particles by the paper's method.\n\n"
    ))
}

fn row(
    press: &Press<'_>,
    file: &str,
    count: u32,
    (options, sampling): (Options, Sampling),
) -> Result<String, Failure> {
    press.progress.doing(file);
    let scene = built("cloud")?;
    let (width, height) = press.timed_size;
    let mut still = scene.at(0.0);
    let size = (2 * width, 2 * height);
    let mut lab = Lab::new(press.context, &scene, &particles(&scene, count, sampling)?, &options, size)?;
    let first = lab.draw(FIRST, RESIDUAL, true)?;
    let exposure = first.image.auto_exposure();
    let mut pictures = vec![Picture::of(&first.image, exposure)];
    let mut times = Vec::new();
    while pictures.len() < 4 {
        for frame in 1..=BETWEEN {
            turn(&mut still, TURN);
            let time = TIME * times.len() as f32;
            lab.scene = scene.at(time);
            lab.scene.lights = still.lights.clone();
            let drawn = lab.draw(1, 0.0, true)?;
            times.push(drawn.ms);
            if frame == BETWEEN {
                pictures.push(Picture::of(&drawn.image, exposure));
            }
        }
    }
    let mut pictures = pictures.into_iter();
    let four = [(); 4].map(|()| pictures.next().unwrap_or_else(|| Picture::white(1, 1)));
    press.picture(file, Picture::grid(&[four]))?;
    press.progress.step();
    let fps = 1e3 / crate::record::Spread::of(&times).p50;
    Ok(format!("![{file}]({file})\n\n{} frames a second at {}x{}. ", digits(fps), size.0, size.1))
}
