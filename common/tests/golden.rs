//! The airlight integral against values of 20 digits, computed by two independent methods in
//! high-precision arithmetic (`golden/`; each file states its convention).

use std::path::Path;

use common::airlight::{LightFromRay, airlight_point};
use common::{Lobe, Phase};
use glam::DVec3;
use serde_json::Value;

/// Relative error that every value has to keep to.
const BOUND: f64 = 1e-10;
/// Relative tolerance that the integrals are asked for.
const TOLERANCE: f64 = 1e-11;

struct Case {
    tag: String,
    light: DVec3,
    origin: DVec3,
    direction: DVec3,
    t: f64,
    h: f64,
    sigma_t: f64,
    albedo: f64,
    end: f64,
    lobe: Lobe,
    radiance: f64,
}

/// A number, written as one or in a string; `"inf"` too.
fn number(value: &Value) -> f64 {
    let text = || value.as_str().and_then(|text| text.parse().ok());
    value.as_f64().or_else(text).unwrap_or_else(|| panic!("{value} is no number"))
}

fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

fn cases(file: &str) -> Vec<Case> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(file);
    let json: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
    let cases = json["cases"].as_array().unwrap();
    assert_eq!(json["count"], cases.len());
    cases
        .iter()
        .map(|case| Case {
            tag: case["tag"].as_str().unwrap().into(),
            light: vector(&case["light"]),
            origin: vector(&case["origin"]),
            direction: vector(&case["dir"]).normalize(),
            t: number(&case["t"]),
            h: number(&case["h"]),
            sigma_t: number(&case["k_t"]),
            albedo: number(&case["albedo"]),
            end: number(&case["d"]),
            lobe: match case["phase"].as_str() {
                None => Lobe::Isotropic,
                Some("hg") => Lobe::HenyeyGreenstein { g: number(&case["g"]) },
                Some("cs") => Lobe::CornetteShanks { g: number(&case["g"]) },
                Some(other) => panic!("{other} is no phase function of the file"),
            },
            radiance: number(&case["L_str"]),
        })
        .collect()
}

fn airlight(case: &Case, t: f64, h: f64, lobe: Lobe) -> f64 {
    let sigma_t = DVec3::splat(case.sigma_t);
    let phase = Phase::from(lobe);
    airlight_point(sigma_t, case.albedo * sigma_t, &phase, t, h, 0.0, case.end, TOLERANCE).x
}

/// Worst relative error from the vectors and from the stored `t` and `h`, and the number of cases.
fn worst(cases: &[Case]) -> f64 {
    let mut worst: f64 = 0.0;
    for case in cases {
        let geometry = LightFromRay::new(case.origin, case.direction, case.light);
        for (way, t, h) in [("vectors", geometry.t, geometry.h), ("t and h", case.t, case.h)] {
            let found = airlight(case, t, h, case.lobe);
            let error = (found / case.radiance - 1.0).abs();
            assert!(error < BOUND, "{} from {way}: {found}, not {}: {error:e}", case.tag, case.radiance);
            worst = worst.max(error);
        }
    }
    worst
}

/// Every case can be had from its vectors, those whose light is 1e-6 m beside the ray too: there
/// the ray lies on an axis, so that the cross product keeps every digit of `h`.
#[test]
fn isotropic() {
    let cases = cases("airlight_isotropic.json");
    assert_eq!(cases.len(), 100);
    assert_eq!(cases.iter().filter(|case| case.tag.starts_with("near_ray")).count(), 3);
    assert_eq!(cases.iter().filter(|case| case.h == 0.0).count(), 6);
    println!("worst relative error {:e}", worst(&cases));
}

#[test]
fn henyey_greenstein_and_cornette_shanks() {
    let cases = cases("airlight_hg.json");
    assert_eq!(cases.len(), 432);
    let cornette_shanks =
        cases.iter().filter(|case| matches!(case.lobe, Lobe::CornetteShanks { .. })).count();
    assert!(cornette_shanks > 150 && cornette_shanks < 282, "{cornette_shanks}");
    assert_eq!(cases.iter().filter(|case| case.tag.starts_with("near_ray")).count(), 52);
    println!("worst relative error {:e}", worst(&cases));
}

/// These tests can fail: with the phase function the wrong way round almost every case does.
#[test]
fn a_phase_function_of_the_wrong_sign_is_found_out() {
    let cases = cases("airlight_hg.json");
    let wrong = |case: &&Case| {
        let turned = match case.lobe {
            Lobe::HenyeyGreenstein { g } => Lobe::HenyeyGreenstein { g: -g },
            Lobe::CornetteShanks { g } => Lobe::CornetteShanks { g: -g },
            other => other,
        };
        (airlight(case, case.t, case.h, turned) / case.radiance - 1.0).abs() > 0.01
    };
    let found_out = cases.iter().filter(wrong).count();
    // A ray that passes its light symmetrically sees both signs alike.
    assert!(found_out > 380, "{found_out} of {}", cases.len());
}
