//! Bounds of the stable time step at rest without eigenvalues.

use crate::discretisation::Discretisation;
use crate::problem::{MassRule, Problem};

/// Smallest per-point bound at rest \[s\] for lumped masses \[node\] \[kg\]. For the
/// even split of masses it is Δt_q = 2/(c √(n_q Σ_a |Grad φ_a|²)) (Joldes, Wittek,
/// Miller 2012, eq. 28; method book, eq. 17.4); for other masses, with W_a the mass
/// of all points in whose supports node a is,
/// Δt_q = 2/(c √(Σ_a |Grad φ_a|² W_a/m_a)) (eq. 17.5).
pub fn per_point_bound(problem: &Problem, discretisation: &Discretisation, mass: &[f64]) -> f64 {
    let (supports, quadrature) = (&discretisation.supports, &discretisation.quadrature);
    let material = |point: usize| &problem.regions[quadrature.regions[point] as usize].material;
    let mut covered = vec![0.0; mass.len()];
    for point in 0..supports.len() {
        for &node in &supports.nodes[supports.row(point)] {
            covered[node as usize] += material(point).density * quadrature.weights[point];
        }
    }
    let bound = |point: usize| {
        let row = supports.row(point);
        let n = row.len() as f64;
        let sum: f64 = row
            .map(|entry| {
                let node = supports.nodes[entry] as usize;
                let mass_ratio = match problem.recipe.mass {
                    MassRule::EvenSplit => n,
                    _ => covered[node] / mass[node],
                };
                supports.grad_phi[entry].norm_squared() * mass_ratio
            })
            .sum();
        2.0 / (material(point).wave_speed() * sum.sqrt())
    };
    (0..supports.len()).map(bound).fold(f64::INFINITY, f64::min)
}

/// Two more bounds at rest, which no run uses, from the stiffness of a point
/// K_q ≤ w_q M_q G_q ⊗ G_q for G_q the lengths |Grad φ_a|, M = ρc², and
/// T_a = Σ_q w_q M_q |Grad φ_a(X_q)| (method book, eqs. 17.6 and 17.7):
/// - by fractions: a point takes the part w_q M_q |Grad φ_a|/T_a of each m_a, and
///   λ ≤ max_q Σ_a |Grad φ_a(X_q)| T_a/m_a;
/// - by rows, after Gershgorin: λ ≤ max_a Σ_q w_q M_q |Grad φ_a| Σ_b |Grad φ_b|/m_a.
pub fn comparison_bounds(
    problem: &Problem,
    discretisation: &Discretisation,
    mass: &[f64],
) -> ComparisonBounds {
    let (supports, quadrature) = (&discretisation.supports, &discretisation.quadrature);
    let stiffness = |point: usize| {
        let material = &problem.regions[quadrature.regions[point] as usize].material;
        quadrature.weights[point] * material.density * material.wave_speed().powi(2)
    };
    let length = |entry: usize| supports.grad_phi[entry].norm();
    let mut total = vec![0.0; mass.len()];
    let mut row_sums = vec![0.0; mass.len()];
    for point in 0..supports.len() {
        let all: f64 = supports.row(point).map(length).sum();
        for entry in supports.row(point) {
            let (node, part) = (supports.nodes[entry] as usize, stiffness(point) * length(entry));
            total[node] += part;
            row_sums[node] += part * all;
        }
    }
    let of_point = |point: usize| -> f64 {
        let part = |entry: usize| {
            let node = supports.nodes[entry] as usize;
            length(entry) * total[node] / mass[node]
        };
        supports.row(point).map(part).sum()
    };
    let by_fractions = (0..supports.len()).map(of_point).fold(0.0, f64::max);
    let by_rows = row_sums.iter().zip(mass).map(|(sum, m)| sum / m).fold(0.0, f64::max);
    ComparisonBounds {
        by_fractions: 2.0 / f64::sqrt(by_fractions),
        by_rows: 2.0 / f64::sqrt(by_rows),
    }
}

/// The time steps of [`comparison_bounds`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ComparisonBounds {
    /// From fractions of the masses \[s\].
    pub by_fractions: f64,
    /// From row sums \[s\].
    pub by_rows: f64,
}
