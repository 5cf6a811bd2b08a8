//! What can go wrong.

/// Why a renderer can't be made or a frame can't be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting out of its range.
    #[error("option {option} is {value}; expected {expected}")]
    Option {
        /// Which.
        option: &'static str,
        /// As it was given.
        value: String,
        /// What it may be.
        expected: &'static str,
    },
    /// The target can't be added to.
    #[error("biri-ss: {0}")]
    Target(#[from] common::gpu::TargetError),
    /// A light or a casting object that would be drawn wrongly.
    #[error("{what} {index} can't be drawn: {why}")]
    Unsupported {
        /// `light` or `caster`.
        what: &'static str,
        /// Which of the inputs.
        index: usize,
        /// What is not modelled, and what to do.
        why: String,
    },
    /// The device can't hold a buffer.
    #[error("biri-ss: {0}")]
    LimitExceeded(#[from] common::gpu::LimitExceeded),
}
