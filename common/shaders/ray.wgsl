// Where on a view ray light can be, and which way it came.

/// Part of the ray (from, to) [m] that lies in a cone of half angle below 90°; empty where from >= to. It chooses between
/// results and does not branch: with branches here Mesa 22.3.6's lavapipe crashed when it made the pipelines.
fn cone_span(eye: vec3f, ray: vec3f, apex: vec3f, axis: vec3f, cos_angle: f32, end: f32) -> vec2f {
    let w = eye - apex;
    let along = vec2f(dot(axis, ray), dot(axis, w));
    let square = cos_angle * cos_angle;
    let a = along.x * along.x - square;
    let b = along.x * along.y - square * dot(ray, w);
    let c = along.y * along.y - square * dot(w, w);
    let discriminant = b * b - a * c;
    // Roots without cancellation.
    let q = -(b + select(-1.0, 1.0, b >= 0.0) * sqrt(max(discriminant, 0.0)));
    let roots = vec2f(q / a, c / q);
    let low = min(roots.x, roots.y);
    let high = max(roots.x, roots.y);
    // The ray is flatter than the cone and cuts one nappe of it twice, or runs towards one end of the double cone.
    let twice = select(vec2f(0.0), vec2f(max(low, 0.0), min(high, end)), along.y + 0.5 * (low + high) * along.x > 0.0);
    let once = select(vec2f(0.0, min(low, end)), vec2f(max(high, 0.0), end), along.x > 0.0);
    // Past the cone, or straight through its apex.
    let grazing = vec2f(0.0, select(0.0, end, a > 0.0 && along.x > 0.0 && along.y >= 0.0));
    let span = select(select(twice, once, a > 0.0), grazing, discriminant <= 0.0);
    return select(span, vec2f(0.0, end), abs(a) < 1e-6);
}

/// Where the point of a ray is that is nearest to a light.
struct Nearest {
    /// Its distance along the ray [m]; negative behind the eye.
    along: f32,
    /// Its distance from the light [m], at least `least`.
    height: f32,
}

/// By the cross product: the root of a difference of squares loses its digits near the light.
fn nearest_to(eye: vec3f, ray: vec3f, light: vec3f, least: f32) -> Nearest {
    let to_light = light - eye;
    return Nearest(dot(to_light, ray), max(length(cross(to_light, ray)), least));
}

/// A face of a point light's map and an offset in its frame.
struct FacePoint {
    /// Index, in the order of `ShadowLayer`.
    face: u32,
    /// Coordinates to the face's right, upwards, and along its forward axis.
    frame: vec3f,
}

/// The face that `away` from the light passes through. Faces look along the axes, so it takes no matrix.
fn cube_face(away: vec3f) -> FacePoint {
    let size = abs(away);
    let ahead = away > vec3f(0.0);
    var found = FacePoint(select(5u, 4u, ahead.z), vec3f(select(away.x, -away.x, ahead.z), away.y, size.z));
    if size.x >= size.y && size.x >= size.z {
        found = FacePoint(select(1u, 0u, ahead.x), vec3f(select(-away.z, away.z, ahead.x), away.y, size.x));
    } else if size.y >= size.z {
        found = FacePoint(select(3u, 2u, ahead.y), vec3f(-away.x, select(away.z, -away.z, ahead.y), size.y));
    }
    return found;
}
