//! The shaders against the network on the CPU.

mod support;

use common::{Lobe, Phase, Sky};
use glam::{DVec3, Vec3};
use support::{Stage, best, paper, scene, sphere, sun};
use szk_network::twin::Twin;
use szk_network::{Colours, Options, Particles, Plan, Sampling, Scattering};

#[test]
fn links_and_steps_are_those_of_the_cpu() {
    let mut cloud = sphere(0.9, Lobe::HenyeyGreenstein { g: 0.3 }.into());
    cloud.albedo = Vec3::new(0.9, 0.8, 0.99);
    let particles = Particles::sample(&cloud, 700, Sampling::Even).unwrap();
    let mut lit = scene(cloud, sun(Vec3::new(-1.0, -1.0, 0.3)));
    lit.sky = Sky::Constant(Vec3::new(0.1, 0.2, 0.3));
    let few = Options { directions: 40, ..best() };
    for (name, options) in [
        ("default", few),
        ("full", Options { scattering: Scattering::Full, ..few }),
        ("tiled", Options { scattering: Scattering::Tiled, ..few }),
        ("paper", Options { directions: 40, conserving: true, ..paper() }),
    ] {
        let plan = Plan::new(&particles, &options).unwrap();
        let mut twin = Twin::new(&particles, &plan, options.opacity);
        let mut stage = Stage::new(&lit, &particles, &options, (16, 16)).unwrap();
        stage.draw(5, 0.0, true).unwrap();
        let buffers = stage.renderer().buffers().unwrap();
        let mut neighbours = stage.integers(buffers.neighbours);
        neighbours.truncate(twin.neighbours.len());
        let other = neighbours.iter().zip(&twin.neighbours).filter(|(a, b)| a != b).count();
        assert!(other * 1000 < neighbours.len(), "{name}: {other} of {} links", neighbours.len());
        // The same links and sources from here on.
        twin.neighbours = neighbours;
        let links = twin.neighbours.len();
        let colours = |values: Vec<f32>| -> Vec<DVec3> {
            (0..links)
                .map(|i| DVec3::from_array([0, 1, 2].map(|c| f64::from(values[c * links + i]))))
                .collect()
        };
        twin.sources = colours(stage.floats(buffers.sources));
        assert!(twin.sources.iter().any(|s| s.x > 0.0), "{name}: no direct light");
        twin.sky = plan.sky(&lit.sky).iter().map(|s| s.as_dvec3()).collect();
        let mut residual = 0.0;
        for _ in 0..5 {
            residual = twin.step();
        }
        let found = colours(stage.floats(buffers.outgoing));
        let rms = |a: &[DVec3]| (a.iter().map(|v| v.length_squared()).sum::<f64>() / a.len() as f64).sqrt();
        let off: Vec<DVec3> = found.iter().zip(&twin.outgoing).map(|(a, b)| a - b).collect();
        println!("{name}: {:.2e}", rms(&off) / rms(&twin.outgoing));
        // Opacities by link are f32 differences of places.
        assert!(rms(&off) < 1e-4 * rms(&twin.outgoing), "{name}: {}", rms(&off) / rms(&twin.outgoing));
        let (found, steps) = stage.state();
        assert_eq!(steps, 5, "{name}");
        assert!((f64::from(found) / residual - 1.0).abs() < 1e-3, "{name}: residual {found}, not {residual}");
    }
}

#[test]
fn direct_light_is_what_collides_in_the_sphere() {
    let cloud = sphere(1.0, Phase::isotropic());
    let particles = Particles::sample(&cloud, 2000, Sampling::Even).unwrap();
    let options = Options { colours: Colours::Grey, ..best() };
    for light in [sun(Vec3::new(-1.0, -1.0, 0.3)), sun(Vec3::X)] {
        let lit = scene(cloud.clone(), light);
        let mut stage = Stage::new(&lit, &particles, &options, (16, 16)).unwrap();
        stage.draw(0, 0.0, true).unwrap();
        let sources = stage.floats(stage.renderer().buffers().unwrap().sources);
        let plan = stage.renderer().plan().unwrap();
        let power = sources.iter().map(|s| f64::from(*s)).sum::<f64>()
            * f64::from(plan.area)
            * 4.0
            * std::f64::consts::PI
            / 128.0;
        // What a beam loses in the sphere: 1 - (1 - (1 + 2t) e^{-2t}) / 2t², over the cross section π.
        let t: f64 = 10.0;
        let exact = std::f64::consts::PI * (1.0 - (1.0 - (1.0 + 2.0 * t) * (-2.0 * t).exp()) / (2.0 * t * t));
        println!("{power:.4}, not {exact:.4}");
        assert!((power / exact - 1.0).abs() < 0.02, "{power}, not {exact}");
    }
}
