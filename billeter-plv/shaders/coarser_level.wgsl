// A min-max level from the one below it, the third and coarser. Needs levels.

@group(0) @binding(0) var coarser: texture_storage_2d_array<r32uint, write>;
@group(0) @binding(1) var finer: texture_2d_array<u32>;

@compute @workgroup_size(8, 8)
fn coarsen(@builtin(global_invocation_id) id: vec3u) {
    let layer = i32(id.z);
    var least = 0xffffffffu;
    var most = 0u;
    for (var i = 0; i < 4; i += 1) {
        let word = textureLoad(finer, 2 * vec2i(id.xy) + vec2i(i & 1, i >> 1u), layer, 0).x;
        least = min(least, word << 16u);
        most = max(most, word & 0xffff0000u);
    }
    textureStore(coarser, vec2i(id.xy), layer, vec4u(pack_range(least, most), 0u, 0u, 0u));
}
