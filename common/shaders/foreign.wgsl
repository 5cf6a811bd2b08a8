// A shadow map that another program drew, in our conventions. Needs fullscreen, light, shadow.

/// How a layer of ours is read from a layer of theirs.
struct Reading {
    /// To clip x, y and w of their map, from a place (x, y, 1) of our layer: ±1 at the centres of border texels.
    clip_from_plane: mat3x3f,
    /// Our depth is offset + scale * theirs; the scale is negative where theirs is standard.
    scale: f32,
    offset: f32,
    /// Which of their layers.
    layer: u32,
}

@group(0) @binding(0) var<uniform> reading: Reading;
@group(0) @binding(1) var map: texture_depth_2d_array;

@fragment
fn fs_foreign(@builtin(position) position: vec4f) -> @builtin(frag_depth) f32 {
    let size = f32(textureDimensions(map).x);
    let plane = shadow_texel_plane(floor(position.xy), size);
    let clip = reading.clip_from_plane * vec3f(plane, 1.0);
    let texel = clamp(shadow_texel(vec4f(clip.xy, 0.0, clip.z), size), vec2f(0.0), vec2f(size - 1.0));
    let stored = textureLoad(map, vec2i(texel), i32(reading.layer), 0);
    // What is empty stays so, also where the far plane has a depth.
    let empty = select(stored <= 0.0, stored >= 1.0, reading.scale < 0.0);
    return select(clamp(reading.offset + reading.scale * stored, 0.0, 1.0), 0.0, empty);
}
