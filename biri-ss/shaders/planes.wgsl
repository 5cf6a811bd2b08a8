// Shadow planes, the caps of shadow volumes, and the airlight that ends at them.
// Needs view, phase, medium, light, kind, haze, airlight, table, gamma.

/// A shadow plane: over the edge from `a` to `b`, away from the light, endless.
struct Plane {
    a: vec3f,
    b: vec3f,
    normal: vec3f,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var scene_depth: texture_depth_2d;
@group(0) @binding(3) var gammas: texture_2d_array<f32>;

@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var<uniform> volume: Volume;
@group(1) @binding(2) var<storage, read> planes: array<Plane>;
/// Corners of the triangles that cast, three numbers each, turned towards the light.
@group(1) @binding(3) var<storage, read> caps: array<f32>;

struct Fragment {
    @builtin(position) clip: vec4f,
    /// Normal of the plane.
    @location(0) @interpolate(flat) normal: vec3f,
    /// A point of the plane, from the eye [m].
    @location(1) @interpolate(flat) anchor: vec3f,
}

/// A point, or (endless) the way from the light through it, in homogeneous coordinates.
fn corner(position: vec3f, endless: bool) -> vec4f {
    if !endless {
        return vec4f(position, 1.0);
    }
    if KIND == LIGHT_DIRECTIONAL {
        return vec4f(light.direction, 0.0);
    }
    return vec4f(position - light.position, 0.0);
}

/// A strip of two triangles: counter-clockwise seen from outside the shadow.
@vertex
fn vs_plane(@builtin(vertex_index) index: u32, @location(0) which: u32) -> Fragment {
    let plane = planes[which];
    let end = select(plane.a, plane.b, index >= 2u);
    // All planes of a point light run through it.
    let through = select(light.position, plane.a, KIND == LIGHT_DIRECTIONAL);
    let clip = volume.clip_from_world * corner(end, (index & 1u) == 1u);
    return Fragment(clip, plane.normal, through - volume.eye);
}

/// Distance along a pixel's ray to the scene [m].
fn scene_distance(pixel: vec2f, direction: vec3f) -> f32 {
    return view_distance(view, textureLoad(scene_depth, vec2i(pixel), 0), direction);
}

/// Distance along the ray at which it meets the plane. From the plane's normal, not from interpolated depth,
/// which is worth little where a plane is seen almost edge-on.
fn plane_distance(fragment: Fragment, direction: vec3f) -> f32 {
    let slope = dot(fragment.normal, direction);
    let distance = dot(fragment.normal, fragment.anchor) / select(slope, 1e-30, slope == 0.0);
    // The eye is in no plane, and this one was drawn here, so it is in front of the eye: what comes out
    // negative is a plane's infinitely far border, where rounding tips the slope over.
    return select(INFINITE_DISTANCE, min(distance, INFINITE_DISTANCE), distance >= 0.0);
}

/// Planes nearer to a surface than this, as a share of its distance, count as behind it.
const TOUCHING: f32 = 1e-5;

fn is_behind(distance: f32, surface: f32) -> bool {
    return distance >= surface * (1.0 - TOUCHING);
}

/// Airlight from the eye to the plane: added where the ray enters a shadow (it sees the plane's outside), taken
/// away where it leaves one. The stencil lets only planes pass that part light from shadow. (14) of the paper,
/// with e^(−k_t t)/(k_t h) for its e^(−k_t d), so that what one plane takes away another has added.
@fragment
fn fs_plane(fragment: Fragment, @builtin(front_facing) enters: bool) -> @location(0) vec4f {
    let direction = view_ray(view, fragment.clip.xy);
    let distance = plane_distance(fragment, direction);
    if is_behind(distance, scene_distance(fragment.clip.xy, direction)) {
        discard;
    }
    let value = airlight(view.eye, direction, distance);
    return vec4f(select(-value, value, enters), 0.0);
}

/// Counts planes behind the scene.
@fragment
fn fs_count(fragment: Fragment) {
    let direction = view_ray(view, fragment.clip.xy);
    if !is_behind(plane_distance(fragment, direction), scene_distance(fragment.clip.xy, direction)) {
        discard;
    }
}

struct Cap {
    @builtin(position) clip: vec4f,
    /// From the eye [m].
    @location(0) offset: vec3f,
    /// 1 at the shadow's infinite end.
    @location(1) @interpolate(flat) endless: u32,
}

/// Instance 0: the triangles that cast; instance 1: their shadows' infinite ends, turned around.
@vertex
fn vs_cap(@builtin(vertex_index) index: u32, @builtin(instance_index) endless: u32) -> Cap {
    let which = index % 3u;
    let turned = select(which, (3u - which) % 3u, endless == 1u);
    let first = 3u * (index - which + turned);
    let position = vec3f(caps[first], caps[first + 1u], caps[first + 2u]);
    let clip = volume.clip_from_world * corner(position, endless == 1u);
    return Cap(clip, position - volume.eye, endless);
}

/// Counts caps behind the scene.
@fragment
fn fs_cap(cap: Cap) {
    let direction = view_ray(view, cap.clip.xy);
    if cap.endless == 0u && !is_behind(length(cap.offset), scene_distance(cap.clip.xy, direction)) {
        discard;
    }
}

@vertex
fn vs_everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return vec4f(corner * 2.0 - 1.0, 0.0, 1.0);
}

/// Airlight up to the scene, where the stencil says that it is lit.
@fragment
fn fs_lit(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = view_ray(view, position.xy);
    return vec4f(airlight(view.eye, direction, scene_distance(position.xy, direction)), 0.0);
}

/// (1), third term: what multiple scattering and emission add along the ray. Printed as L_a e^(−k_t d), which
/// falls with the medium's depth instead of growing.
@fragment
fn fs_ambient(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = view_ray(view, position.xy);
    let passed = transmittance(scene_distance(position.xy, direction));
    return vec4f(volume.ambient * (1.0 - passed), 0.0);
}
