//! Uniform blocks, each the twin of a WGSL struct of the same member names and order; the tests hold
//! every member to its WGSL offset.

use encase::internal::WriteInto;
use encase::{ShaderType, UniformBuffer};
use glam::{Mat4, Vec3};

use crate::phase::{Lobe, Phase};
use crate::{Medium, View};

/// A buffer that holds one uniform block of type `T`.
pub struct Uniform<T> {
    /// The buffer; usages UNIFORM and `COPY_DST`.
    pub buffer: wgpu::Buffer,
    block: std::marker::PhantomData<T>,
}

impl<T: ShaderType + WriteInto> Uniform<T> {
    /// Allocates it; its content is zero.
    pub fn new(device: &wgpu::Device, label: &str) -> Self {
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: T::min_size().get(),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self { buffer, block: std::marker::PhantomData }
    }

    /// Writes the block; it is in place at the next submit.
    pub fn write(&self, queue: &wgpu::Queue, block: &T) {
        queue.write_buffer(&self.buffer, 0, &uniform_bytes(block));
    }
}

/// The bytes of a uniform block as the GPU sees it.
pub fn uniform_bytes<T: ShaderType + WriteInto>(block: &T) -> Vec<u8> {
    let mut bytes = UniformBuffer::new(Vec::new());
    bytes.write(block).expect("a vector grows as needed");
    bytes.into_inner()
}

/// Twin of WGSL `View`.
#[derive(Clone, Copy, Debug, ShaderType)]
pub struct ViewUniform {
    /// Projection times view.
    pub clip_from_world: Mat4,
    /// Position of the eye \[m\].
    pub eye: Vec3,
    /// Near plane \[m\].
    pub near: f32,
    /// Half extent of the image plane at distance 1, along x.
    pub right: Vec3,
    /// Width \[pixels\].
    pub width: f32,
    /// Half extent of the image plane at distance 1, along y.
    pub up: Vec3,
    /// Height \[pixels\].
    pub height: f32,
    /// Unit viewing direction.
    pub forward: Vec3,
    /// Scale \[m\] of the scene's depth: [`DepthRange::coefficients`](crate::DepthRange::coefficients).
    pub depth_scale: f32,
    /// Offset of the scene's depth.
    pub depth_offset: f32,
}

impl From<&View> for ViewUniform {
    fn from(view: &View) -> Self {
        let (right, up, forward) = view.camera.basis();
        let half = view.half_extent();
        let [depth_scale, depth_offset] = view.depth.coefficients();
        Self {
            clip_from_world: view.clip_from_world(),
            eye: view.camera.eye,
            near: view.depth.near,
            right: right * half.x,
            width: view.width as f32,
            up: up * half.y,
            height: view.height as f32,
            forward,
            depth_scale,
            depth_offset,
        }
    }
}

/// Twin of WGSL `Lobe`.
#[derive(Clone, Copy, Debug, Default, ShaderType)]
pub struct LobeUniform {
    /// Share, RGB.
    pub weight: Vec3,
    /// Asymmetry.
    pub g: f32,
}

/// Twin of WGSL `Medium`.
#[derive(Clone, Copy, Debug, ShaderType)]
pub struct MediumUniform {
    /// Scattering coefficient, RGB \[1/m\].
    pub sigma_s: Vec3,
    /// Extinction coefficient, RGB \[1/m\].
    pub sigma_t: Vec3,
    /// The lobes of the phase function.
    pub lobes: [LobeUniform; Phase::MAX_LOBES],
}

impl From<&Medium> for MediumUniform {
    fn from(medium: &Medium) -> Self {
        let mut lobes = [LobeUniform::default(); Phase::MAX_LOBES];
        for (slot, (weight, lobe)) in lobes.iter_mut().zip(&medium.phase.lobes) {
            *slot = LobeUniform { weight: *weight, g: lobe_code(lobe).1 };
        }
        Self { sigma_s: medium.sigma_s, sigma_t: medium.sigma_t(), lobes }
    }
}

/// `LOBE_*` of `phase.wgsl` and the asymmetry.
pub fn lobe_code(lobe: &Lobe) -> (u32, f32) {
    match *lobe {
        Lobe::Isotropic => (0, 0.0),
        Lobe::Rayleigh => (1, 0.0),
        Lobe::HenyeyGreenstein { g } => (2, g as f32),
        Lobe::CornetteShanks { g } => (3, g as f32),
        Lobe::MieHazy => (4, 0.0),
        Lobe::MieMurky => (5, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::bench::check_uniform_layout;
    use crate::shader::{MEDIUM, PHASE, VIEW, compose};

    fn sentinel(value: f32) -> Vec3 {
        Vec3::new(value, value + 0.25, value + 0.5)
    }

    #[test]
    fn view_lies_as_wgsl_has_it() {
        let block = ViewUniform {
            clip_from_world: Mat4::from_diagonal(sentinel(1.0).extend(1.0)),
            eye: sentinel(2.0),
            near: 3.0,
            right: sentinel(4.0),
            width: 5.0,
            up: sentinel(6.0),
            height: 7.0,
            forward: sentinel(8.0),
            depth_scale: 9.0,
            depth_offset: 10.0,
        };
        let expect = [
            ("clip_from_world", 1f32),
            ("eye", 2.0),
            ("near", 3.0),
            ("right", 4.0),
            ("width", 5.0),
            ("up", 6.0),
            ("height", 7.0),
            ("forward", 8.0),
            ("depth_scale", 9.0),
            ("depth_offset", 10.0),
        ]
        .map(|(name, value)| (name, value.to_bits()));
        check_uniform_layout(VIEW, "View", &uniform_bytes(&block), &expect).unwrap();
        // The check can fail: two members of one type swapped.
        let mut swapped = expect;
        (swapped[4].1, swapped[6].1) = (swapped[6].1, swapped[4].1);
        assert!(check_uniform_layout(VIEW, "View", &uniform_bytes(&block), &swapped).is_err());
    }

    #[test]
    fn medium_and_lobe_lie_as_wgsl_has_them() {
        let source = compose(&[PHASE, MEDIUM]);
        let lobe = LobeUniform { weight: sentinel(1.0), g: 3.0 };
        let expect = [("weight", 1f32.to_bits()), ("g", 3f32.to_bits())];
        check_uniform_layout(&source, "Lobe", &uniform_bytes(&lobe), &expect).unwrap();
        let medium = MediumUniform { sigma_s: sentinel(4.0), sigma_t: sentinel(6.0), lobes: [lobe; 4] };
        let expect = [("sigma_s", 4f32.to_bits()), ("sigma_t", 6f32.to_bits()), ("lobes", 1f32.to_bits())];
        check_uniform_layout(&source, "Medium", &uniform_bytes(&medium), &expect).unwrap();
    }
}
