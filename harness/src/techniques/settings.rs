//! A technique's settings as a file: what `harness choose` writes and `harness render --settings` reads.

use std::path::Path;

use common::need::Model;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{Method, find_one};
use crate::failure::Failure;

/// A settings file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    deny_unknown_fields,
    expecting = "an object with `technique`, `options`, `shadow_map_size` and `model`"
)]
pub(crate) struct Settings {
    /// As `harness list` spells it.
    pub technique: String,
    /// The technique's options, as its crate reads them; what is not named is the default.
    #[serde(default)]
    pub options: Value,
    /// Texels on a side of each shadow map; none for the adapter's usual.
    #[serde(default)]
    pub shadow_map_size: Option<u32>,
    /// How much of the scene's fog is drawn.
    #[serde(default)]
    pub model: Model,
}

/// Reads a settings file: the method and its model.
pub(crate) fn read(path: &Path) -> Result<(Method, Model), Failure> {
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
    let text = std::fs::read(path).map_err(|error| wrong(format!("can't be read: {error}")))?;
    parse(&text).map_err(wrong)
}

/// Reads a text, with the place of what is wrong.
fn parse(text: &[u8]) -> Result<(Method, Model), String> {
    let mut text = serde_json::Deserializer::from_slice(text);
    let settings: Settings = placed(&mut text, "")?;
    text.end().map_err(|error| format!("after the settings: {error}"))?;
    if let Some(side) = settings.shadow_map_size.filter(|side| !(2..=16_384).contains(side)) {
        return Err(format!("shadow_map_size: {side}; expected 2 to 16384 texels"));
    }
    Ok((settings.method()?, settings.model))
}

/// A value as a file has it.
pub(crate) fn written(options: &impl Serialize) -> Value {
    // By way of a text, in which an f32 is as short as it can be.
    let text = serde_json::to_string(options);
    text.and_then(|text| serde_json::from_str(&text)).unwrap_or_default()
}

/// The `usual` options with those that a file names in their place.
pub(super) fn merged<T: Serialize + DeserializeOwned>(usual: &T, options: &Value) -> Result<T, String> {
    let whole = match (written(usual), options) {
        (Value::Object(mut whole), Value::Object(own)) => {
            whole.extend(own.clone());
            whole.into()
        }
        (usual, Value::Null) => usual,
        (_, own) => own.clone(),
    };
    placed(whole, "options")
}

/// Reads a value; `within` is where it stands.
fn placed<'de, T: DeserializeOwned>(
    value: impl serde::Deserializer<'de, Error = serde_json::Error>,
    within: &str,
) -> Result<T, String> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let path = error.path().to_string();
        let place = [within, &path].into_iter().filter(|part| !part.is_empty() && *part != ".");
        let place = place.collect::<Vec<_>>().join(".");
        if place.is_empty() { error.inner().to_string() } else { format!("{place}: {}", error.inner()) }
    })
}

impl Settings {
    /// Those of a method.
    pub(crate) fn of(method: &Method, model: &Model) -> Self {
        Self {
            technique: method.technique.into(),
            options: method.recipe.options(),
            shadow_map_size: method.shadow_map_size,
            model: model.clone(),
        }
    }

    /// The method that has them.
    pub(crate) fn method(&self) -> Result<Method, String> {
        let usual = find_one(&self.technique).map_err(|error| format!("technique: {error}"))?;
        if usual.technique != self.technique {
            return Err(format!(
                "technique: `{}` is one setting; expected `{}` and its options",
                self.technique, usual.technique
            ));
        }
        let method = Method {
            name: self.technique.clone(),
            label: "settings from a file".into(),
            preset: "sweep",
            bound: None,
            recipe: usual.recipe.with(&self.options)?,
            ..usual
        };
        Ok(match self.shadow_map_size {
            Some(side) => method.with_shadow_map(side),
            None => method,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::techniques::{all, find, improvements};
    use common::need::{PhaseModel, Shaft};

    #[test]
    fn every_method_is_read_back_as_written() {
        let model = Model {
            lights: vec![Shaft::Unshadowed, Shaft::Off],
            grey: true,
            phase: PhaseModel::HenyeyGreenstein,
        };
        let more = ["chen-planes-32x8@2048", "lit-intervals@512", "froxels-4x256x2", "szk-network-512x64"];
        let more = more.iter().flat_map(|name| find(name).unwrap());
        for method in all().into_iter().chain(improvements()).chain(more) {
            let text = serde_json::to_string_pretty(&Settings::of(&method, &model)).unwrap();
            let (read, again) = parse(text.as_bytes()).unwrap_or_else(|error| panic!("{error}: {text}"));
            assert_eq!((read.settings(), &again), (method.settings(), &model), "{text}");
            assert_eq!(read.shadow_map_size, method.shadow_map_size);
            assert_eq!(read.technique, method.technique);
        }
    }

    #[test]
    fn what_is_not_named_is_the_default() {
        let options = |text: &str| parse(text.as_bytes()).unwrap().0.settings();
        for name in
            ["billeter-plv", "lit-intervals", "biri-ss", "chen-planes", "szk-network", "ray-march", "froxels"]
        {
            let (read, model) = parse(format!(r#"{{"technique": "{name}"}}"#).as_bytes()).unwrap();
            assert_eq!(read.settings(), find_one(name).unwrap().settings(), "{name}");
            assert!(model.is_full() && read.shadow_map_size.is_none());
        }
        let nine = options(r#"{"technique": "chen-planes", "options": {"planes": 9}}"#);
        let mut usual = find_one("chen-planes").unwrap().settings();
        usual.insert("planes".into(), 9.into());
        assert_eq!(nine, usual);
    }

    #[test]
    fn a_bad_field_is_named_with_its_place() {
        for (text, wanted) in [
            (r#"{"technique": "fog"}"#, "technique: there is no technique `fog`"),
            (r#"{"technique": "ray-march-64"}"#, "expected `ray-march` and its options"),
            (r#"{"technique": "unshadowed", "options": {"steps": 3}}"#, "unknown field `steps`"),
            (
                r#"{"technique": "ray-march", "options": {"steps": 0}}"#,
                "options.steps: 0; expected 1 to 4096",
            ),
            (r#"{"technique": "biri-ss", "options": {"culling": true}}"#, "unknown field `culling`"),
            (
                r#"{"technique": "biri-ss", "options": {"order": "any"}}"#,
                "options.order: unknown variant `any`",
            ),
            (
                r#"{"technique": "biri-ss", "model": {"lights": ["on"]}}"#,
                "model.lights[0]: unknown variant `on`",
            ),
            (r#"{"technique": "biri-ss", "shadow_map_size": 1}"#, "shadow_map_size: 1; expected 2 to 16384"),
            (r#"{"technique": "biri-ss""#, "EOF"),
            (r#"{"technique": "biri-ss"} x"#, "after the settings"),
            (r#"{"technique": "lit-intervals", "options": 3}"#, "options: invalid type"),
        ] {
            let error = parse(text.as_bytes()).map(|(method, _)| method.name).unwrap_err();
            assert!(error.contains(wanted) && !error.contains('\n'), "{text}: {error}");
        }
        let missing = read(Path::new("no/such.json")).unwrap_err();
        assert_eq!(missing.exit_code(), 2);
        assert!(missing.to_string().starts_with("no/such.json: can't be read"), "{missing}");
    }
}
