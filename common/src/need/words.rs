//! What a scene needs, in plain words.

use super::{Estimate, Need, Part, PhaseModel, Shaft};

/// A share as a percentage of two digits.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent.abs() {
        p if p >= 10.0 => format!("{percent:.0} %"),
        p if p >= 1.0 => format!("{percent:.1} %"),
        p if p >= 0.1 => format!("{percent:.2} %"),
        p if p < 1e-4 => "0 %".into(),
        _ => format!("{percent:.3} %"),
    }
}

fn sure(Estimate { value, uncertainty }: Estimate) -> String {
    format!("{} ± {}", percent(value), percent(uncertainty))
}

fn told(name: &str, part: &Part, bound: f64) -> String {
    let verdict = if part.error.value == 0.0 && part.share.value == 0.0 {
        "there is none"
    } else if part.may_be_left_out(bound) {
        "may be left out"
    } else if part.error.value - 2.0 * part.error.uncertainty > bound {
        "is needed"
    } else {
        "too close to tell, so it is needed"
    };
    format!("{name}: {} of the light, error without it {}: {verdict}", sure(part.share), sure(part.error))
}

impl Need {
    /// One sentence each on terms, lights and medium, for an error of at most `bound`.
    pub fn sentences(&self, bound: f64) -> Vec<String> {
        let terms = &self.terms;
        let mut said = vec![
            told("surface", &terms.surface, bound),
            told("airlight", &terms.airlight, bound),
            told("indirect airlight", &terms.indirect_airlight, bound),
            told("multiple scattering", &terms.multiple, bound),
        ];
        let model = self.model(bound);
        for (index, light) in self.lights.iter().enumerate() {
            let verdict = match model.shaft(index) {
                Shaft::Off => "its airlight may be left out",
                Shaft::Unshadowed => "its shadows in the air may be left out",
                Shaft::Shadowed if self.cloud => "needed",
                Shaft::Shadowed => "needed with its shadows in the air",
            };
            let shadows = if self.cloud {
                String::new()
            } else {
                format!(", error without its shadows {}", sure(light.shadows.error))
            };
            said.push(format!(
                "light {index} ({}): {} of the airlight, error without it {}{shadows}: {verdict}",
                light.kind,
                sure(light.airlight.share),
                sure(light.airlight.error),
            ));
        }
        if !self.cloud && !self.lights.is_empty() {
            said.push(match self.medium.grey.value {
                0.0 => "medium: grey already, one transmittance is enough".into(),
                _ => format!(
                    "medium: error in grey {}: {}",
                    sure(self.medium.grey),
                    if model.grey { "one colour is enough" } else { "it needs its three colours" }
                ),
            });
            let simpler = match model.phase {
                PhaseModel::Isotropic => "isotropic is enough",
                PhaseModel::HenyeyGreenstein => "one Henyey-Greenstein lobe is enough",
                PhaseModel::Own => "it stays as it is",
            };
            said.push(format!(
                "phase function: error as one Henyey-Greenstein lobe {}, as isotropic {}: {simpler}",
                sure(self.medium.henyey_greenstein),
                sure(self.medium.isotropic)
            ));
        }
        said
    }

    /// Whether single scattering is enough for an error of `bound`, and what it misses.
    pub fn single_scattering_sentence(&self, bound: f64) -> String {
        let multiple = &self.terms.multiple;
        let single = self.terms.airlight.share.value;
        if self.single_scattering_is_enough(bound) {
            return format!(
                "Single scattering is enough: without the light that is scattered more than once the picture is off by {}.",
                sure(multiple.error)
            );
        }
        let of_fog = multiple.share.value / (multiple.share.value + single).max(f64::MIN_POSITIVE);
        let what = if self.cloud { "cloud" } else { "fog" };
        let kind = if of_fog > 0.5 {
            format!(
                "The {what} is like milk: {} of the light that it sends was scattered more than once, so a picture of single \
                 scattering alone looks too dark and too clear.",
                percent(of_fog)
            )
        } else {
            format!("{} of the light that the {what} sends was scattered more than once.", percent(of_fog))
        };
        format!(
            "Single scattering is not enough for {}: without the rest the whole picture is off by {}. {kind}",
            percent(bound),
            sure(multiple.error)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentages_have_two_digits() {
        let texts = [0.5, 0.0123, 0.00123, 0.000123, 1e-9, 11.63].map(percent);
        assert_eq!(texts, ["50 %", "1.2 %", "0.12 %", "0.012 %", "0 %", "1163 %"]);
    }
}
