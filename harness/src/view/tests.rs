//! The window without a window: its passes are run and its controls are operated as a screen reader would.

use std::collections::HashSet;

use common::gpu::{Context, ContextOptions};
use eframe::egui::accesskit::{Action, ActionData, ActionRequest, Node, NodeId, Role, TreeId};
use eframe::egui::{self, Event, RawInput, pos2, vec2};

use super::app::App;
use super::picture::{Against, Shown};
use super::side::Side;
use super::subject::Subject;

/// The window's content and what operates it.
struct Driver {
    app: App,
    window: egui::Context,
    size: egui::Vec2,
    time: f64,
    /// What the sides are to draw with.
    techniques: [String; 2],
    nodes: Vec<(NodeId, Node)>,
}

impl Driver {
    fn new(scene: &str, sides: [&str; 2]) -> Self {
        let context = Context::new(&ContextOptions::default()).expect("an adapter");
        let subject = Subject::load(scene, Some(1500)).or_else(|_| Subject::load(scene, None)).unwrap();
        let sides = sides.map(|name| Side::of(name).unwrap());
        let techniques = [0, 1].map(|index| sides[index].settings.technique.clone());
        let mut app = App::new(context, subject, sides, 64);
        // As coarse as can be: it is the controls that are tested.
        (app.look.always, app.look.fineness.automatic, app.look.fineness.divisor) = (false, false, 8);
        let window = egui::Context::default();
        window.enable_accesskit();
        Self { app, window, size: vec2(700.0, 520.0), time: 0.0, techniques, nodes: Vec::new() }
    }

    /// One pass with these events.
    fn pass(&mut self, events: Vec<Event>) {
        self.time += 0.05;
        let screen_rect = Some(egui::Rect::from_min_size(pos2(0.0, 0.0), self.size));
        let input =
            RawInput { screen_rect, time: Some(self.time), events, focused: true, ..RawInput::default() };
        let app = &mut self.app;
        let output = self.window.run_ui(input, |ui| app.pass(ui, None));
        if let Some(update) = output.platform_output.accesskit_update {
            self.nodes = update.nodes;
        }
    }

    fn act(&mut self, target_node: NodeId, action: Action, data: Option<ActionData>) {
        let request = ActionRequest { action, target_tree: TreeId::ROOT, target_node, data };
        self.pass(vec![Event::AccessKitActionRequest(request)]);
        self.pass(Vec::new());
    }

    /// The control of that role and name.
    fn find(&self, role: Role, name: &str) -> Option<NodeId> {
        let named = |node: &Node| node.label().or(node.value()).is_some_and(|label| label.contains(name));
        self.nodes.iter().find(|(_, node)| node.role() == role && named(node)).map(|(id, _)| *id)
    }

    fn click(&mut self, role: Role, name: &str) {
        let id = self.find(role, name).unwrap_or_else(|| panic!("there is no {role:?} `{name}`"));
        self.act(id, Action::Click, None);
    }

    /// Chooses every entry of a list, the first one last; gives how many there are.
    fn choose_each(&mut self, list: NodeId) -> usize {
        let before: HashSet<NodeId> = self.nodes.iter().map(|(id, _)| *id).collect();
        self.act(list, Action::Click, None);
        let entry = |(id, node): &(NodeId, Node)| {
            (node.role() == Role::Button && !before.contains(id))
                .then(|| (*id, node.label().unwrap_or("").to_owned()))
        };
        let entries: Vec<(NodeId, String)> = self.nodes.iter().filter_map(entry).collect();
        // Scenes are opened elsewhere: here the scene stays what it is.
        let scenes = entries.iter().any(|(_, name)| name == "cathedral");
        for (id, name) in entries.iter().rev().filter(|_| !scenes) {
            self.act(*id, Action::Click, None);
            self.keep_small();
            self.check(name);
            if self.nodes.iter().all(|(open, _)| open != id) {
                self.act(list, Action::Click, None);
            }
        }
        let key = egui::Key::Escape;
        let modifiers = egui::Modifiers::NONE;
        self.pass(vec![Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers }]);
        self.pass(Vec::new());
        entries.len()
    }

    /// Keeps what is drawn cheap, by the same techniques, of which there are two.
    fn keep_small(&mut self) {
        self.app.look.against = Against::Technique;
        (self.app.look.fineness.automatic, self.app.look.fineness.divisor) = (false, 8);
        self.app.look.shadow_map_size = 64;
        self.app.look.always = false;
        for (side, technique) in self.app.sides.iter_mut().zip(&self.techniques) {
            if side.settings.technique != *technique {
                side.take(Side::of(technique).unwrap().settings);
            }
            side.settings.shadow_map_size = side.settings.shadow_map_size.map(|size| size.min(256));
            if let Some(volume) = side.settings.options.pointer_mut("/volume") {
                // A mesh takes a second here.
                *volume = "rays".into();
            }
            for (at, most) in
                [("/particles", 16), ("/options/directions", 8), ("/steps", 64), ("/planes", 16)]
            {
                if let Some(value) = side.settings.options.pointer_mut(at) {
                    *value = value.as_u64().unwrap_or(most).min(most).into();
                }
            }
        }
    }

    /// Fails where a picture is not finite.
    fn check(&self, after: &str) {
        for side in &self.app.sides {
            let Some(image) = side.image(&self.app.context) else { continue };
            assert!(image.pixels.iter().all(|pixel| pixel.is_finite()), "{after}: a pixel is not finite");
        }
    }
}

/// What must not be operated: it writes files or starts a process.
const LEFT_ALONE: [&str; 5] = ["picture", "scene", "settings of A", "settings of B", "how little is enough?"];

/// Operates every control that is there and was not seen before, and those that come up meanwhile; gives how many
/// entries their lists had.
fn operate_all(driver: &mut Driver, seen: &mut HashSet<NodeId>) -> usize {
    let mut choices = 0;
    for _ in 0..400 {
        let next = driver.nodes.iter().find(|(id, node)| {
            let operated = node.supports_action(Action::Click)
                || node.supports_action(Action::Increment)
                || node.supports_action(Action::SetValue);
            let name = node.label().or(node.value());
            let left = node.role() == Role::Button && name.is_some_and(|name| LEFT_ALONE.contains(&name));
            operated && !left && !seen.contains(id) && node.role() != Role::Unknown
        });
        let Some((id, node)) = next.map(|(id, node)| (*id, node.clone())) else {
            return choices;
        };
        seen.insert(id);
        if node.supports_action(Action::Increment) {
            driver.act(id, Action::Increment, None);
        } else if node.role() == Role::TextInput {
            driver.act(id, Action::SetValue, Some(ActionData::Value("no-such-scene".into())));
        } else if node.role() == Role::ComboBox {
            choices += driver.choose_each(id);
        } else {
            driver.act(id, Action::Click, None);
        }
        driver.keep_small();
        driver.check(&format!("{:?} {:?}", node.role(), node.label()));
    }
    panic!("controls without end");
}

#[test]
fn every_control_can_be_operated() {
    for (scene, technique, least) in [
        ("amphora", "unshadowed", 40),
        ("knife-edge", "lit-intervals", 9),
        ("knife-edge", "biri-ss", 9),
        ("knife-edge", "chen-planes", 9),
        ("knife-edge", "froxels-8x64", 3),
        ("knife-edge", "ray-march-64", 1),
        ("sphere", "szk-network-16x8", 15),
    ] {
        let mut driver = Driver::new(scene, [technique, "unshadowed"]);
        driver.keep_small();
        driver.pass(Vec::new());
        driver.pass(Vec::new());
        let mut seen = HashSet::new();
        if technique != "unshadowed" {
            // What all have in common was operated with the first.
            for section in ["Scene", "Picture", "Choose", "Save", "Technique B"] {
                let named = |(_, node): &&(NodeId, Node)| node.label() == Some(section);
                let header = driver.nodes.iter().find(named).unwrap_or_else(|| panic!("no {section}")).0;
                driver.act(header, Action::Click, None);
                seen.insert(header);
            }
            (0..10).for_each(|_| driver.pass(Vec::new()));
        }
        let before = seen.len();
        let choices = operate_all(&mut driver, &mut seen);
        let controls = seen.len() - before;
        println!("{technique}: {controls} controls, {choices} entries of lists");
        assert!(controls >= least, "{technique}: {controls}");
    }
}

#[test]
fn what_is_turned_is_drawn() {
    let mut driver = Driver::new("amphora", ["lit-intervals", "ray-march-64"]);
    driver.pass(Vec::new());
    driver.pass(Vec::new());
    let image = |driver: &Driver| driver.app.sides[0].image(&driver.app.context).unwrap();
    let before = image(&driver);
    assert!(before.pixels.iter().any(|pixel| pixel.max_element() > 0.0));
    assert_eq!(driver.app.sides[0].problem, None);
    let frames = driver.app.sides[0].history.count();
    driver.pass(Vec::new());
    assert_eq!(driver.app.sides[0].history.count(), frames, "a still view is not drawn again");

    driver.click(Role::CheckBox, "light 0");
    assert_eq!(driver.app.subject.changes.lights[0], 0.0);
    assert!(image(&driver) != before, "the light makes no difference");
    driver.click(Role::CheckBox, "light 0");
    assert!(image(&driver) == before, "the light does not come back");

    driver.click(Role::CheckBox, "surface");
    let airlight = image(&driver);
    assert!(airlight != before, "surfaces make no difference");
    driver.click(Role::CheckBox, "airlight");
    driver.click(Role::CheckBox, "surface");
    assert!(image(&driver) != airlight, "airlight makes no difference");
}

#[test]
fn keys_fly_and_a_drag_turns() {
    let mut driver = Driver::new("amphora", ["unshadowed", "unshadowed"]);
    driver.pass(Vec::new());
    let eye = |driver: &Driver| driver.app.subject.camera().eye;
    let start = driver.app.subject.camera();
    let key = |pressed| Event::Key {
        key: egui::Key::W,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: egui::Modifiers::NONE,
    };
    driver.pass(vec![key(true)]);
    driver.pass(vec![key(false)]);
    assert!((eye(&driver) - start.eye).dot(start.target - start.eye) > 0.0);
    let at = pos2(600.0, 100.0);
    let button = |pressed| Event::PointerButton {
        pos: at,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    let before = driver.app.subject.camera();
    driver.pass(vec![Event::PointerMoved(at)]);
    driver.pass(vec![button(true)]);
    driver.pass(vec![Event::PointerMoved(at + vec2(60.0, 0.0))]);
    driver.pass(vec![button(false)]);
    let after = driver.app.subject.camera();
    assert_eq!(after.eye, before.eye);
    assert_ne!(after.target, before.target);
    driver.click(Role::Button, "back to the scene's eye");
    assert_eq!(driver.app.subject.camera(), start);
}

#[test]
fn the_reference_comes_when_the_view_stands_still_and_gives_the_error() {
    let mut driver = Driver::new("knife-edge", ["lit-intervals@512", "lit-intervals"]);
    driver.app.look.against = Against::Reference;
    driver.app.look.shown = Shown::Error;
    driver.app.look.terms = common::Term::Airlight.into();
    let started = std::time::Instant::now();
    let text = loop {
        driver.pass(Vec::new());
        if let Some((text, true)) = driver.app.error_text() {
            break text.to_owned();
        }
        assert!(started.elapsed().as_secs() < 60, "no reference after a minute");
        std::thread::sleep(std::time::Duration::from_millis(20));
    };
    let number = text.split("relative RMSE ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    let error: f64 = number.parse().unwrap();
    assert!(error > 0.0 && error < 2.0, "{text}");
    // It is forgotten as soon as something moves.
    driver.app.subject.time = 1.0;
    driver.pass(Vec::new());
    assert!(driver.app.error_text().is_none());
}

#[test]
fn state_survives_resizing_and_minimising() {
    let mut driver = Driver::new("amphora", ["chen-planes", "unshadowed"]);
    driver.pass(Vec::new());
    driver.app.subject.changes.density = 2.0;
    driver.pass(Vec::new());
    let first = driver.app.sides[0].image(&driver.app.context).unwrap();
    for size in [vec2(0.0, 0.0), vec2(1900.0, 400.0), vec2(640.0, 900.0)] {
        driver.size = size;
        driver.pass(Vec::new());
        assert_eq!(driver.app.sides[0].problem, None, "{size:?}");
    }
    driver.size = vec2(700.0, 520.0);
    driver.pass(Vec::new());
    driver.pass(Vec::new());
    assert_eq!(driver.app.subject.changes.density, 2.0);
    let again = driver.app.sides[0].image(&driver.app.context).unwrap();
    assert_eq!((again.width, again.height), (first.width, first.height));
    assert!(again == first, "another picture");
    assert_eq!(driver.app.shown().unwrap().width(), first.width);
}

#[test]
fn a_scene_that_a_technique_cannot_draw_gets_one_that_can() {
    let mut driver = Driver::new("knife-edge", ["biri-ss", "chen-planes"]);
    driver.pass(Vec::new());
    driver.app.open("sphere");
    driver.pass(Vec::new());
    assert_eq!(driver.app.sides[0].settings.technique, "szk-network");
    assert_eq!(driver.app.sides[0].problem, None);
    assert!(driver.app.said.contains("szk-network draws it in place of biri-ss"), "{}", driver.app.said);
    driver.app.open("no-such-scene");
    assert!(driver.app.said.contains("no-such-scene"), "{}", driver.app.said);
    assert_eq!(driver.app.subject.name, "sphere");
}

#[test]
fn the_screen_shows_what_a_saved_picture_shows() {
    let mut driver = Driver::new("amphora", ["lit-intervals", "unshadowed"]);
    driver.pass(Vec::new());
    driver.pass(Vec::new());
    let image = driver.app.sides[0].image(&driver.app.context).unwrap();
    let wanted = image.to_srgb8(driver.app.look.exposure.unwrap());
    let shown = screen(&driver.app);
    assert_eq!(shown.len(), wanted.len());
    let worst = shown.iter().zip(&wanted).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
    assert!(worst <= 1, "{worst}");
}

/// The bytes of what a screen shows, without alpha.
fn screen(app: &App) -> Vec<u8> {
    let (device, queue) = (&app.context.device, &app.context.queue);
    let texture = app.shown().unwrap();
    let (width, height) = (texture.width(), texture.height());
    let row = (4 * width).next_multiple_of(256);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row * height),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: Some(height) };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        texture.size(),
    );
    queue.submit([encoder.finish()]);
    let words = common::gpu::read_u32s(device, queue, &buffer, (row * height / 4) as usize).unwrap();
    let rows = words.chunks_exact(row as usize / 4);
    rows.flat_map(|row| &row[..width as usize]).flat_map(|word| word.to_le_bytes()[..3].to_vec()).collect()
}
