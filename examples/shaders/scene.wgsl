// Surfaces, lit by a lamp and by the sun with shadows, and dimmed by fog on the way to the eye.

struct Frame {
    clip_from_world: mat4x4f,
    lamp_clip_from_world: mat4x4f,
    sun_clip_from_world: mat4x4f,
    /// w: extinction coefficient [1/m].
    eye: vec4f,
    /// w: cosine of the cone.
    lamp_position: vec4f,
    /// w: cosine of the cone of whole intensity.
    lamp_direction: vec4f,
    lamp_intensity: vec4f,
    sun_direction: vec4f,
    sun_irradiance: vec4f,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var lamp_map: texture_depth_2d;
@group(0) @binding(2) var sun_map: texture_depth_2d;
@group(0) @binding(3) var nearer: sampler_comparison;

struct Surface {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
}

@vertex
fn vs_scene(@location(0) position: vec3f, @location(1) normal: vec3f, @location(2) colour: vec3f) -> Surface {
    return Surface(frame.clip_from_world * vec4f(position, 1.0), position, normal, colour);
}

/// 1 where the place sees the light.
fn seen(map: texture_depth_2d, clip: vec4f) -> f32 {
    let ndc = clip.xyz / clip.w;
    let uv = ndc.xy * vec2f(0.5, -0.5) + 0.5;
    let outside = clip.w <= 0.0 || any(uv < vec2f(0.0)) || any(uv > vec2f(1.0));
    return select(textureSampleCompareLevel(map, nearer, uv, ndc.z), 1.0, outside);
}

@fragment
fn fs_scene(surface: Surface) -> @location(0) vec4f {
    // A step away from the surface, so that it does not shadow itself.
    let place = vec4f(surface.position + 0.03 * surface.normal, 1.0);
    let sigma_t = frame.eye.w;

    let away = surface.position - frame.lamp_position.xyz;
    let distance = length(away);
    let cosine = dot(away / distance, frame.lamp_direction.xyz);
    let ramp = saturate((cosine - frame.lamp_position.w) / (frame.lamp_direction.w - frame.lamp_position.w));
    let lamp = frame.lamp_intensity.xyz * ramp * ramp * exp(-sigma_t * distance) / (distance * distance)
        * max(-dot(surface.normal, away / distance), 0.0)
        * seen(lamp_map, frame.lamp_clip_from_world * place);
    let sun = frame.sun_irradiance.xyz * max(-dot(surface.normal, frame.sun_direction.xyz), 0.0)
        * seen(sun_map, frame.sun_clip_from_world * place);

    let dimmed = exp(-sigma_t * length(surface.position - frame.eye.xyz));
    return vec4f(surface.colour / 3.14159265 * (lamp + sun) * dimmed, 1.0);
}
