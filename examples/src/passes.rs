//! The renderer's pipelines.

use crate::depth::Depth;
use crate::scene::Vertex;

/// All pipelines but those that show a picture.
pub struct Passes {
    /// Depth as a light sees it.
    pub shadow: wgpu::RenderPipeline,
    /// Surfaces.
    pub scene: wgpu::RenderPipeline,
}

impl Passes {
    /// Pipelines for depth of that kind and radiance in that format.
    pub fn new(device: &wgpu::Device, depth: Depth, radiance: wgpu::TextureFormat) -> Self {
        let shadow = device.create_shader_module(wgpu::include_wgsl!("../shaders/shadow.wgsl"));
        let scene = device.create_shader_module(wgpu::include_wgsl!("../shaders/scene.wgsl"));
        Self {
            shadow: pipeline(device, &shadow, ["vs_shadow", ""], Some(depth), None),
            scene: pipeline(device, &scene, ["vs_scene", "fs_scene"], Some(depth), Some(radiance)),
        }
    }
}

/// Shows radiance as a picture of that format.
pub fn tone_pipeline(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("../shaders/tone.wgsl"));
    pipeline(device, &module, ["vs_tone", "fs_tone"], None, Some(format))
}

/// With depth, of vertices; else of one triangle that covers the target.
fn pipeline(
    device: &wgpu::Device,
    module: &wgpu::ShaderModule,
    [vertex, fragment]: [&str; 2],
    depth: Option<Depth>,
    target: Option<wgpu::TextureFormat>,
) -> wgpu::RenderPipeline {
    let vertices = wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x3],
    };
    let buffers = [Some(vertices)];
    let targets = target.map(|format| Some(format.into()));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(vertex),
        layout: None,
        vertex: wgpu::VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: if depth.is_some() { &buffers } else { &[] },
        },
        primitive: Default::default(),
        depth_stencil: depth.map(|depth| wgpu::DepthStencilState {
            format: depth.format(),
            depth_write_enabled: Some(true),
            depth_compare: Some(depth.nearer()),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: target.is_some().then(|| wgpu::FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets: targets.as_slice(),
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// A texture that is drawn into and read from.
pub fn texture(
    device: &wgpu::Device,
    label: &str,
    [width, height]: [u32; 2],
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
        usage: usage | wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

/// Begins a pass that clears its target to black.
pub fn begin<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    label: &str,
    color: Option<&wgpu::TextureView>,
    depth: Option<(&wgpu::TextureView, Depth)>,
) -> wgpu::RenderPass<'a> {
    let color = color.map(|view| {
        let ops =
            wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store };
        Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
    });
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: color.as_slice(),
        depth_stencil_attachment: depth.map(|(view, depth)| wgpu::RenderPassDepthStencilAttachment {
            view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(depth.empty()),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    })
}
