//! What a network is made of, before there are links: windows, opacities, and how light is scattered.

use common::{Phase, Sky};
use glam::{DVec3, Vec3};
use nalgebra::DMatrix;

use crate::phase_matrix::cells;
use crate::{
    Colours, Components, Error, Opacity, Options, Particles, PhaseMatrix, Quadrature, Scattering, Warning,
    Window,
};

/// Entries of a phase function's table, over sin(θ/2) in [0, 1].
pub(crate) const PHASE_ENTRIES: usize = 2048;

/// Everything about a network that neither links nor lights change.
#[derive(Clone, Debug)]
pub struct Plan {
    /// One for each direction. Hidden, as `Window` is.
    #[doc(hidden)]
    pub windows: Vec<Window>,
    /// Side M of the windows \[pixels\]; a window that is shifted has one more.
    pub pixels: u32,
    /// Centre of the bounding sphere \[m\].
    pub centre: Vec3,
    /// Its radius R \[m\].
    pub radius: f32,
    /// Area of a pixel \[m²\]: all of a link's light passes through it.
    pub area: f32,
    /// Optical depth of each particle: its cross section in the area of a pixel.
    pub depths: Vec<f32>,
    /// How light is scattered. Hidden, as `Kernel` is.
    #[doc(hidden)]
    pub kernel: Kernel,
    /// What works, but not well.
    pub warnings: Vec<Warning>,
    /// Phase functions between a light or the eye and a direction: tables over sin(θ/2), each phase's one after the
    /// other; first as means over the solid angle of a direction, then as they are.
    pub(crate) phase_tables: [Vec<f32>; 2],
}

/// How light is scattered.
#[derive(Clone, Debug)]
pub enum Kernel {
    /// By whole matrices, to be multiplied by the albedo.
    Matrices {
        /// D×D each, column i holds what goes out in direction i; one for each phase function, or where light is
        /// scattered again in its particle, one for each colour.
        matrices: Vec<DMatrix<f64>>,
        /// Which.
        by_colour: bool,
    },
    /// By components, those of each phase function.
    Components(Vec<Components>),
}

impl Plan {
    /// Decides on all that particles and options leave open.
    ///
    /// # Errors
    /// [`Error::Option`], [`Error::Cloud`], [`Error::Coloured`] with one colour for a coloured cloud, and [`Error::Diverges`].
    pub fn new(particles: &Particles, options: &Options) -> Result<Self, Error> {
        options.check()?;
        if let Some(problem) = particles.problem() {
            return Err(Error::Cloud { problem });
        }
        if options.colours == Colours::Grey {
            let grey = |colour: Vec3| colour == Vec3::splat(colour.x);
            if !particles.list.iter().all(|p| grey(p.albedo) && grey(p.emission)) {
                return Err(Error::Coloured { what: "a particle" });
            }
        }
        let directions = options.direction_set.directions(options.directions);
        let (centre, radius) = particles.bounding_sphere();
        let count = particles.list.len() as f32;
        let cross_section = particles.list.iter().map(|p| p.cross_section()).sum::<f32>() / count;
        // As many pixels as make the mean optical depth of a particle what it is to be.
        let pixels_of = |depth: f32| 2.0 * radius * (depth / cross_section).sqrt();
        let pixels = options.window.unwrap_or_else(|| {
            // But not so many that the directions don't tell them apart: in thin clouds light would pass by all of them.
            let told_apart = finest_window(particles, radius, options.directions) as u32;
            let wanted = pixels_of(Options::OPTICAL_DEPTH).round() as u32;
            wanted.min(told_apart).clamp(1, Options::MOST_WINDOW)
        });
        let area = (2.0 * radius / pixels as f32).powi(2);
        let depths: Vec<f32> = particles.list.iter().map(|p| p.cross_section() / area).collect();
        let windows = (0..).zip(&directions).map(|(i, d)| Window::new(*d, i, options.turned)).collect();

        let mut matrices: Vec<PhaseMatrix> = Vec::new();
        let mut warnings = window_warnings(particles, pixels, radius, cross_section, options.directions);
        for (index, phase) in particles.phases.iter().enumerate() {
            let mut matrix = PhaseMatrix::new(&directions, phase, options.quadrature);
            if options.conserving {
                matrix = matrix.conserving();
            }
            let of_phase = particles.list.iter().filter(|p| p.phase as usize == index);
            let albedo = f64::from(of_phase.map(|p| p.albedo.max_element()).fold(0.0, f32::max));
            let sums = matrix.spectral_radius();
            if albedo * sums > 1.0 + 1e-9 {
                return Err(Error::Diverges { gain: albedo * sums, albedo, sums });
            }
            warnings.extend(peak_warning(phase, matrix.mean_cosine(&directions), options.directions));
            matrices.push(matrix);
        }
        let phase_tables = [options.quadrature, Quadrature::Points].map(|quadrature| {
            particles
                .phases
                .iter()
                .flat_map(|phase| phase_table(phase, quadrature, options.directions))
                .collect()
        });
        let kernel = kernel(particles, options, &matrices, &depths);
        Ok(Self { windows, pixels, centre, radius, area, depths, kernel, warnings, phase_tables })
    }

    /// Mean radiance that comes in from the sky in each direction, RGB \[W m⁻² sr⁻¹\].
    pub fn sky(&self, sky: &Sky) -> Vec<Vec3> {
        match sky {
            Sky::Picture(_) => {
                let directions: Vec<DVec3> = self.windows.iter().map(|w| w.direction.as_dvec3()).collect();
                let (fine, cell) = cells(&directions);
                let mut sums = vec![(Vec3::ZERO, 0.0); directions.len()];
                for (direction, cell) in fine.iter().zip(cell) {
                    let (sum, count) = &mut sums[cell];
                    *sum += sky.radiance(-direction.as_vec3());
                    *count += 1.0;
                }
                let own = |w: &Window| sky.radiance(-w.direction);
                sums.iter()
                    .zip(&self.windows)
                    .map(|((sum, n), w)| if *n > 0.0 { *sum / *n } else { own(w) })
                    .collect()
            }
            _ => self.windows.iter().map(|w| sky.radiance(-w.direction)).collect(),
        }
    }

    /// Power of radiance 1 in one direction of one particle \[m² sr\].
    pub fn power_of_radiance(&self) -> f64 {
        f64::from(self.area) * 4.0 * std::f64::consts::PI / self.windows.len() as f64
    }

    /// Blocks of four components of each phase function; 0 where light is scattered by whole matrices.
    pub(crate) fn blocks(&self) -> u32 {
        match &self.kernel {
            Kernel::Matrices { .. } => 0,
            Kernel::Components(sets) => {
                sets.iter().map(|set| set.values.len().div_ceil(4)).max().unwrap_or(0) as u32
            }
        }
    }

    /// Whether components are so few that they are found while light goes on to the next particle.
    pub(crate) fn fused(&self) -> bool {
        (1..=3).contains(&self.blocks())
    }

    /// Bytes on the device of networks and tables of scattering: for each of N·D links 12 for each colour and 4, 4 more
    /// for each colour with more than twelve components or whole matrices, and 4 more where opacities are those of
    /// links; and 16 for each block of four components, N times for each colour and D + 1 times for each phase
    /// function, or 4 for each of D² products of each matrix.
    pub fn bytes(&self, options: &Options) -> u64 {
        let (particles, directions) = (self.depths.len() as u64, self.windows.len() as u64);
        let colours = if options.colours == Colours::Grey { 1 } else { 3 };
        let opacities = u64::from(options.opacity == Opacity::Link);
        let networks = if self.fused() { 3 } else { 4 };
        let kernel = match &self.kernel {
            Kernel::Matrices { matrices, .. } => {
                16 * matrices.len() as u64 * directions.div_ceil(4) * directions
            }
            Kernel::Components(sets) => {
                16 * u64::from(self.blocks()) * (sets.len() as u64 * (directions + 1) + colours * particles)
            }
        };
        particles * directions * (4 * networks * colours + 4 + 4 * opacities) + kernel
    }
}

fn kernel(particles: &Particles, options: &Options, matrices: &[PhaseMatrix], depths: &[f32]) -> Kernel {
    let components = |bound| matrices.iter().map(|m| m.components(bound)).collect::<Vec<_>>();
    let first = particles.list[0];
    let alike = particles.list.iter().zip(depths).all(|(p, depth)| {
        p.albedo == first.albedo && p.phase == first.phase && (depth / depths[0] - 1.0).abs() < 1e-4
    });
    let whole = |matrix: &PhaseMatrix| DMatrix::from_fn(matrix.size(), matrix.size(), |i, d| matrix.at(i, d));
    if let Scattering::LowRank { bound } = options.scattering {
        let few = components(bound);
        let most = few.iter().map(|set| set.values.len()).max().unwrap_or(0);
        // Beyond that the whole matrix is cheaper, where one will do for all particles.
        if 2 * most <= options.directions as usize || !(alike || options.opacity == Opacity::Link) {
            return Kernel::Components(few);
        }
    }
    match options.opacity {
        Opacity::Link => {
            Kernel::Matrices { matrices: matrices.iter().map(whole).collect(), by_colour: false }
        }
        // Light that is scattered again and again in its particle: M (1 − a s M)⁻¹, all in one matrix.
        Opacity::Particle if alike => {
            let matrix = whole(&matrices[first.phase as usize]);
            let again = f64::from(self_share(depths[0]));
            let of_colour = |albedo: f32| {
                let size = matrix.nrows();
                let whole = DMatrix::identity(size, size) - f64::from(albedo) * again * &matrix;
                whole.lu().solve(&matrix).unwrap_or_else(|| matrix.clone())
            };
            let colours: &[f32] = match options.colours {
                Colours::Rgb => &first.albedo.to_array(),
                Colours::Grey => &[first.albedo.x],
            };
            let matrices = colours.iter().map(|albedo| of_colour(*albedo)).collect();
            Kernel::Matrices { matrices, by_colour: true }
        }
        // Where that differs from particle to particle, all components do the same.
        Opacity::Particle => Kernel::Components(components(0.0)),
    }
}

/// The share of light that is scattered within a particle of this optical depth and meets it once more on its way
/// out: `1 − (1 − e^{−t})/t`.
pub(crate) fn self_share(depth: f32) -> f32 {
    // A series where the difference would lose digits.
    if depth < 1e-2 { depth * (0.5 - depth / 6.0) } else { 1.0 + (-depth).exp_m1() / depth }
}

/// Mean extinction of the medium that particles stand for \[1/m\]: where they are, there is medium.
fn extinction(particles: &Particles) -> f32 {
    particles.list.iter().map(|p| p.sigma_t).sum::<f32>() / particles.list.len() as f32
}

/// Side of the finest window whose pixels the directions tell apart, at least 1: the paper's `M² ≤ D (Rτ)²/π`.
fn finest_window(particles: &Particles, radius: f32, directions: u32) -> f32 {
    ((directions as f32 / std::f32::consts::PI).sqrt() * radius * extinction(particles)).max(1.0)
}

fn window_warnings(
    particles: &Particles,
    pixels: u32,
    radius: f32,
    cross_section: f32,
    directions: u32,
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let side = 2.0 * radius / pixels as f32;
    let extinction = extinction(particles);
    let most = finest_window(particles, radius, directions);
    if pixels as f32 > most {
        warnings.push(Warning::WindowFinerThanDirections { window: pixels, most: most as u32 });
    }
    let depth = cross_section / (side * side);
    // The window's side is a whole number.
    if depth > 1.0 && pixels > 1 {
        let most = (2.0 * radius / cross_section.sqrt()) as u32;
        warnings.push(Warning::LinksTooLong { depth, window: pixels, most: most.max(1) });
    }
    if side * extinction > 2.5 && depth < Options::OPTICAL_DEPTH / 2.0 {
        warnings.push(Warning::PixelsTooWide { width: side * extinction });
    }
    let (apart, most) = (particles.mean_size() * extinction, Warning::MOST_APART);
    if apart > most {
        warnings.push(Warning::ParticlesTooFar { apart, most });
    }
    warnings
}

/// What the directions make of a phase function's peak; `found` is the mean cosine between them.
fn peak_warning(phase: &Phase, found: f64, directions: u32) -> Option<Warning> {
    let cosines = || phase.lobes.iter().map(|(weight, lobe)| (f64::from(weight.x), lobe.mean_cosine()));
    let wanted = cosines().map(|(weight, cosine)| weight * cosine).sum::<f64>();
    if (found - wanted).abs() > 0.05 {
        return Some(Warning::PeakTooNarrow { found, wanted });
    }
    // A peak is about 1 − |g| wide, and a direction has 4π/D of solid angle.
    let most = (1.0 - (4.0 * std::f64::consts::PI / f64::from(directions)).sqrt() / 3.0).max(0.0);
    let narrow = cosines().map(|(_, cosine)| cosine).find(|cosine| cosine.abs() > most);
    narrow.map(|mean_cosine| Warning::PeakBetweenDirections { mean_cosine, most })
}

/// A phase function \[1/sr\] over sin(θ/2).
fn phase_table(phase: &Phase, quadrature: Quadrature, directions: u32) -> Vec<f32> {
    // Points of a cap with the solid angle of a direction: 4π/D = 2π (1 − cos).
    let cap: Vec<DVec3> = match quadrature {
        Quadrature::Points => vec![DVec3::Z],
        Quadrature::Cells => (0..64)
            .map(|i| {
                let z = 1.0 - 2.0 / f64::from(directions) * (f64::from(i) + 0.5) / 64.0;
                let (radius, azimuth) = ((1.0 - z * z).sqrt(), 2.399_963 * f64::from(i));
                DVec3::new(radius * azimuth.cos(), radius * azimuth.sin(), z)
            })
            .collect(),
    };
    (0..PHASE_ENTRIES)
        .map(|i| {
            let angle = 2.0 * (i as f64 / (PHASE_ENTRIES - 1) as f64).asin();
            let axis = DVec3::new(angle.sin(), 0.0, angle.cos());
            let sum: f64 = cap.iter().map(|at| phase.eval(at.dot(axis).clamp(-1.0, 1.0)).x).sum();
            (sum / cap.len() as f64) as f32
        })
        .collect()
}
