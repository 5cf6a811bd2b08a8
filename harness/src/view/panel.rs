//! The panel beside the picture: everything that can be changed.

use common::need::{PhaseModel, Shaft};
use common::scene::builtin;
use common::{Term, Terms};
use eframe::egui::{self, CollapsingHeader, ComboBox, ScrollArea, Slider, Ui};

use super::app::App;
use super::picture::{Against, COARSEST, Shown};
use super::side::Side;
use super::verdict::Choosing;
use super::{fly, knobs, save};
use crate::techniques::settings::Settings;
use crate::techniques::{self, CLOUDS, Method};

/// Sides of shadow maps that are offered \[texels\].
const MAPS: [u32; 7] = [128, 256, 512, 1024, 2048, 4096, 8192];

/// Shows it all.
pub(super) fn show(app: &mut App, ui: &mut Ui) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.label(format!("{}, {}", app.context.adapter, app.context.driver));
        // The line is there before there is anything to say, so that nothing is shifted.
        let said = if app.said.is_empty() { " " } else { &app.said };
        ui.colored_label(egui::Color32::LIGHT_BLUE, said);
        section(ui, "Scene", |ui| scene(app, ui));
        section(ui, "Picture", |ui| picture(app, ui));
        let lights = app.subject.base().lights.len();
        let cloud = app.subject.base().cloud.is_some();
        let second = app.look.against == Against::Technique;
        for (index, side) in app.sides.iter_mut().enumerate().take(if second { 2 } else { 1 }) {
            let title = if second { ["Technique A", "Technique B"][index] } else { "Technique" };
            section(ui, title, |ui| technique(side, lights, cloud, ui));
        }
        section(ui, "Choose", |ui| choose(app, ui));
        section(ui, "Save", |ui| files(app, ui));
        section(ui, "Keys and mouse", |ui| ui.label(fly::HELP));
    });
}

fn section<R>(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui) -> R) {
    CollapsingHeader::new(title).default_open(true).show(ui, |ui| ui.push_id(title, content));
}

fn scene(app: &mut App, ui: &mut Ui) {
    let mut wanted = None;
    ComboBox::new("scene", "scene").selected_text(&app.subject.name).show_ui(ui, |ui| {
        for (name, what) in builtin::NAMES {
            let chosen = app.subject.name == *name;
            if ui.selectable_label(chosen, *name).on_hover_text(*what).clicked() && !chosen {
                wanted = Some((*name).to_owned());
            }
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("file");
        let typed = egui::TextEdit::singleline(&mut app.file).hint_text("model.obj, .gltf, .glb, .json");
        ui.add(typed.desired_width(180.0)).labelled_by(label.id);
        if ui.button("open").clicked() && !app.file.trim().is_empty() {
            wanted = Some(app.file.trim().to_owned());
        }
    });
    for note in &app.subject.base().notes {
        ui.small(note);
    }
    let kinds: Vec<&str> = app.subject.base().lights.iter().map(|light| light.kind()).collect();
    for (index, factor) in app.subject.changes.lights.iter_mut().enumerate() {
        let mut on = *factor > 0.0;
        ui.horizontal(|ui| {
            if ui.checkbox(&mut on, format!("light {index}")).changed() {
                *factor = if on { 1.0 } else { 0.0 };
            }
            ui.add(Slider::new(factor, 0.0..=8.0).text(format!("{}, × its own", kinds[index])));
        });
    }
    if app.subject.base().cloud.is_none() {
        let density = Slider::new(&mut app.subject.changes.density, 0.01..=100.0).logarithmic(true);
        ui.add(density.text("fog, × its own density"));
    }
    ui.horizontal(|ui| {
        ui.checkbox(&mut app.playing, "play");
        if ui.button("to the beginning").clicked() {
            app.subject.time = 0.0;
        }
    });
    if app.subject.base().animation.is_empty() {
        ui.small("nothing in this scene moves of itself");
    }
    ui.add(
        Slider::new(&mut app.subject.time, 0.0..=60.0).clamping(egui::SliderClamping::Never).text("time [s]"),
    );
    ui.add(Slider::new(&mut app.pace, 0.05..=4.0).logarithmic(true).text("pace [s per s]"));
    let mut camera = app.subject.camera();
    let mut degrees = camera.fov_y.to_degrees();
    if ui.add(Slider::new(&mut degrees, 5.0..=150.0).text("field of view [°, upright]")).changed() {
        camera.fov_y = degrees.to_radians();
        app.subject.changes.camera = Some(camera);
    }
    let radius = app.subject.radius();
    let speed = Slider::new(&mut app.speed, 1e-3 * radius..=10.0 * radius).logarithmic(true);
    ui.add(speed.text("flying [m/s]"));
    ui.horizontal(|ui| {
        if ui.button("back to the scene's eye").clicked() {
            app.subject.changes.camera = None;
        }
        if ui.button("undo all changes").clicked() {
            app.subject.reset();
            app.expose();
        }
    });
    if let Some(name) = wanted {
        app.open(&name);
    }
}

fn picture(app: &mut App, ui: &mut Ui) {
    ui.horizontal(|ui| {
        for term in [Term::Surface, Term::Airlight, Term::IndirectAirlight] {
            let mut on = app.look.terms.contains(term);
            if ui.checkbox(&mut on, term.name()).changed() {
                let others =
                    Term::ALL.into_iter().filter(|other| *other != term && app.look.terms.contains(*other));
                let terms = others.fold(Terms::NONE, Terms::with);
                app.look.terms = if on { terms.with(term) } else { terms };
            }
        }
    });
    if app.look.terms.is_empty() {
        app.look.terms = Term::Airlight.into();
    }
    let names = [
        (Against::Nothing, "nothing"),
        (Against::Technique, "a second technique"),
        (Against::Reference, "the CPU reference"),
    ];
    let current = names.iter().find(|(against, _)| *against == app.look.against).map_or("", |(_, name)| name);
    ComboBox::new("against", "held against").selected_text(current).show_ui(ui, |ui| {
        for (against, name) in names {
            ui.selectable_value(&mut app.look.against, against, name);
        }
    });
    ui.horizontal(|ui| {
        ui.radio_value(&mut app.look.shown, Shown::Divided, "side by side");
        ui.radio_value(&mut app.look.shown, Shown::Error, "error in false colour");
    });
    ui.add(Slider::new(&mut app.look.divided, 0.0..=1.0).text("dividing line [share of the width]"));
    let mut stops = app.look.exposure.unwrap_or(1.0).log2();
    ui.horizontal(|ui| {
        if ui.add(Slider::new(&mut stops, -20.0..=20.0).text("exposure [stops]")).changed() {
            app.look.exposure = Some(stops.exp2());
        }
        if ui.button("from the picture").clicked() {
            app.expose();
        }
    });
    ui.checkbox(&mut app.look.fineness.automatic, "as fine as is fluent");
    let mut divisor = app.look.fineness.divisor.max(1);
    let slider = Slider::new(&mut divisor, 1..=COARSEST).text("window's pixels per pixel, each way");
    if ui.add(slider).changed() {
        app.look.fineness.divisor = divisor;
        app.look.fineness.automatic = false;
    }
    maps(ui, "shadow maps [texels a side]", &mut app.look.shadow_map_size);
    ui.checkbox(&mut app.look.always, "draw all the time");
    ui.checkbox(&mut app.plots, "times by pass");
}

/// A list of sides of shadow maps.
fn maps(ui: &mut Ui, label: &str, size: &mut u32) {
    ComboBox::new(label, label).selected_text(size.to_string()).show_ui(ui, |ui| {
        for map in MAPS {
            ui.selectable_value(size, map, map.to_string());
        }
    });
}

fn technique(side: &mut Side, lights: usize, cloud: bool, ui: &mut Ui) {
    let all = techniques::all();
    let mut settings = side.settings.clone();
    ComboBox::new("technique", "technique").selected_text(&settings.technique).show_ui(ui, |ui| {
        let mut names: Vec<(&str, bool)> = all.iter().map(|method| (method.technique, method.peer)).collect();
        names.dedup();
        for (name, peer) in names.into_iter().filter(|(name, _)| (*name == CLOUDS) == cloud) {
            let chosen = settings.technique == name;
            let label = if peer { format!("{name} (peer)") } else { name.to_owned() };
            if ui.selectable_label(chosen, label).clicked()
                && !chosen
                && let Ok(method) = techniques::find_one(name)
            {
                settings = Settings {
                    shadow_map_size: settings.shadow_map_size,
                    ..Settings::of(&method, &settings.model)
                };
            }
        }
    });
    ui.horizontal_wrapped(|ui| {
        for method in presets(&settings.technique) {
            let preset = Settings::of(&method, &settings.model);
            if ui.selectable_label(preset.options == settings.options, &method.label).clicked() {
                settings.options = preset.options;
            }
        }
    });
    for knob in knobs::of(&settings.technique) {
        if knob.fits(&settings.options) {
            ui.push_id((&side.settings.technique, knob.at), |ui| knob.show(ui, &mut settings.options));
        }
    }
    let mut own = settings.shadow_map_size.is_some();
    ui.horizontal(|ui| {
        ui.checkbox(&mut own, "shadow maps of its own");
        let mut size = settings.shadow_map_size.unwrap_or(1024);
        if own {
            maps(ui, "[texels]", &mut size);
        }
        settings.shadow_map_size = own.then_some(size);
    });
    if !cloud {
        model(&mut settings, lights, ui);
    }
    if settings != side.settings {
        side.take(settings);
    }
}

/// Settings of a technique that have a name.
fn presets(technique: &str) -> Vec<Method> {
    let methods = techniques::all().into_iter().chain(techniques::improvements());
    methods.filter(|method| method.technique == technique).collect()
}

/// How much of the fog is drawn.
fn model(settings: &mut Settings, lights: usize, ui: &mut Ui) {
    let model = &mut settings.model;
    let shafts =
        [(Shaft::Shadowed, "with shadows"), (Shaft::Unshadowed, "without shadows"), (Shaft::Off, "none")];
    for index in 0..lights {
        let mut shaft = model.shaft(index);
        let name = shafts.iter().find(|(other, _)| *other == shaft).map_or("", |(_, name)| name);
        ComboBox::new(("shaft", index), format!("airlight of light {index}")).selected_text(name).show_ui(
            ui,
            |ui| {
                for (other, name) in shafts {
                    ui.selectable_value(&mut shaft, other, name);
                }
            },
        );
        if shaft != model.shaft(index) {
            model.lights.resize(lights.max(model.lights.len()), Shaft::Shadowed);
            model.lights[index] = shaft;
        }
    }
    ui.checkbox(&mut model.grey, "grey medium");
    let phases = [
        (PhaseModel::Own, "its own"),
        (PhaseModel::HenyeyGreenstein, "one Henyey-Greenstein lobe"),
        (PhaseModel::Isotropic, "isotropic"),
    ];
    let name = phases.iter().find(|(phase, _)| *phase == model.phase).map_or("", |(_, name)| name);
    ComboBox::new("phase", "phase function").selected_text(name).show_ui(ui, |ui| {
        for (phase, name) in phases {
            ui.selectable_value(&mut model.phase, phase, name);
        }
    });
}

fn choose(app: &mut App, ui: &mut Ui) {
    ui.add(Slider::new(&mut app.bound, 0.1..=20.0).logarithmic(true).text("error at most [%]"));
    ui.horizontal(|ui| {
        if ui.add_enabled(app.choosing.is_none(), egui::Button::new("how little is enough?")).clicked() {
            match Choosing::start(&app.subject, app.bound, &app.context.adapter, ui.ctx().clone()) {
                Ok(choosing) => app.choosing = Some(choosing),
                Err(problem) => app.said = problem,
            }
        }
        if app.choosing.is_some() {
            ui.spinner();
            if ui.button("stop").clicked() {
                app.choosing = None;
            }
        }
    });
    if app.choosing.is_some() {
        ui.small("measuring in a process of its own; a still window leaves it the adapter");
    }
}

/// What was chosen, in a window of its own.
pub(super) fn verdict(app: &mut App, ui: &mut Ui) {
    let Some(verdict) = &app.verdict else { return };
    let (mut open, mut taken) = (true, None);
    egui::Window::new("How little is enough").open(&mut open).default_width(560.0).show(ui.ctx(), |ui| {
        match verdict {
            Ok(verdict) => {
                if let Some(settings) = &verdict.settings
                    && ui.button("take it").clicked()
                {
                    taken = Some(settings.clone());
                }
                ScrollArea::vertical().max_height(420.0).show(ui, |ui| ui.label(&verdict.text));
            }
            Err(problem) => {
                ui.label(problem);
            }
        }
    });
    if let Some(settings) = taken {
        app.said = format!("{} as chosen", settings.technique);
        app.sides[0].take(settings);
        app.verdict = None;
    } else if !open {
        app.verdict = None;
    }
}

fn files(app: &mut App, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        if ui
            .button("picture")
            .on_hover_text("view-N.png as it is seen, view-N.exr: linear radiance of A")
            .clicked()
        {
            app.save_picture();
        }
        if ui.button("scene").on_hover_text("scene-N.json: with the changes, for --scene").clicked() {
            let path = save::free("".as_ref(), "scene", &["json"]).with_extension("json");
            let written = save::scene(&app.subject).and_then(|scene| save::write_json(&path, &scene));
            app.said = written.map_or_else(|problem| problem, |()| format!("wrote {}", path.display()));
        }
        for (index, name) in [(0, "settings of A"), (1, "settings of B")] {
            if index == 1 && app.look.against != Against::Technique {
                continue;
            }
            if ui.button(name).on_hover_text("settings-N.json, for --settings").clicked() {
                let path = save::free("".as_ref(), "settings", &["json"]).with_extension("json");
                let written = save::settings(&path, &app.sides[index].settings);
                app.said = written.map_or_else(|problem| problem, |()| format!("wrote {}", path.display()));
            }
        }
    });
}
