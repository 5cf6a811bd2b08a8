//! Frames of the sorted shadow planes, which light the surfaces themselves: no shadow maps, every term in a
//! picture of its own, and the times of whole frames.

use std::collections::BTreeMap;
use std::time::Instant;

use biri_ss::{Inputs, Outputs, Renderer, Statistics, Surfaces};
use common::gpu::{Context, Ground, PassTimer, SurfaceData, Targets, read_image};
use common::image::Image;
use common::{Scene, View};
use glam::Vec3;

use crate::failure::Failure;
use crate::interrupt;
use crate::measure::{FRAME_RATE, Frames, check_size, moved};

/// Side of shadow maps that nobody draws: the smallest that there is.
pub(crate) const NO_SHADOW_MAP: u32 = 2;

/// A scene on the device, with targets of one size.
pub(crate) struct Stage<'a> {
    context: &'a Context,
    scene: &'a Scene,
    ground: Ground,
    targets: Targets,
    data: SurfaceData,
    size: (u32, u32),
}

/// What a frame is to hold.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wanted {
    /// Indirect single scattering on surfaces too.
    pub indirect: bool,
    /// No caster at all: every ray is lit.
    pub unshadowed: bool,
}

/// The terms of one frame.
pub(crate) struct Pictures {
    pub surfaces: Image,
    pub airlight: Image,
    /// Black where it was not wanted.
    pub indirect: Image,
}

impl Pictures {
    /// All terms together.
    pub(crate) fn total(&self) -> Image {
        self.surfaces.plus(&self.airlight).plus(&self.indirect)
    }
}

/// Times of whole frames \[ms\], and what each was made of.
#[derive(Debug, Default)]
pub(crate) struct Times {
    /// Everything from moving the scene's data to the device's being done.
    pub frame: Vec<f64>,
    /// The technique on the CPU: silhouettes, order, uploads.
    pub prepare: Vec<f64>,
    /// The technique's passes together, by timestamps; empty where the device has none.
    pub technique: Vec<f64>,
    /// Each pass.
    pub passes: BTreeMap<&'static str, Vec<f64>>,
    pub statistics: Vec<Statistics>,
}

impl<'a> Stage<'a> {
    /// Uploads the scene. Fails where the device can't hold it or the picture.
    pub(crate) fn new(context: &'a Context, scene: &'a Scene, size: (u32, u32)) -> Result<Self, Failure> {
        check_size(context, size)?;
        let (device, format) = (&context.device, context.radiance_format());
        let ground = Ground::new(device, &context.queue, scene, format, NO_SHADOW_MAP)
            .map_err(|error| Failure::Input(format!("{}: {error}", scene.name)))?;
        let targets = Targets::new(device, size.0, size.1, format);
        let data = SurfaceData::new(device, size.0, size.1);
        let stage = Self { context, scene, ground, targets, data, size };
        stage.settled("the scene does not fit on the device")?;
        Ok(stage)
    }

    /// A renderer for this stage's targets.
    pub(crate) fn renderer(&self, options: &biri_ss::Options) -> Result<Renderer, Failure> {
        Renderer::new(&self.context.device, &self.context.queue, options)
            .map_err(|error| Failure::Run(format!("biri-ss: {error}")))
    }

    /// Waits for the device; fails with what it complained about.
    fn settled(&self, what: &str) -> Result<(), Failure> {
        self.context.wait().map_err(|error| Failure::Run(format!("{}: {what}: {error}", self.scene.name)))
    }

    fn prepare_ground(&mut self, scene: &Scene, view: &View) -> Result<(), Failure> {
        self.ground
            .prepare(&self.context.device, &self.context.queue, scene, view)
            .map_err(|error| Failure::Input(format!("{}: {error}", scene.name)))
    }

    /// Prepares one frame of the technique.
    pub(crate) fn prepare(
        &self,
        renderer: &mut Renderer,
        scene: &Scene,
        view: &View,
        wanted: Wanted,
    ) -> Result<(), Failure> {
        let inputs = Inputs {
            view,
            medium: &scene.medium,
            lights: &scene.lights,
            casters: if wanted.unshadowed { &[] } else { &scene.objects },
            depth: &self.targets.depth,
            surfaces: Some(Surfaces {
                normal: &self.data.normal,
                diffuse: &self.data.diffuse,
                specular: &self.data.specular,
                indirect: wanted.indirect,
            }),
            ambient: Vec3::ZERO,
        };
        renderer
            .prepare(&self.context.device, &self.context.queue, &inputs)
            .map_err(|error| Failure::Input(format!("{}: biri-ss: {error}", scene.name)))
    }

    /// The terms of one frame of `scene`, which is this stage's at any time and from any camera.
    pub(crate) fn pictures(
        &mut self,
        renderer: &mut Renderer,
        scene: &Scene,
        wanted: Wanted,
    ) -> Result<Pictures, Failure> {
        let context = self.context;
        let (device, queue) = (&context.device, &context.queue);
        let view = scene.camera.view(self.size.0, self.size.1);
        self.prepare_ground(scene, &view)?;
        self.prepare(renderer, scene, &view, wanted)?;
        let format = context.radiance_format();
        let terms = [(); 3].map(|()| Targets::new(device, self.size.0, self.size.1, format));
        let [surfaces, airlight, indirect] = &terms;
        let mut encoder = device.create_command_encoder(&Default::default());
        terms.iter().for_each(|term| term.encode_clear(&mut encoder));
        let mut off = PassTimer::off();
        self.ground.encode_depth(&mut encoder, &self.targets, &mut off);
        self.ground.encode_surface_data(&mut encoder, &self.targets, &self.data, &mut off);
        let outputs = Outputs {
            airlight: &airlight.radiance_view,
            surfaces: Some(&surfaces.radiance_view),
            indirect: wanted.indirect.then_some(&indirect.radiance_view),
        };
        renderer.encode(&mut encoder, &outputs, &mut off);
        queue.submit([encoder.finish()]);
        self.settled("the frame")?;
        let read = |target: &Targets| {
            let image = read_image(device, queue, &target.radiance);
            image.ok_or_else(|| Failure::Run("the device was lost while a picture was read".into()))
        };
        let pictures =
            Pictures { surfaces: read(surfaces)?, airlight: read(airlight)?, indirect: read(indirect)? };
        self.settled("reading the pictures")?;
        Ok(pictures)
    }

    /// Times of whole frames, everything moving: every frame is drawn by each of the renderers in turn, the
    /// first one being another one each time, so that whatever else the machine does hits all alike.
    pub(crate) fn times<const N: usize>(
        &mut self,
        renderers: &mut [(Renderer, Wanted); N],
        frames: &Frames,
    ) -> Result<[Times; N], Failure> {
        let mut timer = PassTimer::new(&self.context.device, &self.context.queue);
        let mut times = [(); N].map(|()| Times::default());
        for index in 0..frames.total() {
            if times.iter().all(|times| frames.enough(&times.frame)) {
                break;
            }
            let scene = moved(self.scene, index as f32 / FRAME_RATE);
            for turn in 0..N {
                interrupt::check()?;
                let which = (index + turn) % N;
                let (renderer, wanted) = &mut renderers[which];
                let mut unused = Times::default();
                let kept = if index < frames.warm_up { &mut unused } else { &mut times[which] };
                self.time_one(renderer, &scene, *wanted, &mut timer, kept)?;
            }
        }
        Ok(times)
    }

    fn time_one(
        &mut self,
        renderer: &mut Renderer,
        scene: &Scene,
        wanted: Wanted,
        timer: &mut PassTimer,
        times: &mut Times,
    ) -> Result<(), Failure> {
        let context = self.context;
        let (device, queue) = (&context.device, &context.queue);
        let view = scene.camera.view(self.size.0, self.size.1);
        let start = Instant::now();
        self.prepare_ground(scene, &view)?;
        let ground_prepared = Instant::now();
        self.prepare(renderer, scene, &view, wanted)?;
        let prepared = Instant::now();
        let mut encoder = device.create_command_encoder(&Default::default());
        self.targets.encode_clear(&mut encoder);
        self.ground.encode_depth(&mut encoder, &self.targets, timer);
        self.ground.encode_surface_data(&mut encoder, &self.targets, &self.data, timer);
        let all = &self.targets.radiance_view;
        let outputs =
            Outputs { airlight: all, surfaces: Some(all), indirect: wanted.indirect.then_some(all) };
        renderer.encode(&mut encoder, &outputs, timer);
        timer.resolve(&mut encoder);
        queue.submit([encoder.finish()]);
        self.settled("the frame")?;
        let done = Instant::now();

        let ms = |from: Instant, to: Instant| to.duration_since(from).as_secs_f64() * 1e3;
        times.frame.push(ms(start, done));
        times.prepare.push(ms(ground_prepared, prepared));
        times.statistics.push(renderer.statistics());
        let passes = timer.read(device, queue);
        if !passes.is_empty() {
            let own = passes.iter().filter(|(name, _)| Renderer::PASSES.contains(name));
            times.technique.push(own.map(|(_, time)| time).sum());
        }
        for (name, time) in passes {
            times.passes.entry(name).or_default().push(time);
        }
        Ok(())
    }
}
