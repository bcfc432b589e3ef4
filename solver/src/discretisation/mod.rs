//! Nodes, quadrature points, supports, φ and Grad φ: all that does not depend
//! on materials or conditions.
#![allow(non_snake_case)]

pub mod consistency;
pub mod mls;
pub mod moments;
pub mod neighbours;
pub mod nodes;
pub mod patches;
pub mod quadrature;
pub mod rows;
pub mod surface_rule;
pub mod weight_function;

use crate::algebra::tensor::Vector3;
use crate::discretisation::consistency::{Correction, Layout, connected_bodies, make_consistent};
use crate::discretisation::mls::{Approximation, PoorSupport};
use crate::discretisation::nodes::{NodeCloud, node_cloud};
use crate::discretisation::patches::sort_into_patches;
use crate::discretisation::quadrature::{Quadrature, quadrature};
pub use crate::discretisation::rows::Rows;
use crate::discretisation::rows::{Evaluated, Wanted};
use crate::discretisation::surface_rule::SurfaceRule;
use crate::error::Error;
use crate::geometry::selection::Extent;
use crate::problem::{Dimension, EssentialCondition, Gradients, Problem};
use rayon::prelude::*;

/// The body, discretised.
#[derive(Debug, Clone)]
pub struct Discretisation {
    pub dimension: Dimension,
    pub cloud: NodeCloud,
    pub approximation: Approximation,
    pub quadrature: Quadrature,
    /// Supports of the quadrature points.
    pub supports: Rows,
    /// The boundary; without panels where nobody asks for it.
    pub surface: SurfaceRule,
    /// Quadrature points of patch p: `patches[p]..patches[p + 1]`; a patch
    /// lies in one region.
    pub patches: Vec<usize>,
    /// How the gradients were made consistent, if they were.
    pub correction: Option<Correction>,
    /// Quadrature points whose influence radii had to be enlarged.
    pub enlarged: usize,
    /// Largest condition number of a moment matrix (local scaled basis).
    pub worst_condition: f64,
}

/// Edge of the boundary panels over the smallest nodal spacing \[–\].
const PANEL: f64 = 0.5;

/// Something that a user should know before trusting the result.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    FewerPointsThanNodes { points: usize, nodes: usize },
    EnlargedSupports { points: usize, of: usize },
    InconsistentGradients { residual: f64, tolerance: f64, iterations: usize },
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
                "the gradients are consistent to {residual:.1e} only, not to the wanted {tolerance:.1e}, \
                 after {iterations} iterations; a larger tolerance, a larger dilation or a more even \
                 cloud avoids that"
            ),
        }
    }
}

impl Discretisation {
    /// Nodes and quadrature points of a problem with their supports. Points
    /// are sorted by region and patch, neighbours in space close in memory.
    pub fn new(problem: &Problem) -> Result<Discretisation, Error> {
        problem.body.validate_body()?;
        let dimension = problem.dimension;
        // In a plane only the cross-section counts: the ends are no boundary.
        let body = problem.body.section(&dimension)?;
        let recipe = &problem.recipe;
        let cloud = node_cloud(&problem.body, &recipe.cloud, &dimension)?;
        let mut quadrature = quadrature(&body, &problem.regions, &recipe.grid, &dimension)?;
        let influence_radius = cloud.spacing.iter().map(|h| recipe.dilation * h).collect();
        let approximation = Approximation::new(
            cloud.positions.clone(),
            influence_radius,
            recipe.basis,
            recipe.weight_function,
            &dimension,
        );
        let spacing: Vec<f64> = quadrature
            .positions
            .par_iter()
            .map(|X| approximation.mean_radius(X) / recipe.dilation)
            .collect();
        let patches = sort_into_patches(
            &mut quadrature,
            &spacing,
            dimension.thickness(),
            dimension.components(),
        );
        let Evaluated { rows: supports, enlarged, worst_condition } =
            evaluate_all(&approximation, &quadrature.positions)?;
        check_coverage(&cloud, &supports)?;
        let finest = cloud.spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let consistent = matches!(recipe.gradients, Gradients::Consistent { .. });
        let surface = match consistent || !problem.loads.tractions.is_empty() {
            true => {
                let panels = problem.body.boundary_panels(PANEL * finest, &dimension)?;
                let held = held_nodes(problem, &cloud);
                SurfaceRule::new(panels, &cloud, &approximation, &held, dimension.components())
                    .map_err(|(position, poor)| outside(position, &poor))?
            }
            false => SurfaceRule::default(),
        };
        let mut discretisation = Discretisation {
            dimension,
            cloud,
            approximation,
            quadrature,
            supports,
            surface,
            patches,
            correction: None,
            enlarged,
            worst_condition,
        };
        if let Gradients::Consistent { tolerance } = recipe.gradients {
            discretisation.make_consistent(tolerance)?;
        }
        Ok(discretisation)
    }

    /// Scales the quadrature weights of each connected body to the volume
    /// that its boundary encloses and makes Grad φ consistent.
    fn make_consistent(&mut self, tolerance: f64) -> Result<(), Error> {
        let (nodes, d) = (self.cloud.positions.len(), self.dimension.components());
        let bodies = connected_bodies(&self.supports, nodes);
        let mut areas = self.surface.strengths(nodes, |panel| panel.normal);
        for body in 0..bodies.iter().max().map_or(0, |&last| last + 1) {
            let owns = |node: u32| bodies[node as usize] == body;
            let volume = self.surface.close(&mut areas, d, owns);
            if volume > 0.0 {
                self.scale_weights(volume, owns);
            }
        }
        let targets = self.surface.spread(nodes, &areas);
        self.surface.keep(areas);
        let layout = Layout {
            nodes: &self.cloud.positions,
            spacing: &self.cloud.spacing,
            points: &self.quadrature.positions,
            weights: &self.quadrature.weights,
            components: d,
        };
        let correction = make_consistent(&mut self.supports, &layout, &targets, &bodies, tolerance);
        self.correction = Some(correction.better_than_none()?);
        Ok(())
    }

    fn scale_weights(&mut self, volume: f64, owns: impl Fn(u32) -> bool) {
        let supports = &self.supports;
        let own: Vec<usize> =
            (0..supports.len()).filter(|&q| owns(supports.nodes[supports.starts[q]])).collect();
        let weights = &mut self.quadrature.weights;
        let sum: f64 = own.iter().map(|&q| weights[q]).sum();
        own.iter().for_each(|&q| weights[q] *= volume / sum);
    }

    /// Rows of φ and Grad φ at any points of the body \[m\].
    pub fn rows_at(&self, positions: &[Vector3]) -> Result<Rows, Error> {
        Rows::at(&self.approximation, positions, Wanted::ValuesAndGradients)
            .map(|evaluated| evaluated.rows)
            .map_err(|(point, poor)| outside(positions[point], &poor))
    }

    /// Mean number of support nodes per quadrature point.
    pub fn mean_support(&self) -> f64 {
        self.supports.nodes.len() as f64 / self.supports.len() as f64
    }

    /// What a user should know before trusting a result.
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

/// Which nodes some condition selects.
fn held_nodes(problem: &Problem, cloud: &NodeCloud) -> Vec<bool> {
    let held = |node| problem.conditions.iter().any(|condition| holds(condition, cloud, node));
    (0..cloud.positions.len()).map(held).collect()
}

/// Whether a condition selects a node.
pub fn holds(condition: &EssentialCondition, cloud: &NodeCloud, node: usize) -> bool {
    (condition.extent == Extent::Volume || cloud.on_boundary[node])
        && condition.part.contains(&cloud.positions[node])
}

fn outside(position: Vector3, poor: &PoorSupport) -> Error {
    let (size, condition) = (poor.support_size, poor.condition);
    let reason = format!("{size} nodes in its support, condition {condition:.1e}");
    Error::ProbeOutside { position, reason }
}

fn evaluate_all(approximation: &Approximation, positions: &[Vector3]) -> Result<Evaluated, Error> {
    let locate = |(point, poor): (usize, PoorSupport)| match poor.support_size
        < approximation.smallest_support()
    {
        true => Error::SmallSupport {
            point,
            position: positions[point],
            support_size: poor.support_size,
            smallest: approximation.smallest_support(),
        },
        false => Error::SingularMomentMatrix {
            point,
            position: positions[point],
            support_size: poor.support_size,
            condition: poor.condition,
            largest: approximation.largest_condition(),
        },
    };
    Rows::at(approximation, positions, Wanted::ValuesAndGradients).map_err(locate)
}

/// Every node must be covered. The seed (section 2.3) also wants each boundary
/// node to share a support with an interior one; a body one spacing thick has
/// none of these and is sound where its moment matrices are.
fn check_coverage(cloud: &NodeCloud, supports: &Rows) -> Result<(), Error> {
    let mut covered = vec![false; cloud.positions.len()];
    supports.nodes.iter().for_each(|&node| covered[node as usize] = true);
    match covered.iter().position(|covered| !covered) {
        Some(node) => Err(Error::UncoveredNode { node, position: cloud.positions[node] }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_that_stops_above_its_tolerance_is_told() {
        let discretisation = |residual: f64| Discretisation {
            dimension: Dimension::Three,
            cloud: NodeCloud { positions: vec![], spacing: vec![], on_boundary: vec![] },
            approximation: Approximation::new(
                vec![Vector3::zeros()],
                vec![1.0],
                crate::problem::Basis::Linear,
                crate::problem::WeightFunction::QuarticSpline,
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
