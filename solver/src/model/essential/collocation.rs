//! Collocation of prescribed values for functions that do not interpolate.

use crate::algebra::sparse_cholesky::{Scratch, SparseCholesky};
use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Rows};
use faer::sparse::{SparseColMat, Triplet};

/// u = u* + M⁻¹Φᵀ(ΦM⁻¹Φᵀ)⁻¹(ū − Φu*): the displacement field takes the
/// prescribed values ū at the collocation nodes (method book, eq. 15.2: EBCIEM of
/// Joldes, Chowdhury, Wittek, Miller 2017 with V = Φᵀ). The matrix is factored once.
#[derive(Debug, Clone)]
pub(super) struct Collocation {
    /// Row i of Φ: the shape functions at collocation node i.
    rows: Rows,
    /// Of ΦM⁻¹Φᵀ.
    cholesky: SparseCholesky,
}

impl Collocation {
    /// `None` if the constraints are linearly dependent.
    pub fn new(
        discretisation: &Discretisation,
        mass: &[f64],
        nodes: &[u32],
    ) -> Option<Collocation> {
        let positions: Vec<Vector3> =
            nodes.iter().map(|&node| discretisation.cloud.positions[node as usize]).collect();
        let rows = discretisation.rows_at(&positions).ok()?;
        let matrix = gram_matrix(&rows, mass)?;
        let cholesky = SparseCholesky::new(&matrix)?;
        Some(Collocation { rows, cholesky })
    }

    /// Number of collocation nodes.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Replaces prescribed values ū \[set\]\[row\] of K sets by the multipliers
    /// (ΦM⁻¹Φᵀ)⁻¹(ū − Φu), where `values_of(node)` are the nodal parameters \[set\].
    pub fn solve<const K: usize>(
        &self,
        values: &mut [f64],
        scratch: &mut Scratch,
        values_of: impl Fn(u32) -> [f64; K],
    ) {
        for i in 0..self.len() {
            let mut sums = [0.0; K];
            for entry in self.rows.row(i) {
                let (phi, u) = (self.rows.phi[entry], values_of(self.rows.nodes[entry]));
                (0..K).for_each(|set| sums[set] += phi * u[set]);
            }
            (0..K).for_each(|set| values[set * self.len() + i] -= sums[set]);
        }
        self.cholesky.solve(values, scratch);
    }

    /// Nodes and shape functions at collocation node `i`.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (u32, f64)> {
        self.rows.row(i).map(|entry| (self.rows.nodes[entry], self.rows.phi[entry]))
    }

    /// The displacement field \[m\] at collocation node `i`.
    pub fn displacement(&self, i: usize, u: &[f64], components: usize) -> Vector3 {
        self.rows.interpolate(i, u, components)
    }

    /// Calls `correct(node, Δu)` for the changes Δu = M⁻¹Φᵀλ \[set\] of multipliers λ \[set\]\[row\],
    /// term by term.
    pub fn corrections<const K: usize>(
        &self,
        mass: &[f64],
        multipliers: &[f64],
        mut correct: impl FnMut(u32, [f64; K]),
    ) {
        for i in 0..self.len() {
            let own: [f64; K] = std::array::from_fn(|set| multipliers[set * self.len() + i]);
            for entry in self.rows.row(i) {
                let node = self.rows.nodes[entry];
                let factor = self.rows.phi[entry] / mass[node as usize];
                correct(node, own.map(|multiplier| factor * multiplier));
            }
        }
    }
}

/// The lower triangle of ΦM⁻¹Φᵀ.
fn gram_matrix(rows: &Rows, mass: &[f64]) -> Option<SparseColMat<usize, f64>> {
    let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); mass.len()];
    for i in 0..rows.len() {
        for entry in rows.row(i) {
            columns[rows.nodes[entry] as usize].push((i, rows.phi[entry]));
        }
    }
    let mut triplets = Vec::new();
    for (node, entries) in columns.iter().enumerate() {
        for (position, &(i, phi_i)) in entries.iter().enumerate() {
            for &(j, phi_j) in &entries[..=position] {
                triplets.push(Triplet::new(i, j, phi_i * phi_j / mass[node]));
            }
        }
    }
    SparseColMat::try_new_from_triplets(rows.len(), rows.len(), &triplets).ok()
}
