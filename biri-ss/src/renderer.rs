//! The renderer: pipelines at creation, silhouettes and bindings by frame, passes into the caller's encoder.

use std::collections::HashMap;
use std::sync::Arc;

use common::gpu::passes::{Attachments, begin_pass, bind_group, drawn_texture};
use common::gpu::{Accumulator, MediumUniform, PassTimer, Uniform, Variant, ViewUniform};
use common::panels::panels_for;
use common::scene::Object;
use common::{Light, Medium, View, Warning};
use glam::Vec3;
use rayon::prelude::*;

use crate::connectivity::Connectivity;
use crate::gpu_tables::Tables;
use crate::light::{LightState, Volume};
use crate::pipelines::{Layouts, LightForm, Pipelines, RAYS, REFERENCE, STENCIL};
use crate::refuse::refuse;
use crate::shadows::{MOST_SHADOWS, Meshes};
use crate::silhouette::Origin;
use crate::{Airlight, Counting, Error, Options};

/// What a frame is drawn from; borrowed.
pub struct Inputs<'a> {
    /// The eye; of the size of depth and target. [`View::from_matrices`] makes it of your own matrices.
    pub view: &'a View,
    /// The medium.
    pub medium: &'a Medium,
    /// The lights.
    pub lights: &'a [Light],
    /// What casts shadows: all of it, also what the view does not show. An object is known by its mesh's
    /// address: give the same `Arc` every frame.
    pub casters: &'a [Object],
    /// Depth of the scene from the eye: any depth format, standard or reversed, as [`View::depth`] says; see the crate's
    /// contract.
    pub depth: &'a wgpu::TextureView,
    /// Surfaces; `None` if they are not to be lit.
    pub surfaces: Option<Surfaces<'a>>,
    /// Radiance that multiple scattering and emission would add up to in a medium without end, RGB
    /// \[W m⁻² sr⁻¹\]; zero without, and where there is no light.
    pub ambient: Vec3,
}

/// What the eye sees of the surfaces: textures of the view's size, of any float format.
#[derive(Clone, Copy)]
pub struct Surfaces<'a> {
    /// xyz: shading normal in the world, zero where there is no surface; w: Phong exponent.
    pub normal: &'a wgpu::TextureView,
    /// Diffuse reflectance, RGB in [0, 1].
    pub diffuse: &'a wgpu::TextureView,
    /// Specular reflectance, RGB in [0, 1].
    pub specular: &'a wgpu::TextureView,
    /// Whether [`Outputs::indirect`] is wanted.
    pub indirect: bool,
}

/// What the terms are added to: views of [`Options::target_format`] and of the view's size.
#[derive(Clone, Copy)]
pub struct Outputs<'a> {
    /// Airlight, and the ambient term along the ray.
    pub airlight: &'a wgpu::TextureView,
    /// Direct light on surfaces with shadows, and the ambient term on them; `None` if it is not wanted.
    pub surfaces: Option<&'a wgpu::TextureView>,
    /// Indirect single scattering on surfaces; `None` if it is not wanted.
    pub indirect: Option<&'a wgpu::TextureView>,
}

/// What a frame was made of.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Silhouette edges of all lights.
    pub silhouette_edges: usize,
    /// Shadow planes that they became, pieces of split ones counted each.
    pub planes: usize,
    /// Of these, drawn after culling; each as often as it counts.
    pub drawn: usize,
    /// Shadows that the eye is in, by light.
    pub eye_depths: Vec<u32>,
}

/// Draws single scattering.
pub struct Renderer {
    options: Options,
    layouts: Layouts,
    /// By what they are made for, once there is such a light.
    pipelines: HashMap<(LightForm, Variant), Pipelines>,
    accumulator: Accumulator,
    /// Where shadows are counted, of the accumulator's size.
    stencil: Option<wgpu::TextureView>,
    /// What the planes of each ray have in common, if they share it.
    rays: Option<Rays>,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    tables: Tables,
    meshes: Meshes,
    lights: Vec<LightState>,
    frame: Option<Frame>,
    warnings: Vec<Warning>,
}

/// Where planes are drawn.
#[derive(Clone, Copy)]
struct Sized<'a> {
    accumulated: &'a wgpu::TextureView,
    stencil: &'a wgpu::TextureView,
}

/// What the planes of each ray have in common: drawn for one light, then read by its planes.
struct Rays {
    view: wgpu::TextureView,
    group: wgpu::BindGroup,
}

/// Bindings of one frame.
struct Frame {
    group: wgpu::BindGroup,
    surfaces: Option<wgpu::BindGroup>,
    indirect: bool,
    ambient: bool,
}

impl Renderer {
    /// Names of the passes, in order; all but the first and the last come once for each light, the second with
    /// [`Counting::DepthFail`] only, the third with [`Options::shared_beginning`].
    pub const PASSES: &'static [&'static str] = &[
        "biri-ss: clear",
        "biri-ss: count shadows",
        "biri-ss: rays",
        "biri-ss: shadow planes",
        "biri-ss: light surfaces",
        "biri-ss: indirect light",
        "biri-ss: add airlight",
    ];

    /// Builds pipelines and all that no frame changes.
    ///
    /// # Errors
    /// [`Error::Option`] for an option out of its range, [`Error::Target`] for a format that can't be added to.
    pub fn new(device: &wgpu::Device, _queue: &wgpu::Queue, options: &Options) -> Result<Self, Error> {
        options.check()?;
        let Options { target_format, accumulation, clamp_negative, .. } = *options;
        let accumulator = Accumulator::new(device, target_format, accumulation, clamp_negative)?;
        let layouts = Layouts::new(device);
        Ok(Self {
            options: *options,
            pipelines: HashMap::new(),
            layouts,
            accumulator,
            stencil: None,
            rays: None,
            view: Uniform::new(device, "biri-ss: view"),
            medium: Uniform::new(device, "biri-ss: medium"),
            tables: Tables::default(),
            meshes: Meshes::default(),
            lights: Vec::new(),
            frame: None,
            warnings: Vec::new(),
        })
    }

    /// Allocates what depends on the size of the view \[pixels\]; [`Renderer::prepare`] calls it when the
    /// view has another size.
    pub fn resize(&mut self, device: &wgpu::Device, width: u32, height: u32) {
        let (size, usage) = ((width, height), wgpu::TextureUsages::empty());
        self.accumulator.resize(device, "biri-ss: accumulated airlight", size);
        let stencil = drawn_texture(device, "biri-ss: shadow counts", size, STENCIL, usage);
        self.stencil = Some(stencil.create_view(&Default::default()));
        self.rays = self.options.shared_beginning.then(|| {
            let usage = wgpu::TextureUsages::TEXTURE_BINDING;
            let rays = drawn_texture(device, "biri-ss: rays", size, RAYS, usage);
            let view = rays.create_view(&Default::default());
            let resources = [wgpu::BindingResource::TextureView(&view)];
            Rays { group: bind_group(device, "biri-ss: rays", &self.layouts.rays, resources), view }
        });
    }

    /// Finds silhouettes and uploads what this frame needs; once per submit. Refuses what the technique can't
    /// model.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a light or a caster that the technique can't model, [`Error::Target`] for a view without
    /// pixels or too large, [`Error::LimitExceeded`] where the device has no room. Nothing is drawn of a frame that is
    /// refused.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        inputs: &Inputs<'_>,
    ) -> Result<(), Error> {
        // Nothing is drawn of a frame that is refused half-way.
        self.frame = None;
        let View { width, height, .. } = *inputs.view;
        Accumulator::check_size(device, (width, height))?;
        let indirect = inputs.surfaces.is_some_and(|surfaces| surfaces.indirect);
        refuse(inputs, &self.options, indirect)?;
        let meshes = self.meshes.of(inputs.casters)?;
        if !self.accumulator.has_size((width, height)) {
            self.resize(device, width, height);
        }
        self.tables.prepare(device, queue, inputs.medium, &self.options, indirect);
        self.view.write(queue, &ViewUniform::from(inputs.view));
        self.medium.write(queue, &MediumUniform::from(inputs.medium));
        self.prepare_lights(device, queue, inputs, &meshes)?;
        let far = Warning::far_from_the_origin(inputs.view);
        self.warnings = far.into_iter().chain(self.uncounted()).collect();
        self.frame = self.bind(device, inputs, indirect);
        Ok(())
    }

    fn bind(&self, device: &wgpu::Device, inputs: &Inputs<'_>, indirect: bool) -> Option<Frame> {
        use wgpu::BindingResource::TextureView;
        let [tables, lambert, phong] = self.tables.views()?;
        let frame = bind_group(
            device,
            "biri-ss: frame",
            &self.layouts.frame,
            [
                self.view.buffer.as_entire_binding(),
                self.medium.buffer.as_entire_binding(),
                TextureView(inputs.depth),
                TextureView(tables),
            ],
        );
        let surfaces = inputs.surfaces.map(|surfaces| {
            let Surfaces { normal, diffuse, specular, .. } = surfaces;
            let views = [normal, diffuse, specular, lambert, phong].map(TextureView);
            bind_group(device, "biri-ss: surfaces", &self.layouts.surfaces, views)
        });
        Some(Frame { group: frame, surfaces, indirect, ambient: inputs.ambient != Vec3::ZERO })
    }

    fn prepare_lights(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        inputs: &Inputs<'_>,
        meshes: &[Arc<Connectivity>],
    ) -> Result<(), Error> {
        let least = match self.options.airlight {
            Airlight::Quadrature { panels } => panels,
            Airlight::Gamma { .. } | Airlight::GammaRest { .. } => 2,
        };
        let volume = Volume {
            panels: panels_for(&inputs.medium.phase, least),
            ambient: inputs.ambient,
            share: 1.0 / inputs.lights.len().max(1) as f32,
            column: column(inputs.medium),
        };
        let options = &self.options;
        self.lights.truncate(inputs.lights.len());
        while self.lights.len() < inputs.lights.len() {
            self.lights.push(LightState::new(device));
        }
        // Silhouettes and order of all lights side by side.
        self.lights.par_iter_mut().zip(inputs.lights).for_each(|(state, light)| {
            let reach = reach(light, inputs.medium, options.faintest, inputs.view.camera.eye);
            state.find(Origin::of(light), inputs.casters, meshes, inputs.view, options, reach);
        });
        for (state, light) in self.lights.iter_mut().zip(inputs.lights) {
            state.upload(device, queue, &self.layouts.light, light, inputs.view, &volume)?;
            let key = (light_form(light, inputs, options), Variant::new(light, inputs.medium));
            let (layouts, format) = (&self.layouts, self.accumulator.format());
            let make = || Pipelines::new(device, layouts, options, format, key);
            state.pipelines = Some(self.pipelines.entry(key).or_insert_with(make).clone());
        }
        Ok(())
    }

    /// Encodes all passes; each term is added to its output. Nothing without a [`Renderer::prepare`].
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, outputs: &Outputs<'_>, timer: &mut PassTimer) {
        let (Some(accumulated), Some(stencil)) = (self.accumulator.view(), &self.stencil) else { return };
        let Some(frame) = &self.frame else { return };
        let sized = Sized { accumulated, stencil };
        self.accumulator.encode_clear(encoder, Self::PASSES[0], timer);
        for light in &self.lights {
            let Some(pipelines) = &light.pipelines else { continue };
            match self.options.counting {
                Counting::FromEye => {
                    if let (Some([ray, _]), Some(rays)) = (&pipelines.shared, &self.rays) {
                        let target = Attachments::onto(&rays.view);
                        let mut pass = begin_pass(encoder, target, Self::PASSES[2], timer);
                        pass.set_bind_group(0, &frame.group, &[]);
                        pass.set_bind_group(1, light.group(), &[]);
                        draw_everywhere(&mut pass, ray);
                    }
                    let count = wgpu::LoadOp::Clear(light.eye_depth & 0xff);
                    let mut pass = self.ordered_pass(encoder, sized, frame, light, count, timer);
                    if let (Some([_, beginning]), Some(rays)) = (&pipelines.shared, &self.rays) {
                        pass.set_bind_group(2, &rays.group, &[]);
                        // The counts go from this one up and down, so planes add and take away by turns.
                        if light.eye_depth & 0xff == 0 {
                            draw_everywhere(&mut pass, beginning);
                        }
                    }
                    light.draw_planes(&mut pass, &pipelines.planes);
                    draw_everywhere(&mut pass, &pipelines.lit);
                    drop(pass);
                    self.encode_surfaces(encoder, sized, frame, (light, pipelines), outputs, timer);
                }
                Counting::DepthFail => {
                    self.encode_count(encoder, sized, frame, (light, pipelines), timer);
                    self.encode_surfaces(encoder, sized, frame, (light, pipelines), outputs, timer);
                    let mut pass = self.ordered_pass(encoder, sized, frame, light, wgpu::LoadOp::Load, timer);
                    draw_everywhere(&mut pass, &pipelines.lit);
                    light.draw_planes(&mut pass, &pipelines.planes);
                }
            }
        }
        let mut pass = begin_pass(encoder, Attachments::onto(outputs.airlight), Self::PASSES[6], timer);
        let first = self.lights.first().and_then(|light| Some((light, light.pipelines.as_ref()?)));
        if let (true, Some((light, pipelines))) = (frame.ambient, first) {
            pass.set_bind_group(0, &frame.group, &[]);
            pass.set_bind_group(1, light.group(), &[]);
            draw_everywhere(&mut pass, &pipelines.ambient);
        }
        self.accumulator.draw(&mut pass);
    }

    /// The pass in which planes pass or fail by the number of shadows.
    fn ordered_pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        sized: Sized<'_>,
        frame: &Frame,
        light: &LightState,
        count: wgpu::LoadOp<u32>,
        timer: &mut PassTimer,
    ) -> wgpu::RenderPass<'a> {
        let depth_stencil = Some(stencil(sized.stencil, Some(count)));
        let attachments = Attachments { depth_stencil, ..Attachments::onto(sized.accumulated) };
        let mut pass = begin_pass(encoder, attachments, Self::PASSES[3], timer);
        pass.set_bind_group(0, &frame.group, &[]);
        pass.set_bind_group(1, light.group(), &[]);
        pass.set_stencil_reference(REFERENCE);
        pass
    }

    /// Depth-fail: counts the shadow volumes' faces behind the scene.
    fn encode_count(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sized: Sized<'_>,
        frame: &Frame,
        (light, pipelines): (&LightState, &Pipelines),
        timer: &mut PassTimer,
    ) {
        let depth_stencil = Some(stencil(sized.stencil, Some(wgpu::LoadOp::Clear(0))));
        let attachments = Attachments { color: None, depth_stencil };
        let mut pass = begin_pass(encoder, attachments, Self::PASSES[1], timer);
        pass.set_bind_group(0, &frame.group, &[]);
        pass.set_bind_group(1, light.group(), &[]);
        pass.set_stencil_reference(REFERENCE);
        light.draw_whole(&mut pass, &pipelines.count_planes);
        light.draw_caps(&mut pass, &pipelines.count_caps);
    }

    /// Direct and indirect light; the stencil holds the shadows that each pixel's surface is in.
    fn encode_surfaces(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        sized: Sized<'_>,
        frame: &Frame,
        (light, pipelines): (&LightState, &Pipelines),
        outputs: &Outputs<'_>,
        timer: &mut PassTimer,
    ) {
        let Some(surfaces) = &frame.surfaces else { return };
        let bind = |pass: &mut wgpu::RenderPass<'_>| {
            pass.set_bind_group(0, &frame.group, &[]);
            pass.set_bind_group(1, light.group(), &[]);
            pass.set_bind_group(2, surfaces, &[]);
        };
        if let Some(target) = outputs.surfaces {
            let depth_stencil = Some(stencil(sized.stencil, None));
            let attachments = Attachments { depth_stencil, ..Attachments::onto(target) };
            let mut pass = begin_pass(encoder, attachments, Self::PASSES[4], timer);
            bind(&mut pass);
            pass.set_stencil_reference(REFERENCE);
            draw_everywhere(&mut pass, &pipelines.direct);
        }
        let ambient = outputs.surfaces.filter(|_| frame.ambient);
        let indirect = outputs.indirect.filter(|_| frame.indirect);
        for (target, pipeline) in [(ambient, &pipelines.ambient_surface), (indirect, &pipelines.indirect)] {
            if let Some(target) = target {
                let mut pass = begin_pass(encoder, Attachments::onto(target), Self::PASSES[5], timer);
                bind(&mut pass);
                draw_everywhere(&mut pass, pipeline);
            }
        }
    }

    /// What of the frame prepared last is drawn, but not well.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// More shadows over each other than the stencil counts.
    fn uncounted(&self) -> Option<Warning> {
        let depths = self.lights.iter().map(|light| light.eye_depth.max(light.shadows.deepest()));
        let depth = depths.max().unwrap_or(0);
        (depth > MOST_SHADOWS).then_some(Warning {
            parameter: "the number of one light's shadows over each other",
            value: depth.into(),
            bound: MOST_SHADOWS.into(),
            advice: "the stencil counts no farther; join the casters, or let fewer of them cast",
        })
    }

    /// What the frame prepared last was made of.
    pub fn statistics(&self) -> Statistics {
        Statistics {
            silhouette_edges: self.lights.iter().map(|light| light.shadows.edges()).sum(),
            planes: self.lights.iter().map(|light| light.shadows.pieces().len()).sum(),
            drawn: self.lights.iter().map(|light| light.drawn() as usize).sum(),
            eye_depths: self.lights.iter().map(|light| light.eye_depth).collect(),
        }
    }

    /// Mistakes in the order of the planes of the frame prepared last, for `eye` \[m\]: pairs that follow each
    /// other along some of `rays` half planes through light and eye but are drawn the other way round, all
    /// lights together. For measuring.
    pub fn order_violations(&self, eye: Vec3, rays: u32) -> usize {
        self.lights.iter().map(|light| light.shadows.violations(eye, rays)).sum()
    }
}

/// Mean cosine beyond which a lobe is integrated, because its peak falls between the texels of a table. (One that
/// points backwards peaks where the table holds little.)
const PEAKED: f64 = 0.955;

/// How the light's airlight is found: by table where it holds the light, the phase function and all optical depths. (`Γ` is
/// used for every phase function, as the paper does.)
fn light_form(light: &Light, inputs: &Inputs<'_>, options: &Options) -> LightForm {
    let medium = inputs.medium;
    let soft = matches!(light, Light::Spot(spot) if spot.inner_angle < spot.outer_angle);
    let peaked = medium.phase.lobes.iter().any(|(_, lobe)| lobe.mean_cosine() > PEAKED);
    // No ray is farther from a light than the eye is.
    let depth = |at: Vec3| f64::from(medium.sigma_t().max_element() * at.distance(inputs.view.camera.eye));
    let thick = light.position().is_some_and(|at| depth(at) > crate::table::AIRLIGHT_DOMAIN.1);
    match (light, options.airlight) {
        (Light::Directional(_), _) => LightForm::Directional,
        (_, Airlight::Gamma { .. }) if !thick => LightForm::Table,
        (_, Airlight::GammaRest { .. }) if !thick && !soft && !peaked => LightForm::Table,
        _ => LightForm::Integrated,
    }
}

/// Logarithms of the extinction coefficients, in lengths of the airlight table's first axis and from its beginning.
fn column(medium: &Medium) -> Vec3 {
    let (low, high) = crate::table::AIRLIGHT_DOMAIN;
    let place = |sigma: f32| ((f64::from(sigma).max(1e-30) / low).ln() / (high / low).ln()) as f32;
    medium.sigma_t().map(place)
}

/// How far from a light \[m\] casters matter: so far that only `faintest` of what gets to the eye gets there.
fn reach(light: &Light, medium: &Medium, faintest: f32, eye: Vec3) -> f64 {
    let sigma = f64::from(medium.sigma_t().min_element());
    if faintest == 0.0 || sigma == 0.0 || matches!(light, Light::Directional(_)) {
        return f64::INFINITY;
    }
    Origin::of(light).from(eye.as_dvec3()).length() - f64::from(faintest).ln() / sigma
}

fn draw_everywhere(pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
    pass.set_pipeline(pipeline);
    pass.draw(0..3, 0..1);
}

/// The stencil; without a load operation it is only read.
fn stencil(
    view: &wgpu::TextureView,
    load: Option<wgpu::LoadOp<u32>>,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let stencil_ops = load.map(|load| wgpu::Operations { load, store: wgpu::StoreOp::Store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops: None, stencil_ops }
}
