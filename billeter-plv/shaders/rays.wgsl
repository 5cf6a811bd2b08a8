// Lit runs of each view ray: a walk along the ray through the min-max levels of the shadow map.
// Needs fullscreen, view, phase, medium, light, kind, haze, shadow, airlight, segment, run.

/// Largest radiance that the target holds.
override most_radiance: f32 = 6e4;

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var<uniform> rays: Rays;
@group(0) @binding(3) var scene_depth: texture_depth_2d;
@group(0) @binding(4) var levels: texture_2d_array<u32>;

@group(1) @binding(0) var<uniform> light: Light;

/// Optical depth from the eye, and of a lamp from its distance on, behind which nothing is left to see.
const OPAQUE: f32 = 20.0;

fn clip_line(eye: vec3f, direction: vec3f, foot: Foot, layer: u32) -> ClipLine {
    let clip_from_world = light.layers[layer].clip_from_world;
    let slope = clip_from_world * vec4f(direction, 0.0);
    if KIND == LIGHT_DIRECTIONAL {
        return ClipLine(clip_from_world * vec4f(eye, 1.0), slope);
    }
    return ClipLine(clip_from_world * vec4f(-foot.towards, 0.0), slope);
}

/// The ray's first and last place.
fn ray_span(eye: vec3f, direction: vec3f, foot: Foot, distance: f32) -> vec2f {
    if KIND == LIGHT_DIRECTIONAL {
        return vec2f(0.0, distance);
    }
    var span = vec2f(0.0, distance);
    if KIND == LIGHT_SPOT {
        let cone = cone_interval(eye - light.position, direction, light.direction, light.cos_outer);
        span = vec2f(max(cone.x, 0.0), min(cone.y, distance));
        if span.x >= span.y {
            return vec2f(0.0);
        }
    }
    return clamp((span - foot.along) / foot.height, vec2f(-FAR_PLACE), vec2f(FAR_PLACE));
}

/// Angles at which a ray enters and leaves the cone of whole intensity; twice the same where it misses it.
fn edge_kinks(eye: vec3f, direction: vec3f, foot: Foot) -> vec2f {
    if !HAS_RAMP {
        return vec2f(0.0);
    }
    let inner = cone_interval(eye - light.position, direction, light.direction, light.cos_inner);
    return atan2(inner - foot.along, vec2f(foot.height));
}

/// Airlight of the ray up to `distance` [m], RGB [W/m²/sr].
fn ray_airlight(eye: vec3f, direction: vec3f, distance: f32) -> vec3f {
    let sigma = min(medium.sigma_t.x, min(medium.sigma_t.y, medium.sigma_t.z));
    let foot = foot_of(eye, direction, light.position);
    let before = select(length(light.position - eye), 0.0, KIND == LIGHT_DIRECTIONAL);
    let span = ray_span(eye, direction, foot, min(distance, before + OPAQUE / max(sigma, 1e-29)));
    let kinks = edge_kinks(eye, direction, foot);
    let coarsest = i32(rays.coarsest);
    let size = i32(light.shadow_size);

    // Directional: what the ray crosses of the map, and where it passes the far plane there.
    var line: ClipLine;
    var map = span;
    var far_plane = span.y;
    if KIND == LIGHT_DIRECTIONAL {
        line = clip_line(eye, direction, foot, 0u);
        map = map_span(line, span.y);
        far_plane = select(-line.base.z / line.slope.z, map.y, line.slope.z == 0.0);
        far_plane = clamp(far_plane, map.x, max(map.x, map.y));
    }

    var layer = 0u;
    if KIND == LIGHT_POINT {
        layer = shadow_face(span.x * direction - foot.towards);
    }
    var here = span.x;
    var parts = 0u;
    // No early return: a software driver runs all lanes through the loads below, with what their variables hold.
    var done = !(span.x < span.y);
    // A lit run that has begun, and its beginning: scaled place and weight.
    var open = false;
    var first = vec2f(0.0);
    var sum = vec3f(0.0);

    // The walk: how much of a segment lies behind, and the block ahead.
    var segment: Segment;
    var inverse = vec2f(0.0);
    var at = 1.0;
    var entry_depth = 0.0;
    var cell = vec2i(0);
    var level = 0;

    // Each ray walks to the end of its next lit run or segment; then all rays integrate together.
    let most = 4u * u32(light.shadow_size) + 64u;
    for (var round = 0u; round < most && !done; round += 1u) {
        if at >= 1.0 {
            if KIND == LIGHT_DIRECTIONAL {
                // In front of the far plane and behind it, in the order of the ray.
                done = parts == 2u || map.x >= map.y;
                let behind = (line.slope.z > 0.0) == (parts == 0u) && (line.slope.z != 0.0 || line.base.z < 0.0);
                let begin = select(far_plane, map.x, parts == 0u);
                segment = parallel_segment(line, begin, select(map.y, far_plane, parts == 0u), behind);
                if parts == 0u && map.x > 0.0 {
                    segment.lit_before = true;
                    segment.before = 0.0;
                }
            } else {
                done = here >= span.y || parts >= 8u;
                line = clip_line(eye, direction, foot, layer);
                var exit = span.y;
                if KIND == LIGHT_POINT {
                    exit = face_exit(line, here, span.y);
                }
                segment = perspective_segment(line, layer, foot.height, here, exit);
                here = exit;
                if KIND == LIGHT_POINT {
                    layer = face_beyond(layer, exit * direction - foot.towards);
                }
            }
            parts += 1u;
            if done && KIND == LIGHT_DIRECTIONAL && !open && (map.x >= map.y || map.y < span.y) {
                // Outside the map nothing stands in the way.
                open = true;
                first = vec2f(select(0.0, map.y, map.x < map.y), 1.0);
            }
            if !done {
                if segment.lit_before && !open {
                    open = true;
                    first = vec2f(segment.before, 1.0);
                }
                inverse = select(1.0 / segment.delta, vec2f(1e30), abs(segment.delta) < vec2f(1e-30));
                at = 0.0;
                entry_depth = segment.depth.x;
                level = coarsest;
                cell = vec2i(segment.origin) >> vec2u(u32(level));
            }
        }

        // Where in the segment a run begins and ends; one that began before it, at a negative number.
        var begin = -1.0;
        var run_begin = -1.0;
        var end = 0.0;
        var closed = done && open;
        let ahead = select(vec2i(0), vec2i(1), segment.delta >= vec2f(0.0));
        for (var step = 0u; step < 8u * most && at < 1.0 && !closed; step += 1u) {
            // How far the ray is in this block, and between which depths.
            let scale = f32(1u << u32(level));
            let exits = (vec2f(cell + ahead) * scale - segment.origin) * inverse;
            let exit = clamp(min(exits.x, exits.y), at, 1.0);
            let exit_depth = segment.depth.x * (1.0 - exit) + segment.depth.y * exit;
            let word = textureLoad(levels, cell, segment.layer, level).x;
            let leaf = level == 0;
            let most_depth = bitcast<f32>(select(word & 0xffff0000u, word, leaf));
            let least_depth = bitcast<f32>(select(word << 16u, word, leaf));
            let enters_lit = entry_depth >= most_depth;
            let leaves_lit = exit_depth >= most_depth;
            let dark = max(entry_depth, exit_depth) < least_depth;
            if leaf || dark || (enters_lit && leaves_lit) {
                // In a texel whose depth the ray crosses, where it does so.
                let share = clamp((most_depth - entry_depth) / (exit_depth - entry_depth), 0.0, 1.0);
                let edge = at + share * (exit - at);
                // At most one run ends in a block: at its entry, or within. Another one may begin behind it.
                closed = (open && !enters_lit) || (enters_lit && !leaves_lit);
                run_begin = select(begin, at, enters_lit && !open);
                end = select(at, edge, enters_lit);
                begin = select(edge, run_begin, enters_lit);
                open = leaves_lit;

                // On to the next block; up a level only where the parent changes.
                let moved = cell + select(vec2i(0, 2 * ahead.y - 1), vec2i(2 * ahead.x - 1, 0), exits.x <= exits.y);
                let up = level < coarsest && any((moved >> vec2u(1u)) != (cell >> vec2u(1u)));
                let border = (size - 1) >> u32(level);
                at = select(exit, 1.0, any(moved < vec2i(0)) || any(moved > vec2i(border)));
                entry_depth = exit_depth;
                cell = select(moved, moved >> vec2u(1u), up);
                level += select(0, 1, up);
            } else {
                let middle = (vec2f(cell) + 0.5) * scale;
                cell = 2 * cell + select(vec2i(0), vec2i(1), segment.origin + at * segment.delta >= middle);
                level -= 1;
            }
        }
        if closed {
            let run_first = select(segment_place(segment, run_begin), first, run_begin < 0.0);
            let last = select(segment_place(segment, end), vec2f(span.y, 1.0), done);
            sum += run_airlight(foot, direction, run_first, last, kinks);
        }
        first = select(segment_place(segment, begin), first, begin < 0.0);
    }
    return ray_factor(foot, direction) * sum;
}

@fragment
fn fs_rays(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let direction = view_ray(view, pixel.xy);
    let distance = view_distance(view, textureLoad(scene_depth, vec2i(pixel.xy), 0), direction);
    let radiance = ray_airlight(view.eye, direction, distance);
    return vec4f(clamp(radiance, vec3f(0.0), vec3f(most_radiance)), 0.0);
}
