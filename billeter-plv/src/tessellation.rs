//! Adaptive tessellation on the GPU: shadow map in, index buffer and indirect arguments out.

use common::gpu::passes::{bind_group, block, pipeline_layout, shader_module};
use common::gpu::{LightBinding, PassTimer, Uniform, ViewUniform, light_layout, make_buffer};
use encase::ShaderType;

use crate::{Error, shaders};

/// Smallest map that is worth refining; smaller ones are drawn in full.
pub(crate) const LEAST_SIZE: u32 = 8;

/// Share of the full mesh that the index buffer holds. A map that needs more is drawn in full instead,
/// which costs no more memory and hardly more time.
const CAPACITY_SHARE: u64 = 3;

/// Twin of WGSL `Tessellation`.
#[derive(Clone, Copy, Debug, ShaderType)]
pub(crate) struct TessellationUniform {
    pub(crate) layer: u32,
    pub(crate) step: u32,
    pub(crate) diagonal: u32,
    pub(crate) capacity: u32,
    pub(crate) tolerance: f32,
}

/// Levels of the largest grid: side and diagonal vertices for steps 1 to 2^15.
const LEVELS: usize = 32;
/// Bytes between two parameter blocks: the largest alignment that a device may ask for.
const STRIDE: u64 = 256;

/// Compute pipelines.
pub(crate) struct Pipelines {
    layout: wgpu::BindGroupLayout,
    measure: wgpu::ComputePipeline,
    count: wgpu::ComputePipeline,
    place: wgpu::ComputePipeline,
    emit: wgpu::ComputePipeline,
}

/// Buffers for maps of one size; meshes of all layers of all lights use them in turn.
pub(crate) struct Buffers {
    size: u32,
    capacity: u32,
    parameters: wgpu::Buffer,
    pub(crate) indices: wgpu::Buffer,
    pub(crate) arguments: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// Names of this module's passes.
pub(crate) const PASSES: [&str; 2] = ["billeter-plv: measure flatness", "billeter-plv: emit triangles"];

/// Bytes of the draw arguments: of the adaptive mesh, then of the full one.
pub(crate) const ARGUMENTS_SIZE: u64 = 36;

/// Offset in the arguments of those for the full mesh, drawn when the index buffer would not do.
pub(crate) const FULL_ARGUMENTS: u64 = 20;

/// Cells on a side of the grid over a map of `size` texels; twin of WGSL `grid_cells`.
pub(crate) fn grid_cells(size: u32) -> u32 {
    (size - 1).next_power_of_two()
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device, upright_walls: bool) -> Self {
        let entry = |binding, ty, has_dynamic_offset| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None },
            count: None,
        };
        let storage = wgpu::BufferBindingType::Storage { read_only: false };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("billeter-plv: tessellation"),
            entries: &[
                entry(0, wgpu::BufferBindingType::Uniform, true),
                entry(1, storage, false),
                entry(2, storage, false),
                entry(3, storage, false),
                entry(4, storage, false),
                entry(5, wgpu::BufferBindingType::Uniform, false),
            ],
        });
        let label = "billeter-plv: tessellation";
        let module = shader_module(device, label, shaders::tessellate());
        let pipeline_layout = pipeline_layout(device, label, &[&layout, &light_layout(device)]);
        let constants = [("upright_walls", f64::from(u8::from(upright_walls)))];
        let pipeline = |entry| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..Default::default()
                },
                cache: None,
            })
        };
        let (measure, count) = (pipeline("measure"), pipeline("count"));
        let (place, emit) = (pipeline("place"), pipeline("emit"));
        Self { layout, measure, count, place, emit }
    }

    /// Encodes the building of one layer's mesh.
    pub(crate) fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        buffers: &Buffers,
        light: &LightBinding,
        layer: u32,
        timer: &mut PassTimer,
    ) {
        let cells = grid_cells(buffers.size);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(PASSES[0]),
            timestamp_writes: timer.compute(PASSES[0]),
        });
        pass.set_bind_group(1, &light.bind_group, &[]);
        pass.set_pipeline(&self.measure);
        for (level, (step, diagonal)) in levels(cells).enumerate() {
            pass.set_bind_group(0, &buffers.group, &[buffers.offset(layer, level)]);
            let across = if diagonal { cells / (2 * step) } else { cells / step + 1 };
            pass.dispatch_workgroups(across.div_ceil(16), across.div_ceil(16), 1);
        }
        drop(pass);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(PASSES[1]),
            timestamp_writes: timer.compute(PASSES[1]),
        });
        pass.set_bind_group(0, &buffers.group, &[buffers.offset(layer, 0)]);
        pass.set_bind_group(1, &light.bind_group, &[]);
        let blocks = cells / 16 + 1;
        pass.set_pipeline(&self.count);
        pass.dispatch_workgroups(blocks, blocks, 1);
        pass.set_pipeline(&self.place);
        pass.dispatch_workgroups(1, 1, 1);
        pass.set_pipeline(&self.emit);
        pass.dispatch_workgroups(blocks, blocks, 1);
    }
}

/// Levels of the hierarchy from fine to coarse: distance between vertices, and whether they lie in the
/// middle of squares.
fn levels(cells: u32) -> impl Iterator<Item = (u32, bool)> {
    (0..cells.trailing_zeros()).flat_map(|k| [(1 << k, false), (1 << k, true)])
}

impl Buffers {
    pub(crate) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        pipelines: &Pipelines,
        view: &Uniform<ViewUniform>,
        size: u32,
        tolerance: f32,
    ) -> Result<Self, Error> {
        let cells = grid_cells(size);
        let vertices = u64::from(cells + 1).pow(2);
        let capacity = (2 * u64::from(size - 1).pow(2) / CAPACITY_SHARE).max(64);
        let buffer = |label, size, usage| make_buffer(device, label, size, usage);
        let storage = wgpu::BufferUsages::STORAGE;
        let blocks = u64::from(cells / 16 + 1).pow(2);
        let parameters = buffer(
            "billeter-plv: levels",
            6 * LEVELS as u64 * STRIDE,
            wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        )?;
        let errors = buffer("billeter-plv: errors", vertices * 4, storage)?;
        let counts = buffer("billeter-plv: blocks", blocks * 4, storage)?;
        let indices = buffer(
            "billeter-plv: indices",
            capacity * 12,
            storage | wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_SRC,
        )?;
        let arguments = buffer(
            "billeter-plv: draw arguments",
            ARGUMENTS_SIZE,
            storage | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_SRC,
        )?;
        let resources = [
            block(&parameters, TessellationUniform::min_size().get()),
            errors.as_entire_binding(),
            counts.as_entire_binding(),
            indices.as_entire_binding(),
            arguments.as_entire_binding(),
            view.buffer.as_entire_binding(),
        ];
        let group = bind_group(device, "billeter-plv: tessellation", &pipelines.layout, resources);
        let buffers = Self { size, capacity: capacity as u32, parameters, indices, arguments, group };
        for layer in 0..6 {
            for (level, (step, diagonal)) in levels(cells).enumerate() {
                let parameters = TessellationUniform {
                    layer,
                    step,
                    diagonal: diagonal.into(),
                    capacity: buffers.capacity,
                    tolerance,
                };
                let offset = u64::from(buffers.offset(layer, level));
                queue.write_buffer(&buffers.parameters, offset, &common::gpu::uniform_bytes(&parameters));
            }
        }
        Ok(buffers)
    }

    fn offset(&self, layer: u32, level: usize) -> u32 {
        ((layer as usize * LEVELS + level) as u64 * STRIDE) as u32
    }

    /// Texels on a side of the maps that these buffers are for.
    pub(crate) fn size(&self) -> u32 {
        self.size
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::gpu::bench::check_uniform_layout;
    use common::gpu::uniform_bytes;

    #[test]
    fn parameters_lie_as_wgsl_has_them() {
        let block = TessellationUniform { layer: 1, step: 2, diagonal: 3, capacity: 4, tolerance: 5.0 };
        let expect =
            [("layer", 1), ("step", 2), ("diagonal", 3), ("capacity", 4), ("tolerance", 5f32.to_bits())];
        check_uniform_layout(&shaders::tessellate(), "Tessellation", &uniform_bytes(&block), &expect)
            .unwrap();
    }

    #[test]
    fn levels_reach_every_vertex_once() {
        for cells in [1u32, 2, 8, 32] {
            let inner: u32 = levels(cells)
                .map(|(step, diagonal)| {
                    let across = if diagonal { cells / (2 * step) } else { cells / step + 1 };
                    if diagonal { across * across } else { across * across / 2 }
                })
                .sum();
            // All but the four corners, which have no error.
            assert_eq!(inner, (cells + 1).pow(2) - 4, "{cells}");
        }
        assert_eq!([2, 3, 5, 100, 1024, 1025].map(grid_cells), [1, 2, 4, 128, 1024, 1024]);
    }
}
