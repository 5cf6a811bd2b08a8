//! One side of the window: a technique in a setting, and the frames that it draws.

use std::time::Instant;

use common::gpu::{Context, Ground, PassTimer, SurfaceData, Targets, read_image};
use common::image::Image;
use common::need::Model;
use common::{Scene, Term, Terms, View};
use glam::Vec3;

use super::history::History;
use crate::deferred::NO_SHADOW_MAP;
use crate::measure::check_size;
use crate::techniques::settings::Settings;
use crate::techniques::{Frame, Method, Technique, find_one};

/// A technique in a setting.
pub(super) struct Side {
    pub settings: Settings,
    /// Times of its frames.
    pub history: History,
    /// What the last frame's technique says of it.
    pub warnings: Vec<String>,
    /// Why there is no picture, if there is none.
    pub problem: Option<String>,
    made: Option<Made>,
    targets: Option<Targets>,
}

/// What a frame is drawn with; made again when what it depends on changes.
struct Made {
    key: Key,
    ground: Ground,
    drawer: Drawer,
}

/// What [`Made`] depends on.
#[derive(Clone, PartialEq)]
struct Key {
    scene: u64,
    settings: Settings,
    shadow_map_size: u32,
}

/// How a frame is drawn.
enum Drawer {
    /// Airlight by the technique, surfaces by the ground.
    Airlight(Box<dyn Technique>),
    /// All terms by the sorted shadow planes, which have shadows of their own.
    Planes(Box<biri_ss::Renderer>, Box<SurfaceData>, (u32, u32)),
}

/// What is to be drawn.
pub(super) struct Shot<'a> {
    /// What the loaded scene is known by.
    pub id: u64,
    /// The scene with its changes, everything in its place.
    pub scene: &'a Scene,
    pub view: &'a View,
    pub terms: Terms,
    /// Texels on a side of shadow maps, where the settings do not say.
    pub shadow_map_size: u32,
}

impl Side {
    /// The method that `name` stands for, as the command line spells it.
    pub(super) fn of(name: &str) -> Result<Self, String> {
        Ok(Self::with(Settings::of(&find_one(name)?, &Model::default())))
    }

    pub(super) fn with(settings: Settings) -> Self {
        let (history, warnings) = (History::default(), Vec::new());
        Self { settings, history, warnings, problem: None, made: None, targets: None }
    }

    /// Takes other settings.
    pub(super) fn take(&mut self, settings: Settings) {
        if settings.technique != self.settings.technique {
            self.history = History::default();
        }
        self.settings = settings;
    }

    /// Draws a frame; what goes wrong is in `problem`, and the picture is black then.
    pub(super) fn draw(&mut self, context: &Context, shot: &Shot<'_>) {
        self.warnings.clear();
        self.problem = self.try_draw(context, shot).err();
        // What the device says of a frame, it may say late.
        if let Some(error) = context.take_error() {
            self.problem.get_or_insert(error);
        }
        if self.problem.is_some() {
            self.made = None;
            if let Some(targets) = &self.targets {
                let mut encoder = context.device.create_command_encoder(&Default::default());
                targets.encode_clear(&mut encoder);
                context.queue.submit([encoder.finish()]);
            }
        }
    }

    /// The radiance drawn last; none before the first frame.
    pub(super) fn radiance(&self) -> Option<&wgpu::Texture> {
        self.targets.as_ref().map(|targets| &targets.radiance)
    }

    /// The picture drawn last, read back.
    pub(super) fn image(&self, context: &Context) -> Option<Image> {
        read_image(&context.device, &context.queue, self.radiance()?)
    }

    fn try_draw(&mut self, context: &Context, shot: &Shot<'_>) -> Result<(), String> {
        let size = (shot.view.width, shot.view.height);
        let (device, format) = (&context.device, context.radiance_format());
        let fits = |targets: &Targets| (targets.radiance.width(), targets.radiance.height()) == size;
        check_size(context, size).map_err(|failure| failure.to_string())?;
        let targets = match self.targets.take().filter(fits) {
            Some(targets) => targets,
            None => Targets::new(device, size.0, size.1, format),
        };
        let targets = self.targets.insert(targets);
        let method = self.settings.method()?;
        if let Some(refusal) = method.refusal(shot.scene) {
            return Err(refusal);
        }
        let key = Key {
            scene: shot.id,
            settings: self.settings.clone(),
            shadow_map_size: method.shadow_map_size.unwrap_or(shot.shadow_map_size),
        };
        let made = match self.made.take().filter(|made| made.key == key) {
            Some(made) => made,
            None => Made::new(context, shot, &method, key)?,
        };
        let made = self.made.insert(made);
        let (passes, milliseconds) = made.draw(context, shot, targets)?;
        self.warnings = made.drawer.warnings();
        if shot.terms.contains(Term::IndirectAirlight) && matches!(made.drawer, Drawer::Airlight(_)) {
            self.warnings.push(format!(
                "no {}: only biri-ss with all lights and shadows draws it, and the reference",
                Term::IndirectAirlight
            ));
        }
        self.history.push(passes, milliseconds);
        Ok(())
    }
}

impl Made {
    fn new(context: &Context, shot: &Shot<'_>, method: &Method, key: Key) -> Result<Self, String> {
        let (device, queue, format) = (&context.device, &context.queue, context.radiance_format());
        let size = (shot.view.width, shot.view.height);
        let drawer = match method.shadow_planes(format).filter(|_| key.settings.model.is_full()) {
            Some(options) => {
                let renderer = biri_ss::Renderer::new(device, queue, &options).map_err(|e| e.to_string())?;
                Drawer::Planes(Box::new(renderer), Box::new(SurfaceData::new(device, size.0, size.1)), size)
            }
            None => {
                let model = (&key.settings.model, shot.scene.lights.len());
                Drawer::Airlight(method.make_reduced(device, queue, format, size, model)?)
            }
        };
        // Nobody draws the maps of what has shadows of its own.
        let maps = if matches!(drawer, Drawer::Planes(..)) { NO_SHADOW_MAP } else { key.shadow_map_size };
        let ground =
            Ground::new(device, queue, shot.scene, format, maps).map_err(|error| error.to_string())?;
        Ok(Self { key, ground, drawer })
    }

    /// Draws a frame and waits for it; gives the times of passes and the whole \[ms\].
    fn draw(
        &mut self,
        context: &Context,
        shot: &Shot<'_>,
        targets: &Targets,
    ) -> Result<(super::history::Passes, f64), String> {
        let (device, queue) = (&context.device, &context.queue);
        let mut timer = PassTimer::new(device, queue);
        let started = Instant::now();
        let Self { ground, drawer, .. } = self;
        ground.prepare(device, queue, shot.scene, shot.view).map_err(|error| error.to_string())?;
        let mut encoder = device.create_command_encoder(&Default::default());
        targets.encode_clear(&mut encoder);
        ground.encode_depth(&mut encoder, targets, &mut timer);
        match drawer {
            Drawer::Airlight(technique) => {
                ground.encode_shadows(&mut encoder, &mut timer);
                if shot.terms.contains(Term::Surface) {
                    ground.encode_surfaces(&mut encoder, targets, &mut timer);
                }
                // What a technique prepares may need the maps that it reads.
                queue.submit([encoder.finish()]);
                encoder = device.create_command_encoder(&Default::default());
                if shot.terms.contains(Term::Airlight) {
                    let lights = ground.lights();
                    let (scene, view, depth) = (shot.scene, shot.view, &targets.depth);
                    technique.prepare(&Frame { device, queue, scene, view, lights, depth })?;
                    technique.encode(&mut encoder, &targets.radiance_view, &mut timer);
                }
            }
            Drawer::Planes(renderer, data, size) => {
                let now = (shot.view.width, shot.view.height);
                if *size != now {
                    **data = SurfaceData::new(device, now.0, now.1);
                    *size = now;
                }
                ground.encode_surface_data(&mut encoder, targets, data, &mut timer);
                planes(renderer, data, shot, targets, device, queue)?;
                let all = &targets.radiance_view;
                // Airlight that is not asked for goes where nobody looks.
                let nowhere = Targets::new(device, now.0, now.1, targets.radiance.format());
                let outputs = biri_ss::Outputs {
                    airlight: if shot.terms.contains(Term::Airlight) { all } else { &nowhere.radiance_view },
                    surfaces: shot.terms.contains(Term::Surface).then_some(all),
                    indirect: shot.terms.contains(Term::IndirectAirlight).then_some(all),
                };
                renderer.encode(&mut encoder, &outputs, &mut timer);
            }
        }
        timer.resolve(&mut encoder);
        queue.submit([encoder.finish()]);
        context.wait()?;
        let milliseconds = 1e3 * started.elapsed().as_secs_f64();
        Ok((timer.read(device, queue), milliseconds))
    }
}

/// Prepares the sorted shadow planes for all their terms.
fn planes(
    renderer: &mut biri_ss::Renderer,
    data: &SurfaceData,
    shot: &Shot<'_>,
    targets: &Targets,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
) -> Result<(), String> {
    let inputs = biri_ss::Inputs {
        view: shot.view,
        medium: &shot.scene.medium,
        lights: &shot.scene.lights,
        casters: &shot.scene.objects,
        depth: &targets.depth,
        surfaces: Some(biri_ss::Surfaces {
            normal: &data.normal,
            diffuse: &data.diffuse,
            specular: &data.specular,
            indirect: shot.terms.contains(Term::IndirectAirlight),
        }),
        ambient: Vec3::ZERO,
    };
    renderer.prepare(device, queue, &inputs).map_err(|error| error.to_string())
}

impl Drawer {
    fn warnings(&self) -> Vec<String> {
        match self {
            Self::Airlight(technique) => technique.warnings(),
            Self::Planes(renderer, ..) => renderer.warnings().iter().map(ToString::to_string).collect(),
        }
    }
}
