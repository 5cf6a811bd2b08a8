// One light, its kind fixed when a pipeline is made. Needs light, kind, ray; and the globals `light: Light`, `shadow_map`,
// `light_map`, `light_map_sampler`.

/// Fraction of a point or spot's strength that it sends towards `away`, its offset [m] from the light of length
/// `distance`; inside a spot's cone.
fn directed(away: vec3f, distance: f32) -> vec3f {
    var share = vec3f(1.0);
    if KIND == LIGHT_SPOT && HAS_RAMP {
        let cosine = max(dot(away, light.direction) / distance, light.cos_outer);
        share *= light_falloff(cosine, light.cos_inner, light.cos_outer);
    }
    if KIND == LIGHT_SPOT && HAS_MAP {
        let uv = light_map_uv(light.direction, light.map_right, light.map_up, away / distance);
        share *= textureSampleLevel(light_map, light_map_sampler, uv, 0.0).rgb;
    }
    return share;
}

/// Where a light's shadow map has a position: a point light by the offset from it, the others in clip coordinates with
/// x and y in texels from the map's upper left corner. It is linear in the position; `w` is 1 for a position, and 0 for a
/// direction.
fn shadow_place(position: vec3f, w: f32) -> vec4f {
    var place = vec4f(position - w * light.position, 0.0);
    if KIND != LIGHT_POINT {
        let clip = light.layers[0].clip_from_world * vec4f(position, w);
        let half = 0.5 * light.shadow_size;
        place = vec4f(half * (clip.w + clip.x), half * (clip.w - clip.y), clip.zw);
    }
    return place;
}

/// Whether the light is seen from a place, for a spot one in its cone: `shadow_visible` of shadow.wgsl, but no matrix
/// and one division at most.
fn sees_light(at: vec4f) -> bool {
    let size = light.shadow_size;
    var texel = at.xy;
    var face = 0u;
    // Depth is compared as stored · w <= z.
    var zw = vec2f(at.z, 1.0);
    var outside = false;
    if KIND == LIGHT_POINT {
        let place = cube_face(at.xyz);
        // Border texels' centres lie on the border of the face.
        let plane = place.frame.xy * (0.5 * (size - 1.0) / max(place.frame.z, 1e-30));
        texel = vec2f(plane.x, -plane.y) + 0.5 * size;
        face = place.face;
        zw = vec2f(light.near, place.frame.z);
    } else if KIND == LIGHT_SPOT {
        texel /= max(at.w, 1e-30);
        zw = at.zw;
    } else {
        // Nothing stands in the way outside a directional light's map.
        outside = any(at.xy < vec2f(0.0)) || any(at.xy >= vec2f(size));
    }
    let stored = textureLoad(shadow_map, vec2i(clamp(texel, vec2f(0.0), vec2f(size - 1.0))), i32(face), 0);
    // Nor where the map is empty.
    return outside || stored <= 0.0 || stored * zw.y <= zw.x;
}
