//! Finding a device. Hardware comes first; a software adapter is used where there is nothing else and
//! is named as such.

use std::sync::{Arc, Mutex};

use thiserror::Error;

/// A device with its queue, and what it is.
pub struct Context {
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// What the adapter was found by, which makes surfaces of windows.
    pub instance: wgpu::Instance,
    /// The adapter that the device is of.
    pub gpu: wgpu::Adapter,
    /// Adapter name, as the driver gives it.
    pub adapter: String,
    /// Driver and its version.
    pub driver: String,
    /// True where the adapter is a processor pretending to be a GPU.
    pub software: bool,
    errors: Arc<Mutex<Vec<String>>>,
}

/// What to ask for.
#[derive(Clone, Debug, Default)]
pub struct ContextOptions {
    /// Take the first adapter whose name contains this (any case); `None` takes the best.
    pub adapter: Option<String>,
}

/// Why there is no device.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ContextError {
    /// No adapter at all.
    #[error(
        "no graphics adapter was found: install a Vulkan driver (Debian and Ubuntu: \
         mesa-vulkan-drivers and libvulkan1; Fedora: mesa-vulkan-drivers and vulkan-loader; \
         Arch: vulkan-swrast), Metal or Direct3D 12"
    )]
    NoAdapter,
    /// None of the wanted name.
    #[error("no graphics adapter is named like '{wanted}'; there are: {available}")]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// What is there.
        available: String,
    },
    /// The adapter gave no device.
    #[error("the adapter '{adapter}' gave no device: {source}")]
    NoDevice {
        /// Adapter name.
        adapter: String,
        /// What the driver said.
        source: wgpu::RequestDeviceError,
    },
}

impl Context {
    /// Features that are used where the adapter has them; nothing depends on one.
    pub const WANTED: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY
        .union(wgpu::Features::FLOAT32_BLENDABLE)
        .union(wgpu::Features::FLOAT32_FILTERABLE);

    /// Opens the best adapter: discrete, integrated, virtual, then software.
    ///
    /// # Errors
    /// Without an adapter (a software driver counts as one), with none of the name asked for, or if it gives no device.
    pub fn new(options: &ContextOptions) -> Result<Self, ContextError> {
        pollster::block_on(Self::open(options))
    }

    async fn open(options: &ContextOptions) -> Result<Self, ContextError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let mut adapters = instance.enumerate_adapters(wgpu::Backends::PRIMARY).await;
        let rank = |adapter: &wgpu::Adapter| match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        };
        adapters.sort_by_key(rank);
        if adapters.is_empty() {
            return Err(ContextError::NoAdapter);
        }
        if let Some(wanted) = &options.adapter {
            let names: Vec<String> = adapters.iter().map(|adapter| adapter.get_info().name).collect();
            adapters.retain(|a| a.get_info().name.to_lowercase().contains(&wanted.to_lowercase()));
            if adapters.is_empty() {
                let (wanted, available) = (wanted.clone(), names.join(", "));
                return Err(ContextError::NoSuchAdapter { wanted, available });
            }
        }
        let adapter = adapters.swap_remove(0);
        let info = adapter.get_info();
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor {
                label: Some("common: device"),
                required_features: adapter.features() & Self::WANTED,
                required_limits: adapter.limits(),
                ..Default::default()
            })
            .await
            .map_err(|source| ContextError::NoDevice { adapter: info.name.clone(), source })?;

        // An error that nobody waits for is kept, so that a program can end with a sentence.
        let errors = Arc::new(Mutex::new(Vec::new()));
        let kept = Arc::clone(&errors);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if let Ok(mut errors) = kept.lock() {
                errors.push(error.to_string());
            }
        }));
        let lost = Arc::clone(&errors);
        device.set_device_lost_callback(move |reason, message| {
            // Dropping the device is not an accident.
            if reason != wgpu::DeviceLostReason::Destroyed
                && let Ok(mut errors) = lost.lock()
            {
                errors.push(format!("the device was lost: {message}"));
            }
        });
        Ok(Self {
            device,
            queue,
            instance,
            gpu: adapter,
            adapter: info.name,
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            software: info.device_type == wgpu::DeviceType::Cpu,
            errors,
        })
    }

    /// What went wrong on the device since the last call, if anything.
    pub fn take_error(&self) -> Option<String> {
        let mut errors = self.errors.lock().ok()?;
        (!errors.is_empty()).then(|| errors.drain(..).next()).flatten()
    }

    /// Whether 32-bit float targets can be blended into.
    pub fn blends_f32(&self) -> bool {
        self.device.features().contains(wgpu::Features::FLOAT32_BLENDABLE)
    }

    /// The most exact format of radiance that can be blended into here.
    pub fn radiance_format(&self) -> wgpu::TextureFormat {
        if self.blends_f32() { wgpu::TextureFormat::Rgba32Float } else { wgpu::TextureFormat::Rgba16Float }
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// When the device was lost, or had an error that nobody has taken yet.
    pub fn wait(&self) -> Result<(), String> {
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| format!("waiting for the device failed: {error}"))?;
        self.take_error().map_or(Ok(()), Err)
    }
}
