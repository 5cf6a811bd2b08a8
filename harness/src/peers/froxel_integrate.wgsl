// Along the rays: in-scattered radiance from the eye up to the far side of each froxel.
// Needs phase, medium, froxel_grid.

@group(0) @binding(0) var<uniform> medium: Medium;
@group(0) @binding(1) var<uniform> grid: Grid;
@group(0) @binding(2) var<storage, read_write> cells: array<vec2u>;
/// Radiance per scattering coefficient and `grid.inner`, times `grid.exposure`.
@group(0) @binding(3) var integrated: texture_storage_3d<rgba16float, write>;

/// Froxels along a ray: `grid.size.z`.
override SLICES: u32 = 64u;

/// Fraction that passes `distance` [m], and the distance weighed by what is left on the way [m], RGB.
struct Slice {
    passed: vec3f,
    weight: vec3f,
}

/// (1 - exp(-sigma d)) / sigma: what a slice of the same radiance per metre all through sends out of its near side, the
/// energy-conserving formula (S - S exp(-sigma d)) / sigma of Hillaire 2015.
fn slice_of(thickness: f32) -> Slice {
    let tau = medium.sigma_t * thickness;
    let passed = exp(-tau);
    let series = 1.0 - tau * (0.5 - tau * (1.0 / 6.0 - tau / 24.0));
    let share = select((1.0 - passed) / max(tau, vec3f(1e-30)), series, tau < vec3f(0.05));
    return Slice(passed, share * thickness);
}

@compute @workgroup_size(8, 8)
fn integrate(@builtin(global_invocation_id) column: vec3u) {
    if any(column.xy >= grid.size.xy) {
        return;
    }
    var sum = vec3f(0.0);
    var passed = vec3f(1.0);
    var distance = 0.0;
    for (var z = 0u; z < SLICES; z++) {
        let next = slice_distance(grid, f32(z) + 1.0);
        let slice = slice_of(next - distance);
        let index = (z * grid.size.y + column.y) * grid.size.x + column.x;
        let cell = cells[index];
        // Empty for the next frame.
        cells[index] = vec2u(0u);
        sum += passed * slice.weight / grid.inner * vec3f(unpack2x16float(cell.x), unpack2x16float(cell.y).x);
        passed *= slice.passed;
        distance = next;
        textureStore(integrated, vec3u(column.xy, z), vec4f(min(sum, vec3f(6e4)), 1.0));
    }
}
