//! Sorting on the device: many arrays of one length at a time, by key and then by what the key belongs to.

use common::gpu::Uniform;
use common::gpu::passes::bind_group;
use encase::ShaderType;

use crate::pipelines::SortPipelines;

/// What a workgroup sorts by itself.
const BLOCK: u32 = 512;

/// Twin of WGSL `Step`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct StepUniform {
    sequence: u32,
    distance: u32,
    length: u32,
}

/// Length of an array with room for `count`.
pub(crate) fn padded(count: u32) -> u32 {
    count.next_power_of_two().max(BLOCK)
}

/// Sorts the arrays of one buffer.
pub(crate) struct Sorter {
    pipelines: SortPipelines,
    steps: Vec<(Kind, wgpu::BindGroup)>,
    length: u32,
}

#[derive(Clone, Copy)]
enum Kind {
    SortBlocks,
    Compare,
    MergeBlocks,
}

impl Sorter {
    /// For arrays of `length` pairs of integers, [`padded`], in `keys`.
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &SortPipelines,
        keys: &wgpu::Buffer,
        length: u32,
    ) -> Self {
        let mut sorter = Self { pipelines: pipelines.clone(), steps: Vec::new(), length };
        let mut push = |kind, sequence, distance| {
            let uniform = Uniform::new(device, "szk-network: step of sorting");
            uniform.write(queue, &StepUniform { sequence, distance, length });
            let layout = sorter.pipeline(kind).get_bind_group_layout(0);
            let resources = [uniform.buffer.as_entire_binding(), keys.as_entire_binding()];
            let group = bind_group(device, "szk-network: sort", &layout, resources);
            sorter.steps.push((kind, group));
        };
        push(Kind::SortBlocks, BLOCK, 0);
        let mut sequence = 2 * BLOCK;
        while sequence <= length {
            let mut distance = sequence / 2;
            while distance >= BLOCK {
                push(Kind::Compare, sequence, distance);
                distance /= 2;
            }
            push(Kind::MergeBlocks, sequence, 0);
            sequence *= 2;
        }
        sorter
    }

    fn pipeline(&self, kind: Kind) -> &wgpu::ComputePipeline {
        match kind {
            Kind::SortBlocks => &self.pipelines.sort_blocks,
            Kind::Compare => &self.pipelines.compare,
            Kind::MergeBlocks => &self.pipelines.merge_blocks,
        }
    }

    /// Sorts the first `arrays` of them.
    pub(crate) fn encode(&self, pass: &mut wgpu::ComputePass<'_>, arrays: u32) {
        for (kind, group) in &self.steps {
            pass.set_pipeline(self.pipeline(*kind));
            pass.set_bind_group(0, group, &[]);
            pass.dispatch_workgroups(self.length / BLOCK, arrays, 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use common::gpu::bench::{check_uniform_layout, context};
    use common::gpu::{read_u32s, uniform_bytes};
    use common::random::unit;

    use super::*;

    #[test]
    fn the_step_lies_as_wgsl_has_it() {
        let bytes = uniform_bytes(&StepUniform { sequence: 1, distance: 2, length: 3 });
        let expect = [("sequence", 1), ("distance", 2), ("length", 3)];
        check_uniform_layout(&crate::shaders::sort(), "Step", &bytes, &expect).unwrap();
    }

    #[test]
    fn arrays_come_out_in_order() {
        let context = context();
        let (device, queue) = (&context.device, &context.queue);
        for (count, arrays) in [(1, 1), (512, 3), (700, 2), (4096, 5), (5000, 1)] {
            let length = padded(count);
            let random = |i: u32| (unit(u64::from(i)) * 1000.0) as u32;
            // Many keys alike: the second number decides.
            let pairs: Vec<[u32; 2]> = (0..length * arrays)
                .map(|i| if i % length < count { [random(i), i % length] } else { [u32::MAX; 2] })
                .collect();
            let keys = device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: u64::from(length * arrays) * 8,
                usage: wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::COPY_DST
                    | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            });
            queue.write_buffer(&keys, 0, bytemuck::cast_slice(&pairs));
            let sorter = Sorter::new(device, queue, &SortPipelines::new(device), &keys, length);
            let mut encoder = device.create_command_encoder(&Default::default());
            sorter.encode(&mut encoder.begin_compute_pass(&Default::default()), arrays);
            queue.submit([encoder.finish()]);
            let found = read_u32s(device, queue, &keys, 2 * pairs.len()).unwrap();
            for (array, found) in found.chunks_exact(2 * length as usize).enumerate() {
                let mut expected = pairs[array * length as usize..][..length as usize].to_vec();
                expected.sort_unstable();
                assert_eq!(found, expected.as_flattened(), "{count} in {length}");
            }
        }
    }
}
