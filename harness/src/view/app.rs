//! The window's content: what is drawn when, and the picture with what stands on it.

use std::time::{Duration, Instant};

use common::gpu::Context;
use common::image::{Image, write_rgb8};
use common::metrics::compare;
use common::{Scene, Term, Terms};
use eframe::egui::{self, Color32, Rect, Sense, Ui, Vec2, pos2, vec2};
use eframe::egui_wgpu::RenderState;

use super::fly::{self, Steering};
use super::picture::{Against, Fineness, Look, Shown};
use super::present::{Presenter, upload};
use super::refine::{Refining, Wanted, at_rays_of};
use super::side::{Shot, Side};
use super::subject::{Changes, Subject};
use super::verdict::{Choosing, Verdict};
use super::{panel, save};
use crate::falsecolor::{ErrorMap, error_map};
use crate::report::percent;
use crate::techniques::settings::Settings;

/// How long the view stands still before the reference begins \[s\].
const STILL: f32 = 0.3;
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
    scene: *const Scene,
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
            // Minimised: nothing to be seen, nothing to be drawn.
            return;
        }
        self.size = self.look.fineness.size(pixels.x, pixels.y);
        self.steer(ui, &response);
        self.draw();
        self.refine(ui);
        let second = self.second();
        if self.look.shown == Shown::Error && second && self.error.is_none() {
            self.error = self.measure(ui.ctx());
        }
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, Color32::BLACK);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let place = fitted(rect, self.size.0 as f32, self.size.1 as f32);
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
    fn steer(&mut self, ui: &Ui, response: &egui::Response) {
        let camera = self.subject.camera();
        let mut steering: Steering = fly::steering(ui, response, camera.fov_y);
        let line = response.rect.left() + self.look.divided * response.rect.width();
        if response.drag_started() {
            let at = ui.input(|input| input.pointer.press_origin()).map_or(f32::INFINITY, |at| at.x);
            let divided = self.look.against != Against::Nothing && self.look.shown == Shown::Divided;
            self.gripped = divided && (at - line).abs() < GRIP;
        }
        if self.gripped && response.dragged() {
            let share = (line + response.drag_delta().x - response.rect.left()) / response.rect.width();
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
            scene: std::sync::Arc::as_ptr(self.subject.base()),
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
                base: self.subject.base(),
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

    /// Keeps the reference at what is looked at, once that stands still.
    fn refine(&mut self, ui: &Ui) {
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
    fn second(&self) -> bool {
        match self.look.against {
            Against::Nothing => false,
            Against::Technique => self.sides[1].problem.is_none(),
            Against::Reference => self.reference.is_some(),
        }
    }

    /// Both pictures at the same rays, and how sure the second is.
    fn pair(&self) -> Option<(Image, Image, Option<f64>)> {
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
    fn measure(&self, window: &egui::Context) -> Option<ErrorShown> {
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

    /// What stands on the picture.
    fn captions(&self, painter: &egui::Painter, rect: Rect) {
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

    /// Finds the exposure anew from the next picture.
    pub(super) fn expose(&mut self) {
        self.look.exposure = None;
    }

    /// Writes what is seen as a PNG, and the first technique's radiance as an EXR.
    pub(super) fn save_picture(&mut self) {
        let written = self.write_picture();
        self.said = written.unwrap_or_else(|problem| problem);
    }

    fn write_picture(&self) -> Result<String, String> {
        let name = save::free(std::path::Path::new(""), "view", &["png", "exr"]);
        let (png, exr) = (name.with_extension("png"), name.with_extension("exr"));
        let failed = |error: image::ImageError| {
            format!("can't write {}: {}", name.display(), crate::cmd::cause(&error))
        };
        let image = self.sides[0].image(&self.context).ok_or("there is no picture yet")?;
        image.write_exr(&exr).map_err(failed)?;
        let exposure = self.look.exposure.unwrap_or(1.0);
        match (&self.error, self.pair()) {
            (Some(error), _) if self.look.shown == Shown::Error => {
                write_rgb8(&png, error.map.width, error.map.height, error.map.bytes.clone())
                    .map_err(failed)?;
            }
            (_, Some((first, second, _))) if self.second() => {
                divided(&first, &second, self.look.divided).write_png(&png, exposure).map_err(failed)?;
            }
            _ => image.write_png(&png, exposure).map_err(failed)?,
        }
        Ok(format!("wrote {} and {}", png.display(), exr.display()))
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

/// Two pictures of one size, divided by an upright line.
fn divided(first: &Image, second: &Image, share: f32) -> Image {
    let mut image = first.clone();
    let width = first.width.max(1);
    for (index, pixel) in image.pixels.iter_mut().enumerate() {
        let x = index as u32 % width;
        if (x as f32 + 0.5) / width as f32 >= share {
            *pixel = second.pixels[index];
        }
    }
    image
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
