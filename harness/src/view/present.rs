//! From radiance to what the window shows.

use common::gpu::passes::{
    AdditivePipeline, Attachments, begin_pass, bind_group, drawn_texture, shader_module,
};
use common::gpu::{Context, PassTimer, Uniform};
use common::image::Image;
use common::shader::{FULLSCREEN, compose};
use eframe::egui;
use eframe::egui_wgpu::RenderState;
use encase::ShaderType;

/// A pipeline that shows pictures, and the picture shown last.
pub(super) struct Presenter {
    pipeline: wgpu::RenderPipeline,
    shown: Uniform<Shown>,
    /// As many bytes for each pixel as a screen has; and what the window knows it by.
    target: Option<(wgpu::Texture, Option<egui::TextureId>)>,
}

/// Twin of WGSL `Shown`.
#[derive(Clone, Copy, Debug, ShaderType)]
struct Shown {
    exposure: f32,
    divided: f32,
}

/// The window draws sRGB numbers as they are.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// The WGSL, composed.
pub(super) fn shader() -> String {
    compose(&[FULLSCREEN, include_str!("present.wgsl")])
}

impl Presenter {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        let module = shader_module(device, "view: present", shader());
        let pipeline = AdditivePipeline {
            layout: None,
            module: &module,
            entries: ["vs_fullscreen", "fs_present"],
            constants: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            buffers: &[],
            depth_stencil: None,
            target: Some(FORMAT),
            adds: false,
        };
        let pipeline = pipeline.build(device);
        Self { pipeline, shown: Uniform::new(device, "view: shown"), target: None }
    }

    /// Draws `first` to the left of `divided` (share of the width) and `second` to its right.
    pub(super) fn draw(
        &mut self,
        context: &Context,
        [first, second]: [&wgpu::Texture; 2],
        exposure: f32,
        divided: f32,
    ) {
        let Context { device, queue, .. } = context;
        let size = (first.width(), first.height());
        let fits = |target: &wgpu::Texture| (target.width(), target.height()) == size;
        if !self.target.as_ref().is_some_and(|(target, _)| fits(target)) {
            let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
            let target = drawn_texture(device, "view: shown", size, FORMAT, usage);
            let known = self.target.take().and_then(|(_, known)| known);
            self.target = Some((target, known));
        }
        let Some((target, _)) = &self.target else { return };
        self.shown.write(queue, &Shown { exposure, divided });
        let [first, second] = [first, second].map(|texture| texture.create_view(&Default::default()));
        let resources = [
            self.shown.buffer.as_entire_binding(),
            wgpu::BindingResource::TextureView(&first),
            wgpu::BindingResource::TextureView(&second),
        ];
        let group = bind_group(device, "view: shown", &self.pipeline.get_bind_group_layout(0), resources);
        let view = target.create_view(&Default::default());
        let mut encoder = device.create_command_encoder(&Default::default());
        let mut pass =
            begin_pass(&mut encoder, Attachments::onto(&view), "view: present", &mut PassTimer::off());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        queue.submit([encoder.finish()]);
    }

    /// What the window may show; none before the first picture.
    pub(super) fn texture(&mut self, window: &RenderState) -> Option<egui::TextureId> {
        let (target, known) = self.target.as_mut()?;
        let view = target.create_view(&Default::default());
        let mut renderer = window.renderer.write();
        let filter = wgpu::FilterMode::Nearest;
        match known {
            Some(id) => renderer.update_egui_texture_from_wgpu_texture(&window.device, &view, filter, *id),
            None => *known = Some(renderer.register_native_texture(&window.device, &view, filter)),
        }
        *known
    }

    /// The texture that was drawn last.
    #[cfg(test)]
    pub(super) fn target(&self) -> Option<&wgpu::Texture> {
        self.target.as_ref().map(|(target, _)| target)
    }
}

/// A picture from the CPU as a texture of linear radiance.
pub(super) fn upload(context: &Context, image: &Image) -> wgpu::Texture {
    let size = wgpu::Extent3d { width: image.width, height: image.height, depth_or_array_layers: 1 };
    let texture = context.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("view: reference"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels: Vec<f32> = image.pixels.iter().flat_map(|pixel| pixel.extend(1.0).to_array()).collect();
    context.queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&texels),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(16 * image.width),
            rows_per_image: None,
        },
        size,
    );
    texture
}
