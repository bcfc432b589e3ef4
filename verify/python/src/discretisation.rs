//! The discretisation of a case as arrays.

use crate::arrays::{Rows, rows, vectors};
use mtled::Simulation;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;

/// Nodes, quadrature points and supports of a case. Supports are rows as in a compressed sparse
/// matrix: the entries of point p are `support_starts[p]:support_starts[p + 1]`.
#[pyclass(frozen, get_all, module = "mtled")]
pub(crate) struct Discretisation {
    /// Reference positions [m], (nodes, 3).
    nodes_m: Rows,
    /// Local distance of nodes [m], (nodes,).
    nodal_spacing_m: Py<PyArray1<f64>>,
    /// Radius of the influence domain of each node [m], (nodes,).
    influence_radius_m: Py<PyArray1<f64>>,
    /// Whether a node lies on the boundary, (nodes,).
    on_boundary: Py<PyArray1<bool>>,
    /// Lumped mass of each node [kg], (nodes,).
    lumped_mass_kg: Py<PyArray1<f64>>,
    /// Reference positions [m], (points, 3).
    points_m: Rows,
    /// Volume of each quadrature point [m³], (points,).
    quadrature_weights_m3: Py<PyArray1<f64>>,
    /// Number of the region of each point, (points,).
    point_regions: Py<PyArray1<u16>>,
    /// (points + 1,)
    support_starts: Py<PyArray1<usize>>,
    /// Node of each entry, (entries,).
    support_nodes: Py<PyArray1<u32>>,
    /// φ of that node at the point [–], (entries,).
    phi: Py<PyArray1<f64>>,
    /// Grad φ [1/m], (entries, 3).
    grad_phi_per_m: Rows,
    /// The largest condition number of a moment matrix.
    worst_condition: f64,
    /// Quadrature points whose influence radii had to be enlarged.
    enlarged_supports: usize,
    /// Reasons to doubt a result.
    warnings: Vec<String>,
    /// Wall time of the set-up [s].
    setup_seconds: f64,
}

impl Discretisation {
    /// Takes over the memory of the solver.
    pub(crate) fn new(
        py: Python,
        simulation: Simulation,
        warnings: Vec<String>,
    ) -> PyResult<Discretisation> {
        let Simulation { discretisation, model, setup_seconds, .. } = simulation;
        let (cloud, approximation) = (discretisation.cloud, discretisation.approximation);
        let (quadrature, supports) = (discretisation.quadrature, discretisation.supports);
        let gradients = supports.grad_phi;
        Ok(Discretisation {
            nodes_m: vectors(py, cloud.positions)?,
            nodal_spacing_m: cloud.spacing.into_pyarray(py).unbind(),
            influence_radius_m: approximation.influence_radius.into_pyarray(py).unbind(),
            on_boundary: cloud.on_boundary.into_pyarray(py).unbind(),
            lumped_mass_kg: model.lumped_mass.into_pyarray(py).unbind(),
            points_m: vectors(py, quadrature.positions)?,
            quadrature_weights_m3: quadrature.weights.into_pyarray(py).unbind(),
            point_regions: quadrature.regions.into_pyarray(py).unbind(),
            support_starts: supports.starts.into_pyarray(py).unbind(),
            support_nodes: supports.nodes.into_pyarray(py).unbind(),
            phi: supports.phi.into_pyarray(py).unbind(),
            grad_phi_per_m: if gradients.is_empty() {
                rows(py, Vec::new(), 3)?
            } else {
                vectors(py, gradients)?
            },
            worst_condition: discretisation.worst_condition,
            enlarged_supports: discretisation.enlarged,
            warnings,
            setup_seconds,
        })
    }
}
