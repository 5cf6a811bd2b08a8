// What all passes know of the cloud and its network. Twins: szk-network/src/{network,plan,directions}.rs.
// Arrays hold direction by direction, in each particle by particle; of radiance colour by colour before that.

const NOBODY: u32 = 0xffffffffu;
const PHASE_ENTRIES: u32 = 2048u;

struct Cloud {
    /// Centre of the bounding sphere [m].
    centre: vec3f,
    /// Its radius [m].
    radius: f32,
    /// Lowest corner of the voxels [m].
    low: vec3f,
    /// Number of particles.
    count: u32,
    /// Highest corner of the voxels [m].
    high: vec3f,
    /// Number of directions.
    directions: u32,
    /// Extinction coefficient where the density is 1 [1/m].
    sigma_t: f32,
    /// Side of the windows [pixels].
    pixels: u32,
    /// Bits of a key that hold the pixel.
    pixel_bits: u32,
    /// Depths that the rest of a key tells apart.
    levels: f32,
    /// Radius of a splat, in radii of the particle's ball.
    overlap: f32,
    /// Number of lights.
    lights: u32,
    /// Components of each phase function, in blocks of four.
    blocks: u32,
    /// Largest residual at which steps end.
    tolerance: f32,
    /// 1 where matrices are those of colours, not of phase functions.
    by_colour: u32,
    /// Length of the array of splats that is sorted.
    padded: u32,
}

struct Particle {
    /// Centre [m].
    position: vec3f,
    /// Radius of its ball [m].
    radius: f32,
    albedo: vec3f,
    /// Extinction coefficient times volume [m²].
    cross_section: f32,
    /// Radiance that it emits into each direction of the network [W m⁻² sr⁻¹].
    emission: vec3f,
    /// Which phase function.
    phase: u32,
    /// Cross section in the area of a pixel.
    depth: f32,
    /// Opacity that belongs to it.
    opacity: f32,
    /// Share of what it scatters that meets it once more.
    again: f32,
}

struct Window {
    direction: vec3f,
    right: vec3f,
    up: vec3f,
    offset: vec2f,
}

/// Direct light at a particle: its way, and what part of the light collides there in the area of a pixel.
struct Arrival {
    direction: vec3f,
    /// One over the sum of the phase function over the directions, times their number over 4π.
    norm: f32,
    irradiance: vec3f,
}

/// Place in an array of a phase function's table for a cosine; linear in sin(θ/2).
fn phase_place(cosine: f32) -> f32 {
    return sqrt(clamp(0.5 - 0.5 * cosine, 0.0, 1.0)) * f32(PHASE_ENTRIES - 1u);
}
