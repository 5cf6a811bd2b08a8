//! The renderer: what is common to both ways to the lit volume, and the choice between them.

use common::gpu::{LightBinding, PassTimer, coarse_map};
use common::{Light, Medium, View, Warning};

use crate::mesh::{self, Mesh};
use crate::rays::{self, Rays};
use crate::{Error, Options, Volume};

/// Optical depth from the eye to the lights beyond which differences of the mesh's faces are rounding.
const MOST_OPAQUE: f64 = 40.0;

/// What a frame is drawn from; borrowed.
pub struct Inputs<'a> {
    /// The eye; of the size of depth and target. [`View::from_matrices`] makes it of your own matrices.
    pub view: &'a View,
    /// The medium.
    pub medium: &'a Medium,
    /// The lights, with their shadow maps: those of [`common::gpu::Ground`], or your own by
    /// [`common::gpu::ForeignMap`].
    pub lights: &'a [LightBinding],
    /// Depth of the scene from the eye: any depth format, standard or reversed, as [`View::depth`] says; see the crate's
    /// contract.
    pub depth: &'a wgpu::TextureView,
}

/// Draws airlight by the lit volume of a shadow map.
pub struct Renderer {
    drawing: Drawing,
    /// Whether there is a frame to draw: nothing is drawn of one that was refused.
    prepared: bool,
    warnings: Vec<Warning>,
}

enum Drawing {
    Mesh(Box<Mesh>),
    Rays(Box<Rays>),
}

impl Renderer {
    /// Names of the passes, in order. [`Volume::Mesh`] has the first five, of which the middle three come once for
    /// each projection of each light; [`Volume::Rays`] has the last two, once for each light.
    pub const PASSES: &'static [&'static str] = &[
        mesh::PASSES[0],
        mesh::PASSES[1],
        mesh::PASSES[2],
        mesh::PASSES[3],
        mesh::PASSES[4],
        rays::PASSES[0],
        rays::PASSES[1],
    ];

    /// Builds pipelines and all that no frame changes.
    ///
    /// # Errors
    /// [`Error::Option`] for an option out of its range, [`Error::Target`] for a format that can't be added to,
    /// [`Error::LimitExceeded`] where the device has no room.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, options: &Options) -> Result<Self, Error> {
        options.check()?;
        let drawing = match options.volume {
            Volume::Mesh => Drawing::Mesh(Box::new(Mesh::new(device, queue, options)?)),
            Volume::Rays => Drawing::Rays(Box::new(Rays::new(device, options)?)),
        };
        Ok(Self { drawing, prepared: false, warnings: Vec::new() })
    }

    /// Allocates what depends on the size of the view \[pixels\]; [`Renderer::prepare`] calls it when the
    /// view has another size.
    pub fn resize(&mut self, device: &wgpu::Device, width: u32, height: u32) {
        if let Drawing::Mesh(mesh) = &mut self.drawing {
            mesh.resize(device, width, height);
        }
    }

    /// Uploads what this frame needs; once per submit. Refuses what the technique can't model.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a light that the technique can't model, [`Error::Target`] for a view without pixels or too
    /// large, [`Error::LimitExceeded`] where the device has no room. Nothing is drawn of a frame that is refused.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        inputs: &Inputs<'_>,
    ) -> Result<(), Error> {
        self.prepared = false;
        for (light, binding) in inputs.lights.iter().enumerate() {
            if matches!(&binding.light, Light::Spot(spot) if spot.light_map.is_some()) {
                let what = "it carries a light map, which an integral over the angle at the light can't \
                            resolve; take the map away";
                return Err(Error::Unsupported { light, what });
            }
        }
        let lights = || inputs.lights.iter().map(|light| &light.light);
        let opaque = match self.drawing {
            Drawing::Mesh(_) => Warning::opaque(inputs.medium, inputs.view, lights(), MOST_OPAQUE),
            Drawing::Rays(_) => None,
        };
        let far = Warning::far_from_the_origin(inputs.view);
        self.warnings = [far, coarse_map(inputs.lights, inputs.view), opaque].into_iter().flatten().collect();
        match &mut self.drawing {
            Drawing::Mesh(mesh) => mesh.prepare(device, queue, inputs)?,
            Drawing::Rays(rays) => rays.prepare(device, queue, inputs)?,
        }
        self.prepared = true;
        Ok(())
    }

    /// What of the frame prepared last is drawn, but not well.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Encodes all passes; airlight is added to `target`. Nothing without a [`Renderer::prepare`].
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        timer: &mut PassTimer,
    ) {
        if !self.prepared {
            return;
        }
        match &self.drawing {
            Drawing::Mesh(mesh) => mesh.encode(encoder, target, timer),
            Drawing::Rays(rays) => rays.encode(encoder, target, timer),
        }
    }

    /// Triangles of the adaptive meshes that were drawn last, all projections of all lights together and
    /// without the walls that close them; `None` where there is no mesh or all are full. Waits for the device:
    /// for measuring, not for frames.
    pub fn read_adaptive_triangles(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Option<u32> {
        match &self.drawing {
            Drawing::Mesh(mesh) => mesh.read_adaptive_triangles(device, queue),
            Drawing::Rays(_) => None,
        }
    }
}
