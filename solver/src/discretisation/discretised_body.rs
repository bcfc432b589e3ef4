//! The discretisation of a body: its parts and how they are made.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::bridged_gap::BridgedGap;
use crate::discretisation::consistency::{
    Correction, Layout, Targets, connected_bodies, make_consistent,
};
use crate::discretisation::held_volume::{HeldShape, HeldVolume, selects};
use crate::discretisation::mls::{Approximation, PoorSupport, Stiffness};
use crate::discretisation::neighbours::Neighbours;
use crate::discretisation::nodes::NodeCloud;
use crate::discretisation::patch_pieces::part_at_gaps;
use crate::discretisation::patches::sort_into_patches;
use crate::discretisation::placed_nodes::{Placed, flatten, needs_surface};
use crate::discretisation::quadrature::{Moves, NodalSpacing, Quadrature, quadrature_following};
use crate::discretisation::rows::{Evaluated, Requested, Rows};
use crate::discretisation::surface_rule::{SurfaceRule, is_held};
use crate::error::{Error, condition_text};
use crate::geometry::{CoveredPanel, Panel, Shape};
use crate::problem::{BackgroundGrid, Dimension, Problem, Recipe, Region, refuse};
use rayon::prelude::*;

/// The body, discretised.
#[derive(Debug, Clone)]
pub struct Discretisation {
    /// Space, or plane strain.
    pub dimension: Dimension,
    /// The nodes.
    pub cloud: NodeCloud,
    /// The shape functions.
    pub approximation: Approximation,
    /// Points and weights of volume integrals.
    pub quadrature: Quadrature,
    /// Supports of the quadrature points.
    pub supports: Rows,
    /// The boundary; without panels where neither gradients nor loads need it.
    pub surface: SurfaceRule,
    /// Quadrature points of patch p: `patches[p]..patches[p + 1]`; a patch
    /// lies in one region.
    pub patches: Vec<usize>,
    /// Result of the correction of the gradients; `None` for plain ones.
    pub correction: Option<Correction>,
    /// Quadrature points whose influence radii had to be enlarged.
    pub enlarged: usize,
    /// Largest condition number of a moment matrix (local scaled basis).
    pub worst_condition: f64,
    /// Where nodes on both sides of a gap act as one; `None` where none do.
    pub bridged: Option<BridgedGap>,
    /// What is held as a volume; `None` where nothing is.
    pub held: Option<HeldVolume>,
}

impl Discretisation {
    /// Nodes and quadrature points of a problem with their supports. Points
    /// are sorted by region and patch, neighbours in space close in memory.
    pub fn new(problem: &Problem) -> Result<Discretisation, Error> {
        // In the pool: a thread outside it would have to wake those inside for every sum.
        rayon::scope(|_| Discretisation::of(problem))
    }

    fn of(problem: &Problem) -> Result<Discretisation, Error> {
        refuse(problem.check())?;
        problem.body.validate_body()?;
        let dimension = problem.dimension;
        // In a plane the body is its cross-section, whose ends are no boundary.
        let whole = problem.body.section(&dimension)?;
        let held = HeldShape::of(problem, &whole);
        let body = held.as_ref().map_or(&whole, |held| &held.rest);
        let recipe = &problem.recipe;
        let Placed { mut cloud, panels, stiffness } = Placed::new(problem, body, held.is_some())?;
        let deforming = cloud.positions.len();
        let on_boundary =
            held.as_ref().map(|held| held.add_nodes(problem, &whole, &mut cloud)).transpose()?;
        let prescribed = prescribed_nodes(problem, &cloud);
        let mut approximation = approximation_of(&cloud, recipe, (stiffness, body), &dimension);
        if let Some(HeldShape { held, .. }) = &held {
            approximation = approximation.with_held(held, recipe.dilation);
        }
        let approximation = approximation.within(body, recipe.dilation);
        let spacing_at = |X: &Vector3| approximation.mean_radius(X) / recipe.dilation;
        let mut quadrature = points_of(problem, body, &cloud, &prescribed, &approximation)?;
        let spacing: Vec<f64> = quadrature.positions.par_iter().map(spacing_at).collect();
        let (thickness, components) = (dimension.thickness(), dimension.components());
        let patches = sort_into_patches(&mut quadrature, &spacing, thickness, components);
        let beside_gap = |X: &Vector3| approximation.is_beside_gap(X);
        let patches = part_at_gaps(&mut quadrature, &patches, body, &spacing_at, &beside_gap);
        let Evaluated { rows: supports, enlarged, worst_condition, bridging } =
            evaluate_all(&approximation, &quadrature.positions)?;
        let bridged = BridgedGap::widest(&approximation, &quadrature, &supports, &bridging);
        check_coverage(&cloud.positions[..deforming], &supports)?;
        let surface = surface_of(problem, panels, &cloud, &approximation, &prescribed)?;
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
            bridged,
            held: None,
        };
        if let Some(tolerance) = recipe.gradients.tolerance() {
            let second_order = recipe.gradients.is_second_order();
            discretisation.make_consistent(deforming, tolerance, second_order)?;
        }
        if let Some((held, on_boundary)) = held.zip(on_boundary) {
            discretisation.cloud.on_boundary = on_boundary;
            discretisation.hold(problem, held, deforming)?;
        }
        Ok(discretisation)
    }

    /// With weights and gradients of the shape that lies `offsets` \[component of node\] \[m\] from this
    /// one: w det G and G⁻ᵀ Grad φ, G = 1 + Grad of the offsets. Places stay those of this shape, by
    /// which selections find them, and so do φ, the boundary and the patches.
    ///
    /// # Errors
    /// [`Error::FoldedBody`] where the offsets turn a point inside out.
    pub fn moved(&self, offsets: &[f64]) -> Result<Discretisation, Error> {
        let mut moved = self.clone();
        let d = self.dimension.components();
        for (point, weight) in moved.quadrature.weights.iter_mut().enumerate() {
            let G = self.supports.deformation_gradient(point, offsets, d);
            let determinant = G.determinant();
            let folded =
                || Error::FoldedBody { position: self.quadrature.positions[point], determinant };
            if determinant.is_nan() || determinant <= 0.0 {
                return Err(folded());
            }
            *weight *= determinant;
            moved.supports.push_forward(point, &G);
        }
        Ok(moved)
    }

    /// Scales the quadrature weights of each connected body to the volume that its
    /// boundary encloses (method book, eq. 9.7) and makes Grad φ consistent. Of all nodes, the
    /// first `nodes` are in supports.
    fn make_consistent(
        &mut self,
        nodes: usize,
        tolerance: f64,
        second_order: bool,
    ) -> Result<(), Error> {
        let d = self.dimension.components();
        let bodies = connected_bodies(&[&self.supports], nodes);
        let (areas, volumes) = close(&self.surface, &bodies, d);
        for (body, volume) in volumes.into_iter().enumerate().filter(|(_, volume)| *volume > 0.0) {
            self.scale_weights(volume, |node| bodies[node as usize] as usize == body);
        }
        let total = self.surface.scatter(nodes, &areas);
        let targets = Targets {
            moments: second_order.then(|| self.boundary_moments(&areas, &total)),
            areas: total,
        };
        self.surface.store_areas(areas);
        let layout = Layout {
            nodes: &self.cloud.positions[..nodes],
            spacing: &self.cloud.spacing[..nodes],
            points: &self.quadrature.positions,
            weights: &self.quadrature.weights,
            components: d,
        };
        let correction = make_consistent(&mut self.supports, &layout, &targets, &bodies, tolerance);
        self.correction = Some(correction.checked()?);
        Ok(())
    }

    /// ∮ (x − X_a) ⊗ φ_a N dA/h_a of each node \[m²\] from the vector areas of the points of
    /// the boundary and their `total` ∮ φ_a N dA at each node.
    fn boundary_moments(&self, areas: &[Vector3], total: &[Vector3]) -> Vec<Matrix3> {
        let NodeCloud { spacing, .. } = &self.cloud;
        let positions = &self.cloud.positions[..total.len()];
        let mut moments = vec![Matrix3::zeros(); positions.len()];
        for k in 0..self.dimension.components() {
            let weighted: Vec<Vector3> =
                areas.iter().zip(self.surface.positions()).map(|(a, X)| a * X[k]).collect();
            let first = self.surface.scatter(positions.len(), &weighted);
            for (node, moment) in moments.iter_mut().enumerate() {
                let row = (first[node] - positions[node][k] * total[node]) / spacing[node];
                moment.set_row(k, &row.transpose());
            }
        }
        moments
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
        Rows::at(&self.approximation, positions, Requested::ValuesAndGradients)
            .map(|evaluated| evaluated.rows)
            .map_err(|(point, poor)| outside(positions[point], &poor))
    }

    /// The surface rule of covered panels, a part of the boundary.
    pub(crate) fn surface_of_part(
        &self,
        problem: &Problem,
        covered: &[CoveredPanel],
    ) -> Result<SurfaceRule, Error> {
        let panels = covered.iter().map(|covered| covered.panel).collect();
        self.surface_rule(problem, (panels, self.surface.panel_size))
    }

    pub(super) fn surface_rule(
        &self,
        problem: &Problem,
        panels: (Vec<Panel>, f64),
    ) -> Result<SurfaceRule, Error> {
        let prescribed = prescribed_nodes(problem, &self.cloud);
        surface_of(problem, Some(panels), &self.cloud, &self.approximation, &prescribed)
    }

    /// Mean number of support nodes per quadrature point.
    pub fn mean_support(&self) -> f64 {
        self.supports.nodes.len() as f64 / self.supports.len() as f64
    }
}

/// Vector areas of the points of a boundary, closed \[m²\], with the volume \[m³\] that the
/// boundary of each connected body encloses.
pub(super) fn close(
    surface: &SurfaceRule,
    bodies: &[u32],
    components: usize,
) -> (Vec<Vector3>, Vec<f64>) {
    let mut areas = surface.strengths(bodies.len(), |_, panel| panel.mean_normal());
    let count = bodies.iter().max().map_or(0, |&last| last + 1);
    let mut close = |body: u32| {
        surface.close(&mut areas, components, |node: u32| bodies[node as usize] == body)
    };
    let volumes = (0..count).map(&mut close).collect();
    (areas, volumes)
}

/// Shape functions with influence radii of dilation × spacing (method book, eq. 5.3).
fn approximation_of(
    cloud: &NodeCloud,
    recipe: &Recipe,
    (stiffness, body): (Option<Stiffness>, &Shape),
    dimension: &Dimension,
) -> Approximation {
    let radius = cloud.spacing.iter().map(|h| recipe.dilation * h).collect();
    let (basis, weight_function) = (recipe.basis, recipe.weight_function);
    let nodes = cloud.positions.clone();
    let approximation = Approximation::new(nodes, radius, basis, weight_function, dimension);
    match stiffness {
        Some(stiffness) => approximation.with_sides(stiffness, body, recipe.dilation),
        None => approximation,
    }
}

/// The held nodes of the boundary. Quadrature points in their supports are not moved:
/// stresses are singular at the edges of what is held, and what holds for smooth ones makes
/// bonded blocks 2 % stiffer.
fn held_nodes(prescribed: &[[bool; 3]], cloud: &NodeCloud) -> Option<Neighbours> {
    let own = |&node: &usize| cloud.on_boundary[node] && is_held(&prescribed[node]);
    let nodes = (0..cloud.positions.len()).filter(own);
    let positions: Vec<Vector3> = nodes.map(|node| cloud.positions[node]).collect();
    (!positions.is_empty()).then(|| Neighbours::new(&positions, 2.0 * cloud.smallest_spacing()))
}

/// Whether a node is closer to a place than a reach \[m\].
fn is_within(nodes: &Option<Neighbours>, X: &Vector3, reach: f64) -> bool {
    let mut found = false;
    if let Some(nodes) = nodes {
        nodes.for_each_within(X, reach, |_, _| found = true);
    }
    found
}

/// Quadrature points of what deforms, moved where gradients are of second order.
fn points_of(
    problem: &Problem,
    body: &Shape,
    cloud: &NodeCloud,
    prescribed: &[[bool; 3]],
    approximation: &Approximation,
) -> Result<Quadrature, Error> {
    let held = held_nodes(prescribed, cloud);
    let stays = |X: &Vector3| is_within(&held, X, approximation.mean_radius(X));
    let moves = Moves { stays: &stays };
    let moves = problem.recipe.gradients.is_second_order().then_some(&moves);
    let (regions, grid) = (&problem.regions, &problem.recipe.grid);
    let mut quadrature = quadrature_of(problem, regions, (body, grid), approximation, moves)?;
    flatten(&mut quadrature.positions, &problem.dimension);
    Ok(quadrature)
}

/// Quadrature points of the body, a section in a plane, divided into regions, on a grid that
/// may follow the nodes.
pub(crate) fn quadrature_of(
    problem: &Problem,
    regions: &[Region],
    (body, grid): (&Shape, &BackgroundGrid),
    approximation: &Approximation,
    moves: Option<&Moves>,
) -> Result<Quadrature, Error> {
    let dilation = problem.recipe.dilation;
    let within =
        |X: &Vector3, reach: f64| approximation.smallest_radius_within(X, reach) / dilation;
    let largest = approximation.largest_radius() / dilation;
    let beside_gap = |X: &Vector3| approximation.is_beside_gap(X);
    let spacing = NodalSpacing { within: &within, largest, beside_gap: &beside_gap };
    quadrature_following(body, regions, grid, &spacing, &problem.dimension, moves)
}

/// The surface rule, if consistent gradients or loads need it.
fn surface_of(
    problem: &Problem,
    panels: Option<(Vec<Panel>, f64)>,
    cloud: &NodeCloud,
    approximation: &Approximation,
    prescribed: &[[bool; 3]],
) -> Result<SurfaceRule, Error> {
    let Some(panels) = panels.filter(|_| needs_surface(problem)) else {
        return Ok(SurfaceRule::default());
    };
    SurfaceRule::new(panels, cloud, approximation, prescribed, problem.dimension.components())
        .map_err(|(position, poor)| outside(position, &poor))
}

/// Which components of which nodes some condition prescribes; in a plane the third one is as well.
fn prescribed_nodes(problem: &Problem, cloud: &NodeCloud) -> Vec<[bool; 3]> {
    let components = problem.dimension.components();
    let selected = |node| {
        let mut held = [false; 3];
        for condition in problem.conditions.iter().filter(|c| selects(c, cloud, node)) {
            (0..components).for_each(|k| held[k] |= condition.prescribes(k));
            held[components..].fill(true);
        }
        held
    };
    (0..cloud.positions.len()).map(selected).collect()
}

fn outside(position: Vector3, poor: &PoorSupport) -> Error {
    let (size, condition) = (poor.support_size, condition_text(poor.condition));
    let reason = format!("{size} nodes in its support, whose moment matrix has {condition}");
    Error::ProbeOutside { position, reason }
}

fn evaluate_all(approximation: &Approximation, positions: &[Vector3]) -> Result<Evaluated, Error> {
    let locate = |(point, poor): (usize, PoorSupport)| {
        let (position, support_size) = (positions[point], poor.support_size);
        let smallest = approximation.smallest_support();
        if support_size < smallest {
            Error::SmallSupport { point, position, support_size, smallest }
        } else {
            let (condition, largest) = (poor.condition, approximation.largest_condition());
            Error::SingularMomentMatrix { point, position, support_size, condition, largest }
        }
    };
    Rows::at(approximation, positions, Requested::ValuesAndGradients).map_err(locate)
}

/// Every node must be covered. Horton 2007, section 2.3, also requires that each
/// boundary node shares a support with an interior one; a body one spacing thick has
/// no interior nodes and is sound where its moment matrices are.
fn check_coverage(positions: &[Vector3], supports: &Rows) -> Result<(), Error> {
    let mut covered = vec![false; positions.len()];
    supports.nodes.iter().for_each(|&node| covered[node as usize] = true);
    match covered.iter().position(|covered| !covered) {
        Some(node) => Err(Error::UncoveredNode { node, position: positions[node] }),
        None => Ok(()),
    }
}
