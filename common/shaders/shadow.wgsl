// Shadow maps: which texel a point falls into, and what a texel's depth stands for.
// Twin: common/src/gpu/shadow.rs. Needs light.wgsl.
//
// The centres of the border texels lie exactly on the border of the light's square frustum, so that
// neighbouring cube faces share the directions of their border texels.

/// Index of the cube face (of six, in the order of `ShadowLayer`) that `direction` passes through.
fn shadow_face(direction: vec3f) -> u32 {
    let size = abs(direction);
    if size.x >= size.y && size.x >= size.z {
        return select(1u, 0u, direction.x > 0.0);
    }
    if size.y >= size.z {
        return select(3u, 2u, direction.y > 0.0);
    }
    return select(5u, 4u, direction.z > 0.0);
}

/// Distance along the layer's forward axis [m] that a stored depth stands for.
fn shadow_distance(kind: u32, near: f32, far: f32, range: f32, depth: f32) -> f32 {
    if depth <= 0.0 {
        return far;
    }
    if kind == LIGHT_DIRECTIONAL {
        return (1.0 - depth) * range;
    }
    return min(near / depth, far);
}

/// Direction (perspective) or offset (directional) of texel (i, j) in its layer's frame: the vector
/// to be scaled by, or added to, the distance along the forward axis. Texel rows run downwards.
fn shadow_texel_plane(texel: vec2f, size: f32) -> vec2f {
    let at = 2.0 * texel / (size - 1.0) - 1.0;
    return vec2f(at.x, -at.y);
}

/// World position of a texel's centre at `distance` along the forward axis.
fn shadow_position(kind: u32, layer: ShadowLayer, plane: vec2f, distance: f32) -> vec3f {
    let side = plane.x * layer.right + plane.y * layer.up;
    if kind == LIGHT_DIRECTIONAL {
        return layer.origin + side + layer.forward * distance;
    }
    return layer.origin + (side + layer.forward) * distance;
}

/// Texel that a position's clip coordinates (of its layer) fall into; may lie outside the map.
fn shadow_texel(clip: vec4f, size: f32) -> vec2f {
    let ndc = clip.xy / clip.w;
    return floor(vec2f(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5) * size);
}

/// Whether the point with clip coordinates `clip` in layer `layer` sees the light. Outside the map
/// nothing stands in the way. `bias` [fraction of the distance, or of the depth range] keeps a surface
/// from shadowing itself.
fn shadow_visible(map: texture_depth_2d_array, layer: i32, clip: vec4f, size: f32, bias: f32) -> bool {
    let texel = shadow_texel(clip, size);
    // Chosen, not branched upon: with a branch Mesa 22.3.6's lavapipe crashed when it made the pipelines.
    let outside = clip.w <= 0.0 || any(texel < vec2f(0.0)) || any(texel >= vec2f(size));
    let stored = textureLoad(map, vec2i(clamp(texel, vec2f(0.0), vec2f(size - 1.0))), layer, 0);
    // Reversed depth: what is nearer to the light is larger. An empty texel holds nothing back, not even from places
    // beyond the far plane of a directional light, whose depth is negative.
    return outside || stored <= 0.0 || clip.z / clip.w * (1.0 + bias) >= stored;
}
