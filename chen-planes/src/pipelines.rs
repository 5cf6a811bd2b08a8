//! The pipeline that draws planes, and the layout of what it binds.

use common::DepthRange;
use common::gpu::passes::{AdditivePipeline, binding, group_layout, pipeline_layout, shader_module};
use common::gpu::{Variant, light_layout};

use crate::renderer::PlaneData;
use crate::{Factor, Options, Visibility, shaders};

/// Layouts of the bind groups.
pub(crate) struct Layouts {
    /// View, medium, sampling, depth, phase function; group 1 is the light's.
    pub(crate) frame: wgpu::BindGroupLayout,
}

impl Layouts {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        use binding::{DEPTH, TEXTURE, UNIFORM};
        Self {
            frame: group_layout(device, "chen-planes: frame", &[UNIFORM, UNIFORM, UNIFORM, DEPTH, TEXTURE]),
        }
    }
}

/// The test that ends rays at the scene before fragments behind it are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DepthTest {
    format: wgpu::TextureFormat,
    compare: wgpu::CompareFunction,
}

impl DepthTest {
    /// Against the caller's depth; none where it can't be attached. The shader ends rays in any case.
    pub(crate) fn of(depth: &wgpu::TextureView, range: DepthRange) -> Option<Self> {
        let (format, usage) = (depth.texture().format(), depth.texture().usage());
        // A view for sampling has no stencil, one for attaching has all that there is.
        let attachable =
            usage.contains(wgpu::TextureUsages::RENDER_ATTACHMENT) && !format.has_stencil_aspect();
        // Equal passes: what begins beyond a far plane has the depth of what is empty.
        let compare = if range.reversed {
            wgpu::CompareFunction::GreaterEqual
        } else {
            wgpu::CompareFunction::LessEqual
        };
        attachable.then_some(Self { format, compare })
    }
}

/// Draws all planes of a light of that kind: the pattern once for each.
pub(crate) fn planes_pipeline(
    device: &wgpu::Device,
    layouts: &Layouts,
    options: &Options,
    format: wgpu::TextureFormat,
    variant: Variant,
    test: Option<DepthTest>,
) -> wgpu::RenderPipeline {
    let factor = match options.factor {
        Factor::Whole => 0.0,
        Factor::Attenuation => 1.0,
        Factor::Integrated => 2.0,
    };
    let samples = match options.visibility {
        Visibility::PerLatticePoint => 0.0,
        Visibility::PerFragment { samples } => f64::from(samples),
    };
    let offset = f64::from(u8::from(options.offset));
    let mut constants = variant.constants();
    constants.extend([("factor", factor), ("samples", samples), ("pixel_offset", offset)]);
    let points = wgpu::VertexBufferLayout {
        array_stride: 8,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x2],
    };
    let planes = wgpu::VertexBufferLayout {
        array_stride: size_of::<PlaneData>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4],
    };
    let label = "chen-planes: planes";
    let layout = pipeline_layout(device, label, &[&layouts.frame, &light_layout(device)]);
    AdditivePipeline {
        layout: Some(&layout),
        module: &shader_module(device, label, shaders::planes()),
        entries: ["vs_plane", "fs_plane"],
        constants: &constants,
        topology: wgpu::PrimitiveTopology::TriangleList,
        buffers: &[Some(points), Some(planes)],
        depth_stencil: test.map(|DepthTest { format, compare }| wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(false),
            depth_compare: Some(compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        target: Some(format),
        adds: true,
    }
    .build(device)
}
