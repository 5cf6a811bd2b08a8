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
