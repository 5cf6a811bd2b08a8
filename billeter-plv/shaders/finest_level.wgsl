// The two finest min-max levels. Needs light, levels.

@group(0) @binding(0) var coarser: texture_storage_2d_array<r32uint, write>;
@group(0) @binding(1) var texels: texture_storage_2d_array<r32uint, write>;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;

/// The map's texels, and the level above them. What lies beyond the map repeats its border.
@compute @workgroup_size(8, 8)
fn finest(@builtin(global_invocation_id) id: vec3u) {
    let layer = i32(id.z);
    let last = i32(light.shadow_size) - 1;
    var least = 0xffffffffu;
    var most = 0u;
    for (var i = 0; i < 4; i += 1) {
        let texel = 2 * vec2i(id.xy) + vec2i(i & 1, i >> 1u);
        let depth = textureLoad(shadow_map, min(texel, vec2i(last)), layer, 0);
        let word = bitcast<u32>(max(depth, 0.0));
        textureStore(texels, texel, layer, vec4u(word, 0u, 0u, 0u));
        least = min(least, word);
        most = max(most, word);
    }
    textureStore(coarser, vec2i(id.xy), layer, vec4u(pack_range(least, most), 0u, 0u, 0u));
}
