// Ray march through the shadow maps: adds one light's in-scattered radiance.
// Needs fullscreen, view, phase, medium, light, shadow.

struct March {
    /// Samples along a ray.
    steps: u32,
    /// 1: samples at equal steps of the angle at the light, 0: of distance.
    equiangular: u32,
    /// Where a ray that meets no surface ends [m].
    reach: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var<uniform> march: March;
@group(0) @binding(3) var depth_map: texture_depth_2d;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;
@group(1) @binding(2) var light_map: texture_2d<f32>;
@group(1) @binding(3) var light_map_sampler: sampler;

/// Part of the ray (from, to) [m] that lies in a cone of half angle below 90°; empty where from >= to.
fn cone_span(eye: vec3f, ray: vec3f, apex: vec3f, axis: vec3f, cos_angle: f32, end: f32) -> vec2f {
    let w = eye - apex;
    let along = vec2f(dot(axis, ray), dot(axis, w));
    let square = cos_angle * cos_angle;
    let a = along.x * along.x - square;
    let b = along.x * along.y - square * dot(ray, w);
    let c = along.y * along.y - square * dot(w, w);
    let discriminant = b * b - a * c;
    if abs(a) < 1e-6 {
        return vec2f(0.0, end);
    }
    if discriminant <= 0.0 {
        // Past the cone, or straight through its apex.
        return select(vec2f(0.0), vec2f(0.0, end), a > 0.0 && along.x > 0.0 && along.y >= 0.0);
    }
    // Roots without cancellation.
    let q = -(b + select(-1.0, 1.0, b >= 0.0) * sqrt(discriminant));
    let roots = vec2f(q / a, c / q);
    let low = min(roots.x, roots.y);
    let high = max(roots.x, roots.y);
    if a > 0.0 {
        // The ray runs towards one end of the double cone.
        return select(vec2f(0.0, min(low, end)), vec2f(max(high, 0.0), end), along.x > 0.0);
    }
    if along.y + 0.5 * (low + high) * along.x <= 0.0 {
        return vec2f(0.0);
    }
    return vec2f(max(low, 0.0), min(high, end));
}

fn phase(cos_theta: f32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < medium.lobe_count; i++) {
        sum += medium.lobes[i].weight * phase_lobe(medium.lobes[i].kind, medium.lobes[i].g, cos_theta);
    }
    return sum;
}

fn sees_light(position: vec3f) -> bool {
    var index = 0u;
    if light.kind == LIGHT_POINT {
        index = shadow_face(position - light.position);
    }
    let clip = light.layers[index].clip_from_world * vec4f(position, 1.0);
    return shadow_visible(shadow_map, i32(index), clip, light.shadow_size, 0.0);
}

/// In-scattered radiance per metre at `t` along the ray, attenuated on both ways.
fn in_scattering(ray: vec3f, t: f32) -> vec3f {
    let position = view.eye + t * ray;
    var towards = light.direction;
    var distance = 0.0;
    var irradiance = light.strength;
    if light.kind != LIGHT_DIRECTIONAL {
        let away = position - light.position;
        distance = max(length(away), 1e-12);
        towards = away / distance;
        irradiance /= distance * distance;
    }
    if light.kind == LIGHT_SPOT {
        irradiance *= light_falloff(dot(towards, light.direction), light.cos_inner, light.cos_outer);
        if light.has_map == 1u {
            let uv = light_map_uv(light.direction, light.map_right, light.map_up, towards);
            irradiance *= textureSampleLevel(light_map, light_map_sampler, uv, 0.0).rgb;
        }
    }
    if all(irradiance <= vec3f(0.0)) || !sees_light(position) {
        return vec3f(0.0);
    }
    let passed = medium_transmittance(medium.sigma_t, medium.grey, t + distance);
    return medium.sigma_s * phase(dot(towards, -ray)) * irradiance * passed;
}

/// Samples in the middle of equal steps of distance.
fn march_uniform(ray: vec3f, span: vec2f) -> vec3f {
    let step = (span.y - span.x) / f32(march.steps);
    var sum = vec3f(0.0);
    for (var i = 0u; i < march.steps; i++) {
        sum += in_scattering(ray, span.x + (f32(i) + 0.5) * step);
    }
    return sum * step;
}

/// Samples in the middle of equal steps of the angle at the light (Kulla and Fajardo 2012).
fn march_equiangular(ray: vec3f, span: vec2f) -> vec3f {
    let nearest = dot(light.position - view.eye, ray);
    let height = max(length(view.eye + nearest * ray - light.position), 1e-6 * march.reach);
    let first = atan((span.x - nearest) / height);
    let last = atan((span.y - nearest) / height);
    let step = (last - first) / f32(march.steps);
    var sum = vec3f(0.0);
    for (var i = 0u; i < march.steps; i++) {
        let tangent = tan(first + (f32(i) + 0.5) * step);
        let t = clamp(nearest + height * tangent, span.x, span.y);
        sum += in_scattering(ray, t) * (1.0 + tangent * tangent);
    }
    return sum * step * height;
}

@fragment
fn fs_march(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let ray = view_ray(view, pixel.xy);
    let end = min(view_distance(view, textureLoad(depth_map, vec2i(pixel.xy), 0), ray), march.reach);
    var span = vec2f(0.0, end);
    if light.kind == LIGHT_SPOT {
        span = cone_span(view.eye, ray, light.position, light.direction, light.cos_outer, end);
    }
    if span.y <= span.x {
        return vec4f(0.0);
    }
    if march.equiangular == 1u && light.kind != LIGHT_DIRECTIONAL {
        return vec4f(march_equiangular(ray, span), 0.0);
    }
    return vec4f(march_uniform(ray, span), 0.0);
}
