//! A bound on the stable time step from each quadrature point alone.

use crate::discretisation::Discretisation;
use crate::problem::{MassRule, Problem};

/// Smallest per-point bound at rest \[s\]. For the even split of masses
/// Δt_q = 2/(c √(n_q Σ_a |Grad φ_a|²)) (Joldes, Wittek, Miller 2012, eq. 28);
/// for other masses, with W_a the mass of all points that node a supports,
/// Δt_q = 2/(c √(Σ_a |Grad φ_a|² W_a/m_a)), from Σ_q w_q λ_q shares of m_a.
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
                let share = match problem.recipe.mass {
                    MassRule::EvenSplit => n,
                    MassRule::RowSum => covered[node] / mass[node],
                };
                supports.grad_phi[entry].norm_squared() * share
            })
            .sum();
        2.0 / (material(point).wave_speed() * sum.sqrt())
    };
    (0..supports.len()).map(bound).fold(f64::INFINITY, f64::min)
}
