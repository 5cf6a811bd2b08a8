//! Render pipelines and the layouts of what they bind.

use wgpu::{CompareFunction, StencilOperation};

use crate::{Airlight, Counting, Indirect, Options, shaders};

/// Format of the stencil that shadows are counted in.
pub(crate) const STENCIL: wgpu::TextureFormat = wgpu::TextureFormat::Stencil8;

/// Stencil reference of all passes; see [`ordered`].
pub(crate) const REFERENCE: u32 = 1;

/// Layouts of the bind groups.
pub(crate) struct Layouts {
    /// View, medium, depth, airlight tables.
    pub(crate) frame: wgpu::BindGroupLayout,
    /// Light, volume, planes, caps.
    pub(crate) light: wgpu::BindGroupLayout,
    /// Normals, diffuse, specular, Lambert tables, Phong tables.
    pub(crate) surfaces: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let visibility = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = |label, types: &[wgpu::BindingType]| {
            let entry = |(binding, &ty)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
            let entries: Vec<_> = (0..).zip(types).map(entry).collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &entries,
            })
        };
        let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let uniform = buffer(wgpu::BufferBindingType::Uniform);
        let storage = buffer(wgpu::BufferBindingType::Storage { read_only: true });
        let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        };
        let unfiltered = wgpu::TextureSampleType::Float { filterable: false };
        let depth = texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2);
        let flat = texture(unfiltered, wgpu::TextureViewDimension::D2);
        let tables = texture(unfiltered, wgpu::TextureViewDimension::D2Array);
        Self {
            frame: layout("biri-ss: frame", &[uniform, uniform, depth, tables]),
            light: layout("biri-ss: light", &[uniform, uniform, storage, storage]),
            surfaces: layout("biri-ss: surfaces", &[flat, flat, flat, tables, tables]),
        }
    }
}

/// All pipelines.
pub(crate) struct Pipelines {
    /// Counts planes and caps behind the scene.
    pub(crate) count_planes: wgpu::RenderPipeline,
    pub(crate) count_caps: wgpu::RenderPipeline,
    /// Adds and takes away airlight at shadow planes.
    pub(crate) planes: wgpu::RenderPipeline,
    /// Airlight up to lit surfaces.
    pub(crate) lit: wgpu::RenderPipeline,
    pub(crate) direct: wgpu::RenderPipeline,
    pub(crate) indirect: wgpu::RenderPipeline,
    pub(crate) ambient: wgpu::RenderPipeline,
    pub(crate) ambient_surface: wgpu::RenderPipeline,
    pub(crate) add: wgpu::RenderPipeline,
}

/// One stencil face: which fragments pass, and what all of them do to the count.
fn face(compare: CompareFunction, op: StencilOperation) -> wgpu::StencilFaceState {
    wgpu::StencilFaceState { compare, fail_op: op, depth_fail_op: op, pass_op: op }
}

/// The stencil of the ordered pass. A count is the number of shadows that the ray is in; only planes between
/// none and one part light from shadow. The reference is 1: `Greater` passes where the count is 0.
fn ordered(counting: Counting) -> [wgpu::StencilFaceState; 2] {
    let (outside, inside) = (CompareFunction::Greater, CompareFunction::Equal);
    let (more, less) = (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap);
    match counting {
        // Walking away from the eye, a front face leads into a shadow.
        Counting::FromEye => [face(outside, more), face(inside, less)],
        // Walking towards the eye, out of one.
        Counting::DepthFail => [face(inside, less), face(outside, more)],
    }
}

impl Pipelines {
    pub(crate) fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        options: &Options,
        accumulation: wgpu::TextureFormat,
    ) -> Self {
        let module = |label, source: String| {
            device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(label),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            })
        };
        let planes = module("biri-ss: shadow planes", shaders::planes());
        let surfaces = module("biri-ss: surfaces", shaders::surfaces());
        let add = module("biri-ss: add airlight", shaders::add());
        let layout = |label, groups: &[Option<&wgpu::BindGroupLayout>]| {
            device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: groups,
                immediate_size: 0,
            })
        };
        let of_planes = layout("biri-ss: planes", &[Some(&layouts.frame), Some(&layouts.light)]);
        let of_surfaces = layout(
            "biri-ss: surfaces",
            &[Some(&layouts.frame), Some(&layouts.light), Some(&layouts.surfaces)],
        );
        let form = match options.airlight {
            Airlight::Quadrature { .. } => 0.0,
            Airlight::Gamma { .. } => 1.0,
            Airlight::GammaRest { .. } => 2.0,
        };
        let airlight = [("airlight_form", form)];
        let as_direct = [("as_direct", f64::from(u8::from(options.indirect == Indirect::Unclamped)))];
        let clamp = [("clamp_negative", f64::from(u8::from(options.clamp_negative)))];
        let (list, strip) = (wgpu::PrimitiveTopology::TriangleList, wgpu::PrimitiveTopology::TriangleStrip);
        let keep = StencilOperation::Keep;
        let lit = [face(CompareFunction::Greater, keep); 2];
        let (more, less) = (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap);
        let count = [face(CompareFunction::Always, less), face(CompareFunction::Always, more)];
        let build = |build: Build<'_>| build.build(device);
        let base = Build {
            layout: Some(&of_planes),
            module: &planes,
            entries: ["vs_plane", "fs_plane"],
            constants: &[],
            topology: strip,
            stencil: None,
            target: None,
        };
        let target = Some(options.target_format);
        let everywhere = ["vs_everywhere", "fs_lit"];
        let full = Build {
            layout: Some(&of_surfaces),
            module: &surfaces,
            topology: list,
            target,
            entries: ["vs_fullscreen", "fs_direct"],
            ..base
        };
        Self {
            count_planes: build(Build { entries: ["vs_plane", "fs_count"], stencil: Some(count), ..base }),
            count_caps: build(Build {
                entries: ["vs_cap", "fs_cap"],
                topology: list,
                stencil: Some(count),
                ..base
            }),
            planes: build(Build {
                constants: &airlight,
                stencil: Some(ordered(options.counting)),
                target: Some(accumulation),
                ..base
            }),
            lit: build(Build {
                entries: everywhere,
                constants: &airlight,
                topology: list,
                stencil: Some(lit),
                target: Some(accumulation),
                ..base
            }),
            direct: build(Build { stencil: Some(lit), ..full }),
            indirect: build(Build {
                entries: ["vs_fullscreen", "fs_indirect"],
                constants: &as_direct,
                ..full
            }),
            ambient: build(Build {
                entries: ["vs_everywhere", "fs_ambient"],
                topology: list,
                target,
                ..base
            }),
            ambient_surface: build(Build { entries: ["vs_fullscreen", "fs_ambient_surface"], ..full }),
            add: build(Build {
                layout: None,
                module: &add,
                entries: ["vs_fullscreen", "fs_add"],
                constants: &clamp,
                topology: list,
                target,
                ..base
            }),
        }
    }
}

/// What differs between pipelines.
#[derive(Clone, Copy)]
struct Build<'a> {
    layout: Option<&'a wgpu::PipelineLayout>,
    module: &'a wgpu::ShaderModule,
    entries: [&'a str; 2],
    constants: &'a [(&'a str, f64)],
    topology: wgpu::PrimitiveTopology,
    /// Front and back faces.
    stencil: Option<[wgpu::StencilFaceState; 2]>,
    /// Added to.
    target: Option<wgpu::TextureFormat>,
}

impl Build<'_> {
    /// No depth test, both sides drawn.
    fn build(self, device: &wgpu::Device) -> wgpu::RenderPipeline {
        let add = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let targets: Vec<_> = self
            .target
            .into_iter()
            .map(|format| {
                let blend = Some(wgpu::BlendState { color: add, alpha: add });
                Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
            })
            .collect();
        // One shadow plane's number for each instance.
        let number = wgpu::VertexBufferLayout {
            array_stride: 4,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &[wgpu::VertexAttribute {
                format: wgpu::VertexFormat::Uint32,
                offset: 0,
                shader_location: 0,
            }],
        };
        let numbered = [Some(number)];
        let [vertex, fragment] = self.entries;
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: self.layout,
            vertex: wgpu::VertexState {
                module: self.module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: if vertex == "vs_plane" { &numbered } else { &[] },
            },
            primitive: wgpu::PrimitiveState { topology: self.topology, ..Default::default() },
            depth_stencil: self.stencil.map(|[front, back]| wgpu::DepthStencilState {
                format: STENCIL,
                depth_write_enabled: None,
                depth_compare: None,
                stencil: wgpu::StencilState { front, back, read_mask: 0xff, write_mask: 0xff },
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: self.module,
                entry_point: Some(fragment),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: self.constants,
                    ..Default::default()
                },
                targets: &targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
