//! Small things that every technique does to a device: layouts, bindings, pipelines that add, passes.

use super::PassTimer;

/// Types of what a bind group holds, as techniques need them.
pub mod binding {
    use wgpu::{BindingType, BufferBindingType, TextureSampleType, TextureViewDimension};

    const fn buffer(ty: BufferBindingType, has_dynamic_offset: bool) -> BindingType {
        BindingType::Buffer { ty, has_dynamic_offset, min_binding_size: None }
    }

    const fn texture(sample_type: TextureSampleType, view_dimension: TextureViewDimension) -> BindingType {
        BindingType::Texture { sample_type, view_dimension, multisampled: false }
    }

    const UNFILTERED: TextureSampleType = TextureSampleType::Float { filterable: false };

    /// `var<uniform>`.
    pub const UNIFORM: BindingType = buffer(BufferBindingType::Uniform, false);
    /// `var<uniform>`, one of several blocks: bound as [`block`](super::block), at an offset given with the group.
    pub const UNIFORM_AT_OFFSET: BindingType = buffer(BufferBindingType::Uniform, true);
    /// `var<storage, read>`.
    pub const STORAGE: BindingType = buffer(BufferBindingType::Storage { read_only: true }, false);
    /// `texture_depth_2d`.
    pub const DEPTH: BindingType = texture(TextureSampleType::Depth, TextureViewDimension::D2);
    /// `texture_2d<f32>`, read by texel.
    pub const TEXTURE: BindingType = texture(UNFILTERED, TextureViewDimension::D2);
    /// `texture_2d_array<f32>`, read by texel.
    pub const TABLES: BindingType = texture(UNFILTERED, TextureViewDimension::D2Array);
}

/// Layout of a bind group for vertex and fragment shaders, bindings numbered from 0.
pub fn group_layout(
    device: &wgpu::Device,
    label: &str,
    types: &[wgpu::BindingType],
) -> wgpu::BindGroupLayout {
    let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT;
    let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let entries: Vec<_> = (0..).zip(types).map(entry).collect();
    device
        .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// Layout of a pipeline without immediates.
pub fn pipeline_layout(
    device: &wgpu::Device,
    label: &str,
    groups: &[&wgpu::BindGroupLayout],
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(|&group| Some(group)).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}

/// A bind group, bindings numbered from 0.
pub fn bind_group<const N: usize>(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: [wgpu::BindingResource<'_>; N],
) -> wgpu::BindGroup {
    let mut binding = 0..;
    let entries =
        resources.map(|resource| wgpu::BindGroupEntry { binding: binding.next().unwrap_or(0), resource });
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// A block of `bytes` in a buffer of several, for [`binding::UNIFORM_AT_OFFSET`].
pub fn block(buffer: &wgpu::Buffer, bytes: u64) -> wgpu::BindingResource<'_> {
    let size = wgpu::BufferSize::new(bytes);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size })
}

/// A module of composed WGSL.
pub fn shader_module(device: &wgpu::Device, label: &str, source: String) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

/// A pipeline that draws both sides of all faces and, unless told otherwise, adds them to the target.
#[derive(Clone)]
pub struct AdditivePipeline<'a> {
    /// Without one, as the shader has it.
    pub layout: Option<&'a wgpu::PipelineLayout>,
    /// Holds both entry points.
    pub module: &'a wgpu::ShaderModule,
    /// Vertex and fragment shader.
    pub entries: [&'a str; 2],
    /// Values of the shader's overrides.
    pub constants: &'a [(&'a str, f64)],
    /// How vertices become faces.
    pub topology: wgpu::PrimitiveTopology,
    /// What vertices are made of.
    pub buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    /// Which fragments pass.
    pub depth_stencil: Option<wgpu::DepthStencilState>,
    /// Format of the target, if there is one.
    pub target: Option<wgpu::TextureFormat>,
    /// Whether what is drawn is added to the target, or takes its place.
    pub adds: bool,
}

impl AdditivePipeline<'_> {
    /// Makes it.
    pub fn build(&self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let target = self.target.map(|format| {
            let blend = self.adds.then_some(wgpu::BlendState { color: add, alpha: add });
            Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
        });
        let compilation_options =
            wgpu::PipelineCompilationOptions { constants: self.constants, ..Default::default() };
        let [vertex, fragment] = self.entries;
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: self.layout,
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(vertex),
                compilation_options: compilation_options.clone(),
                buffers: self.buffers,
            },
            primitive: wgpu::PrimitiveState { topology: self.topology, ..Default::default() },
            depth_stencil: self.depth_stencil.clone(),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(fragment),
                compilation_options,
                targets: target.as_slice(),
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// A texture of `width` × `height` pixels that passes draw into, and what else `usage` says.
pub fn drawn_texture(
    device: &wgpu::Device,
    label: &str,
    (width, height): (u32, u32),
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    })
}

/// What a pass draws into: a colour target with what it begins with, and a depth or stencil attachment.
#[derive(Default)]
pub struct Attachments<'a> {
    /// Kept at the end.
    pub color: Option<(&'a wgpu::TextureView, wgpu::LoadOp<wgpu::Color>)>,
    /// As the caller has it.
    pub depth_stencil: Option<wgpu::RenderPassDepthStencilAttachment<'a>>,
}

impl<'a> Attachments<'a> {
    /// A colour target that keeps what it holds.
    pub fn onto(view: &'a wgpu::TextureView) -> Self {
        Self { color: Some((view, wgpu::LoadOp::Load)), depth_stencil: None }
    }
}

/// Begins a pass, timed under its label.
pub fn begin_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    attachments: Attachments<'_>,
    label: &'static str,
    timer: &mut PassTimer,
) -> wgpu::RenderPass<'a> {
    let color = attachments.color.map(|(view, load)| {
        let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
        Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: color.as_slice(),
        depth_stencil_attachment: attachments.depth_stencil,
        timestamp_writes: timer.render(label),
        ..Default::default()
    })
}

/// A compute pipeline whose layout is what its shader uses.
pub fn compute_pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    layout: Option<&wgpu::PipelineLayout>,
    entry: &str,
    constants: &[(&str, f64)],
) -> wgpu::ComputePipeline {
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry),
        layout,
        module,
        entry_point: Some(entry),
        compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
        cache: None,
    })
}

/// A bind group of what a shader uses of its bindings: number and resource of each.
pub fn numbered_group(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[(u32, wgpu::BindingResource<'_>)],
) -> wgpu::BindGroup {
    let entries: Vec<_> = resources
        .iter()
        .map(|(binding, resource)| wgpu::BindGroupEntry { binding: *binding, resource: resource.clone() })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// Begins a compute pass, timed under its label.
pub fn begin_compute<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &'static str,
    timer: &mut PassTimer,
) -> wgpu::ComputePass<'a> {
    let timestamp_writes = timer.compute(label);
    encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(label), timestamp_writes })
}
