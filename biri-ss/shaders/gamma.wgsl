// Unshadowed airlight from the eye to a distance along a view ray, by the paper's tables or by quadrature.
// Needs phase, medium, light, common's airlight, table; and the globals `medium: Medium`, `light: Light`,
// `volume: Volume`, `gammas: texture_2d_array<f32>` (a layer for each lobe of the phase function).

/// 0: quadrature; 1: Γ, (7) of the paper; 2: its form that does not cancel where the light is behind the eye.
override airlight_form: u32 = 0u;

const GAMMA_LEAST: f32 = 1e-4;
const GAMMA_MOST: f32 = 30.0;
const HALF_PI: f32 = 1.57079632679490;
/// Share of the larger of two terms that their difference has to keep; below it the ray is integrated.
const CONDITION: f32 = 0.05;

/// Row of the table [0, 1] for a place `beyond` the foot point, `from_light` from the light, on a ray at `height`: by the
/// angle at the light, or, in the second form, by the tangent of its half, which takes no arc tangent.
fn gamma_row(beyond: f32, from_light: f32, height: f32) -> f32 {
    if airlight_form == 1u {
        return 0.5 + atan2(beyond, height) / (2.0 * HALF_PI);
    }
    return 0.5 + 0.5 * beyond / (from_light + height);
}

/// Table value of a lobe: optical depth of the light's distance from the ray, row of the table.
fn gamma_value(lobe: u32, lambda: f32, row: f32) -> f32 {
    let x = log(clamp(lambda, GAMMA_LEAST, GAMMA_MOST) / GAMMA_LEAST) / log(GAMMA_MOST / GAMMA_LEAST);
    return table_lookup(gammas, lobe, vec2f(x, row));
}

/// Airlight of one colour from row `low` to `high` per unit of intensity and scattering coefficient, and
/// the larger of the two terms that it is the difference of.
fn gamma_difference(foot: Foot, colour: u32, low: f32, high: f32, distances: vec2f) -> vec2f {
    let s = medium.sigma_t[colour];
    var near = 0.0;
    var far = 0.0;
    for (var i = 0u; i < medium.lobe_count; i += 1u) {
        let weight = medium.lobes[i].weight[colour];
        near += weight * gamma_value(i, s * foot.height, low);
        far += weight * gamma_value(i, s * foot.height, high);
    }
    let scale = 1.0 / (4.0 * PI * foot.height);
    if airlight_form == 1u {
        // (7): k_t² Ω I/4π · e^(−k_t t)/(k_t h) [Γ(γ_d) − Γ(γ_0)]. The shader of Figure 7 has e^(−k_t d) in its
        // place, which differs from plane to plane, and divides by h alone.
        let factor = scale * exp(-s * foot.along);
        return factor * vec2f(far - near, max(abs(far), abs(near)));
    }
    let first = scale * exp(-s * distances.x) * near;
    let last = scale * exp(-s * distances.y) * far;
    return vec2f(first - last, max(first, last));
}

/// Airlight of a point or spot of constant intensity between two distances by table, RGB; w is 1 where the
/// table is good enough.
fn airlight_gamma(foot: Foot, from_x: f32, to_x: f32) -> vec4f {
    if to_x <= from_x {
        return vec4f(0.0, 0.0, 0.0, 1.0);
    }
    let ends = min(vec2f(from_x, to_x), vec2f(1e15));
    let beyond = ends - foot.along;
    let from_light = sqrt(beyond * beyond + foot.height * foot.height);
    let low = gamma_row(beyond.x, from_light.x, foot.height);
    let high = gamma_row(beyond.y, from_light.y, foot.height);
    // Way from the light to the eye by either end.
    let distances = ends + from_light;
    let most = max(medium.sigma_t.x, max(medium.sigma_t.y, medium.sigma_t.z));
    var good = most * foot.height <= GAMMA_MOST;
    var value = vec3f(0.0);
    for (var colour = 0u; colour < select(3u, 1u, medium.grey == 1u); colour += 1u) {
        let found = gamma_difference(foot, colour, low, high, distances);
        value[colour] = found.x;
        good = good && (airlight_form == 1u || found.x >= CONDITION * found.y);
    }
    if medium.grey == 1u {
        value = vec3f(value.x);
    }
    return vec4f(value * medium.sigma_s, select(0.0, 1.0, good));
}

/// Unshadowed airlight of `light` from the eye to the distance `x` [m], RGB [W/m²/sr].
fn airlight(eye: vec3f, direction: vec3f, x: f32) -> vec3f {
    if light.kind == LIGHT_DIRECTIONAL {
        return airlight_directional(direction, x);
    }
    let foot = foot_of(eye, direction, light.position);
    let breaks = airlight_breaks(eye, direction, x);
    // A table holds light of constant intensity: no spot with a soft edge.
    let soft = light.kind == LIGHT_SPOT && light.cos_inner - light.cos_outer > 1e-6;
    let peaked = airlight_form == 2u && volume.peaked == 1u;
    if airlight_form != 0u && !soft && !peaked {
        let value = airlight_gamma(foot, breaks.x, breaks.w);
        if value.w == 1.0 {
            return light.strength * value.rgb;
        }
    }
    return airlight_between(foot, direction, breaks, volume.panels);
}
