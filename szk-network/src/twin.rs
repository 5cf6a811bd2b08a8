//! The network on the CPU: what the shaders do, one thing after the other, in f64.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::plan::self_share;
use crate::{Kernel, Opacity, Particle, Particles, Plan, Window};

/// Stands for no neighbour.
pub const NOBODY: u32 = u32::MAX;

/// A network on the CPU. Arrays hold direction by direction, in each particle by particle.
#[derive(Clone, Debug)]
pub struct Twin<'a> {
    particles: &'a Particles,
    plan: &'a Plan,
    /// The particle before, or [`NOBODY`].
    pub neighbours: Vec<u32>,
    /// Opacity of each particle for light in each direction.
    pub opacities: Vec<f64>,
    /// Share of what a particle scatters that meets it once more.
    again: Vec<f64>,
    /// What a particle radiates and scatters of direct light \[W m⁻² sr⁻¹\]; all zero at first.
    pub sources: Vec<DVec3>,
    /// Radiance that comes in from the sky, by direction \[W m⁻² sr⁻¹\]; all zero at first.
    pub sky: Vec<DVec3>,
    /// Incoming radiance \[W m⁻² sr⁻¹\].
    pub incoming: Vec<DVec3>,
    /// Outgoing radiance \[W m⁻² sr⁻¹\].
    pub outgoing: Vec<DVec3>,
}

/// The particle before each particle of one direction, or [`NOBODY`].
fn links(particles: &Particles, plan: &Plan, window: &Window) -> Vec<u32> {
    let place = |position: Vec3| (position - plan.centre) / plan.radius;
    let mut order: Vec<(u32, u32)> =
        (0..).zip(&particles.list).map(|(i, p)| (window.key(place(p.position), plan.pixels), i)).collect();
    order.sort_unstable();
    let shift = 32 - crate::directions::pixel_bits(plan.pixels);
    let mut neighbours = vec![NOBODY; order.len()];
    for pair in order.windows(2) {
        if pair[0].0 >> shift == pair[1].0 >> shift {
            neighbours[pair[1].1 as usize] = pair[0].1;
        }
    }
    neighbours
}

/// Whether anybody receives what leaves each of `count` particles in each direction.
pub fn received(neighbours: &[u32], count: usize) -> Vec<bool> {
    let mut received = vec![false; neighbours.len()];
    for (at, neighbour) in neighbours.iter().enumerate() {
        if *neighbour != NOBODY {
            received[at / count * count + *neighbour as usize] = true;
        }
    }
    received
}

impl<'a> Twin<'a> {
    /// Links particles; dark.
    pub fn new(particles: &'a Particles, plan: &'a Plan, opacity: Opacity) -> Self {
        let (count, directions) = (particles.list.len(), plan.windows.len());
        let neighbours: Vec<u32> = plan.windows.iter().flat_map(|w| links(particles, plan, w)).collect();
        let link = |d: usize, p: usize| {
            let [this, before] = [p, neighbours[d * count + p] as usize].map(|i| particles.list.get(i));
            let own = -(-f64::from(plan.depths[p])).exp_m1();
            let (Some(this), Some(before)) = (this, before) else { return own };
            let distance = (this.position - before.position).dot(plan.windows[d].direction);
            -(-0.5 * f64::from(this.sigma_t + before.sigma_t) * f64::from(distance.max(0.0))).exp_m1()
        };
        let opacities =
            (0..directions).flat_map(|d| (0..count).map(move |p| (d, p))).map(|(d, p)| match opacity {
                Opacity::Link => link(d, p),
                Opacity::Particle => -(-f64::from(plan.depths[p])).exp_m1(),
            });
        let again = plan.depths.iter().map(|depth| match opacity {
            Opacity::Link => 0.0,
            Opacity::Particle => f64::from(self_share(*depth)),
        });
        let dark = vec![DVec3::ZERO; count * directions];
        Self {
            opacities: opacities.collect(),
            again: again.collect(),
            particles,
            plan,
            sources: dark.clone(),
            sky: vec![DVec3::ZERO; directions],
            incoming: dark.clone(),
            outgoing: dark,
            neighbours,
        }
    }

    /// One step: light goes on to the next particles, which scatter it. Gives the residual: the sum of what came to
    /// each incoming radiance or went from it, over the sum of all. Of new sources it shows nothing yet in the first
    /// step after them.
    pub fn step(&mut self) -> f64 {
        let count = self.particles.list.len();
        let (mut change, mut total) = (0.0, 0.0);
        for at in 0..self.incoming.len() {
            let (direction, neighbour) = (at / count, self.neighbours[at]);
            let new = match neighbour {
                NOBODY => self.sky[direction],
                neighbour => self.outgoing[direction * count + neighbour as usize],
            };
            change += (new - self.incoming[at]).abs().element_sum();
            total += new.element_sum();
            self.incoming[at] = new;
        }
        self.scatter();
        if change > 0.0 { change / total } else { 0.0 }
    }

    fn scatter(&mut self) {
        let (count, directions) = (self.particles.list.len(), self.plan.windows.len());
        let leaving = |(p, particle): (usize, &Particle)| -> Vec<DVec3> {
            let again = self.again[p];
            let albedo = particle.albedo.as_dvec3();
            // What collides: incoming light, and again what the particle itself radiates and scatters of direct light.
            let collides = |d: usize| {
                let at = d * count + p;
                self.opacities[at] * self.incoming[at] + again * self.sources[at]
            };
            let scattered: Vec<DVec3> = match &self.plan.kernel {
                Kernel::Matrices { matrices, by_colour } => (0..directions)
                    .map(|i| {
                        let of = |c: usize| {
                            if *by_colour { c.min(matrices.len() - 1) } else { particle.phase as usize }
                        };
                        let weight = |d: usize| DVec3::from_array([0, 1, 2].map(|c| matrices[of(c)][(i, d)]));
                        albedo * (0..directions).map(|d| weight(d) * collides(d)).sum::<DVec3>()
                    })
                    .collect(),
                Kernel::Components(sets) => {
                    let set = &sets[particle.phase as usize];
                    let mut scattered = vec![DVec3::ZERO; directions];
                    for (value, vector) in set.values.iter().zip(set.vectors.chunks_exact(directions)) {
                        let sum: DVec3 = vector.iter().enumerate().map(|(d, u)| *u * collides(d)).sum();
                        let sum = *value * albedo * sum / (1.0 - *value * again * albedo);
                        scattered.iter_mut().zip(vector).for_each(|(s, u)| *s += *u * sum);
                    }
                    scattered
                }
            };
            let leaves = |(d, scattered): (usize, DVec3)| {
                let at = d * count + p;
                (1.0 - self.opacities[at]) * self.incoming[at]
                    + (1.0 - again) * (self.sources[at] + scattered)
            };
            scattered.into_iter().enumerate().map(leaves).collect()
        };
        let all: Vec<Vec<DVec3>> = self.particles.list.par_iter().enumerate().map(leaving).collect();
        for (p, of_particle) in all.into_iter().enumerate() {
            for (d, radiance) in of_particle.into_iter().enumerate() {
                self.outgoing[d * count + p] = radiance;
            }
        }
    }

    /// Power that leaves the cloud \[W\]: what nobody receives. Direct light that was not scattered isn't in it.
    pub fn escaping(&self) -> DVec3 {
        let received = received(&self.neighbours, self.particles.list.len());
        let leaving = self.outgoing.iter().zip(received).filter(|(_, received)| !received);
        leaving.map(|(radiance, _)| radiance).sum::<DVec3>() * self.power_of_radiance()
    }

    /// Power of all incoming light \[W\].
    pub fn on_its_way(&self) -> DVec3 {
        self.incoming.iter().sum::<DVec3>() * self.power_of_radiance()
    }

    /// See [`Plan::power_of_radiance`].
    pub fn power_of_radiance(&self) -> f64 {
        self.plan.power_of_radiance()
    }
}
