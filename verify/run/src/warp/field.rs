//! The displacement field of a run, in the body and around it.
#![allow(non_snake_case)]

use super::error::WarpError;
use crate::run::StoredField;
use mtled::algebra::tensor::Vector3;
use mtled::discretisation::HeldShape;
use mtled::discretisation::mls::{Approximation, Stiffness};
use mtled::geometry::Shape;
use mtled::problem::{Dimension, Problem};

/// The decay distance over the largest displacement where none is given: the slope of the decay
/// is then at most a half, and neighbours outside of the body keep their order.
const DECAY: f64 = 3.0;

/// Steps that bring a point to the surface: distances to label maps are not exact.
const MOST_PROJECTIONS: usize = 4;

/// u(X) everywhere. Inside the body it is that of moving least squares. Outside it is that of
/// the nearest point of the body times 1 − 3t² + 2t³, where t is the distance to the body over
/// the decay distance, and 0 from there on.
#[derive(Debug)]
pub struct DisplacementField {
    approximation: Approximation,
    /// \[component of node\] \[m\]
    parameters: Vec<f64>,
    components: usize,
    /// Height of a plane cross-section \[m\].
    plane: Option<f64>,
    body: Shape,
    /// Corners of the box in which the field is not zero \[m\].
    bounds: (Vector3, Vector3),
    /// Displacement of each node \[m\].
    at_nodes: Vec<Vector3>,
    /// Of a node \[m\].
    pub largest_displacement: f64,
    /// Distance over which the field decays outside of the body \[m\].
    pub decay: f64,
}

impl DisplacementField {
    /// The field of a run of `problem`. Outside of the body it decays over `decay` \[m\], or over
    /// three times the largest displacement of a node; over 0 it ends at the boundary.
    pub fn new(
        stored: &StoredField,
        problem: &Problem,
        decay: Option<f64>,
    ) -> Result<DisplacementField, WarpError> {
        let (dimension, recipe) = (&problem.dimension, &problem.recipe);
        let mut approximation = Approximation::new(
            stored.nodes(),
            stored.influence_radius_m.clone(),
            recipe.basis,
            recipe.weight_function,
            dimension,
        );
        let body = problem.body.section(dimension)?;
        let held = HeldShape::of(problem, &body);
        let deforming = held.as_ref().map_or(&body, |held| &held.rest);
        if let Some(stiffness) = Stiffness::at_sharp_borders(problem) {
            approximation = approximation.with_sides(stiffness, deforming, recipe.dilation);
        }
        if let Some(HeldShape { held, .. }) = &held {
            approximation = approximation.with_held(held, recipe.dilation);
        }
        approximation = approximation.within(deforming, recipe.dilation);
        let plane = match dimension {
            Dimension::Three => None,
            Dimension::PlaneStrain { z, .. } => Some(*z),
        };
        let mut field = DisplacementField {
            approximation,
            parameters: stored.nodal_parameters_m.clone(),
            components: dimension.components(),
            plane,
            body,
            bounds: (Vector3::zeros(), Vector3::zeros()),
            at_nodes: Vec::new(),
            largest_displacement: 0.0,
            decay: 0.0,
        };
        field.at_nodes = (field.approximation.nodes.iter().enumerate())
            .map(|(node, X)| field.inside(X).ok_or(WarpError::UncoveredNode { node, position: *X }))
            .collect::<Result<_, _>>()?;
        field.largest_displacement = field.at_nodes.iter().map(|u| u.norm()).fold(0.0, f64::max);
        field.decay = decay.unwrap_or(DECAY * field.largest_displacement);
        let nodes = &field.approximation.nodes;
        let (lower, upper) = field.body.bounding_box().unwrap_or_else(|| corners(nodes));
        let reach = Vector3::repeat(field.decay);
        field.bounds = (lower - reach, upper + reach);
        Ok(field)
    }

    /// Reference positions of the nodes \[m\].
    pub fn nodes(&self) -> &[Vector3] {
        &self.approximation.nodes
    }

    /// Smallest influence radius of a node over the dilation \[m\].
    pub(crate) fn smallest_spacing(&self, dilation: f64) -> f64 {
        let radii = self.approximation.influence_radius.iter();
        radii.fold(f64::INFINITY, |least, radius| least.min(*radius)) / dilation
    }

    /// Corners of the box around the nodes \[m\].
    pub(crate) fn node_bounds(&self) -> (Vector3, Vector3) {
        corners(self.nodes())
    }

    /// How far outside of the body a point is \[m\]; 0 inside.
    pub fn distance_outside(&self, X: &Vector3) -> f64 {
        self.body.signed_distance(X).max(0.0)
    }

    /// u(X) \[m\].
    pub fn at(&self, X: &Vector3) -> Vector3 {
        let (lower, upper) = &self.bounds;
        if (0..3).any(|axis| X[axis] < lower[axis] || X[axis] > upper[axis]) {
            return Vector3::zeros();
        }
        let distance = self.distance_outside(X);
        if distance == 0.0 {
            return self.near(X);
        }
        if distance >= self.decay {
            return Vector3::zeros();
        }
        let t = distance / self.decay;
        self.near(&self.nearest_in_body(X)) * (1.0 - t * t * (3.0 - 2.0 * t))
    }

    /// u at the nearest point of the body \[m\]: the displacement without its decay.
    pub(super) fn at_nearest(&self, X: &Vector3) -> Vector3 {
        self.near(&self.nearest_in_body(X))
    }

    /// Whether a place may have two sources, in the body and outside of it: the steepest slope
    /// of the decay is 3/2 over its distance.
    pub(super) fn may_fold(&self) -> bool {
        self.decay < 1.5 * self.largest_displacement
    }

    /// The nearest point of the body \[m\].
    fn nearest_in_body(&self, X: &Vector3) -> Vector3 {
        let mut nearest = *X;
        for _ in 0..MOST_PROJECTIONS {
            match self.distance_outside(&nearest) {
                0.0 => break,
                distance => nearest -= self.body.gradient(&nearest) * distance,
            }
        }
        nearest
    }

    /// u at a point of the body; that of the nearest node where a thin part of the body has too
    /// few nodes around.
    fn near(&self, X: &Vector3) -> Vector3 {
        self.inside(X).unwrap_or_else(|| {
            let distance = |node: &Vector3| (node - X).norm_squared();
            let by_distance = self
                .nodes()
                .iter()
                .zip(&self.at_nodes)
                .min_by(|(a, _), (b, _)| distance(a).total_cmp(&distance(b)));
            by_distance.map_or_else(Vector3::zeros, |(_, u)| *u)
        })
    }

    /// The sum of shape functions times nodal parameters \[m\].
    fn inside(&self, X: &Vector3) -> Option<Vector3> {
        let mut X = *X;
        X.z = self.plane.unwrap_or(X.z);
        let support = self.approximation.evaluate(&X).ok()?;
        let mut u = Vector3::zeros();
        for (&node, phi) in support.nodes.iter().zip(&support.phi) {
            for component in 0..self.components {
                u[component] += phi * self.parameters[self.components * node as usize + component];
            }
        }
        Some(u)
    }
}

fn corners(nodes: &[Vector3]) -> (Vector3, Vector3) {
    let infinite = Vector3::repeat(f64::INFINITY);
    nodes.iter().fold((infinite, -infinite), |(l, u), X| (l.inf(X), u.sup(X)))
}
