// Adds in-scattered radiance up to each pixel's surface, interpolated in the grid.
// Needs fullscreen, view, phase, medium, froxel_grid.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var<uniform> grid: Grid;
@group(0) @binding(3) var depth_map: texture_depth_2d;
@group(0) @binding(4) var integrated: texture_3d<f32>;
@group(0) @binding(5) var linear_sampler: sampler;

@fragment
fn fs_apply(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let ray = view_ray(view, pixel.xy);
    let end = min(view_distance(view, textureLoad(depth_map, vec2i(pixel.xy), 0), ray), grid.reach);
    let slice = distance_slice(grid, end);
    // A texel's centre stands for the far side of its froxel; in the first one radiance grows from nothing.
    let at = vec3f(pixel.xy / (grid.tile * vec2f(grid.size.xy)), (slice - 0.5) / f32(grid.size.z));
    let found = textureSampleLevel(integrated, linear_sampler, at, 0.0).rgb * min(slice, 1.0);
    return vec4f(medium.sigma_s * found * (grid.inner / grid.exposure), 0.0);
}
