//! The wgpu side: device, scene buffers, shadow maps, depth and surface pass, timing, read-back, and
//! a bench that runs WGSL functions beside their Rust twins.
//!
//! Only [`Context`] creates a device; everything else works on the caller's.

mod accumulator;
pub mod bench;
mod buffers;
mod context;
mod foreign;
mod haze;
pub mod passes;
mod pipelines;
mod readback;
mod scene;
mod shadow;
mod surface;
mod table;
mod timer;
mod uniforms;
mod unshadowed;
mod variant;

pub use accumulator::{Accumulation, Accumulator, TargetError};
pub use buffers::{LimitExceeded, fill_buffer, make_buffer};
pub use context::{Context, ContextError, ContextOptions};
pub use foreign::{ForeignMap, MapError};
pub use readback::{read_depth, read_floats, read_image, read_u32s};
pub use shadow::{
    LightBinding, LightError, LightUniform, Projection, ShadowLayer, coarse_map, light_layout,
    shadow_projection,
};
pub use surface::{DEPTH_FORMAT, Ground, SurfaceData, Targets};
pub use table::{TableFormat, upload_tables};
pub use timer::PassTimer;
pub use uniforms::{LobeUniform, MediumUniform, Uniform, ViewUniform, lobe_code, uniform_bytes};
pub use unshadowed::{Unshadowed, UnshadowedInputs};
pub use variant::Variant;
