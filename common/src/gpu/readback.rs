//! Bringing buffers and pictures back to the CPU. Blocks; for measuring and tests, not for frames.

use glam::Vec3;

use crate::image::Image;

/// The first `size` bytes of a buffer of usage `COPY_SRC`; `None` where the device is lost.
pub(super) fn read_bytes(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    size: u64,
) -> Option<Vec<u8>> {
    if size == 0 {
        return Some(Vec::new());
    }
    let staging = staging(device, size);
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, size);
    queue.submit([encoder.finish()]);
    map(device, &staging)
}

/// The first `count` 32-bit integers of a buffer; `None` where the device is lost.
pub fn read_u32s(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    count: usize,
) -> Option<Vec<u32>> {
    let bytes = read_bytes(device, queue, buffer, 4 * count as u64)?;
    Some(bytemuck::pod_collect_to_vec(&bytes))
}

/// The first `count` floats of a buffer; `None` where the device is lost.
pub fn read_floats(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    count: usize,
) -> Option<Vec<f32>> {
    let bytes = read_bytes(device, queue, buffer, 4 * count as u64)?;
    Some(bytemuck::pod_collect_to_vec(&bytes))
}

/// A texture of `Rgba32Float` or `Rgba16Float` (usage `COPY_SRC`) as a picture; alpha is dropped. `None`
/// where the device is lost.
///
/// # Panics
/// On any other format.
pub fn read_image(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Option<Image> {
    let (width, height) = (texture.width(), texture.height());
    let texel = match texture.format() {
        wgpu::TextureFormat::Rgba32Float => 16,
        wgpu::TextureFormat::Rgba16Float => 8,
        other => panic!("a picture is read from Rgba32Float or Rgba16Float, not {other:?}"),
    };
    let texels = read_texels(device, queue, texture, texel)?;
    let pixels = texels
        .chunks_exact(texel as usize)
        .map(|bytes| {
            if texel == 16 {
                let f = |i: usize| f32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]);
                Vec3::new(f(0), f(4), f(8))
            } else {
                let f = |i: usize| half::f16::from_le_bytes([bytes[i], bytes[i + 1]]).to_f32();
                Vec3::new(f(0), f(2), f(4))
            }
        })
        .collect();
    Some(Image { width, height, pixels })
}

/// The depths of a texture of `Depth32Float` (usage `COPY_SRC`), row by row from the top; `None` where the device
/// is lost.
///
/// # Panics
/// On any other format.
pub fn read_depth(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Option<Vec<f32>> {
    assert_eq!(texture.format(), wgpu::TextureFormat::Depth32Float, "depths are read from Depth32Float");
    Some(bytemuck::pod_collect_to_vec(&read_texels(device, queue, texture, 4)?))
}

/// The bytes of a texture's texels, `texel` each, without padding.
fn read_texels(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    texel: u32,
) -> Option<Vec<u8>> {
    let (width, height) = (texture.width(), texture.height());
    let row = (width * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let staging = staging(device, u64::from(row * height));
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
        },
        texture.size(),
    );
    queue.submit([encoder.finish()]);
    let bytes = map(device, &staging)?;
    Some(
        bytes
            .chunks_exact(row as usize)
            .flat_map(|line| &line[..(width * texel) as usize])
            .copied()
            .collect(),
    )
}

fn staging(device: &wgpu::Device, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("common: read-back"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn map(device: &wgpu::Device, staging: &wgpu::Buffer) -> Option<Vec<u8>> {
    staging.map_async(wgpu::MapMode::Read, .., |_| {});
    device.poll(wgpu::PollType::wait_indefinitely()).ok()?;
    Some(staging.get_mapped_range(..).ok()?.to_vec())
}
