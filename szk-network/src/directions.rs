//! The sample directions, and the window that each direction's particles are projected onto.

use std::f64::consts::{PI, TAU};

use common::random::unit;
use glam::{DVec3, Vec2, Vec3};

/// Which directions light travels in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum DirectionSet {
    /// Evenly spread on a spherical Fibonacci lattice.
    Fibonacci,
    /// Independent and uniform: the paper's.
    Random {
        /// Which of them.
        seed: u64,
    },
}

impl DirectionSet {
    /// `count` unit vectors.
    pub fn directions(self, count: u32) -> Vec<DVec3> {
        let on_sphere = |z: f64, azimuth: f64| {
            let radius = (1.0 - z * z).max(0.0).sqrt();
            DVec3::new(radius * azimuth.cos(), radius * azimuth.sin(), z)
        };
        (0..count)
            .map(|i| match self {
                Self::Fibonacci => {
                    let golden_angle = PI * (3.0 - 5f64.sqrt());
                    on_sphere(
                        1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count),
                        golden_angle * f64::from(i),
                    )
                }
                Self::Random { seed } => {
                    let random =
                        |k| unit(seed.wrapping_mul(0x1_0000_0001).wrapping_add(2 * u64::from(i) + k));
                    on_sphere(1.0 - 2.0 * random(0), TAU * random(1))
                }
            })
            .collect()
    }
}

/// A square window across a direction. Light of one pixel's column goes from particle to particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The way the light travels; unit length.
    pub direction: Vec3,
    /// Unit vectors along the window's sides.
    pub right: Vec3,
    /// See `right`.
    pub up: Vec3,
    /// Place of the window's corner in the first pixel, in [0, 1]².
    pub offset: Vec2,
}

impl Window {
    /// The window of direction number `index`; with `turned` turned and shifted at random, so that no two
    /// directions have their columns alike.
    pub fn new(direction: DVec3, index: u32, turned: bool) -> Self {
        let (right, up) = direction.any_orthonormal_pair();
        let random = |k| unit(0x7769_6e64 + 3 * u64::from(index) + k);
        let (sin, cos) = if turned { (TAU * random(0)).sin_cos() } else { (0.0, 1.0) };
        let offset = if turned { Vec2::new(random(1) as f32, random(2) as f32) } else { Vec2::splat(0.5) };
        Self {
            direction: direction.as_vec3(),
            right: (cos * right + sin * up).as_vec3(),
            up: (cos * up - sin * right).as_vec3(),
            offset,
        }
    }

    /// Sorting key of a place \[in radii of the bounding sphere, from its centre\]: pixel above, depth below. Particles
    /// in order of their keys are columns, each from front to back. Twin of WGSL `column_key`.
    pub fn key(&self, place: Vec3, pixels: u32) -> u32 {
        let bits = pixel_bits(pixels);
        let at = Vec2::new(place.dot(self.right), place.dot(self.up));
        let pixel = (at * 0.5 + 0.5) * pixels as f32 + self.offset;
        let pixel = pixel.floor().clamp(Vec2::ZERO, Vec2::splat(pixels as f32));
        let levels = depth_levels(bits);
        let depth = (place.dot(self.direction) * 0.5 + 0.5).clamp(0.0, 1.0) * (levels - 1.0);
        ((pixel.y as u32 * (pixels + 1) + pixel.x as u32) << (32 - bits)) | depth as u32
    }
}

/// Bits of a key that hold the pixel. One number is left free: the greatest key is nobody's.
pub(crate) fn pixel_bits(pixels: u32) -> u32 {
    let count = (pixels + 1) * (pixels + 1);
    u32::BITS - count.leading_zeros()
}

/// Number of depths that the rest tells apart: no more than f32 does.
pub(crate) fn depth_levels(pixel_bits: u32) -> f32 {
    (1u32 << (32 - pixel_bits).min(22)) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_even_and_random_ones_are_not() {
        let spread = |set: DirectionSet| {
            let directions = set.directions(128);
            assert!(directions.iter().all(|d| (d.length() - 1.0).abs() < 1e-12));
            let nearest = |a: &DVec3| {
                let others = directions.iter().filter(|b| *b != a);
                others.map(|b| a.angle_between(*b)).fold(f64::INFINITY, f64::min)
            };
            let mean: DVec3 = directions.iter().sum::<DVec3>() / 128.0;
            (directions.iter().map(nearest).fold(f64::INFINITY, f64::min), mean.length())
        };
        let (closest, mean) = spread(DirectionSet::Fibonacci);
        assert!(closest > 0.2 && mean < 0.01, "{closest} {mean}");
        let (closest, mean) = spread(DirectionSet::Random { seed: 1 });
        assert!(closest < 0.1 && mean > 0.01, "{closest} {mean}");
        assert_ne!(
            DirectionSet::Random { seed: 1 }.directions(3),
            DirectionSet::Random { seed: 2 }.directions(3)
        );
    }

    #[test]
    fn keys_order_by_pixel_then_depth() {
        let window = Window::new(DVec3::new(0.6, 0.0, 0.8), 3, false);
        for pixels in [1, 2, 16, 63, 64, 1022] {
            let key = |u: f32, v: f32, z: f32| {
                window.key(u * window.right + v * window.up + z * window.direction, pixels)
            };
            let inside = 0.9 / pixels as f32;
            assert!(key(0.0, 0.0, -0.5) < key(0.1 * inside, 0.0, 0.5), "{pixels}");
            if pixels > 1 {
                // One pixel is 2/M wide; the offset puts the middle of a pixel at 0 for an even number of them.
                let next = if pixels % 2 == 0 { 1.2 } else { 2.2 } / pixels as f32;
                let [a, b] =
                    [key(0.0, 0.0, 1.0), key(next, 0.0, -1.0)].map(|k| k >> (32 - pixel_bits(pixels)));
                assert_eq!(a + 1, b, "{pixels}");
            }
            for corner in [-1.0, 1.0] {
                assert_ne!(key(corner, 0.0, 1.0), u32::MAX);
                assert_ne!(key(0.0, corner, 1.0), u32::MAX);
            }
        }
    }
}
