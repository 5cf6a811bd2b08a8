// Adds up what the passes of direct light left of every workgroup, and has as much collide at all particles as collides
// in all voxels. Needs cloud.wgsl.

struct Turn {
    index: u32,
}

/// What of a light collides, in parts of its strength, times area [m²].
struct Collided {
    in_voxels: f32,
    at_particles: f32,
}

@group(0) @binding(0) var<uniform> turn: Turn;
@group(0) @binding(1) var<storage, read> partial: array<f32>;
@group(0) @binding(2) var<storage, read_write> collided: array<Collided>;
@group(0) @binding(3) var<uniform> cloud: Cloud;
@group(0) @binding(4) var<storage, read_write> arrivals: array<Arrival>;

override at_particles: bool;

var<workgroup> sums: array<f32, 256>;

@compute @workgroup_size(256)
fn cs_sum(@builtin(local_invocation_index) thread: u32) {
    var sum = 0.0;
    for (var i = thread; i < arrayLength(&partial); i += 256u) {
        sum += partial[i];
    }
    sums[thread] = sum;
    workgroupBarrier();
    for (var half = 128u; half > 0u; half /= 2u) {
        if thread < half {
            sums[thread] += sums[thread + half];
        }
        workgroupBarrier();
    }
    if thread == 0u {
        if at_particles {
            collided[turn.index].at_particles = sums[0];
        } else {
            collided[turn.index].in_voxels = sums[0];
        }
    }
}

@compute @workgroup_size(64)
fn cs_scale(@builtin(global_invocation_id) id: vec3u) {
    if id.x < cloud.count {
        let found = collided[turn.index];
        let scale = clamp(found.in_voxels / max(found.at_particles, 1e-30), 0.5, 2.0);
        arrivals[turn.index * cloud.count + id.x].irradiance *= scale;
    }
}
