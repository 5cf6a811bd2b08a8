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
    /// The target can't be blended into.
    #[error(
        "a target of {format:?} can't be added to here; expected Rgba16Float, or Rgba32Float where the device \
         has FLOAT32_BLENDABLE"
    )]
    UnsupportedFormat {
        /// The format asked for.
        format: wgpu::TextureFormat,
    },
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
    /// A view without pixels.
    #[error("the view has {width}×{height} pixels; expected at least one each way")]
    EmptyView {
        /// Width \[pixels\].
        width: u32,
        /// Height \[pixels\].
        height: u32,
    },
    /// More than the device can hold.
    #[error("{what} needs {needed}, but the device has {available}")]
    LimitExceeded {
        /// What is too large.
        what: &'static str,
        /// How much it takes.
        needed: u64,
        /// How much there is.
        available: u64,
    },
}
