//! Springs all over a part of the boundary.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::{Discretisation, Rows};
use crate::error::Error;
use crate::geometry::Panel;
use crate::model::loaded_part::LoadedPart;
use crate::problem::{Problem, Spring};
use std::collections::BTreeMap;

/// An elastic bed of a part of the boundary.
#[derive(Debug, Clone)]
pub struct SpringLoad {
    /// φ at the points of the surface.
    rows: Rows,
    /// Reference positions of the points \[m\].
    positions: Vec<Vector3>,
    /// A_i (k_n N ⊗ N + k_t (1 − N ⊗ N)) of each point \[N/m\].
    stiffness: Vec<Matrix3>,
}

impl SpringLoad {
    pub(super) fn new(
        spring: &Spring,
        problem: &Problem,
        discretisation: &Discretisation,
    ) -> Result<SpringLoad, Error> {
        let Some(loaded) = LoadedPart::new(problem, discretisation, &spring.part)? else {
            return Err(Error::EmptySpring { name: spring.name.clone() });
        };
        let nodes = discretisation.cloud.positions.len();
        let d = problem.dimension.components();
        let column = |k: usize| {
            let of_panel = |panel: &Panel| column_of(spring, panel, k, d);
            loaded.strengths(nodes, of_panel)
        };
        let columns = [0, 1, 2].map(column);
        let stiffness = (0..columns[0].len()).map(|i| {
            let matrix = Matrix3::from_columns(&[columns[0][i], columns[1][i], columns[2][i]]);
            0.5 * (matrix + matrix.transpose())
        });
        let points = stiffness.zip(loaded.rule().positions());
        let acting = points.filter(|(matrix, _)| *matrix != Matrix3::zeros());
        let (stiffness, positions): (Vec<Matrix3>, Vec<Vector3>) = acting.unzip();
        let rows = discretisation.rows_at(&positions)?;
        Ok(SpringLoad { rows, positions, stiffness })
    }

    /// Adds f_a = −Σ_i φ_a(X_i) K_i u(X_i) \[N\] at displacements `u` \[m\] (method book, eq. 14.6),
    /// which is linear.
    pub fn add_force(&self, u: &[f64], components: usize, f: &mut [f64]) {
        for (point, stiffness) in self.stiffness.iter().enumerate() {
            let force = -(stiffness * self.rows.interpolate(point, u, components));
            for entry in self.rows.row(point) {
                let node = self.rows.nodes[entry] as usize;
                for k in 0..components {
                    f[components * node + k] += self.rows.phi[entry] * force[k];
                }
            }
        }
    }

    /// What the springs exert on the body at displacements `u` \[m\] \[N\].
    pub fn resultant(&self, u: &[f64], components: usize) -> Vector3 {
        let points = self.stiffness.iter().enumerate();
        points.map(|(i, k)| -(k * self.rows.interpolate(i, u, components))).sum()
    }

    /// Node, place \[m\] and direction of what it holds.
    pub(super) fn held(&self) -> impl Iterator<Item = (u32, Vector3, Vector3)> {
        let points = self.stiffness.iter().zip(&self.positions).enumerate();
        points.flat_map(|(point, (stiffness, X))| {
            let node = self.rows.nodes[self.rows.row(point).start];
            directions(stiffness).into_iter().map(move |(along, _)| (node, *X, along))
        })
    }

    /// Σ_i φ_a K_i of the nodes where that is positive \[N/m\].
    pub(super) fn lumped(&self) -> impl Iterator<Item = (u32, Matrix3)> {
        let mut lumped: BTreeMap<u32, Matrix3> = BTreeMap::new();
        for (point, stiffness) in self.stiffness.iter().enumerate() {
            for entry in self.rows.row(point) {
                let own = lumped.entry(self.rows.nodes[entry]).or_default();
                *own += self.rows.phi[entry].max(0.0) * stiffness;
            }
        }
        lumped.into_iter()
    }
}

/// Column `k` of k_n N ⊗ N + k_t (1 − N ⊗ N) in `d` dimensions.
fn column_of(spring: &Spring, panel: &Panel, k: usize, d: usize) -> Vector3 {
    if k >= d {
        return Vector3::zeros();
    }
    let N = panel.mean_normal().normalize();
    let along = N[k] * N;
    spring.normal * along + spring.tangential * (Vector3::ith(k, 1.0) - along)
}

/// Part of the largest stiffness of a point that counts as none \[–\].
const NONE: f64 = 1e-6;

/// Principal directions of a stiffness, and their stiffnesses \[N/m\].
pub fn directions(stiffness: &Matrix3) -> Vec<(Vector3, f64)> {
    let eigen = stiffness.symmetric_eigen();
    let least = NONE * eigen.eigenvalues.max();
    let principal =
        (0..3).map(|k| (eigen.eigenvectors.column(k).into_owned(), eigen.eigenvalues[k]));
    principal.filter(|(_, stiffness)| *stiffness > least).collect()
}
