//! What is to be solved: plain data, made by the scene reader or by hand.

use crate::algebra::tensor::Vector3;
use crate::geometry::Shape;
pub use crate::geometry::dimension::Dimension;
pub use crate::geometry::field::Field;
use crate::geometry::selection::{Extent, Selector};
use crate::material::Material;

/// A whole problem: body, discretisation recipe, conditions, loads, time.
#[derive(Debug, Clone)]
pub struct Problem {
    pub dimension: Dimension,
    /// The solid that deforms.
    pub body: Shape,
    /// Parts of the body with a material each; the first that contains a
    /// point owns it, and the last should contain everything.
    pub regions: Vec<Region>,
    pub recipe: Recipe,
    pub conditions: Vec<EssentialCondition>,
    pub loads: Loads,
    pub obstacles: Vec<Obstacle>,
    pub motion: Motion,
}

/// A part of the body made of one material.
#[derive(Debug, Clone)]
pub struct Region {
    pub name: String,
    pub part: Selector,
    pub material: Material,
}

/// How the body is turned into nodes, supports and quadrature points.
#[derive(Debug, Clone)]
pub struct Recipe {
    pub cloud: Cloud,
    /// Influence radius over local nodal spacing \[–\].
    pub dilation: f64,
    pub basis: Basis,
    pub weight_function: WeightFunction,
    pub grid: BackgroundGrid,
    pub mass: MassRule,
    /// How prescribed displacements are enforced.
    pub enforcement: Enforcement,
    pub gradients: Gradients,
    pub gradient_storage: GradientStorage,
    pub volumetric_projection: VolumetricProjection,
}

/// Where the nodes come from.
#[derive(Debug, Clone)]
pub enum Cloud {
    /// Lattice points inside the body plus boundary nodes, `spacing` \[m\] apart.
    Regular { spacing: f64 },
    /// As `Regular`, interior nodes moved at random by up to
    /// `jitter` × spacing in each direction (boundary nodes slide along the
    /// boundary where that is possible, or stay).
    Jittered { spacing: f64, jitter: f64, seed: u64 },
    /// Spacing that varies: `spacing` \[m\] far away, each refinement its own
    /// spacing inside its part, growing by at most `growth` per unit length.
    /// Another `seed` than 0 moves the tree of lattices that nodes are picked from.
    Graded { spacing: f64, refinements: Vec<Refinement>, growth: f64, seed: u64 },
    /// Nodes given one by one \[m\]; the local spacing is estimated.
    Given { nodes: Vec<Vector3> },
}

/// A size \[m\] wanted inside a part of the body.
#[derive(Debug, Clone)]
pub struct Refinement {
    pub part: Selector,
    pub size: f64,
}

/// Polynomial basis of the moving least squares.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Basis {
    /// 1, x, y, z (1, x, y in a plane).
    Linear,
    /// All monomials up to second order.
    Quadratic,
    /// All monomials up to second order, the coefficients of second order held
    /// small by `regularisation` \[–\]: sound wherever the linear basis is, and
    /// close to the quadratic one where that is sound (modified moving least
    /// squares, Joldes et al. 2015).
    ModifiedQuadratic { regularisation: f64 },
}

/// Weight function W(q) of the scaled distance q = |X − X_a|/r_a.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WeightFunction {
    CubicSpline,
    QuarticSpline,
    Exponential,
}

/// The background grid that the quadrature points come from. It need not
/// conform to the geometry.
#[derive(Debug, Clone)]
pub struct BackgroundGrid {
    /// Edge of the largest cells \[m\].
    pub cell: f64,
    /// Cells that meet the boundary of the body are halved until they are no
    /// larger than this \[m\]; `None` leaves them.
    pub boundary_cell: Option<f64>,
    /// Cells that meet a part are halved until they are no larger than its size.
    pub refinements: Vec<Refinement>,
    /// Gauss points per cell and direction.
    pub gauss_points: usize,
    pub inside: InsideRule,
}

/// What becomes of a cell that the boundary cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InsideRule {
    /// The seed's rule: kept whole if its centre is inside, dropped otherwise.
    Centre,
    /// A point at the centroid of the inside part with the inside volume.
    VolumeFraction,
}

/// How the mass of a quadrature point is given to its support nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MassRule {
    /// The seed's rule: split evenly over the support.
    EvenSplit,
    /// Σ_q ρ w_q φ_a.
    RowSum,
}

/// Which Grad φ the strains and forces use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Gradients {
    /// The derivatives of φ, as in the seed: affine fields are no equilibrium.
    Plain,
    /// Changed as little as possible until the divergence theorem holds for
    /// every node, up to `tolerance` of the plain gradients' defect \[–\].
    Consistent { tolerance: f64 },
}

/// How many digits of Grad φ the forces read; all arithmetic is in double
/// precision either way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GradientStorage {
    /// Every one.
    Double,
    /// Rounded once to single precision: 16 bytes to read per support entry
    /// instead of 28. Relative errors of 6·10⁻⁸ in each gradient leave patch tests
    /// at 10⁻⁷ and change displacements by less than 10⁻⁶ of the largest.
    Single,
}

/// Projection of the change of volume J in the bulk energy, against volumetric locking.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VolumetricProjection {
    /// J at every quadrature point: nearly incompressible materials lock.
    None,
    /// J projected onto linear functions on patches of quadrature points where the
    /// material is nearly incompressible; at every point elsewhere.
    Patches,
}

/// How prescribed displacements are enforced on functions that do not
/// interpolate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Enforcement {
    /// The nodal parameter is set to the prescribed value (the seed).
    Direct,
    /// The displacement field takes the prescribed value at the nodes, by
    /// constraint forces on all parameters in their supports (EBCIEM).
    Collocation,
}

/// A prescribed displacement on a selection of nodes.
#[derive(Debug, Clone)]
pub struct EssentialCondition {
    pub name: String,
    pub extent: Extent,
    pub part: Selector,
    pub prescribed: Prescribed,
    pub amplitude: Amplitude,
    /// Enforced while t < `release` \[s\]; for ever if `None`.
    pub release: Option<f64>,
}

/// What is prescribed at amplitude 1.
#[derive(Debug, Clone)]
pub enum Prescribed {
    /// A displacement \[m\] per component; `None` leaves a component free.
    Displacement([Option<f64>; 3]),
    /// u = (R(amplitude · angle) − I)(X − point), about a unit axis; angle \[rad\].
    Rotation { point: Vector3, axis: Vector3, angle: f64 },
    /// All components of a displacement field \[m\], at the nodes' own positions.
    Field(Field),
}

/// A factor over time \[–\].
#[derive(Debug, Clone)]
pub enum Amplitude {
    /// 1 from the start.
    Constant,
    /// From 0 to 1 in a straight line over `duration` \[s\], then 1.
    Linear { duration: f64 },
    /// 10s³ − 15s⁴ + 6s⁵, s = t/`duration` \[s\], then 1.
    Smooth { duration: f64 },
    /// Straight lines through (time \[s\], factor), constant outside; 0 if empty.
    Table(Vec<(f64, f64)>),
}

impl Amplitude {
    /// The factor at time `t` \[s\].
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Amplitude::Constant => 1.0,
            Amplitude::Linear { duration } => (t / duration).clamp(0.0, 1.0),
            Amplitude::Smooth { duration } => {
                let s = (t / duration).clamp(0.0, 1.0);
                s * s * s * (10.0 + s * (6.0 * s - 15.0))
            }
            Amplitude::Table(rows) => interpolate(rows, t),
        }
    }
}

fn interpolate(rows: &[(f64, f64)], t: f64) -> f64 {
    let after = rows.partition_point(|row| row.0 <= t);
    match after {
        0 => rows.first().map_or(0.0, |row| row.1),
        n if n == rows.len() => rows[n - 1].1,
        n => {
            let ((t0, a0), (t1, a1)) = (rows[n - 1], rows[n]);
            a0 + (a1 - a0) * (t - t0) / (t1 - t0)
        }
    }
}

/// Everything that pushes without a constraint.
#[derive(Debug, Clone, Default)]
pub struct Loads {
    pub body_forces: Vec<BodyForce>,
    pub tractions: Vec<Traction>,
    /// Velocity at t = 0 \[m/s\], the first part that contains a node.
    pub initial_velocities: Vec<(Selector, Vector3)>,
}

/// A force per mass \[N/kg\] on the whole body.
#[derive(Debug, Clone)]
pub struct BodyForce {
    pub acceleration: Field,
    pub amplitude: Amplitude,
}

/// A dead traction: force per reference area \[Pa\] of fixed direction.
#[derive(Debug, Clone)]
pub struct Traction {
    pub name: String,
    pub part: Selector,
    pub traction: Vector3,
    pub amplitude: Amplitude,
}

/// A rigid obstacle that nodes may not enter.
#[derive(Debug, Clone)]
pub struct Obstacle {
    pub name: String,
    pub shape: Shape,
    /// The shape is grown by this much first \[m\].
    pub offset: f64,
    pub side: ObstacleSide,
    pub friction: Friction,
}

/// On which side of the obstacle's surface the body lives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ObstacleSide {
    /// The shape is solid; the body stays outside.
    Outside,
    /// The shape is a cavity, as in a skull; the body stays inside.
    Inside,
}

/// What happens along the surface of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Friction {
    /// Nodes slide freely.
    Frictionless,
    /// Nodes that touch do not slide while they touch.
    NoSlip,
}

/// How the body moves from its reference configuration.
#[derive(Debug, Clone)]
pub enum Motion {
    /// Central differences from t = 0 to `end` \[s\].
    Dynamic {
        end: f64,
        step: StepControl,
        /// Mass-proportional damping: f_damp = −`damping` M v \[1/s\].
        damping: f64,
    },
    /// Dynamic relaxation to a static solution.
    Static(Relaxation),
    /// Newton's method to a static solution.
    Equilibrium(Newton),
}

/// How the time step follows the critical one.
#[derive(Debug, Clone, Copy)]
pub struct StepControl {
    /// Step over the critical step of the tangent operator \[–\].
    pub safety_factor: f64,
    /// The critical step is found again after this many steps at the latest,
    /// and before as the tangent changes.
    pub reevaluate_every: usize,
    /// A step \[s\] to be used instead; the run is refused if it is not stable
    /// in the reference configuration.
    pub fixed: Option<f64>,
    /// Factor by which heavier nodes lengthen the critical step at rest of a
    /// quasi-static motion \[–\]; 1 adds no mass.
    pub mass_scaling: f64,
}

impl Default for StepControl {
    fn default() -> Self {
        StepControl { safety_factor: 0.94, reevaluate_every: 1000, fixed: None, mass_scaling: 1.0 }
    }
}

/// Settings of dynamic relaxation.
#[derive(Debug, Clone, Copy)]
pub struct Relaxation {
    /// Amplitudes run from t = 0 to this time \[s\], then everything is held;
    /// it is a time of the load curves, not of the body.
    pub load_end: f64,
    /// Number of steps over which the load is applied.
    pub load_steps: usize,
    /// Wanted error of the largest displacement over its size \[–\].
    pub tolerance: f64,
    pub max_steps: usize,
    pub step: StepControl,
    pub mass: RelaxationMass,
}

/// The mass of dynamic relaxation, on which static solutions do not depend.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RelaxationMass {
    /// In proportion to the diagonal of the stiffness at rest: stiff and soft
    /// places then move at the same pace.
    #[default]
    Stiffness,
    /// The lumped mass of the body.
    Lumped,
}

/// Settings of Newton's method.
#[derive(Debug, Clone, Copy)]
pub struct Newton {
    /// Amplitudes run from t = 0 to this time \[s\].
    pub load_end: f64,
    /// Wanted largest unbalanced nodal force over the largest nodal force \[–\].
    pub tolerance: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smooth_amplitude_starts_and_ends_at_rest() {
        let amplitude = Amplitude::Smooth { duration: 2.0 };
        assert_eq!(amplitude.at(0.0), 0.0);
        assert_eq!(amplitude.at(1.0), 0.5);
        assert_eq!(amplitude.at(5.0), 1.0);
        assert!(amplitude.at(2e-3) < 1e-8);
    }

    #[test]
    fn a_table_is_linear_between_its_rows_and_constant_outside() {
        let table = Amplitude::Table(vec![(1.0, 0.0), (2.0, 4.0), (3.0, 2.0)]);
        assert_eq!(table.at(0.0), 0.0);
        assert_eq!(table.at(1.5), 2.0);
        assert_eq!(table.at(2.5), 3.0);
        assert_eq!(table.at(9.0), 2.0);
    }
}
