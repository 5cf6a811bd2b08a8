//! The network on the device: particles, links, direct light and the steps of the iteration.

use common::cloud::Grid;
use common::gpu::passes::numbered_group;
use common::gpu::{LimitExceeded, Uniform, make_buffer};
use encase::ShaderType;
use glam::{UVec3, Vec3};

use crate::directions::{depth_levels, pixel_bits};
use crate::lighting::Lighting;
use crate::linking::Linking;
use crate::pipelines::Pipelines;
use crate::plan::self_share;
use crate::sort::padded;
use crate::{Colours, Kernel, Opacity, Options, Particles, Plan, Scattering};

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
    pub(crate) by_colour: u32,
    pub(crate) padded: u32,
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
    pub(crate) sources: wgpu::Buffer,
    pub(crate) incoming: wgpu::Buffer,
    pub(crate) outgoing: wgpu::Buffer,
    pub(crate) state: wgpu::Buffer,
    sky: wgpu::Buffer,
    pub(crate) linking: Linking,
    steps: Vec<(wgpu::ComputePipeline, wgpu::BindGroup, [u32; 3])>,
    pub(crate) lighting: Option<Lighting>,
    cells: UVec3,
    /// Voxels that light is found in: half as fine.
    pub(crate) lit_cells: UVec3,
    colours: u32,
    /// Of what [`Plan::bytes`] predicts.
    pub(crate) bytes: u64,
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
        pipelines: &Pipelines,
    ) -> Result<Self, LimitExceeded> {
        let (count, directions) = (particles.list.len() as u32, plan.windows.len() as u32);
        let colours = if options.colours == Colours::Grey { 1 } else { 3 };
        let links = u64::from(count) * u64::from(directions);
        let bits = pixel_bits(plan.pixels);
        let blocks = plan.blocks();
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
            by_colour: matches!(plan.kernel, Kernel::Matrices { by_colour: true, .. }).into(),
            padded: padded(count),
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
        // Opacities of links lie behind the neighbours: there are no more than eight storage buffers everywhere.
        let per_link = u64::from(options.opacity == Opacity::Link);
        let neighbours = sized("neighbours", 4 * links * (1 + per_link))?;
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
        let parts = if plan.fused() { 1 } else { chunks };
        let state = sized("state", 8 * (STATE + u64::from(count) * u64::from(parts) * colours))?;
        // Steps that keep nothing but components have no other use for it.
        let collisions = sized("collisions", if plan.fused() { 0 } else { network_bytes })?;

        let counted =
            [&sources, &incoming, &outgoing, &collisions, &neighbours, &factors, &matrices, &moments];
        let bytes = counted.iter().map(|buffer| buffer.size()).sum();
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
            pipelines,
            (count, directions),
            [&cloud.buffer, &particle_buffer, &windows, &neighbours],
        )?;

        let mut steps = Vec::new();
        let mut step = |pipeline: &wgpu::ComputePipeline, bindings: &[u32], dispatch| {
            let all = [
                &cloud.buffer,
                &particle_buffer,
                &neighbours,
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
            let group =
                numbered_group(device, "szk-network: step", &pipeline.get_bind_group_layout(0), &resources);
            steps.push((pipeline.clone(), group, dispatch));
        };
        let colour_count = colours as u32;
        let every_chunk = [workgroups, chunks, colour_count];
        let pipelines = &pipelines.steps;
        if plan.fused() {
            let every_particle = [workgroups, 1, colour_count];
            step(&pipelines.propagate_moments, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 10], every_particle);
        } else {
            step(&pipelines.propagate, &[0, 1, 2, 3, 4, 5, 6, 10, 11], every_chunk);
        }
        step(&pipelines.residual, &[0, 10], [1, 1, 1]);
        match (&plan.kernel, options.scattering) {
            (Kernel::Components(_), _) => {
                if !plan.fused() {
                    let groups = [workgroups, blocks.div_ceil(3), colour_count];
                    step(&pipelines.moments, &[0, 1, 7, 8, 10, 11], groups);
                }
                step(&pipelines.expand, &[0, 1, 2, 4, 5, 6, 7, 8, 10], every_chunk);
            }
            (Kernel::Matrices { .. }, scattering) => {
                let fours = directions.div_ceil(4);
                let (pipeline, dispatch) = match scattering {
                    Scattering::Tiled => {
                        (&pipelines.tiled, [count.div_ceil(16), fours.div_ceil(16), colour_count])
                    }
                    _ => (&pipelines.full, [workgroups, fours, colour_count]),
                };
                step(pipeline, &[0, 1, 2, 4, 5, 6, 9, 10, 11], dispatch);
            }
        }
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
            sources,
            incoming,
            outgoing,
            state,
            sky,
            linking,
            steps,
            lighting: None,
            cells: grid.cells,
            lit_cells: (grid.cells + 1) / 2,
            colours: colour_count,
            bytes,
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

pub(crate) fn extent(cells: UVec3) -> wgpu::Extent3d {
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
