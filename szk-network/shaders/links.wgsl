// The visibility network: all layers of the particles in a window at once, by sorting them into columns.
// Needs cloud.wgsl.

override per_link: bool;

/// Directions that are linked at a time.
struct Batch {
    first: u32,
    /// Length of a sorted array.
    length: u32,
}

@group(0) @binding(0) var<uniform> batch: Batch;
@group(0) @binding(1) var<uniform> cloud: Cloud;
@group(0) @binding(2) var<storage, read> particles: array<Particle>;
@group(0) @binding(3) var<storage, read> windows: array<Window>;
@group(0) @binding(4) var<storage, read_write> keys: array<vec2u>;
/// Neighbours; after them, where opacities are those of links, the bits of these.
@group(0) @binding(5) var<storage, read_write> neighbours: array<u32>;

/// Pixel above, depth below. Twin: `Window::key`.
fn column_key(window: Window, place: vec3f) -> u32 {
    let at = vec2f(dot(place, window.right), dot(place, window.up));
    let side = f32(cloud.pixels);
    let pixel = vec2u(clamp(floor((at * 0.5 + 0.5) * side + window.offset), vec2f(0.0), vec2f(side)));
    let depth = clamp(dot(place, window.direction) * 0.5 + 0.5, 0.0, 1.0) * (cloud.levels - 1.0);
    return ((pixel.y * (cloud.pixels + 1u) + pixel.x) << (32u - cloud.pixel_bits)) | u32(depth);
}

@compute @workgroup_size(64)
fn cs_keys(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= batch.length {
        return;
    }
    var key = vec2u(NOBODY);
    let direction = batch.first + id.y;
    if id.x < cloud.count && direction < cloud.directions {
        let place = (particles[id.x].position - cloud.centre) / cloud.radius;
        key = vec2u(column_key(windows[direction], place), id.x);
    }
    keys[id.y * batch.length + id.x] = key;
}

@compute @workgroup_size(64)
fn cs_links(@builtin(global_invocation_id) id: vec3u) {
    let direction = batch.first + id.y;
    if id.x >= cloud.count || direction >= cloud.directions {
        return;
    }
    let at = id.y * batch.length + id.x;
    let own = keys[at];
    let shift = 32u - cloud.pixel_bits;
    var neighbour = NOBODY;
    if id.x > 0u {
        let before = keys[at - 1u];
        if before.x >> shift == own.x >> shift {
            neighbour = before.y;
        }
    }
    let link = direction * cloud.count + own.y;
    neighbours[link] = neighbour;
    if per_link {
        let particle = particles[own.y];
        var opacity = particle.opacity;
        if neighbour != NOBODY {
            let offset = particle.position - particles[neighbour].position;
            let distance = max(dot(offset, windows[direction].direction), 0.0);
            let extinction = 3.0 / (12.56637061 * pow(particle.radius, 3.0)) * particle.cross_section;
            let other = particles[neighbour];
            let other_extinction = 3.0 / (12.56637061 * pow(other.radius, 3.0)) * other.cross_section;
            opacity = 1.0 - exp(-0.5 * (extinction + other_extinction) * distance);
        }
        neighbours[cloud.count * cloud.directions + link] = bitcast<u32>(opacity);
    }
}
