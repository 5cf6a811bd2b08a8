//! The network on the device: particles, links, direct light and the steps of the iteration.

use common::cloud::Grid;
use common::gpu::passes::{binding, compute_pipeline, numbered_group, pipeline_layout, shader_module};
use common::gpu::{LimitExceeded, Uniform, light_layout, make_buffer};
use encase::ShaderType;
use glam::{UVec3, Vec3};

use crate::directions::{depth_levels, pixel_bits};
use crate::plan::self_share;
use crate::sort::{Sorter, padded};
use crate::{Colours, Incidence, Kernel, Opacity, Options, Particles, Plan, Scattering, shaders};

/// Most bytes of what is sorted at a time.
const SORT_BYTES: u64 = 64 << 20;

/// Directions that an invocation goes through: `CHUNK` of the shader.
const CHUNK: u32 = 32;

/// Pairs of the state in front of what is added up.
const STATE: u64 = 2;

/// Twin of WGSL `Cloud`.
#[derive(Clone, Copy, Debug, ShaderType)]
pub(crate) struct CloudUniform {
    pub(crate) centre: Vec3,
    pub(crate) radius: f32,
    pub(crate) low: Vec3,
    pub(crate) count: u32,
    pub(crate) high: Vec3,
    pub(crate) directions: u32,
    pub(crate) sigma_t: f32,
    pub(crate) pixels: u32,
    pub(crate) pixel_bits: u32,
    pub(crate) levels: f32,
    pub(crate) overlap: f32,
    pub(crate) lights: u32,
    pub(crate) blocks: u32,
    pub(crate) tolerance: f32,
}

/// Twin of WGSL `Batch`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct BatchUniform {
    first: u32,
    length: u32,
}

/// Twin of WGSL `Turn`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct TurnUniform {
    index: u32,
}

/// Twin of WGSL `Particle`.
pub(crate) type ParticleData = [f32; 16];

/// Everything of a cloud that stays on the device.
pub(crate) struct Network {
    pub(crate) uniform: CloudUniform,
    pub(crate) cloud: Uniform<CloudUniform>,
    pub(crate) particles: wgpu::Buffer,
    pub(crate) windows: wgpu::Buffer,
    pub(crate) phase_tables: wgpu::Buffer,
    pub(crate) density: wgpu::TextureView,
    density_texture: wgpu::Texture,
    pub(crate) sampler: wgpu::Sampler,
    pub(crate) neighbours: wgpu::Buffer,
    pub(crate) opacities: wgpu::Buffer,
    pub(crate) sources: wgpu::Buffer,
    pub(crate) incoming: wgpu::Buffer,
    pub(crate) outgoing: wgpu::Buffer,
    pub(crate) state: wgpu::Buffer,
    sky: wgpu::Buffer,
    linking: Linking,
    steps: Vec<(wgpu::ComputePipeline, wgpu::BindGroup, [u32; 3])>,
    pub(crate) lighting: Option<Lighting>,
    light_pipelines: LightPipelines,
    cells: UVec3,
    /// Voxels that light is found in: half as fine.
    lit_cells: UVec3,
    colours: u32,
}

struct Linking {
    keys: wgpu::ComputePipeline,
    links: wgpu::ComputePipeline,
    sorter: Sorter,
    length: u32,
    /// Directions at a time.
    size: u32,
    /// Groups of both pipelines for each batch; the last one is written before it is used.
    batches: Vec<[wgpu::BindGroup; 2]>,
    moving: Uniform<BatchUniform>,
}

struct LightPipelines {
    voxels_group: wgpu::BindGroupLayout,
    voxels: wgpu::ComputePipeline,
    arrivals_group: wgpu::BindGroupLayout,
    arrivals: wgpu::ComputePipeline,
    sums: [wgpu::ComputePipeline; 2],
    scale: wgpu::ComputePipeline,
    sources: wgpu::ComputePipeline,
}

/// What depends on the number of lights.
pub(crate) struct Lighting {
    pub(crate) count: u32,
    pub(crate) lit: wgpu::TextureView,
    pub(crate) arrivals: wgpu::Buffer,
    /// For each light: groups of voxels, their sum, arrivals, their sum, and scaling.
    turns: Vec<[wgpu::BindGroup; 5]>,
    sources: wgpu::BindGroup,
}

/// Bytes of a particle as shaders see it.
pub(crate) fn particle_data(particles: &Particles, plan: &Plan, options: &Options) -> Vec<ParticleData> {
    particles
        .list
        .iter()
        .zip(&plan.depths)
        .map(|(particle, &depth)| {
            let again = if options.opacity == Opacity::Particle { self_share(depth) } else { 0.0 };
            let emission = particle.emission * particle.volume() / plan.area;
            let Vec3 { x, y, z } = particle.position;
            let [r, g, b] = particle.albedo.to_array();
            let [e_r, e_g, e_b] = emission.to_array();
            [
                x,
                y,
                z,
                0.5 * particle.size,
                r,
                g,
                b,
                particle.cross_section(),
                e_r,
                e_g,
                e_b,
                f32::from_bits(particle.phase),
                depth,
                -(-depth).exp_m1(),
                again,
                0.0,
            ]
        })
        .collect()
}

/// Voxels as a texture: density, the correction of splats, and whether there is medium in reach of interpolation.
fn voxel_data(particles: &Particles, options: &Options) -> Vec<u16> {
    let grid = &particles.density;
    let smoothed = particles.smoothed(grid, options.overlap, 0.0);
    let near = near_medium(grid);
    let mut data = Vec::with_capacity(4 * grid.values.len());
    for ((&value, smooth), near) in grid.values.iter().zip(smoothed).zip(near) {
        let wanted = value * particles.sigma_t;
        // Particles without voxels of their own are as they are.
        let correction = match particles.sampled {
            // Where splats hardly reach, no factor makes up for it.
            true if smooth > 0.0 => (wanted / smooth).min(MOST_CORRECTION),
            true => 0.0,
            false => 1.0,
        };
        data.extend(
            [value, correction, f32::from(u8::from(near)), 0.0].map(|v| half::f16::from_f32(v).to_bits()),
        );
    }
    data
}

/// Whether there is medium within two voxels: one of the coarser ones that light is found in.
fn near_medium(grid: &Grid) -> Vec<bool> {
    let mut near: Vec<bool> = grid.values.iter().map(|value| *value > 0.0).collect();
    let [x, y, z] = grid.cells.to_array().map(|n| n as usize);
    for (stride, length) in [(1, x), (x, y), (x * y, z)] {
        let before = near.clone();
        for (index, near) in near.iter_mut().enumerate() {
            let at = index / stride % length;
            let from = index - at.min(2) * stride;
            *near = (0..=at.min(2) + (length - 1 - at).min(2)).any(|i| before[from + i * stride]);
        }
    }
    near
}

/// Splats are made at most so much denser.
const MOST_CORRECTION: f32 = 4.0;

impl Network {
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        particles: &Particles,
        plan: &Plan,
        options: &Options,
    ) -> Result<Self, LimitExceeded> {
        let (count, directions) = (particles.list.len() as u32, plan.windows.len() as u32);
        let colours = if options.colours == Colours::Grey { 1 } else { 3 };
        let links = u64::from(count) * u64::from(directions);
        let bits = pixel_bits(plan.pixels);
        let blocks = match &plan.kernel {
            Kernel::Matrices { .. } => 0,
            Kernel::Components(sets) => {
                sets.iter().map(|set| set.values.len().div_ceil(4)).max().unwrap_or(0) as u32
            }
        };
        let grid = &particles.density;
        let uniform = CloudUniform {
            centre: plan.centre,
            radius: plan.radius,
            low: grid.low,
            count,
            high: grid.high,
            directions,
            sigma_t: particles.sigma_t,
            pixels: plan.pixels,
            pixel_bits: bits,
            levels: depth_levels(bits),
            overlap: options.overlap,
            lights: 0,
            blocks,
            tolerance: 0.0,
        };
        let storage =
            wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC;
        let sized = |label, bytes: u64| make_buffer(device, label, bytes.max(16), storage);
        let filled = |label, bytes: &[u8]| {
            let buffer = sized(label, bytes.len() as u64)?;
            queue.write_buffer(&buffer, 0, bytes);
            Ok(buffer)
        };
        let network_bytes = 4 * links * colours;
        let sources = sized("sources", network_bytes)?;
        let incoming = sized("incoming radiance", network_bytes)?;
        let outgoing = sized("outgoing radiance", network_bytes)?;
        let neighbours = sized("neighbours", 4 * links)?;
        let opacities = sized("opacities", if options.opacity == Opacity::Link { 4 * links } else { 0 })?;
        let window = |w: &crate::Window| {
            let [d, r, u] = [w.direction, w.right, w.up].map(|v| v.extend(0.0).to_array());
            [d, r, u, [w.offset.x, w.offset.y, 0.0, 0.0]]
        };
        let windows: Vec<_> = plan.windows.iter().map(window).collect();
        let windows = filled("windows", bytemuck::cast_slice(&windows))?;
        let particle_buffer =
            filled("particles", bytemuck::cast_slice(&particle_data(particles, plan, options)))?;
        let phase_tables = filled("phase functions", bytemuck::cast_slice(&plan.phase_tables.concat()))?;
        let uniform_usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let sky = make_buffer(device, "sky", 16 * u64::from(Options::MOST_DIRECTIONS), uniform_usage)?;
        let (factors, matrices) = kernel_data(&plan.kernel, directions, blocks);
        let factors = filled("components", bytemuck::cast_slice(&factors))?;
        let matrices = filled("matrices", bytemuck::cast_slice(&matrices))?;
        let moments = sized("moments", 16 * u64::from(count * blocks) * colours)?;
        let workgroups = count.div_ceil(64);
        let chunks = directions.div_ceil(CHUNK);
        let state = sized("state", 8 * (STATE + u64::from(count) * u64::from(chunks) * colours))?;
        let collisions = sized("collisions", network_bytes)?;

        let cloud = Uniform::new(device, "szk-network: cloud");
        cloud.write(queue, &uniform);
        let density_texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("szk-network: density"),
            size: extent(grid.cells),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        write_voxels(queue, &density_texture, particles, options);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("szk-network: linear"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });

        let linking = Linking::new(
            device,
            queue,
            options,
            (count, directions),
            [&cloud.buffer, &particle_buffer, &windows, &neighbours, &opacities],
        )?;

        let flags = [
            ("per_link", f64::from(u8::from(options.opacity == Opacity::Link))),
            (
                "by_colour",
                f64::from(u8::from(matches!(plan.kernel, Kernel::Matrices { by_colour: true, .. }))),
            ),
        ];
        let module = shader_module(device, "szk-network: scatter", shaders::scatter());
        let mut steps = Vec::new();
        let mut step = |entry, bindings: &[u32], dispatch| {
            let pipeline = compute_pipeline(device, &module, None, entry, &flags);
            let all = [
                &cloud.buffer,
                &particle_buffer,
                &neighbours,
                &opacities,
                &sky,
                &sources,
                &incoming,
                &outgoing,
                &factors,
                &moments,
                &matrices,
                &state,
                &collisions,
            ];
            let resources: Vec<_> =
                bindings.iter().map(|&b| (b, all[b as usize].as_entire_binding())).collect();
            let group = numbered_group(device, entry, &pipeline.get_bind_group_layout(0), &resources);
            steps.push((pipeline, group, dispatch));
        };
        let colour_count = colours as u32;
        let every_chunk = [workgroups, chunks, colour_count];
        step("cs_propagate", &[0, 1, 2, 3, 4, 5, 6, 7, 11, 12], every_chunk);
        step("cs_residual", &[0, 11], [1, 1, 1]);
        match (&plan.kernel, options.scattering) {
            (Kernel::Components(_), _) => {
                let groups = [workgroups, blocks.div_ceil(3), colour_count];
                step("cs_moments", &[0, 1, 8, 9, 11, 12], groups);
                step("cs_expand", &[0, 1, 3, 5, 6, 7, 8, 9, 11], every_chunk);
            }
            (Kernel::Matrices { .. }, scattering) => {
                let fours = directions.div_ceil(4);
                let (entry, dispatch) = match scattering {
                    Scattering::Tiled => ("cs_tiled", [count.div_ceil(16), fours.div_ceil(16), colour_count]),
                    _ => ("cs_full", [workgroups, fours, colour_count]),
                };
                step(entry, &[0, 1, 3, 5, 6, 7, 10, 11, 12], dispatch);
            }
        }
        let light_pipelines = LightPipelines::new(device, options, &module, &flags);
        Ok(Self {
            uniform,
            cloud,
            particles: particle_buffer,
            windows,
            phase_tables,
            density: density_texture.create_view(&Default::default()),
            density_texture,
            sampler,
            neighbours,
            opacities,
            sources,
            incoming,
            outgoing,
            state,
            sky,
            linking,
            steps,
            lighting: None,
            light_pipelines,
            cells: grid.cells,
            lit_cells: (grid.cells + 1) / 2,
            colours: colour_count,
        })
    }

    /// New places of the same particles.
    pub(crate) fn write_particles(
        &self,
        queue: &wgpu::Queue,
        particles: &Particles,
        plan: &Plan,
        options: &Options,
    ) {
        let data = particle_data(particles, plan, options);
        queue.write_buffer(&self.particles, 0, bytemuck::cast_slice(&data));
        write_voxels(queue, &self.density_texture, particles, options);
    }

    /// Radiance of the sky by direction.
    pub(crate) fn write_sky(&self, queue: &wgpu::Queue, sky: &[Vec3]) {
        let data: Vec<_> = sky.iter().map(|radiance| radiance.extend(0.0).to_array()).collect();
        queue.write_buffer(&self.sky, 0, bytemuck::cast_slice(&data));
    }

    /// Directions that are linked at a time.
    pub(crate) fn batch(&self) -> u32 {
        self.linking.size
    }

    /// Which directions [`Network::encode_links_of`] links, from the first on.
    pub(crate) fn choose_links(&self, queue: &wgpu::Queue, first: u32) {
        self.linking.moving.write(queue, &BatchUniform { first, length: self.linking.length });
    }

    /// Links all directions.
    pub(crate) fn encode_links(&self, pass: &mut wgpu::ComputePass<'_>) {
        let fixed = self.linking.batches.len() - 1;
        for (index, first) in (0..fixed).zip((0..).step_by(self.linking.size as usize)) {
            let arrays = self.linking.size.min(self.uniform.directions - first);
            self.linking.encode(pass, index, arrays, self.uniform.count);
        }
    }

    /// Links `directions` from the chosen one on, at most a batch.
    pub(crate) fn encode_links_of(&self, pass: &mut wgpu::ComputePass<'_>, directions: u32) {
        let moving = self.linking.batches.len() - 1;
        self.linking.encode(pass, moving, directions, self.uniform.count);
    }

    /// Room for so many lights.
    pub(crate) fn set_lights(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        count: u32,
    ) -> Result<(), LimitExceeded> {
        if self.lighting.as_ref().is_some_and(|lighting| lighting.count == count) {
            return Ok(());
        }
        let depth = u64::from(self.lit_cells.z) * u64::from(count.max(1));
        let available = u64::from(device.limits().max_texture_dimension_3d);
        if depth > available {
            return Err(LimitExceeded { label: "light in voxels".into(), needed: depth, available });
        }
        let storage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let sized = |label, bytes: u64| make_buffer(device, label, bytes.max(32), storage);
        let lit = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("szk-network: light in voxels"),
            size: extent(self.lit_cells * UVec3::new(1, 1, count.max(1))),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
            view_formats: &[],
        });
        let lit = lit.create_view(&Default::default());
        let lights = u64::from(count);
        let arrivals = sized("arrivals", 32 * u64::from(self.uniform.count) * lights)?;
        let collided = sized("collided", 8 * lights)?;
        let groups = self.lit_cells.map(|n| n.div_ceil(4));
        let of_voxels = sized("partial sums of voxels", 4 * u64::from(groups.element_product()))?;
        let of_particles =
            sized("partial sums of particles", 4 * u64::from(self.uniform.count.div_ceil(64)))?;
        let pipelines = &self.light_pipelines;
        use wgpu::BindingResource::{Sampler, TextureView};
        let cloud = self.cloud.buffer.as_entire_binding();
        let mut turns = Vec::new();
        for index in 0..count {
            let turn = Uniform::new(device, "szk-network: turn of a light");
            turn.write(queue, &TurnUniform { index });
            let turn = turn.buffer.as_entire_binding();
            let voxels = [
                (0, turn.clone()),
                (1, cloud.clone()),
                (2, TextureView(&self.density)),
                (3, Sampler(&self.sampler)),
                (4, TextureView(&lit)),
                (5, of_voxels.as_entire_binding()),
            ];
            let at_particles = [
                (0, turn.clone()),
                (1, cloud.clone()),
                (2, self.particles.as_entire_binding()),
                (3, self.windows.as_entire_binding()),
                (4, self.phase_tables.as_entire_binding()),
                (5, TextureView(&lit)),
                (6, Sampler(&self.sampler)),
                (7, arrivals.as_entire_binding()),
                (8, of_particles.as_entire_binding()),
            ];
            let scaled = [
                (0, turn.clone()),
                (2, collided.as_entire_binding()),
                (3, cloud.clone()),
                (4, arrivals.as_entire_binding()),
            ];
            let sum = |which: usize, partial: &wgpu::Buffer| {
                let resources =
                    [(0, turn.clone()), (1, partial.as_entire_binding()), (2, collided.as_entire_binding())];
                let layout = pipelines.sums[which].get_bind_group_layout(0);
                numbered_group(device, "szk-network: sum of direct light", &layout, &resources)
            };
            turns.push([
                numbered_group(device, "szk-network: voxels", &pipelines.voxels_group, &voxels),
                sum(0, &of_voxels),
                numbered_group(device, "szk-network: arrivals", &pipelines.arrivals_group, &at_particles),
                sum(1, &of_particles),
                numbered_group(
                    device,
                    "szk-network: scale",
                    &pipelines.scale.get_bind_group_layout(0),
                    &scaled,
                ),
            ]);
        }
        let resources = [
            (0, cloud),
            (1, self.particles.as_entire_binding()),
            (5, self.sources.as_entire_binding()),
            (13, arrivals.as_entire_binding()),
            (14, self.windows.as_entire_binding()),
            (15, self.phase_tables.as_entire_binding()),
        ];
        let layout = pipelines.sources.get_bind_group_layout(0);
        let sources = numbered_group(device, "szk-network: sources", &layout, &resources);
        self.uniform.lights = count;
        self.lighting = Some(Lighting { count, lit, arrivals, turns, sources });
        Ok(())
    }

    /// Finds direct light, and what particles radiate and scatter of it.
    pub(crate) fn encode_lights(&self, pass: &mut wgpu::ComputePass<'_>, lights: &[wgpu::BindGroup]) {
        let Some(lighting) = &self.lighting else { return };
        let pipelines = &self.light_pipelines;
        let groups = self.lit_cells.map(|n| n.div_ceil(4));
        let workgroups = self.uniform.count.div_ceil(64);
        for (light, [voxels, sum_voxels, arrivals, sum_arrivals, scale]) in lights.iter().zip(&lighting.turns)
        {
            pass.set_pipeline(&pipelines.voxels);
            pass.set_bind_group(0, voxels, &[]);
            pass.set_bind_group(1, light, &[]);
            pass.dispatch_workgroups(groups.x, groups.y, groups.z);
            pass.set_pipeline(&pipelines.sums[0]);
            pass.set_bind_group(0, sum_voxels, &[]);
            pass.dispatch_workgroups(1, 1, 1);
            pass.set_pipeline(&pipelines.arrivals);
            pass.set_bind_group(0, arrivals, &[]);
            pass.set_bind_group(1, light, &[]);
            pass.dispatch_workgroups(workgroups, 1, 1);
            pass.set_pipeline(&pipelines.sums[1]);
            pass.set_bind_group(0, sum_arrivals, &[]);
            pass.dispatch_workgroups(1, 1, 1);
            pass.set_pipeline(&pipelines.scale);
            pass.set_bind_group(0, scale, &[]);
            pass.dispatch_workgroups(workgroups, 1, 1);
        }
        pass.set_pipeline(&pipelines.sources);
        pass.set_bind_group(0, &lighting.sources, &[]);
        pass.dispatch_workgroups(workgroups, self.uniform.directions, 1);
    }

    /// Takes steps.
    pub(crate) fn encode_steps(&self, pass: &mut wgpu::ComputePass<'_>, steps: u32) {
        for _ in 0..steps {
            for (pipeline, group, [x, y, z]) in &self.steps {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, group, &[]);
                pass.dispatch_workgroups(*x, *y, *z);
            }
        }
    }

    /// Number of voxels each way.
    pub(crate) fn cells(&self) -> UVec3 {
        self.cells
    }

    /// Number of colours.
    pub(crate) fn colours(&self) -> u32 {
        self.colours
    }
}

fn extent(cells: UVec3) -> wgpu::Extent3d {
    wgpu::Extent3d { width: cells.x, height: cells.y, depth_or_array_layers: cells.z }
}

fn write_voxels(queue: &wgpu::Queue, texture: &wgpu::Texture, particles: &Particles, options: &Options) {
    let cells = particles.density.cells;
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&voxel_data(particles, options)),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(8 * cells.x),
            rows_per_image: Some(cells.y),
        },
        extent(cells),
    );
}

/// Components in blocks of four, each with its λ in front, and matrices in blocks of four rows.
fn kernel_data(kernel: &Kernel, directions: u32, blocks: u32) -> (Vec<[f32; 4]>, Vec<[f32; 4]>) {
    match kernel {
        Kernel::Components(sets) => {
            let directions = directions as usize;
            let mut factors = Vec::new();
            for set in sets {
                for block in 0..blocks as usize {
                    let of = |value: &dyn Fn(usize) -> f64| {
                        [0, 1, 2, 3].map(|i| {
                            let k = 4 * block + i;
                            if k < set.values.len() { value(k) as f32 } else { 0.0 }
                        })
                    };
                    factors.push(of(&|k| set.values[k]));
                    factors.extend((0..directions).map(|d| of(&|k| set.vectors[k * directions + d])));
                }
            }
            (factors, vec![[0.0; 4]])
        }
        Kernel::Matrices { matrices, .. } => {
            let size = directions as usize;
            let at = |m: &nalgebra::DMatrix<f64>, i: usize, d: usize| {
                if i < size { m[(i, d)] as f32 } else { 0.0 }
            };
            let fours = matrices.iter().flat_map(|m| (0..size).step_by(4).map(move |i| (m, i)));
            let rows = fours.flat_map(|(m, i)| (0..size).map(move |d| [0, 1, 2, 3].map(|k| at(m, i + k, d))));
            (vec![[0.0; 4]], rows.collect())
        }
    }
}

impl Linking {
    fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        options: &Options,
        (count, directions): (u32, u32),
        [cloud, particles, windows, neighbours, opacities]: [&wgpu::Buffer; 5],
    ) -> Result<Self, LimitExceeded> {
        let length = padded(count);
        let size = ((SORT_BYTES / (8 * u64::from(length))) as u32).clamp(1, directions);
        let bytes = 8 * u64::from(length) * u64::from(size);
        let sorted = make_buffer(device, "keys", bytes, wgpu::BufferUsages::STORAGE)?;
        let module = shader_module(device, "szk-network: links", shaders::links());
        let per_link = [("per_link", f64::from(u8::from(options.opacity == Opacity::Link)))];
        let [keys, links] =
            ["cs_keys", "cs_links"].map(|e| compute_pipeline(device, &module, None, e, &per_link));
        let groups = |batch: &Uniform<BatchUniform>| {
            let all = [&batch.buffer, cloud, particles, windows, &sorted, neighbours, opacities];
            let group = |pipeline: &wgpu::ComputePipeline, bindings: &[u32]| {
                let resources: Vec<_> =
                    bindings.iter().map(|&b| (b, all[b as usize].as_entire_binding())).collect();
                numbered_group(device, "szk-network: links", &pipeline.get_bind_group_layout(0), &resources)
            };
            [group(&keys, &[0, 1, 2, 3, 4]), group(&links, &[0, 1, 2, 3, 4, 5, 6])]
        };
        let batch = |first| {
            let uniform = Uniform::new(device, "szk-network: batch of directions");
            uniform.write(queue, &BatchUniform { first, length });
            uniform
        };
        let mut batches: Vec<_> =
            (0..directions).step_by(size as usize).map(|first| groups(&batch(first))).collect();
        let moving = batch(0);
        batches.push(groups(&moving));
        let sorter = Sorter::new(device, queue, &sorted, length);
        Ok(Self { keys, links, sorter, length, size, batches, moving })
    }

    fn encode(&self, pass: &mut wgpu::ComputePass<'_>, batch: usize, arrays: u32, count: u32) {
        let [keys, links] = &self.batches[batch];
        pass.set_pipeline(&self.keys);
        pass.set_bind_group(0, keys, &[]);
        pass.dispatch_workgroups(self.length.div_ceil(64), arrays, 1);
        self.sorter.encode(pass, arrays);
        pass.set_pipeline(&self.links);
        pass.set_bind_group(0, links, &[]);
        pass.dispatch_workgroups(count.div_ceil(64), arrays, 1);
    }
}

impl LightPipelines {
    fn new(
        device: &wgpu::Device,
        options: &Options,
        scatter: &wgpu::ShaderModule,
        flags: &[(&str, f64)],
    ) -> Self {
        let light = light_layout(device);
        let layout = |label, types: &[wgpu::BindingType]| {
            let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty,
                count: None,
            };
            let entries: Vec<_> = (0..).zip(types).map(entry).collect();
            let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries };
            device.create_bind_group_layout(&descriptor)
        };
        let volume = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D3,
            multisampled: false,
        };
        let written = wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: wgpu::TextureFormat::Rgba16Float,
            view_dimension: wgpu::TextureViewDimension::D3,
        };
        let writable = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: false },
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        use binding::{STORAGE, UNIFORM};
        let voxels_group =
            layout("szk-network: voxels", &[UNIFORM, UNIFORM, volume, sampler, written, writable]);
        let arrivals_group = layout(
            "szk-network: arrivals",
            &[UNIFORM, UNIFORM, STORAGE, STORAGE, STORAGE, volume, sampler, writable, writable],
        );
        let pipeline = |name, source, group: &wgpu::BindGroupLayout, entry, constants: &[(&str, f64)]| {
            let layout = pipeline_layout(device, name, &[group, &light]);
            compute_pipeline(device, &shader_module(device, name, source), Some(&layout), entry, constants)
        };
        let nearest = [("nearest", f64::from(u8::from(options.incidence == Incidence::Nearest)))];
        let voxels = pipeline("szk-network: voxels", shaders::voxels(), &voxels_group, "cs_voxels", &[]);
        let arrivals =
            pipeline("szk-network: arrivals", shaders::arrivals(), &arrivals_group, "cs_arrivals", &nearest);
        let module = shader_module(device, "szk-network: sums", shaders::sums());
        let sum = |entry, at_particles| {
            compute_pipeline(device, &module, None, entry, &[("at_particles", at_particles)])
        };
        let (sums, scale) = ([0.0, 1.0].map(|which| sum("cs_sum", which)), sum("cs_scale", 1.0));
        let sources = compute_pipeline(device, scatter, None, "cs_sources", flags);
        Self { voxels_group, voxels, arrivals_group, arrivals, sums, scale, sources }
    }
}
