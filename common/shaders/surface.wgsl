// Depth and surfaces: direct light with hard shadows, attenuated on both ways.
// Needs view, phase, medium, light, kind, haze, arrival, shadow.

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

/// [`arrival`] with the light's map.
fn tinted_arrival(position: vec3f) -> Arrival {
    var found = arrival(position);
    if HAS_MAP {
        let uv = light_map_uv(light.direction, light.map_right, light.map_up, -found.direction);
        found.irradiance *= textureSampleLevel(light_map, light_map_sampler, uv, 0.0).rgb;
    }
    return found;
}

/// Size of a texel at `position` [m], where texels are as large as they appear there.
fn texel_size(position: vec3f) -> f32 {
    let size = 2.0 * length(light.layers[0].right) / light.shadow_size;
    if KIND == LIGHT_DIRECTIONAL {
        return size;
    }
    return size * length(position - light.position);
}

/// Whether `position` sees the light; looked up a little off the surface of unit normal `normal`.
fn sees_light(position: vec3f, normal: vec3f) -> bool {
    let lifted = position + 1.5 * texel_size(position) * normal;
    var index = 0u;
    if KIND == LIGHT_POINT {
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

    let light_here = tinted_arrival(surface.position);
    let cosine = dot(normal, light_here.direction);
    if cosine <= 0.0 || dot(facing, light_here.direction) <= 0.0 || !sees_light(surface.position, facing) {
        return vec4f(0.0);
    }
    let material = materials[surface.material];
    let mirrored = reflect(-to_eye, normal);
    let reflected =
        reflectance(material.k_d, material.k_s, material.exponent, dot(mirrored, light_here.direction));
    let passed = transmittance(distance + light_here.distance);
    return vec4f(light_here.irradiance * cosine * reflected * passed, 0.0);
}

/// What a deferred pass needs of a surface.
struct SurfaceData {
    /// Shading normal; w: Phong exponent.
    @location(0) normal: vec4f,
    @location(1) k_d: vec4f,
    @location(2) k_s: vec4f,
}

@fragment
fn fs_surface_data(surface: Surface) -> SurfaceData {
    let material = materials[surface.material];
    return SurfaceData(
        vec4f(normalize(surface.normal), material.exponent),
        vec4f(material.k_d, 1.0),
        vec4f(material.k_s, 1.0),
    );
}
