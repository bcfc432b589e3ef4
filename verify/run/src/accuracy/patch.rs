//! The affine patch test (method book, section 9): consistent gradients reproduce an
//! affine displacement field to their tolerance on any cloud.
#![allow(non_snake_case)]

use mtled::Simulation;
use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::{Extent, Selector};
use mtled::problem::{Amplitude, EssentialCondition, Field, Prescribed};
use mtled_checks::measure::larger;

/// u = H (X − centre).
#[derive(Debug, Clone, Copy)]
pub struct AffineField {
    /// Displacement gradient \[–\].
    pub H: Matrix3,
    /// Where the displacement vanishes \[m\].
    pub centre: Vector3,
}

/// Largest deviations of a solution from an affine field.
#[derive(Debug, Clone, Copy, Default)]
pub struct AffineErrors {
    /// Of the nodal parameters \[m\].
    pub nodal: f64,
    /// Of the displacement at the quadrature points \[m\].
    pub displacement: f64,
    /// Of F at the quadrature points, Frobenius norm \[–\].
    pub gradient: f64,
    /// Largest exact displacement of a node \[m\].
    pub largest_nodal: f64,
    /// Largest exact displacement of a quadrature point \[m\].
    pub largest: f64,
}

/// Elongation, contraction and shear of about 10 %, not symmetric; within the plane
/// where a displacement has two components.
pub fn affine_gradient(components: usize) -> Matrix3 {
    let mut H = Matrix3::new(0.08, 0.03, 0.01, 0.02, -0.05, 0.03, -0.01, 0.02, -0.02);
    if components == 2 {
        H.fill_row(2, 0.0);
        H.fill_column(2, 0.0);
    }
    H
}

impl AffineField {
    /// u at a reference position \[m\].
    pub fn displacement(&self, X: &Vector3) -> Vector3 {
        self.H * (X - self.centre)
    }

    /// The field prescribed on the whole boundary, reached at t = 1 s.
    pub fn on_boundary(self) -> EssentialCondition {
        EssentialCondition {
            name: "boundary".into(),
            extent: Extent::Surface,
            part: Selector::All,
            prescribed: Prescribed::Field(Field::of(move |X| self.displacement(X))),
            amplitude: Amplitude::Smooth { duration: 1.0 },
            release: None,
        }
    }

    /// Errors of the nodal parameters `u` \[m\], component by component of each node.
    pub fn errors(&self, simulation: &Simulation, u: &[f64]) -> AffineErrors {
        let (discretisation, model) = (&simulation.discretisation, &simulation.model);
        let (rows, components) = (&discretisation.supports, model.components);
        let mut worst = AffineErrors::default();
        for (X, nodal) in model.positions.iter().zip(u.chunks(components)) {
            let exact = self.displacement(X);
            let nodal = Vector3::from_fn(|k, _| nodal.get(k).copied().unwrap_or(0.0));
            worst.largest_nodal = larger(worst.largest_nodal, exact.norm());
            worst.nodal = larger(worst.nodal, (nodal - exact).norm());
        }
        for (point, X) in discretisation.quadrature.positions.iter().enumerate() {
            let exact = self.displacement(X);
            let displacement = rows.interpolate(point, u, components);
            worst.largest = larger(worst.largest, exact.norm());
            worst.displacement = larger(worst.displacement, (displacement - exact).norm());
            let F = rows.deformation_gradient(point, u, components);
            worst.gradient = larger(worst.gradient, (F - Matrix3::identity() - self.H).norm());
        }
        worst
    }
}
