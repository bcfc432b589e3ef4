//! Clouds whose spacing varies.
#![allow(non_snake_case)]

use super::random::SplitMix64;
use super::regular::in_dimension;
use super::{MOST_NODES, NodeCloud};
use crate::algebra::tensor::Vector3;
use crate::geometry::{
    GeometryError, PointHash, ScalarGrid, Seed, Shape, Sizes, boundary_points_sized, positive,
};
use crate::problem::{Dimension, Refinement};

/// Most samples of the grid on which a cloud finds distances to the parts.
const MOST_SAMPLES: f64 = 4e6;
/// Nodes are at least this far apart \[spacing\]; with candidates everywhere
/// this gives about one node per spacing².
const APART: f64 = 0.85;
/// Distance of candidates \[spacing\].
const CANDIDATE: f64 = 1.0 / 3.0;

/// What sizes are wanted.
#[derive(Debug, Clone, Copy)]
pub struct WantedSizes<'a> {
    /// Far from all refinements \[m\].
    pub spacing: f64,
    pub refinements: &'a [Refinement],
    /// Of the spacing per length \[–\].
    pub growth: f64,
}

/// Wanted spacing h(X) = min(`spacing`, size + growth · distance to the part)
/// \[m\] over all refinements.
#[derive(Debug)]
pub struct SizeField<'a> {
    wanted: WantedSizes<'a>,
    corner: Vector3,
    /// Distance to each part \[m\].
    distances: Vec<ScalarGrid>,
}

impl<'a> SizeField<'a> {
    /// Distances are found on a grid of half the smallest size, or coarser where that
    /// takes more than `most_samples`. A part without a sample is an error.
    pub fn new(
        body: &Shape,
        wanted: WantedSizes<'a>,
        dimension: &Dimension,
        most_samples: f64,
    ) -> Result<Self, GeometryError> {
        let (lower, upper) = body.finite_bounds(dimension)?;
        let smallest = wanted.smallest();
        let length = (upper - lower).rows(0, dimension.components()).clone_owned();
        let most = (length.product() / most_samples).powf(1.0 / dimension.components() as f64);
        let step = (0.5 * smallest).max(most);
        let size = [0, 1, 2]
            .map(|k| if k < length.len() { (length[k] / step).ceil() as usize + 1 } else { 1 });
        let blank = ScalarGrid { size, step: Vector3::repeat(step), values: Vec::new() };
        let mut distances = Vec::new();
        for (n, refinement) in wanted.refinements.iter().enumerate() {
            let mut inside = false;
            let mut seeds = Vec::new();
            for at in 0..size.iter().product() {
                let foot = blank.local(at);
                let X = lower + foot;
                if refinement.part.contains(&X) {
                    inside |= body.signed_distance(&X) < step;
                    seeds.push(Seed { at, distance: 0.0, foot });
                }
            }
            if !inside {
                return Err(GeometryError::RefinementEmpty {
                    refinement: n,
                    size: refinement.size,
                });
            }
            distances.push(blank.distance_to_seeds(seeds));
        }
        Ok(SizeField { wanted, corner: lower, distances })
    }

    /// h(X) \[m\].
    pub fn at(&self, X: &Vector3) -> f64 {
        let WantedSizes { spacing, refinements, growth } = self.wanted;
        let mut size = spacing;
        for (refinement, distance) in refinements.iter().zip(&self.distances) {
            let away = if refinement.part.contains(X) {
                0.0
            } else {
                distance.sample(&(X - self.corner)).max(0.0)
            };
            size = size.min(refinement.size + growth * away);
        }
        size
    }
}

/// Boundary points first, then candidates of a tree of lattices, each taken
/// if no node is nearer than 0.85 of its spacing.
pub(super) fn graded(
    body: &Shape,
    wanted: WantedSizes,
    seed: u64,
    dimension: &Dimension,
) -> Result<NodeCloud, GeometryError> {
    let WantedSizes { spacing, refinements, growth } = wanted;
    positive("the nodal spacing", spacing)?;
    for refinement in refinements {
        positive("the size of a refinement", refinement.size)?;
    }
    if !(growth >= 0.0 && growth.is_finite()) {
        return Err(GeometryError::NotPositive {
            name: "the growth of the spacing",
            value: growth,
        });
    }
    let field = SizeField::new(body, wanted, dimension, MOST_SAMPLES)?;
    let size_at = |X: &Vector3| field.at(X);
    let smallest = wanted.smallest();
    let sizes = Sizes { at: &size_at, smallest, largest: spacing };
    let boundary = boundary_points_sized(body, &sizes, dimension)?;
    let mut hash = PointHash::new(APART * smallest, APART * spacing);
    boundary.points.iter().for_each(|X| hash.insert(*X));
    let count = boundary.points.len();
    let mut positions = boundary.points;
    let (mut lower, mut upper) = body.finite_bounds(dimension)?;
    if seed > 0 {
        // The lattices are centred in this box: moved by up to half a spacing, and
        // as much larger, it still covers the body.
        let by = 0.5 * spacing * in_dimension(SplitMix64(seed).vector(), dimension);
        (lower, upper) = (lower + by - by.abs(), upper + by + by.abs());
    }
    candidates(body, &field, lower, upper, dimension, &mut |X, size| {
        if !hash.any_within(&X, APART * size) {
            hash.insert(X);
            positions.push(X);
        }
        if (positions.len() as f64) < MOST_NODES {
            return Ok(());
        }
        let count = positions.len() as f64;
        Err(GeometryError::TooMany { what: "nodes", count, limit: MOST_NODES })
    })?;
    let spacing = positions.iter().map(|X| field.at(X)).collect();
    let on_boundary = (0..positions.len()).map(|n| n < count).collect();
    Ok(NodeCloud { positions, spacing, on_boundary })
}

type Visit<'a> = &'a mut dyn FnMut(Vector3, f64) -> Result<(), GeometryError>;

/// Visits the centres of cubes that are halved until they are as small as the
/// candidates should be apart, if they are clear of the boundary.
fn candidates(
    body: &Shape,
    field: &SizeField,
    lower: Vector3,
    upper: Vector3,
    dimension: &Dimension,
    visit: Visit,
) -> Result<(), GeometryError> {
    let axes = dimension.components();
    let edge = field.wanted.spacing;
    let count = [0, 1, 2]
        .map(|k| if k < axes { ((upper[k] - lower[k]) / edge).ceil().max(1.0) } else { 1.0 });
    super::refuse_too_many(count.iter().product())?;
    let count = count.map(|n| n as usize);
    let middle = 0.5 * (lower + upper);
    for k in 0..count[2] {
        for j in 0..count[1] {
            for i in 0..count[0] {
                let at = [i, j, k];
                let centre = Vector3::from_fn(|axis, _| {
                    let steps = at[axis] as f64 + 0.5 - 0.5 * count[axis] as f64;
                    middle[axis] + if axis < axes { steps * edge } else { 0.0 }
                });
                halve(body, field, centre, edge, axes, visit)?;
            }
        }
    }
    Ok(())
}

fn halve(
    body: &Shape,
    field: &SizeField,
    centre: Vector3,
    edge: f64,
    axes: usize,
    visit: Visit,
) -> Result<(), GeometryError> {
    let distance = body.signed_distance(&centre);
    if distance > 0.5 * edge * (axes as f64).sqrt() {
        return Ok(());
    }
    let size = field.at(&centre);
    // The spacing inside a large cube may be smaller than at its centre.
    let least = (size - 0.5 * field.wanted.growth * edge).max(0.25 * size);
    if edge > CANDIDATE * least.max(1e-3 * field.wanted.spacing)
        && edge > CANDIDATE * field.wanted.smallest()
    {
        for child in 0..1 << axes {
            let offset = Vector3::from_fn(|axis, _| match axis < axes {
                true if child >> axis & 1 == 1 => 0.25 * edge,
                true => -0.25 * edge,
                false => 0.0,
            });
            halve(body, field, centre + offset, 0.5 * edge, axes, visit)?;
        }
        return Ok(());
    }
    if distance < -0.5 * size { visit(centre, size) } else { Ok(()) }
}

impl WantedSizes<'_> {
    fn smallest(&self) -> f64 {
        self.refinements.iter().map(|r| r.size).fold(self.spacing, f64::min)
    }
}
