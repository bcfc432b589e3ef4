//! Masses of free bodies that turn as the bodies do.
#![allow(non_snake_case)]

use super::lumped::masses;
use crate::algebra::tensor::Vector3;
use crate::discretisation::{Discretisation, Warning};
use crate::problem::{MassRule, Problem};
use nalgebra::{SMatrix, SVector};

/// Factor of a mass below which it is not made smaller \[–\].
const LEAST: f64 = 0.25;
/// Eigenvalues of the moments, relative to the largest, below which a direction has no extent \[–\].
const FLAT: f64 = 1e-9;
/// Error of the moments of inertia above which a body is said to turn otherwise \[–\].
const TOLERABLE: f64 = 0.01;
/// Terms of a polynomial of second order.
const TERMS: usize = 10;
type Terms = SVector<f64, TERMS>;

/// Changes row sums, which have the mass and the centre of each connected body, until they have the
/// moments of second order as well: m'_a = m_a (1 + Σ_k c_k p_k(X_a)) with the polynomials p_k of second
/// order (method book, eq. 13.5). Returns what was added to each node of bodies that nothing holds
/// \[kg\], and a warning where nodes are too few for it.
pub fn fit_moments(
    problem: &Problem,
    discretisation: &Discretisation,
    density: &[f64],
    bodies: &[u32],
    mass: &mut [f64],
) -> (Vec<f64>, Option<Warning>) {
    let positions = &discretisation.cloud.positions;
    let mut members: Vec<Vec<usize>> = Vec::new();
    for (node, &body) in bodies.iter().enumerate() {
        members.resize_with(members.len().max(body as usize + 1), Vec::new);
        members[body as usize].push(node);
    }
    let mut frames: Vec<Option<Frame>> = (members.iter())
        .map(|nodes| {
            let is_free = is_free(problem, positions, nodes);
            let is_fitted = is_free || problem.recipe.mass == MassRule::Moments;
            is_fitted.then(|| Frame::of(nodes, positions, mass, is_free))
        })
        .collect();
    for (quadrature, rows) in discretisation.volumes() {
        for (point, point_mass) in masses(quadrature, density).enumerate() {
            let body = bodies[rows.nodes[rows.row(point).start] as usize];
            if let Some(frame) = &mut frames[body as usize] {
                let terms = frame.terms(&quadrature.positions[point]);
                frame.missing.axpy(point_mass, &terms, 1.0);
            }
        }
    }
    let mut added = vec![0.0; mass.len()];
    let mut worst: f64 = 0.0;
    for (frame, nodes) in frames.into_iter().zip(&members) {
        let Some(frame) = frame else { continue };
        let factor = frame.factor();
        let changes: Vec<f64> =
            nodes.iter().map(|&node| factor.dot(&frame.terms(&positions[node]))).collect();
        let lowest = changes.iter().copied().fold(0.0, f64::min);
        let part = ((LEAST - 1.0) / lowest).min(1.0);
        worst = worst.max(frame.left_over(&(part * factor)));
        for (&node, change) in nodes.iter().zip(changes) {
            let change = part * change * mass[node];
            mass[node] += change;
            added[node] = if frame.is_free { change } else { 0.0 };
        }
    }
    let few = (worst > TOLERABLE).then_some(Warning::FewNodesToTurn { error: worst });
    (added, few)
}

/// Whether nothing holds a body for ever.
fn is_free(problem: &Problem, positions: &[Vector3], nodes: &[usize]) -> bool {
    let for_ever = problem.conditions.iter().filter(|condition| condition.release.is_none());
    let held = for_ever.map(|condition| &condition.part);
    let springs = problem.loads.springs.iter().map(|spring| &spring.part);
    let mut parts = held.chain(springs);
    !parts.any(|part| nodes.iter().any(|&node| part.contains(&positions[node])))
}

/// The polynomials of a body, which are of order 1, and their moments.
struct Frame {
    is_free: bool,
    centre: Vector3,
    extent: f64,
    /// Σ_a m_a p_k(X_a) p_l(X_a) \[kg\].
    matrix: SMatrix<f64, TERMS, TERMS>,
    /// ∫ ρ p_k dV − Σ_a m_a p_k(X_a) \[kg\], the integral once all points were added.
    missing: Terms,
}

impl Frame {
    fn of(nodes: &[usize], positions: &[Vector3], mass: &[f64], is_free: bool) -> Frame {
        let total: f64 = nodes.iter().map(|&node| mass[node]).sum();
        let centre: Vector3 = nodes.iter().map(|&node| mass[node] / total * positions[node]).sum();
        let far = |&node: &usize| (positions[node] - centre).norm();
        let extent = nodes.iter().map(far).fold(f64::MIN_POSITIVE, f64::max);
        let (matrix, missing) = (SMatrix::zeros(), Terms::zeros());
        let mut frame = Frame { is_free, centre, extent, matrix, missing };
        for &node in nodes {
            let terms = frame.terms(&positions[node]);
            frame.missing.axpy(-mass[node], &terms, 1.0);
            frame.matrix.ger(mass[node], &terms, &terms, 1.0);
        }
        frame
    }

    fn terms(&self, X: &Vector3) -> Terms {
        let x = (X - self.centre) / self.extent;
        let second = [x.x * x.x, x.y * x.y, x.z * x.z, x.x * x.y, x.y * x.z, x.z * x.x];
        let first = [1.0, x.x, x.y, x.z];
        Terms::from_iterator(first.into_iter().chain(second))
    }

    /// What these coefficients leave of the differences of second moments, over their sum \[–\].
    fn left_over(&self, factor: &Terms) -> f64 {
        let squares = |terms: &Terms| terms.fixed_rows::<3>(4).lp_norm(1);
        let of_nodes: Terms = self.matrix.column(0).into();
        squares(&(self.missing - self.matrix * factor)) / squares(&(of_nodes + self.missing))
    }

    /// The coefficients c_k, 0 in directions that have no extent.
    fn factor(&self) -> Terms {
        let eigen = self.matrix.symmetric_eigen();
        let smallest = FLAT * eigen.eigenvalues.amax();
        let mut factor = Terms::zeros();
        for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > smallest {
                factor.axpy(vector.dot(&self.missing) / value, &vector, 1.0);
            }
        }
        factor
    }
}
