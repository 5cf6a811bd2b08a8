//! A choice in words.

use common::need::Shaft;

use super::{Candidate, Choice, RunnerUp};
use crate::report::{digits, percent};

/// All that the user is told of one choice.
pub(super) fn text(choice: &Choice) -> String {
    let mut text = String::new();
    let mut line = |words: &str| {
        text += words;
        text.push('\n');
    };
    let Choice { scene, width, height, max_error, need, .. } = choice;
    line(&format!(
        "# {scene}, at most {} of error, {width}x{height}, {}",
        percent(*max_error),
        choice.adapter
    ));
    line("");
    line(&format!(
        "What the scene needs (estimated in {} s; all that is said of a picture is of its lit pixels):",
        digits(need.seconds)
    ));
    line("");
    for sentence in need.sentences(*max_error) {
        line(&format!("- {sentence}"));
    }
    line("");
    line(&need.single_scattering_sentence(*max_error));
    if !need.cloud && need.terms.airlight.may_be_left_out(*max_error) {
        line(
            "In the whole picture the airlight makes no difference within the bound; the choice is of how to draw it all the same.",
        );
    }
    if choice.need.cloud {
        line("szk-network draws all orders of scattering, and its error is against all of them.");
    }
    line("");
    match &choice.chosen {
        Some(chosen) => line(&told_chosen(choice, chosen)),
        None => line(&unmet(choice).unwrap_or_default()),
    }
    if let (Some(max), Some(chosen)) = (choice.max_ms, &choice.chosen)
        && chosen.ms > max
    {
        let within = choice.within_max_ms.as_ref().map_or_else(
            || "no setting that was measured is that fast".into(),
            |near| {
                format!(
                    "within it, {} has an error of {} in {} ms",
                    near.name,
                    percent(near.error),
                    digits(near.ms)
                )
            },
        );
        line(&format!("Nothing under the bound is as fast as {} ms: {within}.", digits(max)));
    }
    if let Some(second) = &choice.runner_up {
        line(&told_second(choice, second));
    }
    if !choice.lost.is_empty() {
        line("");
        line("Why not the others:");
        line("");
        for lost in &choice.lost {
            line(&format!("- {}: {}", lost.technique, lost.why));
        }
    }
    if !choice.least.is_empty() {
        line("");
        line("The least that the bound allows, as predicted:");
        line("");
        for least in &choice.least {
            line(&format!("- {} ({})", least.setting, percent(least.predicted_error)));
        }
    }
    let seconds = choice.seconds;
    line("");
    line(&format!(
        "Choosing took {} s: {} s to estimate, {} s for references, {} s to measure.",
        digits(seconds.total()),
        digits(seconds.need),
        digits(seconds.references),
        digits(seconds.measuring)
    ));
    if let Some(sweep) = &choice.sweep {
        line(&sweep.sentence(choice));
    }
    text
}

fn told_chosen(choice: &Choice, chosen: &Candidate) -> String {
    let model = &chosen.settings.model;
    let lights = (0..choice.lights).map(|index| match model.shaft(index) {
        Shaft::Off => format!("no airlight of light {index}"),
        Shaft::Unshadowed => format!("light {index} without shadows in the air"),
        Shaft::Shadowed => String::new(),
    });
    let grey = if model.grey { "a grey medium" } else { "" }.to_owned();
    let phase = match model.phase {
        common::need::PhaseModel::Own => "",
        common::need::PhaseModel::HenyeyGreenstein => "one Henyey-Greenstein lobe",
        common::need::PhaseModel::Isotropic => "an isotropic phase function",
    };
    let left: Vec<String> = lights.chain([grey, phase.to_owned()]).filter(|part| !part.is_empty()).collect();
    let with = if left.is_empty() { String::new() } else { format!(", with {}", left.join(", ")) };
    format!(
        "Choice: {}{with}: error {} (predicted {}), {} ms (predicted {} ms).",
        chosen.name,
        percent(chosen.error),
        percent(chosen.predicted_error),
        digits(chosen.ms),
        digits(chosen.predicted_ms)
    )
}

fn told_second(choice: &Choice, second: &RunnerUp) -> String {
    let why = match &choice.chosen {
        _ if second.error.is_some_and(|error| error > choice.max_error) => {
            "it lost because its error is above the bound".into()
        }
        Some(chosen) => format!(
            "it lost because it {} {} times as long",
            if second.ms.is_some() { "takes" } else { "is predicted to take" },
            digits(second.ms.unwrap_or(second.predicted_ms) / chosen.ms)
        ),
        None => "it is the nearest".into(),
    };
    let number = |measured: Option<f64>, predicted: f64, show: &dyn Fn(f64) -> String| match measured {
        Some(measured) => format!("{} (predicted {})", show(measured), show(predicted)),
        None => format!("{} (predicted)", show(predicted)),
    };
    format!(
        "Runner-up: {}: error {}, {}: {why}.",
        second.name,
        number(second.error, second.predicted_error, &percent),
        number(second.ms, second.predicted_ms, &|ms| format!("{} ms", digits(ms)))
    )
}

/// What was asked for and is not to be had.
pub(super) fn unmet(choice: &Choice) -> Option<String> {
    let Choice { scene, max_error, .. } = choice;
    match (&choice.chosen, choice.max_ms) {
        (None, _) => {
            let nearest = choice.runner_up.as_ref().map_or_else(String::new, |near| {
                let error = near.error.unwrap_or(near.predicted_error);
                let ms = near.ms.unwrap_or(near.predicted_ms);
                format!("; the nearest is {} at {} in {} ms", near.name, percent(error), digits(ms))
            });
            Some(format!("{scene}: no setting stays under {}{nearest}", percent(*max_error)))
        }
        (Some(chosen), Some(max)) if chosen.ms > max => Some(format!(
            "{scene}: under {} the fastest takes {} ms, more than {} ms",
            percent(*max_error),
            digits(chosen.ms),
            digits(max)
        )),
        _ => None,
    }
}
