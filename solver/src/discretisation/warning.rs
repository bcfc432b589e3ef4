//! Doubts about a discretisation, and about the problem that is put to it.

use crate::algebra::tensor::Vector3;
use crate::discretisation::bridged_gap::BridgedGap;
use crate::discretisation::consistency::Correction;
use crate::discretisation::discretised_body::Discretisation;
use crate::error::show;

/// A doubt that does not prevent a run. Positions are reference positions \[m\].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Warning {
    /// Zero-energy modes are likely.
    #[error(
        "{points} quadrature points for {nodes} nodes: every cloud measured with 0.92 points per node or \
         fewer had motions of which less than 5 % of the strain energy is seen (hourglassing); use smaller \
         cells: 1.26 per nodal spacing give two points per node"
    )]
    FewerPointsThanNodes {
        /// Number of quadrature points.
        points: usize,
        /// Number of nodes.
        nodes: usize,
    },
    /// Points on one side of a gap have too few nodes there and share those of the other.
    #[error(
        "{points} of {of} quadrature points beside gaps of the body have too few nodes on their own side, so \
         that both sides move as one there: at ({}) the gap is {width:.3e} m wide and the nodal spacing is \
         {spacing:.3e} m; use a spacing of at most half the thickness of the material beside the gap, or \
         fill the gap",
        show(.position)
    )]
    BridgedGap {
        /// Number of quadrature points.
        points: usize,
        /// Number of all quadrature points.
        of: usize,
        /// Where the gap is widest.
        position: Vector3,
        /// Its width there \[m\].
        width: f64,
        /// Nodal spacing there \[m\].
        spacing: f64,
    },
    /// Some supports were poor with the influence radii of the recipe.
    #[error(
        "the influence radii had to be enlarged at {points} of {of} quadrature points; a larger dilation \
         avoids that"
    )]
    EnlargedSupports {
        /// Number of quadrature points where radii were enlarged.
        points: usize,
        /// Number of all quadrature points.
        of: usize,
    },
    /// The correction of the gradients stopped above its tolerance.
    #[error(
        "the gradients are consistent to {residual:.1e} only, not to the requested {tolerance:.1e}, after \
         {iterations} iterations; a larger tolerance, a larger dilation or a more even cloud avoids that"
    )]
    InconsistentGradients {
        /// Defect over that of plain gradients \[–\].
        residual: f64,
        /// Requested residual \[–\].
        tolerance: f64,
        /// Number of iterations.
        iterations: usize,
    },
    /// Two conditions prescribe the same of more than an edge between two faces.
    #[error(
        "conditions \"{first}\" and \"{second}\" prescribe the same displacement {} of {nodes} nodes, whose \
         force is counted with \"{first}\" alone",
        .components.iter().map(char::to_string).collect::<Vec<_>>().join(", ")
    )]
    SharedNodes {
        /// The condition that has the force.
        first: String,
        /// The other one.
        second: String,
        /// What both prescribe.
        components: Vec<char>,
        /// Number of nodes that both select.
        nodes: usize,
    },
    /// A region of the problem has no effect.
    #[error(
        "region \"{name}\" has no quadrature point, so its material has no effect: it lies outside the body, \
         between the points, or in an earlier region"
    )]
    EmptyRegion {
        /// Its name.
        name: String,
    },
    /// A traction or a pressure acts on nodes only whose motion is prescribed.
    #[error(
        "load \"{name}\" acts on nodes only whose displacement is prescribed: it changes reactions and \
         nothing else"
    )]
    CarriedTraction {
        /// Its name.
        name: String,
    },
    /// Masses at few nodes cannot have the moments of inertia of their body.
    #[error(
        "a body that nothing holds has too few nodes for its moments of inertia, which are {:.0} % off: it turns as \
         if it were larger; use a smaller spacing",
        100.0 * .error
    )]
    FewNodesToTurn {
        /// Relative error of its moments of inertia \[–\].
        error: f64,
    },
    /// The load of a static problem ends before an amplitude does.
    #[error(
        "the amplitude of \"{name}\" lasts {duration} s and the load ends at {end} s, where it is \
         {factor:.4}: the solution is that of a part of the load"
    )]
    UnfinishedLoad {
        /// What is loaded.
        name: String,
        /// Of the amplitude \[s\].
        duration: f64,
        /// Of the load \[s\].
        end: f64,
        /// The amplitude there \[–\].
        factor: f64,
    },
    /// A static problem begins with a rotation of more than half a turn.
    #[error(
        "\"{name}\" turns by {angle:.4} rad at once, more than half a turn: the solution is that of the \
         shorter way to the same place; state how it gets there, as with amplitude = {{ linear = {{ duration = 1 }} }}"
    )]
    SuddenTurn {
        /// Of the condition.
        name: String,
        /// At the start \[rad\].
        angle: f64,
    },
    /// A condition is released before the load of a static problem ends.
    #[error(
        "\"{name}\" is released at {release} s and the load ends at {end} s: the solution is that of a body \
         that it no longer holds"
    )]
    ReleasedEarly {
        /// Of the condition.
        name: String,
        /// Of the condition \[s\].
        release: f64,
        /// Of the load \[s\].
        end: f64,
    },
    /// Nodes are a little inside an obstacle before the first step.
    #[error(
        "{nodes} nodes are inside obstacle \"{name}\" at the start, node {node} at ({}) by {depth:.4e} m: \
         the first step moves them out",
        show(.position)
    )]
    StartInsideObstacle {
        /// Name of the obstacle.
        name: String,
        /// How many.
        nodes: usize,
        /// The deepest of them.
        node: usize,
        /// Where it is.
        position: Vector3,
        /// \[m\]
        depth: f64,
    },
    /// Nodes that contact leaves alone, because a component is prescribed, have entered an
    /// obstacle.
    #[error(
        "{nodes} nodes have entered obstacle \"{name}\", node {node} of reference position ({}) by \
         {depth:.4e} m: contact does not act on nodes of which a component is prescribed",
        show(.position)
    )]
    EndInsideObstacle {
        /// Name of the obstacle.
        name: String,
        /// How many.
        nodes: usize,
        /// The deepest of them.
        node: usize,
        /// Where it is.
        position: Vector3,
        /// \[m\]
        depth: f64,
    },
    /// The surface has entered an obstacle between nodes.
    #[error(
        "the surface has entered obstacle \"{name}\" between nodes, by {depth:.4e} m at reference position \
         ({}): the obstacle has an edge or is narrow for the spacing of the nodes there; use a finer cloud",
        show(.position)
    )]
    SurfaceInObstacle {
        /// Name of the obstacle.
        name: String,
        /// The deepest place.
        position: Vector3,
        /// \[m\]
        depth: f64,
    },
    /// An obstacle has passed through the surface between nodes.
    #[error(
        "obstacle \"{name}\" has passed into the body between nodes and lies about reference position ({}), \
         where it exerts no force: it is narrow for the spacing of the nodes; use a finer cloud, or a larger \
         obstacle",
        show(.position)
    )]
    ObstacleInBody {
        /// Name of the obstacle.
        name: String,
        /// Where it is now in the undeformed body.
        position: Vector3,
    },
    /// Nothing prevents rigid motions of the body of a static problem.
    #[error(
        "the conditions, and contacts that are closed at the start, leave {} of the body free in a static \
         problem: {}",
        match .motions { 1 => "a rigid motion".to_string(), n => format!("{n} rigid motions") },
        if *.touches {
            "only contact that closes during the run can hold it, and without friction that may \
             not be enough to converge"
        } else {
            "the result is one of many that differ by such a motion"
        }
    )]
    FreeMotions {
        /// Number of rigid motions that nothing prevents.
        motions: usize,
        /// Whether there are obstacles.
        touches: bool,
    },
    /// Separate pieces of the body of a static problem that can move.
    #[error(
        "{} of {volume:.3e} m³ around ({:.4}, {:.4}, {:.4}) can move without resistance, since no condition holds \
         it enough: under loads on it a static problem has no solution; hold it, leave it out of \
         the body, or close the gap around it",
        match .pieces {
            1 => "a separate piece of the body".to_string(),
            n => format!("{n} separate pieces of the body, the largest"),
        },
        .centre.x, .centre.y, .centre.z
    )]
    FreePieces {
        /// How many.
        pieces: usize,
        /// Centre of the largest \[m\].
        centre: Vector3,
        /// Its volume \[m³\].
        volume: f64,
    },
    /// A linear law is strained by more than it is made for.
    #[error(
        "the linear law is strained by {strain:.3} at ({}), and holds for strains and rotations of a few \
         hundredths: its stress there is that of no material; use another law, such as neo_hookean_log_j, or \
         a smaller load",
        show(.position)
    )]
    LargeLinearStrain {
        /// Where it is strained most.
        position: Vector3,
        /// The largest principal value of ½(∇u + ∇uᵀ) there \[–\].
        strain: f64,
    },
    /// A compressible part has lost most of its volume.
    #[error(
        "J fell to {jacobian:.3} at ({}), in a part that may change its volume: hardly any tissue has been \
         measured at such a compression, and J near 0 shows that the part is too soft for what is around it",
        show(.position)
    )]
    LostVolume {
        /// Where it has lost most.
        position: Vector3,
        /// J = det F there \[–\].
        jacobian: f64,
    },
}

impl Discretisation {
    /// Doubts that a user should know of before trusting a result.
    pub fn warnings(&self) -> Vec<Warning> {
        let (points, nodes) = (self.supports.len(), self.deforming_nodes());
        let mut warnings = Vec::new();
        if points < nodes {
            warnings.push(Warning::FewerPointsThanNodes { points, nodes });
        }
        if let Some(BridgedGap { points: bridging, position, width, spacing, .. }) = self.bridged {
            let (points, of) = (bridging, points);
            warnings.push(Warning::BridgedGap { points, of, position, width, spacing });
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
            cloud: NodeCloud {
                positions: vec![],
                spacing: vec![],
                on_boundary: vec![],
                on_border: vec![],
            },
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
                linear_stress_iterations: None,
                residual,
                tolerance: 1e-3,
                defect: 1.0,
                bodies: 1,
            }),
            enlarged: 0,
            worst_condition: 1.0,
            bridged: None,
            held: None,
        };
        assert!(discretisation(9e-4).warnings().is_empty());
        let warnings = discretisation(2e-3).warnings();
        assert!(matches!(warnings[..], [Warning::InconsistentGradients { iterations: 500, .. }]));
        assert!(warnings[0].to_string().contains("consistent to 2.0e-3 only"), "{}", warnings[0]);
    }
}
