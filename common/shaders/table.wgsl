// Bilinear look-up of a table whose texel centres carry the samples. Twin: common/src/table.rs.
// By hand, because hardware filters weigh in 1/256 steps and may not filter 32-bit floats at all.

/// Value at `at` in [0, 1]²; 0 and 1 are the centres of the first and last texel; clamped.
fn table_lookup(table: texture_2d<f32>, at: vec2f) -> vec4f {
    let size = vec2f(textureDimensions(table));
    let texel = clamp(at, vec2f(0.0), vec2f(1.0)) * (size - 1.0);
    let low = min(floor(texel), max(size - 2.0, vec2f(0.0)));
    let fraction = texel - low;
    let a = vec2i(low);
    let b = min(a + 1, vec2i(size) - 1);
    let top = mix(textureLoad(table, a, 0), textureLoad(table, vec2i(b.x, a.y), 0), fraction.x);
    let bottom = mix(textureLoad(table, vec2i(a.x, b.y), 0), textureLoad(table, b, 0), fraction.x);
    return mix(top, bottom, fraction.y);
}
