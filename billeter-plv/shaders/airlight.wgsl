// Unshadowed airlight from the eye to a distance along a view ray, by the paper's table where that covers it.
// Needs phase, medium, light, kind, haze, common's airlight, table; and the globals `medium: Medium`, `light: Light`,
// `draw: Draw`, `tables: texture_2d_array<f32>` (twice as many layers as lobes: ahead of and behind the foot point).

/// How a light's airlight is found, so that a shader holds nothing that it does not need: 0: in closed form; 1: by table;
/// 2: by table, integrated beyond its domain; 3: integrated; 4: integrated, with a soft edge.
override light_form: u32 = 4u;

struct Draw {
    /// Which of the light's projections.
    layer: u32,
    /// Panels that the quadrature cuts a ray into, before and after the foot point.
    panels: u32,
}

/// Optical depths that the table covers: exp(-16.1181) to exp(17.9099 - 16.1181), as printed.
const TABLE_LEAST: f32 = 1e-7;
const TABLE_MOST: f32 = 6.0;

/// Where in the table an optical depth lies, in [0, 1]: log-log, as map_x and map_y of the paper.
fn table_position(tau: f32) -> f32 {
    return log(clamp(tau, TABLE_LEAST, TABLE_MOST) / TABLE_LEAST) / log(TABLE_MOST / TABLE_LEAST);
}

/// Integral of one lobe from the eye to `distance`, in units of 1/height: airlight() of the paper with its
/// sign cases put right: zero foot distances belong to a case, and nothing is clamped afterwards.
fn table_integral(lobe: u32, along: f32, distance: f32, height: f32) -> f32 {
    let y = table_position(height);
    let ahead = 2u * lobe;
    let behind = 2u * lobe + 1u;
    let x = table_position(abs(along));
    let rest = distance - along;
    let x_rest = table_position(abs(rest));
    if along < 0.0 {
        // Light behind the eye: both parts lie beyond the foot point.
        return exp(-along)
            * (table_lookup(tables, behind, vec2f(x_rest, y)) - table_lookup(tables, behind, vec2f(x, y)));
    }
    let to_foot = table_lookup(tables, ahead, vec2f(x, y));
    if rest < 0.0 {
        // The ray ends before the foot point: take away what lies between.
        return to_foot - exp(-distance) * table_lookup(tables, ahead, vec2f(x_rest, y));
    }
    return to_foot + exp(-along) * table_lookup(tables, behind, vec2f(x_rest, y));
}

/// Whether a ray lies within the table's domain; beyond it the clamped table is wrong by large factors.
fn table_covers(along: f32, distance: f32, height: f32) -> bool {
    return height >= TABLE_LEAST && max(height, along) <= TABLE_MOST && along >= -TABLE_MOST
        && distance - along >= -TABLE_MOST;
}

/// As airlight_quadrature, from the eye to `to_x`, by the table; one look-up pair for each lobe and colour.
fn airlight_table(foot: Foot, to_x: f32) -> vec3f {
    var sum = vec3f(0.0);
    if to_x <= 0.0 {
        return sum;
    }
    for (var i = 0u; i < LOBES; i += 1u) {
        var value = vec3f(0.0);
        if GREY {
            let s = medium.sigma_t.x;
            value = vec3f(table_integral(i, s * foot.along, s * to_x, s * foot.height));
        } else {
            for (var colour = 0u; colour < 3u; colour += 1u) {
                let s = medium.sigma_t[colour];
                value[colour] = table_integral(i, s * foot.along, s * to_x, s * foot.height);
            }
        }
        sum += medium.lobes[i].weight * value;
    }
    return medium.sigma_s * sum / foot.height;
}

/// Whether the table covers a ray in all colours.
fn table_covers_colours(foot: Foot, to_x: f32) -> bool {
    let s = medium.sigma_t;
    let least = min(s.x, min(s.y, s.z));
    let most = max(s.x, max(s.y, s.z));
    // Both ends of the range of colours: what lies between them is covered too.
    return least * foot.height >= TABLE_LEAST && table_covers(most * foot.along, most * to_x, most * foot.height);
}

/// Unshadowed airlight of `light` from the eye to the distance `x` [m], RGB [W/m²/sr].
fn airlight(eye: vec3f, direction: vec3f, x: f32) -> vec3f {
    if light_form == 0u {
        return airlight_directional(direction, x);
    }
    let foot = foot_of(eye, direction, light.position);
    let breaks = airlight_breaks(eye, direction, x);
    if light_form == 4u {
        return airlight_between(foot, direction, breaks, draw.panels);
    }
    if light_form == 1u || (light_form == 2u && table_covers_colours(foot, breaks.w)) {
        return light.strength * (airlight_table(foot, breaks.w) - airlight_table(foot, breaks.x));
    }
    return light.strength * airlight_quadrature(foot, direction, breaks.x, breaks.w, draw.panels);
}
