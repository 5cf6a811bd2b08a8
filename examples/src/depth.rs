//! The two ways in which renderers keep depth. A program has one of them; this one has both, to show that either will do.

use glam::Mat4;
use glam::camera::rh::proj::directx;

/// How depth is kept: of the eye and in shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Depth {
    /// 0 at the near plane, 1 at the far one, 24 bits.
    Standard,
    /// 1 at the near plane, 0 infinitely far away, 32-bit floats.
    Reversed,
}

impl Depth {
    /// Format of depth textures.
    pub fn format(self) -> wgpu::TextureFormat {
        match self {
            Self::Standard => wgpu::TextureFormat::Depth24Plus,
            Self::Reversed => wgpu::TextureFormat::Depth32Float,
        }
    }

    /// What textures are cleared to.
    pub fn empty(self) -> f32 {
        match self {
            Self::Standard => 1.0,
            Self::Reversed => 0.0,
        }
    }

    /// Passes what is nearer than what is stored.
    pub fn nearer(self) -> wgpu::CompareFunction {
        match self {
            Self::Standard => wgpu::CompareFunction::Less,
            Self::Reversed => wgpu::CompareFunction::Greater,
        }
    }

    /// A perspective with a vertical field of view \[rad\] and planes \[m\]; reversed depth has no far one.
    pub fn perspective(self, fov_y: f32, aspect: f32, [near, far]: [f32; 2]) -> Mat4 {
        match self {
            Self::Standard => directx::perspective(fov_y, aspect, near, far),
            Self::Reversed => directx::perspective_infinite_reverse(fov_y, aspect, near),
        }
    }

    /// A parallel projection of a square of side `2 half` \[m\], between planes \[m\].
    pub fn parallel(self, half: f32, [near, far]: [f32; 2]) -> Mat4 {
        let [near, far] = match self {
            Self::Standard => [near, far],
            Self::Reversed => [far, near],
        };
        directx::orthographic(-half, half, -half, half, near, far)
    }
}
