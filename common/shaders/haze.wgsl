// The medium, its kind fixed when a pipeline is made: lobes that are not there cost nothing, not even where all branches
// are executed. Needs phase, medium; and the global `medium: Medium`. Twin of the overrides: Haze.

/// Whether extinction is the same in all colours.
override GREY: bool = false;
/// How many lobes the phase function has, and which: LOBE_*.
override LOBES: u32 = 1u;
override LOBE_0: u32 = 0u;
override LOBE_1: u32 = 0u;
override LOBE_2: u32 = 0u;
override LOBE_3: u32 = 0u;

/// Phase function of the medium, RGB [1/sr].
fn phase(cos_theta: f32) -> vec3f {
    var sum = medium.lobes[0].weight * phase_lobe(LOBE_0, medium.lobes[0].g, cos_theta);
    if LOBES > 1u {
        sum += medium.lobes[1].weight * phase_lobe(LOBE_1, medium.lobes[1].g, cos_theta);
    }
    if LOBES > 2u {
        sum += medium.lobes[2].weight * phase_lobe(LOBE_2, medium.lobes[2].g, cos_theta);
    }
    if LOBES > 3u {
        sum += medium.lobes[3].weight * phase_lobe(LOBE_3, medium.lobes[3].g, cos_theta);
    }
    return sum;
}

/// Fraction that passes `distance` [m] of the medium, RGB.
fn transmittance(distance: f32) -> vec3f {
    var passed = vec3f(exp(-medium.sigma_t.x * distance));
    if !GREY {
        passed = exp(-medium.sigma_t * distance);
    }
    return passed;
}
