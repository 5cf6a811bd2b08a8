// Bitonic sort of many arrays of one length at a time (Batcher 1968), by key and then by what the key belongs to.

struct Step {
    /// Length of the sequences that are merged.
    sequence: u32,
    /// Distance of what is compared.
    distance: u32,
    /// Length of an array: a power of two, at least a block's.
    length: u32,
}

const BLOCK: u32 = 512u;

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read_write> keys: array<vec2u>;

var<workgroup> block: array<vec2u, BLOCK>;

fn comes_after(a: vec2u, b: vec2u) -> bool {
    return a.x > b.x || (a.x == b.x && a.y > b.y);
}

/// The first of the pair number `index` of those that are `distance` apart.
fn first_of_pair(index: u32, distance: u32) -> u32 {
    return (index / distance) * 2u * distance + index % distance;
}

/// Compares all pairs of a block at one distance. `base` is the block's place in its array.
fn compare_in_block(thread: u32, base: u32, sequence: u32, distance: u32) {
    let a = first_of_pair(thread, distance);
    let b = a + distance;
    let ascending = ((base + a) & sequence) == 0u;
    if comes_after(block[a], block[b]) == ascending {
        let kept = block[a];
        block[a] = block[b];
        block[b] = kept;
    }
    workgroupBarrier();
}

fn load(thread: u32, at: u32) {
    block[thread] = keys[at + thread];
    block[thread + BLOCK / 2u] = keys[at + thread + BLOCK / 2u];
    workgroupBarrier();
}

fn store(thread: u32, at: u32) {
    keys[at + thread] = block[thread];
    keys[at + thread + BLOCK / 2u] = block[thread + BLOCK / 2u];
}

/// Sorts every block.
@compute @workgroup_size(256)
fn cs_sort_blocks(@builtin(local_invocation_index) thread: u32, @builtin(workgroup_id) group: vec3u) {
    let base = group.x * BLOCK;
    let at = group.y * step.length + base;
    load(thread, at);
    for (var sequence = 2u; sequence <= BLOCK; sequence *= 2u) {
        for (var distance = sequence / 2u; distance > 0u; distance /= 2u) {
            compare_in_block(thread, base, sequence, distance);
        }
    }
    store(thread, at);
}

/// Compares all pairs at one distance, that of a block or more.
@compute @workgroup_size(256)
fn cs_compare(@builtin(global_invocation_id) id: vec3u) {
    let a = first_of_pair(id.x, step.distance);
    let ascending = (a & step.sequence) == 0u;
    let at = id.y * step.length + a;
    let b = keys[at + step.distance];
    let kept = keys[at];
    if comes_after(kept, b) == ascending {
        keys[at] = b;
        keys[at + step.distance] = kept;
    }
}

/// Compares at all distances within a block.
@compute @workgroup_size(256)
fn cs_merge_blocks(@builtin(local_invocation_index) thread: u32, @builtin(workgroup_id) group: vec3u) {
    let base = group.x * BLOCK;
    let at = group.y * step.length + base;
    load(thread, at);
    for (var distance = BLOCK / 2u; distance > 0u; distance /= 2u) {
        compare_in_block(thread, base, step.sequence, distance);
    }
    store(thread, at);
}
