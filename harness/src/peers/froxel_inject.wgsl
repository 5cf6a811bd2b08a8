// Light into the froxels: adds one light's in-scattering, attenuated on its way from the light, to each.
// Needs view, phase, medium, light, froxel_grid and the peers' light.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var<uniform> grid: Grid;
/// Radiance per metre and per scattering coefficient, times `grid.exposure`: four 16-bit floats.
@group(0) @binding(3) var<storage, read_write> cells: array<vec2u>;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;
@group(1) @binding(2) var light_map: texture_2d<f32>;
@group(1) @binding(3) var light_map_sampler: sampler;

/// Places in each froxel where the light is looked up.
override SAMPLES: u32 = 4u;

/// Three numbers in [0, 1) that differ from froxel to froxel (pcg3d; Jarzynski and Olano 2020).
fn noise(froxel: vec3u) -> vec3f {
    var v = froxel * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return vec3f(v >> vec3u(8u)) / 16777216.0;
}

/// What arrives at `position` and goes on along -ray, RGB per strength. `least` [m²] bounds the square of the distance:
/// in the light's own froxel its inverse counts by its mean.
fn in_scattering(position: vec3f, ray: vec3f, least: f32) -> vec3f {
    var found = vec3f(0.0);
    if KIND == LIGHT_DIRECTIONAL {
        found = phase(-dot(light.direction, ray));
    } else {
        let away = position - light.position;
        let square = max(dot(away, away), least);
        let distance = sqrt(square);
        found = directed(away, distance) * phase(-dot(away, ray) / distance) * transmittance(distance) / square;
        if KIND == LIGHT_SPOT && dot(away, light.direction) < light.cos_outer * distance {
            found = vec3f(0.0);
        }
    }
    return select(vec3f(0.0), found, sees_light(shadow_place(position, 1.0)));
}

@compute @workgroup_size(8, 2, 4)
fn inject(@builtin(global_invocation_id) froxel: vec3u) {
    if any(froxel >= grid.size) {
        return;
    }
    let first = slice_distance(grid, f32(froxel.z));
    let thickness = slice_distance(grid, f32(froxel.z) + 1.0) - first;
    // A third of the squared radius of a ball as large as the froxel: the mean of 1/d² over it is 3/R².
    let width = 2.0 * length(view.up) / view.height * grid.tile * (first + 0.5 * thickness);
    let volume = width * width * thickness;
    let least = max(0.128 * pow(volume, 2.0 / 3.0), 1e-20);
    // Jittered along the ray, and by the R2 sequence (Roberts 2018) across it.
    let start = noise(froxel);
    var sum = vec3f(0.0);
    for (var i = 0u; i < SAMPLES; i++) {
        let across = fract(start.xy + f32(i) * vec2f(0.7548776662, 0.5698402910));
        let ray = view_ray(view, (vec2f(froxel.xy) + across) * grid.tile);
        let t = first + (f32(i) + start.z) / f32(SAMPLES) * thickness;
        sum += in_scattering(view.eye + t * ray, ray, least);
    }
    let added = min(sum * light.strength * (grid.exposure / f32(SAMPLES)), vec3f(3e4));
    let index = (froxel.z * grid.size.y + froxel.y) * grid.size.x + froxel.x;
    let cell = cells[index];
    let total = min(vec3f(unpack2x16float(cell.x), unpack2x16float(cell.y).x) + added, vec3f(6e4));
    cells[index] = vec2u(pack2x16float(total.xy), pack2x16float(vec2f(total.z, 0.0)));
}
