// Shadow planes whose rays begin alike. Airlight between two distances is what a table says is left at the first, less
// what is left at the second. Planes add and take away airlight from the eye on, by turns, so that on a ray that begins in
// the light all that is left at the eye remains once, and on one that begins in a shadow not at all: it is added
// by `fs_beginning`, and a plane takes one look-up. Needs gamma and planes.

/// Of each pixel's ray: distance to the scene, the foot point's distance, the height above it (the light's distance from
/// the ray), and the logarithm of that in lengths of the table's first axis.
@group(2) @binding(0) var rays: texture_2d<f32>;

/// What a ray is looked up with, found once for all planes of a light.
@fragment
fn fs_ray(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let direction = view_ray(view, position.xy);
    let foot = foot_of(view.eye, direction, light.position);
    let column = log(foot.height) / log(GAMMA_MOST / GAMMA_LEAST);
    return vec4f(scene_distance(position.xy, direction), foot.along, foot.height, column);
}

/// What is left of a ray's airlight at distance `x` [m], RGB [W/m²/sr].
fn rest_at(ray: vec4f, x: f32) -> vec3f {
    let at = min(x, FAR_AWAY);
    let height = ray.z;
    let beyond = at - ray.y;
    let from_light = sqrt(beyond * beyond + height * height);
    let row = gamma_row(beyond, from_light, height);
    var value = vec3f(0.0);
    for (var colour = 0u; colour < select(3u, 1u, GREY); colour += 1u) {
        let column = ray.w + volume.column[colour];
        var sum = 0.0;
        for (var i = 0u; i < LOBES; i += 1u) {
            sum += medium.lobes[i].weight[colour] * table_lookup(gammas, i, vec2f(column, row));
        }
        value[colour] = sum * exp(-medium.sigma_t[colour] * (at + from_light));
    }
    if GREY {
        value = vec3f(value.x);
    }
    return light.strength * medium.sigma_s * value / (4.0 * PI * height);
}

/// Where a ray's light ends that would end at distance `x`: in a spot's cone.
fn lit_end(direction: vec3f, x: f32) -> f32 {
    if KIND == LIGHT_SPOT {
        return airlight_breaks(view.eye, direction, x).w;
    }
    return x;
}

/// As fs_plane.
@fragment
fn fs_plane_rest(fragment: Fragment, @builtin(front_facing) enters: bool) -> @location(0) vec4f {
    let ray = textureLoad(rays, vec2i(fragment.clip.xy), 0);
    let direction = view_ray(view, fragment.clip.xy);
    let distance = plane_distance(fragment, direction);
    if is_behind(distance, ray.x) {
        discard;
    }
    let left = rest_at(ray, lit_end(direction, distance));
    return vec4f(select(left, -left, enters), 0.0);
}

/// As fs_lit.
@fragment
fn fs_lit_rest(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let ray = textureLoad(rays, vec2i(position.xy), 0);
    return vec4f(-rest_at(ray, lit_end(view_ray(view, position.xy), ray.x)), 0.0);
}

/// What is left at the beginning, of rays that begin in the light.
@fragment
fn fs_beginning(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let ray = textureLoad(rays, vec2i(position.xy), 0);
    var begin = 0.0;
    if KIND == LIGHT_SPOT {
        begin = airlight_breaks(view.eye, view_ray(view, position.xy), ray.x).x;
    }
    return vec4f(rest_at(ray, begin), 0.0);
}
