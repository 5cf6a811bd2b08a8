//! The picture: what particles send to the eye, their order, and their splats.

use common::gpu::passes::{Attachments, begin_pass, numbered_group};
use common::gpu::{LimitExceeded, PassTimer, TargetError, Uniform, ViewUniform, fill_buffer, make_buffer};
use common::{Light, View};

use crate::network::Network;
use crate::pipelines::Pipelines;
use crate::sort::{Sorter, padded};

/// Words of a light as a fragment needs it: twin of WGSL `Source`.
type SourceData = [f32; 8];

/// Draws the particles of a network.
pub(crate) struct Splats {
    order: wgpu::ComputePipeline,
    radiances: wgpu::ComputePipeline,
    splat: wgpu::RenderPipeline,
    sorter: Sorter,
    length: u32,
    count: u32,
    keys: wgpu::Buffer,
    radiance_buffer: wgpu::Buffer,
    lights: Option<wgpu::Buffer>,
    view: Uniform<ViewUniform>,
}

/// Bindings of a frame.
pub(crate) struct FrameGroups {
    order: wgpu::BindGroup,
    radiances: wgpu::BindGroup,
    splat: wgpu::BindGroup,
}

impl Splats {
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        count: u32,
    ) -> Result<Self, LimitExceeded> {
        let length = padded(count);
        let storage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let keys = make_buffer(device, "order of splats", 8 * u64::from(length), storage)?;
        let radiance_buffer = make_buffer(device, "radiance to the eye", 16 * u64::from(count), storage)?;
        let sorter = Sorter::new(device, queue, &pipelines.sort, &keys, length);
        let view = Uniform::new(device, "szk-network: view");
        let ([order, radiances], splat) = (pipelines.view.clone(), pipelines.splat.clone());
        Ok(Self { order, radiances, splat, sorter, length, count, keys, radiance_buffer, lights: None, view })
    }

    /// Whether anything can be drawn into a target.
    pub(crate) fn check_target(
        device: &wgpu::Device,
        format: wgpu::TextureFormat,
    ) -> Result<(), TargetError> {
        use wgpu::TextureFormat::{Rgba16Float, Rgba32Float};
        let blends_f32 = device.features().contains(wgpu::Features::FLOAT32_BLENDABLE);
        match format {
            Rgba16Float => Ok(()),
            Rgba32Float if blends_f32 => Ok(()),
            _ => Err(TargetError::UnsupportedFormat { format }),
        }
    }

    /// Writes what a frame needs. There has to be room for the lights in the network.
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        network: &Network,
        view: &View,
        lights: &[&Light],
        depth: &wgpu::TextureView,
    ) -> Result<Option<FrameGroups>, LimitExceeded> {
        self.view.write(queue, &ViewUniform::from(view));
        let data: Vec<SourceData> = lights.iter().map(|light| source_data(light)).collect();
        fill_buffer(device, queue, &mut self.lights, "lights", wgpu::BufferUsages::STORAGE, &data)?;
        let (Some(lighting), Some(lights)) = (&network.lighting, &self.lights) else { return Ok(None) };
        let all = [
            &network.cloud.buffer,
            &self.view.buffer,
            &network.particles,
            &network.windows,
            &network.phase_tables,
            &lighting.arrivals,
            &network.neighbours,
            &network.incoming,
            &network.outgoing,
            &self.radiance_buffer,
            &self.keys,
        ];
        let group = |pipeline: &wgpu::ComputePipeline, bindings: &[u32]| {
            let resources: Vec<_> =
                bindings.iter().map(|&b| (b, all[b as usize].as_entire_binding())).collect();
            numbered_group(device, "szk-network: view", &pipeline.get_bind_group_layout(0), &resources)
        };
        use wgpu::BindingResource::{Sampler, TextureView};
        let resources = [
            (0, network.cloud.buffer.as_entire_binding()),
            (1, self.view.buffer.as_entire_binding()),
            (2, network.particles.as_entire_binding()),
            (3, self.radiance_buffer.as_entire_binding()),
            (4, self.keys.as_entire_binding()),
            (5, lights.as_entire_binding()),
            (6, network.phase_tables.as_entire_binding()),
            (7, TextureView(depth)),
            (8, TextureView(&network.density)),
            (9, TextureView(&lighting.lit)),
            (10, Sampler(&network.sampler)),
        ];
        Ok(Some(FrameGroups {
            order: group(&self.order, &[0, 1, 2, 10]),
            radiances: group(&self.radiances, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9]),
            splat: numbered_group(
                device,
                "szk-network: splat",
                &self.splat.get_bind_group_layout(0),
                &resources,
            ),
        }))
    }

    /// Order and radiance of all particles.
    pub(crate) fn encode_view(&self, pass: &mut wgpu::ComputePass<'_>, groups: &FrameGroups) {
        pass.set_pipeline(&self.order);
        pass.set_bind_group(0, &groups.order, &[]);
        pass.dispatch_workgroups(self.length.div_ceil(64), 1, 1);
        self.sorter.encode(pass, 1);
        pass.set_pipeline(&self.radiances);
        pass.set_bind_group(0, &groups.radiances, &[]);
        pass.dispatch_workgroups(self.count.div_ceil(64), 1, 1);
    }

    /// Draws over the target.
    pub(crate) fn encode_splats(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        groups: &FrameGroups,
        label: &'static str,
        timer: &mut PassTimer,
    ) {
        let mut pass = begin_pass(encoder, Attachments::onto(target), label, timer);
        pass.set_pipeline(&self.splat);
        pass.set_bind_group(0, &groups.splat, &[]);
        pass.draw(0..4, 0..self.count);
    }
}

fn source_data(light: &Light) -> SourceData {
    let (place, kind, strength) = match light {
        Light::Point(light) => (light.position, 0, light.intensity),
        Light::Spot(light) => (light.position, 1, light.intensity),
        Light::Directional(light) => (light.direction, 2, light.irradiance),
    };
    [place.x, place.y, place.z, f32::from_bits(kind), strength.x, strength.y, strength.z, 0.0]
}
