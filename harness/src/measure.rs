//! Times and pictures of one technique on one scene.

use std::collections::BTreeMap;
use std::time::Instant;

use common::gpu::{Context, Ground, PassTimer, Targets, read_depth, read_image};
use common::image::Image;
use common::{Scene, View};
use glam::Vec3;

use crate::failure::Failure;
use crate::interrupt;
use crate::techniques::{Frame, Technique};

/// Frames per second of the motion that is measured.
pub(crate) const FRAME_RATE: f32 = 30.0;

/// A scene on the device, with targets of one size: the ground that all techniques are measured on.
pub(crate) struct Stage<'a> {
    context: &'a Context,
    scene: &'a Scene,
    ground: Ground,
    targets: Targets,
    size: (u32, u32),
}

/// How many frames are drawn and timed.
#[derive(Clone, Debug)]
pub(crate) struct Frames {
    /// Drawn first, not timed.
    pub warm_up: usize,
    /// Timed at most.
    most: usize,
    /// Timed at least, however long they take.
    least: usize,
    /// No new frame once the timed ones took so long \[s\].
    budget: f64,
}

impl Frames {
    /// Exactly as many as were asked for, or as many as suit the adapter.
    pub(crate) fn new(wanted: Option<u32>, software: bool) -> Self {
        let (warm_up, most, least, budget) = if software { (1, 12, 2, 2.0) } else { (20, 300, 30, 10.0) };
        match wanted {
            Some(wanted) => Self { warm_up, most: wanted as usize, least: wanted as usize, budget },
            None => Self { warm_up, most, least, budget },
        }
    }

    /// The same without a warm-up, where frames take so long that it makes no difference.
    pub(crate) fn cold(self) -> Self {
        Self { warm_up: 0, ..self }
    }

    /// For many measurements, each after a picture that warms up the device: about half a second of frames for a look,
    /// else as many as it takes.
    pub(crate) fn of_run(wanted: Option<u32>, software: bool, quick: bool) -> Self {
        let (warm_up, most, least, budget) = match (software, quick) {
            (true, true) => (0, 12, 2, 0.5),
            (true, false) => (0, 12, 3, 2.0),
            (false, true) => (5, 100, 10, 0.5),
            (false, false) => return Self::new(wanted, software),
        };
        let all = Self::new(wanted, software);
        if wanted.is_some() { Self { warm_up, ..all } } else { Self { warm_up, most, least, budget } }
    }

    /// As many as fit into so many seconds, where the number was not asked for.
    pub(crate) fn within(&self, budget: f64) -> Self {
        Self { budget, ..self.clone() }
    }

    /// So many rounds, or fewer where fewer frames were asked for.
    pub(crate) fn at_most(&self, rounds: usize) -> usize {
        self.most.min(rounds)
    }

    /// Drawn altogether at most.
    pub(crate) fn total(&self) -> usize {
        self.warm_up + self.most
    }

    /// Whether the times of the frames so far \[ms\] are enough.
    pub(crate) fn enough(&self, times: &[f64]) -> bool {
        times.len() >= self.least && times.iter().sum::<f64>() > 1e3 * self.budget
    }
}

/// Fails where the device has no picture of that size.
pub(crate) fn check_size(context: &Context, (width, height): (u32, u32)) -> Result<(), Failure> {
    let limits = context.device.limits();
    // A picture is read back through one buffer of rows padded to 256 bytes, 16 bytes a pixel.
    let bytes = (u64::from(width) * 16).next_multiple_of(256) * u64::from(height);
    if width.max(height) > limits.max_texture_dimension_2d || bytes > limits.max_buffer_size {
        return Err(Failure::Input(format!(
            "a picture of {width}x{height} pixels can't be made on {}; expected at most {} each way and {} bytes",
            context.adapter, limits.max_texture_dimension_2d, limits.max_buffer_size
        )));
    }
    Ok(())
}

/// Times of all frames \[ms\].
#[derive(Debug, Default)]
pub(crate) struct Times {
    /// The technique's own passes, by timestamps; empty where the device has none that can be trusted.
    pub passes_total: Vec<f64>,
    /// From submitting the technique's passes until the device is done with them.
    pub wall: Vec<f64>,
    /// Preparing and encoding the technique.
    pub cpu: Vec<f64>,
    /// The whole frame.
    pub frame: Vec<f64>,
    /// Each of the technique's passes, frame by frame.
    pub passes: BTreeMap<&'static str, Vec<f64>>,
    /// Each pass of the ground.
    pub ground_passes: BTreeMap<&'static str, Vec<f64>>,
}

/// Which terms a picture holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Drawn {
    Airlight,
    Surface,
    Both,
}

impl<'a> Stage<'a> {
    /// Uploads the scene. Fails where the device can't hold it, the shadow maps or the picture.
    pub(crate) fn new(
        context: &'a Context,
        scene: &'a Scene,
        size: (u32, u32),
        shadow_size: u32,
    ) -> Result<Self, Failure> {
        Self::of_format(context, scene, size, shadow_size, context.radiance_format())
    }

    /// The same with targets of another format.
    pub(crate) fn of_format(
        context: &'a Context,
        scene: &'a Scene,
        size: (u32, u32),
        shadow_size: u32,
        format: wgpu::TextureFormat,
    ) -> Result<Self, Failure> {
        check_size(context, size)?;
        let ground = Ground::new(&context.device, &context.queue, scene, format, shadow_size)
            .map_err(|error| Failure::Input(format!("{}: {error}", scene.name)))?;
        let targets = Targets::new(&context.device, size.0, size.1, format);
        let stage = Self { context, scene, ground, targets, size };
        stage.settled("the scene does not fit on the device")?;
        Ok(stage)
    }

    /// Format of the target that techniques add to.
    pub(crate) fn format(&self) -> wgpu::TextureFormat {
        self.targets.radiance.format()
    }

    /// Waits for the device; fails with what it complained about.
    fn settled(&self, what: &str) -> Result<(), Failure> {
        self.context.wait().map_err(|error| Failure::Run(format!("{}: {what}: {error}", self.scene.name)))
    }

    /// Draws the frames of warm-up and then times more, everything moving. A refusal of the
    /// technique comes back as the inner error.
    pub(crate) fn times(
        &mut self,
        technique: &mut dyn Technique,
        frames: &Frames,
    ) -> Result<Result<Times, String>, Failure> {
        let mut timers = self.timers();
        let mut times = Times::default();
        for index in 0..frames.total() {
            interrupt::check()?;
            if frames.enough(&times.frame) {
                break;
            }
            let kept = (index >= frames.warm_up).then_some(&mut times);
            if let Err(refusal) = self.time_one(technique, index, &mut timers, kept)? {
                return Ok(Err(refusal));
            }
        }
        Ok(Ok(times))
    }

    /// Timers of the ground's passes and of the technique's.
    fn timers(&self) -> [PassTimer; 2] {
        [(); 2].map(|()| PassTimer::new(&self.context.device, &self.context.queue))
    }

    /// Draws frame `index` of the motion and keeps its times, if they are wanted.
    fn time_one(
        &mut self,
        technique: &mut dyn Technique,
        index: usize,
        [ground_timer, timer]: &mut [PassTimer; 2],
        kept: Option<&mut Times>,
    ) -> Result<Result<(), String>, Failure> {
        let (device, queue) = (&self.context.device, &self.context.queue);
        let scene = moved(self.scene, index as f32 / FRAME_RATE);
        let view = scene.camera.view(self.size.0, self.size.1);

        let start = Instant::now();
        self.draw_ground(&scene, &view, Drawn::Both, ground_timer)?;
        self.settled("the frame's ground")?;
        let ground_done = Instant::now();

        let frame = Frame {
            device,
            queue,
            scene: &scene,
            view: &view,
            lights: self.ground.lights(),
            depth: &self.targets.depth,
        };
        if let Err(refusal) = technique.prepare(&frame) {
            return Ok(Err(refusal));
        }
        let mut encoder = device.create_command_encoder(&Default::default());
        technique.encode(&mut encoder, &self.targets.radiance_view, timer);
        timer.resolve(&mut encoder);
        let commands = encoder.finish();
        let encoded = Instant::now();
        queue.submit([commands]);
        self.settled("the technique")?;
        let done = Instant::now();

        let ground_passes = ground_timer.read(device, queue);
        let passes = timer.read(device, queue);
        let Some(times) = kept else { return Ok(Ok(())) };
        let ms = |from: Instant, to: Instant| to.duration_since(from).as_secs_f64() * 1e3;
        times.cpu.push(ms(ground_done, encoded));
        times.wall.push(ms(encoded, done));
        times.frame.push(ms(start, done));
        // A software adapter's timestamps of compute passes are of when it was told of them, not of when it did them.
        if !passes.is_empty() && !self.context.software {
            times.passes_total.push(passes.values().sum());
        }
        for (all, now) in [(&mut times.passes, passes), (&mut times.ground_passes, ground_passes)] {
            for (name, time) in now {
                all.entry(name).or_default().push(time);
            }
        }
        Ok(Ok(()))
    }

    /// One picture of the scene at `time` \[s\]; without a technique there is no airlight.
    pub(crate) fn picture(
        &mut self,
        technique: Option<&mut dyn Technique>,
        time: f32,
        drawn: Drawn,
    ) -> Result<Image, Failure> {
        let scene = self.scene.at(time);
        let view = scene.camera.view(self.size.0, self.size.1);
        self.draw_ground(&scene, &view, drawn, &mut PassTimer::off())?;
        self.settled("the frame's ground")?;
        if drawn != Drawn::Surface
            && let Some(technique) = technique
        {
            self.add(technique, &scene, &view, &mut PassTimer::off())?;
        }
        self.read()
    }

    /// The airlight of `scene`, which has the objects of the stage's, in whatever place.
    pub(crate) fn airlight_of(
        &mut self,
        technique: &mut dyn Technique,
        scene: &Scene,
    ) -> Result<Image, Failure> {
        let view = scene.camera.view(self.size.0, self.size.1);
        self.draw_ground(scene, &view, Drawn::Airlight, &mut PassTimer::off())?;
        self.settled("the frame's ground")?;
        self.add(technique, scene, &view, &mut PassTimer::off())?;
        self.read()
    }

    /// The airlight alone at `time` \[s\]. A refusal of the technique comes back as the inner error.
    pub(crate) fn try_picture(
        &mut self,
        technique: &mut dyn Technique,
        time: f32,
    ) -> Result<Result<Image, String>, Failure> {
        match self.picture(Some(technique), time, Drawn::Airlight) {
            Ok(image) => Ok(Ok(image)),
            Err(Failure::Input(refusal)) => Ok(Err(refusal)),
            Err(failure) => Err(failure),
        }
    }

    /// The airlight alone at the time that the last picture was of, on that picture's shadow maps and
    /// depth; and the passes' times \[ms\].
    pub(crate) fn airlight_again(
        &mut self,
        technique: &mut dyn Technique,
        time: f32,
    ) -> Result<(Image, BTreeMap<&'static str, f64>), Failure> {
        let scene = self.scene.at(time);
        let view = scene.camera.view(self.size.0, self.size.1);
        let (device, queue) = (&self.context.device, &self.context.queue);
        let mut timer = PassTimer::new(device, queue);
        let mut encoder = device.create_command_encoder(&Default::default());
        self.targets.encode_clear(&mut encoder);
        queue.submit([encoder.finish()]);
        self.add(technique, &scene, &view, &mut timer)?;
        let passes = timer.read(device, queue);
        Ok((self.read()?, passes))
    }

    /// How far from the eye the depth buffer at `time` \[s\] ends the ray of each pixel \[m\], row by row from the top.
    pub(crate) fn distances(&mut self, time: f32) -> Result<Vec<f32>, Failure> {
        let scene = self.scene.at(time);
        let view = scene.camera.view(self.size.0, self.size.1);
        self.draw_ground(&scene, &view, Drawn::Airlight, &mut PassTimer::off())?;
        let (device, queue) = (&self.context.device, &self.context.queue);
        let depths = read_depth(device, queue, self.targets.depth.texture());
        self.settled("reading the depth")?;
        let depths = depths.ok_or_else(|| Failure::Run("the device was lost while depth was read".into()))?;
        let distance =
            |(index, depth)| view.distance(depth, index as u32 % view.width, index as u32 / view.width);
        Ok(depths.into_iter().enumerate().map(distance).collect())
    }

    /// Adds airlight to the target.
    fn add(
        &self,
        technique: &mut dyn Technique,
        scene: &Scene,
        view: &View,
        timer: &mut PassTimer,
    ) -> Result<(), Failure> {
        let (device, queue) = (&self.context.device, &self.context.queue);
        let frame =
            Frame { device, queue, scene, view, lights: self.ground.lights(), depth: &self.targets.depth };
        technique.prepare(&frame).map_err(Failure::Input)?;
        let mut encoder = device.create_command_encoder(&Default::default());
        technique.encode(&mut encoder, &self.targets.radiance_view, timer);
        timer.resolve(&mut encoder);
        queue.submit([encoder.finish()]);
        self.settled("the technique")
    }

    /// The target as it is.
    fn read(&self) -> Result<Image, Failure> {
        let image = read_image(&self.context.device, &self.context.queue, &self.targets.radiance);
        self.settled("reading the picture")?;
        image.ok_or_else(|| Failure::Run("the device was lost while a picture was read".into()))
    }

    /// Shadow maps, depth, and radiance cleared or lit.
    fn draw_ground(
        &mut self,
        scene: &Scene,
        view: &View,
        drawn: Drawn,
        timer: &mut PassTimer,
    ) -> Result<(), Failure> {
        let (device, queue) = (&self.context.device, &self.context.queue);
        self.ground
            .prepare(device, queue, scene, view)
            .map_err(|error| Failure::Input(format!("{}: {error}", scene.name)))?;
        let mut encoder = device.create_command_encoder(&Default::default());
        self.targets.encode_clear(&mut encoder);
        self.ground.encode_shadows(&mut encoder, timer);
        self.ground.encode_depth(&mut encoder, &self.targets, timer);
        if drawn != Drawn::Airlight {
            self.ground.encode_surfaces(&mut encoder, &self.targets, timer);
        }
        timer.resolve(&mut encoder);
        queue.submit([encoder.finish()]);
        Ok(())
    }
}

/// A technique, and which of several stages it is timed on.
pub(crate) struct Turn {
    pub stage: usize,
    pub technique: Box<dyn Technique>,
}

/// Times of several techniques, whole frames of which are drawn in turn, the first one being another one each
/// time, so that whatever else the machine does hits all alike. It is enough when the rounds are.
pub(crate) fn times_in_turn(
    stages: &mut [Stage<'_>],
    turns: &mut [Turn],
    frames: &Frames,
) -> Result<Vec<Times>, Failure> {
    let Some(first) = stages.first() else { return Ok(Vec::new()) };
    let mut timers = first.timers();
    let mut times: Vec<Times> = turns.iter().map(|_| Times::default()).collect();
    let mut rounds: Vec<f64> = Vec::new();
    for index in 0..frames.total() {
        if frames.enough(&rounds) {
            break;
        }
        for turn in 0..turns.len() {
            interrupt::check()?;
            let which = (index + turn) % turns.len();
            let Turn { stage, technique } = &mut turns[which];
            let kept = (index >= frames.warm_up).then_some(&mut times[which]);
            let drawn = stages[*stage].time_one(technique.as_mut(), index, &mut timers, kept)?;
            drawn.map_err(Failure::Input)?;
        }
        if index >= frames.warm_up {
            rounds.push(times.iter().filter_map(|times| times.frame.last()).sum());
        }
    }
    Ok(times)
}

/// What moves while times are taken.
pub(crate) fn motion(scene: &Scene) -> &'static str {
    if scene.animation.is_empty() {
        "camera and lights sway, because the scene has no motion of its own"
    } else {
        "the scene's own motion"
    }
}

/// The scene at `time`; one without motion of its own sways, so that nothing can be kept from frame
/// to frame: camera and lights go round circles of a hundredth of the viewing distance.
pub(crate) fn moved(scene: &Scene, time: f32) -> Scene {
    let mut scene = scene.at(time);
    if scene.animation.is_empty() {
        let radius = 0.01 * scene.camera.eye.distance(scene.camera.target);
        let turn = |rate: f32| Vec3::new((rate * time).cos() - 1.0, 0.0, (rate * time).sin()) * radius;
        scene.camera.eye += turn(2.0);
        for light in &mut scene.lights {
            match light {
                common::Light::Point(light) => light.position += turn(3.0),
                common::Light::Spot(light) => light.position += turn(3.0),
                common::Light::Directional(light) => {
                    let tilt = 0.01 * Vec3::new((3.0 * time).sin(), 0.0, (2.0 * time).sin());
                    light.direction = (light.direction + tilt).normalize();
                }
            }
        }
    }
    scene
}

#[cfg(test)]
mod tests {
    use common::{Light, PointLight};

    use super::*;

    #[test]
    fn a_still_scene_is_set_in_motion_and_starts_where_it_is() {
        let mut scene = Scene::empty("still");
        scene.lights = vec![Light::Point(PointLight { position: Vec3::ONE, intensity: Vec3::ONE })];
        assert_eq!(moved(&scene, 0.0).camera, scene.camera);
        assert_eq!(moved(&scene, 0.0).lights, scene.lights);
        assert_ne!(moved(&scene, 0.1).camera, scene.camera);
        assert_ne!(moved(&scene, 0.1).lights, scene.lights);
        assert_eq!(moved(&scene, 0.1).problem(), None);
    }
}
