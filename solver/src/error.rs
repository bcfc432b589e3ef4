//! The errors of the solver, with the numbers that locate them.

use crate::algebra::tensor::Vector3;
use crate::geometry::GeometryError;

/// An error of the solver. Positions are reference positions \[m\].
#[allow(missing_docs, reason = "the messages name every field")]
#[derive(Debug, Clone, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    #[error("the background grid gives no quadrature point inside the body: use smaller cells")]
    NoQuadraturePoints,
    #[error("no region contains the point ({}): let the last region contain everything", show(.position))]
    PointWithoutRegion { position: Vector3 },
    #[error("quadrature point {point} at ({}) has {support_size} nodes in its support and needs {smallest}: \
             raise the dilation, or add nodes there", show(.position))]
    SmallSupport { point: usize, position: Vector3, support_size: usize, smallest: usize },
    #[error("the moment matrix at quadrature point {point} at ({}) with {support_size} support nodes has condition \
             {condition:.1e} (largest {largest:.0e}): its nodes lie nearly in a plane or on a quadric; \
             raise the dilation, or use the linear basis", show(.position))]
    SingularMomentMatrix {
        point: usize,
        position: Vector3,
        support_size: usize,
        condition: f64,
        largest: f64,
    },
    #[error("node {node} at ({}) is covered by no quadrature point: use smaller cells or a larger dilation", show(.position))]
    UncoveredNode { node: usize, position: Vector3 },
    #[error("node {node} at ({}) has a lumped mass of {mass:.3e} kg: use smaller cells, or mass = \"even_split\"", show(.position))]
    MasslessNode { node: usize, position: Vector3, mass: f64 },
    #[error(
        "{points} quadrature points with {strains} strains each cannot resolve all motions of {nodes} nodes with \
             {constrained} constrained components: at least {modes} zero-energy modes (hourglassing) are left; use smaller \
             cells: 1.26 per nodal spacing give two points per node"
    )]
    TooFewPoints { points: usize, strains: usize, nodes: usize, constrained: usize, modes: usize },
    #[error("{points} quadrature points for {nodes} nodes leave at least {modes} motions with hardly any strain \
             energy at these points (hourglassing), {fraction:.1e} of the true one at the least, the worst about \
             node {node} at ({}): \
             use smaller cells: 1.26 per nodal spacing give two points per node", show(.position))]
    ZeroEnergyModes {
        points: usize,
        nodes: usize,
        modes: usize,
        fraction: f64,
        node: usize,
        position: Vector3,
    },
    #[error(
        "the correction of the gradients diverges: after {iterations} iterations they are {residual:.1e} times as \
             inconsistent as plain ones; use more cells per spacing or a larger dilation, or gradients = \"plain\""
    )]
    DivergedCorrection { iterations: usize, residual: f64 },
    #[error("condition \"{name}\" selects no node")]
    EmptySelection { name: String },
    #[error("traction \"{name}\" selects no part of the boundary")]
    EmptyTraction { name: String },
    #[error(
        "the conditions on component {component} constrain {rows} nodes whose constraints depend on each other: \
             use enforcement = \"direct\""
    )]
    DependentConstraints { component: char, rows: usize },
    #[error("the probe at ({}) lies where no shape functions can be built: {reason}", show(.position))]
    ProbeOutside { position: Vector3, reason: String },
    #[error("the fixed step of {fixed:.4e} s is above the critical step of {critical:.4e} s")]
    UnstableStep { fixed: f64, critical: f64 },
    #[error("diverged at step {step}, t = {time:.6} s: node {node} at ({}) moved by {displacement:.3e} m; \
             the step was {time_step:.3e} s", show(.position))]
    Diverged {
        step: usize,
        time: f64,
        node: usize,
        position: Vector3,
        displacement: f64,
        time_step: f64,
    },
    #[error("quadrature point {point} at ({}) turned inside out at step {step}, t = {time:.6} s: J = {jacobian:.3e}",
            show(.position))]
    Inverted { step: usize, time: f64, point: usize, position: Vector3, jacobian: f64 },
    #[error(
        "dynamic relaxation has not converged after {steps} steps: estimated error {error:.2e} m of a tolerance of \
             {tolerance:.2e} m, residual {residual:.2e} of the largest force"
    )]
    NotConverged { steps: usize, error: f64, tolerance: f64, residual: f64 },
    #[error(
        "newton's method does not treat contact: use dynamic relaxation for a body with obstacles"
    )]
    ContactInNewton,
    #[error(
        "newton's method converges to no equilibrium beyond {reached:.4} of the load: after {iterations} iterations the residual \
             is {residual:.2e} of the largest force{}: use dynamic relaxation, or reduce the load",
        if *.indefinite { " and the tangent is indefinite, as where a body buckles" } else { "" }
    )]
    NoEquilibrium { reached: f64, iterations: usize, residual: f64, indefinite: bool },
    #[error(
        "the model was built for a static problem, its masses are fictitious: build it from a problem whose motion is dynamic"
    )]
    FictitiousMass,
    /// The motion asks for mass scaling, and the model has the masses of the body.
    #[error(
        "the motion scales masses by a factor of {factor} in the critical step, and the model was built without: \
             set it up by Simulation::new, or pass it through raise_masses"
    )]
    UnscaledMass {
        /// Requested ratio of critical time steps \[–\].
        factor: f64,
    },
    #[error(
        "a critical step {factor} times longer takes {:.1} % more mass, and more than {:.0} % would change the motion: \
             scale less, or make the smallest spacings larger",
        100.0 * fraction, 100.0 * most
    )]
    TooMuchAddedMass { factor: f64, fraction: f64, most: f64 },
}

/// Coordinates in metres for a message.
fn show(position: &Vector3) -> String {
    format!("{:.6}, {:.6}, {:.6} m", position.x, position.y, position.z)
}
