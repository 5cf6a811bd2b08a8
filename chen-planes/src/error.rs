//! What can go wrong, each with what to do about it.

use thiserror::Error;

/// Why a renderer can't be made or a frame can't be prepared.
#[derive(Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// Nothing can be added to the target.
    #[error("chen-planes: {0}")]
    Target(#[from] common::gpu::TargetError),
    /// An option is out of its range.
    #[error("chen-planes: {option} is {value}; expected {expected}")]
    Option {
        /// Which option.
        option: &'static str,
        /// Its value.
        value: String,
        /// Its range.
        expected: &'static str,
    },
    /// Planes have nowhere to be.
    #[error("chen-planes: the reach is {reach} m; expected a finite number above the near plane's {near} m")]
    Reach {
        /// As it was given \[m\].
        reach: f32,
        /// The view's near plane \[m\].
        near: f32,
    },
    /// The device can't hold the planes of so many lights.
    #[error("chen-planes: {0}; use fewer planes")]
    LimitExceeded(#[from] common::gpu::LimitExceeded),
}
