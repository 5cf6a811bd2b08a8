//! What stands on the picture.

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, vec2};

use super::App;
use crate::view::picture::{Against, Shown};
use crate::view::side::Side;

impl App {
    /// Writes who draws it, what that says of it, and the error.
    pub(super) fn captions(&self, painter: &egui::Painter, rect: Rect) {
        let alone = self.look.against == Against::Nothing;
        let mut left = of(&self.sides[0], if alone { "" } else { "A: " });
        if let Some(error) = self.error.as_ref().filter(|_| self.look.shown == Shown::Error) {
            left.push((format!("{}: {}", self.look.terms, error.text), Color32::WHITE));
        }
        if self.context.software && self.look.fineness.divisor > 1 {
            let text = format!(
                "software adapter: {}x{} pixels, one for {2}x{2} of the window's, to stay usable",
                self.size.0, self.size.1, self.look.fineness.divisor
            );
            left.push((text, Color32::LIGHT_GRAY));
        }
        let right = match self.look.against {
            Against::Nothing => Vec::new(),
            Against::Technique => of(&self.sides[1], "B: "),
            Against::Reference => vec![self.reference_caption()],
        };
        let width = if alone { 0.95 } else { 0.46 } * rect.width();
        let inner = rect.shrink(8.0);
        write(painter, inner.left_top(), Align2::LEFT_TOP, width, left);
        write(painter, inner.right_top(), Align2::RIGHT_TOP, width, right);
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

/// A line of text and its colour.
type Line = (String, Color32);

/// What there is to say of a side.
fn of(side: &Side, letter: &str) -> Vec<Line> {
    let name = &side.settings.technique;
    if let Some(problem) = &side.problem {
        return vec![(format!("{letter}{name}: {problem}"), Color32::LIGHT_RED)];
    }
    let warnings = side.warnings.iter().map(|warning| (warning.clone(), Color32::YELLOW));
    [(format!("{letter}{name}"), Color32::WHITE)].into_iter().chain(warnings).collect()
}

/// Writes lines below each other from a corner on.
fn write(painter: &egui::Painter, corner: Pos2, align: Align2, width: f32, lines: Vec<Line>) {
    let mut down = 0.0;
    for (text, colour) in lines {
        let galley = painter.layout(text, FontId::proportional(14.0), colour, width);
        let place = align.anchor_size(corner + vec2(0.0, down), galley.size());
        painter.rect_filled(place.expand(3.0), 3.0, Color32::from_black_alpha(170));
        down += place.height() + 8.0;
        painter.galley(place.min, galley, colour);
    }
}
