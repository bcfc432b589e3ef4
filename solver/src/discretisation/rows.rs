//! φ and Grad φ at many points, packed.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::mls::{Approximation, PoorSupport, Scratch, Support};
use rayon::prelude::*;

/// Rows of φ and Grad φ, one for each evaluation point, packed.
#[derive(Debug, Clone)]
pub struct Rows {
    /// Row i is `starts[i]..starts[i + 1]` \[row + 1\].
    pub starts: Vec<usize>,
    /// Node of each entry, ascending in a row.
    pub nodes: Vec<u32>,
    /// \[–\]
    pub phi: Vec<f64>,
    /// \[1/m\]
    pub grad_phi: Vec<Vector3>,
}

impl Default for Rows {
    fn default() -> Rows {
        Rows { starts: vec![0], nodes: Vec::new(), phi: Vec::new(), grad_phi: Vec::new() }
    }
}

/// What rows hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Requested {
    Values,
    ValuesAndGradients,
}

/// Rows with the statistics of their evaluation.
#[derive(Debug, Default)]
pub(crate) struct Evaluated {
    pub rows: Rows,
    /// Points whose influence radii had to be enlarged.
    pub enlarged: usize,
    /// Largest condition number of a moment matrix.
    pub worst_condition: f64,
    /// Points that have nodes from behind a gap of the body, for want of others.
    pub bridging: Vec<usize>,
}

/// Points that are evaluated one after the other.
const PIECE: usize = 128;
/// Points that are evaluated before their rows are packed: that many rows are
/// stored twice.
const BATCH: usize = 128 * PIECE;

impl Evaluated {
    fn of(
        approximation: &Approximation,
        positions: &[Vector3],
        requested: Requested,
    ) -> Result<Evaluated, (usize, PoorSupport)> {
        let mut all = Evaluated::default();
        let (mut scratch, mut support) = (Scratch::default(), Support::default());
        for (point, X) in positions.iter().enumerate() {
            approximation
                .evaluate_into(X, &mut scratch, &mut support)
                .map_err(|poor| (point, poor))?;
            all.rows.push(&support, requested);
            all.enlarged += (support.enlargement > 1.0) as usize;
            all.worst_condition = all.worst_condition.max(support.condition);
            if support.across_gap {
                all.bridging.push(point);
            }
        }
        Ok(all)
    }

    fn append(&mut self, other: Evaluated) {
        let rows = &mut self.rows;
        let (offset, before) = (rows.nodes.len(), rows.len());
        rows.starts.extend(other.rows.starts[1..].iter().map(|start| start + offset));
        rows.nodes.extend(other.rows.nodes);
        rows.phi.extend(other.rows.phi);
        rows.grad_phi.extend(other.rows.grad_phi);
        self.enlarged += other.enlarged;
        self.bridging.extend(other.bridging.iter().map(|point| before + point));
        self.worst_condition = self.worst_condition.max(other.worst_condition);
    }
}

impl Rows {
    /// Grad φ at a point for places that move by G there: G⁻ᵀ Grad φ. A singular G changes nothing.
    pub(crate) fn push_forward(&mut self, point: usize, G: &Matrix3) {
        let Some(back) = G.try_inverse() else { return };
        let back = back.transpose();
        let entries = self.row(point);
        self.grad_phi[entries].iter_mut().for_each(|gradient| *gradient = back * *gradient);
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Entries of row `i` in the packed arrays.
    pub fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    /// Rows at many points, or the first point that has no sound one.
    pub(crate) fn at(
        approximation: &Approximation,
        positions: &[Vector3],
        requested: Requested,
    ) -> Result<Evaluated, (usize, PoorSupport)> {
        let mut all = Evaluated::default();
        for batch in positions.chunks(BATCH) {
            let first = all.rows.len();
            let evaluate = |piece: &[Vector3]| Evaluated::of(approximation, piece, requested);
            let pieces: Vec<_> = batch.par_chunks(PIECE).map(evaluate).collect();
            for (index, piece) in pieces.into_iter().enumerate() {
                all.append(piece.map_err(|(point, poor)| (first + index * PIECE + point, poor))?);
            }
        }
        all.rows.shrink();
        Ok(all)
    }

    fn push(&mut self, support: &Support, requested: Requested) {
        self.nodes.extend(&support.nodes);
        self.phi.extend(&support.phi);
        if requested == Requested::ValuesAndGradients {
            self.grad_phi.extend(&support.grad_phi);
        }
        self.starts.push(self.nodes.len());
    }

    /// Frees the memory that growing reserved in advance.
    fn shrink(&mut self) {
        self.starts.shrink_to_fit();
        self.nodes.shrink_to_fit();
        self.phi.shrink_to_fit();
        self.grad_phi.shrink_to_fit();
    }

    /// The value at row `i` of a nodal field with `components` per node (method
    /// book, eq. 2.1).
    pub fn interpolate(&self, i: usize, field: &[f64], components: usize) -> Vector3 {
        let mut value = Vector3::zeros();
        for entry in self.row(i) {
            let node = self.nodes[entry] as usize;
            for k in 0..components {
                value[k] += self.phi[entry] * field[components * node + k];
            }
        }
        value
    }

    /// F = I + Σ_a u_a ⊗ Grad φ_a at row `i` (method book, eq. 2.2).
    pub fn deformation_gradient(&self, i: usize, field: &[f64], components: usize) -> Matrix3 {
        self.with_gradient(Matrix3::identity(), i, field, components)
    }

    /// Σ_a u_a ⊗ Grad φ_a at row `i`, with all digits of small fields.
    pub fn gradient(&self, i: usize, field: &[f64], components: usize) -> Matrix3 {
        self.with_gradient(Matrix3::zeros(), i, field, components)
    }

    fn with_gradient(&self, mut F: Matrix3, i: usize, field: &[f64], components: usize) -> Matrix3 {
        for entry in self.row(i) {
            let node = self.nodes[entry] as usize;
            let mut u = Vector3::zeros();
            for k in 0..components {
                u[k] = field[components * node + k];
            }
            F += u * self.grad_phi[entry].transpose();
        }
        F
    }
}
