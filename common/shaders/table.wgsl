// Bilinear look-up of a table whose texel centres carry the samples. Twin: common/src/table.rs.
// By hand, because hardware filters weigh in 1/256 steps and may not filter 32-bit floats at all.

/// Value of table `layer` at `at` in [0, 1]²; 0 and 1 are the centres of the first and last texel;
/// clamped.
fn table_lookup(tables: texture_2d_array<f32>, layer: u32, at: vec2f) -> f32 {
    let size = vec2f(textureDimensions(tables));
    let texel = clamp(at, vec2f(0.0), vec2f(1.0)) * (size - 1.0);
    let low = min(floor(texel), max(size - 2.0, vec2f(0.0)));
    let fraction = texel - low;
    let a = vec2i(low);
    let b = min(a + 1, vec2i(size) - 1);
    let top = mix(
        textureLoad(tables, a, layer, 0).x,
        textureLoad(tables, vec2i(b.x, a.y), layer, 0).x,
        fraction.x,
    );
    let bottom = mix(
        textureLoad(tables, vec2i(a.x, b.y), layer, 0).x,
        textureLoad(tables, b, layer, 0).x,
        fraction.x,
    );
    return mix(top, bottom, fraction.y);
}
