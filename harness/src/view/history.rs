//! Times of the frames drawn last, and their plot.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use eframe::egui::{self, Ui};
use egui_plot::{Corner, Legend, Line, Plot, PlotPoints};

use crate::report::digits;

/// Milliseconds by pass.
pub(super) type Passes = BTreeMap<&'static str, f64>;

/// Frames that are kept.
const KEPT: usize = 240;
/// Frames that the plot has room for at least.
const LEAST_SHOWN: usize = 30;

/// The frames drawn last.
#[derive(Default)]
pub(super) struct History {
    frames: VecDeque<(Passes, f64)>,
    /// Frames before those.
    before: usize,
}

impl History {
    /// Another frame: its passes and all of it by the wall clock \[ms\].
    pub(super) fn push(&mut self, passes: Passes, milliseconds: f64) {
        if self.frames.len() == KEPT {
            self.frames.pop_front();
            self.before += 1;
        }
        self.frames.push_back((passes, milliseconds));
    }

    /// Frames drawn so far.
    pub(super) fn count(&self) -> usize {
        self.before + self.frames.len()
    }

    /// Median of the last few frames \[ms\], by the wall clock.
    pub(super) fn milliseconds(&self) -> Option<f64> {
        let mut last: Vec<f64> = self.frames.iter().rev().take(9).map(|(_, ms)| *ms).collect();
        last.sort_by(f64::total_cmp);
        last.get(last.len() / 2).copied()
    }

    /// Time of the last frame \[ms\], by the wall clock.
    pub(super) fn last(&self) -> Option<f64> {
        self.frames.back().map(|(_, ms)| *ms)
    }

    /// All passes of the kept frames, by name: each keeps its colour.
    fn names(&self) -> BTreeSet<&'static str> {
        self.frames.iter().flat_map(|(passes, _)| passes.keys().copied()).collect()
    }

    /// A line for each pass and one for the whole frame.
    pub(super) fn plot(&self, ui: &mut Ui, id: &str, height: f32) {
        let x = |index: usize| (self.before + index + 1) as f64;
        let line = |name: &'static str| {
            let points = self.frames.iter().enumerate();
            let points = points.filter_map(|(index, (passes, _))| Some([x(index), *passes.get(name)?]));
            let last = self.frames.back().and_then(|(passes, _)| passes.get(name));
            let label = last.map_or_else(|| name.to_owned(), |ms| format!("{name}: {} ms", digits(*ms)));
            Line::new(label, PlotPoints::from_iter(points))
        };
        let frames = PlotPoints::from_iter(self.frames.iter().enumerate().map(|(i, (_, ms))| [x(i), *ms]));
        let label = self.last().map_or_else(String::new, |ms| format!(": {} ms", digits(ms)));
        let whole = Line::new(format!("whole frame, wall clock{label}"), frames).color(egui::Color32::GRAY);
        Plot::new(id)
            .height(height)
            .include_y(0.0)
            // As many frames as there is room for, from the first on.
            .include_x(self.before as f64 + 1.0)
            .include_x((self.before + self.frames.len().max(LEAST_SHOWN)) as f64)
            .allow_drag(false)
            .allow_zoom(false)
            .allow_scroll(false)
            .allow_boxed_zoom(false)
            .x_axis_label("frame")
            .y_axis_label("ms")
            .legend(Legend::default().position(Corner::RightTop).text_style(egui::TextStyle::Small))
            .show(ui, |plot| {
                plot.line(whole);
                self.names().into_iter().for_each(|name| plot.line(line(name)));
            });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_frames_are_kept_and_all_are_counted() {
        let mut history = History::default();
        assert_eq!((history.milliseconds(), history.count()), (None, 0));
        for frame in 0..KEPT + 10 {
            history.push(Passes::from([("a", 1.0), ("b", frame as f64)]), frame as f64);
        }
        assert_eq!((history.frames.len(), history.count()), (KEPT, KEPT + 10));
        assert_eq!(history.milliseconds(), Some((KEPT + 5) as f64));
        assert!(history.names().into_iter().eq(["a", "b"]));
    }
}
