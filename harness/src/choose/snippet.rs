//! Settings as Rust: a function that makes just these options.

use std::fmt::Write;

use common::need::{Model, PhaseModel, Shaft};
use serde_json::Value;

use crate::failure::Failure;
use crate::techniques::settings::Settings;

/// Fields of options whose values are variants, and of which type.
const TYPES: [(&str, &str); 19] = [
    ("volume", "Volume"),
    ("evaluation", "Evaluation"),
    ("tessellation", "Tessellation"),
    ("accumulation", "common::gpu::Accumulation"),
    ("format", "common::gpu::TableFormat"),
    ("airlight", "Airlight"),
    ("order", "Order"),
    ("counting", "Counting"),
    ("indirect", "Indirect"),
    ("placement", "Placement"),
    ("factor", "Factor"),
    ("visibility", "Visibility"),
    ("direction_set", "DirectionSet"),
    ("opacity", "Opacity"),
    ("quadrature", "Quadrature"),
    ("scattering", "Scattering"),
    ("incidence", "Incidence"),
    ("colours", "Colours"),
    ("sampling", "Sampling"),
];

/// Rust that makes the options of `settings`, the particles of a cloud and the model.
pub(super) fn of(settings: &Settings) -> Result<String, Failure> {
    let name = match settings.technique.as_str() {
        "billeter-plv" | "lit-intervals" => "billeter_plv",
        "biri-ss" => "biri_ss",
        "chen-planes" => "chen_planes",
        "szk-network" => "szk_network",
        peer => return Ok(of_peer(peer, settings)),
    };
    let mut text = String::new();
    let mut options = &settings.options;
    if name == "szk_network" {
        let sampling = value("sampling", &options["sampling"]);
        let _ = writeln!(
            text,
            "/// The cloud as particles.\npub fn particles(cloud: &common::Cloud) -> Result<szk_network::Particles, \
             szk_network::Error> {{\n    use szk_network::*;\n    Particles::sample(cloud, {}, {sampling})\n}}\n",
            options["particles"]
        );
        options = &options["options"];
    }
    let Value::Object(fields) = options else {
        return Err(Failure::Run(format!("{name}: its options are no object")));
    };
    let _ = writeln!(
        text,
        "/// Options of `{name}::Renderer` for targets of a format.\npub fn options(target_format: wgpu::TextureFormat) -> \
         {name}::Options {{\n    use {name}::*;\n    Options {{\n        target_format,"
    );
    for (field, own) in fields {
        let _ = writeln!(text, "        {field}: {},", value(field, own));
    }
    text += "    }\n}\n";
    Ok(text + &of_model(settings))
}

/// Peers are part of this program: what they are made of is said in words.
fn of_peer(peer: &str, settings: &Settings) -> String {
    let side = settings
        .shadow_map_size
        .map_or_else(String::new, |side| format!(" on shadow maps of {side}² texels"));
    format!(
        "// {peer}{side}: {}. It is no technique's crate; its shaders are in harness/src/peers.\n{}",
        settings.options,
        of_model(settings)
    )
}

fn of_model(settings: &Settings) -> String {
    let Model { lights, grey, phase } = &settings.model;
    let shaft = |shaft: &Shaft| match shaft {
        Shaft::Off => "Shaft::Off",
        Shaft::Unshadowed => "Shaft::Unshadowed",
        Shaft::Shadowed => "Shaft::Shadowed",
    };
    let phase = match phase {
        PhaseModel::Own => "PhaseModel::Own",
        PhaseModel::HenyeyGreenstein => "PhaseModel::HenyeyGreenstein",
        PhaseModel::Isotropic => "PhaseModel::Isotropic",
    };
    let lights = lights.iter().map(shaft).collect::<Vec<_>>().join(", ");
    format!(
        "\n/// How much of the scene's fog is drawn: which lights are handed to the renderer, and in which medium.\npub fn \
         model() -> common::need::Model {{\n    use common::need::*;\n    Model {{ lights: vec![{lights}], grey: {grey}, \
         phase: {phase} }}\n}}\n"
    )
}

/// A field's value in Rust.
fn value(field: &str, own: &Value) -> String {
    let of = TYPES.iter().find(|(name, _)| *name == field).map(|(_, of)| *of);
    match (own, of) {
        (Value::String(variant), Some(of)) => format!("{of}::{}", camel(variant)),
        (Value::Object(variant), Some(of)) => {
            let Some((variant, Value::Object(fields))) = variant.iter().next() else {
                return own.to_string();
            };
            let fields: Vec<String> =
                fields.iter().map(|(field, own)| format!("{field}: {}", value(field, own))).collect();
            format!("{of}::{} {{ {} }}", camel(variant), fields.join(", "))
        }
        (Value::Null, _) => "None".into(),
        (Value::Number(number), _) if field == "window" => format!("Some({number})"),
        (Value::Array(values), _) => {
            format!("[{}]", values.iter().map(Value::to_string).collect::<Vec<_>>().join(", "))
        }
        _ => own.to_string(),
    }
}

/// `gamma_rest` as `GammaRest`.
fn camel(name: &str) -> String {
    let word = |word: &str| {
        let mut letters = word.chars();
        letters
            .next()
            .map_or_else(String::new, |first| first.to_ascii_uppercase().to_string() + letters.as_str())
    };
    name.split('_').map(word).collect()
}

#[cfg(test)]
mod tests;
