//! φ and Grad φ at many points, packed.
#![allow(non_snake_case)]

use crate::mls::Support;
use crate::tensor::{Matrix3, Vector3};

/// Rows of φ and Grad φ, one for each evaluation point, packed.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// Row i is `starts[i]..starts[i + 1]` \[row + 1\].
    pub starts: Vec<usize>,
    pub nodes: Vec<u32>,
    /// \[–\]
    pub phi: Vec<f64>,
    /// \[1/m\]
    pub grad_phi: Vec<Vector3>,
}

impl Rows {
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Entries of row `i` in the packed arrays.
    pub fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }

    pub(crate) fn from_supports(supports: Vec<Support>) -> Rows {
        let mut rows = Rows { starts: vec![0], ..Rows::default() };
        for support in supports {
            rows.nodes.extend(support.nodes);
            rows.phi.extend(support.phi);
            rows.grad_phi.extend(support.grad_phi);
            rows.starts.push(rows.nodes.len());
        }
        rows
    }

    /// The value at row `i` of a nodal field with `components` per node.
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

    /// F = I + Σ_a u_a ⊗ Grad φ_a at row `i`.
    pub fn deformation_gradient(&self, i: usize, field: &[f64], components: usize) -> Matrix3 {
        let mut F = Matrix3::identity();
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
