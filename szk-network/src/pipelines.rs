//! Everything that is compiled, once for all clouds.

use common::gpu::light_layout;
use common::gpu::passes::{binding, compute_pipeline, pipeline_layout, shader_module};

use crate::{Incidence, Opacity, Options, shaders};

/// All pipelines of a renderer.
pub(crate) struct Pipelines {
    pub(crate) sort: SortPipelines,
    /// Keys of particles, and links from them once they are sorted.
    pub(crate) links: [wgpu::ComputePipeline; 2],
    pub(crate) light: LightPipelines,
    pub(crate) steps: StepPipelines,
    /// Order of splats, and what particles send to the eye.
    pub(crate) view: [wgpu::ComputePipeline; 2],
    pub(crate) splat: wgpu::RenderPipeline,
}

/// Of sorting.
#[derive(Clone)]
pub(crate) struct SortPipelines {
    pub(crate) sort_blocks: wgpu::ComputePipeline,
    pub(crate) compare: wgpu::ComputePipeline,
    pub(crate) merge_blocks: wgpu::ComputePipeline,
}

/// Of direct light.
#[derive(Clone)]
pub(crate) struct LightPipelines {
    pub(crate) voxels_group: wgpu::BindGroupLayout,
    pub(crate) voxels: wgpu::ComputePipeline,
    pub(crate) arrivals_group: wgpu::BindGroupLayout,
    pub(crate) arrivals: wgpu::ComputePipeline,
    pub(crate) sums: [wgpu::ComputePipeline; 2],
    pub(crate) scale: wgpu::ComputePipeline,
    pub(crate) sources: wgpu::ComputePipeline,
}

/// Of a step of the iteration.
pub(crate) struct StepPipelines {
    pub(crate) propagate: wgpu::ComputePipeline,
    pub(crate) propagate_moments: wgpu::ComputePipeline,
    pub(crate) residual: wgpu::ComputePipeline,
    pub(crate) moments: wgpu::ComputePipeline,
    pub(crate) expand: wgpu::ComputePipeline,
    pub(crate) full: wgpu::ComputePipeline,
    pub(crate) tiled: wgpu::ComputePipeline,
}

impl Pipelines {
    pub(crate) fn new(device: &wgpu::Device, options: &Options) -> Self {
        let flag = |on: bool| f64::from(u8::from(on));
        let per_link = [("per_link", flag(options.opacity == Opacity::Link))];
        let per_fragment = ("per_fragment", flag(options.per_fragment));
        let module = shader_module(device, "szk-network: links", shaders::links());
        let links = ["cs_keys", "cs_links"].map(|e| compute_pipeline(device, &module, None, e, &per_link));
        let module = shader_module(device, "szk-network: scatter", shaders::scatter());
        let step = |entry| compute_pipeline(device, &module, None, entry, &per_link);
        let steps = StepPipelines {
            propagate: step("cs_propagate"),
            propagate_moments: step("cs_propagate_moments"),
            residual: step("cs_residual"),
            moments: step("cs_moments"),
            expand: step("cs_expand"),
            full: step("cs_full"),
            tiled: step("cs_tiled"),
        };
        let light = LightPipelines::new(device, options, step("cs_sources"));
        let module = shader_module(device, "szk-network: view", shaders::view());
        let constants = [per_link[0], per_fragment];
        let view =
            ["cs_order", "cs_radiances"].map(|e| compute_pipeline(device, &module, None, e, &constants));
        let sort = SortPipelines::new(device);
        Self { sort, links, light, steps, view, splat: splat_pipeline(device, options) }
    }
}

impl SortPipelines {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let module = shader_module(device, "szk-network: sort", shaders::sort());
        let pipeline = |entry| compute_pipeline(device, &module, None, entry, &[]);
        Self {
            sort_blocks: pipeline("cs_sort_blocks"),
            compare: pipeline("cs_compare"),
            merge_blocks: pipeline("cs_merge_blocks"),
        }
    }
}
impl LightPipelines {
    fn new(device: &wgpu::Device, options: &Options, sources: wgpu::ComputePipeline) -> Self {
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
        Self { voxels_group, voxels, arrivals_group, arrivals, sums, scale, sources }
    }
}

fn splat_pipeline(device: &wgpu::Device, options: &Options) -> wgpu::RenderPipeline {
    let flag = |on: bool| f64::from(u8::from(on));
    let per_fragment = ("per_fragment", flag(options.per_fragment));
    let module = shader_module(device, "szk-network: splat", shaders::splat());
    let compilation_options = wgpu::PipelineCompilationOptions {
        constants: &[
            per_fragment,
            ("corrected", flag(options.corrected)),
            ("samples", f64::from(options.samples)),
        ],
        ..Default::default()
    };
    // What is behind is let through by as much as is not opaque.
    let over = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
        operation: wgpu::BlendOperation::Add,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("szk-network: splat"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vs_splat"),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..Default::default()
        },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fs_splat"),
            compilation_options,
            targets: &[Some(wgpu::ColorTargetState {
                format: options.target_format,
                blend: Some(wgpu::BlendState { color: over, alpha: over }),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}
