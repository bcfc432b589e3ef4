//! The errors of the solver, with the numbers that locate them.

use crate::algebra::tensor::Vector3;
use crate::geometry::GeometryError;
use crate::problem::{Mistake, NoDirection};

/// An equilibrium that a body leaves at the slightest touch, or has left by itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Instability {
    /// Steps before it was noticed.
    pub step: usize,
    /// The node that moved most.
    pub node: usize,
    /// Its reference position \[m\].
    pub position: Vector3,
    /// The motion, its largest component 1 \[component of node\] \[–\].
    pub mode: Vec<f64>,
    /// Whether the body has left it for an equilibrium without such a mode.
    pub passed: bool,
}

impl std::fmt::Display for Instability {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Instability { step, node, position, passed, .. } = self;
        if *passed {
            return write!(
                f,
                "buckled: at step {step} the tangent had a negative mode, largest at node {node} at ({}), and the body \
                 has left that equilibrium for one that is stable against smooth motions; there may be others, such as \
                 its mirror image",
                show(position)
            );
        }
        write!(
            f,
            "unstable: at step {step} the tangent has a negative mode, largest at node {node} at ({}): the body \
             buckles, topples or folds, and what it comes to rest in is an equilibrium that it leaves at the \
             slightest touch, or another one than small loads lead to; support it, or reduce the load",
            show(position)
        )
    }
}

/// An error of the solver. Positions are reference positions \[m\].
#[allow(missing_docs, reason = "the messages name every field")]
#[derive(Debug, Clone, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A number of the problem cannot be used.
    #[error(transparent)]
    Mistake(#[from] Mistake),
    /// A simulation was run twice.
    #[error("the simulation has run already, to t = {time} s: set up another one for another run")]
    HasRun { time: f64 },
    /// A simulation cannot go on from the state of another body.
    #[error(
        "the state has {found} numbers and the body needs {expected}: it is a state of another body"
    )]
    StateOfAnother { found: usize, expected: usize },
    #[error("the background grid gives no quadrature point inside the body: use smaller cells")]
    NoQuadraturePoints,
    #[error("no region contains the point ({}): let the last region contain everything", show(.position))]
    PointWithoutRegion { position: Vector3 },
    /// A load or velocity that is no number somewhere; `what` is its list.
    #[error("{what} {index} is no number at ({}): give a formula that has a value in its whole part", show(.position))]
    NoValue { what: &'static str, index: usize, position: Vector3 },
    /// Fibres or sheets without a direction.
    #[error(transparent)]
    NoDirection(#[from] NoDirection),
    #[error("quadrature point {point} at ({}) has {support_size} nodes in its support and needs {smallest}: \
             raise the dilation, or add nodes there", show(.position))]
    SmallSupport { point: usize, position: Vector3, support_size: usize, smallest: usize },
    #[error("the moment matrix at quadrature point {point} at ({}) with {support_size} support nodes has {} \
             (largest {largest:.0e}): its nodes lie nearly in a plane or on a quadric; \
             raise the dilation, or use the linear basis", show(.position), condition_text(*.condition))]
    SingularMomentMatrix {
        point: usize,
        position: Vector3,
        support_size: usize,
        condition: f64,
        largest: f64,
    },
    #[error("the quadrature points around point {point} at ({}) see more than {most} nodes: lower the dilation", show(.position))]
    LargeSupports { point: usize, position: Vector3, most: usize },
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
             node {node} at ({}), with {density:.2} points per spacing squared or cubed: \
             use smaller cells there, or let the grid follow the nodes (leave out its cell and refine): \
             1.26 cells per nodal spacing give two points per node", show(.position))]
    ZeroEnergyModes {
        points: usize,
        nodes: usize,
        modes: usize,
        fraction: f64,
        node: usize,
        density: f64,
        position: Vector3,
    },
    #[error(
        "the correction of the gradients diverges: after {iterations} iterations they are {residual:.1e} times as \
             inconsistent as plain ones; use more cells per spacing or a larger dilation, or gradients = \"plain\""
    )]
    DivergedCorrection { iterations: usize, residual: f64 },
    #[error("condition \"{name}\" selects no node")]
    EmptySelection { name: String },
    #[error("condition \"{name}\" selects node {node} at ({}), which is {distance:.4e} m from its nearest data point, \
             more than the reach of {reach:.4e} m: select fewer nodes, raise the reach, or leave such nodes free", show(.position))]
    BeyondData { name: String, node: usize, position: Vector3, distance: f64, reach: f64 },
    #[error("the displacement of condition \"{name}\" at node {node} ({}) is not a finite number: \
             change its formula or select other nodes", show(.position))]
    NoDisplacement { name: String, node: usize, position: Vector3 },
    #[error("condition \"{second}\" prescribes another displacement {component} than condition \"{first}\" for {} \
             that both select, at node {node} ({}) {:.4e} m and {:.4e} m at t = {time:.6} s: \
             change one of them, or its selection",
            counted(*.nodes), show(.position), .displacements[1], .displacements[0])]
    ContradictingConditions {
        first: String,
        second: String,
        component: char,
        nodes: usize,
        node: usize,
        position: Vector3,
        time: f64,
        displacements: [f64; 2],
    },
    #[error("{} {} inside obstacle \"{name}\" at the start, node {node} at ({}) by {depth:.4e} m: \
             move the obstacle, change its side, or give it another offset",
            counted(*.nodes), if *.nodes == 1 { "is" } else { "are" }, show(.position))]
    NodesInObstacle { name: String, nodes: usize, node: usize, position: Vector3, depth: f64 },
    #[error("condition \"{condition}\" moves {} into obstacle \"{obstacle}\", node {node} at ({}) by {depth:.4e} m \
             at t = {time:.6} s: change the displacement, or move the obstacle", counted(*.nodes), show(.position))]
    DrivenIntoObstacle {
        condition: String,
        obstacle: String,
        nodes: usize,
        node: usize,
        position: Vector3,
        depth: f64,
        time: f64,
    },
    #[error("obstacle \"{name}\" lies inside the body at the start, between its nodes, at ({}): move it, or cut \
             its place out of the body", show(.position))]
    ObstacleInBody { name: String, position: Vector3 },
    #[error("obstacle \"{name}\" is empty: its offset or what is cut out of it leaves nothing")]
    EmptyObstacle { name: String },
    #[error(
        "initial velocity {index} sets that of no node: its part holds none, or an earlier one has them"
    )]
    EmptyInitialVelocity { index: usize },
    #[error(
        "region \"{name}\" has no quadrature point and so no centre of mass: use smaller cells there, or another region"
    )]
    EmptyRegion { name: String },
    #[error("traction \"{name}\" selects no part of the boundary")]
    EmptyTraction { name: String },
    #[error(
        "body force {index} acts on no quadrature point: its part lies outside the body or between the points; \
             change it, or use smaller cells there"
    )]
    EmptyBodyForce { index: usize },
    #[error(
        "body force {index} acts on a part of {volume:e} m³, too small for its volume to be known; the least \
             is {smallest:e} m³, a fifth of a spacing wide: choose a larger part, or a smaller spacing"
    )]
    SmallBodyForce { index: usize, volume: f64, smallest: f64 },
    #[error("pressure \"{name}\" selects no part of the boundary")]
    EmptyPressure { name: String },
    #[error("an unloaded configuration is not looked for with {what}")]
    NotUnloaded { what: &'static str },
    #[error(
        "no configuration without loads is found beyond {reached:.4} of the loads: the loads are too large for the \
             material, or the body has no single one; the last attempt there: {last}"
    )]
    NoneUnloaded { reached: f64, last: String },
    #[error(
        "on the way to the configuration without loads the body folds near ({}) m, with J = {determinant:.2e}: \
             the loads are too large for the material, or it is too soft", show(.position)
    )]
    FoldedBody { position: Vector3, determinant: f64 },
    #[error("spring \"{name}\" selects no part of the boundary")]
    EmptySpring { name: String },
    #[error("cavity \"{name}\" selects no part of the boundary")]
    EmptyCavity { name: String },
    #[error(
        "the surface of cavity \"{name}\" is open ({part:.2} of its area is not closed), so that it encloses no \
             volume: give a point of the plane of its opening, or select all of the surface"
    )]
    OpenCavity { name: String, part: f64 },
    #[error("the surface of cavity \"{name}\" is closed: remove its opening")]
    ClosedCavity { name: String },
    #[error(
        "cavity \"{name}\" has a volume of {volume:e} at rest: the body lies inside of its surface and not \
             around it, or its opening is elsewhere"
    )]
    NoCavity { name: String, volume: f64 },
    #[error(
        "the conditions on component {component} constrain {rows} nodes whose constraints depend on each other: \
             use enforcement = \"direct\""
    )]
    DependentConstraints { component: char, rows: usize },
    #[error("the probe at ({}) lies where no shape functions can be built: {reason}", show(.position))]
    ProbeOutside { position: Vector3, reason: String },
    #[error("the fixed step of {fixed:.4e} s is above the critical step of {critical:.4e} s")]
    UnstableStep { fixed: f64, critical: f64 },
    /// Numbers beyond what a computer holds.
    #[error(
        "no time step can be found, the critical one is {critical} s: moduli, densities or lengths are beyond what \
         numbers hold; check their units"
    )]
    NoTimeStep { critical: f64 },
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
        "dynamic relaxation has not converged after {steps} steps{}: estimated error {error:.2e} m of a tolerance of \
             {tolerance:.2e} m, residual {residual:.2e} of the largest force; node {node} at ({}) still moves most, \
             by {moving:.2e} m a step{}",
        if *.stalled { " and no longer gets nearer" } else { "" },
        show(.position),
        not_held(*.free)
    )]
    NotConverged {
        steps: usize,
        stalled: bool,
        error: f64,
        tolerance: f64,
        residual: f64,
        node: usize,
        position: Vector3,
        moving: f64,
        free: usize,
    },
    #[error("{then}{}", not_held(*.free))]
    NotHeld { free: usize, then: Box<Error> },
    #[error("{instability}; then: {then}")]
    Unstable { instability: Instability, then: Box<Error> },
    #[error(
        "no equilibrium exists: nothing holds the body along {axis}, and the loads push it there with {force:.3e} N; \
             prescribe that component somewhere, or add an obstacle or a spring"
    )]
    NothingHolds { axis: char, force: f64 },
    #[error(
        "newton's method converges to no equilibrium beyond {reached:.4} of the load: after {iterations} iterations the residual \
             is {residual:.2e} of the largest force{}: use dynamic relaxation, of materials without viscosity, or reduce the load",
        if *.indefinite { " and the tangent is indefinite, as where a body buckles" } else { "" }
    )]
    NoEquilibrium {
        reached: f64,
        iterations: usize,
        evaluations: usize,
        residual: f64,
        indefinite: bool,
    },
    #[error(
        "sensitivities of a body with viscosity depend on all equilibria before the last one, and are not computed: remove `prony` for those of a sudden load"
    )]
    MemoryToVary,
    #[error(
        "sensitivities are those of a static problem that Newton's method solves: set its motion to Motion::Newton \
             or Motion::Static, without friction on obstacles"
    )]
    NoEquilibriumToVary,
    #[error(
        "the linear problem of a sensitivity is solved to {residual:.1e} of its forces only, and {limit:.0e} is needed: the \
             body may be about to lose its stability, or contacts may be about to open; look at it under a little less load"
    )]
    NoSensitivity { residual: f64, limit: f64 },
    /// No natural frequency was asked for.
    #[error("no frequency is asked for: ask for 1 or more")]
    NoFrequencies,
    /// There are not so many natural frequencies.
    #[error(
        "{asked} frequencies are asked for, and the body has {has}: its nodes have {components} components of displacement, \
             {held} are held and {rigid} are rigid motions; ask for fewer, or make the nodal spacing smaller"
    )]
    TooManyFrequencies { asked: usize, has: usize, components: usize, held: usize, rigid: usize },
    #[error("{then}; newton's method, tried before, came to {reached:.4} of the load")]
    NeitherSolver { reached: f64, then: Box<Error> },
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

impl Error {
    /// The instability that the run met.
    pub fn instability(&self) -> Option<&Instability> {
        match self {
            Error::Unstable { instability, .. } => Some(instability),
            Error::NotHeld { then, .. } | Error::NeitherSolver { then, .. } => then.instability(),
            _ => None,
        }
    }
}

/// What a message says of rigid motions that nothing prevents.
fn not_held(free: usize) -> String {
    match free {
        0 => String::new(),
        free => format!(
            "; conditions and closed contacts leave {free} rigid motions of the body free: hold it at more nodes"
        ),
    }
}

/// Some nodes, in words.
fn counted(nodes: usize) -> String {
    if nodes == 1 { "1 node".into() } else { format!("{nodes} nodes") }
}

/// The condition of a matrix for a message.
pub(crate) fn condition_text(condition: f64) -> String {
    if condition.is_finite() {
        format!("condition {condition:.1e}")
    } else {
        "no inverse".to_string()
    }
}

/// Coordinates in metres for a message.
pub(crate) fn show(position: &Vector3) -> String {
    format!("{:.6}, {:.6}, {:.6} m", position.x, position.y, position.z)
}
