//! Exact lit intervals per ray.

mod support;

use billeter_plv::{Options, shaders};
use common::gpu::bench::validate_wgsl;
use support::{assert_sane, boxes, draw, errors, point, reference, spot, sun};

fn rays() -> Options {
    Options::rays(common::gpu::bench::context().radiance_format())
}

#[test]
fn shaders_are_valid_without_optional_features() {
    for source in [shaders::finest_level(), shaders::coarser_level(), shaders::rays()] {
        validate_wgsl(&source).unwrap();
    }
}

#[test]
fn boxes_are_drawn_as_by_the_reference() {
    for (name, light, bound) in [
        ("point", point(), 0.01),
        ("spot", spot(0.6, 0.6), 0.01),
        ("soft", spot(0.3, 0.6), 0.015),
        ("sun", sun(), 0.01),
    ] {
        if std::env::var("ONLY").is_ok_and(|o| o != name) {
            continue;
        }
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(80, 60);
        let truth = reference(&scene, &view);
        let image = draw(&scene, &view, &rays(), 256).unwrap();
        assert_sane(&image, name);
        let (rms, worst) = errors(&image, &truth);
        println!("{name}: {rms:.5} rms, {worst:.3} worst");
        assert!(rms < bound, "{name}: {rms}");
        let mut open = scene.clone();
        open.objects.clear();
        let truth = reference(&open, &view);
        let (rms, worst) = errors(&draw(&open, &view, &rays(), 256).unwrap(), &truth);
        println!("{name}, open: {rms:.6} rms, {worst:.6} worst");
    }
}

#[test]
#[ignore]
fn timing() {
    use common::gpu::{Ground, PassTimer, Targets, bench};
    let context = bench::context();
    let (device, queue) = (&context.device, &context.queue);
    for (name, scene) in [
        ("cathedral", common::scene::builtin::cathedral(common::scene::builtin::CATHEDRAL_TRIANGLES)),
        ("amphora", common::scene::builtin::amphora(common::scene::builtin::AMPHORA_TRIANGLES)),
    ] {
        let view = scene.camera.view(640, 512);
        for size in [512, 2048] {
            let mut image = None;
            for (what, options) in [("mesh", Options::best(rays().target_format)), ("rays", rays())] {
                let targets = Targets::new(device, view.width, view.height, options.target_format);
                let mut ground =
                    Ground::new(device, queue, &scene, options.target_format, size).expect("valid scene");
                let mut renderer = billeter_plv::Renderer::new(device, queue, &options).unwrap();
                ground.prepare(device, queue, &scene, &view).expect("valid lights");
                let inputs = billeter_plv::Inputs {
                    view: &view,
                    medium: &scene.medium,
                    lights: ground.lights(),
                    depth: &targets.depth,
                };
                renderer.prepare(device, queue, &inputs).unwrap();
                let mut encoder = device.create_command_encoder(&Default::default());
                targets.encode_clear(&mut encoder);
                ground.encode_shadows(&mut encoder, &mut PassTimer::off());
                ground.encode_depth(&mut encoder, &targets, &mut PassTimer::off());
                queue.submit([encoder.finish()]);
                let mut times = vec![];
                for _ in 0..4 {
                    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
                    let mut encoder = device.create_command_encoder(&Default::default());
                    targets.encode_clear(&mut encoder);
                    renderer.encode(&mut encoder, &targets.radiance_view, &mut PassTimer::off());
                    let start = std::time::Instant::now();
                    queue.submit([encoder.finish()]);
                    device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
                    times.push(start.elapsed().as_secs_f64() * 1e3);
                }
                times.sort_by(f64::total_cmp);
                let got = common::gpu::read_image(device, queue, &targets.radiance).unwrap();
                println!("{name} {size} {what}: {:.0} ms (of {times:.0?})", times[0]);
                if let Some(mesh) = &image {
                    println!("   difference {:?}", errors(&got, mesh));
                }
                image = Some(got);
            }
        }
    }
}
