//! The model of a body: its parts and how they are made.

use crate::algebra::tensor::{Matrix3, Vector3, bounding_box, vector_at};
use crate::discretisation::{Discretisation, Rows, Warning};
use crate::error::Error;
use crate::force::{Block, PackedPoints, stiffness_diagonal};
use crate::model::contact::{ContactPlan, check_obstacles};
use crate::model::essential::{Constraints, check_shared_nodes};
use crate::model::following::FollowingLoads;
use crate::model::load::{
    LoadPattern, check_loads, follow_masses, initial_velocity, load_patterns,
};
use crate::model::mass::{fictitious_mass, fit_moments, lumped_mass};
use crate::model::time_step_bound::per_point_bound;
use crate::problem::{Amplitude, Dimension, MassRule, Motion, Problem, Region, RelaxationMass};

/// A discretised body with its materials, conditions and loads.
#[derive(Debug, Clone)]
pub struct Model {
    /// Displacement components per node: 3, or 2 in a plane.
    pub components: usize,
    /// Reference positions \[node\] \[m\].
    pub positions: Vec<Vector3>,
    /// Lumped mass \[node\] \[kg\].
    pub lumped_mass: Vec<f64>,
    /// Mass in the equation of motion \[node\] \[kg\]: the lumped one, or in a
    /// static problem a fictitious one of the same total (see [`RelaxationMass`]).
    pub inertia: Vec<f64>,
    /// Total that mass scaling has added to it \[kg\].
    pub added_mass: f64,
    /// Diagonal of K at rest, the mean over the components of a node
    /// \[node\] \[N/m\].
    pub stiffness: Vec<f64>,
    /// The quadrature points, packed for the internal force.
    pub points: PackedPoints,
    /// The external forces.
    pub loads: Vec<LoadPattern>,
    /// External forces that depend on displacements.
    pub following: FollowingLoads,
    /// The essential conditions.
    pub constraints: Constraints,
    /// The obstacles, and the nodes that may touch them.
    pub contact: ContactPlan,
    /// Velocity at t = 0 \[component of node\] \[m/s\].
    pub initial_velocity: Vec<f64>,
    /// Per-point bound of the critical time step at rest, for the lumped masses \[s\].
    pub per_point_bound: f64,
    /// The connected body of each node.
    pub bodies: Vec<u32>,
    /// Diagonal of the box around all nodes \[m\].
    pub extent: f64,
    /// Mean nodal spacing \[m\].
    pub mean_spacing: f64,
    /// Reference positions of the quadrature points \[point\] \[m\].
    pub point_positions: Vec<Vector3>,
    /// φ at the nodes, row by row, only for Newton's method.
    pub nodal_rows: Option<Rows>,
    /// What to doubt about the problem itself.
    pub warnings: Vec<Warning>,
}

impl Model {
    /// Binds materials, conditions and loads to a discretisation.
    pub fn new(problem: &Problem, discretisation: &Discretisation) -> Result<Model, Error> {
        // In the pool, as the discretisation is made.
        rayon::scope(|_| Model::of(problem, discretisation))
    }

    fn of(problem: &Problem, discretisation: &Discretisation) -> Result<Model, Error> {
        let quadrature = &discretisation.quadrature;
        let relaxation = problem.motion.relaxation();
        let lumped = matches!(problem.motion, Motion::Dynamic { .. })
            || relaxation.is_some_and(|settings| settings.mass == RelaxationMass::Lumped);
        let bodies = discretisation.connected_bodies();
        let mut warnings = empty_regions(problem, discretisation);
        let (lumped_mass, loads) =
            masses_and_loads(problem, discretisation, &bodies, lumped, &mut warnings)?;
        let components = problem.dimension.components();
        let points = PackedPoints::new(problem, discretisation)?;
        let following = FollowingLoads::new(problem, discretisation)?;
        let mut stiffness = stiffness_diagonal(&points, lumped_mass.len(), f64::INFINITY);
        following.add_to_diagonal(components, &mut stiffness);
        let inertia =
            if lumped { lumped_mass.clone() } else { fictitious_mass(&stiffness, &lumped_mass) };
        warnings.extend(check_shared_nodes(problem, discretisation)?);
        let constraints = Constraints::new(problem, discretisation, &inertia)?;
        warnings.extend(check_loads(problem, discretisation, &constraints));
        let contact = ContactPlan::new(problem, discretisation, &constraints)?;
        let (cloud, end) = (&discretisation.cloud, problem.motion.end());
        warnings.extend(check_obstacles(&contact, cloud, &constraints, components, end)?);
        contact.refuse_swallowed(&cloud.positions, &problem.body)?;
        check_rank(discretisation, &constraints, &bodies)?;
        let per_point_bound = per_point_bound(problem, discretisation, &lumped_mass);
        let (lower, upper) = bounding_box(&discretisation.cloud.positions);
        Ok(Model {
            components,
            bodies,
            positions: discretisation.cloud.positions.clone(),
            points,
            stiffness,
            inertia,
            added_mass: 0.0,
            loads,
            following,
            contact,
            initial_velocity: initial_velocity(problem, discretisation)?,
            point_positions: quadrature.positions.clone(),
            extent: (upper - lower).norm(),
            mean_spacing: cloud.mean_spacing(),
            lumped_mass,
            nodal_rows: if problem.by_newton() {
                Some(discretisation.rows_at(&discretisation.cloud.positions)?)
            } else {
                None
            },
            constraints,
            per_point_bound,
            warnings,
        })
    }

    /// Moves the places of nodes and of pressed surfaces by offsets \[component of node\] \[m\], whose
    /// gradients and weights the discretisation has.
    pub(crate) fn move_by(&mut self, offsets: &[f64]) {
        let d = self.components;
        for (node, position) in self.positions.iter_mut().enumerate() {
            *position += vector_at(offsets, node, d);
        }
        self.following.move_by(offsets, d);
    }

    /// Number of displacement components of all nodes.
    pub fn size(&self) -> usize {
        self.components * self.positions.len()
    }

    /// M⁻¹ f of forces \[component of node\] \[N\], with the inertia \[m/s²\].
    pub fn accelerations(&self, force: &[f64]) -> Vec<f64> {
        force.iter().enumerate().map(|(i, f)| f / self.inertia[i / self.components]).collect()
    }

    /// Fibre frames \[point\]; none where the law of a point has no fibres.
    pub fn fibre_frames(&self) -> Vec<Option<Matrix3>> {
        let mut frames = vec![None; self.point_positions.len()];
        for block in &self.points.blocks {
            block.occupied().for_each(|lane| frames[block.point(lane)] = block.frame(lane));
        }
        frames
    }

    /// Times \[s\] at which the slope of an amplitude jumps, or a condition ends, in any order.
    pub fn corners(&self) -> Vec<f64> {
        let conditions = &self.constraints.conditions;
        let loads = self.loads.iter().map(|load| &load.amplitude);
        let held = conditions.iter().map(|condition| &condition.amplitude);
        let active =
            self.points.blocks.iter().filter_map(|block| Some(&block.active.as_ref()?.amplitude));
        let all = loads
            .chain(self.following.amplitudes())
            .chain(held)
            .chain(active)
            .flat_map(Amplitude::corners);
        all.chain(conditions.iter().filter_map(|condition| condition.release)).collect()
    }

    /// Whether there are stresses beside those of the laws.
    pub fn has_extra_stress(&self) -> bool {
        self.points.blocks.iter().any(Block::has_extra_stress)
    }

    /// Whether a stress depends on what was before.
    pub fn has_memory(&self) -> bool {
        self.points.blocks.iter().any(|block| block.viscosity.is_some())
    }

    /// Bytes that one evaluation of the internal force reads from the blocks.
    pub fn bytes_per_step(&self) -> usize {
        self.points.blocks.iter().map(Block::bytes).sum()
    }
}

/// Masses at the nodes \[kg\] and the loads that act on them; what to doubt about both is added to
/// the warnings. Where masses do not move, only their sum counts.
fn masses_and_loads(
    problem: &Problem,
    discretisation: &Discretisation,
    bodies: &[u32],
    they_move: bool,
    warnings: &mut Vec<Warning>,
) -> Result<(Vec<f64>, Vec<LoadPattern>), Error> {
    let density: Vec<f64> = problem.regions.iter().map(|region| region.material.density).collect();
    let of_rule = |rule| lumped_mass(discretisation, &density, rule);
    let mut mass = match of_rule(problem.recipe.mass) {
        Err(Error::MasslessNode { .. }) if !they_move => of_rule(MassRule::EvenSplit)?,
        mass => mass?,
    };
    let mut loads = load_patterns(problem, discretisation, &density)?;
    if they_move && problem.recipe.mass.has_moments() {
        let (added, warning) = fit_moments(problem, discretisation, &density, bodies, &mut mass);
        if let Motion::Dynamic { .. } = problem.motion {
            follow_masses(&mut loads, problem, (&added, &mass, bodies));
            warnings.extend(warning);
        }
    }
    Ok((mass, loads))
}

/// Regions without a point, which have no effect. A last region of everything may be empty:
/// it is there for what the others leave.
fn empty_regions(problem: &Problem, discretisation: &Discretisation) -> Vec<Warning> {
    let is_owner = |region: u16| {
        discretisation.volumes().any(|(quadrature, _)| quadrature.regions.contains(&region))
    };
    let empty = |(index, region): (usize, &Region)| {
        let rest = index + 1 == problem.regions.len() && region.part.is_everything();
        let unused = !rest && !is_owner(index as u16);
        unused.then(|| Warning::EmptyRegion { name: region.name.clone() })
    };
    problem.regions.iter().enumerate().filter_map(empty).collect()
}

/// Refuses a model with too few points. At rest a point has six strains, three in a
/// plane; motions beyond all strains, the constrained components and the rigid motions
/// of each body have no energy, whatever the supports (method book, eq. 22.2).
fn check_rank(
    discretisation: &Discretisation,
    constraints: &Constraints,
    bodies: &[u32],
) -> Result<(), Error> {
    let (points, nodes) = (discretisation.supports.len(), discretisation.cloud.positions.len());
    let (d, strains, rigid) = match discretisation.dimension {
        Dimension::Three => (3, 6, 6),
        Dimension::PlaneStrain { .. } => (2, 3, 3),
    };
    let constrained: usize = constraints.count(0.0);
    let bodies = bodies.iter().max().map_or(0, |&last| last as usize + 1);
    let modes = (d * nodes).saturating_sub(constrained + strains * points + rigid * bodies);
    match modes {
        0 => Ok(()),
        modes => Err(Error::TooFewPoints { points, strains, nodes, constrained, modes }),
    }
}
