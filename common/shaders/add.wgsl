// Adds the accumulated airlight to the target. Needs fullscreen.

@group(0) @binding(0) var accumulated: texture_2d<f32>;

/// 1: rounding below zero, left over where faces cancel, is not added.
override clamp_negative: u32 = 1u;

@fragment
fn fs_add(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let value = textureLoad(accumulated, vec2i(position.xy), 0).rgb;
    return vec4f(select(value, max(value, vec3f(0.0)), clamp_negative == 1u), 0.0);
}
