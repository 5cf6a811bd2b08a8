//! Buffers that may ask for more than the device has.

use thiserror::Error;

/// More than a buffer of the device can hold.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("buffer `{label}` needs {needed} bytes, but the device has {available}")]
pub struct LimitExceeded {
    /// Which buffer.
    pub label: String,
    /// How much it takes \[bytes\].
    pub needed: u64,
    /// How much there may be \[bytes\].
    pub available: u64,
}

/// Most bytes of a buffer.
fn limit(device: &wgpu::Device, usage: wgpu::BufferUsages) -> u64 {
    let limits = device.limits();
    let bound = usage.contains(wgpu::BufferUsages::STORAGE);
    let bound = if bound { limits.max_storage_buffer_binding_size } else { u64::MAX };
    limits.max_buffer_size.min(bound)
}

/// A buffer of `size` bytes; for storage, small enough to be bound whole.
///
/// # Errors
/// Where the device has no room for so large a buffer.
pub fn make_buffer(
    device: &wgpu::Device,
    label: &str,
    size: u64,
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, LimitExceeded> {
    let available = limit(device, usage);
    if size > available {
        return Err(LimitExceeded { label: label.into(), needed: size, available });
    }
    let label = Some(label);
    Ok(device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false }))
}

/// Writes `data` into a buffer with room for at least one element, a new one if it has grown; says whether it is
/// a new one. An element takes a multiple of four bytes.
///
/// # Errors
/// Where the device has no room for so large a buffer.
pub fn fill_buffer<T: bytemuck::Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &mut Option<wgpu::Buffer>,
    label: &str,
    usage: wgpu::BufferUsages,
    data: &[T],
) -> Result<bool, LimitExceeded> {
    let needed = size_of_val(data).max(size_of::<T>()) as u64;
    let fits = buffer.as_ref().is_some_and(|buffer| buffer.size() >= needed);
    if !fits {
        // Room to grow, so that what moves does not ask for a new one every frame.
        let roomy = (needed + needed / 2).next_multiple_of(16).min(limit(device, usage));
        *buffer = Some(make_buffer(device, label, roomy.max(needed), usage | wgpu::BufferUsages::COPY_DST)?);
    }
    if let Some(buffer) = buffer {
        queue.write_buffer(buffer, 0, bytemuck::cast_slice(data));
    }
    Ok(!fits)
}
