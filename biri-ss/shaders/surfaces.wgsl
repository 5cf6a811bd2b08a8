// Light on surfaces: direct, and by way of the medium. Deferred: one look at each pixel.
// Needs fullscreen, view, phase, medium, light, kind, haze, arrival, table, gamma's Volume.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var scene_depth: texture_depth_2d;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var<uniform> volume: Volume;

/// Shading normal; w: Phong exponent. Zero where there is no surface.
@group(2) @binding(0) var normals: texture_2d<f32>;
/// Diffuse reflectance.
@group(2) @binding(1) var diffuse: texture_2d<f32>;
/// Specular reflectance.
@group(2) @binding(2) var specular: texture_2d<f32>;
/// Irradiance by indirect light: a layer for each lobe of point lights, then of directional ones.
@group(2) @binding(3) var lambert: texture_2d_array<f32>;
/// The same of Phong lobes: for each lobe of the phase function PHONG_LAYERS of point lights, then as many
/// of directional ones.
@group(2) @binding(4) var phong: texture_2d_array<f32>;

/// 1: indirect light only where direct light would come, as the paper's Figure 8 has it.
override as_direct: u32 = 0u;

const PHONG_LAYERS: u32 = 21u;
const INDIRECT_LEAST: f32 = 1e-4;
const INDIRECT_MOST: f32 = 50.0;

struct Surface {
    position: vec3f,
    normal: vec3f,
    to_eye: vec3f,
    /// The eye's direction, mirrored.
    mirrored: vec3f,
    k_d: vec3f,
    k_s: vec3f,
    exponent: f32,
    /// What passes from the surface to the eye.
    passed: vec3f,
    /// Whether there is one.
    there: bool,
}

fn surface_at(pixel: vec2f) -> Surface {
    let at = vec2i(pixel);
    let direction = view_ray(view, pixel);
    let distance = view_distance(view, textureLoad(scene_depth, at, 0), direction);
    let found = textureLoad(normals, at, 0);
    let size = length(found.xyz);
    let there = size > 0.0 && distance < INFINITE_DISTANCE;
    // Surfaces have two sides.
    let normal = found.xyz / max(size, 1e-20) * select(-1.0, 1.0, dot(found.xyz, direction) <= 0.0);
    return Surface(
        view.eye + distance * direction,
        normal,
        -direction,
        reflect(direction, normal),
        textureLoad(diffuse, at, 0).rgb,
        textureLoad(specular, at, 0).rgb,
        max(found.w, 0.0),
        transmittance(distance),
        there,
    );
}

/// Direct light, where the stencil says that the surface is lit; attenuated on both ways.
@fragment
fn fs_direct(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let surface = surface_at(position.xy);
    if !surface.there {
        return vec4f(0.0);
    }
    let light_here = arrival(surface.position);
    let cosine = max(dot(surface.normal, light_here.direction), 0.0);
    let reflected =
        reflectance(surface.k_d, surface.k_s, surface.exponent, dot(surface.mirrored, light_here.direction));
    let passed = surface.passed * transmittance(light_here.distance);
    return vec4f(light_here.irradiance * cosine * reflected * passed, 0.0);
}

/// Where among the layers a Phong exponent lies. Twin: `phong_layer` in src/table.rs.
fn phong_layer(exponent: f32) -> f32 {
    let n = clamp(exponent, 0.0, 1024.0);
    var below = floor(n);
    var low = below;
    var high = below + 1.0;
    if n >= 2.0 {
        let octave = floor(log2(n));
        let start = exp2(octave);
        let half = select(0.0, 1.0, n >= 1.5 * start);
        below = 2.0 * octave + half;
        low = start * (1.0 + 0.5 * half);
        high = start * (1.5 + 0.5 * half);
    }
    return below + (n - low) / (high - low) * (high + 1.0) / (n + 1.0);
}

/// Indirect light of one colour and lobe: what a Lambert surface reflects and what a Phong lobe does, each in
/// units of the light's strength at the surface.
fn indirect_of(lobe: u32, lambda: f32, surface: Surface, to_light: vec3f) -> vec2f {
    let directional = KIND == LIGHT_DIRECTIONAL;
    let x = log(clamp(lambda, INDIRECT_LEAST, INDIRECT_MOST) / INDIRECT_LEAST) / log(INDIRECT_MOST / INDIRECT_LEAST);
    let cos_n = dot(surface.normal, to_light);
    let of_lambert =
        table_lookup(lambert, lobe + select(0u, LOBES, directional), vec2f(x, 0.5 + 0.5 * cos_n));
    let cos_s = dot(surface.mirrored, to_light);
    let y = acos(clamp(cos_s, -1.0, 1.0)) / PI;
    let layer = phong_layer(surface.exponent);
    let below = min(u32(layer), PHONG_LAYERS - 2u);
    let first = (2u * lobe + select(0u, 1u, directional)) * PHONG_LAYERS + below;
    let gathered =
        mix(table_lookup(phong, first, vec2f(x, y)), table_lookup(phong, first + 1u, vec2f(x, y)), layer - f32(below));
    let of_phong = gathered / (surface.exponent + 1.0);
    if as_direct == 1u {
        return vec2f(select(0.0, of_lambert, cos_n > 0.0), select(0.0, of_phong, cos_n > 0.0 && cos_s > 0.0));
    }
    return vec2f(of_lambert, of_phong);
}

/// Indirect single scattering: (10) and (12), in a medium without end, where nothing casts shadows.
@fragment
fn fs_indirect(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let surface = surface_at(position.xy);
    if !surface.there {
        return vec4f(0.0);
    }
    let light_here = arrival(surface.position);
    let directional = KIND == LIGHT_DIRECTIONAL;
    // The cosine law of a Phong lobe, taken at its axis.
    let facing = max(dot(surface.normal, surface.mirrored), 0.0);
    let of_phong = surface.k_s * (surface.exponent + 2.0) / (2.0 * PI) * facing;
    var radiance = vec3f(0.0);
    for (var colour = 0u; colour < 3u; colour += 1u) {
        let sigma_t = medium.sigma_t[colour];
        var strength = light.strength[colour] * medium.sigma_s[colour] / (4.0 * PI);
        var lambda = 1.0;
        if directional {
            // Irradiance · albedo.
            strength /= max(sigma_t, 1e-30);
        } else {
            lambda = sigma_t * light_here.distance;
            // (10): k_t² Ω I/4π · 1/(k_t l); all of it has the attenuation from the light in common.
            strength *= exp(-lambda) / light_here.distance;
        }
        for (var lobe = 0u; lobe < LOBES; lobe += 1u) {
            let found = medium.lobes[lobe].weight[colour] * indirect_of(lobe, lambda, surface, light_here.direction);
            radiance[colour] += strength * (surface.k_d[colour] / PI * found.x + of_phong[colour] * found.y);
        }
    }
    return vec4f(max(radiance, vec3f(0.0)) * surface.passed, 0.0);
}

/// (2), third term: a surface reflects what multiple scattering and emission send it. Printed as
/// L_a e^(−k_t SP), without a reflectance.
@fragment
fn fs_ambient_surface(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let surface = surface_at(position.xy);
    if !surface.there {
        return vec4f(0.0);
    }
    let light_here = arrival(surface.position);
    var sent = vec3f(1.0);
    if KIND != LIGHT_DIRECTIONAL {
        sent -= transmittance(light_here.distance);
    }
    return vec4f(volume.share * volume.ambient * surface.k_d * sent * surface.passed, 0.0);
}
