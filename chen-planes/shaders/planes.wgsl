// Sampling planes: lattices parallel to the screen, each for a slab of the view.
// Needs view, phase, medium, light, airlight, shadow.

struct Sampling {
    /// Texels of the phase function less one.
    last_phase_texel: f32,
    /// 1: the phase function is the same into all directions.
    isotropic: u32,
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
/// How often the way between two places, one lit and one not, is halved to find the edge of the shadow.
override bisections: u32 = 0u;
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
    if light.kind == LIGHT_DIRECTIONAL {
        return medium_transmittance(medium.sigma_t, medium.grey, t);
    }
    let r = max(distance(position, light.position), sampling.nearest);
    let passed = medium_transmittance(medium.sigma_t, medium.grey, t + r);
    if factor == FACTOR_WHOLE {
        return passed / (r * r);
    }
    return passed;
}

/// Whether a point sees the light: H of (4).
fn sees_light(position: vec3f) -> bool {
    var index = 0u;
    if light.kind == LIGHT_POINT {
        index = shadow_face(position - light.position);
    } else if light.kind == LIGHT_SPOT && factor != FACTOR_INTEGRATED {
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
    if light.kind != LIGHT_SPOT {
        return vec3f(1.0);
    }
    let away = position - light.position;
    let towards = away / max(length(away), sampling.nearest);
    // Rounding must not take a span that ends at the cone off its edge.
    let cosine = max(dot(towards, light.direction), light.cos_outer);
    var intensity = vec3f(light_falloff(cosine, light.cos_inner, light.cos_outer));
    if light.has_map == 1u {
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
    fragment.pixel = view.clip_from_world * vec4f(mix(view.eye, position, front), 1.0);
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
    if sampling.isotropic == 1u {
        return vec3f(1.0 / (4.0 * PI));
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
    /// From and to [m].
    x: vec2f,
    /// Distance along the ray to the foot of the perpendicular from the light, and its length [m].
    along: f32,
    height: f32,
    /// Whether the ray is parted in equal steps of the angle at the light, else of distance.
    angular: bool,
    /// What lattice points around carry.
    factor: vec3f,
    seen: vec3f,
}

/// Distance [m] that a parameter of the span (angle or distance) stands for.
fn span_distance(span: Span, parameter: f32) -> f32 {
    if span.angular {
        return clamp(span.along + span.height * tan(parameter), span.x.x, span.x.y);
    }
    return parameter;
}

/// What scatters towards the eye at a distance, per step of the parameter and strength of the light, shadows and the
/// scattering coefficient left out: dt / r² = dangle / height.
fn integrand(span: Span, x: f32) -> vec3f {
    if light.kind == LIGHT_DIRECTIONAL {
        let phase = phase_from_map(-dot(light.direction, span.ray));
        if factor == FACTOR_INTEGRATED {
            return phase * medium_transmittance(medium.sigma_t, medium.grey, x);
        }
        return phase * span.factor;
    }
    let r = length(vec2f(span.height, x - span.along));
    let phase = phase_from_map((span.along - x) / r);
    if factor == FACTOR_INTEGRATED {
        return phase * medium_transmittance(medium.sigma_t, medium.grey, x + r) / span.height;
    }
    if factor == FACTOR_ATTENUATION {
        return phase * span.factor / (r * r);
    }
    return phase * span.factor;
}

/// The slab's airlight from samples within equal steps between two parameters.
fn sampled(span: Span, first: f32, end: f32, offset: f32) -> vec3f {
    let places = max(samples, 1u);
    let step = (end - first) / f32(places);
    var sum = vec3f(0.0);
    for (var i = 0u; i < places; i += 1u) {
        let x = span_distance(span, first + (f32(i) + offset) * step);
        var seen = span.seen;
        if samples > 0u {
            let position = view.eye + x * span.ray;
            seen = select(vec3f(0.0), arriving(position), sees_light(position));
        }
        if any(seen > vec3f(0.0)) {
            sum += seen * integrand(span, x);
        }
    }
    return sum * step;
}

/// The same, but between samples that differ the edge of the shadow is looked for.
fn bisected(span: Span, first: f32, end: f32, offset: f32) -> vec3f {
    let step = (end - first) / f32(samples);
    var sum = vec3f(0.0);
    var last = first;
    var lit_last = sees_light(view.eye + span_distance(span, last) * span.ray);
    for (var i = 1u; i <= samples; i += 1u) {
        let next = select(first + (f32(i) + offset - 0.5) * step, end, i == samples);
        let lit_next = sees_light(view.eye + span_distance(span, next) * span.ray);
        var lit = vec2f(last, next);
        if lit_last != lit_next {
            var edge = lit;
            for (var j = 0u; j < bisections; j += 1u) {
                let middle = 0.5 * (edge.x + edge.y);
                let as_last = sees_light(view.eye + span_distance(span, middle) * span.ray) == lit_last;
                edge = select(vec2f(edge.x, middle), vec2f(middle, edge.y), as_last);
            }
            let middle = 0.5 * (edge.x + edge.y);
            lit = select(vec2f(middle, next), vec2f(last, middle), lit_last);
        }
        if lit_last || lit_next {
            let x = span_distance(span, 0.5 * (lit.x + lit.y));
            sum += (lit.y - lit.x) * arriving(view.eye + x * span.ray) * integrand(span, x);
        }
        last = next;
        lit_last = lit_next;
    }
    return sum;
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
    var span = Span(ray, t, 0.0, 0.0, false, fragment.factor, fragment.seen);
    var ends = t;
    var value = vec3f(0.0);
    if light.kind != LIGHT_DIRECTIONAL {
        let foot = foot_of(view.eye, ray, light.position);
        span.along = foot.along;
        span.height = max(foot.height, sampling.nearest);
        span.angular = factor == FACTOR_INTEGRATED;
        if span.angular {
            if light.kind == LIGHT_SPOT {
                // No place is wasted outside the cone.
                let cone = cone_interval(view.eye - light.position, ray, light.direction, light.cos_outer);
                span.x = clamp(cone, t.xx, t.yy);
                if span.x.y <= span.x.x {
                    return vec4f(0.0);
                }
            }
            ends = atan((span.x - span.along) / span.height);
        }
    } else if factor == FACTOR_INTEGRATED && t.y > sampling.reach * stretch {
        // Parallel light behind all that casts shadows goes on and on.
        ends.y = max(sampling.reach * stretch, t.x);
        let rest = t.y - ends.y;
        let whole = vec3f(
            attenuated_length(medium.sigma_t.x, rest),
            attenuated_length(medium.sigma_t.y, rest),
            attenuated_length(medium.sigma_t.z, rest),
        );
        value = integrand(span, ends.y) * whole;
    }
    let offset = sample_offset(fragment.pixel.xy);
    if bisections > 0u && samples > 0u {
        value += bisected(span, ends.x, ends.y, offset);
    } else {
        value += sampled(span, ends.x, ends.y, offset);
    }
    return vec4f(min(medium.sigma_s * light.strength * value, vec3f(sampling.most)), 0.0);
}
