//! Render pipelines and the layouts of what they bind.

use common::gpu::passes::{AdditivePipeline, binding, group_layout, pipeline_layout, shader_module};
use wgpu::{CompareFunction, StencilOperation};

use crate::{Airlight, Counting, Indirect, Options, shaders};

/// Format of the stencil that shadows are counted in.
pub(crate) const STENCIL: wgpu::TextureFormat = wgpu::TextureFormat::Stencil8;

/// Format of what the planes of a ray have in common.
pub(crate) const RAYS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

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
    /// What the planes of each ray have in common.
    pub(crate) rays: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        use binding::{DEPTH, STORAGE, TABLES, TEXTURE, UNIFORM};
        let layout = |label, types: &[_]| group_layout(device, label, types);
        Self {
            frame: layout("biri-ss: frame", &[UNIFORM, UNIFORM, DEPTH, TABLES]),
            light: layout("biri-ss: light", &[UNIFORM, UNIFORM, STORAGE, STORAGE]),
            surfaces: layout("biri-ss: surfaces", &[TEXTURE, TEXTURE, TEXTURE, TABLES, TABLES]),
            rays: layout("biri-ss: rays", &[TEXTURE]),
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
    /// What the planes of each ray have in common, and what is left at its beginning; if they share that.
    pub(crate) shared: Option<[wgpu::RenderPipeline; 2]>,
    pub(crate) direct: wgpu::RenderPipeline,
    pub(crate) indirect: wgpu::RenderPipeline,
    pub(crate) ambient: wgpu::RenderPipeline,
    pub(crate) ambient_surface: wgpu::RenderPipeline,
}

/// One stencil face: which fragments pass, and what all of them do to the count.
fn face(compare: CompareFunction, op: StencilOperation) -> wgpu::StencilFaceState {
    wgpu::StencilFaceState { compare, fail_op: op, depth_fail_op: op, pass_op: op }
}

/// What front and back faces do to the stencil; there is no depth test.
fn stencil([front, back]: [wgpu::StencilFaceState; 2]) -> Option<wgpu::DepthStencilState> {
    Some(wgpu::DepthStencilState {
        format: STENCIL,
        depth_write_enabled: None,
        depth_compare: None,
        stencil: wgpu::StencilState { front, back, read_mask: 0xff, write_mask: 0xff },
        bias: Default::default(),
    })
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
        let planes = shader_module(device, "biri-ss: shadow planes", shaders::planes());
        let surfaces = shader_module(device, "biri-ss: surfaces", shaders::surfaces());
        let Layouts { frame, light, surfaces: textures, rays } = layouts;
        let of_rays = pipeline_layout(device, "biri-ss: planes of rays", &[frame, light, rays]);
        let of_planes = pipeline_layout(device, "biri-ss: planes", &[frame, light]);
        let of_surfaces = pipeline_layout(device, "biri-ss: surfaces", &[frame, light, textures]);
        let form = match options.airlight {
            Airlight::Quadrature { .. } => 0.0,
            Airlight::Gamma { .. } => 1.0,
            Airlight::GammaRest { .. } => 2.0,
        };
        let as_direct = f64::from(u8::from(options.indirect == Indirect::Unclamped));
        let (list, strip) = (wgpu::PrimitiveTopology::TriangleList, wgpu::PrimitiveTopology::TriangleStrip);
        // One shadow plane's number for each instance.
        let numbers = [Some(wgpu::VertexBufferLayout {
            array_stride: 4,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![0 => Uint32],
        })];
        let (more, less) = (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap);
        let count = stencil([face(CompareFunction::Always, less), face(CompareFunction::Always, more)]);
        let target = Some(options.target_format);
        let lit = AdditivePipeline {
            layout: Some(&of_planes),
            module: &planes,
            entries: ["vs_everywhere", "fs_lit"],
            constants: &[("airlight_form", form)],
            topology: list,
            buffers: &[],
            depth_stencil: stencil([face(CompareFunction::Greater, StencilOperation::Keep); 2]),
            target: Some(accumulation),
            adds: true,
        };
        let direct = AdditivePipeline {
            layout: Some(&of_surfaces),
            module: &surfaces,
            entries: ["vs_fullscreen", "fs_direct"],
            constants: &[("as_direct", as_direct)],
            target,
            ..lit.clone()
        };
        let shared = options.shared_beginning.then(|| {
            let everywhere = AdditivePipeline { depth_stencil: None, ..lit.clone() };
            let alone = AdditivePipeline { adds: false, target: Some(RAYS), ..everywhere.clone() };
            let entries = |fragment| ["vs_everywhere", fragment];
            let beginning = AdditivePipeline {
                layout: Some(&of_rays),
                entries: entries("fs_beginning"),
                depth_stencil: stencil([face(CompareFunction::Always, StencilOperation::Keep); 2]),
                ..everywhere
            };
            [AdditivePipeline { entries: entries("fs_ray"), ..alone }, beginning].map(|p| p.build(device))
        });
        let (of_planes, plane_entries, lit_entries) = if options.shared_beginning {
            (&of_rays, ["vs_plane", "fs_plane_rest"], ["vs_everywhere", "fs_lit_rest"])
        } else {
            (&of_planes, ["vs_plane", "fs_plane"], lit.entries)
        };
        let plain = lit.clone();
        let lit = AdditivePipeline { layout: Some(of_planes), entries: lit_entries, ..lit };
        let planes = AdditivePipeline {
            entries: plane_entries,
            topology: strip,
            buffers: &numbers,
            depth_stencil: stencil(ordered(options.counting)),
            ..lit.clone()
        };
        let [ambient_surface, indirect] = ["fs_ambient_surface", "fs_indirect"].map(|fragment| {
            let entries = ["vs_fullscreen", fragment];
            AdditivePipeline { entries, depth_stencil: None, ..direct }.build(device)
        });
        let count_planes = AdditivePipeline {
            entries: ["vs_plane", "fs_count"],
            depth_stencil: count.clone(),
            target: None,
            layout: plain.layout,
            ..planes
        };
        let count_caps = AdditivePipeline {
            entries: ["vs_cap", "fs_cap"],
            depth_stencil: count,
            target: None,
            ..plain.clone()
        };
        let ambient = AdditivePipeline {
            entries: ["vs_everywhere", "fs_ambient"],
            depth_stencil: None,
            target,
            ..plain
        };
        Self {
            count_planes: count_planes.build(device),
            count_caps: count_caps.build(device),
            planes: planes.build(device),
            lit: lit.build(device),
            shared,
            direct: direct.build(device),
            indirect,
            ambient: ambient.build(device),
            ambient_surface,
        }
    }
}
