//! The GPU ground: shaders validated, WGSL functions beside their Rust twins, small renders.
#![cfg(all(feature = "gpu", feature = "reference"))]

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use common::gpu::bench::{context, eval_wgsl, validate_wgsl};
use common::gpu::{
    Accumulation, Accumulator, ForeignMap, Ground, PassTimer, SurfaceData, TableFormat, TargetError, Targets,
    fill_buffer, lobe_code, make_buffer, read_depth, read_image, read_u32s, upload_tables,
};
use common::image::Image;
use common::reference::Reference;
use common::scene::{Material, Mesh, Object};
use common::shader::{self, LIGHT, MEDIUM, PHASE, SHADOW, TABLE, VIEW, compose};
use common::table::{Axis, Table2};
use common::terms::{Term, Terms};
use common::{Camera, DepthRange, Light, Lobe, Medium, Phase, PointLight, Scene, SpotLight, View};
use glam::{Affine3A, Vec3, Vec4};

/// Largest difference relative to `scale`.
fn worst(got: &[Vec4], expected: impl Iterator<Item = Vec4>) -> f32 {
    got.iter()
        .zip(expected)
        .map(|(g, e)| (*g - e).abs().max_element() / e.abs().max_element().max(1e-3))
        .fold(0.0, f32::max)
}

#[test]
fn shared_shaders_are_valid_without_optional_features() {
    for chunks in [&[VIEW][..], &[PHASE, MEDIUM], &[LIGHT, SHADOW], &[TABLE], &[shader::FULLSCREEN]] {
        validate_wgsl(&compose(chunks)).unwrap();
    }
    validate_wgsl(&Accumulator::shader()).unwrap();
    validate_wgsl(&ForeignMap::shader()).unwrap();
    // The check can fail: the medium needs the lobes' names no less than the compiler needs types.
    assert!(validate_wgsl("fn broken() -> f32 { return 1u; }").is_err());
}

#[test]
fn phase_functions_are_their_twins() {
    let lobes = [
        Lobe::Isotropic,
        Lobe::Rayleigh,
        Lobe::HenyeyGreenstein { g: 0.76 },
        Lobe::HenyeyGreenstein { g: -0.95 },
        Lobe::HenyeyGreenstein { g: 0.0 },
        Lobe::CornetteShanks { g: 0.5 },
        Lobe::CornetteShanks { g: 0.95 },
        Lobe::MieHazy,
        Lobe::MieMurky,
    ];
    for lobe in lobes {
        let (kind, g) = lobe_code(&lobe);
        let inputs: Vec<Vec4> =
            (0..=64).map(|i| Vec4::new(i as f32 / 32.0 - 1.0, kind as f32, g, 0.0)).collect();
        let got = eval_wgsl(context(), &[PHASE], &[], "", "vec4f(phase_lobe(u32(x.y), x.z, x.x))", &inputs);
        let twin =
            |sign: f64| inputs.iter().map(move |x| Vec4::splat(lobe.eval(sign * f64::from(x.x)) as f32));
        assert!(worst(&got, twin(1.0)) < 2e-5, "{lobe:?}: {}", worst(&got, twin(1.0)));
        if lobe.mean_cosine() != 0.0 {
            assert!(worst(&got, twin(-1.0)) > 0.1, "{lobe:?}: the sign of the cosine matters");
        }
    }
}

#[test]
fn a_spot_falls_off_as_its_twin() {
    let spot = SpotLight {
        position: Vec3::ZERO,
        direction: Vec3::NEG_Z,
        up: Vec3::Y,
        intensity: Vec3::ONE,
        inner_angle: 0.3,
        outer_angle: 0.6,
        light_map: None,
    };
    let inputs: Vec<Vec4> = (0..100).map(|i| Vec4::splat(1.0 - i as f32 * 0.003)).collect();
    let call = |inner: f32, outer: f32| format!("vec4f(light_falloff(x.x, {inner:?}, {outer:?}))");
    let (inner, outer) = (spot.inner_angle.cos(), spot.outer_angle.cos());
    let twin = || inputs.iter().map(|x| Vec4::splat(spot.falloff(x.x)));
    let got = eval_wgsl(context(), &[LIGHT], &[], "", &call(inner, outer), &inputs);
    assert!(worst(&got, twin()) < 1e-4);
    let other = eval_wgsl(context(), &[LIGHT], &[], "", &call(inner, outer - 0.05), &inputs);
    assert!(worst(&other, twin()) > 0.1, "another cone is another falloff");
}

/// WGSL that makes a `view: View` of the rays and the depth of this one.
fn view_in_wgsl(view: &View) -> String {
    let (right, up, forward) = view.camera.basis();
    let half = view.half_extent();
    let [scale, offset] = view.depth.coefficients();
    let v = |v: Vec3| format!("vec3f({:?}, {:?}, {:?})", v.x, v.y, v.z);
    format!(
        "var view: View; view.right = {}; view.up = {}; view.forward = {}; view.width = {:?}; view.height = {:?};
         view.depth_scale = {scale:?}; view.depth_offset = {offset:?};",
        v(right * half.x),
        v(up * half.y),
        v(forward),
        view.width as f32,
        view.height as f32,
    )
}

#[test]
fn rays_are_their_twins() {
    let camera =
        Camera { eye: Vec3::new(1.0, 2.0, 3.0), target: Vec3::new(-4.0, 1.0, 0.5), up: Vec3::Y, fov_y: 1.1 };
    let view = camera.view(64, 40);
    let inputs: Vec<Vec4> =
        (0..64 * 40).map(|i| Vec4::new((i % 64) as f32, (i / 64) as f32, 0.0, 0.0)).collect();
    let expression = "vec4f(view_ray(view, x.xy + 0.5), 1.0)";
    let got = eval_wgsl(context(), &[VIEW], &[], &view_in_wgsl(&view), expression, &inputs);
    let twin = inputs.iter().map(|x| view.ray_direction(x.x as u32, x.y as u32).extend(1.0));
    assert!(worst(&got, twin) < 1e-4);
    let mirrored = inputs.iter().map(|x| view.ray_direction(63 - x.x as u32, x.y as u32).extend(1.0));
    assert!(worst(&got, mirrored) > 0.05, "column 0 is on the left");
}

#[test]
fn distances_are_their_twins() {
    let camera = Camera { target: Vec3::new(-4.0, 1.0, 0.5), ..Camera::default() };
    let endless = f32::INFINITY;
    let range = |far, reversed| DepthRange { near: 0.1, far, reversed };
    let ranges = [range(80.0, false), range(endless, false), range(80.0, true), range(endless, true)];
    // x, y: pixel; z: distance along the viewing direction [m], 0 where nothing is.
    let pixels = (0..400).map(|i| Vec4::new((i % 64) as f32, (i / 10) as f32, (i % 7 * i % 11) as f32, 0.0));
    for depth in ranges {
        let view = View { depth, ..camera.view(64, 40) };
        let stored = |x: &Vec4| if x.z == 0.0 { depth.empty() } else { depth.depth(x.z) };
        let inputs: Vec<Vec4> = pixels.clone().map(|x| x.with_w(stored(&x))).collect();
        let got = eval_wgsl(
            context(),
            &[VIEW],
            &[],
            &view_in_wgsl(&view),
            "vec4f(view_distance(view, x.w, view_ray(view, x.xy + 0.5)), view_depth(view, max(x.z, 1.0)), 0.0, 0.0)",
            &inputs,
        );
        let twin = |view: View| {
            inputs.iter().map(move |x| {
                // 1e30 stands for infinity.
                let distance = view.distance(x.w, x.x as u32, x.y as u32).min(1e30);
                Vec4::new(distance, view.depth.depth(x.z.max(1.0)), 0.0, 0.0)
            })
        };
        // Standard depth keeps few digits of what is far: a rounding of the division shows.
        let off = worst(&got, twin(view));
        assert!(off < 1e-4, "{depth:?}: {off}");
        let far = got.iter().filter(|got| got.x > 1e29).count();
        assert_eq!(far, inputs.iter().filter(|x| x.z == 0.0).count(), "{depth:?}: what is empty is far");
        for other in ranges.into_iter().filter(|other| *other != depth) {
            assert!(worst(&got, twin(View { depth: other, ..view })) > 0.01, "{depth:?} is not {other:?}");
        }
    }
}

#[test]
fn tables_look_up_as_their_twins() {
    let axes = [Axis::Log { low: 1e-2, high: 10.0 }, Axis::Linear { low: 0.0, high: 3.0 }];
    let table = Table2::build(axes, [17, 9], |x, y| (-x).exp() * (1.0 + y));
    let other = Table2::build(axes, [17, 9], |x, y| x + y);
    let inputs: Vec<Vec4> = (0..200)
        .map(|i| {
            let position = [(i * 37 % 200) as f32 / 180.0 - 0.05, i as f32 / 180.0 - 0.05];
            Vec4::new(position[0], position[1], 0.0, 0.0)
        })
        .collect();
    let context = context();
    for (format, tolerance) in [(TableFormat::F32, 1e-5), (TableFormat::F16, 2e-3)] {
        let view = upload_tables(&context.device, &context.queue, "test", &[&other, &table], format);
        let look = |layer: u32| {
            let expression = format!("vec4f(table_lookup(tables, {layer}u, x.xy))");
            eval_wgsl(
                context,
                &[TABLE],
                &[("tables: texture_2d_array<f32>", &view)],
                "",
                &expression,
                &inputs,
            )
        };
        let twin = || {
            inputs.iter().map(|x| {
                let at = [axes[0].parameter(f64::from(x.x)), axes[1].parameter(f64::from(x.y))];
                Vec4::splat(table.lookup(at).value as f32)
            })
        };
        assert!(worst(&look(1), twin()) < tolerance, "{format:?}: {}", worst(&look(1), twin()));
        assert!(worst(&look(0), twin()) > 0.1, "the other layer holds another table");
    }
}

fn quad(corners: [Vec3; 4]) -> Object {
    let mesh = Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    Object { name: "quad".into(), mesh: Arc::new(mesh), world_from_object: Affine3A::IDENTITY }
}

/// A glossy floor under a panel that throws a shadow.
fn floor_and_panel(light: Light) -> Scene {
    let square =
        |y: f32, s: f32| [Vec3::new(-s, y, s), Vec3::new(s, y, s), Vec3::new(s, y, -s), Vec3::new(-s, y, -s)];
    let mut scene = Scene::empty("floor");
    scene.objects = vec![quad(square(0.0, 4.0)), quad(square(1.0, 0.7))];
    scene.materials[0] = Material {
        name: "floor".into(),
        k_d: Vec3::new(0.6, 0.5, 0.4),
        k_s: Vec3::splat(0.3),
        exponent: 20.0,
    };
    scene.medium = Medium {
        sigma_s: Vec3::new(0.1, 0.15, 0.2),
        sigma_a: Vec3::new(0.02, 0.0, 0.01),
        phase: Phase::isotropic(),
    };
    scene.camera = Camera { eye: Vec3::new(0.5, 3.0, 5.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.8 };
    scene.lights = vec![light];
    scene
}

fn surfaces(scene: &Scene, shadow_size: u32) -> Image {
    let context = context();
    let (device, queue) = (&context.device, &context.queue);
    let view = scene.camera.view(64, 48);
    let format = context.radiance_format();
    let targets = Targets::new(device, 64, 48, format);
    let mut ground = Ground::new(device, queue, scene, format, shadow_size).unwrap();
    ground.prepare(device, queue, scene, &view).unwrap();
    let mut timer = PassTimer::new(device, queue);
    let mut encoder = device.create_command_encoder(&Default::default());
    targets.encode_clear(&mut encoder);
    ground.encode_shadows(&mut encoder, &mut timer);
    ground.encode_depth(&mut encoder, &targets, &mut timer);
    ground.encode_surfaces(&mut encoder, &targets, &mut timer);
    let data = SurfaceData::new(device, 64, 48);
    ground.encode_surface_data(&mut encoder, &targets, &data, &mut timer);
    timer.resolve(&mut encoder);
    queue.submit([encoder.finish()]);
    if timer.is_on() {
        let times = timer.read(device, queue);
        assert!(Ground::PASSES.iter().all(|pass| times.contains_key(pass)), "every pass is timed: {times:?}");
    }
    assert_eq!(context.take_error(), None);
    read_image(device, queue, &targets.radiance).unwrap()
}

#[test]
fn surfaces_are_lit_as_by_the_reference() {
    let point = Light::Point(PointLight {
        position: Vec3::new(0.6, 2.6, -0.4),
        intensity: Vec3::new(8.0, 9.0, 10.0),
    });
    let spot = Light::Spot(SpotLight {
        position: Vec3::new(1.5, 3.0, 1.0),
        direction: Vec3::new(-0.4, -0.9, -0.2).normalize(),
        up: Vec3::Y,
        intensity: Vec3::splat(20.0),
        inner_angle: 0.3,
        outer_angle: 0.5,
        light_map: None,
    });
    let sun = Light::Directional(common::DirectionalLight {
        direction: Vec3::new(0.3, -0.8, -0.1).normalize(),
        irradiance: Vec3::ONE,
    });
    for light in [point, spot, sun] {
        let scene = floor_and_panel(light);
        let view = scene.camera.view(64, 48);
        let reference = Reference::new(&scene).unwrap();
        let terms = Terms::from_iter([Term::Surface]);
        let rendered = reference.render(&view, terms, &|_| {}, &AtomicBool::new(false)).unwrap();
        let truth = rendered.surface.unwrap();
        let got = surfaces(&scene, 512);
        let kind = scene.lights[0].kind();
        // Pixels on a shadow's edge may fall to either side; all others agree.
        let mut different = 0;
        for (a, b) in got.pixels.iter().zip(&truth.pixels) {
            let scale = b.max_element().max(1e-3);
            different += usize::from((*a - *b).abs().max_element() > 0.01 * scale);
        }
        assert!(different < 64 * 48 / 50, "{kind}: {different} pixels differ");
        let lit = truth.pixels.iter().filter(|p| p.max_element() > 0.0).count();
        assert!((200..64 * 48 - 100).contains(&lit), "{kind}: there is light and shadow: {lit}");
        // The comparison can fail: without the panel there is no shadow.
        let mut open = scene.clone();
        open.objects.truncate(1);
        let open = surfaces(&open, 512);
        let changed =
            open.pixels.iter().zip(&truth.pixels).filter(|(a, b)| (**a - **b).abs().max_element() > 0.01);
        assert!(changed.count() > 64, "{kind}: the panel matters");
    }
}

#[test]
fn depth_is_where_the_rays_of_the_reference_end() {
    let light = Light::Point(PointLight { position: Vec3::new(0.6, 2.6, -0.4), intensity: Vec3::ONE });
    let mut scene = floor_and_panel(light);
    scene.medium.sigma_s = Vec3::splat(0.1);
    let context = context();
    let (device, queue) = (&context.device, &context.queue);
    let view = scene.camera.view(64, 48);
    let format = context.radiance_format();
    let targets = Targets::new(device, 64, 48, format);
    let mut ground = Ground::new(device, queue, &scene, format, 2).unwrap();
    ground.prepare(device, queue, &scene, &view).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    ground.encode_depth(&mut encoder, &targets, &mut PassTimer::off());
    queue.submit([encoder.finish()]);
    let depths = read_depth(device, queue, targets.depth.texture()).unwrap();
    let distance = |i: u32| view.distance(depths[i as usize], i % 64, i / 64);
    let distances: Vec<f32> = (0..64 * 48).map(distance).collect();

    let never = AtomicBool::new(false);
    let reference = Reference::new(&scene).unwrap();
    let airlight = reference.render(&view, Term::Airlight.into(), &|_| {}, &never).unwrap().airlight.unwrap();
    let others =
        |distances: &[f32]| reference.airlight_as_seen(&view, &airlight, distances, &never).unwrap().1;
    // At most a few pixels at edges.
    assert!(others(&distances) <= 6, "{}", others(&distances));
    let mirrored: Vec<f32> = (0..64 * 48).map(|i| distances[(i / 64 * 64 + 63 - i % 64) as usize]).collect();
    // The floor is as far on either side, the panel is not.
    assert!(others(&mirrored) > 50, "{}", others(&mirrored));
}

#[test]
fn nothing_is_in_shadow_beyond_an_empty_texel() {
    // x: depth in the map's clip space; beyond the far plane of a directional light it is negative.
    let context = context();
    let texture = |depth: f32| {
        let texture = context.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("map"),
            size: wgpu::Extent3d { width: 2, height: 2, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        let mut encoder = context.device.create_command_encoder(&Default::default());
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(depth),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        }));
        context.queue.submit([encoder.finish()]);
        let dimension = Some(wgpu::TextureViewDimension::D2Array);
        texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() })
    };
    let visible = |stored: f32, depths: &[f32]| -> Vec<bool> {
        let map = texture(stored);
        let inputs: Vec<Vec4> = depths.iter().map(|&depth| Vec4::splat(depth)).collect();
        let found = eval_wgsl(
            context,
            &[LIGHT, SHADOW],
            &[("map: texture_depth_2d_array", &map)],
            "let clip = vec4f(0.0, 0.0, x.x, 1.0);",
            "vec4f(f32(shadow_visible(map, 0, clip, 2.0, 0.0)))",
            &inputs,
        );
        found.iter().map(|found| found.x == 1.0).collect()
    };
    assert_eq!(visible(0.0, &[0.7, 0.0, -0.4]), [true, true, true], "empty");
    assert_eq!(visible(0.5, &[0.7, 0.4, -0.4]), [true, false, false], "something in the way");
}

#[test]
fn shadow_maps_of_impossible_sizes_are_refused() {
    let context = context();
    let scene = floor_and_panel(Light::Point(PointLight { position: Vec3::Y, intensity: Vec3::ONE }));
    for size in [0, 1, 1 << 20] {
        let error = Ground::new(&context.device, &context.queue, &scene, context.radiance_format(), size);
        let message = error.err().expect("refused").to_string();
        assert!(message.contains(&size.to_string()), "{message}");
    }
}

#[test]
fn the_ground_draws_one_kind_of_depth() {
    let context = context();
    let (device, queue) = (&context.device, &context.queue);
    let scene = floor_and_panel(Light::Point(PointLight { position: Vec3::Y, intensity: Vec3::ONE }));
    let mut ground = Ground::new(device, queue, &scene, context.radiance_format(), 2).unwrap();
    let view = scene.camera.view(8, 6);
    assert!(ground.prepare(device, queue, &scene, &view).is_ok());
    let depth = DepthRange { near: 0.1, far: 10.0, reversed: false };
    let error = ground.prepare(device, queue, &scene, &View { depth, ..view }).expect_err("refused");
    assert!(error.to_string().contains("DepthRange::reversed"), "{error}");
}

#[test]
fn targets_that_nothing_can_be_added_to_are_refused() {
    let device = &context().device;
    let new = |format| Accumulator::new(device, format, Accumulation::F32, true).map(|made| made.format());
    let format = wgpu::TextureFormat::Rgba8Unorm;
    assert_eq!(new(format), Err(TargetError::UnsupportedFormat { format }));
    let accumulated = new(wgpu::TextureFormat::Rgba16Float).unwrap();
    assert_eq!(accumulated, context().radiance_format(), "32 bits wherever the device blends them");
    let available = device.limits().max_texture_dimension_2d;
    let check = |size| Accumulator::check_size(device, size);
    assert_eq!(check((available, 1)), Ok(()));
    assert_eq!(check((0, 4)), Err(TargetError::EmptyView { width: 0, height: 4 }));
    let needed = available + 1;
    assert_eq!(check((4, needed)), Err(TargetError::TooLarge { needed, available }));
}

#[test]
fn buffers_grow_and_are_refused() {
    let (device, queue) = (&context().device, &context().queue);
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let mut buffer = None;
    let mut fill = |data: &[u32]| fill_buffer(device, queue, &mut buffer, "test", usage, data).unwrap();
    let long: Vec<u32> = (0..99).collect();
    assert_eq!([&[][..], &[7], &long, &long[..50]].map(&mut fill), [true, false, true, false]);
    let read = read_u32s(device, queue, buffer.as_ref().unwrap(), 99).unwrap();
    assert_eq!(read, long, "what is shorter stays in place");
    let available = device.limits().max_storage_buffer_binding_size.min(device.limits().max_buffer_size);
    let error = make_buffer(device, "test", available + 1, usage).expect_err("an error").to_string();
    assert!(error.contains("`test`") && error.contains(&available.to_string()), "{error}");
}
