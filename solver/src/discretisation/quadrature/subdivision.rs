//! Which cells of the background grid are divided, and how many points that gives.

use crate::algebra::tensor::Vector3;
use crate::discretisation::quadrature::cell::Cell;
use crate::geometry::{CELLS, GeometryError, POINTS, Shape, positive};
use crate::problem::{BackgroundGrid, Refinement};

/// After so many cells of one level the finer levels are extrapolated from their growth.
const SAMPLE: usize = 100_000;

/// The nodal spacing that cells may follow.
pub struct NodalSpacing<'a> {
    /// The smallest one within a reach of a place \[m\].
    pub within: &'a (dyn Fn(&Vector3, f64) -> f64 + Sync),
    /// \[m\]
    pub largest: f64,
    /// Whether a gap of the body is so near a place that nodes on its two sides are.
    pub beside_gap: &'a (dyn Fn(&Vector3) -> bool + Sync),
}

impl NodalSpacing<'static> {
    /// Of nodes that cells do not follow.
    pub const UNKNOWN: Self = NodalSpacing {
        within: &|_, _| f64::INFINITY,
        largest: f64::INFINITY,
        beside_gap: &|_| false,
    };
}

/// Edge of a cell that is not divided to follow the spacing, over the one wanted \[–\].
const SLIGHTLY_TOO_LARGE: f64 = 1.1;

/// Parts per direction of a cell whose edge is `ratio` times the one wanted.
fn parts_for(ratio: f64) -> usize {
    match ratio / SLIGHTLY_TOO_LARGE {
        ratio if ratio <= 1.0 => 1,
        ratio if ratio > 2.0 && ratio <= 3.0 => 3,
        _ => 2,
    }
}

/// The edge \[m\] to which cells of an edge \[m\] are divided where a smaller one is wanted.
pub fn followed_edge(mut edge: f64, wanted: f64) -> f64 {
    while parts_for(edge / wanted) > 1 {
        edge /= parts_for(edge / wanted) as f64;
    }
    edge
}

/// The rules of a grid over a body.
#[derive(Clone, Copy)]
pub(super) struct Subdivision<'a> {
    pub body: &'a Shape,
    pub grid: &'a BackgroundGrid,
    pub spacing: &'a NodalSpacing<'a>,
    /// 2 or 3.
    pub components: usize,
}

/// Whether a cell is larger than requested.
fn too_large(cell: &Cell, limit: f64) -> bool {
    cell.edge > limit * (1.0 + 1e-9)
}

/// How often a cell has to be halved to be as small as requested.
fn halvings(cell: &Cell, limit: f64) -> f64 {
    (cell.edge / (limit * (1.0 + 1e-9))).log2().ceil().max(0.0)
}

impl Subdivision<'_> {
    /// Refuses sizes that are not lengths, and rules that do not exist.
    pub fn validate(&self) -> Result<(), GeometryError> {
        if let Some(cells) = self.grid.cells_per_spacing {
            positive("the number of cells per spacing", cells)?;
        }
        positive("the edge of the background cells", self.largest_edge())?;
        self.finer().try_for_each(|size| positive("the size of refined cells", size))?;
        match self.grid.gauss_points {
            1..=5 => Ok(()),
            count => Err(GeometryError::GaussPoints { count }),
        }
    }

    /// Edge of the undivided cells \[m\].
    pub fn largest_edge(&self) -> f64 {
        match self.grid.cells_per_spacing {
            Some(cells) => self.grid.cell.min(self.spacing.largest / cells),
            None => self.grid.cell,
        }
    }

    /// Parts per direction into which a cell at a signed `distance` \[m\] is divided.
    pub fn parts(&self, cell: &Cell, distance: f64) -> usize {
        if self.halves(cell, distance) { 2 } else { self.parts_to_follow(cell) }
    }

    /// Parts per direction into which a cell is divided to follow the nodal spacing
    /// (method book, eq. 7.5): three where that is enough, two otherwise.
    fn parts_to_follow(&self, cell: &Cell) -> usize {
        let Some(cells) = self.grid.cells_per_spacing else { return 1 };
        let wanted = (self.spacing.within)(&cell.centre, cell.half_diagonal(self.components));
        parts_for(cell.edge * cells / wanted)
    }

    /// Requested sizes of smaller cells \[m\].
    fn finer(&self) -> impl Iterator<Item = f64> {
        let parts = self.grid.refinements.iter().map(|refinement| refinement.size);
        self.grid.boundary_cell.into_iter().chain(parts)
    }

    /// Whether a cell at a signed `distance` \[m\] is halved.
    fn halves(&self, cell: &Cell, distance: f64) -> bool {
        let meets_boundary = distance > -cell.half_diagonal(self.components);
        let meets = |refinement: &Refinement| {
            cell.samples(self.components).any(|sample| refinement.part.contains(&sample))
        };
        (meets_boundary && self.grid.boundary_cell.is_some_and(|limit| too_large(cell, limit)))
            || (self.grid.refinements.iter())
                .any(|refinement| too_large(cell, refinement.size) && meets(refinement))
    }

    /// Refuses a grid of `counts` cells along the axes that has too many points, before
    /// any is made. `cells` are the unrefined ones.
    pub fn refuse_too_many(
        &self,
        counts: [f64; 3],
        cells: impl Iterator<Item = Cell>,
    ) -> Result<(), GeometryError> {
        let whole: f64 = counts.iter().product();
        CELLS.check(whole)?;
        let refined = self.finer().any(|size| size < self.largest_edge());
        if !refined && whole * self.points_per_cell() <= POINTS.most {
            return Ok(());
        }
        let mut points = 0.0;
        cells.into_iter().try_for_each(|cell| {
            points += self.expected_points(cell);
            POINTS.check(points)
        })
    }

    fn points_per_cell(&self) -> f64 {
        (self.grid.gauss_points as f64).powi(self.components as i32)
    }

    /// About how many points a cell gives, found by halving it level by level.
    fn expected_points(&self, cell: Cell) -> f64 {
        let smallest = self.finer().fold(self.largest_edge(), f64::min);
        let mut cells = 0.0;
        let mut level = vec![cell];
        while !level.is_empty() {
            let mut next = Vec::new();
            for cell in &level {
                let distance = self.body.signed_distance(&cell.centre);
                if distance > cell.half_diagonal(self.components) {
                    continue;
                }
                if !self.halves(cell, distance) {
                    cells += 1.0;
                    continue;
                }
                match self.halved_evenly(cell, distance) {
                    Some(halvings) => cells += (self.components as f64 * halvings).exp2(),
                    None => next.extend(cell.children(self.components)),
                }
            }
            if next.len() > SAMPLE {
                let growth = next.len() as f64 / level.len() as f64;
                let levels = halvings(&next[0], smallest);
                cells += next.len() as f64 * growth.powf(levels);
                break;
            }
            level = next;
        }
        cells * self.points_per_cell()
    }

    /// How often all of a cell is halved, if it lies inside the body and inside the most
    /// refined of the parts that it meets.
    fn halved_evenly(&self, cell: &Cell, distance: f64) -> Option<f64> {
        let contained = |part: &Refinement| {
            cell.samples(self.components).all(|sample| part.part.contains(&sample))
        };
        let inside = distance <= -cell.half_diagonal(self.components);
        let finest = (self.grid.refinements.iter())
            .filter(|part| cell.samples(self.components).any(|sample| part.part.contains(&sample)))
            .min_by(|a, b| a.size.total_cmp(&b.size))?;
        (inside && contained(finest)).then(|| halvings(cell, finest.size))
    }
}
