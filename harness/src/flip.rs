//! FLIP: how different two pictures look when one flips between them.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild: *FLIP: A
//! Difference Evaluator for Alternating Images*, 2020 (the version for ordinary, tone-mapped
//! pictures). Two pipelines, one for colour and one for edges and points, meet in one number per
//! pixel from 0 (no difference seen) to 1.

use glam::Vec3;
use rayon::prelude::*;

/// Pixels per degree of visual angle: a screen 0.7 m wide, of 3840 pixels, seen from 0.7 m.
pub(crate) const PIXELS_PER_DEGREE: f32 = 67.0;

/// Mean FLIP of two sRGB pictures of one size, three bytes a pixel.
///
/// # Panics
/// When a picture does not have `width * height` pixels.
pub(crate) fn mean_flip(reference: &[u8], test: &[u8], width: usize, height: usize) -> f64 {
    let map = flip_map(reference, test, width, height, PIXELS_PER_DEGREE);
    map.iter().map(|&value| f64::from(value)).sum::<f64>() / map.len().max(1) as f64
}

/// FLIP of every pixel.
fn flip_map(reference: &[u8], test: &[u8], width: usize, height: usize, pixels_per_degree: f32) -> Vec<f32> {
    assert_eq!(reference.len(), width * height * 3, "three bytes a pixel");
    assert_eq!(test.len(), width * height * 3, "three bytes a pixel");
    let [reference, test] = [reference, test].map(|bytes| {
        let pixels = bytes.chunks_exact(3).map(|rgb| ycxcz_from_linear(linear_from_bytes(rgb))).collect();
        Plane { width, height, pixels }
    });

    // Colour: what the eye resolves at this distance, in a space where distances are perceived ones.
    let seen = [&reference, &test].map(|picture| hunt_lab_after_csf(picture, pixels_per_degree));
    let green = hunt_lab_from_linear(Vec3::Y);
    let blue = hunt_lab_from_linear(Vec3::Z);
    let largest = hyab(green, blue).powf(COLOUR_EXPONENT);

    // Features: edges and points, from luminance alone.
    let features = [&reference, &test].map(|picture| features(picture, pixels_per_degree));

    (0..width * height)
        .into_par_iter()
        .map(|i| {
            let colour = squash(hyab(seen[0][i], seen[1][i]).powf(COLOUR_EXPONENT), largest);
            let (edge, point) =
                (features[0][i][0] - features[1][i][0], features[0][i][1] - features[1][i][1]);
            let feature = (edge.abs().max(point.abs()) / 2f32.sqrt()).sqrt().clamp(0.0, 1.0);
            colour.powf(1.0 - feature)
        })
        .collect()
}

/// `q_c` of the paper: compresses large colour differences.
const COLOUR_EXPONENT: f32 = 0.7;

/// Maps colour differences so that the lower 0.4 of their range takes 0.95 of the result's.
fn squash(difference: f32, largest: f32) -> f32 {
    let (knee, at_knee) = (0.4 * largest, 0.95);
    if difference < knee {
        at_knee / knee * difference
    } else {
        at_knee + (difference - knee) / (largest - knee) * (1.0 - at_knee)
    }
}

/// Distance of colours: city block in lightness, Euclidean in the other two.
fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// A picture of three numbers a pixel.
struct Plane {
    width: usize,
    height: usize,
    pixels: Vec<Vec3>,
}

impl Plane {
    /// Convolution with `across(x) down(y)`, each weight applied to all three numbers at once;
    /// the border pixels go on for ever. `across` and `down` have odd lengths.
    fn convolve(&self, across: &[Vec3], down: &[Vec3]) -> Self {
        let rows =
            self.pass(across, |pixels, x, y, offset| pixels[y * self.width + clamped(x, offset, self.width)]);
        rows.pass(down, |pixels, x, y, offset| pixels[clamped(y, offset, self.height) * self.width + x])
    }

    fn pass(&self, weights: &[Vec3], fetch: impl Fn(&[Vec3], usize, usize, isize) -> Vec3 + Sync) -> Self {
        let radius = (weights.len() / 2) as isize;
        let pixels = (0..self.pixels.len())
            .into_par_iter()
            .map(|i| {
                let (x, y) = (i % self.width, i / self.width);
                (-radius..=radius)
                    .zip(weights)
                    .map(|(offset, weight)| *weight * fetch(&self.pixels, x, y, offset))
                    .sum()
            })
            .collect();
        Self { width: self.width, height: self.height, pixels }
    }
}

fn clamped(at: usize, offset: isize, length: usize) -> usize {
    at.saturating_add_signed(offset).min(length - 1)
}

/// The colour pipeline: contrast sensitivity filters, then L*a*b* with the Hunt effect.
fn hunt_lab_after_csf(picture: &Plane, pixels_per_degree: f32) -> Vec<Vec3> {
    // Sensitivity of each opponent channel, as a sum of two Gaussians `a √(π/b) exp(−π² d²/b)` of the
    // distance d in degrees; the second one counts for blue-yellow only.
    const B1: [f32; 3] = [0.0047, 0.0053, 0.04];
    const A2: [f32; 3] = [0.0, 0.0, 13.5];
    const B2: [f32; 3] = [1e-5, 1e-5, 0.025];
    const A1: [f32; 3] = [1.0, 1.0, 34.1];
    let pi = std::f32::consts::PI;
    let radius = (3.0 * (0.04 / (2.0 * pi * pi)).sqrt() * pixels_per_degree).ceil() as isize;
    let kernel = |b: [f32; 3]| -> Vec<Vec3> {
        let weight = |i: isize| {
            let degrees = i as f32 / pixels_per_degree;
            Vec3::from_array(b.map(|b| (-pi * pi * degrees * degrees / b).exp()))
        };
        (-radius..=radius).map(weight).collect()
    };
    let sum = |kernel: &[Vec3]| kernel.iter().copied().sum::<Vec3>();
    let height =
        |a: [f32; 3], b: [f32; 3]| Vec3::from_array(std::array::from_fn(|i| a[i] * (pi / b[i]).sqrt()));
    let (first, second) = (kernel(B1), kernel(B2));
    let (h1, h2) = (height(A1, B1), height(A2, B2));
    let total = h1 * sum(&first) * sum(&first) + h2 * sum(&second) * sum(&second);
    let one = picture.convolve(&first, &first);
    let two = picture.convolve(&second, &second);
    one.pixels
        .par_iter()
        .zip(&two.pixels)
        .map(|(one, two)| {
            let filtered = (h1 * one + h2 * two) / total;
            hunt_lab_from_linear(linear_from_ycxcz(filtered).clamp(Vec3::ZERO, Vec3::ONE))
        })
        .collect()
}

/// The feature pipeline: strength of edges and of points at each pixel.
fn features(picture: &Plane, pixels_per_degree: f32) -> Vec<[f32; 2]> {
    // A feature detector as wide as the eye's, 0.082 degrees.
    let deviation = 0.5 * 0.082 * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as isize;
    let gauss = |x: f32| (-x * x / (2.0 * deviation * deviation)).exp();
    let bell: Vec<f32> = (-radius..=radius).map(|x| gauss(x as f32)).collect();
    let slope: Vec<f32> = (-radius..=radius).map(|x| -(x as f32) * gauss(x as f32)).collect();
    let curvature: Vec<f32> = (-radius..=radius)
        .map(|x| ((x * x) as f32 / (deviation * deviation) - 1.0) * gauss(x as f32))
        .collect();

    // Weights above and below zero sum to +1 and −1, each sign by itself.
    let bell_sum: f32 = bell.iter().sum();
    let balanced = |kernel: &[f32]| -> Vec<f32> {
        let above: f32 = kernel.iter().filter(|w| **w > 0.0).sum::<f32>() * bell_sum;
        let below: f32 = -kernel.iter().filter(|w| **w < 0.0).sum::<f32>() * bell_sum;
        kernel.iter().map(|w| w / if *w > 0.0 { above } else { below }).collect()
    };
    let (slope, curvature) = (balanced(&slope), balanced(&curvature));

    // Luminance in [0, 1] in the first two numbers: one is differentiated across, one down.
    let luminance = picture.pixels.iter().map(|p| Vec3::splat((p.x + 16.0) / 116.0)).collect();
    let plane = Plane { width: picture.width, height: picture.height, pixels: luminance };
    let mixed = |across: &[f32], down: &[f32]| -> Vec<Vec3> {
        across.iter().zip(down).map(|(a, b)| Vec3::new(*a, *b, 0.0)).collect()
    };
    let edges = plane.convolve(&mixed(&slope, &bell), &mixed(&bell, &slope));
    let points = plane.convolve(&mixed(&curvature, &bell), &mixed(&bell, &curvature));
    edges.pixels.iter().zip(&points.pixels).map(|(e, p)| [e.length(), p.length()]).collect()
}

// --- Colour spaces -------------------------------------------------------------------------------

fn linear_from_bytes(rgb: &[u8]) -> Vec3 {
    let linear = |byte: u8| common::image::linear_from_srgb(f32::from(byte) / 255.0);
    Vec3::new(linear(rgb[0]), linear(rgb[1]), linear(rgb[2]))
}

/// Rows of XYZ from linear sRGB (BT.709 primaries, white point D65).
const XYZ_FROM_LINEAR: [Vec3; 3] = [
    Vec3::new(0.412_390_8, 0.357_584_34, 0.180_480_8),
    Vec3::new(0.212_639, 0.715_168_7, 0.072_192_32),
    Vec3::new(0.019_330_82, 0.119_194_78, 0.950_532_1),
];

/// XYZ relative to white.
fn relative_xyz(linear: Vec3) -> Vec3 {
    let row = |row: Vec3| row.dot(linear) / row.element_sum();
    Vec3::from_array(XYZ_FROM_LINEAR.map(row))
}

fn linear_from_relative_xyz(relative: Vec3) -> Vec3 {
    let rows = XYZ_FROM_LINEAR.map(|row| row / row.element_sum());
    glam::Mat3::from_cols(rows[0], rows[1], rows[2]).transpose().inverse() * relative
}

/// The linear opponent space in which the eye's filters work.
fn ycxcz_from_linear(linear: Vec3) -> Vec3 {
    let xyz = relative_xyz(linear);
    Vec3::new(116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z))
}

fn linear_from_ycxcz(ycxcz: Vec3) -> Vec3 {
    let y = (ycxcz.x + 16.0) / 116.0;
    linear_from_relative_xyz(Vec3::new(ycxcz.y / 500.0 + y, y, y - ycxcz.z / 200.0))
}

/// L*a*b* with colourfulness scaled by lightness (the Hunt effect).
fn hunt_lab_from_linear(linear: Vec3) -> Vec3 {
    let f = |t: f32| {
        let delta = 6f32 / 29.0;
        if t > delta.powi(3) { t.cbrt() } else { t / (3.0 * delta * delta) + 4.0 / 29.0 }
    };
    let xyz = relative_xyz(linear);
    let (x, y, z) = (f(xyz.x), f(xyz.y), f(xyz.z));
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    Vec3::new(lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pictures of waves, the second one changed in one of three ways.
    fn waves(width: usize, height: usize, change: u32) -> [Vec<u8>; 2] {
        let mut pair = [Vec::new(), Vec::new()];
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let wave = |rate: f32, shift: f32| {
                (127.5 + 120.0 * (x as f32 * rate + y as f32 * 0.13 + shift).sin()) as u8
            };
            let a = [wave(0.21, 0.0), wave(0.05, 1.0), wave(0.6, 2.0)];
            let b = match change {
                0 => a,
                1 => [wave(0.21, 0.3), wave(0.05, 1.2), wave(0.61, 2.0)],
                2 if (x / 5 + y / 7) % 4 == 0 => [255 - a[0], a[1], a[2] / 2],
                2 => a,
                _ => a.map(|byte| (f32::from(byte) * 0.97) as u8),
            };
            pair[0].extend(a);
            pair[1].extend(b);
        }
        pair
    }

    /// Values of the authors' own program (NVIDIA's C++, by the crate nv-flip 0.1.2) for the same bytes.
    #[test]
    fn agrees_with_the_authors_program() {
        for (change, width, height, expected) in [
            (0, 96, 64, 0.0),
            (1, 96, 64, 0.388_471),
            (1, 31, 47, 0.366_191),
            (2, 96, 64, 0.346_490),
            (2, 31, 47, 0.369_959),
            (3, 96, 64, 0.163_468),
            (3, 31, 47, 0.165_616),
        ] {
            let [reference, test] = waves(width, height, change);
            let ours = mean_flip(&reference, &test, width, height);
            assert!(
                (ours - expected).abs() < 2e-5,
                "{change}, {width}x{height}: {ours}, expected {expected}"
            );
        }
    }
}
