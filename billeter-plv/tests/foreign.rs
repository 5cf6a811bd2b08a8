//! Shadow maps that another program drew, against the ground's own of the same resolution.

mod support;

use billeter_plv::{Inputs, Options, Renderer};
use common::gpu::bench::context;
use common::gpu::passes::{
    AdditivePipeline, Attachments, begin_pass, bind_group, drawn_texture, shader_module,
};
use common::gpu::{ForeignMap, Ground, MapError, PassTimer, Targets, read_image};
use common::image::Image;
use common::{Light, Scene};
use glam::camera::rh::{proj::directx, view};
use glam::{Mat4, Vec3, Vec4};
use support::{boxes, errors, point, spot, sun};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

const SIZE: u32 = 512;

const SHADER: &str = "
    @group(0) @binding(0) var<uniform> clip_from_world: mat4x4f;
    @vertex fn vs(@location(0) position: vec3f) -> @builtin(position) vec4f {
        return clip_from_world * vec4f(position, 1.0);
    }
    @fragment fn fs() {}";

/// A map as another program draws it: with any matrices, in any format, standard or reversed.
fn draw_map(scene: &Scene, matrices: &[Mat4], format: wgpu::TextureFormat, reversed: bool) -> wgpu::Texture {
    let (device, queue) = (&context().device, &context().queue);
    let corners: Vec<Vec3> = scene.world_triangles().iter().flat_map(|triangle| triangle.positions).collect();
    let buffer = |contents: &[u8], usage| {
        device.create_buffer_init(&BufferInitDescriptor { label: Some("test"), contents, usage })
    };
    let vertices = buffer(bytemuck::cast_slice(&corners), wgpu::BufferUsages::VERTEX);
    let compare = if reversed { wgpu::CompareFunction::Greater } else { wgpu::CompareFunction::Less };
    let pipeline = AdditivePipeline {
        layout: None,
        module: &shader_module(device, "test", SHADER.into()),
        entries: ["vs", "fs"],
        constants: &[],
        topology: wgpu::PrimitiveTopology::TriangleList,
        buffers: &[Some(wgpu::VertexBufferLayout {
            array_stride: 12,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3],
        })],
        depth_stencil: Some(wgpu::DepthStencilState {
            format,
            depth_write_enabled: Some(true),
            depth_compare: Some(compare),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        target: None,
        adds: false,
    }
    .build(device);
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("foreign map"),
        size: wgpu::Extent3d { width: SIZE, height: SIZE, depth_or_array_layers: matrices.len() as u32 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    for (layer, matrix) in (0..).zip(matrices) {
        let uniform = buffer(bytemuck::bytes_of(matrix), wgpu::BufferUsages::UNIFORM);
        let group =
            bind_group(device, "test", &pipeline.get_bind_group_layout(0), [uniform.as_entire_binding()]);
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: layer,
            array_layer_count: Some(1),
            ..Default::default()
        });
        let clear = wgpu::LoadOp::Clear(if reversed { 0.0 } else { 1.0 });
        let depth_stencil = Some(wgpu::RenderPassDepthStencilAttachment {
            view: &view,
            depth_ops: Some(wgpu::Operations { load: clear, store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        });
        let attachments = Attachments { color: None, depth_stencil };
        let mut pass = begin_pass(&mut encoder, attachments, "test", &mut PassTimer::off());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.draw(0..corners.len() as u32, 0..1);
    }
    queue.submit([encoder.finish()]);
    texture
}

/// What another program has drawn, and how.
struct Map<'a> {
    matrices: &'a [Mat4],
    format: wgpu::TextureFormat,
    reversed: bool,
}

/// Airlight with the ground's own map, or with another program's.
fn draw(scene: &Scene, options: &Options, map: Option<Map<'_>>) -> Image {
    let (device, queue) = (&context().device, &context().queue);
    let view = scene.camera.view(48, 36);
    let targets = Targets::new(device, 48, 36, options.target_format);
    let mut ground = Ground::new(device, queue, scene, options.target_format, SIZE).unwrap();
    ground.prepare(device, queue, scene, &view).unwrap();
    let mut lights = ground.lights().to_vec();
    let foreign = map.map(|Map { matrices, format, reversed }| {
        let texture = draw_map(scene, matrices, format, reversed);
        let mut foreign = ForeignMap::new(&texture, 0..matrices.len() as u32).unwrap();
        let bounds = scene.bounds().unwrap();
        lights = vec![foreign.prepare(device, queue, &scene.lights[0], matrices, bounds).unwrap()];
        foreign
    });
    let mut renderer = Renderer::new(device, queue, options).unwrap();
    let inputs = Inputs { view: &view, medium: &scene.medium, lights: &lights, depth: &targets.depth };
    renderer.prepare(device, queue, &inputs).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut timer = PassTimer::off();
    targets.encode_clear(&mut encoder);
    match &foreign {
        Some(foreign) => foreign.encode(&mut encoder, &mut timer),
        None => ground.encode_shadows(&mut encoder, &mut timer),
    }
    ground.encode_depth(&mut encoder, &targets, &mut timer);
    renderer.encode(&mut encoder, &targets.radiance_view, &mut timer);
    queue.submit([encoder.finish()]);
    let image = read_image(device, queue, &targets.radiance).unwrap();
    assert_eq!(context().take_error(), None);
    image
}

/// Both ways to the lit volume.
fn both() -> [(&'static str, Options); 2] {
    let format = context().radiance_format();
    [("mesh", Options::best(format)), ("rays", Options::rays(format))]
}

/// The ground's own projections with another depth: standard, with near and far planes.
fn with_standard_depth(scene: &Scene) -> Vec<Mat4> {
    let projection = common::gpu::shadow_projection(&scene.lights[0], scene.bounds(), SIZE);
    let (near, far) = (0.1, 60.0);
    let standard = |matrix: Mat4| {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| matrix.row(i));
        let z = match scene.lights[0] {
            Light::Directional(_) => w - z,
            _ => (far * w - Vec4::W * near * far) / (far - near),
        };
        Mat4::from_cols(x, y, z, w).transpose()
    };
    projection.layers.iter().map(|layer| standard(layer.clip_from_world)).collect()
}

/// As renderers usually draw: frusta that end at the edges of the map.
fn usual(light: &Light) -> Vec<Mat4> {
    let (near, far) = (0.1, 40.0);
    match light {
        Light::Spot(spot) => {
            let projection = directx::perspective(2.0 * spot.outer_angle, 1.0, near, far);
            vec![projection * view::look_to_mat4(spot.position, spot.direction, Vec3::Y)]
        }
        Light::Directional(sun) => {
            let projection = directx::orthographic(-9.0, 9.0, -9.0, 9.0, 1.0, 21.0);
            vec![projection * view::look_to_mat4(-11.0 * sun.direction, sun.direction, Vec3::Y)]
        }
        Light::Point(point) => {
            // Mirrored, as cube textures have their faces.
            let projection = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0))
                * directx::perspective(std::f32::consts::FRAC_PI_2, 1.0, near, far);
            let ups = [Vec3::NEG_Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::NEG_Y, Vec3::NEG_Y];
            let face = |i: usize| {
                let forward = Vec3::AXES[i / 2] * if i.is_multiple_of(2) { 1.0 } else { -1.0 };
                projection * view::look_to_mat4(point.position, forward, ups[i])
            };
            (0..6).map(face).collect()
        }
    }
}

#[test]
fn texels_of_the_same_places_draw_the_same_picture() {
    for (name, light) in [("point", point()), ("spot", spot(0.3, 0.6)), ("sun", sun())] {
        let scene = boxes(light, 0.1);
        let matrices = with_standard_depth(&scene);
        for (way, options) in both() {
            let own = draw(&scene, &options, None);
            let format = wgpu::TextureFormat::Depth32Float;
            let map = |reversed| Map { matrices: &matrices, format, reversed };
            let (rms, worst) = errors(&draw(&scene, &options, Some(map(false))), &own);
            println!("{name}, {way}: {rms:.1e} rms, {worst:.1e} worst");
            assert!(rms < 5e-5, "{name}, {way}: {rms}");
            // The comparison can fail: cleared and tested the other way, the same texture holds what is farthest.
            let (other, _) = errors(&draw(&scene, &options, Some(map(true))), &own);
            assert!(other > 0.05, "{name}, {way}: {other}");
        }
    }
}

#[test]
fn maps_as_renderers_draw_them_agree_to_the_texel() {
    for (name, light, bound) in
        [("point", point(), 0.002), ("spot", spot(0.3, 0.6), 0.003), ("sun", sun(), 0.006)]
    {
        let matrices = usual(&light);
        let scene = boxes(light, 0.1);
        for (way, options) in both() {
            let own = draw(&scene, &options, None);
            for format in [wgpu::TextureFormat::Depth32Float, wgpu::TextureFormat::Depth24Plus] {
                let map = Map { matrices: &matrices, format, reversed: false };
                let (rms, worst) = errors(&draw(&scene, &options, Some(map)), &own);
                println!("{name}, {way}, {format:?}: {rms:.1e} rms, {worst:.1e} worst");
                assert!(rms < bound, "{name}, {way}, {format:?}: {rms}");
            }
        }
    }
}

#[test]
fn a_map_in_our_conventions_is_read_as_it_is() {
    for (name, light) in [("point", point()), ("spot", spot(0.3, 0.6)), ("sun", sun())] {
        let scene = boxes(light, 0.1);
        let projection = common::gpu::shadow_projection(&scene.lights[0], scene.bounds(), SIZE);
        let matrices: Vec<Mat4> = projection.layers.iter().map(|layer| layer.clip_from_world).collect();
        let format = wgpu::TextureFormat::Depth32Float;
        let (way, options) = both().into_iter().next_back().unwrap();
        let own = draw(&scene, &options, None);
        let map = Map { matrices: &matrices, format, reversed: true };
        let (rms, _) = errors(&draw(&scene, &options, Some(map)), &own);
        assert!(rms < 5e-5, "{name}, {way}: {rms}");
    }
}

#[test]
fn textures_that_cannot_be_read_are_refused_in_a_sentence() {
    let device = &context().device;
    use wgpu::{TextureFormat, TextureUsages};
    let texture = |size, format, usage| drawn_texture(device, "test", size, format, usage);
    let depth = TextureFormat::Depth32Float;
    let bound = TextureUsages::TEXTURE_BINDING;
    for (texture, layers, words) in [
        (texture((8, 8), TextureFormat::Rgba16Float, bound), 0..1, "no depth"),
        (texture((8, 4), depth, bound), 0..1, "square"),
        (texture((8, 8), depth, TextureUsages::COPY_SRC), 0..1, "TEXTURE_BINDING"),
        (texture((8, 8), depth, bound), 0..6, "layers"),
    ] {
        let error = ForeignMap::new(&texture, layers).err().expect("refused").to_string();
        assert!(error.contains(words), "`{error}` says nothing of {words}");
    }
    let scene = boxes(point(), 0.1);
    let mut map = ForeignMap::new(&texture((8, 8), depth, bound), 0..1).unwrap();
    let bounds = scene.bounds().unwrap();
    let queue = &context().queue;
    let error =
        map.prepare(device, queue, &scene.lights[0], &[Mat4::IDENTITY], bounds).err().expect("refused");
    assert_eq!(error, MapError::Count { kind: "point", expected: 6, layers: 1, matrices: 1 });
}
