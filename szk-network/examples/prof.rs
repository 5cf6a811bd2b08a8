use common::gpu::{Context, ContextOptions, Ground, PassTimer, Targets};
use common::{Camera, Cloud, Density, DirectionalLight, Light, Lobe, Scene, Sky};
use glam::Vec3;
use szk_network::*;
fn main() {
    let context = Context::new(&ContextOptions::default()).unwrap();
    let (device, queue) = (&context.device, &context.queue);
    let format = context.radiance_format();
    for (g, n, d, s, colours) in [
        (0.0, 4096, 128, Scattering::LowRank { bound: 0.03 }, Colours::Grey),
        (0.0, 4096, 128, Scattering::LowRank { bound: 0.03 }, Colours::Rgb),
        (0.3, 4096, 128, Scattering::LowRank { bound: 0.03 }, Colours::Grey),
        (0.5, 4096, 128, Scattering::LowRank { bound: 0.03 }, Colours::Grey),
        (0.3, 4096, 128, Scattering::Full, Colours::Grey),
        (0.3, 4096, 128, Scattering::Tiled, Colours::Grey),
    ] {
        let cloud = Cloud {
            density: Density::Sphere { centre: Vec3::ZERO, radius: 1.0 },
            sigma_t: 10.0,
            albedo: Vec3::splat(0.9),
            phase: Lobe::HenyeyGreenstein { g }.into(),
            emission: Vec3::ZERO,
        };
        let mut scene = Scene::empty("cloud");
        scene.lights.push(Light::Directional(DirectionalLight {
            direction: Vec3::new(1.0, -0.5, -0.4).normalize(),
            irradiance: Vec3::ONE,
        }));
        scene.sky = Sky::Constant(Vec3::splat(0.1));
        scene.camera = Camera { eye: Vec3::new(0.0, 0.0, 4.0), target: Vec3::ZERO, up: Vec3::Y, fov_y: 0.6 };
        let view = scene.camera.view(256, 208);
        let targets = Targets::new(device, view.width, view.height, format);
        let mut ground = Ground::new(device, queue, &scene, format, 64).unwrap();
        ground.prepare(device, queue, &scene, &view).unwrap();
        let particles = Particles::sample(&cloud, n, Sampling::Even).unwrap();
        let t = std::time::Instant::now();
        let mut network = Renderer::new(
            device,
            &Options { target_format: format, directions: d, scattering: s, colours, ..Options::default() },
        )
        .unwrap();
        network.load(device, queue, &particles).unwrap();
        println!("load {:?}", t.elapsed());
        let mut timer = PassTimer::new(device, queue);
        for frame in 0..2 {
            let inputs = Inputs {
                view: &view,
                lights: ground.lights(),
                sky: &scene.sky,
                depth: &targets.depth,
                relight: true,
                steps: 4,
                residual: 0.0,
            };
            network.prepare(device, queue, &inputs).unwrap();
            let mut encoder = device.create_command_encoder(&Default::default());
            targets.encode_clear(&mut encoder);
            ground.encode_shadows(&mut encoder, &mut PassTimer::off());
            ground.encode_depth(&mut encoder, &targets, &mut PassTimer::off());
            network.encode(&mut encoder, &targets.radiance_view, &mut timer);
            timer.resolve(&mut encoder);
            queue.submit([encoder.finish()]);
            context.wait().unwrap();
            println!("g {g} {s:?} {colours:?} frame {frame}: {:.1?}", timer.read(device, queue));
        }
    }
}
