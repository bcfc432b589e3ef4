//! The matrix pencil whose quotient is the captured fraction of a strain energy.
#![allow(non_snake_case)]

use crate::discretisation::rows::Rows;
use crate::discretisation::{Discretisation, quadrature_of};
use crate::error::Error;
use crate::model::Model;
use crate::model::essential::{ConstraintForces, ConstraintSet};
use crate::problem::{BackgroundGrid, Cloud, Enforcement, Problem};
use faer::{Mat, Side};

/// Points of the finer rule over those of the model, at least …
pub(super) const POINTS_PER_POINT: f64 = 3.0;
/// … and over nodes, enough to capture every motion.
pub(super) const POINTS_PER_NODE: f64 = 5.0;

/// δ L² \[–\]: far below the energy of any strained motion, far above round-off.
const ANCHOR: f64 = 1e-4;

/// Up to this many unknowns and constraints the modes are counted.
const LARGEST_COUNTED: usize = 4500;

/// K + δM and K̂ + δM under the conditions at t = 0.
pub(super) struct Pencil<'a> {
    pub model: &'a Model,
    pub discretisation: &'a Discretisation,
    pub finer: Rows,
    pub finer_weights: Vec<f64>,
    /// δM per component of node.
    anchor: Vec<f64>,
    /// Constrained components with the rows of φ that constrain them.
    pub constraints: Vec<(usize, Rows)>,
}

impl<'a> Pencil<'a> {
    pub fn new(
        problem: &Problem,
        discretisation: &'a Discretisation,
        model: &'a Model,
    ) -> Result<Pencil<'a>, Error> {
        let (finer, finer_weights) = finer_rule(problem, discretisation)?;
        let supports = &discretisation.supports;
        let d = model.components;
        let mut anchor = vec![0.0; model.size()];
        for (q, weight) in discretisation.quadrature.weights.iter().enumerate() {
            let row = supports.row(q);
            let part = ANCHOR * weight / row.len() as f64 / model.extent.powi(2);
            for &node in &supports.nodes[row] {
                for k in 0..d {
                    anchor[d * node as usize + k] += part;
                }
            }
        }
        let constraints = constraints(problem, discretisation, model)?;
        Ok(Pencil { model, discretisation, finer, finer_weights, anchor, constraints })
    }

    pub fn finer_points(&self) -> usize {
        self.finer_weights.len()
    }

    /// (K + δM)v.
    pub fn model_product(&self, v: &[f64]) -> Vec<f64> {
        let weights = &self.discretisation.quadrature.weights;
        self.product(&self.discretisation.supports, weights, v)
    }

    /// (K̂ + δM)v.
    pub fn finer_product(&self, v: &[f64]) -> Vec<f64> {
        self.product(&self.finer, &self.finer_weights, v)
    }

    fn product(&self, rows: &Rows, weights: &[f64], v: &[f64]) -> Vec<f64> {
        let d = self.model.components;
        let mut out: Vec<f64> = self.anchor.iter().zip(v).map(|(m, v)| m * v).collect();
        for (q, weight) in weights.iter().enumerate() {
            let H = rows.gradient(q, v, d);
            let strain = (H + H.transpose()) * (0.5 * weight);
            for entry in rows.row(q) {
                let force = strain * rows.grad_phi[entry];
                for k in 0..d {
                    out[d * rows.nodes[entry] as usize + k] += force[k];
                }
            }
        }
        out
    }

    /// Projects `v` onto the motions that the conditions allow.
    pub fn project(&self, v: &mut [f64]) {
        let mut forces = ConstraintForces::default();
        self.model.constraints.project(0.0, &self.model.lumped_mass, v, &mut forces);
    }

    /// Number of motions with a captured fraction below `fraction` (η), by the
    /// inertia of K − η K̂ + (1 − η) δM bordered with the constraints C (Sylvester's
    /// law: the number of negative pivots less that of the rows of C); `None` where
    /// that matrix is too large.
    pub fn count_below(&self, fraction: f64) -> Option<usize> {
        let n = self.model.size();
        let constrained: usize = self.constraints.iter().map(|(_, rows)| rows.len()).sum();
        if n + constrained > LARGEST_COUNTED {
            return None;
        }
        let mut matrix = Mat::<f64>::zeros(n + constrained, n + constrained);
        let weights = &self.discretisation.quadrature.weights;
        self.add(&mut matrix, &self.discretisation.supports, weights, 1.0);
        self.add(&mut matrix, &self.finer, &self.finer_weights, -fraction);
        let size = (0..n).map(|i| matrix[(i, i)].abs()).sum::<f64>() / n as f64;
        for i in 0..n {
            matrix[(i, i)] += (1.0 - fraction) * self.anchor[i];
        }
        let mut next = n;
        for (component, rows) in &self.constraints {
            for i in 0..rows.len() {
                for entry in rows.row(i) {
                    let column = self.model.components * rows.nodes[entry] as usize + component;
                    matrix[(next, column)] = size * rows.phi[entry];
                }
                next += 1;
            }
        }
        Some(negative_pivots(&matrix).saturating_sub(constrained))
    }

    /// matrix += factor · K of these points, in the lower triangle.
    fn add(&self, matrix: &mut Mat<f64>, rows: &Rows, weights: &[f64], factor: f64) {
        let d = self.model.components;
        for (q, weight) in weights.iter().enumerate() {
            let half = 0.5 * factor * weight;
            for a in rows.row(q) {
                let (node, g) = (d * rows.nodes[a] as usize, rows.grad_phi[a] * half);
                // Nodes of a support ascend.
                for b in rows.row(q).take_while(|&b| b <= a) {
                    let (other, h) = (d * rows.nodes[b] as usize, &rows.grad_phi[b]);
                    let diagonal = g.dot(h);
                    for i in 0..d {
                        matrix[(node + i, other + i)] += diagonal;
                        for j in 0..d {
                            matrix[(node + i, other + j)] += g[j] * h[i];
                        }
                    }
                }
            }
        }
    }
}

/// Rows and weights of smaller cells, with plain gradients of the same functions.
fn finer_rule(
    problem: &Problem,
    discretisation: &Discretisation,
) -> Result<(Rows, Vec<f64>), Error> {
    let (points, nodes) = (discretisation.supports.len(), discretisation.cloud.positions.len());
    let more = f64::max(POINTS_PER_POINT, POINTS_PER_NODE * nodes as f64 / points as f64);
    let factor = more.powf(-1.0 / problem.dimension.components() as f64);
    let mut grid: BackgroundGrid = problem.recipe.grid.clone();
    grid.cell *= factor;
    grid.boundary_cell = grid.boundary_cell.map(|edge| factor * edge);
    grid.refinements.iter_mut().for_each(|refinement| refinement.size *= factor);
    // Also where the cells of the model do not.
    if matches!(problem.recipe.cloud, Cloud::Graded { .. } | Cloud::Given { .. }) {
        let cells = POINTS_PER_NODE.powf(1.0 / problem.dimension.components() as f64);
        let asked = grid.cells_per_spacing.map_or(0.0, |asked| asked / factor);
        grid.cells_per_spacing = Some(cells.max(asked));
    }
    let body = match &discretisation.held {
        Some(held) => held.shape.rest.clone(),
        None => problem.body.section(&problem.dimension)?,
    };
    let approximation = &discretisation.approximation;
    let rule = quadrature_of(problem, &problem.regions, (&body, &grid), approximation, None)?;
    Ok((discretisation.rows_at(&rule.positions)?, rule.weights))
}

/// The rows of φ of each constrained component at t = 0.
fn constraints(
    problem: &Problem,
    discretisation: &Discretisation,
    model: &Model,
) -> Result<Vec<(usize, Rows)>, Error> {
    let rows = |set: &ConstraintSet| {
        let rows = match problem.recipe.enforcement {
            Enforcement::Collocation => {
                let at = set.rows.iter().map(|row| model.positions[row.node as usize]);
                discretisation.rows_at(&at.collect::<Vec<_>>())?
            }
            Enforcement::Direct => Rows {
                starts: (0..=set.rows.len()).collect(),
                nodes: set.rows.iter().map(|row| row.node).collect(),
                phi: vec![1.0; set.rows.len()],
                grad_phi: Vec::new(),
            },
        };
        Ok((set.component, rows))
    };
    model.constraints.active(0.0).iter().map(rows).collect()
}

/// Negative eigenvalues of a symmetric matrix, from its Bunch–Kaufman factors.
fn negative_pivots(matrix: &Mat<f64>) -> usize {
    let factors = matrix.lblt(Side::Lower);
    let (diagonal, below) = (factors.B_diag(), factors.B_subdiag());
    let (n, mut i, mut negative) = (matrix.nrows(), 0, 0);
    while i < n {
        if i + 1 < n && below[i] != 0.0 {
            // A 2×2 block: by its determinant and trace.
            let (a, b, c) = (diagonal[i], diagonal[i + 1], below[i]);
            negative += match a * b - c * c < 0.0 {
                true => 1,
                false if a + b < 0.0 => 2,
                false => 0,
            };
            i += 2;
        } else {
            negative += (diagonal[i] < 0.0) as usize;
            i += 1;
        }
    }
    negative
}
