//! What is known at quadrature points, at the nodes (method book, eq. 10.6).
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::Discretisation;
use crate::material::Law;
use crate::model::Model;
use crate::motion::internal_force::projected_mean_stress;
use crate::problem::Problem;

/// J, Cauchy stress and strain of the material at the nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct NodalFields {
    /// J \[node\] \[–\]; 1 within what is held as a volume, where nothing deforms.
    pub jacobian: Vec<f64>,
    /// Cauchy stress \[node\]\[by rows\] \[Pa\], the pressure of patches and the stress of fibres and
    /// viscosity included.
    pub stress: Vec<f64>,
    /// Green–Lagrange strain \[node\]\[xx, yy, zz, xy, yz, zx\] \[–\].
    pub strain: Vec<f64>,
}

/// J, nine components of the stress by rows, and six of the strain.
const FIELDS: usize = 16;
/// Share in a fit that a point has at least, since φ may be negative \[–\].
const LEAST_SHARE: f64 = 1e-6;
/// Directions in which points spread by less of their largest spread, squared, have no slope: across a
/// sheet of points, and across a plane \[–\].
const FLAT: f64 = 0.01;

impl NodalFields {
    /// At nodal parameters `u` \[m\]: linear functions are fitted to the values at the quadrature points
    /// that a node supports in its region, weighted by volume times φ, so that values on the boundary
    /// are those there and not half a support inside. `extra_stress` are second Piola–Kirchhoff
    /// stresses \[point\]\[xx, yy, zz, xy, yz, zx\] \[Pa\] beside those of the laws, if there are any.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
        model: &Model,
        u: &[f64],
        extra_stress: &[[f64; 6]],
    ) -> NodalFields {
        let homes = homes(problem, discretisation);
        let (rows, quadrature) = (&discretisation.supports, &discretisation.quadrature);
        let cloud = &discretisation.cloud;
        let frames = model.fibre_frames();
        let mut fits = vec![Fit::default(); cloud.positions.len()];
        for (point, mean_stress) in projected_mean_stress(model, u).into_iter().enumerate() {
            let F = rows.deformation_gradient(point, u, model.components);
            let (X, region) = (quadrature.positions[point], quadrature.regions[point]);
            let law = &problem.regions[region as usize].material.law;
            let extra = extra_stress.get(point);
            let values = at_point(&F, law, frames[point].as_ref(), mean_stress, extra);
            for entry in rows.row(point) {
                let node = rows.nodes[entry] as usize;
                if homes[node].is_none_or(|home| home == region) {
                    let weight = quadrature.weights[point] * rows.phi[entry].max(LEAST_SHARE);
                    let offset = (X - cloud.positions[node]) / cloud.spacing[node];
                    fits[node].add(weight, &offset, &values);
                }
            }
        }
        let mut fields =
            NodalFields { jacobian: Vec::new(), stress: Vec::new(), strain: Vec::new() };
        for fit in fits {
            let values = fit.at_node();
            fields.jacobian.push(values[0]);
            fields.stress.extend(&values[1..10]);
            fields.strain.extend(&values[10..]);
        }
        fields
    }

    /// −tr σ/3 \[node\] \[Pa\].
    pub fn pressure(&self) -> Vec<f64> {
        self.stress.chunks(9).map(|s| -(s[0] + s[4] + s[8]) / 3.0).collect()
    }
}

/// The region of each node, if it supports points there; `None` where points of all count.
fn homes(problem: &Problem, discretisation: &Discretisation) -> Vec<Option<u16>> {
    let positions = &discretisation.cloud.positions;
    if problem.regions.len() == 1 {
        return vec![None; positions.len()];
    }
    let owner = |X: &Vector3| problem.regions.iter().position(|region| region.part.contains(X));
    let owners: Vec<_> = positions.iter().map(|X| owner(X).map(|region| region as u16)).collect();
    let mut homes = vec![None; positions.len()];
    let rows = &discretisation.supports;
    for (point, region) in discretisation.quadrature.regions.iter().enumerate() {
        for &node in &rows.nodes[rows.row(point)] {
            if owners[node as usize] == Some(*region) {
                homes[node as usize] = Some(*region);
            }
        }
    }
    homes
}

fn at_point(
    F: &Matrix3,
    law: &Law,
    frame: Option<&Matrix3>,
    mean_stress: f64,
    extra_stress: Option<&[f64; 6]>,
) -> [f64; FIELDS] {
    // The Cauchy stress is the same in every frame of the material.
    let own = frame.filter(|_| law.has_fibres()).map_or(*F, |frame| F * frame);
    let mut sigma = law.cauchy(&own) + Matrix3::from_diagonal_element(mean_stress);
    if let Some(&[xx, yy, zz, xy, yz, xz]) = extra_stress {
        let S = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        sigma += F * S * F.transpose() / F.determinant();
    }
    let E = 0.5 * (F.transpose() * F - Matrix3::identity());
    let mut values = [0.0; FIELDS];
    values[0] = F.determinant();
    values[1..10].copy_from_slice(sigma.transpose().as_slice());
    values[10..].copy_from_slice(&[E.m11, E.m22, E.m33, E.m12, E.m23, E.m13]);
    values
}

/// Sums over the points around a node, with offsets x from it.
#[derive(Clone, Default)]
struct Fit {
    /// Σ w.
    weight: f64,
    /// Σ w x.
    first: Vector3,
    /// Σ w x xᵀ.
    second: Matrix3,
    /// Σ w v.
    values: [f64; FIELDS],
    /// Σ w v x.
    slopes: [Vector3; FIELDS],
}

impl Fit {
    fn add(&mut self, weight: f64, offset: &Vector3, values: &[f64; FIELDS]) {
        self.weight += weight;
        self.first += weight * offset;
        self.second += weight * offset * offset.transpose();
        for (k, value) in values.iter().enumerate() {
            self.values[k] += weight * value;
            self.slopes[k] += weight * *value * offset;
        }
    }

    /// v̄ − x̄ · M⁺ (Σ w v x/W − v̄ x̄), with means over W = Σ w and M the spread of the offsets.
    fn at_node(&self) -> [f64; FIELDS] {
        if self.weight == 0.0 {
            return std::array::from_fn(|k| f64::from(k == 0));
        }
        let middle = self.first / self.weight;
        let spread = (self.second / self.weight - middle * middle.transpose()).symmetric_eigen();
        let largest = spread.eigenvalues.max();
        let mut reach = Vector3::zeros();
        for (axis, own) in spread.eigenvectors.column_iter().zip(&spread.eigenvalues) {
            if *own > FLAT * largest {
                reach += axis * (axis.dot(&middle) / own);
            }
        }
        std::array::from_fn(|k| {
            let mean = self.values[k] / self.weight;
            mean - reach.dot(&(self.slopes[k] / self.weight - mean * middle))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fitted(points: &[Vector3], value: impl Fn(&Vector3) -> f64) -> f64 {
        let mut fit = Fit::default();
        for (n, X) in points.iter().enumerate() {
            fit.add(1.0 + 0.1 * n as f64, X, &[value(X); FIELDS]);
        }
        fit.at_node()[FIELDS - 1]
    }

    #[test]
    fn linear_fields_are_found_beside_the_points_in_space_and_on_a_sheet() {
        let at = |n: usize| Vector3::new((n % 3) as f64, (n / 3 % 3) as f64, (n / 9) as f64);
        let linear = |X: &Vector3| 3.0 + X.x - 0.5 * X.y + 0.2 * X.z;
        let space: Vec<Vector3> = (0..27).map(|n| at(n) + Vector3::repeat(0.2)).collect();
        assert!((fitted(&space, linear) - 3.0).abs() < 1e-12);
        let sheet: Vec<Vector3> = space.iter().map(|X| Vector3::new(X.x, X.y, 0.0)).collect();
        assert!((fitted(&sheet, linear) - 3.0).abs() < 1e-12);
        assert!((fitted(&[Vector3::x()], linear) - 4.0).abs() < 1e-12);
    }
}
