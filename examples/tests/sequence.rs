//! The program's sequence, small: every technique comes and goes, and no convention of the renderer's makes a difference.

use std::sync::OnceLock;

use engine_example::checks::{BITS, Checks, DEPTH};
use engine_example::depth::Depth;
use engine_example::engine::Settings;
use engine_example::gpu::Gpu;
use engine_example::picture::Picture;
use engine_example::sequence::{Pictures, draw};
use glam::Vec3;

const SIZE: [u32; 2] = [96, 60];

const SETTINGS: Settings =
    Settings { depth: Depth::Standard, radiance: wgpu::TextureFormat::Rgba16Float, shadow_size: 512 };

fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::headless().unwrap())
}

/// The sequence and its figures; both are made once.
fn sequence() -> &'static (Pictures, Checks) {
    static SEQUENCE: OnceLock<(Pictures, Checks)> = OnceLock::new();
    SEQUENCE.get_or_init(|| {
        let (_, pictures) = draw(gpu(), SETTINGS, SIZE, 2).unwrap();
        let checks = Checks::new(gpu(), SETTINGS, SIZE, 2, &pictures).unwrap();
        println!("{checks}");
        (pictures, checks)
    })
}

#[test]
fn every_pixel_is_finite() {
    assert!(sequence().1.sane);
    let mut broken = sequence().0.both.clone();
    broken.pixels[7].y = f32::NAN;
    assert!(!broken.is_sane());
}

#[test]
fn standard_and_reversed_depth_draw_the_same() {
    let [rms, most] = sequence().1.depth;
    assert!(rms < DEPTH[0] && most < DEPTH[1], "{rms} {most}");
    assert!(most > 0.0, "they were drawn apart");
}

#[test]
fn sixteen_and_thirty_two_bits_differ_by_rounding() {
    let Some(bits) = sequence().1.bits else { return };
    assert!(bits < BITS, "{bits}");
    assert!(bits > 1.0 / 65536.0, "they were drawn apart: {bits}");
}

#[test]
fn what_is_switched_off_adds_nothing_at_all() {
    let (pictures, checks) = sequence();
    assert_eq!(pictures.off, pictures.bare);
    assert_eq!(checks.off, 0.0);
    assert_eq!(pictures.again, pictures.both, "and is the same when it is on again");
    assert!(pictures.both.mean() > 1.2 * pictures.bare.mean(), "there is something to add");
}

#[test]
fn a_picture_that_has_its_size_again_is_the_same() {
    let (pictures, _) = sequence();
    assert_eq!(pictures.resized_back, pictures.lamp);
    assert_eq!(pictures.small.size, [72, 45]);
    let ratio = pictures.small.mean() / pictures.lamp.mean();
    // So few pixels miss some of the edges.
    assert!((ratio - 1.0).abs() < 0.1, "the smaller picture shows the same: {ratio}");
}

#[test]
fn two_techniques_add_up_in_one_frame() {
    let (pictures, checks) = sequence();
    assert!(checks.sum < 0.02, "{}", checks.sum);
    for (name, one) in [("lamp", &pictures.lamp), ("sun", &pictures.sun)] {
        assert!(one.mean() > 1.05 * pictures.bare.mean(), "{name} adds light");
        assert!(one.mean() < pictures.both.mean(), "{name} is not all of it");
    }
}

#[test]
fn shafts_are_seen() {
    let (pictures, checks) = sequence();
    assert!((0.02..0.8).contains(&checks.shadowed), "{}", checks.shadowed);
    // Casters take light away from the air and add none.
    let airlight = |with: &Picture, without: &Picture| -> Vec<Vec3> {
        with.pixels.iter().zip(&without.pixels).map(|(with, without)| *with - *without).collect()
    };
    let shadowed = airlight(&pictures.both, &pictures.bare);
    let open = airlight(&pictures.open, &pictures.bare_open);
    let scale = open.iter().map(|value| value.element_sum()).sum::<f32>() / open.len() as f32;
    let brighter =
        shadowed.iter().zip(&open).filter(|(a, b)| (**a - **b).max_element() > 0.02 * scale).count();
    assert!(brighter * 200 < open.len(), "{brighter} pixels have more light with shadows");
    // A shaft's edge: neighbours of which one has far less light.
    let edges = shadowed.windows(2).filter(|pair| {
        let [a, b] = [pair[0].element_sum(), pair[1].element_sum()];
        (a - b).abs() > 0.2 * a.max(b) && a.max(b) > 0.5 * scale * checks.shadowed
    });
    let edges = edges.count();
    assert!(edges > 30, "{edges} edges");
}

#[test]
fn nothing_is_left_to_say() {
    assert_eq!(sequence().1.problems(), [""; 0]);
}
