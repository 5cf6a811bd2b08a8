// Airlight of one lit run of a view ray. Needs phase, medium, light, kind, haze, airlight, segment; and the globals
// `medium: Medium`, `light: Light`, `rays: Rays`.
//
// Six-point Gauss-Legendre in pieces that shrink towards the run's far end, where the path back to the eye makes
// the integrand fall off within the last bit of angle. Nodes lie at angles `end - 2 atan(x)` with x quadratic in
// the rule's variable, so sine, cosine and path of a node are rational in x: no trigonometry but once a piece.

/// Most pieces of a run.
const MOST_PIECES: f32 = 64.0;

struct Rays {
    /// Widest piece [rad].
    piece: f32,
    /// Number of the coarsest level.
    coarsest: u32,
}

/// Where a piece of a run ends, and how wide it is.
struct Piece {
    /// Sine and cosine of angle/2 + π/4 at its end.
    end: vec2f,
    /// Tangent of half its width.
    reach: f32,
    /// Its number, counted from the run's end.
    number: f32,
}

/// Integrand at the rule's variable `q` in [0, 1].
fn run_node(foot: Foot, direction: vec3f, piece: Piece, q: f32) -> vec3f {
    let share = 1.0 / (2.0 * piece.number + 1.0);
    let x = piece.reach * q * (2.0 * piece.number + q) * share;
    let over = 1.0 / (1.0 + x * x);
    // Sine and cosine of angle/2 + π/4 at the node, both times sqrt(1 + x²).
    let up = piece.end.x - x * piece.end.y;
    let down = max(piece.end.y + x * piece.end.x, 1e-20);
    let path = foot.along + foot.height * (up / down);
    let s = (up - down) * (up + down) * over;
    var value = (2.0 * (piece.number + q) * share * over) * phase(-s) * transmittance(path);
    if HAS_RAMP {
        let away = s * direction - (2.0 * up * down * over) * foot.towards;
        // The run is clipped to the cone beforehand: rounding must not fall off its edge.
        let cos_angle = max(dot(away, light.direction), light.cos_outer);
        value *= light_falloff(cos_angle, light.cos_inner, light.cos_outer);
    }
    return value;
}

/// Airlight between two angles at the light, but for the light's strength, sigma_s and 1/height.
fn run_integral(foot: Foot, direction: vec3f, low: f32, high: f32) -> vec3f {
    let width = max(high - low, 0.0);
    let pieces = clamp(ceil(width / rays.piece), 1.0, MOST_PIECES);
    var sum = vec3f(0.0);
    for (var i = 0.0; i < pieces; i += 1.0) {
        let near = i / pieces;
        let far = (i + 1.0) / pieces;
        let half = 0.5 * (high - width * near * near) + 0.25 * PI;
        let reach = tan(0.5 * width * (far - near) * (far + near));
        let piece = Piece(vec2f(sin(half), max(cos(half), 0.0)), reach, i);
        sum += reach * (
            0.171324492379170345 * (run_node(foot, direction, piece, 0.0337652428984239861)
                + run_node(foot, direction, piece, 0.9662347571015760139))
            + 0.360761573048138608 * (run_node(foot, direction, piece, 0.1693953067668677432)
                + run_node(foot, direction, piece, 0.8306046932331322568))
            + 0.467913934572691047 * (run_node(foot, direction, piece, 0.3806904069584015456)
                + run_node(foot, direction, piece, 0.6193095930415984544))
        );
    }
    return sum;
}

/// Airlight of a run between two places, each a vector of scaled place and weight, but for the factors that
/// `ray_factor` holds. `kinks` are the angles at which the ray meets a soft edge's inner cone.
fn run_airlight(foot: Foot, direction: vec3f, first: vec2f, last: vec2f, kinks: vec2f) -> vec3f {
    if KIND == LIGHT_DIRECTIONAL {
        let s = medium.sigma_t;
        let x = max(last.x - first.x, 0.0);
        let length = vec3f(attenuated_length(s.x, x), attenuated_length(s.y, x), attenuated_length(s.z, x));
        return transmittance(first.x) * length;
    }
    let low = atan2(first.x, first.y);
    let high = atan2(last.x, last.y);
    if !HAS_RAMP {
        return run_integral(foot, direction, low, high);
    }
    let edges = clamp(kinks, vec2f(low), vec2f(max(low, high)));
    return run_integral(foot, direction, low, edges.x) + run_integral(foot, direction, edges.x, edges.y)
        + run_integral(foot, direction, edges.y, high);
}

/// What all runs of a ray have in common.
fn ray_factor(foot: Foot, direction: vec3f) -> vec3f {
    if KIND == LIGHT_DIRECTIONAL {
        return light.strength * medium.sigma_s * phase(-dot(light.direction, direction));
    }
    return light.strength * medium.sigma_s / foot.height;
}
