// Depth and surfaces: direct light with hard shadows, attenuated on both ways.
// Needs view, phase, medium, light, shadow.

struct Object {
    world_from_object: mat4x4f,
    /// Inverse transpose of the linear part.
    normal_from_object: mat4x4f,
}

struct Material {
    /// Diffuse reflectance.
    k_d: vec3f,
    /// Phong exponent.
    exponent: f32,
    /// Specular reflectance.
    k_s: vec3f,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> objects: array<Object>;
@group(0) @binding(2) var<storage, read> materials: array<Material>;
@group(0) @binding(3) var<uniform> medium: Medium;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;
@group(1) @binding(2) var light_map: texture_2d<f32>;
@group(1) @binding(3) var light_map_sampler: sampler;

struct Surface {
    @builtin(position) @invariant clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) @interpolate(flat) material: u32,
}

@vertex
fn vs_surface(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) material: u32,
    @builtin(instance_index) index: u32,
) -> Surface {
    let object = objects[index];
    let world = object.world_from_object * vec4f(position, 1.0);
    let turned = (object.normal_from_object * vec4f(normal, 0.0)).xyz;
    return Surface(view.clip_from_world * world, world.xyz, turned, material);
}

/// Light that arrives at a point: its direction, distance in the medium, and irradiance on a facing plane.
struct Arrival {
    direction: vec3f,
    distance: f32,
    irradiance: vec3f,
}

fn arrival(position: vec3f) -> Arrival {
    if light.kind == LIGHT_DIRECTIONAL {
        return Arrival(-light.direction, 0.0, light.strength);
    }
    let to_light = light.position - position;
    let distance = max(length(to_light), 1e-12);
    let direction = to_light / distance;
    var intensity = light.strength;
    if light.kind == LIGHT_SPOT {
        intensity *= light_falloff(dot(-direction, light.direction), light.cos_inner, light.cos_outer);
        if light.has_map == 1u {
            let uv = light_map_uv(light.direction, light.map_right, light.map_up, -direction);
            intensity *= textureSampleLevel(light_map, light_map_sampler, uv, 0.0).rgb;
        }
    }
    return Arrival(direction, distance, intensity / (distance * distance));
}

/// Size of a texel at `position` [m], where texels are as large as they appear there.
fn texel_size(position: vec3f) -> f32 {
    let size = 2.0 * length(light.layers[0].right) / light.shadow_size;
    if light.kind == LIGHT_DIRECTIONAL {
        return size;
    }
    return size * length(position - light.position);
}

/// Whether `position` sees the light; looked up a little off the surface of unit normal `normal`.
fn sees_light(position: vec3f, normal: vec3f) -> bool {
    let lifted = position + 1.5 * texel_size(position) * normal;
    var index = 0u;
    if light.kind == LIGHT_POINT {
        index = shadow_face(lifted - light.position);
    }
    let clip = light.layers[index].clip_from_world * vec4f(lifted, 1.0);
    return shadow_visible(shadow_map, i32(index), clip, light.shadow_size, 1e-3);
}

@fragment
fn fs_surface(surface: Surface) -> @location(0) vec4f {
    let away = surface.position - view.eye;
    let distance = length(away);
    let to_eye = -away / distance;
    // Both normals face the eye: surfaces have two sides.
    var facing = normalize(cross(dpdx(surface.position), dpdy(surface.position)));
    facing *= select(-1.0, 1.0, dot(facing, to_eye) >= 0.0);
    var normal = normalize(surface.normal);
    normal *= select(-1.0, 1.0, dot(normal, to_eye) >= 0.0);

    let light_here = arrival(surface.position);
    let cosine = dot(normal, light_here.direction);
    if cosine <= 0.0 || dot(facing, light_here.direction) <= 0.0 || !sees_light(surface.position, facing) {
        return vec4f(0.0);
    }
    let material = materials[surface.material];
    let mirrored = reflect(-to_eye, normal);
    let gloss = pow(max(dot(mirrored, light_here.direction), 0.0), material.exponent);
    let reflectance = material.k_d / PI + material.k_s * ((material.exponent + 2.0) / (2.0 * PI) * gloss);
    let passed = medium_transmittance(medium.sigma_t, medium.grey, distance + light_here.distance);
    return vec4f(light_here.irradiance * cosine * reflectance * passed, 0.0);
}
