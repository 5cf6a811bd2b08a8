//! What can go wrong, each with what to do about it.

use thiserror::Error;

/// Why a renderer can't be made or a frame can't be prepared.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The technique has no model of what this light does; it is refused rather than drawn wrongly.
    #[error("billeter-plv can't draw light {light}: {what}")]
    Unsupported {
        /// Index into `Inputs::lights`.
        light: usize,
        /// Which feature of the light, and what to do.
        what: &'static str,
    },
    /// The target can't be added to.
    #[error("billeter-plv: {0}")]
    Target(#[from] common::gpu::TargetError),
    /// An option is out of its range.
    #[error("billeter-plv: {option} is {value}; expected {expected}")]
    Option {
        /// Which option.
        option: &'static str,
        /// Its value.
        value: String,
        /// Its range.
        expected: &'static str,
    },
    /// The device can't hold a buffer.
    #[error("billeter-plv: {0}; use a smaller shadow map")]
    LimitExceeded(#[from] common::gpu::LimitExceeded),
}
