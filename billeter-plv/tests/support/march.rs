//! A dense march through a shadow map, by `shadow_visible` alone: what a walk through the same map must come to.

use common::gpu::passes::{
    AdditivePipeline, Attachments, begin_pass, bind_group, binding, group_layout, pipeline_layout,
    shader_module,
};
use common::gpu::{
    Ground, MediumUniform, PassTimer, Targets, Uniform, Variant, ViewUniform, bench, light_layout, read_image,
};
use common::image::Image;
use common::shader::{AIRLIGHT, FULLSCREEN, HAZE, KIND, LIGHT, MEDIUM, PHASE, SHADOW, VIEW, compose};
use common::{Scene, View};

const MARCH: &str = "
@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> medium: Medium;
@group(0) @binding(2) var scene_depth: texture_depth_2d;
@group(1) @binding(0) var<uniform> light: Light;
@group(1) @binding(1) var shadow_map: texture_depth_2d_array;

const STEPS: u32 = 2500u;

fn visible(position: vec3f) -> bool {
    var layer = 0u;
    if KIND == LIGHT_POINT {
        layer = shadow_face(position - light.position);
    }
    let clip = light.layers[layer].clip_from_world * vec4f(position, 1.0);
    return shadow_visible(shadow_map, i32(layer), clip, light.shadow_size, 0.0);
}

@fragment
fn fs_march(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let direction = view_ray(view, pixel.xy);
    let depth = textureLoad(scene_depth, vec2i(pixel.xy), 0);
    // Nothing to see behind a hundred metres of these scenes.
    let distance = min(view_distance(view, depth, direction), 100.0);
    var sum = vec3f(0.0);
    if KIND == LIGHT_DIRECTIONAL {
        let step = distance / f32(STEPS);
        for (var i = 0u; i < STEPS; i += 1u) {
            let t = (f32(i) + 0.5) * step;
            if visible(view.eye + t * direction) {
                sum += step * exp(-medium.sigma_t * t);
            }
        }
        sum *= phase(-dot(light.direction, direction));
    } else {
        let foot = foot_of(view.eye, direction, light.position);
        let ends = airlight_breaks(view.eye, direction, distance);
        let low = atan2(ends.x - foot.along, foot.height);
        let step = (atan2(ends.w - foot.along, foot.height) - low) / f32(STEPS);
        for (var i = 0u; i < STEPS; i += 1u) {
            let angle = low + (f32(i) + 0.5) * step;
            let away = foot.height * (tan(angle) * direction - foot.towards);
            if visible(light.position + away) {
                sum += step / foot.height * airlight_at_angle(foot, direction, angle);
            }
        }
    }
    return vec4f(light.strength * medium.sigma_s * sum, 0.0);
}
";

/// The airlight of a scene's only light.
pub(crate) fn march(scene: &Scene, view: &View, shadow_size: u32) -> Image {
    let context = bench::context();
    let (device, queue) = (&context.device, &context.queue);
    let format = context.radiance_format();
    let targets = Targets::new(device, view.width, view.height, format);
    let mut ground = Ground::new(device, queue, scene, format, shadow_size).expect("valid scene");
    ground.prepare(device, queue, scene, view).expect("valid lights");
    let frame_layout = group_layout(device, "march", &[binding::UNIFORM, binding::UNIFORM, binding::DEPTH]);
    let layout = pipeline_layout(device, "march", &[&frame_layout, &light_layout(device)]);
    let source = compose(&[FULLSCREEN, VIEW, PHASE, MEDIUM, LIGHT, KIND, HAZE, AIRLIGHT, SHADOW, MARCH]);
    let pipeline = AdditivePipeline {
        layout: Some(&layout),
        module: &shader_module(device, "march", source),
        entries: ["vs_fullscreen", "fs_march"],
        constants: &Variant::new(&scene.lights[0], &scene.medium).constants(),
        topology: wgpu::PrimitiveTopology::TriangleList,
        buffers: &[],
        depth_stencil: None,
        target: Some(format),
        adds: true,
    };
    let pipeline = pipeline.build(device);
    let (eye, medium) = (Uniform::new(device, "view"), Uniform::new(device, "medium"));
    eye.write(queue, &ViewUniform::from(view));
    medium.write(queue, &MediumUniform::from(&scene.medium));
    let resources = [
        eye.buffer.as_entire_binding(),
        medium.buffer.as_entire_binding(),
        wgpu::BindingResource::TextureView(&targets.depth),
    ];
    let frame = bind_group(device, "march", &frame_layout, resources);
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut timer = PassTimer::off();
    targets.encode_clear(&mut encoder);
    ground.encode_shadows(&mut encoder, &mut timer);
    ground.encode_depth(&mut encoder, &targets, &mut timer);
    let mut pass = begin_pass(&mut encoder, Attachments::onto(&targets.radiance_view), "march", &mut timer);
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &frame, &[]);
    pass.set_bind_group(1, &ground.lights()[0].bind_group, &[]);
    pass.draw(0..3, 0..1);
    drop(pass);
    queue.submit([encoder.finish()]);
    let image = read_image(device, queue, &targets.radiance).expect("the device is there");
    assert_eq!(context.take_error(), None, "the device reports nothing");
    image
}
