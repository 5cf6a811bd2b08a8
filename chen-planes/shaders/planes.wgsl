// Sampling planes: lattices parallel to the screen, each for a slab of the view.
// Needs view, phase, medium, light, shadow.

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

/// Part of the light's strength that gets to a point: its falloff, light map and shadow; H and I of (4).
fn seen_light(position: vec3f) -> vec3f {
    var index = 0u;
    var tint = vec3f(1.0);
    if light.kind == LIGHT_POINT {
        index = shadow_face(position - light.position);
    } else if light.kind == LIGHT_SPOT {
        let away = position - light.position;
        let towards = away / max(length(away), sampling.nearest);
        let falloff = light_falloff(dot(towards, light.direction), light.cos_inner, light.cos_outer);
        if falloff <= 0.0 {
            return vec3f(0.0);
        }
        tint = vec3f(falloff);
        if light.has_map == 1u {
            let uv = light_map_uv(light.direction, light.map_right, light.map_up, towards);
            tint *= textureSampleLevel(light_map, light_map_sampler, uv, 0.0).rgb;
        }
    }
    let clip = light.layers[index].clip_from_world * vec4f(position, 1.0);
    return select(vec3f(0.0), tint, shadow_visible(shadow_map, i32(index), clip, light.shadow_size, 0.0));
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
        fragment.seen = seen_light(position);
    }
    return fragment;
}

/// Phase function, RGB [1/sr]: texels dense towards both ends, where phase functions peak.
fn phase_of_medium(cos_theta: f32) -> vec3f {
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

/// Light seen at a distance along a ray, or what the lattice points around saw.
fn seen_along(ray: vec3f, x: f32, lattice: vec3f) -> vec3f {
    if samples == 0u {
        return lattice;
    }
    return seen_light(view.eye + x * ray);
}

/// Airlight of a slab between two distances along a ray, per strength of the light and without the scattering
/// coefficient: distances at equal steps, the smooth part from the lattice.
fn sampled(ray: vec3f, t: vec2f, offset: f32, fragment: Fragment) -> vec3f {
    let places = max(samples, 1u);
    let step = (t.y - t.x) / f32(places);
    var sum = vec3f(0.0);
    for (var i = 0u; i < places; i += 1u) {
        let x = t.x + (f32(i) + offset) * step;
        var value = seen_along(ray, x, fragment.seen);
        if light.kind == LIGHT_DIRECTIONAL {
            sum += value * phase_of_medium(-dot(light.direction, ray));
            continue;
        }
        let away = view.eye + x * ray - light.position;
        let r = max(length(away), sampling.nearest);
        if factor == FACTOR_ATTENUATION {
            value /= r * r;
        }
        sum += value * phase_of_medium(-dot(away, ray) / r);
    }
    return fragment.factor * sum * step;
}

/// As [`sampled`], in equal steps of the angle at the light: dt / r² = dangle / height.
fn integrated(ray: vec3f, t: vec2f, offset: f32, seen: vec3f) -> vec3f {
    let places = max(samples, 1u);
    let to_light = light.position - view.eye;
    let along = dot(to_light, ray);
    // By the cross product: sqrt(l² - along²) cancels.
    let height = max(length(cross(to_light, ray)), sampling.nearest);
    let low = atan((t.x - along) / height);
    let step = (atan((t.y - along) / height) - low) / f32(places);
    var sum = vec3f(0.0);
    for (var i = 0u; i < places; i += 1u) {
        let angle = low + (f32(i) + offset) * step;
        let x = clamp(along + height * tan(angle), t.x, t.y);
        let value = seen_along(ray, x, seen);
        if any(value > vec3f(0.0)) {
            let r = length(vec2f(height, x - along));
            let passed = medium_transmittance(medium.sigma_t, medium.grey, x + r);
            sum += value * passed * phase_of_medium((along - x) / r);
        }
    }
    return sum * step / height;
}

/// (1 - exp(-sigma x)) / sigma, without cancellation for thin media.
fn attenuated_length(sigma: f32, x: f32) -> f32 {
    let tau = sigma * x;
    if tau < 1e-2 {
        return x * (1.0 - tau * (0.5 - tau * (1.0 / 6.0 - tau / 24.0)));
    }
    return (1.0 - exp(-tau)) / sigma;
}

/// As [`integrated`] for parallel light: the mean of what the samples see, times the exact integral.
fn integrated_directional(ray: vec3f, t: vec2f, seen_to: f32, offset: f32, seen: vec3f) -> vec3f {
    let places = max(samples, 1u);
    let step = (min(t.y, seen_to) - t.x) / f32(places);
    var sum = vec3f(0.0);
    for (var i = 0u; i < places; i += 1u) {
        sum += seen_along(ray, t.x + (f32(i) + offset) * step, seen);
    }
    let length = t.y - t.x;
    let whole = vec3f(
        attenuated_length(medium.sigma_t.x, length),
        attenuated_length(medium.sigma_t.y, length),
        attenuated_length(medium.sigma_t.z, length),
    );
    let passed = medium_transmittance(medium.sigma_t, medium.grey, t.x);
    return sum / f32(places) * passed * whole * phase_of_medium(-dot(light.direction, ray));
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
    var value: vec3f;
    if factor != FACTOR_INTEGRATED {
        value = sampled(ray, t, offset, fragment);
    } else if light.kind == LIGHT_DIRECTIONAL {
        value = integrated_directional(ray, t, sampling.reach * stretch, offset, fragment.seen);
    } else {
        value = integrated(ray, t, offset, fragment.seen);
    }
    return vec4f(min(medium.sigma_s * light.strength * value, vec3f(sampling.most)), 0.0);
}
