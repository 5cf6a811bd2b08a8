// From radiance to what a screen shows.

@group(0) @binding(0) var radiance: texture_2d<f32>;

/// Radiance that becomes 1 − 1/e of white [W/m²/sr].
const WHITE: f32 = 0.12;

@vertex
fn vs_tone(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fs_tone(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let value = textureLoad(radiance, vec2i(position.xy), 0).rgb;
    return vec4f(1.0 - exp(-value / WHITE), 1.0);
}
