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
    /// The target can't be blended into on this device.
    #[error("billeter-plv can't blend into {format:?} on this device; use Rgba16Float")]
    UnsupportedFormat {
        /// The format asked for.
        format: wgpu::TextureFormat,
    },
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
    /// The device can't hold a buffer or texture.
    #[error(
        "billeter-plv needs {what} of {needed}, the device has {available}; use a smaller shadow map or view"
    )]
    LimitExceeded {
        /// What is too large.
        what: &'static str,
        /// How much.
        needed: u64,
        /// Of how much.
        available: u64,
    },
    /// The view has no pixels.
    #[error("billeter-plv: the view is {width}×{height} pixels; expected at least 1×1")]
    EmptyView {
        /// Width \[pixels\].
        width: u32,
        /// Height \[pixels\].
        height: u32,
    },
}
