// Lights: what they send where. Twin: common/src/light.rs.

const LIGHT_POINT: u32 = 0u;
const LIGHT_SPOT: u32 = 1u;
const LIGHT_DIRECTIONAL: u32 = 2u;

/// One projection of a shadow map: a camera at the light.
struct ShadowLayer {
    clip_from_world: mat4x4f,
    /// Apex [m]; for a directional light the centre of the near plane.
    origin: vec3f,
    /// Half extent at distance 1 (directional: at any distance [m]) of the square that the centres of
    /// the border texels span.
    right: vec3f,
    up: vec3f,
    /// Unit viewing direction.
    forward: vec3f,
}

struct Light {
    /// Point, spot: position [m].
    position: vec3f,
    /// One of LIGHT_*.
    kind: u32,
    /// Spot, directional: the way the light travels, unit length.
    direction: vec3f,
    /// Spot: cosine of the cone of whole intensity.
    cos_inner: f32,
    /// Intensity [W/sr] or irradiance [W/m²], RGB.
    strength: vec3f,
    /// Spot: cosine of the cone.
    cos_outer: f32,
    /// Spot: unit vectors of the light map, divided by the cone's tangent.
    map_right: vec3f,
    /// Spot: 1 where a light map tints the intensity.
    has_map: u32,
    map_up: vec3f,
    /// Texels on a side of the shadow map.
    shadow_size: f32,
    /// Projections in use: 6 for a point light, else 1.
    layer_count: u32,
    /// Near plane of a point or spot's projections [m]; for a directional light 0.
    near: f32,
    /// What an empty texel stands for [m]: so far away that what lies behind makes no difference.
    far: f32,
    /// Directional: distance from the near to the far plane of the projection [m].
    range: f32,
    layers: array<ShadowLayer, 6>,
}

/// Fraction of a spot's axis intensity at `cos_angle` from the axis (KHR_lights_punctual).
fn light_falloff(cos_angle: f32, cos_inner: f32, cos_outer: f32) -> f32 {
    let width = cos_inner - cos_outer;
    let ramp = clamp((cos_angle - cos_outer) / width, 0.0, 1.0);
    let share = select(ramp * ramp, 1.0, width < 1e-6);
    return select(share, 0.0, cos_angle < cos_outer);
}

/// Where in its light map a spot's `direction` is, in [0, 1]²; row 0 at the top.
fn light_map_uv(axis: vec3f, map_right: vec3f, map_up: vec3f, direction: vec3f) -> vec2f {
    let along = max(dot(axis, direction), 1e-6);
    return vec2f(dot(map_right, direction), -dot(map_up, direction)) / along * 0.5 + 0.5;
}
