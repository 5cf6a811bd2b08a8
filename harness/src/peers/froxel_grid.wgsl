// The frustum-aligned grid: tiles of pixels, slices of distance.

struct Grid {
    /// Froxels along x, y and the ray.
    size: vec3u,
    /// Pixels on a side of a tile.
    tile: f32,
    /// Distance behind which there are neither surfaces nor lights [m]: up to it go the first `share` of the slices.
    inner: f32,
    share: f32,
    /// Distance where rays end [m].
    reach: f32,
    /// What stored radiance per metre is multiplied by, so that 16 bits hold it whatever the unit of the lights.
    exposure: f32,
}

/// How much thicker the last slice up to `inner` is than the first: exp(GROWTH).
const GROWTH: f32 = 1.5;

/// Distance [m] of the place `slice` (0: at the eye) of the slices: exponential, from the eye on and not from a near plane.
fn slice_distance(grid: Grid, slice: f32) -> f32 {
    let u = slice / f32(grid.size.z);
    if u <= grid.share {
        return grid.inner * (exp(GROWTH * u / grid.share) - 1.0) / (exp(GROWTH) - 1.0);
    }
    return grid.inner * pow(grid.reach / grid.inner, (u - grid.share) / (1.0 - grid.share));
}

/// Place among the slices of a distance: inverse of `slice_distance`.
fn distance_slice(grid: Grid, distance: f32) -> f32 {
    var u = grid.share / GROWTH * log(1.0 + distance / grid.inner * (exp(GROWTH) - 1.0));
    if distance > grid.inner && grid.share < 1.0 {
        u = grid.share + (1.0 - grid.share) * log(distance / grid.inner) / log(grid.reach / grid.inner);
    }
    return min(u, 1.0) * f32(grid.size.z);
}
