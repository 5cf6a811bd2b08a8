//! The ground that every technique stands on: shadow maps, depth and the surface pass of a frame.

use glam::Mat4;

use super::passes::{Attachments, begin_pass, bind_group, block, drawn_texture};
use super::pipelines::{Pipelines, shadow_pass_layout, surface_pass_layout};
use super::scene::SceneBuffers;
use super::shadow::{LightBinding, LightError, shadow_projection};
use super::uniforms::{MediumUniform, Uniform, ViewUniform};
use super::{PassTimer, Variant};
use crate::{DepthRange, Scene, View};

/// Format of all depth that is drawn here: reversed, infinite far plane.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Depth and radiance of a view's size.
pub struct Targets {
    /// [`DEPTH_FORMAT`]; may be bound as a texture and copied from.
    pub depth: wgpu::TextureView,
    /// Linear radiance \[W m⁻² sr⁻¹\]; may be copied from.
    pub radiance: wgpu::Texture,
    /// View of `radiance`.
    pub radiance_view: wgpu::TextureView,
}

impl Targets {
    /// Targets of `width` × `height` pixels with radiance in `format`.
    pub fn new(device: &wgpu::Device, width: u32, height: u32, format: wgpu::TextureFormat) -> Self {
        let texture = |label, format, usage| {
            let usage = usage | wgpu::TextureUsages::TEXTURE_BINDING;
            drawn_texture(device, label, (width, height), format, usage)
        };
        let depth = texture("common: depth", DEPTH_FORMAT, wgpu::TextureUsages::COPY_SRC);
        let radiance = texture("common: radiance", format, wgpu::TextureUsages::COPY_SRC);
        let radiance_view = radiance.create_view(&Default::default());
        Self { depth: depth.create_view(&Default::default()), radiance, radiance_view }
    }

    /// Encodes the clearing of radiance to black.
    pub fn encode_clear(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("common: clear"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.radiance_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
    }
}

/// What a deferred pass needs of the surfaces that the eye sees: three textures of a view's size, zero where
/// there is no surface.
pub struct SurfaceData {
    /// xyz: unit shading normal in the world; w: Phong exponent.
    pub normal: wgpu::TextureView,
    /// Diffuse reflectance, RGB.
    pub diffuse: wgpu::TextureView,
    /// Specular reflectance, RGB.
    pub specular: wgpu::TextureView,
}

impl SurfaceData {
    pub(super) const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

    /// Textures of `width` × `height` pixels.
    pub fn new(device: &wgpu::Device, width: u32, height: u32) -> Self {
        let texture = |label| {
            let usage = wgpu::TextureUsages::TEXTURE_BINDING;
            drawn_texture(device, label, (width, height), Self::FORMAT, usage)
                .create_view(&Default::default())
        };
        let [normal, diffuse, specular] =
            ["common: normals", "common: diffuse reflectance", "common: specular reflectance"].map(texture);
        Self { normal, diffuse, specular }
    }
}

/// A shadow map's texture, as one array and layer by layer.
pub(super) struct ShadowTexture {
    pub(super) array: wgpu::TextureView,
    pub(super) layers: Vec<wgpu::TextureView>,
}

/// Pipelines and buffers for the depth, the shadow maps and the surfaces of one scene.
pub struct Ground {
    scene: SceneBuffers,
    view: Uniform<ViewUniform>,
    medium: Uniform<MediumUniform>,
    projections: wgpu::Buffer,
    shadow_textures: Vec<ShadowTexture>,
    shadow_size: u32,
    lights: Vec<LightBinding>,
    shadow_group: wgpu::BindGroup,
    surface_group: wgpu::BindGroup,
    pipelines: Pipelines,
    /// What lights surfaces, of each light.
    lit_pipelines: Vec<wgpu::RenderPipeline>,
}

/// Bytes between two projections in their buffer: the largest alignment that a device may ask for.
const PROJECTION_STRIDE: u64 = 256;

impl Ground {
    /// Names of the passes, in order.
    pub const PASSES: [&'static str; 4] = [
        "common: draw shadow maps",
        "common: draw depth",
        "common: light surfaces",
        "common: draw surface data",
    ];

    /// Uploads `scene` and builds all that does not change by frame. Radiance targets will be of
    /// `format`; shadow maps of `shadow_size`² texels (2 up to the device's limit).
    ///
    /// # Errors
    /// [`LightError::Size`] and [`LightError::TooManyTriangles`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &Scene,
        format: wgpu::TextureFormat,
        shadow_size: u32,
    ) -> Result<Self, LightError> {
        let limit = device.limits().max_texture_dimension_2d;
        if !(2..=limit).contains(&shadow_size) {
            return Err(LightError::Size { size: shadow_size, limit });
        }
        let buffers = SceneBuffers::new(device, queue, scene)
            .ok_or(LightError::TooManyTriangles { triangles: scene.triangle_count() })?;
        let layer_counts: Vec<u32> =
            scene.lights.iter().map(|light| if light.kind() == "point" { 6 } else { 1 }).collect();
        let total: u64 = layer_counts.iter().map(|&n| u64::from(n)).sum();
        let projections = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("common: shadow projections"),
            size: total.max(1) * PROJECTION_STRIDE,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let view = Uniform::new(device, "common: view");
        let medium = Uniform::new(device, "common: medium");

        let (shadow_layout, surface_layout) = (shadow_pass_layout(device), surface_pass_layout(device));
        let (objects, materials) = (buffers.objects(), buffers.materials());
        let shadow_group = bind_group(
            device,
            "common: shadow pass",
            &shadow_layout,
            [block(&projections, 64), objects.as_entire_binding()],
        );
        let surface_group = bind_group(
            device,
            "common: surface pass",
            &surface_layout,
            [&view.buffer, objects, materials, &medium.buffer].map(wgpu::Buffer::as_entire_binding),
        );
        Ok(Self {
            scene: buffers,
            view,
            medium,
            projections,
            shadow_textures: layer_counts.iter().map(|&n| shadow_texture(device, shadow_size, n)).collect(),
            shadow_size,
            lights: Vec::new(),
            shadow_group,
            surface_group,
            pipelines: Pipelines::new(device, &shadow_layout, &surface_layout, format),
            lit_pipelines: Vec::new(),
        })
    }

    /// Puts everything into its place for a frame: `scene` is the one of [`Ground::new`] at any time, and the view's
    /// depth is [`DepthRange::reversed`]. One call per submit.
    ///
    /// # Errors
    /// [`LightError::Invalid`], for a light that is not valid at this time.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &Scene,
        view: &View,
    ) -> Result<(), LightError> {
        for (index, light) in scene.lights.iter().enumerate() {
            if let Some(problem) = light.problem() {
                return Err(LightError::Invalid { index, kind: light.kind(), problem });
            }
        }
        if view.depth != DepthRange::reversed(view.depth.near) {
            return Err(LightError::Depth);
        }
        self.scene.update(queue, scene);
        self.view.write(queue, &ViewUniform::from(view));
        self.medium.write(queue, &MediumUniform::from(&scene.medium));
        let bounds = scene.bounds();
        self.lights = scene
            .lights
            .iter()
            .zip(&self.shadow_textures)
            .map(|(light, texture)| {
                let projection = shadow_projection(light, bounds, self.shadow_size);
                LightBinding::new(device, queue, light, projection, &texture.array)
            })
            .collect();
        let pipelines = &mut self.pipelines;
        self.lit_pipelines = scene
            .lights
            .iter()
            .map(|light| pipelines.lit(device, Variant::new(light, &scene.medium)))
            .collect();
        let layers = self.lights.iter().flat_map(|light| &light.projection.layers);
        for (index, layer) in layers.enumerate() {
            let bytes: &[Mat4] = &[layer.clip_from_world];
            queue.write_buffer(
                &self.projections,
                index as u64 * PROJECTION_STRIDE,
                bytemuck::cast_slice(bytes),
            );
        }
        Ok(())
    }

    /// The lights of the prepared frame, with their shadow maps.
    pub fn lights(&self) -> &[LightBinding] {
        &self.lights
    }

    /// Draws all shadow maps.
    pub fn encode_shadows(&self, encoder: &mut wgpu::CommandEncoder, timer: &mut PassTimer) {
        let layers = self.shadow_textures.iter().flat_map(|texture| &texture.layers);
        for (index, layer) in layers.enumerate() {
            let mut pass = depth_only_pass(encoder, layer, Self::PASSES[0], timer);
            pass.set_pipeline(&self.pipelines.shadow);
            pass.set_bind_group(0, &self.shadow_group, &[(index as u64 * PROJECTION_STRIDE) as u32]);
            self.scene.draw(&mut pass);
        }
    }

    /// Draws the depth that the eye sees; cleared first.
    pub fn encode_depth(&self, encoder: &mut wgpu::CommandEncoder, targets: &Targets, timer: &mut PassTimer) {
        let mut pass = depth_only_pass(encoder, &targets.depth, Self::PASSES[1], timer);
        pass.set_pipeline(&self.pipelines.depth);
        pass.set_bind_group(0, &self.surface_group, &[]);
        self.scene.draw(&mut pass);
    }

    /// Adds the `surface` term to the radiance; depth and shadow maps have been drawn.
    pub fn encode_surfaces(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        timer: &mut PassTimer,
    ) {
        let attachments = Attachments {
            depth_stencil: Some(read_depth(&targets.depth)),
            ..Attachments::onto(&targets.radiance_view)
        };
        let mut pass = begin_pass(encoder, attachments, Self::PASSES[2], timer);
        pass.set_bind_group(0, &self.surface_group, &[]);
        for (light, pipeline) in self.lights.iter().zip(&self.lit_pipelines) {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, &light.bind_group, &[]);
            self.scene.draw(&mut pass);
        }
    }
}

impl Ground {
    /// Draws what a deferred pass needs; depth has been drawn.
    pub fn encode_surface_data(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        data: &SurfaceData,
        timer: &mut PassTimer,
    ) {
        let attachments = [&data.normal, &data.diffuse, &data.specular].map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(Self::PASSES[3]),
            color_attachments: &attachments,
            depth_stencil_attachment: Some(read_depth(&targets.depth)),
            timestamp_writes: timer.render(Self::PASSES[3]),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipelines.surface_data);
        pass.set_bind_group(0, &self.surface_group, &[]);
        self.scene.draw(&mut pass);
    }
}

pub(super) fn shadow_texture(device: &wgpu::Device, size: u32, layers: u32) -> ShadowTexture {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("common: shadow map"),
        size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH_FORMAT,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let array = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    let layer = |base_array_layer| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    };
    ShadowTexture { array, layers: (0..layers).map(layer).collect() }
}

pub(super) fn depth_only_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    depth: &wgpu::TextureView,
    label: &'static str,
    timer: &mut PassTimer,
) -> wgpu::RenderPass<'a> {
    let cleared = wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store };
    let depth_stencil = Some(wgpu::RenderPassDepthStencilAttachment {
        view: depth,
        depth_ops: Some(cleared),
        stencil_ops: None,
    });
    begin_pass(encoder, Attachments { color: None, depth_stencil }, label, timer)
}

fn read_depth(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops: None, stencil_ops: None }
}
