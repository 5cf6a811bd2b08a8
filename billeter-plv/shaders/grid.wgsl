// Vertices of the light volume: a texel of the shadow map each.
// Needs light, shadow; and the globals `light: Light`, `shadow_map: texture_depth_2d_array`.

/// 1: where depth jumps, vertices on both sides move to the middle between them, so that the wall stands
/// upright; 0: it slopes over a texel, as in the paper.
override upright_walls: u32 = 0u;

/// A depth that differs from what the surface before it foretells by more than so many texels is a jump.
const JUMP: f32 = 4.0;

/// Where between two texels their wall stands: not quite in the middle. With the eye in line with the light, middles fall on
/// pixel centres, and a rasteriser that counts the wall's edge there but not the next face's leaves the pixel black.
const MEETING: f32 = 0.46875;

/// Cells on a side of the grid that the adaptive mesh refines: the power of two that holds the map.
fn grid_cells(shadow_size: f32) -> u32 {
    let cells = u32(shadow_size) - 1u;
    return select(1u << (32u - countLeadingZeros(cells - 1u)), 1u, cells <= 1u);
}

/// What is linear across a plane seen by the light: 1/distance, or the distance itself for parallel light.
fn linear_key(kind: u32, distance: f32) -> f32 {
    return select(1.0 / distance, distance, kind == LIGHT_DIRECTIONAL);
}

/// Inverse of linear_key, for keys that extrapolation may have carried beyond all distances.
fn key_distance(kind: u32, far: f32, key: f32) -> f32 {
    if kind == LIGHT_DIRECTIONAL {
        return clamp(key, 0.0, far);
    }
    return 1.0 / max(key, 1.0 / far);
}

/// Whether depth jumps between the middle two of four texels in a row: neither surface foretells the other.
fn jumps(kind: u32, far: f32, texel_width: f32, before: f32, here: f32, there: f32, beyond: f32) -> bool {
    let at_here = key_distance(kind, far, here);
    let at_there = key_distance(kind, far, there);
    let foretold_there = key_distance(kind, far, 2.0 * here - before);
    let foretold_here = key_distance(kind, far, 2.0 * there - beyond);
    let gap = min(abs(at_there - foretold_there), abs(at_here - foretold_here));
    let width = texel_width * select(min(at_here, at_there), 1.0, kind == LIGHT_DIRECTIONAL);
    return gap > JUMP * width;
}

fn texel_key(layer: u32, texel: vec2i) -> f32 {
    let last = vec2i(i32(light.shadow_size) - 1);
    let depth = textureLoad(shadow_map, clamp(texel, vec2i(0), last), i32(layer), 0);
    return linear_key(light.kind, shadow_distance(light.kind, light.near, light.far, light.range, depth));
}

/// A vertex: where it lies on the map, in texels, and how far away [m].
struct TexelVertex {
    texel: vec2f,
    distance: f32,
}

/// The vertex of a texel; coordinates beyond the map are clamped. Vertices of the border stay on it.
fn texel_vertex(layer: u32, texel: vec2u) -> TexelVertex {
    let last = i32(light.shadow_size) - 1;
    let at = min(vec2i(texel), vec2i(last));
    let key = texel_key(layer, at);
    var vertex = TexelVertex(vec2f(at), key_distance(light.kind, light.far, key));
    if upright_walls == 0u {
        return vertex;
    }
    let width = 2.0 * length(light.layers[layer].right) / light.shadow_size;
    var moved = key;
    for (var axis = 0u; axis < 2u; axis += 1u) {
        if at[axis] == 0 || at[axis] == last {
            continue;
        }
        let step = select(vec2i(0, 1), vec2i(1, 0), axis == 0u);
        let a1 = texel_key(layer, at - step);
        let b1 = texel_key(layer, at + step);
        let a2 = texel_key(layer, at - 2 * step);
        let b2 = texel_key(layer, at + 2 * step);
        let before = jumps(light.kind, light.far, width, a2, a1, key, b1);
        let after = jumps(light.kind, light.far, width, a1, key, b1, b2);
        // What is one texel thin between two jumps stays in its place, and so do its neighbours: both
        // sides of a jump move, or neither.
        if after && !before {
            let b3 = texel_key(layer, at + 3 * step);
            if !jumps(light.kind, light.far, width, key, b1, b2, b3) {
                vertex.texel[axis] += MEETING;
                moved += MEETING * (key - a1);
            }
        } else if before && !after {
            let a3 = texel_key(layer, at - 3 * step);
            if !jumps(light.kind, light.far, width, a3, a2, a1, key) {
                vertex.texel[axis] -= 1.0 - MEETING;
                moved += (1.0 - MEETING) * (key - b1);
            }
        }
    }
    vertex.distance = key_distance(light.kind, light.far, moved);
    return vertex;
}
