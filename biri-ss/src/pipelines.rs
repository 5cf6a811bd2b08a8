//! Render pipelines and the layouts of what they bind.

use common::gpu::Variant;
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

/// How a light's airlight is found; each has pipelines of its own, whose shaders hold nothing else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum LightForm {
    /// In closed form.
    Directional,
    /// By table.
    Table,
    /// By quadrature.
    Integrated,
}

/// All pipelines of lights of one form and kind.
#[derive(Clone)]
pub(crate) struct Pipelines {
    /// Counts planes and caps behind the scene.
    pub(crate) count_planes: wgpu::RenderPipeline,
    pub(crate) count_caps: wgpu::RenderPipeline,
    pub(crate) direct: wgpu::RenderPipeline,
    pub(crate) indirect: wgpu::RenderPipeline,
    pub(crate) ambient: wgpu::RenderPipeline,
    pub(crate) ambient_surface: wgpu::RenderPipeline,
    /// Adds and takes away airlight at shadow planes.
    pub(crate) planes: wgpu::RenderPipeline,
    /// Airlight up to lit surfaces.
    pub(crate) lit: wgpu::RenderPipeline,
    /// What the planes of each ray have in common, and what is left at its beginning; if they share that.
    pub(crate) shared: Option<[wgpu::RenderPipeline; 2]>,
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

/// One shadow plane's number for each instance.
const NUMBERS: [Option<wgpu::VertexBufferLayout<'_>>; 1] = [Some(wgpu::VertexBufferLayout {
    array_stride: 4,
    step_mode: wgpu::VertexStepMode::Instance,
    attributes: &wgpu::vertex_attr_array![0 => Uint32],
})];

/// Passes where no shadow is counted.
fn where_lit() -> Option<wgpu::DepthStencilState> {
    stencil([face(CompareFunction::Greater, StencilOperation::Keep); 2])
}

impl Pipelines {
    /// Sums of airlight are kept in `format`.
    pub(crate) fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        options: &Options,
        format: wgpu::TextureFormat,
        (form, variant): (LightForm, Variant),
    ) -> Self {
        let module = shader_module(device, "biri-ss: shadow planes", shaders::planes());
        let surfaces = shader_module(device, "biri-ss: surfaces", shaders::surfaces());
        let Layouts { frame, light, surfaces: textures, rays } = layouts;
        let plain = pipeline_layout(device, "biri-ss: planes", &[frame, light]);
        let of_rays = pipeline_layout(device, "biri-ss: planes of rays", &[frame, light, rays]);
        let of_surfaces = pipeline_layout(device, "biri-ss: surfaces", &[frame, light, textures]);
        let shares = options.shared_beginning && form == LightForm::Table;
        let by_table = match options.airlight {
            Airlight::Gamma { .. } => 1.0,
            Airlight::GammaRest { .. } | Airlight::Quadrature { .. } => 2.0,
        };
        let with = |more: &[_]| [&variant.constants(), more].concat();
        let of_airlight = with(&[("airlight_form", by_table), ("light_form", f64::from(form as u8))]);
        let as_direct = f64::from(u8::from(options.indirect == Indirect::Unclamped));
        let of_light = with(&[("as_direct", as_direct)]);
        let (list, strip) = (wgpu::PrimitiveTopology::TriangleList, wgpu::PrimitiveTopology::TriangleStrip);
        let (more, less) = (StencilOperation::IncrementWrap, StencilOperation::DecrementWrap);
        let count = stencil([face(CompareFunction::Always, less), face(CompareFunction::Always, more)]);

        // Airlight.
        let (layout, [plane, lit]) = if shares {
            (&of_rays, ["fs_plane_rest", "fs_lit_rest"])
        } else {
            (&plain, ["fs_plane", "fs_lit"])
        };
        let lit = AdditivePipeline {
            layout: Some(layout),
            module: &module,
            entries: ["vs_everywhere", lit],
            constants: &of_airlight,
            topology: list,
            buffers: &[],
            depth_stencil: where_lit(),
            target: Some(format),
            adds: true,
        };
        let planes = AdditivePipeline {
            entries: ["vs_plane", plane],
            topology: strip,
            buffers: &NUMBERS,
            depth_stencil: stencil(ordered(options.counting)),
            ..lit.clone()
        };
        let ray = AdditivePipeline {
            layout: Some(&plain),
            entries: ["vs_everywhere", "fs_ray"],
            depth_stencil: None,
            target: Some(RAYS),
            adds: false,
            ..lit.clone()
        };
        let beginning = AdditivePipeline {
            entries: ["vs_everywhere", "fs_beginning"],
            depth_stencil: stencil([face(CompareFunction::Always, StencilOperation::Keep); 2]),
            ..lit.clone()
        };
        let ambient = AdditivePipeline {
            layout: Some(&plain),
            entries: ["vs_everywhere", "fs_ambient"],
            depth_stencil: None,
            target: Some(options.target_format),
            ..lit.clone()
        };
        let count_planes = AdditivePipeline {
            entries: ["vs_plane", "fs_count"],
            topology: strip,
            buffers: &NUMBERS,
            depth_stencil: count.clone(),
            target: None,
            ..ambient.clone()
        };
        let count_caps = AdditivePipeline {
            entries: ["vs_cap", "fs_cap"],
            depth_stencil: count,
            target: None,
            ..ambient.clone()
        };

        // Surfaces.
        let direct = AdditivePipeline {
            layout: Some(&of_surfaces),
            module: &surfaces,
            entries: ["vs_fullscreen", "fs_direct"],
            constants: &of_light,
            depth_stencil: where_lit(),
            ..ambient.clone()
        };
        let [ambient_surface, indirect] = ["fs_ambient_surface", "fs_indirect"].map(|fragment| {
            let entries = ["vs_fullscreen", fragment];
            AdditivePipeline { entries, depth_stencil: None, ..direct.clone() }.build(device)
        });
        Self {
            count_planes: count_planes.build(device),
            count_caps: count_caps.build(device),
            direct: direct.build(device),
            indirect,
            ambient: ambient.build(device),
            ambient_surface,
            planes: planes.build(device),
            lit: lit.build(device),
            shared: shares.then(|| [ray, beginning].map(|pipeline| pipeline.build(device))),
        }
    }
}
