//! The shaders are valid without optional features.

use common::gpu::bench::{storage_buffers, validate_wgsl};
use szk_network::shaders;

#[test]
fn the_shaders_are_valid_without_optional_features() {
    let all = [
        ("sort", shaders::sort()),
        ("links", shaders::links()),
        ("voxels", shaders::voxels()),
        ("arrivals", shaders::arrivals()),
        ("sums", shaders::sums()),
        ("scatter", shaders::scatter()),
        ("view", shaders::view()),
        ("splat", shaders::splat()),
    ];
    for (name, source) in all {
        validate_wgsl(&source).unwrap_or_else(|error| panic!("{name}: {error}"));
        for (entry, buffers) in storage_buffers(&source).unwrap() {
            assert!(buffers <= 8, "{entry}: {buffers} storage buffers");
        }
    }
}
