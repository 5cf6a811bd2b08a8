//! What can be set of a technique: every field of its options as a slider, a switch or a choice.
//!
//! Settings are edited as the JSON that a settings file holds, so the window knows nothing of a technique but this
//! table; the tests hold it to the options themselves.

use eframe::egui::{ComboBox, Slider, Ui};
use serde_json::Value;

/// One thing that can be set.
pub(super) struct Knob {
    /// Where it is in the options: a JSON pointer. What is not there has no widget.
    pub at: &'static str,
    /// What the user reads, and behind it the unit.
    pub label: &'static str,
    pub unit: &'static str,
    pub kind: Kind,
}

/// How it is set.
pub(super) enum Kind {
    /// A whole number in a range.
    Whole(u32, u32),
    /// A number in a range, on a logarithmic scale; a range from 0 has 0 too.
    Real(f64, f64),
    Switch,
    /// One of several values: what the user reads, and JSON. Those with fields of their own are told apart by the first key.
    Choice(&'static [(&'static str, &'static str)]),
}

use Kind::{Choice, Real, Switch, Whole};

const fn knob(at: &'static str, label: &'static str, unit: &'static str, kind: Kind) -> Knob {
    Knob { at, label, unit, kind }
}

const BITS: Kind = Choice(&[("16 bits", r#""f16""#), ("32 bits", r#""f32""#)]);
const TABLE: Kind = Whole(4, 2048);
const PANELS: Kind = Whole(1, 16);
const SEED: Kind = Whole(0, 999);

const BILLETER: &[Knob] = &[
    knob("/volume", "volume", "", Choice(&[("mesh", r#""mesh""#), ("rays", r#""rays""#)])),
    knob(
        "/evaluation",
        "airlight by",
        "",
        Choice(&[
            ("quadrature", r#"{"quadrature":{"panels":1}}"#),
            ("table", r#"{"table":{"width":1024,"height":512,"format":"f32"}}"#),
        ]),
    ),
    knob("/evaluation/quadrature/panels", "panels", "pieces of 12 nodes", PANELS),
    knob("/evaluation/table/width", "table width", "texels", TABLE),
    knob("/evaluation/table/height", "table height", "texels", TABLE),
    knob("/evaluation/table/format", "table in", "", BITS),
    knob(
        "/tessellation",
        "tessellation",
        "",
        Choice(&[("full", r#""full""#), ("adaptive", r#"{"adaptive":{"tolerance":0.0005}}"#)]),
    ),
    knob("/tessellation/adaptive/tolerance", "tolerance", "of the distance", Real(1e-5, 0.5)),
    knob("/upright_walls", "upright walls", "", Switch),
    knob("/accumulation", "sum in", "", BITS),
    knob("/clamp_negative", "clamp below zero", "", Switch),
];

const BIRI: &[Knob] = &[
    knob(
        "/airlight",
        "airlight by",
        "",
        Choice(&[
            ("Γ − rest table", r#"{"gamma_rest":{"width":256,"height":512,"format":"f32"}}"#),
            ("Γ table", r#"{"gamma":{"width":256,"height":512,"format":"f32"}}"#),
            ("quadrature", r#"{"quadrature":{"panels":1}}"#),
        ]),
    ),
    knob("/airlight/gamma_rest/width", "table width", "texels", TABLE),
    knob("/airlight/gamma_rest/height", "table height", "texels", TABLE),
    knob("/airlight/gamma_rest/format", "table in", "", BITS),
    knob("/airlight/gamma/width", "table width", "texels", TABLE),
    knob("/airlight/gamma/height", "table height", "texels", TABLE),
    knob("/airlight/gamma/format", "table in", "", BITS),
    knob("/airlight/quadrature/panels", "panels", "pieces of 12 nodes", PANELS),
    knob("/order", "order", "", Choice(&[("exact", r#""exact""#), ("by angle", r#""angle""#)])),
    knob(
        "/counting",
        "counting",
        "",
        Choice(&[("from the eye", r#""from_eye""#), ("depth fail", r#""depth_fail""#)]),
    ),
    knob("/shared_beginning", "share the rays' beginning", "", Switch),
    knob("/accumulation", "sum in", "", BITS),
    knob(
        "/indirect",
        "indirect",
        "",
        Choice(&[("clamped", r#""clamped""#), ("unclamped", r#""unclamped""#)]),
    ),
    knob("/cull", "cull", "", Switch),
    knob("/faintest", "faintest plane", "of the light", Real(0.0, 0.1)),
    knob("/clamp_negative", "clamp below zero", "", Switch),
];

const CHEN: &[Knob] = &[
    knob("/planes", "planes", "", Whole(1, 512)),
    knob("/lattice/0", "lattice, across", "points", Whole(2, 128)),
    knob("/lattice/1", "lattice, down", "points", Whole(2, 128)),
    knob(
        "/placement",
        "placement",
        "",
        Choice(&[
            ("integrand", r#""integrand""#),
            ("transmittance", r#""transmittance""#),
            ("equi-angular", r#""equi_angular""#),
            ("even", r#""even""#),
        ]),
    ),
    knob(
        "/factor",
        "on a plane",
        "",
        Choice(&[
            ("integrated", r#""integrated""#),
            ("attenuation", r#""attenuation""#),
            ("whole", r#""whole""#),
        ]),
    ),
    knob(
        "/visibility",
        "visibility",
        "",
        Choice(&[
            ("per fragment", r#"{"per_fragment":{"samples":64}}"#),
            ("per lattice point", r#""per_lattice_point""#),
        ]),
    ),
    knob("/visibility/per_fragment/samples", "places", "per plane", Whole(1, 64)),
    knob("/offset", "offset per pixel", "", Switch),
    knob("/early_end", "end early", "", Switch),
    knob("/phase_texels", "phase table", "texels", Whole(16, 8192)),
    knob("/accumulation", "sum in", "", BITS),
];

const SZK: &[Knob] = &[
    knob("/particles", "particles", "", Whole(1, 16_384)),
    knob(
        "/sampling",
        "sampling",
        "",
        Choice(&[("even", r#""even""#), ("random", r#"{"random":{"seed":1}}"#)]),
    ),
    knob("/sampling/random/seed", "seed", "", SEED),
    knob("/options/directions", "directions", "", Whole(2, 512)),
    knob(
        "/options/direction_set",
        "spread",
        "",
        Choice(&[("Fibonacci", r#""fibonacci""#), ("random", r#"{"random":{"seed":1}}"#)]),
    ),
    knob("/options/direction_set/random/seed", "seed of directions", "", SEED),
    knob("/options/window", "window", "", Choice(&[("as wide as needed", "null"), ("64 pixels", "64")])),
    knob("/options/window", "window", "pixels", Whole(8, 1022)),
    knob("/options/turned", "turn each particle's directions", "", Switch),
    knob(
        "/options/opacity",
        "opacity of",
        "",
        Choice(&[("a particle", r#""particle""#), ("a link", r#""link""#)]),
    ),
    knob(
        "/options/quadrature",
        "phase function at",
        "",
        Choice(&[("cells", r#""cells""#), ("points", r#""points""#)]),
    ),
    knob("/options/conserving", "conserve energy", "", Switch),
    knob(
        "/options/scattering",
        "scattering",
        "",
        Choice(&[
            ("low rank", r#"{"low_rank":{"bound":0.03}}"#),
            ("tiled", r#""tiled""#),
            ("full", r#""full""#),
        ]),
    ),
    knob("/options/scattering/low_rank/bound", "its bound", "of the matrix", Real(0.0, 0.5)),
    knob(
        "/options/incidence",
        "light comes in",
        "",
        Choice(&[("exactly", r#""exact""#), ("by the nearest direction", r#""nearest""#)]),
    ),
    knob("/options/colours", "colours", "", Choice(&[("RGB", r#""rgb""#), ("grey", r#""grey""#)])),
    knob("/options/overlap", "overlap", "radii", Real(0.5, 8.0)),
    knob("/options/per_fragment", "per fragment", "", Switch),
    knob("/options/corrected", "correct the density", "", Switch),
    knob("/options/samples", "shadow rays", "per particle", Whole(1, 32)),
];

const MARCH: &[Knob] = &[knob("/steps", "steps", "", Whole(1, 4096))];

const FROXELS: &[Knob] = &[
    knob("/tile", "tile", "pixels", Whole(1, 64)),
    knob("/slices", "slices", "", Whole(1, 1024)),
    knob("/samples", "places", "per froxel", Whole(1, 64)),
];

/// All knobs of a technique, in the order in which they are shown.
pub(super) fn of(technique: &str) -> &'static [Knob] {
    match technique {
        "billeter-plv" | "lit-intervals" => BILLETER,
        "biri-ss" => BIRI,
        "chen-planes" => CHEN,
        "szk-network" => SZK,
        "froxels" => FROXELS,
        march if march.starts_with("ray-march") => MARCH,
        _ => &[],
    }
}

impl Knob {
    /// Whether these options have it, in this form.
    pub(super) fn fits(&self, options: &Value) -> bool {
        match (&self.kind, options.pointer(self.at)) {
            (_, None) => false,
            (Whole(..), Some(value)) => value.is_u64(),
            (Real(..), Some(value)) => value.is_number(),
            (Switch, Some(value)) => value.is_boolean(),
            (Choice(_), Some(_)) => true,
        }
    }

    /// Shows it for options that it fits, and turns it.
    pub(super) fn show(&self, ui: &mut Ui, options: &mut Value) {
        let Some(value) = options.pointer_mut(self.at) else { return };
        let text =
            if self.unit.is_empty() { self.label.into() } else { format!("{} [{}]", self.label, self.unit) };
        match &self.kind {
            Whole(least, most) => {
                let mut number = value.as_u64().unwrap_or_default();
                let range = u64::from(*least)..=u64::from(*most);
                let slider = Slider::new(&mut number, range).logarithmic(most / least.max(&1) > 32);
                ui.add(slider.text(text));
                *value = number.into();
            }
            Real(least, most) => {
                let mut number = value.as_f64().unwrap_or_default();
                let slider = Slider::new(&mut number, *least..=*most).logarithmic(true);
                let slider = slider.smallest_positive(if *least > 0.0 { *least } else { 1e-7 });
                // What is not turned keeps all its digits.
                if ui.add(slider.text(text)).changed() {
                    *value = number.into();
                }
            }
            Switch => {
                let mut on = value.as_bool().unwrap_or_default();
                ui.checkbox(&mut on, text);
                *value = on.into();
            }
            Choice(choices) => choose(ui, self.at, &text, choices, value),
        }
    }
}

/// A list to choose a value from.
fn choose(ui: &mut Ui, at: &str, text: &str, choices: &[(&str, &str)], value: &mut Value) {
    let parsed = |json: &str| serde_json::from_str::<Value>(json).unwrap_or_default();
    let current = choices.iter().find(|(_, json)| same_variant(&parsed(json), value));
    ComboBox::new(at, text).selected_text(current.map_or("?", |(label, _)| label)).show_ui(ui, |ui| {
        for (label, json) in choices {
            let chosen = current.is_some_and(|(current, _)| current == label);
            if ui.selectable_label(chosen, *label).clicked() && !chosen {
                *value = parsed(json);
            }
        }
    });
}

/// Whether two values are the same choice, whatever its own fields are.
pub(super) fn same_variant(a: &Value, b: &Value) -> bool {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => a.keys().next() == b.keys().next(),
        (Value::Number(_), Value::Number(_)) => true,
        _ => a == b,
    }
}

#[cfg(test)]
mod tests {
    use common::need::Model;

    use super::*;
    use crate::techniques::settings::Settings;
    use crate::techniques::{all, find, improvements};

    /// Pointers to all that is no object and no list.
    fn leaves(value: &Value, at: &str, found: &mut Vec<String>) {
        match value {
            Value::Object(fields) => {
                fields.iter().for_each(|(name, value)| leaves(value, &format!("{at}/{name}"), found));
            }
            Value::Array(items) => {
                items.iter().enumerate().for_each(|(i, value)| leaves(value, &format!("{at}/{i}"), found));
            }
            _ => found.push(at.into()),
        }
    }

    fn all_settings() -> Vec<Settings> {
        let more = ["froxels", "ray-march-equiangular-offset-9", "szk-network-512x64"];
        let more = more.iter().flat_map(|name| find(name).unwrap());
        let methods = all().into_iter().chain(improvements()).chain(more);
        methods.map(|method| Settings::of(&method, &Model::default())).collect()
    }

    #[test]
    fn every_setting_of_every_technique_has_a_knob() {
        for settings in all_settings() {
            let mut found = Vec::new();
            leaves(&settings.options, "", &mut found);
            for leaf in found {
                let has = of(&settings.technique).iter().any(|k| k.at == leaf && k.fits(&settings.options));
                assert!(has, "{}: {leaf} of {} has no knob", settings.technique, settings.options);
            }
        }
    }

    #[test]
    fn whatever_a_knob_is_turned_to_is_a_setting() {
        let mut turned = 0;
        for settings in all_settings() {
            for knob in of(&settings.technique).iter().filter(|knob| knob.fits(&settings.options)) {
                let values: Vec<Value> = match knob.kind {
                    Whole(least, most) => vec![least.into(), most.into()],
                    Real(least, most) => vec![least.into(), most.into()],
                    Switch => vec![true.into(), false.into()],
                    Choice(choices) => {
                        choices.iter().map(|(_, json)| serde_json::from_str(json).unwrap()).collect()
                    }
                };
                for value in values {
                    let mut settings = settings.clone();
                    *settings.options.pointer_mut(knob.at).unwrap() = value.clone();
                    let read = settings.method();
                    assert!(read.is_ok(), "{} {} {value}: {read:?}", settings.technique, knob.at);
                    turned += 1;
                }
            }
        }
        assert!(turned > 300, "{turned}");
    }

    #[test]
    fn choices_are_told_apart_and_one_of_them_is_the_current() {
        for settings in all_settings() {
            for knob in of(&settings.technique).iter().filter(|knob| knob.fits(&settings.options)) {
                let Choice(choices) = knob.kind else { continue };
                let value = settings.options.pointer(knob.at).unwrap();
                let json = |text: &str| serde_json::from_str::<Value>(text).unwrap();
                let same = choices.iter().filter(|(_, text)| same_variant(&json(text), value)).count();
                assert_eq!(same, 1, "{} {} {value}", settings.technique, knob.at);
            }
        }
    }
}
