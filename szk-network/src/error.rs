//! What can go wrong, each with what to do about it, and what works but not well.

use std::fmt;
use std::path::PathBuf;

use thiserror::Error;

/// Why a renderer can't be made, a cloud can't be taken or a frame can't be prepared.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// Nothing can be drawn into the target.
    #[error("szk-network: {0}")]
    Target(#[from] common::gpu::TargetError),
    /// An option is out of its range.
    #[error("szk-network: {option} is {value}; expected {expected}")]
    Option {
        /// Which option.
        option: &'static str,
        /// Its value.
        value: String,
        /// Its range.
        expected: &'static str,
    },
    /// Something is wrong with the cloud.
    #[error("szk-network: the cloud {problem}")]
    Cloud {
        /// One clause.
        problem: String,
    },
    /// A file of particles is unusable.
    #[error("szk-network: {}: {problem}", path.display())]
    File {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
    /// The iteration would not converge: light would grow from step to step.
    #[error(
        "szk-network: light would grow by up to {gain:.3} in a step (albedo {albedo:.3}, sums of the phase matrix up \
         to {sums:.3}); switch `conserving` on, or use more or even directions"
    )]
    Diverges {
        /// Albedo times the largest sum.
        gain: f64,
        /// The largest albedo.
        albedo: f64,
        /// The largest sum of a column.
        sums: f64,
    },
    /// The device can't hold the network.
    #[error("szk-network: {0}; use fewer particles or directions, or one colour")]
    LimitExceeded(#[from] common::gpu::LimitExceeded),
    /// A light or the sky is coloured, the network is not.
    #[error("szk-network: {what} is coloured, but the network has one colour; set `colours` to `Rgb`")]
    Coloured {
        /// What is.
        what: &'static str,
    },
    /// There is no cloud yet, or another number of particles than there was.
    #[error("szk-network: {found} particles, but the network was made for {expected}; load the cloud anew")]
    Count {
        /// As given.
        found: usize,
        /// As loaded.
        expected: usize,
    },
    /// The sky can't be used.
    #[error("szk-network: the sky {problem}")]
    Sky {
        /// One clause.
        problem: String,
    },
}

/// What works, but not well.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The paper's rule `M² ≤ D (Rτ)²/π` is broken: the window is finer than the directions tell apart.
    WindowFinerThanDirections {
        /// Side of the window \[pixels\].
        window: u32,
        /// The largest that the rule allows.
        most: u32,
    },
    /// Most links pass most of the medium by: the mean optical depth of a particle in its pixel is above 1.
    LinksTooLong {
        /// Mean optical depth of a particle in its pixel.
        depth: f32,
        /// Side of the window \[pixels\].
        window: u32,
        /// Where it would be 1.
        most: u32,
    },
    /// Particles of one pixel are linked that don't face each other.
    PixelsTooWide {
        /// Side of a pixel in mean free paths.
        width: f32,
    },
    /// The phase function has a peak that the directions can't tell.
    PeakTooNarrow {
        /// Mean cosine between the directions.
        found: f64,
        /// Mean cosine of the phase function.
        wanted: f64,
    },
    /// The phase function has a peak that is narrower than the directions are apart: light goes in stars.
    PeakBetweenDirections {
        /// Mean cosine of the lobe.
        mean_cosine: f64,
        /// The largest, of either sign, that the directions tell.
        most: f64,
    },
    /// Light is scattered on the way from particle to particle.
    ParticlesTooFar {
        /// Mean diameter of the balls that particles stand for, in mean free paths.
        apart: f32,
        /// What it should be at most.
        most: f32,
    },
    /// A light is so near to particles that what it sends them differs from one to the next.
    LightTooNear {
        /// Which of the inputs.
        light: usize,
        /// To the nearest particle \[m\].
        distance: f32,
        /// What it should be at least \[m\].
        least: f32,
    },
    /// The eye is among the particles, where light is too bright.
    EyeTooNear {
        /// To the nearest particle \[m\].
        distance: f32,
        /// What it should be at least \[m\].
        least: f32,
    },
}

impl Warning {
    /// Mean free paths between particles that go well.
    pub(crate) const MOST_APART: f32 = 2.2;
    /// Sizes of particles that a light and the eye should be away from the nearest one.
    pub(crate) const LEAST_TO_LIGHT: f32 = 5.0;
    pub(crate) const LEAST_TO_EYE: f32 = 1.0;
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::WindowFinerThanDirections { window, most } => write!(
                f,
                "the window has {window}² pixels, more than {most}², which the directions tell apart; use more \
                 directions or a coarser window"
            ),
            Self::LinksTooLong { depth, window, most } => write!(
                f,
                "links pass {depth:.2} optical depths of medium by, because the window has {window}² pixels; use more \
                 particles or at most {most}² pixels"
            ),
            Self::PixelsTooWide { width } => write!(
                f,
                "a pixel of the window is {width:.1} mean free paths wide, so that light is carried sideways; use \
                 more particles or a finer window"
            ),
            Self::PeakTooNarrow { found, wanted } => write!(
                f,
                "the mean cosine between the directions is {found:.3}, that of the phase function {wanted:.3}; use \
                 more directions"
            ),
            Self::PeakBetweenDirections { mean_cosine, most } => write!(
                f,
                "the phase function has a peak of mean cosine {mean_cosine:.3}, narrower than the directions, which tell \
                 at most {most:.3}; use more directions"
            ),
            Self::ParticlesTooFar { apart, most } => write!(
                f,
                "the particles stand for {apart:.1} mean free paths of medium each, more than {most}, so that the cloud \
                 comes out too dark; use more particles"
            ),
            Self::LightTooNear { light, distance, least } => write!(
                f,
                "light {light} is {distance:.3} m from a particle, less than {least:.3} m, so that its spot on the \
                 cloud is too blurred; use more particles or move it away"
            ),
            Self::EyeTooNear { distance, least } => write!(
                f,
                "the eye is {distance:.3} m from a particle, less than {least:.3} m: within the cloud pictures are too \
                 bright; use more particles or move it away"
            ),
        }
    }
}
