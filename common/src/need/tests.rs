use glam::Vec3;

use super::*;
use crate::scene::builtin;
use crate::{Light, Lobe, Medium, Phase, PointLight};

fn settings() -> Settings {
    Settings { width: 40, seconds: 0.5, ..Settings::default() }
}

fn need(scene: &Scene) -> Need {
    estimate(scene, &settings()).unwrap()
}

/// A lamp in fog in front of a pillar.
fn two_lights(second: f32) -> Scene {
    let mut scene = builtin::knife_edge();
    let Light::Point(lamp) = scene.lights[0].clone() else { panic!("a lamp") };
    scene.lights.push(Light::Point(PointLight {
        position: lamp.position + Vec3::new(-0.5, 0.3, -1.0),
        intensity: second * lamp.intensity,
    }));
    scene
}

#[test]
fn a_dim_light_is_left_out_and_a_bright_one_is_not() {
    let need = need(&two_lights(1e-3));
    let model = need.model(0.01);
    assert_eq!(model.lights, [Shaft::Shadowed, Shaft::Off], "{need:?}");
    let share = need.lights[1].airlight.share.value;
    assert!(share > 1e-4 && share < 5e-3, "{share}");
    // One light's error is its own; all lights off leave nothing.
    assert!((need.error_of(&model) - need.lights[1].airlight.error.value).abs() < 1e-9);
    let dark = Model { lights: vec![Shaft::Off; 2], ..Model::default() };
    assert!(need.error_of(&dark) >= 1.0, "{}", need.error_of(&dark));
    assert_eq!(need.error_of(&Model::default()), 0.0);
    // Of equal ones neither is.
    assert_eq!(self::need(&two_lights(1.0)).model(0.01).lights, [Shaft::Shadowed; 2]);
}

#[test]
fn nothing_throws_a_shadow_in_an_empty_scene() {
    let need = need(&builtin::empty());
    assert_eq!(need.lights[0].shadows.error.value, 0.0);
    assert_eq!(need.model(0.01).lights, [Shaft::Unshadowed]);
    assert!((need.lights[0].airlight.share.value - 1.0).abs() < 1e-12);
    assert_eq!(need.terms.surface, Part::default());
}

#[test]
fn media_are_simplified_as_far_as_they_nearly_are_simple() {
    let mut scene = builtin::knife_edge();
    let medium = |tint: f32, phase: Phase| Medium {
        sigma_s: 0.1 * Vec3::new(1.0, 1.0 + tint, 1.0 - tint),
        sigma_a: Vec3::splat(0.01),
        phase,
    };
    // As simple as it can be.
    assert_eq!(need(&scene).medium, MediumParts::default());
    scene.medium = medium(1e-4, Lobe::HenyeyGreenstein { g: 1e-3 }.into());
    let almost = need(&scene).model(0.05);
    assert!(almost.grey && almost.phase == PhaseModel::Isotropic, "{almost:?}");
    scene.medium = medium(0.5, Lobe::HenyeyGreenstein { g: 0.8 }.into());
    let far = need(&scene);
    let model = far.model(0.05);
    assert!(!model.grey && model.phase == PhaseModel::Own, "{model:?}");
    assert_eq!(far.medium.henyey_greenstein, Estimate::default());
    assert!(far.medium.grey.value > 0.1 && far.medium.isotropic.value > 0.3, "{far:?}");
}

#[test]
fn thin_fog_is_single_scattering_and_milk_is_not() {
    let mut scene = builtin::open_room();
    // The sun would find endless fog however thin it is.
    scene.lights.retain(|light| light.kind() == "point");
    scene.medium = Medium::grey(1e-4, 0.5, Phase::isotropic());
    let thin = need(&scene);
    assert!(thin.single_scattering_is_enough(0.02), "{thin:?}");
    assert!(thin.terms.airlight.may_be_left_out(0.02), "{thin:?}");
    scene.medium = Medium::grey(2.0, 0.999, Phase::isotropic());
    let milk = need(&scene);
    assert!(!milk.single_scattering_is_enough(0.02));
    assert!(milk.terms.multiple.share.value > 0.3, "{:?}", milk.terms);
    assert!(
        milk.single_scattering_sentence(0.02).contains("like milk"),
        "{}",
        milk.single_scattering_sentence(0.02)
    );
    assert!(thin.single_scattering_sentence(0.02).starts_with("Single scattering is enough"));
}

#[test]
fn terms_are_shares_of_the_whole() {
    let need = need(&two_lights(1.0));
    let TermParts { surface, airlight, indirect_airlight, multiple } = need.terms;
    let sum: f64 = [surface, airlight, indirect_airlight, multiple].iter().map(|part| part.share.value).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
    assert!(airlight.share.value > 0.1 && airlight.error.uncertainty < 0.2 * airlight.error.value);
    assert_eq!(need.sentences(0.01).len(), 4 + 2 + 2);
}

#[test]
fn an_estimate_is_read_back_as_written() {
    let need = need(&builtin::empty());
    let text = serde_json::to_string(&need).unwrap();
    assert_eq!(serde_json::from_str::<Need>(&text).unwrap(), need);
}

#[test]
fn a_cloud_is_all_paths() {
    let need = need(&builtin::sphere());
    assert!(need.cloud && need.paths > 0);
    assert_eq!(need.model(0.01).lights, vec![Shaft::Shadowed; need.lights.len()]);
    assert!(!need.single_scattering_is_enough(0.1), "{need:?}");
}

#[test]
fn too_small_a_picture_is_refused() {
    let error = estimate(&builtin::empty(), &Settings { width: 2, ..settings() }).unwrap_err();
    assert!(error.to_string().contains("at least 8"), "{error}");
}
