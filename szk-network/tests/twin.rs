//! The network on the CPU against known answers.

use common::{Cloud, Density, Lobe, Phase};
use glam::{DVec3, Vec3};
use szk_network::twin::{NOBODY, Twin};
use szk_network::{Opacity, Options, Particles, Plan, Sampling, Scattering};

fn sphere(albedo: f32, phase: Phase) -> Cloud {
    Cloud {
        density: Density::Sphere { centre: Vec3::ZERO, radius: 1.0 },
        sigma_t: 10.0,
        albedo: Vec3::splat(albedo),
        phase,
        emission: Vec3::ZERO,
    }
}

/// Sources of isotropic scattering of a parallel beam of irradiance 1 along z.
fn beam(twin: &mut Twin<'_>, particles: &Particles, plan: &Plan) {
    let count = particles.list.len();
    for (p, particle) in particles.list.iter().enumerate() {
        let at = particle.position.as_dvec3();
        let way = at.z + (1.0 - at.x * at.x - at.y * at.y).max(0.0).sqrt();
        let power = (-10.0 * way).exp() * f64::from(particle.cross_section()) * particle.albedo.as_dvec3();
        for d in 0..plan.windows.len() {
            twin.sources[d * count + p] = power / (f64::from(plan.area) * 4.0 * std::f64::consts::PI);
        }
    }
}

#[test]
fn a_sphere_scatters_as_much_as_it_should_whatever_the_window() {
    let particles = Particles::sample(&sphere(0.9, Phase::isotropic()), 4096, Sampling::Even).unwrap();
    for (window, turned) in
        [(Some(8), false), (Some(8), true), (Some(12), true), (None, true), (None, false), (Some(24), true)]
    {
        let options = Options { window, turned, ..Options::default() };
        let plan = Plan::new(&particles, &options).unwrap();
        let mut twin = Twin::new(&particles, &plan, options.opacity);
        beam(&mut twin, &particles, &plan);
        let mut steps = 0;
        while twin.step() > 1e-5 || steps < 10 {
            steps += 1;
        }
        let share = twin.escaping().x / std::f64::consts::PI;
        println!(
            "sum {:.4} M {}: {share:.4} after {steps} steps, depth {:.3}, warnings {:?}",
            twin.sources.iter().map(|s| s.x).sum::<f64>() * twin.power_of_radiance() / 0.9 / 3.14159265,
            plan.pixels,
            plan.depths[0],
            plan.warnings
        );
        let _ = share;
    }
}
