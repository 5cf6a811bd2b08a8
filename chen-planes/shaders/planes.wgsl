// Sampling planes: lattices parallel to the screen, each for a slab of the view.
// Needs view, phase, medium, light, kind, haze, airlight, shadow.

struct Sampling {
    /// Texels of the phase function less one.
    last_phase_texel: f32,
    /// What one plane adds at most [W/m²/sr]: no sum of planes is beyond what the target holds.
    most: f32,
    /// What is nearer to a light than this counts as so far away [m].
    nearest: f32,
    /// Where the last slab's shadows end, even if the slab itself does not [m].
    reach: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var<uniform> sampling: Sampling;
@group(0) @binding(3) var scene_depth: texture_depth_2d;
@group(0) @binding(4) var phase_map: texture_2d<f32>;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;
@group(1) @binding(2) var light_map: texture_2d<f32>;
@group(1) @binding(3) var light_map_sampler: sampler;

const FACTOR_WHOLE: u32 = 0u;
const FACTOR_ATTENUATION: u32 = 1u;
const FACTOR_INTEGRATED: u32 = 2u;

/// Stands for infinity [m]; its square is a number too.
const INFINITE: f32 = 1e18;

/// One of FACTOR_*.
override factor: u32 = 0u;
/// Places within a slab where shadows are looked up; 0: at lattice points instead.
override samples: u32 = 1u;
/// 1: places are shifted pixel by pixel.
override pixel_offset: u32 = 0u;

/// A plane: three of its corners, and in the fourth components where its slab begins and ends and where it lies
/// itself, as depths along the viewing direction [m].
struct Plane {
    /// V0, slab's front.
    @location(1) v0: vec4f,
    /// V1, slab's back.
    @location(2) v1: vec4f,
    /// V3, plane.
    @location(3) v3: vec4f,
}

struct Fragment {
    @builtin(position) pixel: vec4f,
    /// What the lattice carries: xyz of [`lattice_factor`].
    @location(0) factor: vec3f,
    /// Light that arrives, of lattice points.
    @location(1) seen: vec3f,
    /// Front and back of the slab [m].
    @location(2) @interpolate(flat) slab: vec2f,
}

/// The smooth part of the integrand at a lattice point: ξ of (6) put right, without the step, or its attenuation alone.
fn lattice_factor(position: vec3f) -> vec3f {
    let t = distance(position, view.eye);
    if KIND == LIGHT_DIRECTIONAL {
        return transmittance(t);
    }
    let r = max(distance(position, light.position), sampling.nearest);
    let passed = transmittance(t + r);
    if factor == FACTOR_WHOLE {
        return passed / (r * r);
    }
    return passed;
}

/// Whether a point sees the light: H of (4).
fn sees_light(position: vec3f) -> bool {
    var index = 0u;
    if KIND == LIGHT_POINT {
        index = shadow_face(position - light.position);
    } else if KIND == LIGHT_SPOT && factor != FACTOR_INTEGRATED {
        // Where spans do not end at the cone, the cone is an edge like others.
        let towards = position - light.position;
        if dot(towards, light.direction) < light.cos_outer * length(towards) {
            return false;
        }
    }
    let clip = light.layers[index].clip_from_world * vec4f(position, 1.0);
    return shadow_visible(shadow_map, i32(index), clip, light.shadow_size, 0.0);
}

/// Part of the light's strength that goes towards a point, in its cone: falloff and light map, I of (4).
fn arriving(position: vec3f) -> vec3f {
    if KIND != LIGHT_SPOT {
        return vec3f(1.0);
    }
    let away = position - light.position;
    let towards = away / max(length(away), sampling.nearest);
    // Rounding must not take a span that ends at the cone off its edge.
    let cosine = max(dot(towards, light.direction), light.cos_outer);
    var intensity = vec3f(light_falloff(cosine, light.cos_inner, light.cos_outer));
    if HAS_MAP {
        let uv = light_map_uv(light.direction, light.map_right, light.map_up, towards);
        intensity *= textureSampleLevel(light_map, light_map_sampler, uv, 0.0).rgb;
    }
    return intensity;
}

@vertex
fn vs_plane(@location(0) uv: vec2f, plane: Plane) -> Fragment {
    // (9)
    let position = uv.y * (plane.v3.xyz - plane.v0.xyz) + uv.x * (plane.v1.xyz - plane.v0.xyz) + plane.v0.xyz;
    // On the same ray, but where the slab begins: the depth test ends what lies wholly behind the scene.
    let front = max(plane.v0.w, 1.001 * view.near) / plane.v3.w;
    var fragment: Fragment;
    // From the eye, whose own clip position is zero but for its depth: a front that is near, or an eye that is far from
    // the origin, would be lost in the difference of world positions. The depth is that of the scene's buffer, and its
    // end where there is a far plane in front.
    let clip = view.clip_from_world * vec4f(front * (position - view.eye), 0.0);
    fragment.pixel = vec4f(clip.xy, clip.w * clamp(view_depth(view, clip.w), 0.0, 1.0), clip.w);
    fragment.slab = vec2f(plane.v0.w, plane.v1.w);
    if factor != FACTOR_INTEGRATED {
        fragment.factor = lattice_factor(position);
    }
    if samples == 0u {
        fragment.seen = select(vec3f(0.0), arriving(position), sees_light(position));
    }
    return fragment;
}

/// Phase function, RGB [1/sr]: texels dense towards both ends, where phase functions peak.
fn phase_from_map(cos_theta: f32) -> vec3f {
    if LOBES == 1u && LOBE_0 == LOBE_ISOTROPIC {
        return phase(cos_theta);
    }
    let s = 0.5 * sqrt(max(1.0 - abs(cos_theta), 0.0));
    let at = select(s, 1.0 - s, cos_theta >= 0.0) * sampling.last_phase_texel;
    let low = min(floor(at), sampling.last_phase_texel - 1.0);
    let a = textureLoad(phase_map, vec2i(i32(low), 0), 0).rgb;
    let b = textureLoad(phase_map, vec2i(i32(low) + 1, 0), 0).rgb;
    return mix(a, b, at - low);
}

/// Where within a step samples are taken, in (0, 1): its middle, or interleaved gradient noise (Jimenez 2014), which
/// differs most among neighbouring pixels.
fn sample_offset(pixel: vec2f) -> f32 {
    if pixel_offset == 0u {
        return 0.5;
    }
    let cell = floor(pixel);
    return fract(52.9829189 * fract(dot(cell, vec2f(0.06711056, 0.00583715))));
}

/// A slab's part of a view ray.
struct Span {
    ray: vec3f,
    /// Where it begins and ends [m].
    x: vec2f,
    /// Distance along the ray to the foot of the perpendicular from the light, and its length [m].
    along: f32,
    height: f32,
    /// Clip coordinates in the shadow map, of the eye and of a metre along the ray; not of a point light.
    clip_eye: vec4f,
    clip_ray: vec4f,
}

/// Whether the place at a distance sees the light.
fn sees_light_along(span: Span, x: f32) -> bool {
    if KIND == LIGHT_POINT {
        return sees_light(view.eye + x * span.ray);
    }
    if KIND == LIGHT_SPOT && factor != FACTOR_INTEGRATED {
        return sees_light(view.eye + x * span.ray);
    }
    let clip = span.clip_eye + x * span.clip_ray;
    return shadow_visible(shadow_map, 0, clip, light.shadow_size, 0.0);
}

/// Airlight per strength of the light, without the scattering coefficient, from equal steps of distance: the smooth
/// factor is the lattice's, and lattice points have seen `seen` of the light if no fragment looks. Here and below shadows
/// choose and do not branch: with branches in these sums Mesa 22.3.6's lavapipe crashed when it made the pipelines.
fn sampled(span: Span, offset: f32, lattice: vec3f, seen: vec3f) -> vec3f {
    let places = max(samples, 1u);
    let step = (span.x.y - span.x.x) / f32(places);
    var sum = vec3f(0.0);
    for (var i = 0u; i < places; i += 1u) {
        let place = span.x.x + (f32(i) + offset) * step;
        var value = seen;
        if samples > 0u {
            value = select(vec3f(0.0), arriving(view.eye + place * span.ray), sees_light_along(span, place));
        }
        if KIND == LIGHT_DIRECTIONAL {
            sum += value * phase_from_map(-dot(light.direction, span.ray));
            continue;
        }
        // What is smooth is found in the middle of the step, whatever the offset: it stays of second order.
        let x = span.x.x + (f32(i) + 0.5) * step;
        let r = max(length(vec2f(span.height, x - span.along)), sampling.nearest);
        if factor == FACTOR_ATTENUATION {
            value /= r * r;
        }
        sum += value * phase_from_map((span.along - x) / r);
    }
    return lattice * sum * step;
}

/// Product of complex numbers: the sum of their angles.
fn product(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

/// Distance along the ray [m] to what is seen from the light at the angle of that cosine and sine.
fn distance_at(span: Span, angle: vec2f) -> f32 {
    return clamp(span.along + span.height * angle.y / max(angle.x, 1e-30), span.x.x, span.x.y);
}

/// The same without a lattice, in equal steps of the angle at the light: dt / r² = dangle / height.
fn integrated(span: Span, offset: f32, seen: vec3f) -> vec3f {
    let places = max(samples, 1u);
    let ends = atan((span.x - span.along) / span.height);
    let step = (ends.y - ends.x) / f32(places);
    // Cosine and sine of the angle in the middle of a step, turned by a step each time; and of the place's angle
    // relative to it.
    let middle = ends.x + 0.5 * step;
    var turned = vec2f(cos(middle), sin(middle));
    let turn = vec2f(cos(step), sin(step));
    let shift = vec2f(cos((offset - 0.5) * step), sin((offset - 0.5) * step));
    var sum = vec3f(0.0);
    for (var i = 0u; i < places; i += 1u) {
        let smooth_at = turned;
        turned = product(turned, turn);
        var value = seen;
        if samples > 0u {
            let place = distance_at(span, product(smooth_at, shift));
            value = select(vec3f(0.0), arriving(view.eye + place * span.ray), sees_light_along(span, place));
        }
        let x = distance_at(span, smooth_at);
        let r = length(vec2f(span.height, x - span.along));
        sum += value * phase_from_map(-smooth_at.y) * transmittance(x + r);
    }
    return sum * step / span.height;
}

fn attenuated_lengths(x: f32) -> vec3f {
    return vec3f(
        attenuated_length(medium.sigma_t.x, x),
        attenuated_length(medium.sigma_t.y, x),
        attenuated_length(medium.sigma_t.z, x),
    );
}

/// The same for parallel light, in equal steps of distance up to where shadows end; each passes its exact share.
fn integrated_directional(span: Span, shadows_end: f32, offset: f32, seen: vec3f) -> vec3f {
    let places = max(samples, 1u);
    let end = clamp(span.x.y, span.x.x, max(shadows_end, span.x.x));
    let step = (end - span.x.x) / f32(places);
    let passes = transmittance(step);
    var passed = vec3f(1.0);
    var sum = vec3f(0.0);
    for (var i = 0u; i < places; i += 1u) {
        if samples == 0u {
            sum += seen * passed;
        } else if sees_light_along(span, span.x.x + (f32(i) + offset) * step) {
            sum += passed;
        }
        passed *= passes;
    }
    // Behind all that casts shadows, light goes on and on.
    let value = sum * attenuated_lengths(step) + passed * attenuated_lengths(span.x.y - end);
    let before = transmittance(span.x.x);
    return value * before * phase_from_map(-dot(light.direction, span.ray));
}

@fragment
fn fs_plane(fragment: Fragment) -> @location(0) vec4f {
    let ray = view_ray(view, fragment.pixel.xy);
    let stretch = 1.0 / dot(ray, view.forward);
    let scene = view_distance(view, textureLoad(scene_depth, vec2i(fragment.pixel.xy), 0), ray);
    // The last partial interval before a surface has its true length.
    let t = vec2f(fragment.slab.x * stretch, min(min(fragment.slab.y * stretch, scene), INFINITE));
    if t.y <= t.x {
        return vec4f(0.0);
    }
    let offset = sample_offset(fragment.pixel.xy);
    let layer = light.layers[0].clip_from_world;
    var span = Span(ray, t, 0.0, 0.0, layer * vec4f(view.eye, 1.0), layer * vec4f(ray, 0.0));
    if KIND != LIGHT_DIRECTIONAL {
        let foot = foot_of(view.eye, ray, light.position);
        span.along = foot.along;
        span.height = foot.height;
    }
    var value: vec3f;
    if factor != FACTOR_INTEGRATED {
        value = sampled(span, offset, fragment.factor, fragment.seen);
    } else if KIND == LIGHT_DIRECTIONAL {
        value = integrated_directional(span, sampling.reach * stretch, offset, fragment.seen);
    } else {
        if KIND == LIGHT_SPOT {
            // No place is wasted outside the cone.
            let cone = cone_interval(view.eye - light.position, ray, light.direction, light.cos_outer);
            span.x = clamp(cone, t.xx, t.yy);
            if span.x.y <= span.x.x {
                discard;
            }
        }
        value = integrated(span, offset, fragment.seen);
    }
    return vec4f(min(medium.sigma_s * light.strength * value, vec3f(sampling.most)), 0.0);
}
