// Airlight as if nothing threw a shadow: all lights at once, each by a few points of quadrature a ray.
// Needs fullscreen, view, phase, medium, light, ray, haze.

struct Source {
    /// Point, spot: position [m].
    position: vec3f,
    /// Spot: cosine of the cone.
    cos_outer: f32,
    /// Spot, directional: the way the light travels, unit length.
    direction: vec3f,
    /// Spot: cosine of the cone of whole intensity.
    cos_inner: f32,
    /// Intensity [W/sr] or irradiance [W/m²], RGB.
    strength: vec3f,
}

struct Sources {
    /// Where a ray that meets no surface ends [m].
    reach: f32,
    /// Points, then spots with an edge, then soft spots, then directional lights.
    all: array<Source, 16>,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var depth_map: texture_depth_2d;
@group(0) @binding(3) var<uniform> sources: Sources;

// A spot with a light map, drawn by itself; else any light, not looked at.
@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(2) var light_map: texture_2d<f32>;
@group(1) @binding(3) var light_map_sampler: sampler;

/// How many of each kind there are: known when the pipeline is made, so that loops can be unrolled.
override POINTS: u32 = 0u;
override SPOTS: u32 = 0u;
override SOFT_SPOTS: u32 = 0u;
override SUNS: u32 = 0u;

/// 1 - tan(θ/2) of the angle θ at the light between a ray's nearest point and the point `x` [m] beyond it.
fn angle_parameter(x: f32, height: f32) -> f32 {
    let distance = sqrt(height * height + x * x);
    // Without cancellation on either side.
    return select(1.0 - x / (height + distance), height * (1.0 + height / (distance + x)) / (height + distance), x > 0.0);
}

/// A stretch of a ray in the light of one point or spot.
struct Stretch {
    nearest: Nearest,
    middle: f32,
    half: f32,
}

fn stretch_of(nearest: Nearest, span: vec2f) -> Stretch {
    let far = angle_parameter(span.x - nearest.along, nearest.height);
    let near = angle_parameter(span.y - nearest.along, nearest.height);
    return Stretch(nearest, 0.5 * (far + near), 0.5 * (far - near));
}

/// A point of the quadrature.
struct Node {
    /// Phase function and transmittance times the angle that a step of the parameter spans, RGB [1/sr].
    value: vec3f,
    /// Cosine and sine of the angle at the light.
    angle: vec2f,
}

/// Integrand at parameter q, where tan(θ/2) = 1 - q. With it all is rational: sin θ, dθ, and the path from the
/// light over the ray to the eye, along + height · tan(θ/2 + π/4) (formulas (5) to (7) of Biri et al. 2006).
fn node(nearest: Nearest, q: f32) -> Node {
    let tangent = 1.0 - q;
    let inverse = 1.0 / (1.0 + tangent * tangent);
    let angle = vec2f(1.0 - tangent * tangent, 2.0 * tangent) * inverse;
    let path = nearest.along + nearest.height * (2.0 - q) / q;
    return Node(2.0 * inverse * phase(-angle.y) * transmittance(path), angle);
}

/// Nodes and weights of the four-point Gauss-Legendre rule on both sides of the middle.
const NEAR_NODE: f32 = 0.339981043584856265;
const FAR_NODE: f32 = 0.861136311594052575;
const NEAR_WEIGHT: f32 = 0.652145154862546143;
const FAR_WEIGHT: f32 = 0.347854845137453857;

/// Airlight of a point light per strength and scattering coefficient, between two distances.
fn airlight_between(ray: vec3f, position: vec3f, span: vec2f) -> vec3f {
    let nearest = nearest_to(view.eye, ray, position, 1e-6 * sources.reach);
    let s = stretch_of(nearest, span);
    let inner = node(nearest, s.middle - NEAR_NODE * s.half).value + node(nearest, s.middle + NEAR_NODE * s.half).value;
    let outer = node(nearest, s.middle - FAR_NODE * s.half).value + node(nearest, s.middle + FAR_NODE * s.half).value;
    return (NEAR_WEIGHT * inner + FAR_WEIGHT * outer) * s.half / nearest.height;
}

/// What a spot sends towards a node of a ray, RGB; `across` leads from the light to the ray's nearest point.
fn spot_node(ray: vec3f, across: vec3f, spot: Source, nearest: Nearest, q: f32, mapped: bool) -> vec3f {
    let at = node(nearest, q);
    let away = at.angle.x * across + at.angle.y * ray;
    // The stretch is clipped to the cone: rounding must not fall off its edge.
    let cosine = max(dot(away, spot.direction), spot.cos_outer);
    var sent = vec3f(light_falloff(cosine, spot.cos_inner, spot.cos_outer));
    if mapped {
        let uv = light_map_uv(light.direction, light.map_right, light.map_up, away);
        sent *= textureSampleLevel(light_map, light_map_sampler, uv, 0.0).rgb;
    }
    return sent * at.value;
}

/// Three points over a stretch of a ray in which a spot's falloff is smooth.
fn spot_panel(ray: vec3f, across: vec3f, spot: Source, s: Stretch, mapped: bool) -> vec3f {
    let offset = 0.774596669241483377 * s.half;
    let outer = spot_node(ray, across, spot, s.nearest, s.middle - offset, mapped)
        + spot_node(ray, across, spot, s.nearest, s.middle + offset, mapped);
    return (8.0 * spot_node(ray, across, spot, s.nearest, s.middle, mapped) + 5.0 * outer) * (s.half / 9.0);
}

/// Airlight of a spot with an edge per strength and scattering coefficient: a point light's over a part of the ray.
fn airlight_spot(ray: vec3f, spot: Source, end: f32) -> vec3f {
    let span = cone_span(view.eye, ray, spot.position, spot.direction, spot.cos_outer, end);
    return airlight_between(ray, spot.position, vec2f(span.x, max(span.x, span.y)));
}

/// Airlight of a spot with a soft edge, or one with a light map, per strength and scattering coefficient. The falloff
/// has a kink at the cone of whole intensity, so the ray is cut there.
fn airlight_soft_spot(ray: vec3f, spot: Source, end: f32, mapped: bool) -> vec3f {
    let outer = cone_span(view.eye, ray, spot.position, spot.direction, spot.cos_outer, end);
    let inner = cone_span(view.eye, ray, spot.position, spot.direction, spot.cos_inner, end);
    let last = max(outer.x, outer.y);
    let from_inner = clamp(inner.x, outer.x, last);
    let to_inner = clamp(inner.y, from_inner, last);
    let nearest = nearest_to(view.eye, ray, spot.position, 1e-6 * sources.reach);
    let across = normalize(view.eye + nearest.along * ray - spot.position + vec3f(1e-20, 0.0, 0.0));
    let first = stretch_of(nearest, vec2f(outer.x, from_inner));
    let middle = stretch_of(nearest, vec2f(from_inner, to_inner));
    let second = stretch_of(nearest, vec2f(to_inner, last));
    let sum = spot_panel(ray, across, spot, first, mapped) + spot_panel(ray, across, spot, middle, mapped)
        + spot_panel(ray, across, spot, second, mapped);
    return sum / nearest.height;
}

/// Airlight of a directional light per strength and scattering coefficient, in closed form.
fn airlight_sun(ray: vec3f, direction: vec3f, end: f32) -> vec3f {
    let tau = medium.sigma_t * end;
    let series = 1.0 - tau * (0.5 - tau / 6.0);
    let share = select((1.0 - exp(-tau)) / max(tau, vec3f(1e-30)), series, tau < vec3f(0.02));
    return phase(-dot(direction, ray)) * share * end;
}

/// Length of the ray through a pixel.
fn ray_end(pixel: vec2f, ray: vec3f) -> f32 {
    return min(view_distance(view, textureLoad(depth_map, vec2i(pixel), 0), ray), sources.reach);
}

@fragment
fn fs_unshadowed(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let ray = view_ray(view, pixel.xy);
    let end = ray_end(pixel.xy, ray);
    var sum = vec3f(0.0);
    if POINTS > 0u {
        for (var i = 0u; i < POINTS; i++) {
            sum += sources.all[i].strength * airlight_between(ray, sources.all[i].position, vec2f(0.0, end));
        }
    }
    if SPOTS > 0u {
        for (var i = POINTS; i < POINTS + SPOTS; i++) {
            sum += sources.all[i].strength * airlight_spot(ray, sources.all[i], end);
        }
    }
    if SOFT_SPOTS > 0u {
        for (var i = POINTS + SPOTS; i < POINTS + SPOTS + SOFT_SPOTS; i++) {
            sum += sources.all[i].strength * airlight_soft_spot(ray, sources.all[i], end, false);
        }
    }
    if SUNS > 0u {
        let first = POINTS + SPOTS + SOFT_SPOTS;
        for (var i = first; i < first + SUNS; i++) {
            sum += sources.all[i].strength * airlight_sun(ray, sources.all[i].direction, end);
        }
    }
    return vec4f(medium.sigma_s * sum, 0.0);
}

@fragment
fn fs_mapped(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let ray = view_ray(view, pixel.xy);
    let spot = Source(light.position, light.cos_outer, light.direction, light.cos_inner, light.strength);
    let sum = airlight_soft_spot(ray, spot, ray_end(pixel.xy, ray), true);
    return vec4f(medium.sigma_s * light.strength * sum, 0.0);
}
