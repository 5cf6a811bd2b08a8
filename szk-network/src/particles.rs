//! Clouds as particles.

use std::sync::Arc;

use common::cloud::Grid;
use common::random::{even3, unit};
use common::{Cloud, Density, Phase};
use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;

use crate::Error;

/// Voxels along the longest side of a cloud that particles are sampled from: for each particle along a side so many,
/// and at least and at most so many in all.
const VOXELS_OF_PARTICLE: f32 = 8.0;
const VOXELS: [f32; 2] = [32.0, 128.0];
/// Voxels along the longest side of a cloud that is nothing but particles.
const PARTICLE_VOXELS: u32 = 64;
/// Places tried for each particle before a cloud counts as empty.
const MOST_TRIES: u64 = 100_000;

/// A ball of the medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Particle {
    /// Centre \[m\].
    pub position: Vec3,
    /// Diameter of the ball whose medium it stands for \[m\], above 0.
    pub size: f32,
    /// Extinction coefficient of that medium \[1/m\], above 0.
    pub sigma_t: f32,
    /// Single-scattering albedo, RGB in [0, 1].
    pub albedo: Vec3,
    /// What that medium radiates of itself, RGB \[W m⁻³ sr⁻¹\], not negative.
    pub emission: Vec3,
    /// Which of [`Particles::phases`].
    pub phase: u32,
}

impl Particle {
    /// Volume of its ball \[m³\].
    pub fn volume(&self) -> f32 {
        std::f32::consts::PI / 6.0 * self.size.powi(3)
    }

    /// Extinction coefficient times volume \[m²\]: what it takes out of a beam, over the beam's irradiance.
    pub fn cross_section(&self) -> f32 {
        self.sigma_t * self.volume()
    }
}

/// How places are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Sampling {
    /// Evenly spread: there is about as much medium around each.
    Even,
    /// Independent of each other: the paper's.
    Random {
        /// Which of them.
        seed: u64,
    },
}

/// A cloud as particles, and what they were sampled from.
#[derive(Clone, Debug, PartialEq)]
pub struct Particles {
    /// The particles, 1 to [`Particles::MOST`].
    pub list: Vec<Particle>,
    /// Their phase functions, 1 to [`Particles::MOST_PHASES`], the same for all colours.
    pub phases: Vec<Phase>,
    /// Density of the medium, voxels in [0, 1].
    pub density: Arc<Grid>,
    /// Extinction coefficient where the density is 1 \[1/m\].
    pub sigma_t: f32,
    /// Whether `density` was there before the particles and is finer than they are.
    pub sampled: bool,
}

impl Particles {
    /// Most particles.
    pub const MOST: u32 = 65_536;
    /// Most phase functions.
    pub const MOST_PHASES: usize = 8;

    /// `count` particles, 1 to [`Particles::MOST`], of a cloud, as many at each place as there are collisions.
    ///
    /// # Errors
    /// [`Error::Cloud`], for a cloud that has something wrong with it, no end or next to nothing in it, and for a `count` of 0
    /// or above [`Particles::MOST`].
    pub fn sample(cloud: &Cloud, count: u32, sampling: Sampling) -> Result<Self, Error> {
        let problem = |problem: String| Err(Error::Cloud { problem });
        if let Some(what) = cloud.problem() {
            return problem(what);
        }
        if matches!(cloud.density, Density::Slab { .. }) {
            return problem("is a slab, which has no end; expected a cloud of finite size".into());
        }
        if !(1..=Self::MOST).contains(&count) {
            return problem(format!("is to be {count} particles; expected 1 to {}", Self::MOST));
        }
        let density = match &cloud.density {
            // Voxels stay what they are, unless they are too fine.
            Density::Grid(grid) if grid.cells.max_element() <= VOXELS[1] as u32 => Arc::clone(grid),
            density => {
                let voxels = (VOXELS_OF_PARTICLE * (count as f32).cbrt()).clamp(VOXELS[0], VOXELS[1]);
                Arc::new(Grid::of(density, voxels as u32))
            }
        };
        let (low, high) = cloud.density.bounds();
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let voxel = ((density.high - density.low) / density.cells.as_vec3()).as_dvec3().element_product();
        let total: f64 = density.values.iter().map(|value| f64::from(*value)).sum::<f64>() * voxel;
        let cross_section = total * f64::from(cloud.sigma_t) / f64::from(count);
        if !(cross_section > 0.0 && cross_section.is_finite()) {
            return problem("has no medium in it; expected an extinction and a density above 0".into());
        }
        let mut list = Vec::with_capacity(count as usize);
        for n in 0..MOST_TRIES * u64::from(count) {
            let (place, chance) = match sampling {
                Sampling::Even => (even3(n), unit(n)),
                Sampling::Random { seed } => {
                    let random = |k| unit(seed.wrapping_mul(0x1_0000_0000_0001).wrapping_add(4 * n + k));
                    ([0, 1, 2].map(random), random(3))
                }
            };
            let at = low + DVec3::from_array(place) * (high - low);
            let value = cloud.density.at(at);
            if chance >= value {
                continue;
            }
            let sigma_t = f64::from(cloud.sigma_t) * value;
            let size = (6.0 * cross_section / (std::f64::consts::PI * sigma_t)).cbrt();
            list.push(Particle {
                position: at.as_vec3(),
                size: size as f32,
                sigma_t: sigma_t as f32,
                albedo: cloud.albedo,
                emission: cloud.emission * value as f32,
                phase: 0,
            });
            if list.len() == count as usize {
                let phases = vec![cloud.phase.clone()];
                return Ok(Self { list, phases, density, sigma_t: cloud.sigma_t, sampled: true });
            }
        }
        problem("is nearly empty: too little of its bounds is filled; expected tighter bounds".into())
    }

    /// Particles as they are; their medium is spread over their own size.
    ///
    /// # Errors
    /// [`Error::Cloud`], for no or more than [`Particles::MOST`] particles, no or more than [`Particles::MOST_PHASES`] phase
    /// functions, one that differs between colours, and a particle with a value out of its range.
    pub fn new(list: Vec<Particle>, phases: Vec<Phase>) -> Result<Self, Error> {
        let particles = Self {
            density: Arc::new(Grid {
                cells: UVec3::ONE,
                low: Vec3::ZERO,
                high: Vec3::ONE,
                values: vec![0.0],
            }),
            list,
            phases,
            sigma_t: 0.0,
            sampled: false,
        };
        if let Some(problem) = particles.problem() {
            return Err(Error::Cloud { problem });
        }
        let (low, high) =
            particles.list.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| {
                (low.min(p.position - p.size), high.max(p.position + p.size))
            });
        let side = (high - low).max_element() / PARTICLE_VOXELS as f32;
        let cells = ((high - low) / side).ceil().as_uvec3().clamp(UVec3::ONE, UVec3::splat(PARTICLE_VOXELS));
        let mut grid = Grid { cells, low, high, values: Vec::new() };
        let extinction = particles.smoothed(&grid, 2.0, 0.75 * side);
        let sigma_t = extinction.iter().fold(0.0, |most: f32, value| most.max(*value));
        grid.values = extinction.iter().map(|value| value / sigma_t.max(f32::MIN_POSITIVE)).collect();
        Ok(Self { density: Arc::new(grid), sigma_t, ..particles })
    }

    /// Extinction coefficient \[1/m\] at the centres of a grid's cells if each particle is spread over a ball of
    /// `overlap` times its radius, and no less than `least` \[m\].
    pub(crate) fn smoothed(&self, grid: &Grid, overlap: f32, least: f32) -> Vec<f32> {
        let cell = (grid.high - grid.low) / grid.cells.as_vec3();
        let row = (grid.cells.x * grid.cells.y) as usize;
        // Slices of z, each with the particles that reach into it.
        let mut values = vec![0.0f32; row * grid.cells.z as usize];
        values.par_chunks_mut(row.max(1)).enumerate().for_each(|(z, slice)| {
            let height = grid.low.z + (z as f32 + 0.5) * cell.z;
            for particle in &self.list {
                let reach = (0.5 * overlap * particle.size).max(least);
                let away = height - particle.position.z;
                if away.abs() >= reach {
                    continue;
                }
                let kernel = particle.cross_section() * KERNEL / reach.powi(3);
                let from =
                    ((particle.position - reach - grid.low) / cell - 0.5).ceil().max(Vec3::ZERO).as_uvec3();
                let to = ((particle.position + reach - grid.low) / cell - 0.5).floor().max(-Vec3::ONE);
                for y in from.y..grid.cells.y.min((to.y + 1.0) as u32) {
                    for x in from.x..grid.cells.x.min((to.x + 1.0) as u32) {
                        let at = grid.low + (Vec3::new(x as f32, y as f32, z as f32) + 0.5) * cell;
                        let u = 1.0 - at.distance_squared(particle.position) / (reach * reach);
                        if u > 0.0 {
                            slice[(y * grid.cells.x + x) as usize] += kernel * u * u.sqrt();
                        }
                    }
                }
            }
        });
        values
    }

    /// Centre and radius of a sphere around all centres \[m\].
    pub(crate) fn bounding_sphere(&self) -> (Vec3, f32) {
        let (low, high) = self.list.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| {
            (low.min(p.position), high.max(p.position))
        });
        let centre = 0.5 * (low + high);
        let radius = self.list.iter().map(|p| p.position.distance(centre)).fold(0.0, f32::max);
        // A lone particle has a size as well.
        let own = self.list.first().map_or(1.0, |p| 0.5 * p.size);
        (centre, (1.0001 * radius).max(own))
    }

    /// Mean diameter of the balls that they stand for \[m\]: about as far are they apart.
    pub(crate) fn mean_size(&self) -> f32 {
        self.list.iter().map(|p| p.size).sum::<f32>() / self.list.len() as f32
    }

    /// What is wrong with these particles, if anything: one clause, to be put behind "the cloud".
    pub fn problem(&self) -> Option<String> {
        let count = self.list.len();
        if count == 0 || count > Self::MOST as usize {
            return Some(format!("has {count} particles; expected 1 to {}", Self::MOST));
        }
        if self.phases.is_empty() || self.phases.len() > Self::MOST_PHASES {
            return Some(format!(
                "has {} phase functions; expected 1 to {}",
                self.phases.len(),
                Self::MOST_PHASES
            ));
        }
        for phase in &self.phases {
            if let Some(problem) = phase.problem() {
                return Some(problem);
            }
            if phase.lobes.iter().any(|(weight, _)| *weight != Vec3::splat(weight.x)) {
                return Some("has a phase function of its own for each colour; expected one for all".into());
            }
        }
        for (index, particle) in self.list.iter().enumerate() {
            let known = (particle.phase as usize) < self.phases.len();
            let problem = particle.problem().or_else(|| {
                (!known).then(|| {
                    format!("has phase function {}; there are {}", particle.phase, self.phases.len())
                })
            });
            if let Some(problem) = problem {
                return Some(format!("has a particle, number {index}, that {problem}"));
            }
        }
        None
    }
}

/// The kernel that particles are spread by, `(1 − r²/h²)^{3/2}`, times this over h³ is 1 over its ball.
const KERNEL: f32 = 8.0 / (std::f32::consts::PI * std::f32::consts::PI);

impl Particle {
    pub(crate) fn problem(&self) -> Option<String> {
        let Self { position, size, sigma_t, albedo, emission, .. } = self;
        if !position.is_finite() {
            return Some(format!("is at {position}; expected three finite numbers"));
        }
        if !(*size > 0.0 && size.is_finite() && *sigma_t > 0.0 && sigma_t.is_finite()) {
            return Some(format!(
                "has a size of {size} m and sigma_t = {sigma_t} 1/m; expected numbers above 0"
            ));
        }
        if !(albedo.cmpge(Vec3::ZERO).all() && albedo.cmple(Vec3::ONE).all()) {
            return Some(format!("has an albedo of {albedo}; expected three numbers in [0, 1]"));
        }
        if !(emission.cmpge(Vec3::ZERO).all() && emission.is_finite()) {
            return Some(format!(
                "has an emission of {emission}; expected three finite numbers, none negative"
            ));
        }
        None
    }
}
