//! What stands on the picture.

use eframe::egui::{self, Color32, Rect, vec2};

use super::App;
use crate::view::picture::{Against, Shown};
use crate::view::side::Side;

impl App {
    /// What stands on the picture.
    pub(super) fn captions(&self, painter: &egui::Painter, rect: Rect) {
        let font = egui::FontId::proportional(14.0);
        let write = |at: egui::Pos2, align: egui::Align2, text: &str, colour: Color32| {
            let galley = painter.layout(text.to_owned(), font.clone(), colour, rect.width() * 0.9);
            let place = align.anchor_size(at, galley.size());
            painter.rect_filled(place.expand(3.0), 3.0, Color32::from_black_alpha(170));
            painter.galley(place.min, galley, colour);
            place.height() + 8.0
        };
        let of = |side: &Side, letter: &str| match &side.problem {
            Some(problem) => (format!("{letter}{}: {problem}", side.settings.technique), Color32::LIGHT_RED),
            None => (format!("{letter}{}", side.settings.technique), Color32::WHITE),
        };
        let letter = if self.look.against == Against::Nothing { "" } else { "A: " };
        let (text, colour) = of(&self.sides[0], letter);
        let mut down = 8.0;
        down += write(rect.left_top() + vec2(8.0, down), egui::Align2::LEFT_TOP, &text, colour);
        for warning in &self.sides[0].warnings {
            down +=
                write(rect.left_top() + vec2(8.0, down), egui::Align2::LEFT_TOP, warning, Color32::YELLOW);
        }
        let right = match self.look.against {
            Against::Nothing => None,
            Against::Technique => Some(of(&self.sides[1], "B: ")),
            Against::Reference => Some(self.reference_caption()),
        };
        if let Some((text, colour)) = right {
            let down = if text.len() > 50 { down } else { 8.0 };
            write(rect.right_top() + vec2(-8.0, down), egui::Align2::RIGHT_TOP, &text, colour);
        }
        let mut up = -8.0;
        if self.context.software && self.look.fineness.divisor > 1 {
            let text = format!(
                "software adapter: {}x{} pixels, one for {2}x{2} of the window's, to stay usable",
                self.size.0, self.size.1, self.look.fineness.divisor
            );
            up -= write(
                rect.left_bottom() + vec2(8.0, up),
                egui::Align2::LEFT_BOTTOM,
                &text,
                Color32::LIGHT_GRAY,
            );
        }
        if let Some(error) = self.error.as_ref().filter(|_| self.look.shown == Shown::Error) {
            let text = format!("{}: {}", self.look.terms, error.text);
            write(rect.left_bottom() + vec2(8.0, up), egui::Align2::LEFT_BOTTOM, &text, Color32::WHITE);
        }
    }

    fn reference_caption(&self) -> (String, Color32) {
        let Some(refining) = &self.refining else { return ("reference".into(), Color32::WHITE) };
        if let Some(problem) = &refining.problem {
            return (format!("B: {problem}"), Color32::LIGHT_RED);
        }
        let of =
            |step: u32| if step == 1 { "every pixel".into() } else { format!("one of {step}x{step} pixels") };
        let text = match &refining.found {
            Some(found) if refining.is_finished() => format!("B: reference, {}", of(found.step)),
            Some(found) => {
                format!("B: reference, {}, finer one {:.0} % done", of(found.step), 100.0 * refining.share())
            }
            None if self.asked.as_ref().is_some_and(|(_, _, begun)| *begun) => "B: reference, begun".into(),
            None => "B: reference, begins when the view stands still".into(),
        };
        (text, Color32::WHITE)
    }
}
