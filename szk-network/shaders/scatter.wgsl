// The steps of the iteration. Needs cloud.wgsl. Of the colours, the third dimension of a dispatch has its own.

/// How opacities are kept: one for each link, or one for each particle.
override per_link: bool;

@group(0) @binding(0) var<uniform> cloud: Cloud;
@group(0) @binding(1) var<storage, read> particles: array<Particle>;
/// Neighbours; after them, where opacities are those of links, the bits of these.
@group(0) @binding(2) var<storage, read> neighbours: array<u32>;
@group(0) @binding(3) var<uniform> sky: array<vec4f, 512>;
@group(0) @binding(4) var<storage, read_write> sources: array<f32>;
@group(0) @binding(5) var<storage, read_write> incoming: array<f32>;
@group(0) @binding(6) var<storage, read_write> outgoing: array<f32>;
@group(0) @binding(7) var<storage, read> factors: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> moments: array<vec4f>;
@group(0) @binding(9) var<storage, read> matrices: array<vec4f>;
/// Residual of the last step and steps that were taken; 1 as soon as the residual is small enough, 2 from the step after
/// that, whose work is left out, and steps of this frame; then what each invocation found to be new, and how much there
/// is.
@group(0) @binding(10) var<storage, read_write> state: array<vec2f>;
@group(0) @binding(11) var<storage, read_write> collisions: array<f32>;
@group(0) @binding(12) var<storage, read> arrivals: array<Arrival>;
@group(0) @binding(13) var<storage, read> windows: array<Window>;
@group(0) @binding(14) var<storage, read> phase_table: array<f32>;

fn links() -> u32 {
    return cloud.count * cloud.directions;
}

/// Directions that an invocation goes through.
const CHUNK: u32 = 32u;

/// Pairs of `state` in front of what is added up.
const STATE: u32 = 2u;

/// Whether nothing is left to do in this step.
fn is_done() -> bool {
    return state[1].x == 2.0;
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

/// Light that goes on to a particle in one direction, what is new of it, and what of it collides there (and again what
/// the particle itself radiates and scatters of direct light).
struct Gathered {
    collides: f32,
    arriving: f32,
    change: f32,
}

fn gather(colour: u32, direction: u32, particle: u32, of_particle: f32, again: f32) -> Gathered {
    let network = colour * links();
    let link = direction * cloud.count + particle;
    let neighbour = neighbours[link];
    var arriving = 0.0;
    if neighbour == NOBODY {
        arriving = sky[direction][colour];
    } else {
        arriving = outgoing[network + direction * cloud.count + neighbour];
    }
    let change = abs(arriving - incoming[network + link]);
    incoming[network + link] = arriving;
    var opacity = of_particle;
    if per_link {
        opacity = bitcast<f32>(neighbours[links() + link]);
    }
    return Gathered(opacity * arriving + again * sources[network + link], arriving, change);
}

/// Light goes on to the next particle; what of it collides there is kept for a whole matrix.
@compute @workgroup_size(64)
fn cs_propagate(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    if id.x >= cloud.count || state[1].x != 0.0 {
        return;
    }
    let opacity = particles[id.x].opacity;
    let again = particles[id.x].again;
    var change = vec2f(0.0);
    let last = min(CHUNK * (id.y + 1u), cloud.directions);
    for (var d = CHUNK * id.y; d < last; d++) {
        let gathered = gather(id.z, d, id.x, opacity, again);
        change += vec2f(gathered.change, gathered.arriving);
        collisions[id.z * links() + d * cloud.count + id.x] = gathered.collides;
    }
    state[STATE + (id.z * groups.y + id.y) * cloud.count + id.x] = change;
}

var<workgroup> totals: array<vec2f, 256>;

/// The residual of a step.
@compute @workgroup_size(256)
fn cs_residual(@builtin(local_invocation_index) thread: u32) {
    var sum = vec2f(0.0);
    for (var i = STATE + thread; i < arrayLength(&state); i += 256u) {
        sum += state[i];
    }
    totals[thread] = sum;
    workgroupBarrier();
    for (var half = 128u; half > 0u; half /= 2u) {
        if thread < half {
            totals[thread] += totals[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u {
        if state[1].x == 0.0 {
            let residual = totals[0].x / max(totals[0].y, 1e-30);
            state[0] = vec2f(residual, state[0].y + 1.0);
            // What is new of direct light shows in the second step of a frame only.
            let settled = residual < cloud.tolerance && state[1].y > 0.0;
            state[1] = vec2f(select(0.0, 1.0, settled), state[1].y + 1.0);
        } else {
            state[1].x = 2.0;
        }
    }
}

/// Outgoing radiance, from the part of it that was scattered out of other directions.
fn leaves(network: u32, link: u32, particle: u32, scattered: f32) {
    var opacity = particles[particle].opacity;
    if per_link {
        opacity = bitcast<f32>(neighbours[links() + link]);
    }
    outgoing[network + link] = (1.0 - opacity) * incoming[network + link]
        + (1.0 - particles[particle].again) * (sources[network + link] + scattered);
}

/// Where a block of four components of a particle is.
fn moment_place(colour: u32, block: u32, particle: u32) -> u32 {
    return (colour * cloud.blocks + block) * cloud.count + particle;
}

/// Where a block of `factors` begins. It has its λ in front.
fn factor_place(phase: u32, block: u32) -> u32 {
    return (phase * cloud.blocks + block) * (cloud.directions + 1u);
}

/// Keeps four components of what collides at a particle, each multiplied by what becomes of it.
fn keep_moments(colour: u32, block: u32, particle: u32, sum: vec4f) {
    let share = factors[factor_place(particles[particle].phase, block)] * particles[particle].albedo[colour];
    moments[moment_place(colour, block, particle)] = sum * share / (1.0 - share * particles[particle].again);
}

/// Up to three blocks of four components of what collides at a particle.
@compute @workgroup_size(64)
fn cs_moments(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count || is_done() {
        return;
    }
    let phase = particles[id.x].phase;
    let first = 3u * id.y;
    let blocks = min(cloud.blocks - first, 3u);
    let a = factor_place(phase, first);
    let b = factor_place(phase, first + min(1u, blocks - 1u));
    let c = factor_place(phase, first + min(2u, blocks - 1u));
    var sums = array<vec4f, 3>();
    let network = id.z * links();
    if blocks == 1u {
        for (var d = 0u; d < cloud.directions; d++) {
            sums[0] += factors[a + 1u + d] * collisions[network + d * cloud.count + id.x];
        }
    } else {
        for (var d = 0u; d < cloud.directions; d++) {
            let collides = collisions[network + d * cloud.count + id.x];
            sums[0] += factors[a + 1u + d] * collides;
            sums[1] += factors[b + 1u + d] * collides;
            sums[2] += factors[c + 1u + d] * collides;
        }
    }
    for (var i = 0u; i < blocks; i++) {
        keep_moments(id.z, first + i, id.x, sums[i]);
    }
}

/// Light goes on to the next particle; what of it collides there is kept as up to three blocks of components.
@compute @workgroup_size(64)
fn cs_propagate_moments(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count || state[1].x != 0.0 {
        return;
    }
    let particle = particles[id.x];
    let blocks = cloud.blocks;
    let a = factor_place(particle.phase, 0u);
    let b = factor_place(particle.phase, min(1u, blocks - 1u));
    let c = factor_place(particle.phase, min(2u, blocks - 1u));
    var sums = array<vec4f, 3>();
    var change = vec2f(0.0);
    if blocks == 1u {
        for (var d = 0u; d < cloud.directions; d++) {
            let gathered = gather(id.z, d, id.x, particle.opacity, particle.again);
            change += vec2f(gathered.change, gathered.arriving);
            sums[0] += factors[a + 1u + d] * gathered.collides;
        }
    } else {
        for (var d = 0u; d < cloud.directions; d++) {
            let gathered = gather(id.z, d, id.x, particle.opacity, particle.again);
            change += vec2f(gathered.change, gathered.arriving);
            sums[0] += factors[a + 1u + d] * gathered.collides;
            sums[1] += factors[b + 1u + d] * gathered.collides;
            sums[2] += factors[c + 1u + d] * gathered.collides;
        }
    }
    state[STATE + id.z * cloud.count + id.x] = change;
    for (var block = 0u; block < blocks; block++) {
        keep_moments(id.z, block, id.x, sums[block]);
    }
}

/// Outgoing radiance from the components.
@compute @workgroup_size(64)
fn cs_expand(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count || is_done() {
        return;
    }
    let phase = particles[id.x].phase;
    let again = particles[id.x].again;
    let network = id.z * links();
    let last = min(CHUNK * (id.y + 1u), cloud.directions);
    for (var first = 0u; first < cloud.blocks; first += 3u) {
        let blocks = min(cloud.blocks - first, 3u);
        // Blocks that are missing are the first one, times 0.
        let a = factor_place(phase, first);
        let b = factor_place(phase, first + min(1u, blocks - 1u));
        let c = factor_place(phase, first + min(2u, blocks - 1u));
        let moment_a = moments[moment_place(id.z, first, id.x)];
        var moment_b = vec4f(0.0);
        var moment_c = vec4f(0.0);
        if blocks > 1u {
            moment_b = moments[moment_place(id.z, first + 1u, id.x)];
        }
        if blocks > 2u {
            moment_c = moments[moment_place(id.z, first + 2u, id.x)];
        }
        for (var d = CHUNK * id.y; d < last; d++) {
            var scattered = dot(factors[a + 1u + d], moment_a);
            if blocks > 1u {
                scattered += dot(factors[b + 1u + d], moment_b) + dot(factors[c + 1u + d], moment_c);
            }
            let link = d * cloud.count + id.x;
            if first == 0u {
                leaves(network, link, id.x, scattered);
            } else {
                outgoing[network + link] += (1.0 - again) * scattered;
            }
        }
    }
}

/// Where the rows of four directions begin in the matrix of a particle.
fn matrix_place(colour: u32, phase: u32, four: u32) -> u32 {
    let size = (cloud.directions + 3u) / 4u * cloud.directions;
    let which = select(phase, min(colour, arrayLength(&matrices) / size - 1u), cloud.by_colour == 1u);
    return which * size + four * cloud.directions;
}

fn leave_four(network: u32, four: u32, particle: u32, scattered: vec4f) {
    for (var i = 0u; i < min(4u, cloud.directions - 4u * four); i++) {
        leaves(network, (4u * four + i) * cloud.count + particle, particle, scattered[i]);
    }
}

/// Outgoing radiance in four directions from the whole matrix.
@compute @workgroup_size(64)
fn cs_full(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cloud.count || is_done() {
        return;
    }
    let row = matrix_place(id.z, particles[id.x].phase, id.y);
    let network = id.z * links();
    var sum = vec4f(0.0);
    for (var d = 0u; d < cloud.directions; d++) {
        sum += matrices[row + d] * collisions[network + d * cloud.count + id.x];
    }
    leave_four(network, id.y, id.x, particles[id.x].albedo[id.z] * sum);
}

const TILE: u32 = 16u;
var<workgroup> tile: array<array<f32, TILE>, TILE>;

/// The same, what collides in tiles of 16 particles by 16 directions that a workgroup shares.
@compute @workgroup_size(16, 16)
fn cs_tiled(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let fours = (cloud.directions + 3u) / 4u;
    let particle = min(id.x, cloud.count - 1u);
    let four = min(id.y, fours - 1u);
    let row = matrix_place(id.z, particles[particle].phase, four);
    let network = id.z * links();
    var sum = vec4f(0.0);
    for (var first = 0u; first < cloud.directions; first += TILE) {
        let d = min(first + local.y, cloud.directions - 1u);
        tile[local.y][local.x] = collisions[network + d * cloud.count + particle];
        workgroupBarrier();
        for (var i = 0u; i < min(TILE, cloud.directions - first); i++) {
            sum += matrices[row + first + i] * tile[i][local.x];
        }
        workgroupBarrier();
    }
    if id.x < cloud.count && id.y < fours && !is_done() {
        leave_four(network, four, id.x, particles[id.x].albedo[id.z] * sum);
    }
}
