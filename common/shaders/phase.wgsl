// Phase functions [1/sr], normalised to 1 over the sphere; +1 is forward. Twin: common/src/phase.rs.

const PI: f32 = 3.14159265358979;

const LOBE_ISOTROPIC: u32 = 0u;
const LOBE_RAYLEIGH: u32 = 1u;
const LOBE_HENYEY_GREENSTEIN: u32 = 2u;
const LOBE_CORNETTE_SHANKS: u32 = 3u;
const LOBE_MIE_HAZY: u32 = 4u;
const LOBE_MIE_MURKY: u32 = 5u;

fn phase_rayleigh(cos_theta: f32) -> f32 {
    return 3.0 / (16.0 * PI) * (1.0 + cos_theta * cos_theta);
}

/// 1 + g² − 2gc to the power 3/2, without cancellation where g → ±1 looks along its own peak.
fn phase_denominator(cos_theta: f32, g: f32) -> f32 {
    let s = sign(g);
    let base = (1.0 - abs(g)) * (1.0 - abs(g)) + 2.0 * abs(g) * (1.0 - s * cos_theta);
    return base * sqrt(base);
}

fn phase_henyey_greenstein(cos_theta: f32, g: f32) -> f32 {
    return (1.0 - g * g) / (4.0 * PI * phase_denominator(cos_theta, g));
}

fn phase_cornette_shanks(cos_theta: f32, g: f32) -> f32 {
    return 3.0 * (1.0 - g * g) * (1.0 + cos_theta * cos_theta)
        / (8.0 * PI * (2.0 + g * g) * phase_denominator(cos_theta, g));
}

/// Nishita 1987, hazy; the printed function integrates to 4π · 2.
fn phase_mie_hazy(cos_theta: f32) -> f32 {
    let b = 0.5 + 0.5 * cos_theta;
    let b4 = b * b * b * b;
    return (1.0 + 9.0 * b4 * b4) / (8.0 * PI);
}

/// Nishita 1987, murky; the printed function integrates to 4π · 83/33.
fn phase_mie_murky(cos_theta: f32) -> f32 {
    let b = 0.5 + 0.5 * cos_theta;
    let b4 = b * b * b * b;
    let b16 = b4 * b4 * b4 * b4;
    return (1.0 + 50.0 * b16 * b16) * 33.0 / (4.0 * PI * 83.0);
}

fn phase_lobe(kind: u32, g: f32, cos_theta: f32) -> f32 {
    switch kind {
        case LOBE_RAYLEIGH: { return phase_rayleigh(cos_theta); }
        case LOBE_HENYEY_GREENSTEIN: { return phase_henyey_greenstein(cos_theta, g); }
        case LOBE_CORNETTE_SHANKS: { return phase_cornette_shanks(cos_theta, g); }
        case LOBE_MIE_HAZY: { return phase_mie_hazy(cos_theta); }
        case LOBE_MIE_MURKY: { return phase_mie_murky(cos_theta); }
        default: { return 1.0 / (4.0 * PI); }
    }
}
