// A view ray in the projections of a light's shadow map. Needs light, kind, shadow, airlight.
//
// A place along the ray is one number: the tangent of the angle at the light, or for a directional light the
// distance from the eye [m]. In a projection the ray is a straight line of texel coordinates and reversed depth,
// so between two ends of a segment all three are linear; the place itself is projective.

/// What stands for an endless ray's tangent: its angle is a right one to the last bit.
const FAR_PLACE: f32 = 1e18;

/// Part of a ray in one projection of the shadow map.
struct Segment {
    layer: i32,
    /// Texel coordinates at its beginning.
    origin: vec2f,
    /// From there to its end.
    delta: vec2f,
    /// Reversed depth at both ends.
    depth: vec2f,
    /// Places of both ends, times their weights: places mix in proportion to weights.
    scaled: vec2f,
    weight: vec2f,
    /// Light that nothing stands in the way of comes before it: from the place `before` on.
    lit_before: bool,
    before: f32,
    /// Where the next segment begins.
    next: f32,
}

/// Place and weight at a fraction of a segment: the place is their quotient.
fn segment_place(segment: Segment, fraction: f32) -> vec2f {
    return vec2f(segment.scaled.x, segment.weight.x) * (1.0 - fraction)
        + vec2f(segment.scaled.y, segment.weight.y) * fraction;
}

/// The ray's clip coordinates in a layer: `base + place * slope`.
struct ClipLine {
    base: vec4f,
    slope: vec4f,
}

fn clip_texel(clip: vec4f, size: f32) -> vec2f {
    return clamp((vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5) * size, vec2f(0.0), vec2f(size));
}

/// Segment between two places in a perspective projection.
fn perspective_segment(line: ClipLine, layer: u32, height: f32, first: f32, last: f32) -> Segment {
    // What is nearer to the light than the near plane is lit, and its depth too coarse to tell from others.
    let near = (light.near / height - line.base.w) / select(line.slope.w, 1.0, line.slope.w == 0.0);
    var from_place = first;
    var to_place = last;
    if line.slope.w > 0.0 {
        from_place = clamp(near, first, last);
    } else if line.slope.w < 0.0 {
        to_place = clamp(near, first, last);
    }
    let from_clip = line.base + from_place * line.slope;
    let to_clip = line.base + to_place * line.slope;
    let weight = light.near / max(height * vec2f(from_clip.w, to_clip.w), vec2f(light.near));
    let origin = clip_texel(from_clip, light.shadow_size);
    let delta = clip_texel(to_clip, light.shadow_size) - origin;
    let scaled = vec2f(from_place, to_place) * weight;
    return Segment(i32(layer), origin, delta, weight, scaled, weight, from_place > first, first, last);
}

/// Leaves of a cube face: the place at which a ray that is in it at `first` crosses into another one.
fn face_exit(line: ClipLine, first: f32, last: f32) -> f32 {
    // The frustum of a face is that of its border texels' centres.
    let beyond = light.shadow_size / max(light.shadow_size - 1.0, 1e-3);
    let base = beyond * line.base.xy;
    let slope = beyond * line.slope.xy;
    let value = vec4f(line.base.w - base, line.base.w + base);
    let change = vec4f(line.slope.w - slope, line.slope.w + slope);
    let exits = select(vec4f(FAR_PLACE), value / max(-change, vec4f(1e-20)), change < vec4f(0.0));
    return clamp(min(min(exits.x, exits.y), min(exits.z, exits.w)), first, last);
}

/// The face on the other side of an edge of `face`, in `direction`.
fn face_beyond(face: u32, direction: vec3f) -> u32 {
    let axis = face >> 1u;
    return shadow_face(select(direction, vec3f(0.0), vec3u(0u, 1u, 2u) == vec3u(axis)));
}

/// Part of a directional light's map that a ray crosses: places, empty where first >= last. A parallel ray's
/// part may be endless.
fn map_span(line: ClipLine, end: f32) -> vec2f {
    let slope = select(line.slope.xy, vec2f(1e-30), abs(line.slope.xy) < vec2f(1e-30));
    let one = (-1.0 - line.base.xy) / slope;
    let two = (1.0 - line.base.xy) / slope;
    let first = min(one, two);
    let last = max(one, two);
    return vec2f(max(max(first.x, first.y), 0.0), min(min(last.x, last.y), end));
}

/// Of a ray in a directional light's map the part in front of the far plane or, with `behind`, beyond it: there
/// an empty texel lets all light through and any other one none, as if the ray ran along the far plane.
fn parallel_segment(line: ClipLine, first: f32, last: f32, behind: bool) -> Segment {
    let change = line.slope.z;
    let near = (1.0 - line.base.z) / select(change, 1.0, change == 0.0);
    var from_place = first;
    var to_place = last;
    if !behind && change < 0.0 {
        from_place = clamp(near, first, last);
    } else if !behind && change > 0.0 {
        to_place = clamp(near, first, last);
    }
    let from_clip = line.base + from_place * line.slope;
    let to_clip = line.base + to_place * line.slope;
    let depth = select(max(vec2f(from_clip.z, to_clip.z), vec2f(0.0)), vec2f(0.0), behind);
    let origin = clip_texel(vec4f(from_clip.xyz, 1.0), light.shadow_size);
    let delta = clip_texel(vec4f(to_clip.xyz, 1.0), light.shadow_size) - origin;
    let scaled = vec2f(from_place, to_place);
    return Segment(0, origin, delta, depth, scaled, vec2f(1.0), from_place > first, first, last);
}
