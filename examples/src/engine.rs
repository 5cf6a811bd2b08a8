//! The renderer: shadow maps, surfaces, and behind them whatever adds to the radiance.

use anyhow::{Result, ensure};
use glam::Vec4;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

use crate::depth::Depth;
use crate::fog::{Fog, Shafts};
use crate::passes::{Passes, begin, texture};
use crate::scene::{self, Moment, SIGMA_T, Vertex};

/// How the renderer is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// How it keeps depth.
    pub depth: Depth,
    /// Format of radiance: `Rgba16Float`, or `Rgba32Float` where the device blends it.
    pub radiance: wgpu::TextureFormat,
    /// Side of its shadow maps \[texels\].
    pub shadow_size: u32,
}

/// What a frame shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Show {
    /// Light in fog.
    pub shafts: Shafts,
    /// Whether anything casts shadows.
    pub casters: bool,
}

/// The renderer.
pub struct Engine {
    device: wgpu::Device,
    queue: wgpu::Queue,
    settings: Settings,
    passes: Passes,
    vertices: wgpu::Buffer,
    vertex_count: u32,
    bounds: (glam::Vec3, glam::Vec3),
    frame: wgpu::Buffer,
    lamp: ShadowMap,
    sun: ShadowMap,
    sampler: wgpu::Sampler,
    depth: wgpu::TextureView,
    radiance: wgpu::Texture,
    /// Made when it is switched on for the first time.
    fog: Option<Fog>,
}

/// A shadow map, and the matrix that it is drawn with.
struct ShadowMap {
    texture: wgpu::Texture,
    matrix: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// Vectors in the uniform block `Frame`.
const FRAME_VECTORS: usize = 18;

impl Engine {
    /// A renderer into pictures of `size` \[pixels\].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        settings: Settings,
        size: [u32; 2],
    ) -> Result<Self> {
        let blends = device.features().contains(wgpu::Features::FLOAT32_BLENDABLE);
        let wide = settings.radiance == wgpu::TextureFormat::Rgba32Float;
        ensure!(blends || !wide, "this adapter can't blend into 32-bit radiance; draw with --hdr 16");
        let vertices = scene::hall();
        let passes = Passes::new(device, settings.depth, settings.radiance);
        let [depth, radiance] = targets(device, settings, size);
        Ok(Self {
            vertices: device.create_buffer_init(&BufferInitDescriptor {
                label: Some("hall"),
                contents: bytemuck::cast_slice(&vertices),
                usage: wgpu::BufferUsages::VERTEX,
            }),
            vertex_count: vertices.len() as u32,
            bounds: scene::bounds(&vertices),
            frame: uniform(device, "frame", 16 * FRAME_VECTORS as u64),
            lamp: ShadowMap::new(device, &passes, settings, "lamp's shadow map"),
            sun: ShadowMap::new(device, &passes, settings, "sun's shadow map"),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("nearer than what casts"),
                compare: Some(settings.depth.nearer()),
                ..Default::default()
            }),
            depth: depth.create_view(&Default::default()),
            radiance,
            fog: None,
            device: device.clone(),
            queue: queue.clone(),
            settings,
            passes,
        })
    }

    /// Pictures have another size \[pixels\] from now on.
    pub fn resize(&mut self, size: [u32; 2]) {
        let [depth, radiance] = targets(&self.device, self.settings, size);
        self.depth = depth.create_view(&Default::default());
        self.radiance = radiance;
    }

    /// Size of pictures \[pixels\].
    pub fn size(&self) -> [u32; 2] {
        [self.radiance.width(), self.radiance.height()]
    }

    /// What has been drawn last: linear radiance \[W m⁻² sr⁻¹\].
    pub fn radiance(&self) -> &wgpu::Texture {
        &self.radiance
    }

    /// Draws the scene at a time \[s\] and submits it.
    pub fn draw(&mut self, time: f32, show: Show) -> Result<()> {
        let [width, height] = self.size();
        let moment = Moment::at(time, width as f32 / height as f32, self.settings.depth, self.bounds);
        self.queue.write_buffer(&self.frame, 0, bytemuck::cast_slice(&frame_block(&moment)));
        let mut encoder = self.device.create_command_encoder(&Default::default());
        for (map, matrix) in
            [(&self.lamp, moment.lamp.clip_from_world), (&self.sun, moment.sun.clip_from_world)]
        {
            self.queue.write_buffer(&map.matrix, 0, bytemuck::bytes_of(&matrix));
            self.draw_shadows(&mut encoder, map, show.casters);
        }
        let radiance = self.radiance.create_view(&Default::default());
        self.draw_surfaces(&mut encoder, &radiance);

        // Light in fog: two calls.
        let Shafts { lamp, sun } = show.shafts;
        if lamp || sun {
            let (device, queue) = (&self.device, &self.queue);
            let fog = match &mut self.fog {
                Some(fog) => fog,
                none => none.insert(Fog::new(
                    device,
                    queue,
                    self.settings.radiance,
                    [&self.lamp.texture, &self.sun.texture],
                )?),
            };
            fog.prepare(device, queue, &moment, &self.depth, show.shafts)?;
            fog.encode(&mut encoder, &radiance, show.shafts);
        }

        self.queue.submit([encoder.finish()]);
        Ok(())
    }

    fn draw_shadows(&self, encoder: &mut wgpu::CommandEncoder, map: &ShadowMap, casters: bool) {
        let view = map.texture.create_view(&Default::default());
        let mut pass = begin(encoder, "shadow map", None, Some((&view, self.settings.depth)));
        pass.set_pipeline(&self.passes.shadow);
        pass.set_bind_group(0, &map.group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.draw(0..if casters { self.vertex_count } else { 0 }, 0..1);
    }

    fn draw_surfaces(&self, encoder: &mut wgpu::CommandEncoder, radiance: &wgpu::TextureView) {
        let [lamp, sun] = [&self.lamp, &self.sun].map(|map| map.texture.create_view(&Default::default()));
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("surfaces"),
            layout: &self.passes.scene.get_bind_group_layout(0),
            entries: &[
                entry(0, self.frame.as_entire_binding()),
                entry(1, wgpu::BindingResource::TextureView(&lamp)),
                entry(2, wgpu::BindingResource::TextureView(&sun)),
                entry(3, wgpu::BindingResource::Sampler(&self.sampler)),
            ],
        });
        let mut pass = begin(encoder, "surfaces", Some(radiance), Some((&self.depth, self.settings.depth)));
        pass.set_pipeline(&self.passes.scene);
        pass.set_bind_group(0, &group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.draw(0..self.vertex_count, 0..1);
    }

    /// Shows what has been drawn last in `target`, by a pipeline of [`tone_pipeline`](crate::passes::tone_pipeline).
    pub fn show(&self, pipeline: &wgpu::RenderPipeline, target: &wgpu::TextureView) {
        let radiance = self.radiance.create_view(&Default::default());
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tone"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&radiance),
            }],
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = begin(&mut encoder, "tone", Some(target), None);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        self.queue.submit([encoder.finish()]);
    }
}

impl ShadowMap {
    fn new(device: &wgpu::Device, passes: &Passes, settings: Settings, label: &str) -> Self {
        let Settings { depth, shadow_size, .. } = settings;
        let usage = wgpu::TextureUsages::empty();
        let texture = texture(device, label, [shadow_size; 2], depth.format(), usage);
        let matrix = uniform(device, label, 64);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &passes.shadow.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: matrix.as_entire_binding() }],
        });
        Self { texture, matrix, group }
    }
}

fn uniform(device: &wgpu::Device, label: &str, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// The eye's depth and the radiance. Techniques read the one and add to the other.
fn targets(device: &wgpu::Device, settings: Settings, size: [u32; 2]) -> [wgpu::Texture; 2] {
    let Settings { depth, radiance, .. } = settings;
    [
        texture(device, "depth", size, depth.format(), wgpu::TextureUsages::empty()),
        texture(device, "radiance", size, radiance, wgpu::TextureUsages::COPY_SRC),
    ]
}

/// The uniform block `Frame`.
fn frame_block(moment: &Moment) -> [Vec4; FRAME_VECTORS] {
    let Moment { lamp, sun, .. } = moment;
    let matrices =
        [moment.clip_from_view * moment.view_from_world, lamp.clip_from_world, sun.clip_from_world];
    let [inner, outer] = lamp.angles;
    let vectors = [
        moment.eye.extend(SIGMA_T),
        lamp.position.extend(outer.cos()),
        lamp.direction.extend(inner.cos()),
        lamp.intensity.extend(0.0),
        sun.direction.extend(0.0),
        sun.irradiance.extend(0.0),
    ];
    let columns = matrices.iter().flat_map(|matrix| (0..4).map(|i| matrix.col(i)));
    let mut block = [Vec4::ZERO; FRAME_VECTORS];
    for (slot, vector) in block.iter_mut().zip(columns.chain(vectors)) {
        *slot = vector;
    }
    block
}

/// Bytes that a vertex has in its buffer.
const _: () = assert!(size_of::<Vertex>() == 36);
