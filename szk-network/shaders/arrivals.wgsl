// What of each light collides at every particle. Needs light.wgsl and what that needs.

override nearest: bool;

@group(1) @binding(0) var<uniform> light: Light;

@group(0) @binding(0) var<uniform> turn: Turn;
@group(0) @binding(1) var<uniform> cloud: Cloud;
@group(0) @binding(2) var<storage, read> particles: array<Particle>;
@group(0) @binding(3) var<storage, read> windows: array<Window>;
@group(0) @binding(4) var<storage, read> phase_table: array<f32>;
@group(0) @binding(5) var lit: texture_3d<f32>;
@group(0) @binding(6) var linear_sampler: sampler;
@group(0) @binding(7) var<storage, read_write> arrivals: array<Arrival>;
@group(0) @binding(8) var<storage, read_write> partial: array<f32>;

/// The part of the light that comes as far as a point, by interpolation between voxels.
fn lit_at(position: vec3f) -> vec3f {
    var cells = vec3f(textureDimensions(lit));
    cells.z /= f32(cloud.lights);
    var at = clamp((position - cloud.low) / (cloud.high - cloud.low) * cells, vec3f(0.5), cells - 0.5);
    at.z += f32(turn.index) * cells.z;
    return textureSampleLevel(lit, linear_sampler, at / vec3f(textureDimensions(lit)), 0.0).rgb;
}

fn phase_at(phase: u32, cosine: f32) -> f32 {
    let place = phase_place(cosine);
    let first = min(u32(place), PHASE_ENTRIES - 2u);
    let at = phase * PHASE_ENTRIES + first;
    return mix(phase_table[at], phase_table[at + 1u], place - f32(first));
}

/// What of the light collides at each particle.
@compute @workgroup_size(64)
fn cs_arrivals(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3u,
) {
    var collides = 0.0;
    if id.x < cloud.count {
        let particle = particles[id.x];
        var way = light.direction;
        if light.kind != LIGHT_DIRECTIONAL {
            let offset = particle.position - light.position;
            way = offset / max(length(offset), 1e-12);
        }
        if nearest {
            var best = -2.0;
            let wanted = way;
            for (var d = 0u; d < cloud.directions; d++) {
                let cosine = dot(windows[d].direction, wanted);
                if cosine > best {
                    best = cosine;
                    way = windows[d].direction;
                }
            }
        }
        var sum = 0.0;
        for (var d = 0u; d < cloud.directions; d++) {
            sum += phase_at(particle.phase, dot(windows[d].direction, way));
        }
        let falloff = falloff_squared(particle.position, particle.radius);
        let reached = lit_at(particle.position) * falloff;
        collides = mean(reached) * particle.cross_section;
        let norm = f32(cloud.directions) / (4.0 * PI * max(sum, 1e-30));
        arrivals[turn.index * cloud.count + id.x] = Arrival(way, norm, reached * light.strength);
    }
    let sum = add_up(thread, collides);
    if thread == 0u {
        partial[group.x] = sum;
    }
}
