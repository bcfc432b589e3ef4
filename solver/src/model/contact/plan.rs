//! Which nodes may touch the obstacles, and how they are kept out.
#![allow(non_snake_case)]

use super::between::{Outside, narrow};
use crate::algebra::tensor::{Vector3, vector_at};
use crate::discretisation::{Discretisation, Rows};
use crate::error::Error;
use crate::model::essential::Constraints;
use crate::problem::{Friction, Obstacle, Problem};

/// The obstacles of a problem and the nodes that may touch them: boundary nodes of
/// which some component is not prescribed for ever. Obstacles push them in such components
/// only, as on a plane of symmetry; where an obstacle faces along the others, a node may
/// therefore enter it ([`ContactPlan::penetrations`]).
#[derive(Debug, Clone, Default)]
pub struct ContactPlan {
    /// As stated in the problem; in a plane their sections.
    pub obstacles: Vec<Obstacle>,
    /// Boundary nodes with a component that is not prescribed for ever, ascending.
    pub nodes: Vec<u32>,
    /// φ at these nodes \[node that may touch\].
    pub(super) rows: Rows,
    /// Displacement components of a node.
    pub(super) components: usize,
    /// Boundary nodes with a component that is.
    pub held: Vec<u32>,
    /// Which components obstacles may push \[node\]\[component\].
    free: Vec<Components>,
    /// Mean nodal spacing \[m\]; candidates are searched again when the body may have moved so far.
    pub mean_spacing: f64,
    /// Widths of obstacles that nodes alone may miss \[obstacle\] \[m\].
    pub(super) narrow: Vec<Option<f64>>,
    /// The body whose surface they may enter between nodes; none where there are no such obstacles.
    pub(super) outside: Option<Outside>,
}

/// A choice of components.
pub(crate) type Components = [bool; 3];

/// What an obstacle exerts on a node.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ContactForce {
    /// Index of the obstacle.
    pub obstacle: u32,
    /// The node.
    pub node: u32,
    /// \[N\]
    pub force: Vector3,
}

impl ContactPlan {
    /// Selects the nodes; without obstacles the plan is empty.
    pub fn new(
        problem: &Problem,
        discretisation: &Discretisation,
        constraints: &Constraints,
    ) -> Result<ContactPlan, Error> {
        let cloud = &discretisation.cloud;
        if problem.obstacles.is_empty() {
            return Ok(ContactPlan::default());
        }
        let components = problem.dimension.components();
        let all = 0..cloud.positions.len() as u32;
        let free: Vec<Components> = (all.clone())
            .map(|node| {
                [0, 1, 2].map(|k| k < components && !constraints.always_prescribes(node, k))
            })
            .collect();
        let boundary = || all.clone().filter(|node| cloud.on_boundary[*node as usize]);
        let count = |node: u32| free[node as usize].iter().filter(|free| **free).count();
        let nodes: Vec<u32> = boundary().filter(|node| count(*node) > 0).collect();
        let places: Vec<Vector3> = nodes.iter().map(|n| cloud.positions[*n as usize]).collect();
        let rows = discretisation.rows_at(&places)?;
        let held = boundary().filter(|node| count(*node) < components).collect();
        let mean_spacing = cloud.mean_spacing();
        let section = |obstacle: &Obstacle| -> Result<Obstacle, Error> {
            let shape = obstacle.shape.section(&problem.dimension)?;
            Ok(Obstacle { shape, ..obstacle.clone() })
        };
        let obstacles: Vec<Obstacle> =
            problem.obstacles.iter().map(section).collect::<Result<_, _>>()?;
        let mut plan = ContactPlan {
            obstacles,
            nodes,
            rows,
            components,
            held,
            free,
            mean_spacing,
            narrow: Vec::new(),
            outside: None,
        };
        let around = problem.body.bounding_box();
        plan.narrow = (0..plan.obstacles.len() as u32)
            .map(|index| {
                let around =
                    around.map(|around| plan.seen_from(index, around, problem.motion.end()));
                narrow(&plan.obstacles[index as usize], around, mean_spacing)
            })
            .collect();
        plan.outside = plan.narrow.iter().any(Option::is_some).then(|| Outside::new(problem));
        Ok(plan)
    }

    /// Which components of a node obstacles may push.
    pub(crate) fn free(&self, node: u32) -> Components {
        self.free[node as usize]
    }
}

/// Gap over the mean nodal spacing below which a contact is closed \[–\].
const CLOSED: f64 = 1e-6;

impl ContactPlan {
    /// Reference positions \[m\] of nodes in contact at time `t` \[s\] and displacements `u`
    /// \[component of node\] \[m\], with the directions in which obstacles hold them.
    pub fn closed(&self, positions: &[Vector3], t: f64, u: &[f64]) -> Vec<(Vector3, Vector3)> {
        let components = u.len() / positions.len();
        let mut closed = Vec::new();
        for (_, placed) in self.all_placed(t) {
            for &node in &self.nodes {
                let X = positions[node as usize];
                let x = X + vector_at(u, node as usize, components);
                if placed.gap(&x) < CLOSED * self.mean_spacing {
                    match placed.obstacle.friction {
                        Friction::Frictionless => {
                            closed.push((X, placed.normal(&x, self.free(node))));
                        }
                        Friction::NoSlip | Friction::Coulomb(_) => {
                            let free = self.free(node);
                            let along = (0..3).filter(|k| free[*k]);
                            closed.extend(along.map(|k| (X, Vector3::ith(k, 1.0))));
                        }
                    }
                }
            }
        }
        closed
    }
}
