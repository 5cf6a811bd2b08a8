// What the window shows: two pictures of linear radiance, divided by an upright line, tone-mapped as common's `Image::to_srgb8`
// does it. Needs fullscreen.

struct Shown {
    /// Factor before the tone curve.
    exposure: f32,
    /// Share of the width that the first picture has.
    divided: f32,
}

@group(0) @binding(0) var<uniform> shown: Shown;
@group(0) @binding(1) var first: texture_2d<f32>;
/// May be coarser: its pixels are shown as squares.
@group(0) @binding(2) var second: texture_2d<f32>;

/// What stands for NaN and infinity.
const BROKEN: vec3f = vec3f(1.0, 0.0, 1.0);
const LARGEST: f32 = 3.4e38;

fn texel(size: vec2u, share: vec2f) -> vec2u {
    return min(vec2u(share * vec2f(size)), size - 1u);
}

fn srgb(linear: vec3f) -> vec3f {
    return select(1.055 * pow(linear, vec3f(1.0 / 2.4)) - 0.055, 12.92 * linear, linear <= vec3f(0.0031308));
}

@fragment
fn fs_present(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let share = position.xy / vec2f(textureDimensions(first));
    let a = textureLoad(first, texel(textureDimensions(first), share), 0).rgb;
    let b = textureLoad(second, texel(textureDimensions(second), share), 0).rgb;
    let radiance = select(b, a, share.x < shown.divided);
    let seen = srgb(1.0 - exp(-max(radiance * shown.exposure, vec3f(0.0))));
    return vec4f(select(BROKEN, seen, all(abs(radiance) <= vec3f(LARGEST))), 1.0);
}
