//! What a particle takes of light: by the distance to the particle before it, as in the paper, or by its own cross
//! section. Judged by the power that a sphere scatters out of itself, over the side of the windows.

use std::f64::consts::PI;

use common::Light;
use common::reference::multiple::scattered_power;
use glam::DVec3;
use serde::Serialize;
use szk_network::twin::Twin;
use szk_network::{Opacity, Options, Particles, Plan, Sampling};

use super::super::plot::{Chart, Curve, Look, Numbers};
use super::super::verdict::signed;
use super::super::{Origin, Press};
use super::lab::{best, particles};
use super::{SCHEMA, axis, built, draw};
use crate::failure::Failure;
use crate::report::{digits, markdown, percent};

const COUNTS: [u32; 2] = [1024, 4096];
const WINDOWS: [u32; 10] = [4, 6, 8, 10, 12, 16, 20, 24, 32, 48];
const OPACITIES: [(Opacity, &str); 2] = [(Opacity::Link, "by link"), (Opacity::Particle, "by particle")];

/// Steps of progress: paths, each number of particles.
pub(super) const STEPS: u64 = 1 + COUNTS.len() as u64;

/// Directions; more change little.
const DIRECTIONS: u32 = 32;
/// Paths of the exact power.
const PATHS: u32 = 1 << 18;

#[derive(Debug, Serialize)]
struct Opacities {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    /// Share of the light that collides which leaves again, by paths, and its standard error.
    exact: f64,
    exact_error: f64,
    curves: Vec<Powers>,
}

#[derive(Debug, Serialize)]
struct Powers {
    opacity: &'static str,
    particles: u32,
    /// The window that the crate chooses by itself.
    chosen: u32,
    points: Vec<Point>,
}

#[derive(Debug, Serialize)]
struct Point {
    window: u32,
    /// Error of the power, relative; null where the iteration did not end.
    power_error: Option<f64>,
}

/// Measures, draws and writes; gives the section as Markdown.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    press.progress.doing("opacities: paths");
    let scene = built("sphere")?;
    let escape =
        scattered_power(&scene, PATHS, 1).map_err(|error| Failure::Run(format!("sphere: {error}")))?;
    let collided = escape.incident.mean.x - escape.unscattered.mean.x;
    let (exact, exact_error) = (escape.scattered.mean.x / collided, escape.scattered.error.x / collided);
    press.progress.step();
    let Some(Light::Directional(light)) = scene.lights.first() else {
        return Err(Failure::Run("sphere: the scene has lost its light".into()));
    };
    let mut curves = Vec::new();
    for count in COUNTS {
        press.progress.doing(&format!("opacities: {count} particles"));
        let particles = particles(&scene, count, Sampling::Even)?;
        for (opacity, name) in OPACITIES {
            let options = Options { opacity, ..best(press, DIRECTIONS) };
            let plan = |window| {
                Plan::new(&particles, &Options { window, ..options })
                    .map_err(|error| Failure::Run(error.to_string()))
            };
            let mut points = Vec::new();
            for window in WINDOWS {
                crate::interrupt::check()?;
                let share = share(&particles, &plan(Some(window))?, opacity, light.direction.as_dvec3());
                points.push(Point { window, power_error: share.map(|share| share / exact - 1.0) });
            }
            curves.push(Powers { opacity: name, particles: count, chosen: plan(None)?.pixels, points });
        }
        press.progress.step();
    }
    let opacities = Opacities { schema: SCHEMA, origin: press.origin(), exact, exact_error, curves };
    press.json("opacities.json", &opacities)?;
    draw(press, "opacities.svg", &chart(&opacities.curves))?;
    Ok(text(&opacities))
}

/// Of the light that collides the share that leaves again, of parallel light through a homogeneous sphere of radius 1.
fn share(particles: &Particles, plan: &Plan, opacity: Opacity, direction: DVec3) -> Option<f64> {
    let mut twin = Twin::new(particles, plan, opacity);
    let count = particles.list.len();
    for (p, particle) in particles.list.iter().enumerate() {
        let at = particle.position.as_dvec3();
        let along: f64 = at.dot(direction);
        let way = along + (1.0 - at.length_squared() + along * along).max(0.0).sqrt();
        let collides = (-way * f64::from(particles.sigma_t)).exp() * f64::from(particle.cross_section());
        let source = collides * particle.albedo.as_dvec3() / (f64::from(plan.area) * 4.0 * PI);
        twin.sources.iter_mut().skip(p).step_by(count).for_each(|at| *at = source);
    }
    let albedo = particles.list.first().map_or(1.0, |particle| f64::from(particle.albedo.x));
    let collided = twin.sources.iter().map(|s| s.x).sum::<f64>() * twin.power_of_radiance() / albedo;
    // The residual shows nothing of new sources in their first step.
    let settled = (0..400).any(|step| twin.step() < 1e-3 && step > 0);
    settled.then(|| twin.escaping().x / collided)
}

fn chart(curves: &[Powers]) -> Chart {
    let colour = |powers: &Powers| {
        2 * usize::from(powers.opacity == OPACITIES[1].1) + usize::from(powers.particles == COUNTS[1])
    };
    let curve = |powers: &Powers| Curve {
        label: format!("{}, {} particles", powers.opacity, powers.particles),
        points: powers
            .points
            .iter()
            .filter_map(|point| Some((f64::from(point.window), point.power_error?)))
            .collect(),
        look: Look::Both,
        colour: colour(powers),
    };
    Chart {
        axes: [
            axis("side of the windows, M [pixels]", true, Numbers::Plain),
            axis("error of the scattered power", false, Numbers::Percent),
        ],
        curves: curves.iter().map(curve).collect(),
    }
}

fn text(opacities: &Opacities) -> String {
    let mut head = vec!["M".to_owned()];
    head.extend(opacities.curves.iter().map(|c| format!("{}, {}", c.opacity, c.particles)));
    let mut rows = vec![head];
    for (index, window) in WINDOWS.iter().enumerate() {
        let mut row = vec![window.to_string()];
        row.extend(opacities.curves.iter().map(|c| {
            let error = c.points.get(index).and_then(|point| point.power_error);
            error.map_or("–".into(), signed)
        }));
        rows.push(row);
    }
    let chosen: Vec<String> = opacities
        .curves
        .iter()
        .filter(|c| c.opacity == OPACITIES[0].1)
        .map(|c| format!("{} for {} particles", c.chosen, c.particles))
        .collect();
    format!(
        "![opacities](opacities.svg)\n\nPower that `sphere` scatters out of itself, {} of what collides by paths (± \
         {}): error of the network over the side M of its windows, {DIRECTIONS} even directions, otherwise \
         default. By link, as in the paper, the window decides how bright the cloud is, and there is one window \
         that happens to be right; by particle it hardly matters up to about twice the one that the crate chooses by \
         itself, M = {}. In finer windows particles miss each other.\n\n{}",
        digits(opacities.exact),
        percent(opacities.exact_error / opacities.exact),
        chosen.join(" and "),
        markdown::table(&rows)
    )
}
