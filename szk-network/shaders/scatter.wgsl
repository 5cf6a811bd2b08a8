// The steps of the iteration. Needs cloud.wgsl. Of the colours, the third dimension of a dispatch has its own.

/// How opacities are kept: one for each link, or one for each particle.
override per_link: bool;
/// Matrices are those of colours, not of phase functions.
override by_colour: bool;

struct Control {
    /// Residual of the last step.
    residual: f32,
    /// Steps that were taken since the network was linked.
    steps: u32,
    /// 1 as soon as the residual is small enough, 2 from the step after that: the rest of the steps is left out.
    done: u32,
}

@group(0) @binding(0) var<uniform> cloud: Cloud;
@group(0) @binding(1) var<storage, read> particles: array<Particle>;
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;
@group(0) @binding(3) var<storage, read> opacities: array<f32>;
@group(0) @binding(4) var<storage, read> sky: array<vec3f>;
@group(0) @binding(5) var<storage, read_write> sources: array<f32>;
@group(0) @binding(6) var<storage, read_write> incoming: array<f32>;
@group(0) @binding(7) var<storage, read_write> outgoing: array<f32>;
@group(0) @binding(8) var<storage, read> factors: array<vec4f>;
@group(0) @binding(9) var<storage, read_write> moments: array<vec4f>;
@group(0) @binding(10) var<storage, read> matrices: array<f32>;
@group(0) @binding(11) var<storage, read_write> partial: array<vec2f>;
@group(0) @binding(12) var<storage, read_write> control: Control;
@group(0) @binding(13) var<storage, read> arrivals: array<Arrival>;
@group(0) @binding(14) var<storage, read> windows: array<Window>;
@group(0) @binding(15) var<storage, read> phase_table: array<f32>;

fn links() -> u32 {
    return cloud.count * cloud.directions;
}

fn opacity(direction: u32, particle: u32) -> f32 {
    if per_link {
        return opacities[direction * cloud.count + particle];
    }
    return particles[particle].opacity;
}

/// What of the light of one direction collides at a particle: incoming, and again what it radiates itself.
fn collides(colour: u32, direction: u32, particle: u32) -> f32 {
    let at = colour * links() + direction * cloud.count + particle;
    return opacity(direction, particle) * incoming[at] + particles[particle].again * sources[at];
}

/// Outgoing radiance, from the part of it that was scattered out of others.
fn leaves(colour: u32, direction: u32, particle: u32, scattered: f32) {
    let at = colour * links() + direction * cloud.count + particle;
    outgoing[at] = (1.0 - opacity(direction, particle)) * incoming[at]
        + (1.0 - particles[particle].again) * (sources[at] + scattered);
}

/// What particles radiate and scatter of direct light.
@compute @workgroup_size(64)
fn cs_sources(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count {
        return;
    }
    let particle = particles[id.x];
    var sum = particle.emission;
    for (var l = 0u; l < cloud.lights; l++) {
        let arrival = arrivals[l * cloud.count + id.x];
        let place = phase_place(dot(windows[id.y].direction, arrival.direction));
        let first = min(u32(place), PHASE_ENTRIES - 2u);
        let at = particle.phase * PHASE_ENTRIES + first;
        let phase = mix(phase_table[at], phase_table[at + 1u], place - f32(first)) * arrival.norm;
        sum += particle.albedo * arrival.irradiance * (particle.depth * phase);
    }
    for (var colour = 0u; colour < arrayLength(&sources) / links(); colour++) {
        sources[colour * links() + id.y * cloud.count + id.x] = sum[colour];
    }
}

var<workgroup> sums: array<vec2f, 64>;

/// Light goes on to the next particle. Notes how much of it is new, and how much there is.
@compute @workgroup_size(64)
fn cs_propagate(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
) {
    var change = vec2f(0.0);
    if id.x < cloud.count && control.done == 0u {
        let link = id.y * cloud.count + id.x;
        let at = id.z * links() + link;
        let neighbour = neighbours[link];
        var arriving = 0.0;
        if neighbour == NOBODY {
            arriving = sky[id.y][id.z];
        } else {
            arriving = outgoing[id.z * links() + id.y * cloud.count + neighbour];
        }
        change = vec2f(abs(arriving - incoming[at]), arriving);
        incoming[at] = arriving;
    }
    sums[thread] = change;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            sums[thread] += sums[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u {
        partial[(group.z * groups.y + group.y) * groups.x + group.x] = sums[0];
    }
}

var<workgroup> totals: array<vec2f, 256>;

/// The residual of a step.
@compute @workgroup_size(256)
fn cs_residual(@builtin(local_invocation_index) thread: u32) {
    var sum = vec2f(0.0);
    for (var i = thread; i < arrayLength(&partial); i += 256u) {
        sum += partial[i];
    }
    totals[thread] = sum;
    workgroupBarrier();
    for (var half = 128u; half > 0u; half /= 2u) {
        if thread < half {
            totals[thread] += totals[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u && control.done == 0u {
        control.residual = totals[0].x / max(totals[0].y, 1e-30);
        control.steps += 1u;
        control.done = select(0u, 1u, control.residual < cloud.tolerance);
    } else if thread == 0u {
        control.done = 2u;
    }
}

/// Where a block of four components of a particle is.
fn moment_place(colour: u32, block: u32, particle: u32) -> u32 {
    return (colour * cloud.blocks + block) * cloud.count + particle;
}

/// Four components of what collides at a particle, each multiplied by what becomes of it. A block of `factors` has its
/// λ in front.
@compute @workgroup_size(64)
fn cs_moments(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count || control.done == 2u {
        return;
    }
    let particle = particles[id.x];
    let first = (particle.phase * cloud.blocks + id.y) * (cloud.directions + 1u);
    var sum = vec4f(0.0);
    for (var d = 0u; d < cloud.directions; d++) {
        sum += factors[first + 1u + d] * collides(id.z, d, id.x);
    }
    let share = factors[first] * particle.albedo[id.z];
    moments[moment_place(id.z, id.y, id.x)] = sum * share / (1.0 - share * particle.again);
}

/// Outgoing radiance from the components.
@compute @workgroup_size(64)
fn cs_expand(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count || control.done == 2u {
        return;
    }
    let phase = particles[id.x].phase;
    var scattered = 0.0;
    for (var block = 0u; block < cloud.blocks; block++) {
        let factor = factors[(phase * cloud.blocks + block) * (cloud.directions + 1u) + 1u + id.y];
        scattered += dot(factor, moments[moment_place(id.z, block, id.x)]);
    }
    leaves(id.z, id.y, id.x, scattered);
}

fn matrix_place(colour: u32, particle: u32) -> u32 {
    let size = cloud.directions * cloud.directions;
    if by_colour {
        return min(colour, arrayLength(&matrices) / size - 1u) * size;
    }
    return particles[particle].phase * size;
}

/// Outgoing radiance from the whole matrix.
@compute @workgroup_size(64)
fn cs_full(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count || control.done == 2u {
        return;
    }
    let row = matrix_place(id.z, id.x) + id.y * cloud.directions;
    var sum = 0.0;
    for (var d = 0u; d < cloud.directions; d++) {
        sum += matrices[row + d] * collides(id.z, d, id.x);
    }
    leaves(id.z, id.y, id.x, particles[id.x].albedo[id.z] * sum);
}

const TILE: u32 = 16u;
var<workgroup> tile: array<array<f32, TILE>, TILE>;

/// The same, what collides in tiles of 16 particles by 16 directions that a workgroup shares. Particles of other phase
/// functions multiply by rows of their own, so only what collides is shared.
@compute @workgroup_size(16, 16)
fn cs_tiled(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_id) local: vec3u,
) {
    let inside = id.x < cloud.count && id.y < cloud.directions;
    let row = matrix_place(id.z, min(id.x, cloud.count - 1u)) + min(id.y, cloud.directions - 1u) * cloud.directions;
    var sum = 0.0;
    for (var first = 0u; first < cloud.directions; first += TILE) {
        var value = 0.0;
        if id.x < cloud.count && first + local.y < cloud.directions {
            value = collides(id.z, first + local.y, id.x);
        }
        tile[local.y][local.x] = value;
        workgroupBarrier();
        for (var d = 0u; d < min(TILE, cloud.directions - first); d++) {
            sum += matrices[row + first + d] * tile[d][local.x];
        }
        workgroupBarrier();
    }
    if inside && control.done != 2u {
        leaves(id.z, id.y, id.x, particles[id.x].albedo[id.z] * sum);
    }
}
