//! Prescribed displacements, at the nodes and between them.
#![allow(non_snake_case)]

use super::sampling::part_of_surface;
use super::{Kind, Row, Run};
use crate::algebra::tensor::{Vector3, vector_at};
use crate::error::Error;
use crate::geometry::{Extent, Selector};
use crate::problem::{Enforcement, EssentialCondition, Prescribed};

/// Difference at a node over the largest prescribed displacement \[–\]: collocation is solved to
/// round-off, and Newton's method leaves at most a millionth of a jump.
const AT_NODES: f64 = 1e-5;
/// The same over the size of the body \[–\], for what is held at 0 while the body moves.
const ROUND_OFF: f64 = 1e-8;
/// The same for a field on the whole boundary, over its range \[–\]: its mean gradient is kept,
/// for which values at nodes are changed in second order of the spacing.
const WHOLE_FIELD: f64 = 0.01;
/// Root mean square of the differences between nodes over the range of the displacement of the
/// body \[–\]: answers inherit it. At the rim of a held part the displacement leaves what is
/// prescribed within a support, which counts here; error bars of usual clouds are 2 to 10 %.
const BETWEEN: f64 = 0.05;
/// Places between the nodes of a condition.
const SAMPLES: usize = 128;

/// A condition at the end of the run.
struct AtEnd<'a> {
    condition: &'a EssentialCondition,
    factor: f64,
}

impl AtEnd<'_> {
    /// The displacement that is prescribed at `X` \[m\].
    fn displacement(&self, X: &Vector3) -> Vector3 {
        match &self.condition.prescribed {
            Prescribed::Displacement(values) => {
                Vector3::from_fn(|k, _| self.factor * values[k].unwrap_or(0.0))
            }
            Prescribed::Field(field) => self.factor * field.at(X),
            Prescribed::Rotation { point, axis, angle } => {
                let (arm, angle) = (X - point, self.factor * angle);
                let along = arm.dot(axis) * axis;
                let across = arm - along;
                across * (angle.cos() - 1.0) + axis.cross(&across) * angle.sin()
            }
        }
    }

    /// The part of a displacement that the condition says something about, less what it says.
    fn difference(&self, u: &Vector3, X: &Vector3, components: usize) -> Vector3 {
        let asked = self.displacement(X);
        let prescribed = |k: usize| {
            k < components
                && match &self.condition.prescribed {
                    Prescribed::Displacement(values) => values[k].is_some(),
                    Prescribed::Rotation { .. } | Prescribed::Field(_) => true,
                }
        };
        Vector3::from_fn(|k, _| if prescribed(k) { u[k] - asked[k] } else { 0.0 })
    }
}

impl Run<'_> {
    /// A row for each condition that holds at the end, and one between its nodes.
    pub(super) fn prescribed(&self) -> Result<Vec<Row>, Error> {
        let mut rows = Vec::new();
        for condition in &self.problem.conditions {
            if condition.release.is_some_and(|release| self.time >= release) {
                continue;
            }
            let at_end = AtEnd { condition, factor: condition.amplitude.at(self.time) };
            rows.extend(self.at_nodes(&at_end)?);
            rows.extend(self.between_nodes(&at_end)?);
        }
        Ok(rows)
    }

    /// Where the difference at a node is the largest.
    fn at_nodes(&self, at_end: &AtEnd) -> Result<Option<Row>, Error> {
        let AtEnd { condition, .. } = at_end;
        let positions = &self.discretisation.cloud.positions;
        let held = |&node: &usize| {
            let X = &positions[node];
            condition.part.contains(X)
                && (condition.extent == Extent::Volume
                    || self.body.signed_distance(X).abs() < 1e-3 * self.spacing)
        };
        let nodes: Vec<usize> = (0..positions.len()).filter(held).collect();
        let values = match self.problem.recipe.enforcement {
            Enforcement::Direct => {
                let (u, d) = (&self.state.displacement, self.model.components);
                nodes.iter().map(|&node| vector_at(u, node, d)).collect()
            }
            Enforcement::Collocation => {
                self.field_at(&nodes.iter().map(|&node| positions[node]).collect::<Vec<_>>())?
            }
        };
        let places = nodes.into_iter().map(|node| positions[node]);
        let placed: Vec<(Vector3, Vector3)> = places.zip(values).collect();
        let sizes = placed.iter().map(|(X, _)| at_end.displacement(X).norm());
        let largest = sizes.fold(0.0, f64::max);
        let mut limit = AT_NODES * largest + ROUND_OFF * self.extent();
        if matches!(condition.prescribed, Prescribed::Field(_)) {
            limit += WHOLE_FIELD * self.range();
        }
        Ok(self.worst(Kind::PrescribedAtNodes, at_end, &placed, limit))
    }

    fn between_nodes(&self, at_end: &AtEnd) -> Result<Option<Row>, Error> {
        let AtEnd { condition, .. } = at_end;
        let places = match condition.extent {
            Extent::Surface => {
                let (facets, dimension) = (&self.sampled.facets, &self.problem.dimension);
                let part = part_of_surface(facets, &condition.part, dimension, self.spacing);
                part.pieces.iter().map(|piece| piece.0).collect()
            }
            Extent::Volume => self.places_within(&condition.part),
        };
        let step = places.len().div_ceil(SAMPLES).max(1);
        let places: Vec<Vector3> = places.into_iter().step_by(step).collect();
        let values = self.field_at(&places)?;
        let components = self.model.components;
        let squares = places.iter().zip(&values);
        let squares =
            squares.map(|(X, u)| at_end.difference(u, X, components).norm_squared()).sum::<f64>();
        let mean = (squares / places.len().max(1) as f64).sqrt();
        let limit = BETWEEN * self.range() + ROUND_OFF * self.extent();
        Ok((!places.is_empty())
            .then(|| Row::numbers(Kind::PrescribedBetween, &condition.name, 0.0, mean, limit)))
    }

    /// Places of the body in a part of space.
    fn places_within(&self, part: &Selector) -> Vec<Vector3> {
        let places = self.sampled.pieces.iter().map(|piece| self.at(piece.0));
        places.filter(|X| part.contains(X)).collect()
    }

    /// The place \[m\] with the largest difference of its displacement \[m\].
    fn worst(
        &self,
        kind: Kind,
        at_end: &AtEnd,
        placed: &[(Vector3, Vector3)],
        limit: f64,
    ) -> Option<Row> {
        let components = self.model.components;
        let difference = |(X, u): &(Vector3, Vector3)| at_end.difference(u, X, components);
        let size = |placed: &&(Vector3, Vector3)| {
            let size = difference(placed).norm();
            if size.is_nan() { f64::INFINITY } else { size }
        };
        let worst = placed.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let done = worst.1;
        let asked = done - difference(worst);
        Some(Row::vectors(kind, &at_end.condition.name, asked, done, limit))
    }

    /// The displacement at places of the body \[m\].
    fn field_at(&self, places: &[Vector3]) -> Result<Vec<Vector3>, Error> {
        let rows = self.discretisation.rows_at(places)?;
        let (u, components) = (&self.state.displacement, self.model.components);
        Ok((0..places.len()).map(|i| rows.interpolate(i, u, components)).collect())
    }

    /// Diagonal of the box around the displacements of all nodes \[m\].
    fn range(&self) -> f64 {
        let d = self.model.components;
        let u = |node| vector_at(&self.state.displacement, node, d);
        let (mut lower, mut upper) = (u(0), u(0));
        (1..self.model.positions.len()).for_each(|node| {
            (lower, upper) = (lower.inf(&u(node)), upper.sup(&u(node)));
        });
        (upper - lower).norm()
    }
}
