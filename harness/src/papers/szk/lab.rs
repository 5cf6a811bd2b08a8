//! Clouds on the device, as the figures need them.

use common::Scene;
use szk_network::{Colours, Options, Particles};

use super::super::Press;
pub(super) use crate::clouds::{Frame, Lab, RESIDUAL, particles};
use crate::failure::Failure;
pub(super) use crate::truth::{Off, Truth, relative};

/// The best that we know, in one colour.
pub(super) fn best(press: &Press<'_>, directions: u32) -> Options {
    Options { directions, colours: Colours::Grey, ..Options::best(press.context.radiance_format()) }
}

/// The paper's method.
pub(super) fn paper(press: &Press<'_>, directions: u32) -> Options {
    Options { directions, ..Options::paper(press.context.radiance_format()) }
}

/// A cloud in the size of timed frames.
pub(super) fn lab<'a>(
    press: &'a Press<'a>,
    scene: &Scene,
    particles: &Particles,
    options: &Options,
) -> Result<Lab<'a>, Failure> {
    Lab::new(press.context, scene, particles, options, press.timed_size)
}

/// All that a cloud scatters, in the size of timed frames.
pub(super) fn truth(press: &Press<'_>, scene: &Scene) -> Result<Truth, Failure> {
    Truth::of(scene, press.timed_size, &|share| {
        press.progress.detail(format!("{}: paths, {:.0} %", scene.name, 100.0 * share));
    })
}
