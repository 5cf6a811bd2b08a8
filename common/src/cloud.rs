//! Clouds: participating media whose density varies in space and that have an end.

use std::sync::Arc;

use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;

use crate::Phase;

/// A participating medium of varying density; beside the homogeneous [`Medium`](crate::Medium), which fills all
/// space.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    /// Where there is how much of it.
    pub density: Density,
    /// Extinction coefficient where the density is 1 \[1/m\], not negative, the same for all colours.
    pub sigma_t: f32,
    /// Single-scattering albedo, RGB in [0, 1].
    pub albedo: Vec3,
    /// Phase function \[1/sr\].
    pub phase: Phase,
    /// What it radiates of itself where the density is 1, RGB \[W m⁻³ sr⁻¹\], not negative.
    pub emission: Vec3,
}

/// A density: a function of space in [0, 1], zero outside of its bounds.
#[derive(Clone, Debug, PartialEq)]
pub enum Density {
    /// 1 between two heights, as far as the world goes.
    Slab {
        /// Lower end \[m\].
        low: f32,
        /// Upper end \[m\], above the lower one.
        high: f32,
    },
    /// 1 in a sphere.
    Sphere {
        /// Centre \[m\].
        centre: Vec3,
        /// Radius \[m\], above 0.
        radius: f32,
    },
    /// 1 in a core, less in the shell around it.
    TwoDensity {
        /// Centre of both \[m\].
        centre: Vec3,
        /// Radius of the core \[m\], 0 up to the radius of the whole.
        core: f32,
        /// Radius of the whole \[m\].
        radius: f32,
        /// Density of the shell, in [0, 1].
        shell: f32,
    },
    /// Puffs on a flat base, frayed by noise.
    Cumulus(Cumulus),
    /// Voxels.
    Grid(Arc<Grid>),
}

/// A heap of puffs, frayed by noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Cumulus {
    /// Centre and radius of each puff \[m\].
    puffs: Vec<(DVec3, f64)>,
    low: Vec3,
    high: Vec3,
    /// Length of the coarsest noise \[m\].
    grain: f64,
    seed: u32,
}

/// Voxels in a box: values at cell centres, trilinear between them, zero outside of the box.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Number of cells each way, at least 1.
    pub cells: UVec3,
    /// Lowest corner of the box \[m\].
    pub low: Vec3,
    /// Highest corner of the box \[m\], above the lowest each way.
    pub high: Vec3,
    /// Values in [0, 1]; x goes fastest, then y.
    pub values: Vec<f32>,
}

/// Noise takes away so much of a puff's depth, in parts of its radius.
const FRAY: f64 = 0.4;
/// The density rises from 0 to 1 over this depth, in parts of a puff's radius.
const RIM: f64 = 0.2;

impl Cumulus {
    /// A heap about `size` \[m\] wide whose base has its middle at `base`; another one for every `seed`.
    pub fn new(base: Vec3, size: f32, seed: u32) -> Self {
        let (base, size) = (base.as_dvec3(), f64::from(size));
        let mut puffs = Vec::new();
        // Rings of puffs that get smaller and higher towards the middle, each a little off its place.
        for (count, ring, height, radius) in
            [(7, 0.30, 0.12, 0.21), (5, 0.19, 0.25, 0.20), (3, 0.10, 0.38, 0.17), (1, 0.0, 0.2, 0.30)]
        {
            for i in 0..count {
                let random = |k: u32| hash([puffs.len() as i64, i64::from(k), 0], seed) - 0.5;
                let angle = (f64::from(i) + random(0)) * std::f64::consts::TAU / f64::from(count);
                let ring = ring * (1.0 + 0.4 * random(1));
                let place = DVec3::new(
                    1.15 * ring * angle.cos(),
                    height + 0.08 * random(2),
                    0.85 * ring * angle.sin(),
                );
                puffs.push((base + size * place, size * radius * (1.0 + 0.5 * random(3))));
            }
        }
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &(centre, radius) in &puffs {
            low = low.min(centre - radius);
            high = high.max(centre + radius);
        }
        low.y = low.y.max(base.y);
        Self { puffs, low: low.as_vec3(), high: high.as_vec3(), grain: 0.12 * size, seed }
    }

    fn at(&self, p: DVec3) -> f64 {
        let depth =
            self.puffs.iter().map(|(centre, radius)| 1.0 - p.distance(*centre) / radius).fold(-1.0, f64::max);
        // The base is flat, but not sharp.
        let depth = depth.min((p.y - f64::from(self.low.y)) / self.grain);
        if depth <= 0.0 {
            return 0.0;
        }
        let noise = if depth < FRAY + RIM { fractal_noise(p / self.grain, self.seed) } else { 0.0 };
        let t = ((depth - FRAY * noise) / RIM).clamp(0.0, 1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// A number in [0, 1) for a point of the integer lattice.
fn hash(p: [i64; 3], seed: u32) -> f64 {
    let mut h = u64::from(seed) ^ 0x9e37_79b9_7f4a_7c15;
    for x in p {
        // SplitMix64 (Steele, Lea and Flood 2014).
        h = h.wrapping_add(x as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
        h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        h ^= h >> 31;
    }
    (h >> 11) as f64 / (1u64 << 53) as f64
}

/// Four octaves of value noise, in [0, 1].
fn fractal_noise(p: DVec3, seed: u32) -> f64 {
    let (mut sum, mut total, mut weight, mut p) = (0.0, 0.0, 1.0, p);
    for octave in 0..4 {
        let cell = p.floor();
        let f = p - cell;
        let f = f * f * (3.0 - 2.0 * f);
        let at = |dx: i64, dy: i64, dz: i64| {
            hash([cell.x as i64 + dx, cell.y as i64 + dy, cell.z as i64 + dz], seed.wrapping_add(octave))
        };
        let along = |dy, dz| at(0, dy, dz) + f.x * (at(1, dy, dz) - at(0, dy, dz));
        let plane = |dz| along(0, dz) + f.y * (along(1, dz) - along(0, dz));
        sum += weight * (plane(0) + f.z * (plane(1) - plane(0)));
        total += weight;
        weight *= 0.5;
        p *= 2.03;
    }
    sum / total
}

impl Density {
    /// The value at a point \[m\], in [0, 1].
    pub fn at(&self, p: DVec3) -> f64 {
        let inside =
            |centre: Vec3, radius: f32| p.distance_squared(centre.as_dvec3()) <= f64::from(radius).powi(2);
        match self {
            Self::Slab { low, high } => {
                f64::from(u8::from((f64::from(*low)..=f64::from(*high)).contains(&p.y)))
            }
            Self::Sphere { centre, radius } => f64::from(u8::from(inside(*centre, *radius))),
            Self::TwoDensity { centre, core, radius, shell } => {
                if inside(*centre, *core) {
                    1.0
                } else if inside(*centre, *radius) {
                    f64::from(*shell)
                } else {
                    0.0
                }
            }
            Self::Cumulus(cumulus) => cumulus.at(p),
            Self::Grid(grid) => grid.at(p),
        }
    }

    /// Lowest and highest corner of a box with all of it \[m\]; infinite for a slab.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        match self {
            Self::Slab { low, high } => (
                Vec3::new(f32::NEG_INFINITY, *low, f32::NEG_INFINITY),
                Vec3::new(f32::INFINITY, *high, f32::INFINITY),
            ),
            Self::Sphere { centre, radius } | Self::TwoDensity { centre, radius, .. } => {
                (centre - *radius, centre + *radius)
            }
            Self::Cumulus(cumulus) => (cumulus.low, cumulus.high),
            Self::Grid(grid) => (grid.low, grid.high),
        }
    }

    /// The part of a ray that may meet it: distances from the origin \[in lengths of `direction`\], not negative;
    /// `None` where it does not.
    pub fn span(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let mut span = [0.0f64, f64::INFINITY];
        if let Self::Sphere { centre, radius } | Self::TwoDensity { centre, radius, .. } = self {
            let to_centre = centre.as_dvec3() - origin;
            let (a, b) = (direction.length_squared(), to_centre.dot(direction));
            // |direction|² times the squared distance of line and centre, by a cross product: no cancellation.
            let root = (a * f64::from(*radius).powi(2) - to_centre.cross(direction).length_squared()).sqrt();
            span = [((b - root) / a).max(0.0), (b + root) / a];
        } else {
            let (low, high) = self.bounds();
            for axis in 0..3 {
                let [o, d] = [origin[axis], direction[axis]];
                let [low, high] = [f64::from(low[axis]), f64::from(high[axis])];
                if d == 0.0 {
                    if !(low..=high).contains(&o) {
                        return None;
                    }
                    continue;
                }
                let ends = [(low - o) / d, (high - o) / d];
                span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
            }
        }
        (span[0] < span[1]).then_some(span)
    }

    /// What is wrong with it, if anything: one clause.
    pub fn problem(&self) -> Option<String> {
        let ball = |centre: Vec3, radius: f32| centre.is_finite() && radius.is_finite() && radius > 0.0;
        match self {
            Self::Slab { low, high } if !(low.is_finite() && high.is_finite() && low < high) => {
                Some(format!("is a slab from {low} to {high} m; expected two heights, the lower one first"))
            }
            Self::Sphere { centre, radius } if !ball(*centre, *radius) => Some(format!(
                "is a sphere of radius {radius} m at {centre}; expected finite numbers, a radius above 0"
            )),
            Self::TwoDensity { centre, core, radius, shell }
                if !(ball(*centre, *radius)
                    && *core >= 0.0
                    && core <= radius
                    && (0.0..=1.0).contains(shell)) =>
            {
                Some(format!(
                    "has a core of {core} m in a radius of {radius} m and a shell of density {shell}; expected \
                     0 ≤ core ≤ radius and a density in [0, 1]"
                ))
            }
            Self::Cumulus(Cumulus { low, high, .. })
                if !(low.is_finite() && high.is_finite() && low.cmplt(*high).all()) =>
            {
                Some("is a cumulus of no size; expected a finite place and a size above 0".into())
            }
            Self::Grid(grid) => grid.problem(),
            _ => None,
        }
    }
}

impl Grid {
    /// Most cells that there may be in all.
    pub const MOST_CELLS: u64 = 1 << 28;

    /// Voxels of a density: `longest` cells along its longest side, each the mean of a few points in it. An empty
    /// cell all around keeps the edge where it is.
    ///
    /// # Panics
    /// For a slab, which has no end, and without cells.
    pub fn of(density: &Density, longest: u32) -> Self {
        let (low, high) = density.bounds();
        assert!((high - low).is_finite() && longest >= 3, "a density with an end, and cells for it");
        let side = (high - low).max_element() / (longest - 2) as f32;
        let cells = ((high - low) / side - 1e-3).ceil().as_uvec3() + 2;
        let low = 0.5 * (low + high) - 0.5 * side * cells.as_vec3();
        let high = low + side * cells.as_vec3();
        const POINTS: u32 = 2;
        let mean = |cell: UVec3| {
            let points =
                (0..POINTS.pow(3)).map(|i| UVec3::new(i % POINTS, i / POINTS % POINTS, i / POINTS.pow(2)));
            let at = |within: UVec3| cell.as_dvec3() + (within.as_dvec3() + 0.5) / f64::from(POINTS);
            let value = |within| density.at(low.as_dvec3() + f64::from(side) * at(within));
            (points.map(value).sum::<f64>() / f64::from(POINTS.pow(3))) as f32
        };
        let row = |y, z| (0..cells.x).map(move |x| UVec3::new(x, y, z));
        let slices =
            (0..cells.z).into_par_iter().map(|z| (0..cells.y).flat_map(|y| row(y, z)).map(mean).collect());
        let values = slices.collect::<Vec<Vec<f32>>>().concat();
        Self { cells, low, high, values }
    }

    /// The value at a point \[m\], in [0, 1].
    pub fn at(&self, p: DVec3) -> f64 {
        let (low, high) = (self.low.as_dvec3(), self.high.as_dvec3());
        let cells = self.cells.as_dvec3();
        let u = (p - low) / (high - low) * cells;
        if u.cmplt(DVec3::ZERO).any() || u.cmpgt(cells).any() || u.is_nan() {
            return 0.0;
        }
        let u = (u - 0.5).clamp(DVec3::ZERO, cells - 1.0);
        let cell = u.floor();
        let f = u - cell;
        let first = cell.as_uvec3();
        let next = (first + 1).min(self.cells - 1);
        let at = |x: u32, y: u32, z: u32| {
            f64::from(self.values[((z * self.cells.y + y) * self.cells.x + x) as usize])
        };
        let along = |y, z| at(first.x, y, z) + f.x * (at(next.x, y, z) - at(first.x, y, z));
        let plane = |z| along(first.y, z) + f.y * (along(next.y, z) - along(first.y, z));
        plane(first.z) + f.z * (plane(next.z) - plane(first.z))
    }

    fn problem(&self) -> Option<String> {
        let Self { cells, low, high, values } = self;
        let count = [cells.x, cells.y, cells.z].iter().map(|&n| u64::from(n)).product::<u64>();
        if count == 0 || count > Self::MOST_CELLS || count != values.len() as u64 {
            return Some(format!(
                "has {}×{}×{} voxels with {} values; expected a value for each of 1 to {} voxels",
                cells.x,
                cells.y,
                cells.z,
                values.len(),
                Self::MOST_CELLS
            ));
        }
        if !(low.is_finite() && high.is_finite() && low.cmplt(*high).all()) {
            return Some(format!(
                "lies between {low} and {high}; expected two finite corners, the lower one first"
            ));
        }
        let wrong = values.iter().find(|value| !(0.0..=1.0).contains(*value))?;
        Some(format!("has a voxel of density {wrong}; expected 0 to 1"))
    }
}

impl Cloud {
    /// What is wrong with this cloud, if anything: one clause, to be put behind its name.
    pub fn problem(&self) -> Option<String> {
        let Self { density, sigma_t, albedo, phase, emission } = self;
        if !(sigma_t.is_finite() && *sigma_t >= 0.0) {
            return Some(format!("has sigma_t = {sigma_t} 1/m; expected a finite number, not negative"));
        }
        if !(albedo.cmpge(Vec3::ZERO).all() && albedo.cmple(Vec3::ONE).all()) {
            return Some(format!("has an albedo of {albedo}; expected three numbers in [0, 1]"));
        }
        if !(emission.is_finite() && emission.cmpge(Vec3::ZERO).all()) {
            return Some(format!(
                "has an emission of {emission}; expected three finite numbers, none negative"
            ));
        }
        density.problem().or_else(|| phase.problem())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_keeps_the_volume_of_a_sphere() {
        let density = Density::Sphere { centre: Vec3::new(1.0, -2.0, 3.0), radius: 2.0 };
        let grid = Grid::of(&density, 40);
        assert_eq!(grid.problem(), None);
        let cell = ((grid.high - grid.low) / grid.cells.as_vec3()).as_dvec3();
        let volume = grid.values.iter().map(|v| f64::from(*v)).sum::<f64>() * cell.element_product();
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
        assert!((volume / exact - 1.0).abs() < 2e-3, "{volume}, not {exact}");
        assert_eq!(grid.at(DVec3::new(1.0, -2.0, 3.0)), 1.0);
        assert_eq!(grid.at(DVec3::new(1.0, -2.0, 5.5)), 0.0);
    }

    #[test]
    fn spans_are_where_the_density_begins_and_ends() {
        let sphere = Density::Sphere { centre: Vec3::ZERO, radius: 2.0 };
        assert_eq!(sphere.span(DVec3::new(0.0, 0.0, -5.0), DVec3::Z), Some([3.0, 7.0]));
        assert_eq!(sphere.span(DVec3::ZERO, DVec3::Z), Some([0.0, 2.0]));
        assert_eq!(sphere.span(DVec3::new(0.0, 2.5, -5.0), DVec3::Z), None);
        assert_eq!(sphere.span(DVec3::new(0.0, 0.0, 5.0), DVec3::Z), None);
        let slab = Density::Slab { low: -1.0, high: 1.0 };
        assert_eq!(slab.span(DVec3::new(7.0, 3.0, 0.0), -DVec3::Y), Some([2.0, 4.0]));
        assert_eq!(slab.span(DVec3::new(7.0, 0.0, 0.0), DVec3::X), Some([0.0, f64::INFINITY]));
        assert_eq!(slab.span(DVec3::new(7.0, 3.0, 0.0), DVec3::X), None);
    }

    #[test]
    fn a_cumulus_is_a_density_with_an_end() {
        let cumulus = Cumulus::new(Vec3::new(0.0, 10.0, 0.0), 100.0, 1);
        let density = Density::Cumulus(cumulus);
        let (low, high) = density.bounds();
        assert_eq!(low.y, 10.0);
        let (mut full, mut some, mut outside) = (0, 0, 0);
        for i in 0..20_000 {
            let random = |k| hash([i, k, 0], 9);
            let at = DVec3::new(random(0), random(1), random(2));
            let at = low.as_dvec3() - 10.0 + at * (high - low + 20.0).as_dvec3();
            let value = density.at(at);
            assert!((0.0..=1.0).contains(&value));
            full += i32::from(value == 1.0);
            some += i32::from(value > 0.0);
            let beyond = at.cmplt(low.as_dvec3()).any() || at.cmpgt(high.as_dvec3()).any();
            outside += i32::from(beyond && value > 0.0);
        }
        assert_eq!(outside, 0);
        assert!(full > 1000 && some > full + 500, "{full} full, {some} not empty");
        assert_ne!(density, Density::Cumulus(Cumulus::new(Vec3::new(0.0, 10.0, 0.0), 100.0, 2)));
    }

    #[test]
    fn problems_are_named() {
        let good = Cloud {
            density: Density::Sphere { centre: Vec3::ZERO, radius: 1.0 },
            sigma_t: 1.0,
            albedo: Vec3::ONE,
            phase: Phase::isotropic(),
            emission: Vec3::ZERO,
        };
        assert_eq!(good.problem(), None);
        let says = |cloud: Cloud, what: &str| {
            let problem = cloud.problem().unwrap();
            assert!(problem.contains(what), "{problem}");
        };
        says(Cloud { sigma_t: f32::NAN, ..good.clone() }, "sigma_t");
        says(Cloud { albedo: Vec3::splat(1.1), ..good.clone() }, "albedo");
        says(Cloud { emission: -Vec3::ONE, ..good.clone() }, "emission");
        says(
            Cloud { density: Density::Sphere { centre: Vec3::ZERO, radius: 0.0 }, ..good.clone() },
            "radius",
        );
        let grid = Grid { cells: UVec3::ONE, low: Vec3::ZERO, high: Vec3::ONE, values: vec![2.0] };
        says(Cloud { density: Density::Grid(grid.into()), ..good }, "density 2");
    }
}
