// The eye: which ray belongs to which pixel, and how far away a depth is. Twin: common/src/view.rs.

struct View {
    clip_from_world: mat4x4f,
    /// Position of the eye [m].
    eye: vec3f,
    /// Distance of the near plane [m]; depth is near / -z_view.
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
}

/// What x beyond any scene stands for infinity [m].
const INFINITE_DISTANCE: f32 = 1e30;

/// Unit direction of the ray through `pixel` (as @builtin(position): centres at .5, row 0 at the top).
fn view_ray(view: View, pixel: vec2f) -> vec3f {
    let u = 2.0 * pixel.x / view.width - 1.0;
    let v = 1.0 - 2.0 * pixel.y / view.height;
    return normalize(view.forward + u * view.right + v * view.up);
}

/// Distance [m] along the unit ray `direction` to the surface of reversed `depth`; 0 is infinitely far.
fn view_distance(view: View, depth: f32, direction: vec3f) -> f32 {
    if depth <= 0.0 {
        return INFINITE_DISTANCE;
    }
    return view.near / (depth * dot(direction, view.forward));
}
