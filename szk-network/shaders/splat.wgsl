// Particles as splats, drawn over the picture from back to front. Needs view, phase, light and cloud.wgsl.

/// Direct light is found for each fragment.
override per_fragment: bool;
/// Splats are corrected by the ratio of the density to what they add up to.
override corrected: bool;
/// Most places along a splat that density and direct light are found at.
override samples: u32;

/// Optical depth between them.
const SPACING: f32 = 0.35;

/// A light as a fragment needs it.
struct Source {
    /// Position [m], or the way that the light travels.
    place: vec3f,
    /// One of LIGHT_*.
    kind: u32,
    /// Intensity [W/sr] or irradiance [W/m²], RGB.
    strength: vec3f,
}

@group(0) @binding(0) var<uniform> cloud: Cloud;
@group(0) @binding(1) var<uniform> view: View;
@group(0) @binding(2) var<storage, read> particles: array<Particle>;
@group(0) @binding(3) var<storage, read> radiances: array<vec4f>;
@group(0) @binding(4) var<storage, read> keys: array<vec2u>;
@group(0) @binding(5) var<storage, read> lights: array<Source>;
@group(0) @binding(6) var<storage, read> phase_tables: array<f32>;
@group(0) @binding(7) var depth: texture_depth_2d;
@group(0) @binding(8) var density: texture_3d<f32>;
@group(0) @binding(9) var lit: texture_3d<f32>;
@group(0) @binding(10) var linear_sampler: sampler;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) particle: u32,
}

@vertex
fn vs_splat(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varying {
    let index = keys[instance].y;
    let particle = particles[index];
    let corner = vec2f(f32(vertex & 1u), f32(vertex >> 1u)) * 2.0 - 1.0;
    let reach = cloud.overlap * particle.radius;
    let offset = particle.position - view.eye;
    let distance = length(offset);
    // The eye is in the splat: it fills the picture.
    var position = vec4f(corner, 0.5, 1.0);
    if distance > 1.05 * reach {
        // The square that bounds a ball as it is seen.
        let way = offset / distance;
        let right = normalize(cross(way, select(vec3f(0.0, 1.0, 0.0), vec3f(1.0, 0.0, 0.0), abs(way.y) > 0.9)));
        let up = cross(right, way);
        let half = reach * distance / sqrt(distance * distance - reach * reach);
        position = view.clip_from_world
            * vec4f(particle.position + half * (corner.x * right + corner.y * up), 1.0);
    }
    return Varying(position, index);
}

/// The part of a kernel (1 − x²)^{3/2} over [−1, 1] that lies before x.
fn part_before(x: f32) -> f32 {
    let c = clamp(x, -1.0, 1.0);
    return 0.5 + (c * (5.0 - 2.0 * c * c) * sqrt(1.0 - c * c) + 3.0 * asin(c)) / (3.0 * PI);
}

fn phase_at(phase: u32, cosine: f32) -> f32 {
    let place = phase_place(cosine);
    let first = min(u32(place), PHASE_ENTRIES - 2u);
    // The second half of the tables: phase functions as they are.
    let at = arrayLength(&phase_tables) / 2u + phase * PHASE_ENTRIES + first;
    return mix(phase_tables[at], phase_tables[at + 1u], place - f32(first));
}

/// Radiance that the medium at a place would scatter of direct light into a direction if there was no end to it.
fn direct(position: vec3f, way: vec3f, particle: Particle) -> vec3f {
    let all = vec3f(textureDimensions(lit));
    let cells = vec3f(all.xy, all.z / f32(cloud.lights));
    let place = clamp((position - cloud.low) / (cloud.high - cloud.low) * cells, vec3f(0.5), cells - 0.5);
    var sum = vec3f(0.0);
    for (var l = 0u; l < cloud.lights; l++) {
        let light = lights[l];
        let at = (place + vec3f(0.0, 0.0, f32(l) * cells.z)) / all;
        var strength = textureSampleLevel(lit, linear_sampler, at, 0.0).rgb * light.strength;
        var travels = light.place;
        if light.kind != LIGHT_DIRECTIONAL {
            let offset = position - light.place;
            let squared = max(dot(offset, offset), particle.radius * particle.radius / 3.0);
            strength /= squared;
            travels = offset / sqrt(squared);
        }
        sum += strength * phase_at(particle.phase, dot(travels, way));
    }
    return particle.albedo * sum;
}

@fragment
fn fs_splat(fragment: Varying) -> @location(0) vec4f {
    let particle = particles[fragment.particle];
    let reach = cloud.overlap * particle.radius;
    let ray = view_ray(view, fragment.position.xy);
    let offset = particle.position - view.eye;
    let distance = dot(offset, ray);
    let miss = offset - distance * ray;
    let u = 1.0 - dot(miss, miss) / (reach * reach);
    if u <= 0.0 {
        discard;
    }
    // The part of the splat between the eye and what stands in the scene.
    let half = reach * sqrt(u);
    let end = view_distance(view, textureLoad(depth, vec2i(fragment.position.xy), 0), ray);
    let first = max(-1.0, -distance / half);
    let last = min(1.0, (end - distance) / half);
    if first >= last {
        discard;
    }
    let whole = particle.cross_section * 3.0 / (PI * reach * reach) * u * u;
    let radiance = radiances[fragment.particle].rgb;
    var sum = vec3f(0.0);
    var transmittance = 1.0;
    var before = part_before(first);
    let extinction = particle.cross_section * 0.75 / (PI * pow(particle.radius, 3.0));
    let places = clamp(ceil(extinction * half * (last - first) / SPACING), 1.0, f32(samples));
    for (var i = 0.0; i < places; i += 1.0) {
        let to = mix(first, last, (i + 1.0) / places);
        let part = part_before(to);
        let position = view.eye
            + (distance + half * mix(first, last, (i + 0.5) / places)) * ray;
        var optical_depth = whole * (part - before);
        before = part;
        if corrected {
            let at = (position - cloud.low) / (cloud.high - cloud.low);
            let inside = all(at >= vec3f(0.0)) && all(at <= vec3f(1.0));
            optical_depth *= select(0.0, textureSampleLevel(density, linear_sampler, at, 0.0).y, inside);
        }
        // 1 − exp loses all digits where there is little.
        let opacity = select(1.0 - exp(-optical_depth), optical_depth, optical_depth < 1e-3);
        if per_fragment {
            sum += transmittance * opacity * (radiance + direct(position, -ray, particle));
        } else {
            sum += transmittance * opacity * radiance;
        }
        transmittance *= 1.0 - opacity;
    }
    return vec4f(sum, 1.0 - transmittance);
}
