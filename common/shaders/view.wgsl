// The eye: which ray belongs to which pixel, and how far away a depth is. Twin: common/src/view.rs.

struct View {
    clip_from_world: mat4x4f,
    /// Position of the eye [m].
    eye: vec3f,
    /// Distance of the near plane [m].
    near: f32,
    /// Half extent of the image plane at distance 1, along x.
    right: vec3f,
    /// Width [pixels].
    width: f32,
    /// Half extent of the image plane at distance 1, along y.
    up: vec3f,
    /// Height [pixels].
    height: f32,
    /// Unit viewing direction.
    forward: vec3f,
    /// Distance along the viewing direction [m] is depth_scale / (depth - depth_offset): what the scene's depth means.
    /// Negative for standard depth, positive for reversed.
    depth_scale: f32,
    depth_offset: f32,
}

/// What x beyond any scene stands for infinity [m].
const INFINITE_DISTANCE: f32 = 1e30;

/// Unit direction of the ray through `pixel` (as @builtin(position): centres at .5, row 0 at the top).
fn view_ray(view: View, pixel: vec2f) -> vec3f {
    let u = 2.0 * pixel.x / view.width - 1.0;
    let v = 1.0 - 2.0 * pixel.y / view.height;
    return normalize(view.forward + u * view.right + v * view.up);
}

/// Distance [m] along the unit ray `direction` to the surface of a `depth`; what an empty pixel holds is infinitely far.
fn view_distance(view: View, depth: f32, direction: vec3f) -> f32 {
    // Chosen, not branched upon: see `uniform_branches`.
    let empty = select(depth >= 1.0, depth <= 0.0, view.depth_scale > 0.0);
    let along = view.depth_scale / (depth - view.depth_offset);
    return select(along / dot(direction, view.forward), INFINITE_DISTANCE, empty);
}

/// Depth of a place `along` the viewing direction [m] as the scene's buffer would hold it: the inverse.
fn view_depth(view: View, along: f32) -> f32 {
    return view.depth_offset + view.depth_scale / along;
}
