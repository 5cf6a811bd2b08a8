//! The second picture: what the first is held against, and how far they are apart.

use std::time::{Duration, Instant};

use common::Term;
use common::image::Image;
use common::metrics::compare;
use eframe::egui::{self, Ui};

use super::{App, Drawn, ErrorShown};
use crate::falsecolor::error_map;
use crate::report::percent;
use crate::view::picture::Against;
use crate::view::refine::{Refining, Wanted, at_rays_of};

/// How long the view stands still before the reference begins \[s\].
const STILL: f32 = 0.3;

impl App {
    /// Keeps the reference at what is looked at, once that stands still.
    pub(super) fn refine(&mut self, ui: &Ui) {
        if self.look.against != Against::Reference {
            if let Some(refining) = &mut self.refining {
                refining.stop();
            }
            (self.asked, self.reference) = (None, None);
            return;
        }
        let wanted = Drawn { shadow_map_size: 0, ..self.wanted(None) };
        let context = ui.ctx().clone();
        let refining = self.refining.get_or_insert_with(|| Refining::new(context));
        match &mut self.asked {
            Some((asked, since, begun)) if *asked == wanted => {
                if *begun {
                    if !refining.is_finished() {
                        ui.ctx().request_repaint_after(Duration::from_millis(200));
                    }
                    return;
                }
                let still = since.elapsed().as_secs_f32();
                if still < STILL {
                    ui.ctx().request_repaint_after_secs(STILL - still);
                    return;
                }
                *begun = true;
                let scene = self.subject.now();
                let mut terms = self.look.terms;
                if scene.cloud.is_some() && terms.contains(Term::Airlight) {
                    // What draws clouds draws all orders of scattering.
                    terms = terms.with(Term::Multiple);
                }
                refining.ask(Wanted { camera: scene.camera, scene, size: self.size, terms });
            }
            asked => {
                *asked = Some((wanted, Instant::now(), false));
                refining.stop();
                (self.reference, self.error) = (None, None);
                ui.ctx().request_repaint_after_secs(STILL);
            }
        }
    }

    /// Whether there is a second picture.
    pub(super) fn second(&self) -> bool {
        match self.look.against {
            Against::Nothing => false,
            Against::Technique => self.sides[1].problem.is_none(),
            Against::Reference => self.reference.is_some(),
        }
    }

    /// Both pictures at the same rays, and how sure the second is.
    pub(super) fn pair(&self) -> Option<(Image, Image, Option<f64>)> {
        let first = self.sides[0].image(&self.context)?;
        match self.look.against {
            Against::Nothing => None,
            Against::Technique => Some((first, self.sides[1].image(&self.context)?, None)),
            Against::Reference => {
                let found = self.refining.as_ref()?.found.as_ref()?;
                Some((at_rays_of(&first, found.step), found.image.clone(), Some(found.uncertainty)))
            }
        }
    }

    /// The error of the first picture against the second.
    pub(super) fn measure(&self, window: &egui::Context) -> Option<ErrorShown> {
        let (first, second, uncertainty) = self.pair()?;
        let errors = compare(&first, &second).ok()?;
        let map = error_map(&first, &second);
        let size = [map.width as usize, map.height as usize];
        let image = egui::ColorImage::from_rgb(size, &map.bytes);
        let texture = window.load_texture("view: error", image, egui::TextureOptions::NEAREST);
        let sure = uncertainty
            .map_or_else(String::new, |u| format!(", of which the reference may be off by {}", percent(u)));
        let text = format!(
            "relative RMSE {}, bias {}, worst tile {} ({}x{} pixels{sure})",
            percent(errors.rel_rmse),
            percent(errors.bias),
            percent(errors.worst_tile),
            first.width,
            first.height
        );
        Some(ErrorShown { map, texture, text })
    }
}
