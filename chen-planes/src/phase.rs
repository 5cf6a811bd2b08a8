//! The phase function as a texture.

use common::Phase;

/// Cosine that a texel of `texels` stands for. Half of them look forward, half backward, dense towards both ends
/// where phase functions peak; twin of `phase_texel` in `planes.wgsl`.
pub(crate) fn cosine(texel: u32, texels: u32) -> f64 {
    let u = f64::from(texel) / f64::from(texels - 1);
    let s = 2.0 * u.min(1.0 - u);
    if u < 0.5 { s * s - 1.0 } else { 1.0 - s * s }
}

/// Texels of the phase function, RGB and 1 \[1/sr\].
pub(crate) fn texels(phase: &Phase, texels: u32) -> Vec<[f32; 4]> {
    let value = |texel| phase.eval(cosine(texel, texels)).as_vec3().extend(1.0).to_array();
    (0..texels).map(value).collect()
}

/// Uploads it: `Rgba32Float`, one row.
pub(crate) fn upload(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    phase: &Phase,
    width: u32,
) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width, height: 1, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("chen-planes: phase function"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&texels(phase, width)),
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(16 * width), rows_per_image: None },
        size,
    );
    texture.create_view(&Default::default())
}
