//! Doubts about a discretisation.

use crate::discretisation::consistency::Correction;
use crate::discretisation::discretised_body::Discretisation;

/// A doubt about a discretisation that does not prevent a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Zero-energy modes are likely.
    FewerPointsThanNodes {
        /// Number of quadrature points.
        points: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// Some supports were poor with the influence radii of the recipe.
    EnlargedSupports {
        /// Number of quadrature points where radii were enlarged.
        points: usize,
        /// Number of all quadrature points.
        of: usize,
    },
    /// The correction of the gradients stopped above its tolerance.
    InconsistentGradients {
        /// Defect over that of plain gradients \[–\].
        residual: f64,
        /// Requested residual \[–\].
        tolerance: f64,
        /// Number of iterations.
        iterations: usize,
    },
}

impl std::fmt::Display for Warning {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Warning::FewerPointsThanNodes { points, nodes } => write!(
                f,
                "{points} quadrature points for {nodes} nodes: every cloud measured with 0.92 points per node \
                 or fewer had motions of which less than 5 % of the strain energy is seen (hourglassing); \
                 use smaller cells: 1.26 per nodal spacing give two points per node"
            ),
            Warning::EnlargedSupports { points, of } => write!(
                f,
                "the influence radii had to be enlarged at {points} of {of} quadrature points; \
                 a larger dilation avoids that"
            ),
            Warning::InconsistentGradients { residual, tolerance, iterations } => write!(
                f,
                "the gradients are consistent to {residual:.1e} only, not to the requested {tolerance:.1e}, \
                 after {iterations} iterations; a larger tolerance, a larger dilation or a more even \
                 cloud avoids that"
            ),
        }
    }
}

impl Discretisation {
    /// Doubts that a user should know of before trusting a result.
    pub fn warnings(&self) -> Vec<Warning> {
        let (points, nodes) = (self.supports.len(), self.cloud.positions.len());
        let mut warnings = Vec::new();
        if points < nodes {
            warnings.push(Warning::FewerPointsThanNodes { points, nodes });
        }
        if self.enlarged > 0 {
            warnings.push(Warning::EnlargedSupports { points: self.enlarged, of: points });
        }
        if let Some(Correction { residual, tolerance, iterations, .. }) = self.correction
            && residual > tolerance
        {
            warnings.push(Warning::InconsistentGradients { residual, tolerance, iterations });
        }
        warnings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::tensor::Vector3;
    use crate::discretisation::mls::Approximation;
    use crate::discretisation::nodes::NodeCloud;
    use crate::discretisation::quadrature::Quadrature;
    use crate::discretisation::rows::Rows;
    use crate::discretisation::surface_rule::SurfaceRule;
    use crate::problem::{Basis, Dimension, WeightFunction};

    #[test]
    fn a_correction_that_stops_above_its_tolerance_is_reported() {
        let discretisation = |residual: f64| Discretisation {
            dimension: Dimension::Three,
            cloud: NodeCloud { positions: vec![], spacing: vec![], on_boundary: vec![] },
            approximation: Approximation::new(
                vec![Vector3::zeros()],
                vec![1.0],
                Basis::Linear,
                WeightFunction::QuarticSpline,
                &Dimension::Three,
            ),
            quadrature: Quadrature::default(),
            supports: Rows::default(),
            surface: SurfaceRule::default(),
            patches: vec![0],
            correction: Some(Correction {
                iterations: 500,
                residual,
                tolerance: 1e-3,
                defect: 1.0,
                bodies: 1,
            }),
            enlarged: 0,
            worst_condition: 1.0,
        };
        assert!(discretisation(9e-4).warnings().is_empty());
        let warnings = discretisation(2e-3).warnings();
        assert!(matches!(warnings[..], [Warning::InconsistentGradients { iterations: 500, .. }]));
        assert!(warnings[0].to_string().contains("consistent to 2.0e-3 only"), "{}", warnings[0]);
    }
}
