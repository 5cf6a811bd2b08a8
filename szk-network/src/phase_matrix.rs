//! The phase function between the sample directions: a matrix, made to conserve energy, and its few largest
//! components.

use common::Phase;
use glam::DVec3;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rayon::prelude::*;

use crate::DirectionSet;

/// How the phase function is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case", deny_unknown_fields))]
pub enum Quadrature {
    /// At the directions themselves: the paper's.
    Points,
    /// As the mean over the solid angle around each: a peak narrower than that is neither missed nor counted whole.
    Cells,
}

/// `M[i][d]`: the share of light that comes in direction d and goes on in direction i; 4π/D times the phase
/// function. Symmetric.
#[derive(Clone, Debug, PartialEq)]
pub struct PhaseMatrix {
    matrix: DMatrix<f64>,
}

/// The largest components of a matrix: `Σ λ_k u_k u_kᵀ`.
#[derive(Clone, Debug, PartialEq)]
pub struct Components {
    /// `λ_k`, the largest first.
    pub values: Vec<f64>,
    /// `u_k`, of length 1, one after the other.
    pub vectors: Vec<f64>,
    /// The largest |λ| that is left out; 0 if there is none: bound of a step's error, relative to the light that is
    /// scattered, both as root of the sum of squares over directions.
    pub error: f64,
}

/// Directions that stand for the solid angles of [`Quadrature::Cells`].
const FINE: u32 = 4096;
/// Entries of the table that a phase function is looked up in; even in the angle, so that peaks are resolved.
const TABLE: usize = 1 << 14;
/// Most turns of the normalisation; it takes some tens.
const MOST_TURNS: u32 = 100_000;

impl PhaseMatrix {
    /// Of the phase function's first colour.
    pub fn new(directions: &[DVec3], phase: &Phase, quadrature: Quadrature) -> Self {
        let count = directions.len();
        let weight = 4.0 * std::f64::consts::PI / count as f64;
        let matrix = match quadrature {
            Quadrature::Points => DMatrix::from_fn(count, count, |i, d| {
                weight * phase.eval(directions[i].dot(directions[d]).clamp(-1.0, 1.0)).x
            }),
            Quadrature::Cells => weight * means_over_cells(directions, phase),
        };
        Self { matrix }
    }

    /// Number of directions.
    pub fn size(&self) -> usize {
        self.matrix.nrows()
    }

    /// `M[i][d]`.
    pub fn at(&self, i: usize, d: usize) -> f64 {
        self.matrix[(i, d)]
    }

    /// Makes rows and columns add up to 1 and keeps it symmetric: M' = s M s with s = √(s / M s) to the end
    /// (Sinkhorn). Columns of 1 conserve energy, rows of 1 leave light alone that is the same everywhere.
    #[must_use]
    pub fn conserving(&self) -> Self {
        let count = self.size();
        let mut scale = DVector::from_element(count, 1.0);
        for _ in 0..MOST_TURNS {
            let sums = (&self.matrix * &scale).component_mul(&scale);
            if sums.iter().all(|sum| (sum - 1.0).abs() < 1e-13) {
                break;
            }
            scale.iter_mut().zip(&sums).for_each(|(s, sum)| *s /= sum.max(f64::MIN_POSITIVE).sqrt());
        }
        Self { matrix: DMatrix::from_fn(count, count, |i, d| scale[i] * self.matrix[(i, d)] * scale[d]) }
    }

    /// The largest sum of a column: by so much, times albedo, the energy of a network grows at most in a step.
    pub fn most_gain(&self) -> f64 {
        self.matrix.column_iter().map(|column| column.sum()).fold(0.0, f64::max)
    }

    /// The largest factor by which scattering alone can go on growing (spectral radius).
    pub fn spectral_radius(&self) -> f64 {
        self.matrix.symmetric_eigenvalues().iter().fold(0.0, |radius, value| radius.max(value.abs()))
    }

    /// Mean cosine of the scattering angle between the directions.
    pub fn mean_cosine(&self, directions: &[DVec3]) -> f64 {
        let count = self.size();
        let pairs = (0..count).flat_map(|i| (0..count).map(move |d| (i, d)));
        pairs.map(|(i, d)| self.at(i, d) * directions[i].dot(directions[d])).sum::<f64>() / count as f64
    }

    /// The fewest components whose remainder is at most `bound` and whose sum is nowhere negative, so that light
    /// neither grows nor falls below zero.
    pub fn components(&self, bound: f64) -> Components {
        let count = self.size();
        let SymmetricEigen { eigenvectors, eigenvalues } = self.matrix.clone().symmetric_eigen();
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|a, b| eigenvalues[*b].abs().total_cmp(&eigenvalues[*a].abs()));
        let left = |rank: usize| order.get(rank).map_or(0.0, |k| eigenvalues[*k].abs());
        let mut sum = DMatrix::<f64>::zeros(count, count);
        let mut rank = 0;
        while rank < count {
            let vector = eigenvectors.column(order[rank]);
            sum.ger(eigenvalues[order[rank]], &vector, &vector, 1.0);
            rank += 1;
            // Components of one size belong together: half of a pair would favour a direction.
            let whole = left(rank) < 0.95 * left(rank - 1) || rank == count;
            if whole && left(rank) <= bound && sum.min() >= -1e-12 {
                break;
            }
        }
        Components {
            values: order[..rank].iter().map(|k| eigenvalues[*k]).collect(),
            vectors: order[..rank]
                .iter()
                .flat_map(|k| eigenvectors.column(*k).iter().copied().collect::<Vec<_>>())
                .collect(),
            error: left(rank),
        }
    }
}

/// For each fine direction the nearest of the coarse ones.
pub(crate) fn cells(directions: &[DVec3]) -> (Vec<DVec3>, Vec<usize>) {
    let fine = DirectionSet::Fibonacci.directions(FINE);
    let nearest = |fine: &DVec3| {
        let cosine = |i: &usize| directions[*i].dot(*fine);
        (0..directions.len()).max_by(|a, b| cosine(a).total_cmp(&cosine(b))).unwrap_or(0)
    };
    let cell = fine.par_iter().map(nearest).collect();
    (fine, cell)
}

/// Mean of the phase function over pairs of solid angles \[1/sr\].
fn means_over_cells(directions: &[DVec3], phase: &Phase) -> DMatrix<f64> {
    let (fine, cell) = cells(directions);
    let table: Vec<f64> =
        (0..=TABLE).map(|i| phase.eval((std::f64::consts::PI * i as f64 / TABLE as f64).cos()).x).collect();
    let value = |cosine: f64| {
        let at = cosine.clamp(-1.0, 1.0).acos() * (TABLE as f64 / std::f64::consts::PI);
        let i = (at as usize).min(TABLE - 1);
        table[i] + (at - i as f64) * (table[i + 1] - table[i])
    };
    let count = directions.len();
    let mut members = vec![Vec::new(); count];
    fine.iter().zip(&cell).for_each(|(direction, cell)| members[*cell].push(*direction));
    // A cell without a fine direction of its own is its direction.
    members.iter_mut().zip(directions).filter(|(m, _)| m.is_empty()).for_each(|(m, d)| m.push(*d));
    let rows: Vec<Vec<f64>> = (0..count)
        .into_par_iter()
        .map(|i| {
            let mean = |d: usize| {
                let pairs = members[i].iter().flat_map(|a| members[d].iter().map(move |b| a.dot(*b)));
                pairs.map(value).sum::<f64>() / (members[i].len() * members[d].len()) as f64
            };
            (0..=i).map(mean).collect()
        })
        .collect();
    DMatrix::from_fn(count, count, |i, d| rows[i.max(d)][i.min(d)])
}

#[cfg(test)]
mod tests {
    use common::Lobe;

    use super::*;

    fn matrix(set: DirectionSet, g: f64, quadrature: Quadrature) -> (Vec<DVec3>, PhaseMatrix) {
        let directions = set.directions(128);
        let phase = Lobe::HenyeyGreenstein { g }.into();
        let matrix = PhaseMatrix::new(&directions, &phase, quadrature);
        (directions, matrix)
    }

    #[test]
    fn random_directions_would_diverge_and_normalised_ones_conserve() {
        for (g, least) in [(0.5, 1.02), (0.76, 1.1), (0.9, 2.0)] {
            let (_, raw) = matrix(DirectionSet::Random { seed: 5 }, g, Quadrature::Points);
            assert!(raw.spectral_radius() > least, "{g}: {}", raw.spectral_radius());
            let made = raw.conserving();
            assert!((made.spectral_radius() - 1.0).abs() < 1e-9, "{g}");
            assert!((made.most_gain() - 1.0).abs() < 1e-12, "{g}");
            assert!((0..128).all(|i| (0..128).all(|d| (made.at(i, d) - made.at(d, i)).abs() < 1e-15)));
        }
    }

    #[test]
    fn means_over_cells_keep_the_mean_cosine() {
        for (g, by_points, by_cells) in [(0.3, 1e-3, 0.01), (0.76, 0.05, 0.02), (0.9, 0.2, 0.05)] {
            for (quadrature, bound) in [(Quadrature::Points, by_points), (Quadrature::Cells, by_cells)] {
                let (directions, raw) = matrix(DirectionSet::Fibonacci, g, quadrature);
                let found = raw.conserving().mean_cosine(&directions);
                println!("g {g} {quadrature:?}: {found:.4}");
                assert!((found - g).abs() < bound, "{g} {quadrature:?}: {found}");
            }
        }
    }

    #[test]
    fn components_are_few_where_the_phase_function_is_smooth() {
        for (g, bound, most) in [(0.0, 0.03, 1), (0.3, 0.03, 9), (0.5, 0.05, 36)] {
            let (_, raw) = matrix(DirectionSet::Fibonacci, g, Quadrature::Points);
            let made = raw.conserving();
            let few = made.components(bound);
            let rank = few.values.len();
            println!("g {g}: rank {rank}, error {}", few.error);
            assert!(rank <= most && few.error <= bound, "g {g}: rank {rank}, error {}", few.error);
            assert!((few.values[0] - 1.0).abs() < 1e-9);
            let sum = |i: usize, d: usize| {
                (0..rank)
                    .map(|k| few.values[k] * few.vectors[128 * k + i] * few.vectors[128 * k + d])
                    .sum::<f64>()
            };
            for i in 0..128 {
                // Energy is conserved by the few as well.
                assert!(((0..128).map(|d| sum(i, d)).sum::<f64>() - 1.0).abs() < 1e-9);
                assert!((0..128).all(|d| sum(i, d) > -1e-9));
            }
        }
        // All of them are the matrix.
        let (_, raw) = matrix(DirectionSet::Fibonacci, 0.5, Quadrature::Points);
        assert_eq!(raw.components(0.0).values.len(), 128);
    }
}
