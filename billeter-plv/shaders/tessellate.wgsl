// Adaptive tessellation of the light volume: a right-triangulated irregular network over the shadow map.
// Needs view, light, shadow, grid.
//
// The grid of 2^k + 1 vertices is the finest of a hierarchy of right triangles, each of which can be split
// at the middle of its longest side. A vertex is the middle of one or two such sides. Its error is how far
// it lies from the side that it would split, or the largest error of the vertices below it, if that is more
// (the maximum hierarchy): so a vertex that is kept implies all those above it, and no cracks can appear.

struct Tessellation {
    /// Which of the light's projections.
    layer: u32,
    /// Distance between the vertices of the level measured, in texels: a power of two.
    step: u32,
    /// 1 for vertices in the middle of a square, 0 for those in the middle of a square's side.
    diagonal: u32,
    /// Triangles that the index buffer holds.
    capacity: u32,
    /// Largest error of a vertex left out, as a fraction of `reach`.
    tolerance: f32,
}

@group(0) @binding(0) var<uniform> tessellation: Tessellation;
@group(0) @binding(1) var<storage, read_write> errors: array<f32>;
/// First per workgroup how many triangles, then where its first one goes.
@group(0) @binding(2) var<storage, read_write> blocks: array<u32>;
@group(0) @binding(3) var<storage, read_write> indices: array<u32>;
/// Arguments of draw_indexed_indirect (5) and draw_indirect (4).
@group(0) @binding(4) var<storage, read_write> arguments: array<u32>;
@group(0) @binding(5) var<uniform> view: View;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;

const INFINITE_ERROR: f32 = 1e30;

/// How far a vertex lies from the middle of the chord that would replace it: along the light's direction
/// as a fraction of `reach` for what lies within it and of the distance for what lies beyond, and across it likewise.
fn chord_error(reach: f32, vertex: TexelVertex, a: TexelVertex, b: TexelVertex) -> f32 {
    let key = 0.5 * (linear_key(light.kind, a.distance) + linear_key(light.kind, b.distance));
    let chord = key_distance(light.kind, light.far, key);
    let along = abs(vertex.distance - chord);
    let texel = 2.0 * length(light.layers[tessellation.layer].right) / light.shadow_size;
    let width = texel * select(min(vertex.distance, reach), 1.0, light.kind == LIGHT_DIRECTIONAL);
    let across = length(vertex.texel - 0.5 * (a.texel + b.texel)) * width;
    return (along + across) / (reach + min(vertex.distance, chord));
}

fn vertex_at(texel: vec2u) -> TexelVertex {
    return texel_vertex(tessellation.layer, texel);
}

/// What errors are measured by [m]: the scene's reach, which an empty texel's distance is a thousand times of, or the
/// distance from eye to light if that is less, for small things on a large ground.
fn reach() -> f32 {
    let scene = light.far * 1e-3;
    return select(min(scene, distance(view.eye, light.position)), scene, light.kind == LIGHT_DIRECTIONAL);
}

fn error_at(vertex: vec2u, side: u32) -> f32 {
    return errors[vertex.y * side + vertex.x];
}

/// End of the diagonal through the middle of a square, of its two the one that the level above starts
/// from: its coordinates are multiples of four steps.
fn diagonal_end(vertex: vec2u, step: u32) -> vec2u {
    let at = vertex / step;
    return select(at + 1u, at - 1u, (at - 1u) % 4u == vec2u(0u)) * step;
}

/// Ends of the side that a vertex is the middle of.
struct Side {
    a: vec2u,
    b: vec2u,
}

fn side_of(vertex: vec2u, step: u32, diagonal: bool) -> Side {
    if diagonal {
        let a = diagonal_end(vertex, step);
        return Side(a, 2u * vertex - a);
    }
    let odd = (vertex / step) & vec2u(1u);
    return Side(vertex - odd * step, vertex + odd * step);
}

/// One level of the maximum hierarchy, from fine to coarse.
@compute @workgroup_size(16, 16)
fn measure(@builtin(global_invocation_id) id: vec3u) {
    let cells = grid_cells(light.shadow_size);
    let side = cells + 1u;
    let step = tessellation.step;
    let diagonal = tessellation.diagonal == 1u;
    var vertex = id.xy * step;
    if diagonal {
        vertex = (2u * id.xy + 1u) * step;
    } else if ((id.x + id.y) & 1u) == 0u {
        return;
    }
    if any(vertex > vec2u(cells)) {
        return;
    }
    var error = INFINITE_ERROR;
    // The border is kept whole: walls are built on it.
    let inside = all(vertex > vec2u(0u)) && all(vertex < vec2u(cells));
    if inside {
        let ends = side_of(vertex, step, diagonal);
        error = chord_error(reach(), vertex_at(vertex), vertex_at(ends.a), vertex_at(ends.b));
        if diagonal {
            error = max(error, max(
                max(error_at(vertex - vec2u(step, 0u), side), error_at(vertex + vec2u(step, 0u), side)),
                max(error_at(vertex - vec2u(0u, step), side), error_at(vertex + vec2u(0u, step), side)),
            ));
        } else if step > 1u {
            let half = step / 2u;
            error = max(error, max(
                max(error_at(vertex - half, side), error_at(vertex + half, side)),
                max(error_at(vertex + vec2u(half, 0u) - vec2u(0u, half), side),
                    error_at(vertex - vec2u(half, 0u) + vec2u(0u, half), side)),
            ));
        }
    }
    errors[vertex.y * side + vertex.x] = error;
}

fn kept(vertex: vec2u) -> bool {
    let cells = grid_cells(light.shadow_size);
    // The four corners are always there.
    if all(vertex % cells == vec2u(0u)) {
        return true;
    }
    return error_at(vertex, cells + 1u) > tessellation.tolerance;
}

/// Triangles that belong to a vertex: those whose longest side it would split, if it is left out but their
/// apex, which splits the triangle above, is kept; and the finest ones around a kept vertex of the last level.
var<private> found: array<array<vec2u, 3>, 4>;

fn triangle(a: vec2u, b: vec2u, c: vec2u) -> array<vec2u, 3> {
    // Rows run downwards: counter-clockwise for the light is clockwise in texels.
    let ab = vec2i(b) - vec2i(a);
    let ac = vec2i(c) - vec2i(a);
    if ab.x * ac.y - ab.y * ac.x < 0 {
        return array(a, b, c);
    }
    return array(a, c, b);
}

fn find_triangles(vertex: vec2u) -> u32 {
    let cells = grid_cells(light.shadow_size);
    let corner = all(vertex % cells == vec2u(0u));
    if any(vertex > vec2u(cells)) || corner {
        return 0u;
    }
    let trailing = countTrailingZeros(vertex);
    let step = 1u << min(trailing.x, trailing.y);
    let diagonal = trailing.x == trailing.y;
    let ends = side_of(vertex, step, diagonal);
    var count = 0u;
    var apices: array<vec2u, 2>;
    var exists = array(true, true);
    if diagonal {
        apices = array(vec2u(ends.a.x, ends.b.y), vec2u(ends.b.x, ends.a.y));
    } else {
        // Across the side: beyond the border there is none.
        let across = vec2u(step) - ((vertex / step) & vec2u(1u)) * step;
        exists = array(all(vertex >= across), all(vertex + across <= vec2u(cells)));
        apices = array(vertex - across, vertex + across);
    }
    let split = kept(vertex);
    for (var i = 0u; i < 2u; i += 1u) {
        if !exists[i] {
            continue;
        }
        let apex = apices[i];
        if !split && kept(apex) {
            found[count] = triangle(ends.a, ends.b, apex);
            count += 1u;
        } else if split && !diagonal && step == 1u {
            found[count] = triangle(ends.a, vertex, apex);
            found[count + 1u] = triangle(vertex, ends.b, apex);
            count += 2u;
        }
    }
    return count;
}

var<workgroup> sums: array<u32, 256>;

/// Inclusive prefix sums of one number for each of the workgroup's 256 invocations.
fn prefix_sum(local: u32, value: u32) -> u32 {
    sums[local] = value;
    workgroupBarrier();
    for (var offset = 1u; offset < 256u; offset *= 2u) {
        var other = 0u;
        if local >= offset {
            other = sums[local - offset];
        }
        workgroupBarrier();
        sums[local] += other;
        workgroupBarrier();
    }
    return sums[local];
}

fn block_of(group: vec3u) -> u32 {
    return group.y * (grid_cells(light.shadow_size) / 16u + 1u) + group.x;
}

/// How many triangles each block of 16 × 16 vertices makes.
@compute @workgroup_size(16, 16)
fn count(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let total = prefix_sum(local, find_triangles(id.xy));
    if local == 255u {
        blocks[block_of(group)] = total;
    }
}

/// Where each block's triangles go, in a fixed order: the same map gives the same mesh, bit for bit.
@compute @workgroup_size(256)
fn place(@builtin(local_invocation_index) local: u32) {
    let rows = grid_cells(light.shadow_size) / 16u + 1u;
    let total_blocks = rows * rows;
    let each = (total_blocks + 255u) / 256u;
    let first = min(local * each, total_blocks);
    let end = min(first + each, total_blocks);
    var own = 0u;
    for (var i = first; i < end; i += 1u) {
        own += blocks[i];
    }
    let before = prefix_sum(local, own) - own;
    var next = before;
    for (var i = first; i < end; i += 1u) {
        let count = blocks[i];
        blocks[i] = next;
        next += count;
    }
    if local == 255u {
        // More than the buffer holds: nothing of this mesh, and the full one instead.
        let fits = next <= tessellation.capacity;
        let cells = u32(light.shadow_size) - 1u;
        arguments[0] = select(0u, 3u * next, fits);
        arguments[1] = select(0u, 1u, fits);
        arguments[2] = 0u;
        arguments[3] = 0u;
        arguments[4] = 0u;
        arguments[5] = 2u * (cells + 1u);
        arguments[6] = select(cells, 0u, fits);
        arguments[7] = 0u;
        arguments[8] = 0u;
    }
}

/// Writes the triangles' indices.
@compute @workgroup_size(16, 16)
fn emit(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let count = find_triangles(id.xy);
    let first = blocks[block_of(group)] + prefix_sum(local, count) - count;
    let side = grid_cells(light.shadow_size) + 1u;
    for (var i = 0u; i < count; i += 1u) {
        let at = first + i;
        if at < tessellation.capacity {
            for (var corner = 0u; corner < 3u; corner += 1u) {
                let vertex = found[i][corner];
                indices[3u * at + corner] = vertex.y * side + vertex.x;
            }
        }
    }
}
