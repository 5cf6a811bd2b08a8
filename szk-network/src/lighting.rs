//! Direct light: how much of each light reaches the voxels, and what of it collides at the particles.

use common::gpu::passes::numbered_group;
use common::gpu::{LimitExceeded, Uniform, make_buffer};
use encase::ShaderType;
use glam::UVec3;

use crate::network::{Network, extent};
use crate::pipelines::{LightPipelines, Pipelines};

/// Twin of WGSL `Turn`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct TurnUniform {
    index: u32,
}

/// What depends on the number of lights.
pub(crate) struct Lighting {
    pub(crate) count: u32,
    pub(crate) lit: wgpu::TextureView,
    pub(crate) arrivals: wgpu::Buffer,
    /// For each light: groups of voxels, their sum, arrivals, their sum, and scaling.
    turns: Vec<[wgpu::BindGroup; 5]>,
    sources: wgpu::BindGroup,
    pipelines: LightPipelines,
    /// Workgroups of voxels, and of particles.
    groups: UVec3,
    particles: u32,
    directions: u32,
}

impl Lighting {
    /// Room for so many lights.
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        network: &Network,
        count: u32,
    ) -> Result<Self, LimitExceeded> {
        let depth = u64::from(network.lit_cells.z) * u64::from(count.max(1));
        let available = u64::from(device.limits().max_texture_dimension_3d);
        if depth > available {
            return Err(LimitExceeded { label: "light in voxels".into(), needed: depth, available });
        }
        let storage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let sized = |label, bytes: u64| make_buffer(device, label, bytes.max(32), storage);
        let lit = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("szk-network: light in voxels"),
            size: extent(network.lit_cells * UVec3::new(1, 1, count.max(1))),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
            view_formats: &[],
        });
        let lit = lit.create_view(&Default::default());
        let lights = u64::from(count);
        let arrivals = sized("arrivals", 32 * u64::from(network.uniform.count) * lights)?;
        let collided = sized("collided", 8 * lights)?;
        let groups = network.lit_cells.map(|n| n.div_ceil(4));
        let of_voxels = sized("partial sums of voxels", 4 * u64::from(groups.element_product()))?;
        let of_particles =
            sized("partial sums of particles", 4 * u64::from(network.uniform.count.div_ceil(64)))?;
        let pipelines = pipelines.light.clone();
        use wgpu::BindingResource::{Sampler, TextureView};
        let cloud = network.cloud.buffer.as_entire_binding();
        let mut turns = Vec::new();
        for index in 0..count {
            let turn = Uniform::new(device, "szk-network: turn of a light");
            turn.write(queue, &TurnUniform { index });
            let turn = turn.buffer.as_entire_binding();
            let voxels = [
                (0, turn.clone()),
                (1, cloud.clone()),
                (2, TextureView(&network.density)),
                (3, Sampler(&network.sampler)),
                (4, TextureView(&lit)),
                (5, of_voxels.as_entire_binding()),
            ];
            let at_particles = [
                (0, turn.clone()),
                (1, cloud.clone()),
                (2, network.particles.as_entire_binding()),
                (3, network.windows.as_entire_binding()),
                (4, network.phase_tables.as_entire_binding()),
                (5, TextureView(&lit)),
                (6, Sampler(&network.sampler)),
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
            (1, network.particles.as_entire_binding()),
            (4, network.sources.as_entire_binding()),
            (12, arrivals.as_entire_binding()),
            (13, network.windows.as_entire_binding()),
            (14, network.phase_tables.as_entire_binding()),
        ];
        let layout = pipelines.sources.get_bind_group_layout(0);
        let sources = numbered_group(device, "szk-network: sources", &layout, &resources);
        let particles = network.uniform.count.div_ceil(64);
        let directions = network.uniform.directions;
        Ok(Self { count, lit, arrivals, turns, sources, pipelines, groups, particles, directions })
    }

    /// Finds direct light, and what particles radiate and scatter of it.
    pub(crate) fn encode(&self, pass: &mut wgpu::ComputePass<'_>, lights: &[wgpu::BindGroup]) {
        let Self { pipelines, groups, particles: workgroups, .. } = self;
        let workgroups = *workgroups;
        for (light, [voxels, sum_voxels, arrivals, sum_arrivals, scale]) in lights.iter().zip(&self.turns) {
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
        pass.set_bind_group(0, &self.sources, &[]);
        pass.dispatch_workgroups(workgroups, self.directions, 1);
    }
}
