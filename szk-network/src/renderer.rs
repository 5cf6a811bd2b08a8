//! The renderer: a cloud loaded once, steps and a picture for every frame.

use std::sync::atomic::{AtomicBool, Ordering};

use common::gpu::passes::begin_compute;
use common::gpu::{LightBinding, PassTimer};
use common::{Light, Sky, View};
use glam::Vec3;

use crate::lighting::Lighting;
use crate::network::Network;
use crate::pipelines::Pipelines;
use crate::splats::{FrameGroups, Splats};
use crate::{Colours, Error, Options, Particles, Plan, Warning};

/// What a frame is drawn from; borrowed.
pub struct Inputs<'a> {
    /// The eye; of the size of depth and target. [`View::from_matrices`] makes it of your own matrices.
    pub view: &'a View,
    /// The lights, with the shadow maps of what else is in the scene: those of [`common::gpu::Ground`], or your own by
    /// [`common::gpu::ForeignMap`].
    pub lights: &'a [LightBinding],
    /// Light from all around.
    pub sky: &'a Sky,
    /// Depth of the scene from the eye: any depth format, standard or reversed, as [`View::depth`] says; see the crate's
    /// contract.
    pub depth: &'a wgpu::TextureView,
    /// Whether lights, or what casts their shadows, differ from the last frame's. If not, direct light is not found
    /// again.
    pub relight: bool,
    /// Steps of the iteration in this frame, each from where the last one ended.
    pub steps: u32,
    /// Residual at which this frame's steps end: what changed in a step over the sum of all radiance, at least 0; with 0
    /// all are taken.
    pub residual: f32,
}

/// Draws a cloud.
pub struct Renderer {
    options: Options,
    pipelines: Pipelines,
    loaded: Option<Loaded>,
    frame: Option<Frame>,
    warnings: Vec<Warning>,
}

struct Loaded {
    plan: Plan,
    /// Where the particles are \[m\], and how large.
    places: Vec<Vec3>,
    size: f32,
    network: Network,
    splats: Splats,
    sky: Option<Sky>,
    /// Whether all directions have been linked.
    linked: AtomicBool,
    /// The next direction that is linked anew when particles move, and how many are in the frame.
    next: u32,
    relink: u32,
}

/// What `encode` needs of a frame.
struct Frame {
    lights: Vec<wgpu::BindGroup>,
    relight: bool,
    steps: u32,
    relink: u32,
    groups: FrameGroups,
}

impl Renderer {
    /// Names of the passes, in order; links, light and steps come where there is something to do.
    pub const PASSES: &'static [&'static str] = &[
        "szk-network: link",
        "szk-network: light",
        "szk-network: iterate",
        "szk-network: view",
        "szk-network: splat",
    ];

    /// Compiles all pipelines.
    ///
    /// # Errors
    /// [`Error::Option`] for an option out of its range, [`Error::Target`] for a format that can't be blended into.
    pub fn new(device: &wgpu::Device, options: &Options) -> Result<Self, Error> {
        options.check()?;
        Splats::check_target(device, options.target_format)?;
        let pipelines = Pipelines::new(device, options);
        Ok(Self { options: *options, pipelines, loaded: None, frame: None, warnings: Vec::new() })
    }

    /// Takes a cloud, dark at first; it is linked in the next frame. What works, but not well, is in
    /// [`Renderer::warnings`].
    ///
    /// # Errors
    /// As [`Plan::new`], and [`Error::LimitExceeded`] where the device has no room. No cloud is loaded then.
    pub fn load(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        particles: &Particles,
    ) -> Result<(), Error> {
        (self.frame, self.loaded) = (None, None);
        self.warnings.clear();
        let plan = Plan::new(particles, &self.options)?;
        let network = Network::new(device, queue, particles, &plan, &self.options, &self.pipelines)?;
        let splats = Splats::new(device, queue, &self.pipelines, particles.list.len() as u32)?;
        let linked = AtomicBool::new(false);
        self.warnings.clone_from(&plan.warnings);
        let (places, size) = (places(particles), particles.mean_size());
        self.loaded =
            Some(Loaded { plan, places, size, network, splats, sky: None, linked, next: 0, relink: 0 });
        Ok(())
    }

    /// Moves the particles of an animated cloud. In the next frame `directions` of the directions are linked anew, in
    /// turn, so that all have been after D / `directions` frames; direct light has to be found again.
    ///
    /// # Errors
    /// [`Error::Count`] for another number of particles than was loaded, [`Error::Cloud`] for voxels of another number and for
    /// particles that [`Particles::new`] would refuse. The network stays as it was.
    pub fn update(
        &mut self,
        queue: &wgpu::Queue,
        particles: &Particles,
        directions: u32,
    ) -> Result<(), Error> {
        let Some(loaded) = &mut self.loaded else {
            return Err(Error::Count { found: particles.list.len(), expected: 0 });
        };
        let (found, expected) = (particles.list.len(), loaded.plan.depths.len());
        if found != expected {
            return Err(Error::Count { found, expected });
        }
        let (found, expected) = (particles.density.cells, loaded.network.cells());
        if found != expected {
            return Err(Error::Cloud {
                problem: format!("has {found} voxels, but {expected} were loaded; load the cloud anew"),
            });
        }
        if let Some(problem) = particles.problem() {
            return Err(Error::Cloud { problem });
        }
        // Windows stay as large as they are; whoever leaves them is in the pixels at their edge.
        loaded.places = places(particles);
        loaded.plan.depths = particles.list.iter().map(|p| p.cross_section() / loaded.plan.area).collect();
        loaded.network.uniform.low = particles.density.low;
        loaded.network.uniform.high = particles.density.high;
        loaded.network.uniform.sigma_t = particles.sigma_t;
        loaded.network.write_particles(queue, particles, &loaded.plan, &self.options);
        let directions =
            directions.min(loaded.network.linking.batch()).min(loaded.network.uniform.directions);
        loaded.relink = directions.min(loaded.network.uniform.directions - loaded.next);
        loaded.network.linking.choose(queue, loaded.next);
        Ok(())
    }

    /// What works, but not well, of the cloud that is loaded and of the frame prepared last.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// What was decided for the cloud that is loaded.
    pub fn plan(&self) -> Option<&Plan> {
        self.loaded.as_ref().map(|loaded| &loaded.plan)
    }

    /// Buffers of the network, of usage `COPY_SRC`; `None` before a cloud is loaded. Hidden: for tests and measuring, and
    /// laid out as the passes have it.
    #[doc(hidden)]
    pub fn buffers(&self) -> Option<Buffers<'_>> {
        self.loaded.as_ref().map(|Loaded { network, .. }| Buffers {
            neighbours: &network.neighbours,
            sources: &network.sources,
            incoming: &network.incoming,
            outgoing: &network.outgoing,
            state: &network.state,
            colours: network.colours(),
            bytes: network.bytes,
        })
    }

    /// Uploads what this frame needs; once per submit.
    ///
    /// # Errors
    /// [`Error::Coloured`] with one colour for a coloured light or sky, [`Error::Sky`], [`Error::Target`] for a view without
    /// pixels or too large, [`Error::LimitExceeded`] where the device has no room. Nothing is drawn of a frame that is
    /// refused.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        inputs: &Inputs<'_>,
    ) -> Result<(), Error> {
        // Nothing is drawn of a frame that is refused.
        self.frame = None;
        let Some(loaded) = &mut self.loaded else { return Ok(()) };
        let Inputs { view, sky, .. } = *inputs;
        common::gpu::Accumulator::check_size(device, (view.width, view.height))?;
        let lights: Vec<&Light> = inputs.lights.iter().map(|light| &light.light).collect();
        if self.options.colours == Colours::Grey {
            let grey = |colour: Vec3| colour == Vec3::splat(colour.x);
            if !lights.iter().all(|light| grey(strength(light))) {
                return Err(Error::Coloured { what: "a light" });
            }
            if let Sky::Constant(radiance) = sky
                && !grey(*radiance)
            {
                return Err(Error::Coloured { what: "the sky" });
            }
        }
        if let Some(problem) = sky.problem() {
            return Err(Error::Sky { problem });
        }
        self.warnings =
            loaded.plan.warnings.iter().cloned().chain(loaded.near(view.camera.eye, &lights)).collect();
        let count = lights.len() as u32;
        let fits = loaded.network.lighting.as_ref().is_some_and(|lighting| lighting.count == count);
        if !fits {
            let lighting = Lighting::new(device, queue, &self.pipelines, &loaded.network, count)?;
            loaded.network.uniform.lights = count;
            loaded.network.lighting = Some(lighting);
        }
        let relight = inputs.relight || !fits;
        if loaded.sky.as_ref() != Some(sky) {
            loaded.network.write_sky(queue, &loaded.plan.sky(sky));
            loaded.sky = Some(sky.clone());
        }
        loaded.network.uniform.tolerance = inputs.residual;
        loaded.network.cloud.write(queue, &loaded.network.uniform);
        // Whether the steps are done is known anew in every frame.
        queue.write_buffer(&loaded.network.state, 8, &[0; 8]);
        let groups = loaded.splats.prepare(device, queue, &loaded.network, view, &lights, inputs.depth)?;
        self.frame = groups.map(|groups| Frame {
            lights: inputs.lights.iter().map(|light| light.bind_group.clone()).collect(),
            relight,
            steps: inputs.steps,
            relink: std::mem::take(&mut loaded.relink),
            groups,
        });
        if let Some(frame) = &self.frame {
            loaded.next = (loaded.next + frame.relink) % loaded.network.uniform.directions;
        }
        Ok(())
    }

    /// Encodes all passes; the cloud is drawn over `target`. Nothing without a [`Renderer::prepare`].
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        let (Some(loaded), Some(frame)) = (&self.loaded, &self.frame) else { return };
        let Loaded { network, splats, .. } = loaded;
        let [link, light, iterate, view, splat] = [0, 1, 2, 3, 4].map(|pass| Self::PASSES[pass]);
        if !loaded.linked.swap(true, Ordering::Relaxed) {
            network.linking.encode_all(&mut begin_compute(encoder, link, timer));
        } else if frame.relink > 0 {
            network.linking.encode_some(&mut begin_compute(encoder, link, timer), frame.relink);
        }
        if let (true, Some(lighting)) = (frame.relight, &network.lighting) {
            lighting.encode(&mut begin_compute(encoder, light, timer), &frame.lights);
        }
        if frame.steps > 0 {
            network.encode_steps(&mut begin_compute(encoder, iterate, timer), frame.steps);
        }
        splats.encode_view(&mut begin_compute(encoder, view, timer), &frame.groups);
        splats.encode_splats(encoder, target, &frame.groups, splat, timer);
    }
}

/// Arrays of a network: direction by direction, in each particle by particle; of radiance colour by colour before that.
#[derive(Clone, Copy, Debug)]
pub struct Buffers<'a> {
    /// The particle before each, or `u32::MAX`; after all of them, where opacities are those of links, their bits.
    pub neighbours: &'a wgpu::Buffer,
    /// What particles radiate and scatter of direct light \[W m⁻² sr⁻¹\].
    pub sources: &'a wgpu::Buffer,
    /// Incoming radiance \[W m⁻² sr⁻¹\].
    pub incoming: &'a wgpu::Buffer,
    /// Outgoing radiance \[W m⁻² sr⁻¹\].
    pub outgoing: &'a wgpu::Buffer,
    /// Residual of the last step, steps taken, whether they were ended by the residual, steps of the last frame (f32
    /// each), and more.
    pub state: &'a wgpu::Buffer,
    /// Number of colours: 1 or 3.
    pub colours: u32,
    /// Bytes of networks and tables of scattering together: what [`Plan::bytes`] predicts.
    pub bytes: u64,
}

impl Loaded {
    /// What of eye and lights is too near to the particles.
    fn near(&self, eye: Vec3, lights: &[&Light]) -> Vec<Warning> {
        let nearest = |to: Vec3| {
            self.places.iter().map(|place| place.distance_squared(to)).fold(f32::INFINITY, f32::min).sqrt()
        };
        let mut warnings = Vec::new();
        let (distance, least) = (nearest(eye), Warning::LEAST_TO_EYE * self.size);
        if distance < least {
            warnings.push(Warning::EyeTooNear { distance, least });
        }
        let least = Warning::LEAST_TO_LIGHT * self.size;
        for (light, position) in
            lights.iter().enumerate().filter_map(|(i, light)| Some((i, light.position()?)))
        {
            let distance = nearest(position);
            if distance < least {
                warnings.push(Warning::LightTooNear { light, distance, least });
            }
        }
        warnings
    }
}

fn places(particles: &Particles) -> Vec<Vec3> {
    particles.list.iter().map(|particle| particle.position).collect()
}

fn strength(light: &Light) -> Vec3 {
    match light {
        Light::Point(light) => light.intensity,
        Light::Spot(light) => light.intensity,
        Light::Directional(light) => light.irradiance,
    }
}
