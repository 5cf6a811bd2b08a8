// How much of each light reaches every voxel. Needs light.wgsl and what that needs.

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;
@group(1) @binding(2) var light_map: texture_2d<f32>;
@group(1) @binding(3) var light_map_sampler: sampler;

@group(0) @binding(0) var<uniform> turn: Turn;
@group(0) @binding(1) var<uniform> cloud: Cloud;
@group(0) @binding(2) var density: texture_3d<f32>;
@group(0) @binding(3) var linear_sampler: sampler;
@group(0) @binding(4) var lit: texture_storage_3d<rgba16float, write>;
@group(0) @binding(5) var<storage, read_write> partial: array<f32>;

fn density_at(position: vec3f) -> f32 {
    let at = (position - cloud.low) / (cloud.high - cloud.low);
    if any(at < vec3f(0.0)) || any(at > vec3f(1.0)) {
        return 0.0;
    }
    return textureSampleLevel(density, linear_sampler, at, 0.0).x;
}

fn voxel_size() -> vec3f {
    return (cloud.high - cloud.low) / vec3f(textureDimensions(density));
}

/// Optical depth along a unit direction from a point to `end` [m] away, or to the end of the voxels.
fn optical_depth(position: vec3f, direction: vec3f, end: f32) -> f32 {
    // Where the ray leaves the box.
    let inverse = 1.0 / select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let exits = max((cloud.low - position) * inverse, (cloud.high - position) * inverse);
    let way = min(end, max(min(exits.x, min(exits.y, exits.z)), 0.0));
    let size = voxel_size();
    let steps = clamp(ceil(way / (1.4 * min(size.x, min(size.y, size.z)))), 1.0, 1024.0);
    let step = way / steps;
    var sum = 0.0;
    for (var i = 0.5; i < steps; i += 1.0) {
        sum += density_at(position + i * step * direction);
    }
    return cloud.sigma_t * sum * step;
}

/// Whether the scene lets the light through to a point.
fn sees_light(position: vec3f) -> bool {
    var layer = 0u;
    if light.layer_count > 1u {
        layer = shadow_face(position - light.position);
    }
    let clip = light.layers[layer].clip_from_world * vec4f(position, 1.0);
    return shadow_visible(shadow_map, i32(layer), clip, light.shadow_size, 1e-4);
}

/// The part of the light that comes as far as a point: cone, light map, shadow and transmittance; without the
/// squared distance.
fn share(position: vec3f) -> vec3f {
    var direction = -light.direction;
    var distance = 1e30;
    var tint = vec3f(1.0);
    if light.kind != LIGHT_DIRECTIONAL {
        let to_light = light.position - position;
        distance = max(length(to_light), 1e-12);
        direction = to_light / distance;
        if light.kind == LIGHT_SPOT {
            tint *= light_falloff(dot(-direction, light.direction), light.cos_inner, light.cos_outer);
            if light.has_map == 1u {
                let uv = light_map_uv(light.direction, light.map_right, light.map_up, -direction);
                tint *= textureSampleLevel(light_map, light_map_sampler, uv, 0.0).rgb;
            }
        }
    }
    if all(tint <= vec3f(0.0)) || !sees_light(position) {
        return vec3f(0.0);
    }
    return tint * exp(-optical_depth(position, direction, distance));
}

/// One over the squared distance, its mean over a voxel; 1 for parallel light.
fn mean_falloff_squared(position: vec3f, size: vec3f) -> f32 {
    let radius = min(size.x, min(size.y, size.z));
    let offset = light.position - position;
    if light.kind == LIGHT_DIRECTIONAL || dot(offset, offset) > 16.0 * radius * radius {
        return falloff_squared(position, 0.0);
    }
    // Near the light it changes within the voxel.
    var sum = 0.0;
    for (var i = 0u; i < 64u; i++) {
        let within = (vec3f(vec3u(i, i / 4u, i / 16u) % 4u) - 1.5) / 4.0;
        sum += falloff_squared(position + within * size, radius / 8.0);
    }
    return sum / 64.0;
}

/// How much of the light reaches each voxel.
@compute @workgroup_size(4, 4, 4)
fn cs_voxels(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(local_invocation_index) thread: u32,
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
) {
    var cells = textureDimensions(lit);
    cells.z /= cloud.lights;
    var collides = 0.0;
    if all(id < cells) {
        let size = (cloud.high - cloud.low) / vec3f(cells);
        let position = cloud.low + (vec3f(id) + 0.5) * size;
        var reached = vec3f(0.0);
        // The third channel is above 0 where there is medium in reach of interpolation.
        let here = textureSampleLevel(density, linear_sampler, (vec3f(id) + 0.5) / vec3f(cells), 0.0);
        if here.z > 0.0 {
            reached = share(position);
            collides = here.x * cloud.sigma_t * size.x * size.y * size.z * mean(reached)
                * mean_falloff_squared(position, size);
        }
        textureStore(lit, id + vec3u(0u, 0u, turn.index * cells.z), vec4f(reached, 1.0));
    }
    let sum = add_up(thread, collides);
    if thread == 0u {
        partial[(group.z * groups.y + group.y) * groups.x + group.x] = sum;
    }
}
