//! The program's device.

use anyhow::{Context, Result};

/// Device and queue, and the adapter that they are of.
pub struct Gpu {
    /// What draws.
    pub adapter: wgpu::Adapter,
    /// Its device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
}

impl Gpu {
    /// Opens a device without a window.
    pub fn headless() -> Result<Self> {
        Self::open(&wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle()), None)
    }

    /// Opens a device that can draw on `surface`.
    pub fn open(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .context("no graphics adapter was found: install a driver for Vulkan, Metal or Direct3D 12")?;
        // All that techniques ask for: the default limits, and for a 32-bit target that it can be blended into.
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("engine"),
            required_features: adapter.features() & wgpu::Features::FLOAT32_BLENDABLE,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .context("the graphics adapter gave no device")?;
        Ok(Self { adapter, device, queue })
    }
}
