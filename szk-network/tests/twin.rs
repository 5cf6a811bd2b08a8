//! The network on the CPU against known answers: the powers of a sphere, energy, and what the printed forms would give.

mod support;

use common::{Lobe, Phase};
use glam::DVec3;
use std::f64::consts::PI;
use support::sphere;
use szk_network::twin::{NOBODY, Twin};
use szk_network::{
    DirectionSet, Error, Kernel, Opacity, Options, Particles, Plan, Quadrature, Sampling, Scattering,
};

/// Isotropic sources of a parallel beam of irradiance 1 along z in the sphere of 20 optical depths across.
fn beam(twin: &mut Twin<'_>, particles: &Particles, plan: &Plan) {
    let count = particles.list.len();
    for (p, particle) in particles.list.iter().enumerate() {
        let at = particle.position.as_dvec3();
        let way = at.z + (1.0 - at.x * at.x - at.y * at.y).max(0.0).sqrt();
        let power = (-10.0 * way).exp() * f64::from(particle.cross_section()) * particle.albedo.as_dvec3();
        for d in 0..plan.windows.len() {
            twin.sources[d * count + p] = power / (f64::from(plan.area) * 4.0 * PI);
        }
    }
}

/// The share of the collided light that a sphere scatters out of itself.
fn scattered(options: &Options, count: u32) -> f64 {
    let particles = Particles::sample(&sphere(0.9, Phase::isotropic()), count, Sampling::Even).unwrap();
    let plan = Plan::new(&particles, options).unwrap();
    let mut twin = Twin::new(&particles, &plan, options.opacity);
    beam(&mut twin, &particles, &plan);
    let collided = twin.sources.iter().map(|s| s.x).sum::<f64>() * twin.power_of_radiance() / 0.9;
    for step in 0..300 {
        if twin.step() < 1e-3 && step > 0 {
            break;
        }
    }
    twin.escaping().x / collided
}

/// By paths, .5408 ± .0005 of the light that meets the sphere come out scattered, .005 otherwise.
const SCATTERED: f64 = 0.5408 / 0.995;

#[test]
fn a_sphere_scatters_as_much_as_it_should_whatever_the_window() {
    let few = Options { directions: 32, ..Options::default() };
    for (count, window) in [(1000, Some(8)), (2000, Some(9)), (2000, None), (2000, Some(16))] {
        let share = scattered(&Options { window, ..few }, count);
        println!("N {count}, M {window:?}: {:+.4}", share / SCATTERED - 1.0);
        assert!((share / SCATTERED - 1.0).abs() < 0.03, "N {count}, M {window:?}: {share}");
    }
    // Opacities by link make the window decide.
    let [coarse, fine] = [6, 16].map(|m| {
        scattered(&Options { window: Some(m), opacity: Opacity::Link, turned: false, ..few }, 4000)
            / SCATTERED
    });
    println!("opacities by link: {:+.4} at M 6, {:+.4} at M 16", coarse - 1.0, fine - 1.0);
    assert!(coarse < 0.95 && fine > 1.05, "{coarse} {fine}");
}

/// A network that nothing leaves: what would go out of a column comes in at its other end.
fn closed<'a>(particles: &'a Particles, plan: &'a Plan, opacity: Opacity) -> Twin<'a> {
    let mut twin = Twin::new(particles, plan, opacity);
    let count = particles.list.len();
    for d in 0..plan.windows.len() {
        let links = &mut twin.neighbours[d * count..][..count];
        let mut after = vec![NOBODY; count];
        links
            .iter()
            .enumerate()
            .filter(|(_, n)| **n != NOBODY)
            .for_each(|(p, n)| after[*n as usize] = p as u32);
        for p in (0..count).filter(|p| links[*p] == NOBODY).collect::<Vec<_>>() {
            let mut last = p;
            while after[last] != NOBODY {
                last = after[last] as usize;
            }
            links[p] = last as u32;
        }
    }
    twin
}

/// Energy of a closed network after 200 steps, over that at the beginning: light of one direction at first.
fn kept(options: &Options, albedo: f32, phase: Lobe) -> Result<f64, Error> {
    let particles = Particles::sample(&sphere(albedo, phase.into()), 40, Sampling::Even)?;
    let plan = Plan::new(&particles, options)?;
    let mut twin = closed(&particles, &plan, options.opacity);
    twin.outgoing[..40].fill(DVec3::ONE);
    for _ in 0..200 {
        twin.step();
    }
    Ok(twin.on_its_way().x / (40.0 * twin.power_of_radiance()))
}

#[test]
fn without_absorption_energy_stays() {
    let best = Options::default();
    for g in [0.0, 0.3, 0.5, 0.76, 0.9] {
        for (name, options) in [
            ("default", best),
            ("full", Options { scattering: Scattering::Full, ..best }),
            ("by link", Options { opacity: Opacity::Link, ..best }),
            ("random", Options { direction_set: DirectionSet::Random { seed: 1 }, ..best }),
            ("points", Options { quadrature: Quadrature::Points, ..best }),
        ] {
            // Smooth phase functions are all alike.
            if g < 0.7 && name != "default" {
                continue;
            }
            let energy = kept(&options, 1.0, Lobe::HenyeyGreenstein { g }).unwrap();
            assert!((energy - 1.0).abs() < 1e-9, "g {g}, {name}: {energy}");
        }
    }
    // With absorption it falls as it has to.
    let energy = kept(&best, 0.9, Lobe::Isotropic).unwrap();
    assert!(energy < 0.01, "{energy}");
}

#[test]
fn what_would_grow_is_refused() {
    // Random directions without normalisation: a spectral radius above 1.
    let raw = Options { window: Some(4), ..Options::paper(wgpu::TextureFormat::Rgba16Float) };
    let grows = |g, albedo| kept(&raw, albedo, Lobe::CornetteShanks { g });
    assert!(grows(0.0, 0.9).unwrap() < 1.0, "the paper's own case");
    for (g, albedo) in [(0.0, 1.0), (0.76, 0.9), (0.9, 0.5)] {
        match grows(g, albedo) {
            Err(Error::Diverges { gain, .. }) => assert!(gain > 1.0),
            other => panic!("g {g}, albedo {albedo}: {other:?}"),
        }
        // Normalised, the same directions will do.
        assert!(
            kept(&Options { conserving: true, ..raw }, albedo, Lobe::CornetteShanks { g }).unwrap()
                < 1.0 + 1e-9
        );
    }
}

#[test]
fn opacities_multiply_to_the_transmittance_of_a_line() {
    let particles = Particles::sample(&sphere(0.9, Phase::isotropic()), 4000, Sampling::Even).unwrap();
    for (opacity, bound) in [(Opacity::Link, 0.06), (Opacity::Particle, 0.03)] {
        let options = Options { directions: 16, opacity, turned: false, ..Options::default() };
        let plan = Plan::new(&particles, &options).unwrap();
        let twin = Twin::new(&particles, &plan, opacity);
        // Mean optical depth over columns, against the volume over the area that they have.
        let depth: f64 = twin.opacities.iter().map(|opacity| -(1.0 - opacity).ln()).sum();
        let columns = twin.neighbours.iter().filter(|n| **n == NOBODY).count() as f64;
        let exact = 10.0 * 4.0 / 3.0 * PI / (f64::from(plan.area) * columns / 16.0);
        println!("{opacity:?}: {:.4}, {exact:.4}", depth / columns);
        assert!((depth / columns / exact - 1.0).abs() < bound, "{opacity:?}: {} {exact}", depth / columns);
    }
}

#[test]
fn the_albedo_sets_the_pace_and_the_residual_bounds_the_error() {
    // Closed, all opacities alike: each step leaves 1 - α (1 - a) of the error.
    for albedo in [0.5, 0.9] {
        let particles = Particles::sample(&sphere(albedo, Phase::isotropic()), 60, Sampling::Even).unwrap();
        let options = Options { directions: 32, ..Options::default() };
        let plan = Plan::new(&particles, &options).unwrap();
        let mut twin = closed(&particles, &plan, options.opacity);
        twin.sources.fill(DVec3::ONE);
        let residuals: Vec<f64> = (0..60).map(|_| twin.step()).collect();
        let before = twin.on_its_way().x;
        let residual = twin.step();
        let contraction = residuals[59] / residuals[58];
        for _ in 0..20_000 {
            if twin.step() < 1e-9 {
                break;
            }
        }
        let left = 1.0 - before / twin.on_its_way().x;
        // What is still missing is the geometric series of what came last.
        let bound = residual / (1.0 - contraction);
        println!("albedo {albedo}: contraction {contraction:.4}, error {left:.2e}, bound {bound:.2e}");
        assert!(left <= 1.02 * bound && left >= 0.3 * bound, "albedo {albedo}: {left} {bound}");
    }
}

#[test]
fn the_two_rules_for_the_window_are_warned_about() {
    use szk_network::Warning;
    let warnings = |cloud: &common::Cloud, count, options: &Options| {
        let particles = Particles::sample(cloud, count, Sampling::Even).unwrap();
        Plan::new(&particles, options).unwrap().warnings
    };
    let cloud = sphere(0.9, Phase::isotropic());
    let window = |m| Options { window: Some(m), ..Options::default() };
    assert_eq!(warnings(&cloud, 1000, &Options::default()), []);
    // D (Rτ)²/π = 63.8² and 3N/(πRτ) = 9.8².
    let found = warnings(&cloud, 1000, &window(70));
    assert!(matches!(found[0], Warning::WindowFinerThanDirections { most: 62..=66, .. }), "{found:?}");
    assert!(matches!(found[1], Warning::LinksTooLong { most: 9, .. }), "{found:?}");
    assert!(!warnings(&cloud, 1000, &window(9)).iter().any(|w| matches!(w, Warning::LinksTooLong { .. })));
    let found = warnings(&cloud, 4000, &window(4));
    assert!(matches!(found[..], [Warning::PixelsTooWide { .. }]), "{found:?}");
    let peaked = sphere(0.9, Lobe::HenyeyGreenstein { g: 0.9 }.into());
    let few = Options { directions: 32, quadrature: Quadrature::Points, ..Options::default() };
    assert!(matches!(warnings(&peaked, 1000, &few)[..], [Warning::PeakTooNarrow { .. }]));
}

#[test]
fn too_few_particles_and_directions_are_warned_about() {
    use szk_network::Warning;
    let plan = |sigma_t, g, count| {
        let phase = Lobe::HenyeyGreenstein { g }.into();
        let cloud = common::Cloud { sigma_t, ..sphere(0.9, phase) };
        let particles = Particles::sample(&cloud, count, Sampling::Even).unwrap();
        Plan::new(&particles, &Options::default()).unwrap()
    };
    assert_eq!(plan(10.0, 0.85, 4096).warnings, []);
    for g in [0.95, -0.95] {
        let found = plan(10.0, g, 4096).warnings;
        assert!(matches!(found[..], [Warning::PeakBetweenDirections { .. }]), "{g}: {found:?}");
        assert!(found[0].to_string().contains("use more directions"), "{}", found[0]);
    }
    let found = plan(25.0, 0.0, 4096).warnings;
    assert!(matches!(found[..], [Warning::ParticlesTooFar { apart: 3.0..3.3, .. }]), "{found:?}");
    // In thin clouds the window is no finer than the directions tell apart: nothing is to be warned about.
    for (sigma_t, pixels) in [(2.5, 15), (0.5, 3), (0.05, 1), (5e-5, 1)] {
        let plan = plan(sigma_t, 0.0, 4096);
        assert_eq!((plan.pixels, &plan.warnings[..]), (pixels, &[][..]), "{sigma_t}");
    }
}

#[test]
fn as_few_components_as_the_bound_asks_for() {
    let rank = |g: f64, bound| {
        let particles =
            Particles::sample(&sphere(0.9, Lobe::HenyeyGreenstein { g }.into()), 10, Sampling::Even).unwrap();
        let options = Options { scattering: Scattering::LowRank { bound }, ..Options::default() };
        match Plan::new(&particles, &options).unwrap().kernel {
            Kernel::Components(sets) => sets[0].values.len(),
            Kernel::Matrices { .. } => 0,
        }
    };
    assert_eq!(rank(0.0, 0.03), 1);
    assert_eq!(rank(0.3, 0.1), 4);
    assert_eq!(rank(0.3, 0.03), 9);
    assert!((16..=36).contains(&rank(0.5, 0.03)));
    // Too many: the whole matrix.
    assert_eq!(rank(0.9, 0.03), 0);
}
