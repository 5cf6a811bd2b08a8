//! Where a technique adds up, and how the sum gets to the caller's target.

use thiserror::Error;

use super::PassTimer;
use super::passes::{AdditivePipeline, Attachments, begin_pass, bind_group, drawn_texture, shader_module};
use crate::shader::{ADD, FULLSCREEN, compose};

/// What contributions are added up in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Accumulation {
    /// `Rgba16Float`: blends everywhere, but loses digits where many contributions overlap.
    F16,
    /// `Rgba32Float` where the device blends it, else as [`Accumulation::F16`].
    F32,
}

/// Why nothing can be added to a target.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum TargetError {
    /// The target can't be blended into.
    #[error(
        "a target of {format:?} can't be added to here; expected Rgba16Float, or Rgba32Float where the device \
         has FLOAT32_BLENDABLE"
    )]
    UnsupportedFormat {
        /// The format asked for.
        format: wgpu::TextureFormat,
    },
    /// A view without pixels.
    #[error("the view has {width}×{height} pixels; expected at least one each way")]
    EmptyView {
        /// Width \[pixels\].
        width: u32,
        /// Height \[pixels\].
        height: u32,
    },
    /// A view that is too large.
    #[error("a texture side needs {needed}, but the device has {available}")]
    TooLarge {
        /// Longer side of the view \[pixels\].
        needed: u32,
        /// Longest that the device has.
        available: u32,
    },
}

/// A texture of the view's size that contributions are blended into, and the pass that adds it to a target.
pub struct Accumulator {
    format: wgpu::TextureFormat,
    add: wgpu::RenderPipeline,
    sized: Option<Sized>,
}

struct Sized {
    view: wgpu::TextureView,
    group: wgpu::BindGroup,
    size: (u32, u32),
}

impl Accumulator {
    /// For targets of `target_format`; with `clamp_negative` a sum below zero is taken for zero.
    ///
    /// # Errors
    /// [`TargetError::UnsupportedFormat`].
    pub fn new(
        device: &wgpu::Device,
        target_format: wgpu::TextureFormat,
        accumulation: Accumulation,
        clamp_negative: bool,
    ) -> Result<Self, TargetError> {
        use wgpu::TextureFormat::{Rgba16Float, Rgba32Float};
        Self::check_format(device, target_format)?;
        let blends_f32 = device.features().contains(wgpu::Features::FLOAT32_BLENDABLE);
        let module = shader_module(device, "common: add", Self::shader());
        let add = AdditivePipeline {
            layout: None,
            module: &module,
            entries: ["vs_fullscreen", "fs_add"],
            constants: &[("clamp_negative", f64::from(u8::from(clamp_negative)))],
            topology: wgpu::PrimitiveTopology::TriangleList,
            buffers: &[],
            depth_stencil: None,
            target: Some(target_format),
            adds: true,
        };
        let format = if accumulation == Accumulation::F32 && blends_f32 { Rgba32Float } else { Rgba16Float };
        Ok(Self { format, add: add.build(device), sized: None })
    }

    /// An error for a target that can't be added to.
    ///
    /// # Errors
    /// [`TargetError::UnsupportedFormat`].
    pub fn check_format(device: &wgpu::Device, format: wgpu::TextureFormat) -> Result<(), TargetError> {
        use wgpu::TextureFormat::{Rgba16Float, Rgba32Float};
        let blends_f32 = device.features().contains(wgpu::Features::FLOAT32_BLENDABLE);
        if format == Rgba16Float || format == Rgba32Float && blends_f32 {
            return Ok(());
        }
        Err(TargetError::UnsupportedFormat { format })
    }

    /// The WGSL of the adding pass, composed: for validation without a GPU.
    pub fn shader() -> String {
        compose(&[FULLSCREEN, ADD])
    }

    /// Format that contributions are blended in.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// Whether it has been given this size \[pixels\].
    pub fn has_size(&self, size: (u32, u32)) -> bool {
        self.sized.as_ref().is_some_and(|sized| sized.size == size)
    }

    /// An error for a size \[pixels\] that the device can't hold.
    ///
    /// # Errors
    /// [`TargetError::EmptyView`] and [`TargetError::TooLarge`].
    pub fn check_size(device: &wgpu::Device, (width, height): (u32, u32)) -> Result<(), TargetError> {
        let (needed, available) = (width.max(height), device.limits().max_texture_dimension_2d);
        if width == 0 || height == 0 {
            return Err(TargetError::EmptyView { width, height });
        }
        if needed > available {
            return Err(TargetError::TooLarge { needed, available });
        }
        Ok(())
    }

    /// Allocates the texture for a size \[pixels\].
    pub fn resize(&mut self, device: &wgpu::Device, label: &str, size: (u32, u32)) {
        let texture = drawn_texture(device, label, size, self.format, wgpu::TextureUsages::TEXTURE_BINDING);
        let view = texture.create_view(&Default::default());
        let layout = self.add.get_bind_group_layout(0);
        let group = bind_group(device, label, &layout, [wgpu::BindingResource::TextureView(&view)]);
        self.sized = Some(Sized { view, group, size });
    }

    /// The texture; none before [`Accumulator::resize`].
    pub fn view(&self) -> Option<&wgpu::TextureView> {
        self.sized.as_ref().map(|sized| &sized.view)
    }

    /// A pass that sets it to zero.
    pub fn encode_clear(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        label: &'static str,
        timer: &mut PassTimer,
    ) {
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let color = self.view().map(|view| (view, clear));
        drop(begin_pass(encoder, Attachments { color, depth_stencil: None }, label, timer));
    }

    /// Draws the sum into a pass over the target, where it is added.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(sized) = &self.sized {
            pass.set_pipeline(&self.add);
            pass.set_bind_group(0, &sized.group, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    /// A pass that adds the sum to `target`.
    pub fn encode_add(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        label: &'static str,
        timer: &mut PassTimer,
    ) {
        self.draw(&mut begin_pass(encoder, Attachments::onto(target), label, timer));
    }
}
