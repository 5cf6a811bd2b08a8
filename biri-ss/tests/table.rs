//! The tables: golden values, direct quadrature, and how long they take.

use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

use biri_ss::table::*;
use common::Lobe;
use serde_json::Value;

fn fixture(name: &str) -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str()?.parse().ok()).unwrap()
}

#[test]
fn gamma_has_its_golden_values() {
    let golden = fixture("gamma_table.json");
    let lambdas: Vec<f64> = golden["lambda_"].as_array().unwrap().iter().map(number).collect();
    let rows = golden["table"].as_array().unwrap();
    let mut checked = 0;
    for (lambda, row) in lambdas.iter().zip(rows) {
        for (i, value) in row.as_array().unwrap().iter().enumerate() {
            let (angle, exact) = (PI * (i as f64 / 19.0 - 0.5), number(value));
            let angle = angle.clamp(-FRAC_PI_2, FRAC_PI_2);
            let found = gamma(Lobe::Isotropic, *lambda, angle);
            assert!(
                (found - exact).abs() < 2e-9 * exact.abs().max(1e-3),
                "{lambda} {angle}: {found}, {exact}"
            );
            checked += 1;
        }
    }
    assert_eq!(checked, 400);
}

#[test]
fn indirect_light_has_its_golden_values() {
    for case in fixture("iss_lambert.json")["cases"].as_array().unwrap() {
        let (lambda, cos) = (number(&case["lam"]), number(&case["phi_n_deg"]).to_radians().cos());
        for (clamped, name) in [(true, "exact"), (false, "unclamped")] {
            let found = (-lambda).exp() * lambert(Lobe::Isotropic, lambda, cos, clamped);
            let exact = number(&case[name]);
            let scale = number(&case["exact"]);
            assert!((found - exact).abs() < 1e-7 * scale, "{lambda} {cos} {name}: {found}, {exact}");
        }
    }
    for case in fixture("iss_phong.json")["cases"].as_array().unwrap() {
        let (lambda, n) = (number(&case["lam"]), number(&case["n"]) as u32);
        let phi_s = number(&case["phi_s_deg"]).to_radians();
        for (clamped, name) in [(true, "exact"), (false, "unclamped")] {
            let found = (-lambda).exp() * phong(Lobe::Isotropic, lambda, phi_s, n, clamped);
            let (exact, scale) = (number(&case[name]), number(&case["exact"]));
            let off = (found - exact).abs();
            assert!(off < 2e-6 * scale.max(exact.abs()), "{lambda} {n} {phi_s} {name}: {found}, {exact}");
        }
    }
}

#[test]
fn the_built_tables_hold_their_functions() {
    for lobe in [Lobe::Isotropic, Lobe::MieHazy, Lobe::HenyeyGreenstein { g: 0.7 }] {
        let (rest, printed) =
            (build_airlight(lobe, [256, 512], true), build_airlight(lobe, [256, 512], false));
        let (mut off, mut off_printed) = (0.0_f64, 0.0_f64);
        for i in 0..400 {
            let lambda = 1e-3 * 2e4_f64.powf(f64::from(i * 37 % 400) / 400.0);
            let angle = -1.5 + 3.0 * f64::from(i) / 400.0;
            let exact = gamma_rest(lobe, lambda, angle);
            off = off.max((rest.lookup([lambda, (0.5 * angle).tan()]).value / exact - 1.0).abs());
            let exact = gamma(lobe, lambda, angle);
            off_printed = off_printed.max((printed.lookup([lambda, angle]).value - exact).abs());
        }
        println!("{lobe:?}: rest {off:.1e}, Γ {off_printed:.1e} absolute");
        assert!(off < 2e-3 && off_printed < 6e-4, "{lobe:?}: {off} {off_printed}");
        // The measure can fail: a table of another phase function.
        let wrong = build_airlight(Lobe::HenyeyGreenstein { g: -0.7 }, [256, 512], true);
        assert!((wrong.lookup([0.3, 0.1_f64.tan()]).value / gamma_rest(lobe, 0.3, 0.2) - 1.0).abs() > 0.1);

        let ([point, directional], lobes) = (build_lambert(lobe, true), build_phong(lobe, true));
        for (lambda, cos) in [(1e-3, 0.9), (0.07, 0.0), (0.6, -0.4), (3.0, 0.5), (20.0, 1.0)] {
            let (found, exact) = (point.lookup([lambda, cos]).value, lambert(lobe, lambda, cos, true));
            assert!((found / exact - 1.0).abs() < 6e-3, "{lobe:?} {lambda} {cos}: {found}, {exact}");
            for n in [1, 10, 50, 300] {
                let layer = phong_layer(f64::from(n));
                let at = |k: f64| lobes[k as usize].lookup([lambda, cos.acos()]).value;
                let found = at(layer.floor()) + layer.fract() * (at(layer.ceil()) - at(layer.floor()));
                let exact = f64::from(n + 1) * phong(lobe, lambda, cos.acos(), n, true);
                // Twenty optical depths away next to nothing arrives, and what does from the light's own direction.
                let bound = if lambda > 10.0 { 0.03 } else { 2e-2 };
                assert!((found / exact - 1.0).abs() < bound, "{lobe:?} {lambda} {cos} {n}: {found}, {exact}");
            }
        }
        // A directional light: the phase function itself, weighted by the cosine. Seen from the light's side
        // it is half the sphere or more.
        let half: f64 = (0..20_000)
            .map(|i| (f64::from(i) + 0.5) / 20_000.0)
            .map(|c| 2.0 * PI * c * 4.0 * PI * lobe.eval(c) / 20_000.0)
            .sum();
        let found = directional.lookup([1.0, 1.0]).value;
        assert!((found / half - 1.0).abs() < 1e-4, "{lobe:?}: {found}, {half}");
    }
    // Isotropic: a surface gets a quarter of irradiance · albedo whichever way it faces.
    let [_, directional] = build_lambert(Lobe::Isotropic, true);
    for cos in [-1.0, 0.0, 0.7] {
        assert!((directional.lookup([1.0, cos]).value / (4.0 * PI) - 0.25).abs() < 1e-4);
    }
}

#[test]
fn layers_of_exponents_are_where_the_shader_looks_for_them() {
    for (layer, &n) in EXPONENTS.iter().enumerate() {
        assert!((phong_layer(f64::from(n)) - layer as f64).abs() < 1e-12, "{n}");
    }
    let exponents =
        [0.0, 0.4, 1.0, 1.7, 2.0, 2.5, 3.0, 5.0, 8.0, 9.0, 12.0, 37.0, 100.0, 777.0, 1024.0, 5000.0];
    let inputs: Vec<glam::Vec4> = exponents.iter().map(|&n| glam::Vec4::splat(n)).collect();
    let source = biri_ss::shaders::surfaces();
    let start = source.find("fn phong_layer").unwrap();
    let function = &source[start..start + source[start..].find("\n}\n").unwrap() + 3];
    let context = common::gpu::bench::context();
    let found =
        common::gpu::bench::eval_wgsl(context, &[function], &[], "", "vec4f(phong_layer(x.x))", &inputs);
    for (found, n) in found.iter().zip(exponents) {
        let exact = phong_layer(f64::from(n));
        assert!((f64::from(found.x) - exact).abs() < 1e-4, "{n}: {}, {exact}", found.x);
    }
}
