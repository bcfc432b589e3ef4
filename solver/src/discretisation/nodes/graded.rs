//! Clouds whose spacing varies.
#![allow(non_snake_case)]

use crate::algebra::random::Random;
use crate::algebra::tensor::Vector3;
use crate::discretisation::nodes::cloud::NodeCloud;
use crate::geometry::{
    DISTANCE_SAMPLES, GeometryError, KnownDistance, NODES, PointHash, ScalarGrid, Shape,
    TargetSpacing, boundary_points, indices, positive,
};
use crate::problem::{Dimension, Refinement};

/// Most samples of the grid of distances to the refined parts.
const MOST_SAMPLES: f64 = 4e6;
/// Nodes are at least this far apart \[spacing\]; with candidates everywhere
/// this gives about one node per spacing².
const APART: f64 = 0.85;
/// Distance of candidates \[spacing\].
const CANDIDATE: f64 = 1.0 / 3.0;

/// Sizes that a graded cloud is to have.
#[derive(Debug, Clone, Copy)]
pub struct RequestedSizes<'a> {
    /// Far from all refinements \[m\].
    pub spacing: f64,
    /// Parts with smaller spacings.
    pub refinements: &'a [Refinement],
    /// Largest growth of the spacing per length \[–\].
    pub growth: f64,
}

/// Target spacing h(X) = min(`spacing`, size + growth · distance to the part)
/// \[m\] over all refinements (method book, eq. 5.1).
#[derive(Debug)]
pub struct SizeField<'a> {
    requested: RequestedSizes<'a>,
    corner: Vector3,
    /// Distance to each part \[m\].
    distances: Vec<ScalarGrid>,
}

impl<'a> SizeField<'a> {
    /// Distances are computed on a grid of half the smallest size, or on a coarser one
    /// where that needs more than `most_samples`. A part without a sample is an error.
    pub fn new(
        body: &Shape,
        requested: RequestedSizes<'a>,
        dimension: &Dimension,
        most_samples: f64,
    ) -> Result<Self, GeometryError> {
        let (lower, _) = body.finite_bounds(dimension)?;
        let (size, step) = requested.grid(body, dimension, most_samples)?;
        let blank = ScalarGrid { size, step: Vector3::repeat(step), values: Vec::new() };
        let mut distances = Vec::new();
        for (n, refinement) in requested.refinements.iter().enumerate() {
            let mut inside = false;
            let mut known = Vec::new();
            for at in 0..size.iter().product() {
                let foot = blank.local(at);
                let X = lower + foot;
                if refinement.part.contains(&X) {
                    inside |= body.signed_distance(&X) < step;
                    known.push(KnownDistance { at, distance: 0.0, foot });
                }
            }
            if !inside {
                return Err(GeometryError::RefinementEmpty {
                    refinement: n,
                    size: refinement.size,
                });
            }
            distances.push(blank.propagate(&known, requested.reach(refinement, step)));
        }
        Ok(SizeField { requested, corner: lower, distances })
    }

    /// h(X) \[m\].
    pub fn at(&self, X: &Vector3) -> f64 {
        let RequestedSizes { spacing, refinements, growth } = self.requested;
        let mut size = spacing;
        for (refinement, distance) in refinements.iter().zip(&self.distances) {
            let mut away = distance.sample(&(X - self.corner)).max(0.0);
            // Far from the samples of a part the question costs more than the answer.
            if away < 2.0 * distance.step.max() && refinement.part.contains(X) {
                away = 0.0;
            }
            size = size.min(refinement.size + growth * away);
        }
        size
    }
}

/// Boundary points first, then candidates, one in each square or cube of a tree of lattices,
/// each chosen if no node is nearer than 0.85 of its spacing. In space candidates are random:
/// those at the centres settle on crystals, whose alternating displacements cost Newton's
/// method up to three times the products (method book, section 21).
pub(super) fn graded(
    body: &Shape,
    requested: RequestedSizes,
    seed: u64,
    dimension: &Dimension,
) -> Result<NodeCloud, GeometryError> {
    let RequestedSizes { spacing, refinements, growth } = requested;
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
    let field = SizeField::new(body, requested, dimension, MOST_SAMPLES)?;
    let size_at = |X: &Vector3| field.at(X);
    let smallest = requested.smallest();
    let target = TargetSpacing { at: &size_at, smallest, largest: spacing };
    let boundary = boundary_points(body, &target, dimension)?;
    let mut hash = PointHash::new(APART * smallest, APART * spacing);
    boundary.points.iter().for_each(|X| hash.insert(*X));
    let count = boundary.points.len();
    let mut positions = boundary.points;
    let (mut lower, mut upper) = body.finite_bounds(dimension)?;
    if seed > 0 {
        // The lattices are centred in this box: moved by up to half a spacing, and
        // as much larger, it still covers the body.
        let by = 0.5 * spacing * dimension.in_plane(Random(seed).vector(3));
        (lower, upper) = (lower + by - by.abs(), upper + by + by.abs());
    }
    let mut random = Random(seed);
    let mut candidate = |cube: Cube| match dimension.components() {
        3 => cube.centre + 0.5 * cube.edge * random.vector(3),
        _ => cube.centre,
    };
    candidates(body, &field, lower, upper, dimension, &mut |cube, size| {
        let X = candidate(cube);
        if !hash.any_within(&X, APART * size) {
            hash.insert(X);
            positions.push(X);
        }
        NODES.check(positions.len() as f64)
    })?;
    Ok(NodeCloud::boundary_first(positions, count, size_at))
}

/// A cube with one candidate.
#[derive(Clone, Copy)]
struct Cube {
    centre: Vector3,
    /// \[m\]
    edge: f64,
}

type Visit<'a> = &'a mut dyn FnMut(Cube, f64) -> Result<(), GeometryError>;

/// Visits cubes that are halved until they are as small as the candidates should be
/// apart, with the spacing there, unless they are too near the boundary.
fn candidates(
    body: &Shape,
    field: &SizeField,
    lower: Vector3,
    upper: Vector3,
    dimension: &Dimension,
    visit: Visit,
) -> Result<(), GeometryError> {
    let axes = dimension.components();
    let edge = field.requested.spacing;
    // Cubes that fit exactly must not get another layer from round-off.
    let along = |k: usize| ((upper[k] - lower[k]) / edge - 1e-9).ceil().max(1.0);
    let count = [0, 1, 2].map(|k| if k < axes { along(k) } else { 1.0 });
    NODES.check(count.iter().product())?;
    let count = count.map(|n| n as usize);
    let middle = 0.5 * (lower + upper);
    for at in indices(count) {
        let centre = Vector3::from_fn(|axis, _| {
            let steps = at[axis] as f64 + 0.5 - 0.5 * count[axis] as f64;
            middle[axis] + if axis < axes { steps * edge } else { 0.0 }
        });
        halve(body, field, Cube { centre, edge }, axes, visit)?;
    }
    Ok(())
}

fn halve(
    body: &Shape,
    field: &SizeField,
    cube: Cube,
    axes: usize,
    visit: Visit,
) -> Result<(), GeometryError> {
    let Cube { centre, edge } = cube;
    let distance = body.signed_distance(&centre);
    if distance > 0.5 * edge * (axes as f64).sqrt() {
        return Ok(());
    }
    let size = field.at(&centre);
    // The spacing inside a large cube may be smaller than at its centre.
    let least = (size - 0.5 * field.requested.growth * edge).max(0.25 * size);
    if edge > CANDIDATE * least.max(1e-3 * field.requested.spacing)
        && edge > CANDIDATE * field.requested.smallest()
    {
        for child in 0..1 << axes {
            let offset = Vector3::from_fn(|axis, _| match axis < axes {
                true if child >> axis & 1 == 1 => 0.25 * edge,
                true => -0.25 * edge,
                false => 0.0,
            });
            let child = Cube { centre: centre + offset, edge: 0.5 * edge };
            halve(body, field, child, axes, visit)?;
        }
        return Ok(());
    }
    if distance < -0.5 * size { visit(cube, size) } else { Ok(()) }
}

impl RequestedSizes<'_> {
    /// Number of samples of the distances to each part, before nodes are chosen.
    pub(crate) fn samples(
        &self,
        body: &Shape,
        dimension: &Dimension,
    ) -> Result<f64, GeometryError> {
        let (size, _) = self.grid(body, dimension, MOST_SAMPLES)?;
        Ok(size.map(|n| n as f64).iter().product())
    }

    /// Samples along each axis, and their distance \[m\].
    fn grid(
        &self,
        body: &Shape,
        dimension: &Dimension,
        most_samples: f64,
    ) -> Result<([usize; 3], f64), GeometryError> {
        let (lower, upper) = body.finite_bounds(dimension)?;
        let length = (upper - lower).rows(0, dimension.components()).clone_owned();
        let most = (length.product() / most_samples).powf(1.0 / dimension.components() as f64);
        let step = (0.5 * self.smallest()).max(most);
        let across =
            |k: usize| if k < length.len() { (length[k] / step).ceil() + 1.0 } else { 1.0 };
        // A long thin body needs more than were asked for.
        DISTANCE_SAMPLES.check((0..3).map(across).product())?;
        Ok(([0, 1, 2].map(|k| across(k) as usize), step))
    }

    /// How far around a part the spacing is smaller than elsewhere, and two samples more:
    /// values between samples need them \[m\].
    fn reach(&self, refinement: &Refinement, step: f64) -> f64 {
        (self.spacing - refinement.size).max(0.0) / self.growth + 2.0 * step
    }

    fn smallest(&self) -> f64 {
        self.refinements.iter().map(|r| r.size).fold(self.spacing, f64::min)
    }
}
