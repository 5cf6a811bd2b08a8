//! Tables as textures.

use crate::table::Table2;

/// How many bits a table's samples are stored in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// R32Float.
    F32,
    /// R16Float: half the memory; values below 6e-8 become 0 and those below 6e-5 lose digits.
    F16,
}

/// Uploads a table as a texture, to be read with `textureLoad`, as `table_lookup` does.
pub fn upload_table(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    table: &Table2,
    format: TableFormat,
) -> wgpu::TextureView {
    let [width, height] = table.size().map(|n| n as u32);
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
    let samples = table.to_f32();
    let (texture_format, bytes): (_, Vec<u8>) = match format {
        TableFormat::F32 => (wgpu::TextureFormat::R32Float, bytemuck::cast_slice(&samples).to_vec()),
        TableFormat::F16 => {
            let halves = samples.iter().flat_map(|&sample| half::f16::from_f32(sample).to_le_bytes());
            (wgpu::TextureFormat::R16Float, halves.collect())
        }
    };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: texture_format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let bytes_per_row = Some(bytes.len() as u32 / height);
    queue.write_texture(
        texture.as_image_copy(),
        &bytes,
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row, rows_per_image: None },
        size,
    );
    texture.create_view(&Default::default())
}
