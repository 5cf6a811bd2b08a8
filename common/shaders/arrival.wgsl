// Light that arrives at a surface, and what the surface reflects of it. Needs light, kind; and the
// global `light: Light`.

/// Light that arrives at a point: its direction, distance in the medium, and irradiance on a facing plane.
struct Arrival {
    direction: vec3f,
    distance: f32,
    irradiance: vec3f,
}

/// Without the light's map.
fn arrival(position: vec3f) -> Arrival {
    if KIND == LIGHT_DIRECTIONAL {
        return Arrival(-light.direction, 0.0, light.strength);
    }
    let to_light = light.position - position;
    let distance = max(length(to_light), 1e-12);
    let direction = to_light / distance;
    var intensity = light.strength;
    if KIND == LIGHT_SPOT {
        intensity *= light_falloff(dot(-direction, light.direction), light.cos_inner, light.cos_outer);
    }
    return Arrival(direction, distance, intensity / (distance * distance));
}

/// `k_d/π + k_s (n+2)/2π cosⁿ` [1/sr]; `cosine` between the light and the mirrored direction of the eye.
fn reflectance(k_d: vec3f, k_s: vec3f, exponent: f32, cosine: f32) -> vec3f {
    let gloss = pow(max(cosine, 0.0), exponent);
    return k_d / 3.14159265358979 + k_s * ((exponent + 2.0) / 6.28318530717959 * gloss);
}
