// A homogeneous medium with a phase function of up to four lobes. Twin: common/src/medium.rs.
// Kinds of lobes are in haze.wgsl.

struct Lobe {
    /// Share of this lobe, RGB.
    weight: vec3f,
    /// Asymmetry, where the lobe has one.
    g: f32,
}

struct Medium {
    /// Scattering coefficient, RGB [1/m].
    sigma_s: vec3f,
    /// Extinction coefficient, RGB [1/m].
    sigma_t: vec3f,
    /// Those that are not in use are zero.
    lobes: array<Lobe, 4>,
}
