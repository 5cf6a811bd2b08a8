// Twin: `VolumeUniform` in src/renderer.rs.

/// What a light's shadow planes are drawn with.
struct Volume {
    /// With a near plane so near that it cuts nothing off.
    clip_from_world: mat4x4f,
    /// The eye, off all shadow planes [m].
    eye: vec3f,
    /// Panels that the quadrature cuts a ray into, before and after the foot point.
    panels: u32,
    /// Radiance that multiple scattering and emission add up to in a medium without end, RGB.
    ambient: vec3f,
    /// Share of `ambient` that this light's surroundings send to a surface.
    share: f32,
    /// Logarithms of the extinction coefficients, in lengths of the airlight table's first axis and from its beginning.
    column: vec3f,
}
