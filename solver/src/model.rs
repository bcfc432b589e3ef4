//! Everything that stays constant during a run, checked.

use crate::consistency::connected_bodies;
use crate::contact::ContactPlan;
use crate::discretisation::Discretisation;
use crate::error::Error;
use crate::essential::Constraints;
use crate::load::{LoadPattern, load_patterns};
use crate::mass::lumped_mass;
use crate::material::Law;
use crate::patches::orthonormal_basis;
use crate::problem::{Dilatation, Dimension, Problem};
use crate::projection::Projection;
use crate::tensor::{Vector3, box_around};
use crate::time_step_bound::per_point_bound;
use std::ops::Range;

/// A discretised body with its materials, conditions and loads.
#[derive(Debug, Clone)]
pub struct Model {
    /// Displacement components per node: 3, or 2 in a plane.
    pub components: usize,
    /// Reference positions \[node\] \[m\].
    pub positions: Vec<Vector3>,
    /// \[node\] \[kg\]
    pub lumped_mass: Vec<f64>,
    pub blocks: Vec<Block>,
    pub loads: Vec<LoadPattern>,
    pub constraints: Constraints,
    pub contact: ContactPlan,
    /// Velocity at t = 0 \[component of node\] \[m/s\].
    pub initial_velocity: Vec<f64>,
    /// Per-point bound of the critical time step at rest \[s\].
    pub bound: f64,
    /// Diagonal of the box around all nodes \[m\].
    pub extent: f64,
    /// Reference positions of the quadrature points \[point\] \[m\].
    pub point_positions: Vec<Vector3>,
}

/// Consecutive quadrature points of one material, with their own numbering of
/// the nodes they touch. Blocks depend on the problem alone, never on the
/// number of threads.
#[derive(Debug, Clone)]
pub struct Block {
    pub law: Law,
    pub points: Range<usize>,
    /// Global node of each local one.
    pub nodes: Vec<u32>,
    /// Support of local point p is `starts[p]..starts[p + 1]`.
    pub starts: Vec<u32>,
    /// Local node indices \[support entry\].
    pub supports: Vec<u32>,
    /// Grad φ, `components` per entry \[1/m\].
    pub grad_phi: Vec<f64>,
    /// \[point\] \[m³\]
    pub quadrature_weights: Vec<f64>,
    /// Only where the material is nearly incompressible.
    pub projection: Option<Projection>,
}

impl Block {
    /// Local nodes and gradients of a local point, D components each.
    #[inline(always)]
    pub fn support<const D: usize>(&self, point: usize) -> (&[u32], &[[f64; D]]) {
        let entries = self.starts[point] as usize..self.starts[point + 1] as usize;
        (&self.supports[entries.clone()], &self.grad_phi.as_chunks::<D>().0[entries])
    }

    /// Points of the largest patch; 0 without a projection.
    pub fn largest_patch(&self) -> usize {
        let patches = self.projection.iter().flat_map(|p| p.starts.windows(2));
        patches.map(|ends| (ends[1] - ends[0]) as usize).max().unwrap_or(0)
    }
}

/// A block holds at least and at most this many points.
const BLOCK_POINTS: (usize, usize) = (1024, 8192);

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
        let constraints = Constraints::new(problem, discretisation, &lumped_mass)?;
        check_rank(discretisation, &constraints)?;
        let bound = per_point_bound(problem, discretisation, &lumped_mass);
        Ok(Model {
            components: problem.dimension.components(),
            positions: discretisation.cloud.positions.clone(),
            blocks: blocks(problem, discretisation),
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
        self.blocks.iter().map(|b| 8 * b.grad_phi.len() + 4 * b.supports.len()).sum()
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

/// Blocks end where a patch does.
fn blocks(problem: &Problem, discretisation: &Discretisation) -> Vec<Block> {
    let regions = &discretisation.quadrature.regions;
    let most = (regions.len() / 16).clamp(BLOCK_POINTS.0, BLOCK_POINTS.1);
    let patches = &discretisation.patches;
    let mut blocks = Vec::new();
    let mut first = 0;
    while first + 1 < patches.len() {
        let start = patches[first];
        let last = (first + 1..patches.len())
            .take_while(|&p| regions[patches[p] - 1] == regions[start])
            .take_while(|&p| p == first + 1 || patches[p] - start <= most)
            .last()
            .unwrap_or(first + 1);
        blocks.push(block(problem, first..last, discretisation));
        first = last;
    }
    blocks
}

fn block(problem: &Problem, patches: Range<usize>, discretisation: &Discretisation) -> Block {
    let rows = &discretisation.supports;
    let starts = &discretisation.patches[patches.start..=patches.end];
    let points = starts[0]..starts[starts.len() - 1];
    let components = discretisation.dimension.components();
    let entries = rows.starts[points.start]..rows.starts[points.end];
    let mut nodes: Vec<u32> = rows.nodes[entries.clone()].to_vec();
    nodes.sort_unstable();
    nodes.dedup();
    let local = |node: &u32| nodes.binary_search(node).unwrap_or_default() as u32;
    let offset = entries.start;
    let region = discretisation.quadrature.regions[points.start] as usize;
    let law = problem.regions[region].material.law;
    let share = match problem.recipe.dilatation {
        Dilatation::Projected => law.projected_share(),
        Dilatation::Pointwise => 0.0,
    };
    Block {
        law,
        starts: rows.starts[points.start..=points.end]
            .iter()
            .map(|s| (s - offset) as u32)
            .collect(),
        supports: rows.nodes[entries.clone()].iter().map(local).collect(),
        grad_phi: rows.grad_phi[entries]
            .iter()
            .flat_map(|gradient| gradient.iter().take(components).copied())
            .collect(),
        quadrature_weights: discretisation.quadrature.weights[points.clone()].to_vec(),
        projection: (share > 0.0).then(|| projection(share, starts, discretisation)),
        nodes,
        points,
    }
}

fn projection(share: f64, starts: &[usize], discretisation: &Discretisation) -> Projection {
    let quadrature = &discretisation.quadrature;
    let components = discretisation.dimension.components();
    let basis = |patch: &[usize]| {
        let points = patch[0]..patch[1];
        orthonormal_basis(&quadrature.positions, &quadrature.weights, points, components)
    };
    Projection {
        share,
        starts: starts.iter().map(|start| (start - starts[0]) as u32).collect(),
        basis: starts.windows(2).flat_map(basis).collect(),
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
