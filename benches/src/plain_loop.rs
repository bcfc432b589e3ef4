//! A straightforward internal force for comparison: no SIMD, one thread, the law chosen at
//! every point.
#![allow(non_snake_case)]

use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::discretisation::patches::orthonormal_basis;
use mtled::discretisation::{Discretisation, Rows};
use mtled::material::Law;
use mtled::problem::{Problem, VolumetricProjection};

/// The internal force point by point and patch by patch (method book, section 11).
pub struct PlainLoop<'a> {
    supports: &'a Rows,
    weights: &'a [f64],
    regions: &'a [u16],
    laws: Vec<Law>,
    patches: &'a [usize],
    projected: bool,
    /// Basis of the patches, where J is projected.
    basis: Vec<[f64; 4]>,
    /// F of the points of a patch, and their J, later their pressure \[Pa\].
    deformation: Vec<Matrix3>,
    pressures: Vec<f64>,
}

impl<'a> PlainLoop<'a> {
    /// The loop over the points of a discretisation.
    pub fn new(problem: &Problem, discretisation: &'a Discretisation) -> PlainLoop<'a> {
        let (quadrature, patches) = (&discretisation.quadrature, &discretisation.patches);
        let d = discretisation.dimension.components();
        let projected = problem.recipe.volumetric_projection == VolumetricProjection::Patches;
        let basis = |ends: &[usize]| {
            orthonormal_basis(&quadrature.positions, &quadrature.weights, ends[0]..ends[1], d)
        };
        PlainLoop {
            supports: &discretisation.supports,
            weights: &quadrature.weights,
            regions: &quadrature.regions,
            laws: problem.regions.iter().map(|region| region.material.law).collect(),
            patches,
            projected,
            basis: if projected { patches.windows(2).flat_map(basis).collect() } else { vec![] },
            deformation: Vec::new(),
            pressures: Vec::new(),
        }
    }

    /// f_int,a = Σ_q w_q P(F_q) Grad φ_a(X_q) \[N\] at displacements `u` \[m\],
    /// three components per node.
    pub fn internal_force(&mut self, u: &[f64], f: &mut [f64]) {
        f.fill(0.0);
        for patch in self.patches.windows(2) {
            let points = patch[0]..patch[1];
            self.deformation.clear();
            self.pressures.clear();
            for point in points.clone() {
                let F = self.supports.deformation_gradient(point, u, 3);
                self.pressures.push(F.determinant());
                self.deformation.push(F);
            }
            let law = self.laws[self.regions[patch[0]] as usize];
            let fraction = law.projected_fraction();
            let projected = self.projected && fraction > 0.0;
            if projected {
                self.project(&law, fraction, points.start);
            }
            for point in points.clone() {
                let F = &self.deformation[point - points.start];
                let mut P = law.first_piola_kirchhoff(F);
                if projected {
                    let cofactor = Matrix3::from_columns(&[
                        F.column(1).cross(&F.column(2)),
                        F.column(2).cross(&F.column(0)),
                        F.column(0).cross(&F.column(1)),
                    ]);
                    P += cofactor * self.pressures[point - points.start];
                }
                P *= self.weights[point];
                for entry in self.supports.row(point) {
                    let node = self.supports.nodes[entry] as usize;
                    let force: Vector3 = P * self.supports.grad_phi[entry];
                    for k in 0..3 {
                        f[3 * node + k] += force[k];
                    }
                }
            }
        }
    }

    /// Replaces J of a patch by s (p − U'(J)), where p is the projection of U'(θ) (method
    /// book, eq. 10.5).
    fn project(&mut self, law: &Law, fraction: f64, start: usize) {
        let jacobians = self.pressures.clone();
        let theta = self.projection(&jacobians, start);
        let slopes: Vec<f64> = theta.iter().map(|theta| law.bulk_slope(*theta)).collect();
        let pressures = self.projection(&slopes, start);
        for (i, p) in pressures.iter().enumerate() {
            self.pressures[i] = fraction * (p - law.bulk_slope(jacobians[i]));
        }
    }

    /// Σ_b B_b(X_q) Σ_r w_r B_b(X_r) v_r over the points of a patch.
    fn projection(&self, values: &[f64], start: usize) -> Vec<f64> {
        let mut moments = [0.0; 4];
        for (i, value) in values.iter().enumerate() {
            for (moment, b) in moments.iter_mut().zip(self.basis[start + i]) {
                *moment += self.weights[start + i] * b * value;
            }
        }
        let value = |i: usize| self.basis[start + i].iter().zip(moments).map(|(b, m)| b * m).sum();
        (0..values.len()).map(value).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bodies::{DeformedModel, cube, pointwise, same_force};

    #[test]
    fn its_force_is_that_of_the_solver() {
        for problem in [cube(6, 30.0), pointwise(cube(6, 30.0))] {
            let discretisation = Discretisation::new(&problem).unwrap();
            let mut model = DeformedModel::new(&problem, &discretisation).unwrap();
            let (u, mut f) = (model.u.clone(), model.f.clone());
            model.evaluate();
            PlainLoop::new(&problem, &discretisation).internal_force(&u, &mut f);
            same_force(&model.f, &f, 1e-9).unwrap();
        }
    }
}
