//! Everything that stays constant during a run, checked.

pub mod blocks;
pub mod collocation;
pub mod contact;
pub mod essential;
pub mod load;
pub mod mass;
pub mod projection;
pub mod stiffness;
pub mod time_step_bound;
pub mod zero_energy;

use crate::algebra::tensor::{Vector3, box_around};
use crate::discretisation::Discretisation;
use crate::discretisation::consistency::connected_bodies;
use crate::error::Error;
use crate::model::blocks::blocks;
pub use crate::model::blocks::{Block, Chunk, Sums};
use crate::model::contact::ContactPlan;
use crate::model::essential::Constraints;
use crate::model::load::{LoadPattern, load_patterns};
use crate::model::mass::{lumped_mass, mass_like};
use crate::model::stiffness::stiffness_diagonal;
use crate::model::time_step_bound::per_point_bound;
use crate::problem::{Dimension, Motion, Problem, Relaxation, RelaxationMass};

/// A discretised body with its materials, conditions and loads.
#[derive(Debug, Clone)]
pub struct Model {
    /// Displacement components per node: 3, or 2 in a plane.
    pub components: usize,
    /// Reference positions \[node\] \[m\].
    pub positions: Vec<Vector3>,
    /// \[node\] \[kg\]
    pub lumped_mass: Vec<f64>,
    /// The mass that moves \[node\] \[kg\]: the lumped one, or in a static
    /// problem a fictitious one of the same total (see [`RelaxationMass`]).
    pub inertia: Vec<f64>,
    /// What `raise_masses` has added to it \[kg\].
    pub added_mass: f64,
    /// Diagonal of K at rest, the mean over the components of a node
    /// \[node\] \[N/m\].
    pub stiffness: Vec<f64>,
    pub blocks: Vec<Block>,
    pub sums: Sums,
    pub loads: Vec<LoadPattern>,
    pub constraints: Constraints,
    pub contact: ContactPlan,
    /// Velocity at t = 0 \[component of node\] \[m/s\].
    pub initial_velocity: Vec<f64>,
    /// Per-point bound of the critical time step at rest, of the lumped masses \[s\].
    pub bound: f64,
    /// Diagonal of the box around all nodes \[m\].
    pub extent: f64,
    /// Reference positions of the quadrature points \[point\] \[m\].
    pub point_positions: Vec<Vector3>,
}

impl Model {
    /// Binds materials, conditions and loads to a discretisation.
    pub fn new(problem: &Problem, discretisation: &Discretisation) -> Result<Model, Error> {
        let quadrature = &discretisation.quadrature;
        let density: Vec<f64> = quadrature
            .regions
            .iter()
            .map(|&region| problem.regions[region as usize].material.density)
            .collect();
        let lumped_mass = lumped_mass(discretisation, &density, problem.recipe.mass)?;
        let components = problem.dimension.components();
        let blocks = blocks(problem, discretisation);
        let stiffness = stiffness_diagonal(&blocks, components, lumped_mass.len());
        let inertia = match problem.motion {
            Motion::Dynamic { .. }
            | Motion::Static(Relaxation { mass: RelaxationMass::Lumped, .. }) => {
                lumped_mass.clone()
            }
            Motion::Static(_) | Motion::Equilibrium(_) => mass_like(&stiffness, &lumped_mass),
        };
        let constraints = Constraints::new(problem, discretisation, &inertia)?;
        check_rank(discretisation, &constraints)?;
        let bound = per_point_bound(problem, discretisation, &lumped_mass);
        Ok(Model {
            components,
            positions: discretisation.cloud.positions.clone(),
            sums: Sums::new(&blocks, lumped_mass.len()),
            blocks,
            stiffness,
            inertia,
            added_mass: 0.0,
            loads: load_patterns(problem, discretisation, &density)?,
            contact: ContactPlan::new(problem, discretisation, &constraints)?,
            initial_velocity: initial_velocity(problem, discretisation),
            point_positions: quadrature.positions.clone(),
            extent: extent(&discretisation.cloud.positions),
            lumped_mass,
            constraints,
            bound,
        })
    }

    /// Number of displacement components of all nodes.
    pub fn size(&self) -> usize {
        self.components * self.positions.len()
    }

    /// Bytes that one evaluation of the internal force streams.
    pub fn bytes_per_step(&self) -> usize {
        self.blocks.iter().map(Block::bytes).sum()
    }
}

/// At rest a point sees its strains and nothing else, six or three in a plane:
/// motions beyond that number, the held components and the rigid motions of
/// each body have no energy whatever the supports.
fn check_rank(discretisation: &Discretisation, constraints: &Constraints) -> Result<(), Error> {
    let (points, nodes) = (discretisation.supports.len(), discretisation.cloud.positions.len());
    let (d, strains, rigid) = match discretisation.dimension {
        Dimension::Three => (3, 6, 6),
        Dimension::PlaneStrain { .. } => (2, 3, 3),
    };
    let held: usize = constraints.active(0.0).iter().map(|set| set.rows.len()).sum();
    let bodies = connected_bodies(&discretisation.supports, nodes);
    let bodies = bodies.iter().max().map_or(0, |&last| last as usize + 1);
    let modes = (d * nodes).saturating_sub(held + strains * points + rigid * bodies);
    match modes {
        0 => Ok(()),
        modes => Err(Error::TooFewPoints { points, strains, nodes, held, modes }),
    }
}

fn extent(positions: &[Vector3]) -> f64 {
    let (min, max) = box_around(positions);
    (max - min).norm()
}

fn initial_velocity(problem: &Problem, discretisation: &Discretisation) -> Vec<f64> {
    let components = problem.dimension.components();
    let mut velocity = vec![0.0; components * discretisation.cloud.positions.len()];
    for (node, position) in discretisation.cloud.positions.iter().enumerate() {
        let parts = &problem.loads.initial_velocities;
        if let Some((_, v)) = parts.iter().find(|(part, _)| part.contains(position)) {
            for k in 0..components {
                velocity[components * node + k] = v[k];
            }
        }
    }
    velocity
}
