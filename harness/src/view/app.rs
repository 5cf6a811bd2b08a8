//! The window's content: what is drawn when, and where it stands.

mod against;
mod captions;
mod saving;

use std::time::Instant;

use common::Terms;
use common::gpu::Context;
use eframe::egui::{self, Color32, Rect, Sense, Ui, Vec2, pos2};
use eframe::egui_wgpu::RenderState;

use super::fly::{self, Steering};
use super::panel;
use super::picture::{Against, Fineness, Look, Shown};
use super::present::{Presenter, upload};
use super::refine::Refining;
use super::side::{Shot, Side};
use super::subject::{Changes, Subject};
use super::verdict::{Choosing, Verdict};
use crate::falsecolor::ErrorMap;
use crate::techniques::settings::Settings;

/// How near to the line a drag moves it \[points\].
const GRIP: f32 = 8.0;
/// Share of the scene's radius that the eye goes in a second.
const SPEED: f32 = 0.4;

/// All that the window knows.
pub(super) struct App {
    pub context: Context,
    pub subject: Subject,
    pub sides: [Side; 2],
    pub look: Look,
    pub playing: bool,
    /// Seconds of the scene's motion in one of the clock.
    pub pace: f32,
    /// How fast the eye flies \[m/s\].
    pub speed: f32,
    pub choosing: Option<Choosing>,
    pub verdict: Option<Result<Verdict, String>>,
    /// Largest error that is chosen for \[%\].
    pub bound: f32,
    /// Name of a scene file that is being typed.
    pub file: String,
    /// What was done last, or why not.
    pub said: String,
    /// Whether the times are shown.
    pub plots: bool,
    /// What was drawn last on each side.
    drawn: [Option<Drawn>; 2],
    presenter: Presenter,
    refining: Option<Refining>,
    /// What the reference was asked for, or is going to be; and since when nothing moved.
    asked: Option<(Drawn, Instant, bool)>,
    /// The reference picture on the device.
    reference: Option<wgpu::Texture>,
    error: Option<ErrorShown>,
    /// Pixels of the picture.
    size: (u32, u32),
    /// Whether the line is being moved.
    gripped: bool,
}

/// All that a picture depends on.
#[derive(Clone, PartialEq)]
struct Drawn {
    scene: u64,
    changes: Changes,
    time: f32,
    terms: Terms,
    size: (u32, u32),
    shadow_map_size: u32,
    /// None for the reference.
    settings: Option<Settings>,
}

/// An error map and what it amounts to.
struct ErrorShown {
    map: ErrorMap,
    texture: egui::TextureHandle,
    /// In words, with its number.
    text: String,
}

impl App {
    pub(super) fn new(context: Context, subject: Subject, sides: [Side; 2], shadow_map_size: u32) -> Self {
        let look = Look {
            terms: Terms::DIRECT,
            against: Against::Nothing,
            shown: Shown::Divided,
            divided: 0.5,
            exposure: None,
            shadow_map_size,
            fineness: Fineness::of(context.software),
            always: !context.software,
        };
        Self {
            presenter: Presenter::new(&context.device),
            speed: SPEED * subject.radius(),
            context,
            subject,
            sides,
            look,
            playing: false,
            pace: 1.0,
            choosing: None,
            verdict: None,
            bound: 2.0,
            file: String::new(),
            said: String::new(),
            plots: true,
            drawn: [None, None],
            refining: None,
            asked: None,
            reference: None,
            error: None,
            size: (0, 0),
            gripped: false,
        }
    }

    /// Looks at another scene; what can't draw it makes room for what can.
    pub(super) fn open(&mut self, name: &str) {
        match Subject::load(name, self.subject.triangles).or_else(|_| Subject::load(name, None)) {
            Ok(subject) => {
                self.subject = subject;
                self.speed = SPEED * self.subject.radius();
                self.look.exposure = None;
                self.said = format!("{name}: {} triangles", self.subject.base().triangle_count());
                self.suit_techniques();
            }
            Err(failure) => self.said = failure.to_string(),
        }
    }

    /// Replaces techniques that refuse the scene, and says so.
    fn suit_techniques(&mut self) {
        let base = self.subject.base();
        let usual = super::usual_technique(&self.context, base.cloud.is_some());
        for side in &mut self.sides {
            // What is drawn of lights is said of those of another scene.
            side.settings.model.lights.clear();
            let refused = side.settings.method().is_ok_and(|method| method.refusal(base).is_some());
            if refused && let Ok(other) = Side::of(usual) {
                self.said += &format!("; {usual} draws it in place of {}", side.settings.technique);
                *side = other;
            }
        }
    }

    /// One pass over the whole window. `window` is what the pictures are shown with; without it they are drawn all the same.
    pub(super) fn pass(&mut self, ui: &mut Ui, window: Option<&RenderState>) {
        self.poll();
        if ui.max_rect().size().min_elem() < 1.0 {
            // Minimised: nothing is seen, and the panels keep their sizes.
            return;
        }
        if self.playing {
            self.subject.time += self.pace * ui.input(|input| input.stable_dt).min(1.0);
            ui.request_repaint();
        }
        egui::Panel::left("settings").default_size(340.0).show(ui, |ui| panel::show(self, ui));
        if self.plots {
            egui::Panel::bottom("times").default_size(190.0).resizable(true).show(ui, |ui| self.plots(ui));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, window));
        panel::verdict(self, ui);
    }

    /// Takes what was finished in the background.
    fn poll(&mut self) {
        if let Some(verdict) = self.choosing.as_ref().and_then(Choosing::poll) {
            (self.choosing, self.verdict) = (None, Some(verdict));
        }
        if self.refining.as_mut().is_some_and(Refining::poll) {
            let found = self.refining.as_ref().and_then(|refining| refining.found.as_ref());
            self.reference = found.map(|found| upload(&self.context, &found.image));
            self.error = None;
        }
    }

    fn plots(&self, ui: &mut Ui) {
        let sides = if self.look.against == Against::Technique { 2 } else { 1 };
        ui.columns(sides, |columns| {
            for (index, (ui, side)) in columns.iter_mut().zip(&self.sides).enumerate() {
                let ms = side.history.milliseconds().map_or_else(String::new, |ms| {
                    let (ms, rate) = (crate::report::digits(ms), crate::report::digits(1e3 / ms));
                    format!(": {ms} ms, {rate} frames a second, {} frames", side.history.count())
                });
                ui.label(format!("{}{ms}", side.settings.technique));
                if self.context.software {
                    ui.small("a software adapter's pass times miss the work of compute passes");
                }
                let height = ui.available_height();
                side.history.plot(ui, &format!("times {index}"), height);
            }
        });
    }

    fn picture(&mut self, ui: &mut Ui, window: Option<&RenderState>) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let pixels = rect.size() * ui.ctx().pixels_per_point();
        if pixels.min_elem() < 1.0 {
            return;
        }
        self.size = self.look.fineness.size(pixels.x, pixels.y);
        let place = fitted(rect, self.size.0 as f32, self.size.1 as f32);
        self.steer(ui, &response, place);
        self.draw();
        self.refine(ui);
        let second = self.second();
        if self.look.shown == Shown::Error && second && self.error.is_none() {
            self.error = self.measure(ui.ctx());
        }
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, Color32::BLACK);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        match &self.error {
            Some(error) if self.look.shown == Shown::Error && second => {
                let place = fitted(rect, error.map.width as f32, error.map.height as f32);
                painter.image(error.texture.id(), place, whole, Color32::WHITE);
            }
            _ => {
                if let Some(window) = window
                    && let Some(id) = self.presenter.texture(window)
                {
                    painter.image(id, place, whole, Color32::WHITE);
                }
                if second && self.look.shown == Shown::Divided {
                    let x = place.left() + self.look.divided * place.width();
                    painter.vline(x, place.y_range(), (2.0, Color32::WHITE));
                }
            }
        }
        self.captions(&painter, rect);
    }

    /// Moves eye or line.
    fn steer(&mut self, ui: &Ui, response: &egui::Response, place: Rect) {
        let camera = self.subject.camera();
        let mut steering: Steering = fly::steering(ui, response, camera.fov_y);
        let line = place.left() + self.look.divided * place.width();
        if response.drag_started() {
            let at = ui.input(|input| input.pointer.press_origin()).map_or(f32::INFINITY, |at| at.x);
            let divided = self.look.against != Against::Nothing && self.look.shown == Shown::Divided;
            self.gripped = divided && (at - line).abs() < GRIP;
        }
        if self.gripped && response.dragged() {
            let share = (line + response.drag_delta().x - place.left()) / place.width();
            self.look.divided = share.clamp(0.0, 1.0);
            steering.turn = [0.0; 2];
        }
        let radius = self.subject.radius();
        self.speed = (self.speed * steering.faster).clamp(1e-3 * radius, 10.0 * radius);
        let way = self.speed * ui.input(|input| input.stable_dt).min(0.5);
        if let Some(camera) = fly::moved(&camera, &steering, way) {
            self.subject.changes.camera = Some(camera);
        }
        if steering.go != glam::Vec3::ZERO {
            ui.request_repaint();
        }
    }

    /// What a side's picture is of now.
    fn wanted(&self, settings: Option<Settings>) -> Drawn {
        Drawn {
            scene: self.subject.id(),
            changes: self.subject.changes.clone(),
            time: self.subject.time,
            terms: self.look.terms,
            size: self.size,
            shadow_map_size: self.look.shadow_map_size,
            settings,
        }
    }

    /// Draws what is not drawn yet, and shows it.
    fn draw(&mut self) {
        let sides = if self.look.against == Against::Technique { 2 } else { 1 };
        let scene = self.subject.now();
        let view = scene.camera.view(self.size.0, self.size.1);
        let mut milliseconds = 0.0;
        for index in 0..sides {
            let wanted = self.wanted(Some(self.sides[index].settings.clone()));
            if self.drawn[index].as_ref() == Some(&wanted) && !self.look.always {
                continue;
            }
            let shot = Shot {
                id: self.subject.id(),
                scene: &scene,
                view: &view,
                terms: self.look.terms,
                shadow_map_size: self.look.shadow_map_size,
            };
            // A first frame makes what it is drawn with: its time is not a frame's.
            let warm = self.drawn[index]
                .as_ref()
                .is_some_and(|drawn| drawn.settings == wanted.settings && drawn.size == wanted.size);
            self.sides[index].draw(&self.context, &shot);
            milliseconds += self.sides[index].history.last().filter(|_| warm).unwrap_or(0.0);
            self.drawn[index] = Some(wanted);
            self.error = None;
        }
        if milliseconds > 0.0 {
            self.look.fineness.took(milliseconds);
        }
        if self.look.exposure.is_none() {
            self.look.exposure = self.sides[0].image(&self.context).map(|image| image.auto_exposure());
        }
        let exposure = self.look.exposure.unwrap_or(1.0);
        let Some(first) = self.sides[0].radiance() else { return };
        let second = match self.look.against {
            Against::Nothing => None,
            Against::Technique => self.sides[1].radiance(),
            Against::Reference => self.reference.as_ref(),
        };
        let divided = if second.is_some() { self.look.divided } else { 2.0 };
        self.presenter.draw(&self.context, [first, second.unwrap_or(first)], exposure, divided);
    }

    /// Finds the exposure anew from the next picture.
    pub(super) fn expose(&mut self) {
        self.look.exposure = None;
    }

    /// What a screen shows of the picture.
    #[cfg(test)]
    pub(super) fn shown(&self) -> Option<&wgpu::Texture> {
        self.presenter.target()
    }

    /// What is said of the error, and whether that is of the finest reference.
    #[cfg(test)]
    pub(super) fn error_text(&self) -> Option<(&str, bool)> {
        let error = self.error.as_ref()?;
        Some((&error.text, self.refining.as_ref().is_some_and(Refining::is_finished)))
    }
}

/// The largest place in `rect` for something of this shape.
fn fitted(rect: Rect, width: f32, height: f32) -> Rect {
    let scale = (rect.width() / width).min(rect.height() / height);
    Rect::from_center_size(rect.center(), Vec2::new(width, height) * scale)
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        self.pass(ui, frame.wgpu_render_state());
        if self.look.always {
            ui.request_repaint();
        }
    }
}
