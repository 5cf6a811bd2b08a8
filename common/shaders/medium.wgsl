// A homogeneous medium with a phase function of up to four lobes. Twin: common/src/medium.rs.
// Needs phase.wgsl.

struct Lobe {
    /// Share of this lobe, RGB.
    weight: vec3f,
    /// One of LOBE_*.
    kind: u32,
    /// Asymmetry, where the lobe has one.
    g: f32,
}

struct Medium {
    /// Scattering coefficient, RGB [1/m].
    sigma_s: vec3f,
    /// How many of `lobes` are in use, 1 to 4.
    lobe_count: u32,
    /// Extinction coefficient, RGB [1/m].
    sigma_t: vec3f,
    /// 1 where sigma_t is the same in all colours, else 0.
    grey: u32,
    lobes: array<Lobe, 4>,
}

/// Fraction that passes `distance` [m] of the medium, RGB.
fn medium_transmittance(sigma_t: vec3f, grey: u32, distance: f32) -> vec3f {
    if grey == 1u {
        return vec3f(exp(-sigma_t.x * distance));
    }
    return exp(-sigma_t * distance);
}
