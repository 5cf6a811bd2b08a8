//! The airlight functions of the shader and the table, against integrals in f64.

use billeter_plv::shaders::{self, AIRLIGHT};
use billeter_plv::table::{DOMAIN, build_tables, compute_ahead, compute_behind};
use common::airlight::airlight_point;
use common::gpu::bench::{context, eval_wgsl, uniform_branches, validate_wgsl};
use common::gpu::{TableFormat, lobe_code, upload_tables};
use common::shader::{self, HAZE, KIND, LIGHT, MEDIUM, PHASE, TABLE};
use common::table::{Axis, Table2};
use common::{Lobe, Phase};
use glam::{DVec3, Vec4};

#[test]
fn shaders_are_valid_without_optional_features() {
    for source in [shaders::volume(), shaders::tessellate()] {
        validate_wgsl(&source).unwrap();
        assert_eq!(uniform_branches(&source).unwrap(), [""; 0]);
    }
}

/// Rays past a light in units of optical depth: along, height, distance. Seeded, of the kind that scenes
/// have, and the sign cases at their borders.
fn rays() -> Vec<[f64; 3]> {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    let mut random = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut rays = vec![
        // The paper's shader turned these black: zero distance to or from the foot point.
        [0.0, 0.5, 2.0],
        [1.0, 0.5, 1.0],
        // Light far ahead, far behind, and the ray's end just before the foot point.
        [2.5, 0.3, 0.01],
        [-2.5, 0.3, 3.0],
        [1.0, 0.1, 0.999],
        [1.0, 1e-4, 5.0],
    ];
    for _ in 0..300 {
        let l = 1e-2 * 300f64.powf(random());
        let cosine = 2.0 * random() - 1.0;
        let distance = 0.03 * 100f64.powf(random());
        rays.push([l * cosine, l * (1.0 - cosine * cosine).sqrt(), distance]);
    }
    rays
}

/// Relative errors of the shader's airlight over all rays, ascending.
fn shader_errors(lobe: Lobe, table: bool) -> Vec<f64> {
    let context = context();
    // Lengths in metres at an extinction that is not 1, which would hide a missing factor.
    let sigma = 0.25;
    let rays = rays();
    let inputs: Vec<Vec4> =
        rays.iter().map(|r| Vec4::from_array([r[0], r[1], r[2], 0.0].map(|x| (x / sigma) as f32))).collect();
    let (kind, g) = lobe_code(&lobe);
    let prelude = format!(
        "medium.sigma_s = vec3f({0:?} * 0.9); medium.sigma_t = vec3f({0:?});
         medium.lobes[0] = Lobe(vec3f(1.0), {g:?});
         draw.panels = 1u;
         let direction = vec3f(0.0, 0.0, -1.0); let foot = Foot(x.x, x.y, vec3f(0.0, 1.0, 0.0));",
        sigma as f32
    );
    let switched = AIRLIGHT.replace(
        "override light_form: u32 = 4u",
        &format!("const light_form: u32 = {}u", if table { 2 } else { 4 }),
    );
    let built = build_tables(lobe, 1024, 512);
    let view =
        upload_tables(&context.device, &context.queue, "test", &[&built[0], &built[1]], TableFormat::F32);
    let haze = HAZE
        .replace("GREY: bool = false", "GREY: bool = true")
        .replace("LOBE_0: u32 = 0u", &format!("LOBE_0: u32 = {kind}u"));
    let globals = "var<private> medium: Medium; var<private> light: Light; var<private> draw: Draw;";
    let chunks = [PHASE, MEDIUM, LIGHT, KIND, globals, &haze, shader::AIRLIGHT, TABLE, &switched];
    let textures = [("tables: texture_2d_array<f32>", &view)];
    // As `airlight` does it for a point light of unit intensity.
    let expression =
        "vec4f(select(airlight_quadrature(foot, direction, 0.0, x.z, draw.panels), airlight_table(foot, x.z),
        light_form == 2u && table_covers_colours(foot, x.z)), 0.0)";
    let got = eval_wgsl(context, &chunks, &textures, &prelude, expression, &inputs);
    let mut errors: Vec<f64> = got
        .iter()
        .zip(&inputs)
        .map(|(got, x)| {
            let exact = airlight_point(
                DVec3::splat(sigma),
                DVec3::splat(0.9 * sigma),
                &Phase::from(lobe),
                f64::from(x.x),
                f64::from(x.y),
                0.0,
                f64::from(x.z),
                1e-10,
            );
            assert!(got.x.is_finite(), "{x}");
            (f64::from(got.x) / exact.x - 1.0).abs()
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors
}

/// The error that a fraction of the rays stays below.
fn quantile(errors: &[f64], fraction: f64) -> f64 {
    errors[((errors.len() - 1) as f64 * fraction) as usize]
}

#[test]
fn quadrature_is_the_integral() {
    for (lobe, bound) in [
        (Lobe::Isotropic, 5e-4),
        (Lobe::Rayleigh, 5e-4),
        (Lobe::HenyeyGreenstein { g: 0.5 }, 5e-3),
        (Lobe::MieHazy, 5e-3),
    ] {
        let errors = shader_errors(lobe, false);
        let (worst, median) = (quantile(&errors, 1.0), quantile(&errors, 0.5));
        println!("{lobe:?}: worst {worst:.1e}, median {median:.1e}");
        assert!(worst < bound, "{lobe:?}: {worst}");
        assert!(median < 5e-6, "{lobe:?}: {median}");
    }
}

#[test]
fn the_table_is_the_integral_within_its_resolution() {
    // Short rays far from the foot point are the difference of two nearly equal entries, and lose all
    // digits of the interpolation; the others do not.
    for lobe in [Lobe::Isotropic, Lobe::HenyeyGreenstein { g: 0.5 }] {
        let errors = shader_errors(lobe, true);
        let [median, high, worst] = [0.5, 0.9, 1.0].map(|fraction| quantile(&errors, fraction));
        println!("{lobe:?}: median {median:.1e}, 90 % {high:.1e}, worst {worst:.1e}");
        assert!(median < 3e-4 && high < 1e-2 && worst < 1.0, "{lobe:?}: {median} {high} {worst}");
    }
}

#[test]
fn entries_are_the_golden_integral() {
    // Both parts of a ray with the light at (t, h): L = sigma_s sigma_t I / l * (ahead + e^-t behind).
    for [along, height, distance] in [[1.0, 0.5, 3.0], [0.02, 0.3, 2.0], [4.0, 1e-3, 6.0], [0.5, 2.0, 0.6]] {
        for lobe in [Lobe::Isotropic, Lobe::CornetteShanks { g: 0.5 }] {
            let sum = compute_ahead(lobe, along, height)
                + (-along).exp() * compute_behind(lobe, distance - along, height);
            let exact =
                airlight_point(DVec3::ONE, DVec3::ONE, &lobe.into(), along, height, 0.0, distance, 1e-12).x;
            assert!((sum / height / exact - 1.0).abs() < 1e-5, "{lobe:?} {along} {height}: {sum} {exact}");
        }
    }
}

#[test]
fn interpolation_is_as_good_as_its_texels() {
    let built = build_tables(Lobe::Isotropic, 256, 128);
    let ahead = built[0].worst_error(|t, l| compute_ahead(Lobe::Isotropic, t, l));
    // 1024×512 reaches 6e-3 (formulas); a fourth of the texels has sixteen times the error.
    assert!((0.01..0.12).contains(&ahead), "{ahead}");
    let look = built[0].lookup([2.0 * DOMAIN.1, 1.0]);
    assert!(look.clamped, "beyond the domain is said to be clamped");
}

#[test]
fn per_byte_the_table_is_worth_more_than_the_simpler_one() {
    // Sun et al. 2005 tabulate F(u, v) = int_0^v exp(-u tan x) dx, 64² texels, for isotropic light: the
    // airlight is exp(-along)/height * (F(height, high) - F(height, low)) / 2π.
    let f = |u: f64, v: f64| {
        let rule = common::quadrature::gauss_legendre(64);
        rule.iter().map(|&(x, w)| 0.5 * w * v * (-u * (0.5 * v * (x + 1.0)).tan()).exp()).sum::<f64>()
    };
    let axes =
        [Axis::Linear { low: 0.0, high: 10.0 }, Axis::Linear { low: 0.0, high: std::f64::consts::FRAC_PI_2 }];
    let sun = Table2::build(axes, [64, 64], f);
    let paper = build_tables(Lobe::Isotropic, 1024, 512);
    let same_bytes = build_tables(Lobe::Isotropic, 90, 45);
    let two_part = |tables: &[Table2; 2], [along, height, distance]: [f64; 3]| {
        let [ahead, behind] = [0, 1].map(|i| move |t: f64| tables[i].lookup([t.abs(), height]).value);
        let sum = if along < 0.0 {
            (-along).exp() * (behind(distance - along) - behind(along))
        } else if distance < along {
            ahead(along) - (-distance).exp() * ahead(distance - along)
        } else {
            ahead(along) + (-along).exp() * behind(distance - along)
        };
        sum / height
    };
    let one_part = |[along, height, distance]: [f64; 3]| {
        let v = |x: f64| 0.25 * std::f64::consts::PI + 0.5 * ((x - along) / height).atan();
        let difference = sun.lookup([height, v(distance)]).value - sun.lookup([height, v(0.0)]).value;
        (-along).exp() * 2.0 * difference / (4.0 * std::f64::consts::PI) / height
    };
    let errors = |value: &dyn Fn([f64; 3]) -> f64| {
        let mut errors: Vec<f64> = rays()
            .into_iter()
            .map(|ray| {
                let [along, height, distance] = ray;
                let phase = Phase::isotropic();
                let exact =
                    airlight_point(DVec3::ONE, DVec3::ONE, &phase, along, height, 0.0, distance, 1e-10).x;
                (value(ray) / exact - 1.0).abs()
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        [0.5, 0.9].map(|fraction| quantile(&errors, fraction))
    };
    let [sun, paper, small] =
        [errors(&one_part), errors(&|ray| two_part(&paper, ray)), errors(&|ray| two_part(&same_bytes, ray))];
    println!("median and 90 %: 64² of F, 16 KiB {sun:?}; 90×45, 16 KiB {small:?}; 1024×512, 2 MiB {paper:?}");
    assert!(paper[0] < 0.1 * sun[0], "{paper:?} {sun:?}");
}
