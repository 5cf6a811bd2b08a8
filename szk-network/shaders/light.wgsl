// Direct light, what its passes share. Needs phase, light, shadow and cloud.wgsl, and the globals `cloud` and `light`.

/// Which light it is the turn of.
struct Turn {
    index: u32,
}

/// One over the squared distance, its mean over a ball of `radius` near the light; 1 for parallel light.
fn falloff_squared(position: vec3f, radius: f32) -> f32 {
    if light.kind == LIGHT_DIRECTIONAL {
        return 1.0;
    }
    let offset = light.position - position;
    return 1.0 / max(dot(offset, offset), radius * radius / 3.0);
}

var<workgroup> sums: array<f32, 64>;

fn add_up(thread: u32, value: f32) -> f32 {
    sums[thread] = value;
    workgroupBarrier();
    for (var half = 32u; half > 0u; half /= 2u) {
        if thread < half {
            sums[thread] += sums[thread + half];
        }
        workgroupBarrier();
    }
    return sums[0];
}

fn mean(colour: vec3f) -> f32 {
    return dot(colour, vec3f(1.0 / 3.0));
}
