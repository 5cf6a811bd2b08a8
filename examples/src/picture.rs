//! Pictures on the CPU: radiance to be checked, and a PNG file.

use std::path::Path;

use anyhow::{Context, Result};
use glam::Vec3;

use crate::engine::Engine;
use crate::gpu::Gpu;
use crate::passes::{texture, tone_pipeline};

/// Linear radiance \[W m⁻² sr⁻¹\], row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height \[pixels\].
    pub size: [u32; 2],
    /// RGB.
    pub pixels: Vec<Vec3>,
}

impl Picture {
    /// What the engine has drawn last.
    pub fn of(gpu: &Gpu, engine: &Engine) -> Result<Self> {
        let radiance = engine.radiance();
        let wide = radiance.format() == wgpu::TextureFormat::Rgba32Float;
        let number = |bytes: &[u8]| match *bytes {
            [a, b, c, d] => f32::from_le_bytes([a, b, c, d]),
            [a, b] => half::f16::from_le_bytes([a, b]).to_f32(),
            _ => f32::NAN,
        };
        let bytes = read(gpu, radiance, if wide { 16 } else { 8 })?;
        let width = if wide { 4 } else { 2 };
        let numbers: Vec<f32> = bytes.chunks_exact(width).map(number).collect();
        let pixels = numbers.chunks_exact(4).map(|rgba| Vec3::new(rgba[0], rgba[1], rgba[2])).collect();
        Ok(Self { size: engine.size(), pixels })
    }

    /// Mean radiance over all pixels and colours \[W m⁻² sr⁻¹\].
    pub fn mean(&self) -> f32 {
        let sum: f64 = self.pixels.iter().map(|pixel| f64::from(pixel.element_sum())).sum();
        (sum / (3 * self.pixels.len()) as f64) as f32
    }

    /// Whether every pixel is a finite number, and none is negative.
    pub fn is_sane(&self) -> bool {
        self.pixels.iter().all(|pixel| pixel.is_finite() && pixel.min_element() >= 0.0)
    }

    /// Root mean square and largest difference of pixels, over the mean radiance of this picture.
    ///
    /// # Panics
    /// When the pictures have different sizes.
    pub fn difference(&self, other: &Self) -> [f32; 2] {
        assert_eq!(self.size, other.size, "pictures of one size");
        let pairs = self.pixels.iter().zip(&other.pixels);
        let apart = pairs.map(|(a, b)| (*a - *b).abs());
        let (sum, most) = apart.fold((0.0, 0.0f32), |(sum, most), apart| {
            (sum + f64::from(apart.length_squared()), most.max(apart.max_element()))
        });
        let rms = (sum / (3 * self.pixels.len()) as f64).sqrt() as f32;
        [rms / self.mean(), most / self.mean()]
    }

    /// Largest difference of a number in two pictures of one size, as a share of the number; of what is next to black, of
    /// a hundredth of the mean.
    pub fn relative_difference(&self, other: &Self) -> f32 {
        let least = 1e-2 * self.mean();
        let share = |(a, b): (&Vec3, &Vec3)| ((*a - *b).abs() / a.max(Vec3::splat(least))).max_element();
        self.pixels.iter().zip(&other.pixels).map(share).fold(0.0, f32::max)
    }
}

/// Writes what the engine has drawn last, as a screen would show it.
pub fn write_png(gpu: &Gpu, engine: &Engine, path: &Path) -> Result<()> {
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let shown = texture(&gpu.device, "shown", engine.size(), format, wgpu::TextureUsages::COPY_SRC);
    engine.show(&tone_pipeline(&gpu.device, format), &shown.create_view(&Default::default()));
    let [width, height] = engine.size();
    let bytes = read(gpu, &shown, 4)?;
    image::save_buffer(path, &bytes, width, height, image::ExtendedColorType::Rgba8)
        .with_context(|| format!("can't write {}", path.display()))
}

/// The bytes of a texture of usage `COPY_SRC`, `texel` for each texel.
fn read(gpu: &Gpu, texture: &wgpu::Texture, texel: u32) -> Result<Vec<u8>> {
    let (width, height) = (texel * texture.width(), texture.height());
    let row = width.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("read-back"),
        size: u64::from(row * height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    gpu.queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |_| {});
    gpu.device.poll(wgpu::PollType::wait_indefinitely()).context("the device was lost")?;
    let mapped = buffer.get_mapped_range(..).context("the device was lost")?;
    Ok(mapped.chunks_exact(row as usize).flat_map(|line| &line[..width as usize]).copied().collect())
}
