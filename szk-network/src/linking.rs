//! The visibility network on the device: particles sorted into the columns of each direction's window.

use common::gpu::passes::numbered_group;
use common::gpu::{LimitExceeded, Uniform, make_buffer};
use encase::ShaderType;

use crate::pipelines::Pipelines;
use crate::sort::{Sorter, padded};

/// Most bytes of what is sorted at a time.
const SORT_BYTES: u64 = 64 << 20;

/// Twin of WGSL `Batch`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct BatchUniform {
    first: u32,
    length: u32,
}

/// Finds for each particle the one before it in each direction.
pub(crate) struct Linking {
    keys: wgpu::ComputePipeline,
    links: wgpu::ComputePipeline,
    sorter: Sorter,
    length: u32,
    /// Directions at a time.
    size: u32,
    count: u32,
    directions: u32,
    /// Groups of both pipelines for each batch; the last one is written before it is used.
    batches: Vec<[wgpu::BindGroup; 2]>,
    moving: Uniform<BatchUniform>,
}

impl Linking {
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        (count, directions): (u32, u32),
        [cloud, particles, windows, neighbours]: [&wgpu::Buffer; 4],
    ) -> Result<Self, LimitExceeded> {
        let length = padded(count);
        let size = ((SORT_BYTES / (8 * u64::from(length))) as u32).clamp(1, directions);
        let bytes = 8 * u64::from(length) * u64::from(size);
        let sorted = make_buffer(device, "keys", bytes, wgpu::BufferUsages::STORAGE)?;
        let [keys, links] = pipelines.links.clone();
        let groups = |batch: &Uniform<BatchUniform>| {
            let all = [&batch.buffer, cloud, particles, windows, &sorted, neighbours];
            let group = |pipeline: &wgpu::ComputePipeline, bindings: &[u32]| {
                let resources: Vec<_> =
                    bindings.iter().map(|&b| (b, all[b as usize].as_entire_binding())).collect();
                numbered_group(device, "szk-network: links", &pipeline.get_bind_group_layout(0), &resources)
            };
            [group(&keys, &[0, 1, 2, 3, 4]), group(&links, &[0, 1, 2, 3, 4, 5])]
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
        let sorter = Sorter::new(device, queue, &pipelines.sort, &sorted, length);
        Ok(Self { keys, links, sorter, length, size, count, directions, batches, moving })
    }

    /// Links `arrays` directions of a batch.
    fn encode(&self, pass: &mut wgpu::ComputePass<'_>, batch: usize, arrays: u32) {
        let [keys, links] = &self.batches[batch];
        pass.set_pipeline(&self.keys);
        pass.set_bind_group(0, keys, &[]);
        pass.dispatch_workgroups(self.length.div_ceil(64), arrays, 1);
        self.sorter.encode(pass, arrays);
        pass.set_pipeline(&self.links);
        pass.set_bind_group(0, links, &[]);
        pass.dispatch_workgroups(self.count.div_ceil(64), arrays, 1);
    }

    /// Directions at a time.
    pub(crate) fn batch(&self) -> u32 {
        self.size
    }

    /// Links all directions.
    pub(crate) fn encode_all(&self, pass: &mut wgpu::ComputePass<'_>) {
        let fixed = self.batches.len() - 1;
        for (index, first) in (0..fixed).zip((0..).step_by(self.size as usize)) {
            self.encode(pass, index, self.size.min(self.directions - first));
        }
    }

    /// Which directions [`Linking::encode_some`] links, from the first on.
    pub(crate) fn choose(&self, queue: &wgpu::Queue, first: u32) {
        self.moving.write(queue, &BatchUniform { first, length: self.length });
    }

    /// Links `directions` from the chosen one on, at most a batch.
    pub(crate) fn encode_some(&self, pass: &mut wgpu::ComputePass<'_>, directions: u32) {
        self.encode(pass, self.batches.len() - 1, directions);
    }
}
