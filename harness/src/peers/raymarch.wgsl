// Ray march through the shadow map of one light: adds its in-scattered radiance.
// Needs fullscreen, view, phase, medium, light, ray, and the peers' light.

struct March {
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

/// Samples along a ray.
override STEPS: u32 = 64u;
/// Whether where in its step a sample lies differs from pixel to pixel, or is its middle.
override OFFSET: bool = false;
/// Whether steps are equal in the angle at the light, or in distance.
override EQUIANGULAR: bool = false;

/// Interleaved gradient noise in [0, 1) (Jimenez 2014, "Next Generation Post Processing in Call of Duty: Advanced
/// Warfare"): any 3x3 pixels hold values about evenly spread.
fn interleaved_gradient_noise(pixel: vec2f) -> f32 {
    return fract(52.9829189 * fract(dot(floor(pixel), vec2f(0.06711056, 0.00583715))));
}

/// What a step of length `step` [m] counts by a sample at `offset` of it, so that the medium's attenuation over the
/// step is integrated and only the rest is sampled (Hillaire 2015). With a homogeneous medium it is
/// the same for all steps of a ray, and costs nothing.
fn step_weight(step: f32, offset: f32) -> vec3f {
    let tau = medium.sigma_t * step;
    // (1 - exp(-tau)) / tau · exp(offset tau); a series where the difference would lose its digits.
    let series = 1.0 - tau * (0.5 - tau * (1.0 / 6.0 - tau / 24.0));
    let share = select((1.0 - exp(-tau)) / max(tau, vec3f(1e-30)), series, tau < vec3f(0.05));
    // What is that dense is black: the samples have no light left, but infinity of it would be no number.
    return step * share * exp(min(offset * tau, vec3f(80.0)));
}

/// Equal steps of distance, in the light of a point or spot. Here and below shadows choose and do not branch: with a branch
/// around the sum Mesa 22.3.6's lavapipe crashed when it made the pipelines.
fn march_uniform(ray: vec3f, span: vec2f, offset: f32) -> vec3f {
    let step = (span.y - span.x) / f32(STEPS);
    let nearest = nearest_to(view.eye, ray, light.position, 0.0);
    let square = max(nearest.height * nearest.height, 1e-12 * step * step);
    let start = shadow_place(view.eye, 1.0);
    let slope = shadow_place(ray, 0.0);
    let apart = view.eye - light.position;
    var sum = vec3f(0.0);
    for (var i = 0u; i < STEPS; i++) {
        let t = span.x + (f32(i) + offset) * step;
        let beyond = t - nearest.along;
        let inverse = inverseSqrt(square + beyond * beyond);
        let distance = (square + beyond * beyond) * inverse;
        let sent = directed(apart + t * ray, distance) * (inverse * inverse);
        let passed = sent * phase(-beyond * inverse) * transmittance(t + distance);
        sum += select(vec3f(0.0), passed, sees_light(start + t * slope));
    }
    return sum * step_weight(step, offset);
}

/// Equal steps of the angle at the light (Kulla and Fajardo 2012). The inverse square of the distance is what a step
/// of the angle takes back, and sines and cosines follow from those of the step before by rotation.
fn march_equiangular(ray: vec3f, span: vec2f, offset: f32) -> vec3f {
    let nearest = nearest_to(view.eye, ray, light.position, 1e-6 * march.reach);
    let height = nearest.height;
    let ends = span - nearest.along;
    let step = atan2(height * (ends.y - ends.x), height * height + ends.x * ends.y) / f32(STEPS);
    let turn = vec2f(cos(step), sin(step));
    // Cosine and sine of the angle, at the first sample.
    var angle = rotate(vec2f(height, ends.x) / length(vec2f(height, ends.x)), vec2f(cos(offset * step), sin(offset * step)));
    let start = shadow_place(view.eye, 1.0);
    let slope = shadow_place(ray, 0.0);
    let apart = view.eye - light.position;
    var sum = vec3f(0.0);
    for (var i = 0u; i < STEPS; i++) {
        let distance = height / max(angle.x, 1e-7);
        let t = clamp(nearest.along + distance * angle.y, span.x, span.y);
        let passed = directed(apart + t * ray, distance) * phase(-angle.y) * transmittance(t + distance);
        sum += select(vec3f(0.0), passed, sees_light(start + t * slope));
        angle = rotate(angle, turn);
    }
    return sum * step / height;
}

fn rotate(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.y * b.x + a.x * b.y);
}

/// Equal steps of distance, in the light of a directional light: one phase angle, and no way to the light to pass.
fn march_directional(ray: vec3f, span: vec2f, offset: f32) -> vec3f {
    let step = (span.y - span.x) / f32(STEPS);
    let start = shadow_place(view.eye, 1.0);
    let slope = shadow_place(ray, 0.0);
    var sum = vec3f(0.0);
    for (var i = 0u; i < STEPS; i++) {
        let t = span.x + (f32(i) + offset) * step;
        sum += select(vec3f(0.0), transmittance(t), sees_light(start + t * slope));
    }
    return sum * step_weight(step, offset) * phase(-dot(light.direction, ray));
}

@fragment
fn fs_march(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let ray = view_ray(view, pixel.xy);
    let end = min(view_distance(view, textureLoad(depth_map, vec2i(pixel.xy), 0), ray), march.reach);
    var span = vec2f(0.0, end);
    if KIND == LIGHT_SPOT {
        span = cone_span(view.eye, ray, light.position, light.direction, light.cos_outer, end);
    }
    span.y = max(span.x, span.y);
    let offset = select(0.5, interleaved_gradient_noise(pixel.xy), OFFSET);
    var sum = vec3f(0.0);
    if KIND == LIGHT_DIRECTIONAL {
        sum = march_directional(ray, span, offset);
    } else if EQUIANGULAR {
        sum = march_equiangular(ray, span, offset);
    } else {
        sum = march_uniform(ray, span, offset);
    }
    return vec4f(light.strength * medium.sigma_s * sum, 0.0);
}
