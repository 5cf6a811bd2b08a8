// What particles send towards the eye, and their order. Needs view and cloud.wgsl.

/// How opacities are kept: one for each link, or one for each particle.
override per_link: bool;
/// Direct light is found for each fragment, and left out here.
override per_fragment: bool;

@group(0) @binding(0) var<uniform> cloud: Cloud;
@group(0) @binding(1) var<uniform> view: View;
@group(0) @binding(2) var<storage, read> particles: array<Particle>;
@group(0) @binding(3) var<storage, read> windows: array<Window>;
@group(0) @binding(4) var<storage, read> phase_tables: array<f32>;
@group(0) @binding(5) var<storage, read> arrivals: array<Arrival>;
/// Neighbours; after them, where opacities are those of links, the bits of these.
@group(0) @binding(6) var<storage, read> neighbours: array<u32>;
@group(0) @binding(7) var<storage, read> incoming: array<f32>;
@group(0) @binding(8) var<storage, read> outgoing: array<f32>;
@group(0) @binding(9) var<storage, read_write> radiances: array<vec4f>;
@group(0) @binding(10) var<storage, read_write> keys: array<vec2u>;

fn phase_at(phase: u32, cosine: f32) -> f32 {
    let place = phase_place(cosine);
    let first = min(u32(place), PHASE_ENTRIES - 2u);
    let at = phase * PHASE_ENTRIES + first;
    return mix(phase_tables[at], phase_tables[at + 1u], place - f32(first));
}

/// The farthest first.
@compute @workgroup_size(64)
fn cs_order(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.padded {
        return;
    }
    var key = vec2u(NOBODY);
    if id.x < cloud.count {
        let offset = particles[id.x].position - view.eye;
        key = vec2u(~bitcast<u32>(dot(offset, offset)), id.x);
    }
    keys[id.x] = key;
}

/// Radiance that a particle's medium would have towards the eye if there was no end to it.
@compute @workgroup_size(64)
fn cs_radiances(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count {
        return;
    }
    let particle = particles[id.x];
    let to_eye = view.eye - particle.position;
    let way = to_eye / max(length(to_eye), 1e-20);
    let links = cloud.count * cloud.directions;
    let colours = arrayLength(&incoming) / links;
    var scattered = vec3f(0.0);
    var sum = 0.0;
    for (var d = 0u; d < cloud.directions; d++) {
        let phase = phase_at(particle.phase, dot(windows[d].direction, way));
        sum += phase;
        let link = d * cloud.count + id.x;
        var opacity = particle.opacity;
        if per_link {
            opacity = bitcast<f32>(neighbours[links + link]);
        }
        for (var colour = 0u; colour < colours; colour++) {
            let arriving = incoming[colour * links + link];
            // What leaves but did not pass through was radiated or scattered here; part of it collides once more.
            let own = max(outgoing[colour * links + link] - (1.0 - opacity) * arriving, 0.0)
                / (1.0 - particle.again);
            scattered[colour] += phase * (opacity * arriving + particle.again * own);
        }
    }
    if colours == 1u {
        scattered = scattered.xxx;
    }
    var radiance = particle.emission + particle.albedo * scattered / max(sum, 1e-30);
    if !per_fragment {
        for (var l = 0u; l < cloud.lights; l++) {
            let arrival = arrivals[l * cloud.count + id.x];
            let phase = phase_at(particle.phase, dot(arrival.direction, way));
            radiance += particle.albedo * arrival.irradiance * (particle.depth * phase);
        }
    }
    radiances[id.x] = vec4f(radiance / particle.depth, 1.0);
}
