//! A cell, what lies in it, and the sums over all.

use super::simplex::vector_area;
use super::surface::Facet;
use crate::algebra::tensor::Vector3;

/// Part of a cell that such a part may be off by \[–\], where pieces of 1/48 of it are asked.
const BY_PLACES: f64 = 0.45;

/// Volume of a part with its first moments.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Volume {
    /// \[m³\]
    pub size: f64,
    /// ∫ X dV \[m⁴\].
    pub first: Vector3,
    /// How wrong the size may be \[m³\].
    pub doubt: f64,
    /// Square of how wrong it may be besides, in sum over cells whose errors are independent \[m⁶\].
    pub(super) variance: f64,
}

/// What was found.
#[derive(Debug, Default)]
pub(crate) struct Sampled {
    /// \[part\]
    pub volumes: Vec<Volume>,
    pub facets: Vec<Facet>,
    /// Pieces of the volume for integrals: place \[m\], size \[m³\], part.
    pub pieces: Vec<(Vector3, f64, usize)>,
    /// Places on edges of the body, and in the middle of cells in which the faces beside an edge are not
    /// known \[m\].
    pub edges: Vec<Vector3>,
    /// Edge of the largest of these cells \[m\].
    pub finest: f64,
}

#[derive(Clone, Copy)]
pub(super) struct Cell {
    pub centre: Vector3,
    /// Half of its edges \[m\].
    pub half: Vector3,
}

/// What lies in a cell.
#[derive(Default)]
pub(super) struct Cut {
    pub pieces: Vec<(Vector3, f64, usize)>,
    pub facets: Vec<Facet>,
    /// Deviation of the signed distance from a linear function \[m\].
    pub bend: f64,
    pub edge: bool,
    /// Places along the edges of faces that are flat.
    pub edges: Vec<Vector3>,
    /// The same of the borders of the parts that may lie in the cell: part, \[m\].
    pub border_bends: Vec<(usize, f64)>,
    /// Whether the pieces were told by places, not by distances.
    pub by_places: bool,
}

impl Cell {
    pub fn corner(&self, n: usize) -> Vector3 {
        let side =
            |axis: usize| if n >> axis & 1 == 1 { self.half[axis] } else { -self.half[axis] };
        self.centre + Vector3::new(side(0), side(1), side(2))
    }

    /// Halves along each direction, in a plane along x and y.
    pub fn children(&self, flat: bool) -> impl Iterator<Item = Cell> {
        let deep = if flat { 1.0 } else { 0.5 };
        let half = self.half.component_mul(&Vector3::new(0.5, 0.5, deep));
        let whole = *self;
        (0..if flat { 4 } else { 8 }).map(move |n| {
            let mut centre = 0.5 * (whole.centre + whole.corner(n));
            if flat {
                centre.z = whole.centre.z;
            }
            Cell { centre, half }
        })
    }

    pub fn volume(&self) -> f64 {
        8.0 * self.half.product()
    }
}

impl Sampled {
    pub(super) fn add(&mut self, cell: &Cell, cut: Cut) {
        let area: f64 = cut.facets.iter().map(|facet| vector_area(&facet.corners).norm()).sum();
        let parts = cut.pieces.len() as f64;
        let face = cell.volume() / (2.0 * cell.half.x);
        let border_bend = cut.border_bends.iter().fold(0.0, |most, (_, bend)| bend.max(most));
        for (part, bend) in &cut.border_bends {
            if !cut.pieces.iter().any(|(_, _, other)| other == part) {
                self.volumes[*part].doubt += bend * face;
            }
        }
        for (place, size, part) in &cut.pieces {
            let own = &mut self.volumes[*part];
            own.size += size;
            own.first += *size * place;
            // What a boundary that bends is off, and what several owners may get of another.
            own.doubt += cut.bend * area / parts + border_bend * face;
            if cut.by_places {
                own.variance += (BY_PLACES * cell.volume()).powi(2);
            }
        }
        if cut.edge {
            self.edges.push(cell.centre);
            self.finest = self.finest.max(2.0 * cell.half.x);
        }
        self.edges.extend(cut.edges);
        self.pieces.extend(cut.pieces);
        self.facets.extend(cut.facets);
    }

    /// \[m³\]
    pub fn volume(&self) -> f64 {
        self.volumes.iter().map(|part| part.size).sum()
    }
}
