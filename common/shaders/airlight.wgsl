// Unshadowed airlight from the eye to a distance along a view ray, by quadrature, for every kind of light.
// Twin: common/src/airlight.rs. Needs phase, medium, light, kind, haze; and the globals `medium: Medium`, `light: Light`.

/// Where a light lies relative to a view ray.
struct Foot {
    /// Distance along the ray to the foot of the perpendicular from the light [m]; negative behind the eye.
    along: f32,
    /// Length of the perpendicular [m], positive.
    height: f32,
    /// Unit vector from the foot point to the light.
    towards: vec3f,
}

/// By the cross product: sqrt(l² - along²) cancels, and gives NaN for light near the ray.
fn foot_of(eye: vec3f, direction: vec3f, position: vec3f) -> Foot {
    let to_light = position - eye;
    let along = dot(to_light, direction);
    let perpendicular = cross(direction, cross(to_light, direction));
    // A ray through the light itself is infinitely bright; a millionth of the distance is as near as it gets.
    let least = max(1e-6 * length(to_light), 1e-12 * light.far);
    let height = max(length(cross(to_light, direction)), least);
    return Foot(along, height, perpendicular / max(length(perpendicular), 1e-30));
}

/// Part of a ray inside a cone: from and to [m]; empty where from >= to. The cone's half angle is below
/// 90°, so it is convex and the part is one interval.
fn cone_interval(apex_to_eye: vec3f, direction: vec3f, axis: vec3f, cosine: f32) -> vec2f {
    let a = dot(direction, axis);
    let b = dot(apex_to_eye, axis);
    let c2 = cosine * cosine;
    // q(x) = (b + a x)² - c² |apex_to_eye + x direction|² >= 0 on the near nappe.
    let q2 = a * a - c2;
    let q1 = a * b - c2 * dot(apex_to_eye, direction);
    let q0 = b * b - c2 * dot(apex_to_eye, apex_to_eye);
    // q1² - q2 q0, written so that nothing cancels but where the ray grazes the cone.
    let normal = cross(apex_to_eye, direction);
    let across = dot(normal, axis);
    let discriminant = c2 * ((1.0 - cosine) * (1.0 + cosine) * dot(normal, normal) - across * across);
    // Citardauq's form: no cancellation.
    let q = -(q1 + select(-1.0, 1.0, q1 >= 0.0) * sqrt(max(discriminant, 0.0)));
    let r0 = q / select(q2, 1e-12, abs(q2) < 1e-12);
    let r1 = q0 / select(q, 1e-30, abs(q) < 1e-30);
    let low = min(r0, r1);
    let high = max(r0, r1);
    // Steeper than the cone: one cut on each nappe; the near nappe lies where b + a x > 0.
    var part = select(vec2f(-1e30, low), vec2f(high, 1e30), a > 0.0);
    if q2 < 0.0 {
        // Flatter: the ray cuts one nappe twice.
        part = select(vec2f(low, high), vec2f(0.0), b + a * 0.5 * (low + high) < 0.0);
    }
    return select(part, vec2f(0.0), discriminant <= 0.0);
}

/// Integrand in the angle at the light: phase function, the spot's falloff, transmittance. (5)-(7) of
/// Biri et al. 2006 put right: path = x + r = along + height · tan(angle/2 + π/4), dx/r² = dangle/height.
/// `turn` has the angle's sine and cosine: near right angles these say more than the angle does.
fn airlight_node(foot: Foot, direction: vec3f, turn: vec2f) -> vec3f {
    let s = turn.x;
    let c = max(turn.y, 1e-20);
    // tan(angle/2 + π/4), without cancellation on either side.
    let u = select(c / (1.0 - s), (1.0 + s) / c, s > 0.0);
    let path = foot.along + foot.height * u;
    var value = phase(-s) * transmittance(path);
    if KIND == LIGHT_SPOT && HAS_RAMP {
        let away = s * direction - c * foot.towards;
        // The interval is clipped to the cone beforehand: rounding must not fall off its edge.
        let cos_angle = max(dot(away, light.direction), light.cos_outer);
        value *= light_falloff(cos_angle, light.cos_inner, light.cos_outer);
    }
    return value;
}

fn airlight_at_angle(foot: Foot, direction: vec3f, angle: f32) -> vec3f {
    return airlight_node(foot, direction, vec2f(sin(angle), cos(angle)));
}

/// Four-point Gauss-Legendre rule over [middle - half, middle + half].
fn airlight_panel(foot: Foot, direction: vec3f, middle: f32, half: f32) -> vec3f {
    let a = 0.339981043584856265 * half;
    let b = 0.861136311594052575 * half;
    return half * (
        0.652145154862546143 * (airlight_at_angle(foot, direction, middle - a) + airlight_at_angle(foot, direction, middle + a))
        + 0.347854845137453857 * (airlight_at_angle(foot, direction, middle - b) + airlight_at_angle(foot, direction, middle + b))
    );
}

/// Integrand in q, where the angle lacks end + width q² of a right one: nodes gather at the end, where the path back to the
/// eye makes the integrand fall off within the last bit of angle.
fn airlight_graded(foot: Foot, direction: vec3f, end: f32, width: f32, q: f32) -> vec3f {
    let lacking = end + width * q * q;
    return 2.0 * width * q * airlight_node(foot, direction, vec2f(cos(lacking), sin(lacking)));
}

/// Eight-point Gauss-Legendre rule in q over [middle - half, middle + half].
fn airlight_graded_panel(foot: Foot, direction: vec3f, end: f32, width: f32, middle: f32, half: f32) -> vec3f {
    let a = 0.183434642495649805 * half;
    let b = 0.525532409916328986 * half;
    let c = 0.796666477413626740 * half;
    let d = 0.960289856497536232 * half;
    return half * (
        0.362683783378361983
            * (airlight_graded(foot, direction, end, width, middle - a) + airlight_graded(foot, direction, end, width, middle + a))
        + 0.313706645877887287
            * (airlight_graded(foot, direction, end, width, middle - b) + airlight_graded(foot, direction, end, width, middle + b))
        + 0.222381034453374471
            * (airlight_graded(foot, direction, end, width, middle - c) + airlight_graded(foot, direction, end, width, middle + c))
        + 0.101228536290376259
            * (airlight_graded(foot, direction, end, width, middle - d) + airlight_graded(foot, direction, end, width, middle + d))
    );
}

/// Airlight of a point or spot per unit intensity between two distances, by quadrature, RGB [1/m²/sr].
/// Up to the foot point the integrand is smooth: four nodes in each of `panels` panels; beyond it eight, graded.
fn airlight_quadrature(foot: Foot, direction: vec3f, from_x: f32, to_x: f32, panels: u32) -> vec3f {
    if to_x <= from_x {
        return vec3f(0.0);
    }
    let h = foot.height;
    let from_foot = from_x - foot.along;
    // Beyond that far the angle is a right one; no product overflows.
    let to_foot = min(to_x - foot.along, 1e8 * max(h, abs(from_foot)));
    let low = atan2(from_foot, h);
    // On one side of the foot point, both angles may be nearly right ones: their difference would lose all digits.
    let width = atan2(h * (to_foot - from_foot), h * h + from_foot * to_foot);
    var sum = vec3f(0.0);
    // Counts that depend on the ray, not branches around loops to a uniform number: see Variant.
    let before = select(0u, panels, from_foot < 0.0);
    let half = 0.5 * select(-low, width, to_foot <= 0.0) / f32(panels);
    for (var i = 0u; i < before; i += 1u) {
        sum += airlight_panel(foot, direction, low + (2.0 * f32(i) + 1.0) * half, half);
    }
    let beyond = select(0u, panels, to_foot > 0.0);
    let rest = select(atan2(to_foot, h), width, from_foot >= 0.0);
    let end = atan2(h, to_foot);
    let half_graded = 0.5 / f32(panels);
    for (var i = 0u; i < beyond; i += 1u) {
        let q = (2.0 * f32(i) + 1.0) * half_graded;
        sum += airlight_graded_panel(foot, direction, end, rest, q, half_graded);
    }
    return medium.sigma_s * sum / h;
}

/// Distances at which the integrand along a ray begins, has its kinks, and ends: nothing of a point light;
/// for a spot where the ray is in its cone, and in its cone of whole intensity.
fn airlight_breaks(eye: vec3f, direction: vec3f, x: f32) -> vec4f {
    if KIND == LIGHT_POINT {
        return vec4f(0.0, x, x, x);
    }
    // A spot shines between two distances only; airlight stays a function of x alone, so the volume's
    // faces still add up to the lit parts exactly.
    let to_eye = eye - light.position;
    let cone = cone_interval(to_eye, direction, light.direction, light.cos_outer);
    let first = max(cone.x, 0.0);
    let last = max(min(x, cone.y), first);
    if !HAS_RAMP {
        return vec4f(first, last, last, last);
    }
    let inner = cone_interval(to_eye, direction, light.direction, light.cos_inner);
    return vec4f(first, clamp(inner.x, first, last), clamp(inner.y, first, last), last);
}

/// (1 - exp(-sigma x)) / sigma, without cancellation for thin media.
fn attenuated_length(sigma: f32, x: f32) -> f32 {
    let tau = sigma * x;
    if tau < 1e-2 {
        return x * (1.0 - tau * (0.5 - tau * (1.0 / 6.0 - tau / 24.0)));
    }
    return (1.0 - exp(-tau)) / sigma;
}

/// Unshadowed airlight of a directional light from the eye to the distance `x` [m], RGB [W/m²/sr].
fn airlight_directional(direction: vec3f, x: f32) -> vec3f {
    let length = vec3f(
        attenuated_length(medium.sigma_t.x, x),
        attenuated_length(medium.sigma_t.y, x),
        attenuated_length(medium.sigma_t.z, x),
    );
    // The light's leg is not attenuated: its strength is what arrives in the scene.
    return light.strength * medium.sigma_s * phase(-dot(light.direction, direction)) * length;
}

/// Unshadowed airlight of a point or spot from the eye to the last of `breaks`, RGB [W/m²/sr].
fn airlight_between(foot: Foot, direction: vec3f, breaks: vec4f, panels: u32) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < 3u; i += 1u) {
        sum += airlight_quadrature(foot, direction, breaks[i], breaks[i + 1u], panels);
    }
    return light.strength * sum;
}
