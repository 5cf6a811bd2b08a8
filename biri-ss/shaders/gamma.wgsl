// Unshadowed airlight from the eye to a distance along a view ray, by the paper's tables or by quadrature.
// Needs phase, medium, light, kind, haze, common's airlight, table; and the globals `medium: Medium`, `light: Light`,
// `volume: Volume`, `gammas: texture_2d_array<f32>` (a layer for each lobe of the phase function).

/// 0: quadrature; 1: Γ, (7) of the paper; 2: its form that does not cancel where the light is behind the eye.
override airlight_form: u32 = 0u;
/// What kind of light is drawn, so that a shader holds nothing that it does not need: 0: a directional one; 1: one
/// that tables hold; 2: one to be integrated.
override light_form: u32 = 2u;

const GAMMA_LEAST: f32 = 1e-4;
const GAMMA_MOST: f32 = 30.0;
const HALF_PI: f32 = 1.57079632679490;
/// Farther than any scene [m]; its square is still a number.
const FAR_AWAY: f32 = 1e15;

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

/// Airlight of one colour from row `low` to `high` per unit of intensity and scattering coefficient.
fn gamma_difference(foot: Foot, colour: u32, low: f32, high: f32, distances: vec2f) -> f32 {
    let s = medium.sigma_t[colour];
    var near = 0.0;
    var far = 0.0;
    for (var i = 0u; i < LOBES; i += 1u) {
        let weight = medium.lobes[i].weight[colour];
        near += weight * gamma_value(i, s * foot.height, low);
        far += weight * gamma_value(i, s * foot.height, high);
    }
    let scale = 1.0 / (4.0 * PI * foot.height);
    if airlight_form == 1u {
        // (7): k_t² Ω I/4π · e^(−k_t t)/(k_t h) [Γ(γ_d) − Γ(γ_0)]. The shader of Figure 7 has e^(−k_t d) in its
        // place, which differs from plane to plane, and divides by h alone.
        return scale * exp(-s * foot.along) * (far - near);
    }
    return scale * (exp(-s * distances.x) * near - exp(-s * distances.y) * far);
}

/// Airlight of a point or spot of constant intensity between two distances by table, RGB.
fn airlight_gamma(foot: Foot, from_x: f32, to_x: f32) -> vec3f {
    if to_x <= from_x {
        return vec3f(0.0);
    }
    let ends = min(vec2f(from_x, to_x), vec2f(FAR_AWAY));
    let beyond = ends - foot.along;
    let from_light = sqrt(beyond * beyond + foot.height * foot.height);
    let low = gamma_row(beyond.x, from_light.x, foot.height);
    let high = gamma_row(beyond.y, from_light.y, foot.height);
    // Way from the light to the eye by either end.
    let distances = ends + from_light;
    var value = vec3f(0.0);
    for (var colour = 0u; colour < select(3u, 1u, GREY); colour += 1u) {
        value[colour] = gamma_difference(foot, colour, low, high, distances);
    }
    if GREY {
        value = vec3f(value.x);
    }
    return value * medium.sigma_s;
}

/// Unshadowed airlight of `light` from the eye to the distance `x` [m], RGB [W/m²/sr].
fn airlight(eye: vec3f, direction: vec3f, x: f32) -> vec3f {
    if light_form == 0u {
        return airlight_directional(direction, x);
    }
    let foot = foot_of(eye, direction, light.position);
    let breaks = airlight_breaks(eye, direction, x);
    if light_form == 1u {
        return light.strength * airlight_gamma(foot, breaks.x, breaks.w);
    }
    return airlight_between(foot, direction, breaks, volume.panels);
}
