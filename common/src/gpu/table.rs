//! Tables as textures.

use crate::table::Table2;

/// How many bits a table's samples are stored in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TableFormat {
    /// `R32Float`.
    F32,
    /// `R16Float`: half the memory; values below 6e-8 become 0 and those below 6e-5 lose digits.
    F16,
}

/// Uploads tables of one size as the layers of a texture array, to be read by WGSL `table_lookup`.
///
/// # Panics
/// Without a table, or with tables of different sizes.
pub fn upload_tables(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    tables: &[&Table2],
    format: TableFormat,
) -> wgpu::TextureView {
    let [width, height] = tables[0].size().map(|n| n as u32);
    assert!(tables.iter().all(|table| table.size() == tables[0].size()), "tables of one size");
    let size = wgpu::Extent3d { width, height, depth_or_array_layers: tables.len() as u32 };
    let samples: Vec<f32> = tables.iter().flat_map(|table| table.to_f32()).collect();
    let (texture_format, texel, bytes): (_, u32, Vec<u8>) = match format {
        TableFormat::F32 => (wgpu::TextureFormat::R32Float, 4, bytemuck::cast_slice(&samples).to_vec()),
        TableFormat::F16 => {
            let halves = samples.iter().flat_map(|&sample| half::f16::from_f32(sample).to_le_bytes());
            (wgpu::TextureFormat::R16Float, 2, halves.collect())
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
    queue.write_texture(
        texture.as_image_copy(),
        &bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(texel * width),
            rows_per_image: Some(height),
        },
        size,
    );
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}
