//! From the background grid to quadrature points.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::quadrature::borders::{Borders, owner};
use crate::discretisation::quadrature::cell::{Cell, in_plane};
use crate::discretisation::quadrature::cut::{cut, spread};
use crate::discretisation::quadrature::gauss::gauss_legendre;
use crate::discretisation::quadrature::pieces::{Leaf, Moments, pieces};
use crate::discretisation::quadrature::rule::Quadrature;
use crate::discretisation::quadrature::second_order::{Moves, Piece};
use crate::discretisation::quadrature::simplex::Simplex;
use crate::discretisation::quadrature::subdivision::{NodalSpacing, Subdivision};
use crate::error::Error;
use crate::geometry::{POINTS, Shape, indices};
use crate::problem::{BackgroundGrid, Dimension, InsideRule, Region};
use rayon::prelude::*;

/// Halvings below a sub-cell when its inside volume is measured.
const FRACTION_DEPTH: usize = 4;
const FRACTION_DEPTH_PLANE: usize = 5;
/// A grid that fits but for this fraction of a cell gets no other layer: a body may be that much
/// larger by round-off, far from the origin or turned \[–\].
const FITS: f64 = 1e-6;
/// The boundary is flat in a cell where the signed distance differs by less than this
/// fraction of its edge from that of a plane \[–\].
const FLAT: f64 = 1e-9;
/// The same for a boundary that is cut as a plane of the same mean distance; not round, so that
/// round-off seldom chooses \[–\].
const NEARLY_FLAT: f64 = 0.004_131_7;
/// Components of a normal that differ by less are equal: it comes from differences \[–\].
const TIE: f64 = 1e-3;
/// Parts of a cell smaller than this fraction of it are dropped \[–\].
const SMALLEST_FRACTION: f64 = 1e-4;

struct PointCollector<'a> {
    body: &'a Shape,
    regions: &'a [Region],
    grid: &'a BackgroundGrid,
    subdivision: Subdivision<'a>,
    /// 2 or 3.
    components: usize,
    /// Volume of a cell is edge^components × thickness.
    thickness: f64,
    out: Quadrature,
    /// What each point stands for, if points are moved afterwards.
    pieces: Option<Vec<Piece>>,
}

/// As [`quadrature_following`] on a grid that does not follow the nodes.
pub fn quadrature(
    body: &Shape,
    regions: &[Region],
    grid: &BackgroundGrid,
    dimension: &Dimension,
) -> Result<Quadrature, Error> {
    quadrature_following(body, regions, grid, &NodalSpacing::UNKNOWN, dimension, None)
}

/// Lays the grid over the body and collects its points, by the centre rule (Horton
/// 2007, section 2.3) or by volume fractions, with a point at the centroid of the
/// inside part of each region in a cell (method book, eq. 7.2), which may be moved.
pub fn quadrature_following(
    body: &Shape,
    regions: &[Region],
    grid: &BackgroundGrid,
    spacing: &NodalSpacing,
    dimension: &Dimension,
    moves: Option<&Moves>,
) -> Result<Quadrature, Error> {
    let (min, max) = body.bounding_box().ok_or(Error::NoQuadraturePoints)?;
    let (thickness, z) = match *dimension {
        Dimension::Three => (1.0, 0.0),
        Dimension::PlaneStrain { thickness, z } => (thickness, z),
    };
    let components = dimension.components();
    let subdivision = Subdivision { body, grid, spacing, components };
    subdivision.validate()?;
    let edge = subdivision.largest_edge();
    let counts = [0, 1, 2].map(|k| {
        if k < components { ((max[k] - min[k]) / edge - FITS).ceil().max(1.0) } else { 1.0 }
    });
    let middle = (min + max) * 0.5;
    let cell_at = |index: [usize; 3]| {
        let mut centre = middle;
        for axis in 0..3 {
            centre[axis] += edge * (index[axis] as f64 + 0.5 - 0.5 * counts[axis]);
        }
        if components == 2 {
            centre.z = z;
        }
        Cell { centre, edge }
    };
    let size = counts.map(|count| count as usize);
    subdivision.refuse_too_many(counts, indices(size).map(cell_at))?;
    let row_of_cells = |row: usize| {
        let mut collector = PointCollector {
            body,
            regions,
            grid,
            subdivision,
            components,
            thickness,
            out: Quadrature::default(),
            pieces: moves.map(|_| Vec::new()),
        };
        for i in 0..size[0] {
            collector.visit(cell_at([i, row % size[1], row / size[1]]))?;
        }
        Ok((collector.out, collector.pieces.unwrap_or_default()))
    };
    let rows: Vec<Result<_, Error>> =
        (0..size[1] * size[2]).into_par_iter().map(row_of_cells).collect();
    let (parts, pieces): (Vec<Quadrature>, Vec<Vec<Piece>>) =
        rows.into_iter().collect::<Result<_, _>>()?;
    let mut all = Quadrature::joined(parts);
    if all.positions.is_empty() {
        return Err(Error::NoQuadraturePoints);
    }
    if let Some(moves) = moves {
        moves.apply(&pieces.concat(), body, regions, &mut all);
    }
    Ok(all)
}

impl PointCollector<'_> {
    /// Divides a cell where smaller ones are requested, drops it outside.
    fn visit(&mut self, cell: Cell) -> Result<(), Error> {
        let distance = self.body.signed_distance(&cell.centre);
        let reach = cell.half_diagonal(self.components);
        if distance > reach {
            return Ok(());
        }
        let parts = self.subdivision.parts(&cell, distance);
        if parts > 1 {
            for child in cell.divide(parts, self.components) {
                self.visit(child)?;
            }
            return Ok(());
        }
        self.leaf(cell, distance > -reach)
    }

    fn leaf(&mut self, cell: Cell, meets_boundary: bool) -> Result<(), Error> {
        POINTS.check(self.out.positions.len() as f64)?;
        let mut mixed = self.may_be_mixed(&cell);
        let before = self.out.positions.len();
        match self.grid.inside {
            InsideRule::Centre => {
                if self.body.signed_distance(&cell.centre) > 0.0 {
                    return Ok(());
                }
                self.whole(&cell)?;
            }
            InsideRule::VolumeFraction if meets_boundary => self.parts(&cell)?,
            InsideRule::VolumeFraction if mixed => {
                self.parts(&cell)?;
                mixed = self.out.regions[before..].windows(2).any(|pair| pair[0] != pair[1]);
                if !mixed {
                    self.drop_from(before);
                    self.whole(&cell)?;
                }
            }
            InsideRule::VolumeFraction => self.whole(&cell)?,
        }
        if self.out.positions.len() > before {
            self.out.cells += 1;
            self.out.cut_cells += (meets_boundary || mixed) as usize;
        }
        Ok(())
    }

    /// Gauss–Legendre points of a whole cell.
    fn whole(&mut self, cell: &Cell) -> Result<(), Error> {
        let rule = gauss_legendre(self.grid.gauss_points);
        let layers: &[(f64, f64)] = if self.components == 3 { &rule } else { &[(0.0, 1.0)] };
        // Two Gauss points integrate squares themselves.
        let spread = if rule.len() == 1 { cell.spread(self.components) } else { Matrix3::zeros() };
        for &(z, wz) in layers {
            for &(y, wy) in &rule {
                for &(x, wx) in &rule {
                    let X = cell.centre + Vector3::new(x, y, z) * cell.edge;
                    let weight = self.volume(cell) * wx * wy * wz;
                    self.push(X, weight, self.region_at(&X)?);
                    self.add_piece(cell.edge / rule.len() as f64, spread);
                }
            }
        }
        Ok(())
    }

    /// One point per sub-box, region and piece at the centroid of what lies inside.
    fn parts(&mut self, cell: &Cell) -> Result<(), Error> {
        let depth = if self.components == 2 { FRACTION_DEPTH_PLANE } else { FRACTION_DEPTH };
        for part in cell.divide(self.grid.gauss_points, self.components) {
            let origin = self.pieces.is_some().then_some(part.centre);
            let mut moments = vec![Moments::default(); self.regions.len()];
            if (self.subdivision.spacing.beside_gap)(&part.centre) {
                let mut leaves = Vec::new();
                self.measure(&part, depth, &mut |leaf| leaves.push(leaf))?;
                let piece = pieces(self.body, &part, &leaves, 1 << depth, self.components);
                let count = piece.iter().max().map_or(1, |&last| last + 1);
                moments.resize(count * self.regions.len(), Moments::default());
                for (leaf, piece) in leaves.iter().zip(piece) {
                    let own = piece * self.regions.len() + leaf.region;
                    moments[own].add(leaf, origin.as_ref());
                }
            } else {
                let add = &mut |leaf: Leaf| moments[leaf.region].add(&leaf, origin.as_ref());
                self.measure(&part, depth, add)?;
            }
            for (own, Moments { volume, first, second }) in moments.into_iter().enumerate() {
                if volume > SMALLEST_FRACTION * self.volume(&part) {
                    let centroid = first / volume;
                    self.push(centroid, volume, (own % self.regions.len()) as u16);
                    let offset = centroid - part.centre;
                    self.add_piece(part.edge, second / volume - offset * offset.transpose());
                }
            }
        }
        Ok(())
    }

    /// Visits the inside parts of a cell: halves it where the boundary is not flat; the
    /// smallest cells are cut as if it were.
    fn measure(&self, cell: &Cell, depth: usize, keep: &mut impl FnMut(Leaf)) -> Result<(), Error> {
        let distance = self.body.signed_distance(&cell.centre);
        let reach = cell.half_diagonal(self.components);
        if distance > reach {
            return Ok(());
        }
        let is_cut = distance > -reach;
        let mixed = self.may_be_mixed(cell);
        if mixed && let Some(parts) = self.borders().split(cell, is_cut, depth == 0) {
            self.keep_parts(cell, &parts, keep);
            return Ok(());
        }
        let mixed = mixed && depth > 0;
        let one_plane = match (is_cut, mixed) {
            (false, false) => Some((1.0, Vector3::zeros(), cell.spread(self.components))),
            (true, false) if depth > 0 => self.flat_cut(cell, distance),
            _ => None,
        };
        let (fraction, shift, spread) = match one_plane {
            Some(part) => part,
            None if depth > 0 => {
                return cell
                    .children(self.components)
                    .try_for_each(|child| self.measure(&child, depth - 1, keep));
            }
            None => self.axis_cut(cell, distance),
        };
        if fraction > 0.0 {
            let centroid = cell.centre + shift;
            let region = self.region_at(&centroid)? as usize;
            let volume = fraction * self.volume(cell);
            keep(Leaf { cell: *cell, region, centroid, volume, spread });
        }
        Ok(())
    }

    /// Visits the parts of a cell by region.
    fn keep_parts(&self, cell: &Cell, parts: &[Vec<Simplex>], keep: &mut impl FnMut(Leaf)) {
        for (region, parts) in parts.iter().enumerate() {
            for part in parts {
                let (centroid, spread) = part.moments();
                let volume = part.size() * self.thickness;
                keep(Leaf { cell: *cell, region, centroid, volume, spread });
            }
        }
    }

    /// Inside fraction of a cell, the shift of its centroid and its spread where the
    /// boundary is nearly flat, judged by the signed distance at centre and corners (method
    /// book, eq. 7.3).
    fn flat_cut(&self, cell: &Cell, distance: f64) -> Option<(f64, Vector3, Matrix3)> {
        let near = |value: f64| value.abs() <= NEARLY_FLAT * cell.edge;
        let half = 0.5 * cell.edge;
        let ends: &[[f64; 3]] = match self.components {
            2 => &[[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]],
            _ => &[[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0]],
        };
        let mut rises = [0.0; 4];
        let (mut slope, mut bend, mut most, mut straight_ways) = (Vector3::zeros(), 0.0, 0.0f64, 0);
        for (rise, end) in rises.iter_mut().zip(ends) {
            let end = Vector3::from(*end);
            let ahead = self.body.signed_distance(&(cell.centre + half * end));
            let behind = self.body.signed_distance(&(cell.centre - half * end));
            let curved = ahead + behind - 2.0 * distance;
            if !near(curved) {
                return None;
            }
            bend += curved / ends.len() as f64;
            most = most.max(curved.abs());
            straight_ways += usize::from(curved.abs() <= FLAT * cell.edge);
            *rise = 0.5 * (ahead - behind);
            slope += end * *rise;
        }
        // Half the change of the distance along each edge.
        slope /= ends.len() as f64;
        // Bent along one diagonal only, the cell lies beside an edge, whose bend is no curvature.
        let beside_edge = straight_ways + 1 == ends.len();
        let straight = !beside_edge
            && rises
                .iter()
                .zip(ends)
                .all(|(rise, end)| near(slope.dot(&Vector3::from(*end)) - rise));
        straight.then(|| {
            // The mean distance in the cell is that of a plane.
            let level = if most > FLAT * cell.edge { distance + bend / 6.0 } else { distance };
            let (fraction, mut shift) = cut(level, &(2.0 * slope));
            if self.components == 2 {
                shift.z = 0.0;
            }
            let spread = match self.pieces {
                Some(_) => spread(level, &(2.0 * slope)) * cell.edge.powi(2),
                None => Matrix3::zeros(),
            };
            (fraction, shift * cell.edge, in_plane(spread, self.components))
        })
    }

    /// Inside fraction of a small cell, the shift of its centroid and its spread, as if
    /// the boundary were a plane whose normal is the nearest axis: exact for
    /// boundaries along the grid, second order in the cell for others (method
    /// book, eq. 7.4).
    fn axis_cut(&self, cell: &Cell, distance: f64) -> (f64, Vector3, Matrix3) {
        let fraction = (0.5 - distance / cell.edge).clamp(0.0, 1.0);
        let mut spread = cell.spread(self.components);
        if fraction == 0.0 || fraction == 1.0 {
            return (fraction, Vector3::zeros(), spread);
        }
        let mut normal = self.body.gradient(&cell.centre);
        if self.components == 2 {
            normal.z = 0.0;
        }
        // Round-off must not choose among axes that are equally near.
        let most = normal.amax();
        let nearest = [0, 1, 2].map(|axis| normal[axis].abs() > (1.0 - TIE) * most);
        let share = 1.0 / nearest.iter().filter(|&&nearest| nearest).count().max(1) as f64;
        let mut shift = Vector3::zeros();
        for axis in (0..3).filter(|&axis| nearest[axis]) {
            shift[axis] = -share * normal[axis].signum() * 0.5 * (1.0 - fraction) * cell.edge;
            spread[(axis, axis)] *= 1.0 - share * (1.0 - fraction * fraction);
        }
        (fraction, shift, spread)
    }

    fn add_piece(&mut self, edge: f64, spread: Matrix3) {
        if let Some(pieces) = &mut self.pieces {
            pieces.push(Piece { edge, spread });
        }
    }

    /// Takes points back.
    fn drop_from(&mut self, first: usize) {
        self.out.truncate(first);
        if let Some(pieces) = &mut self.pieces {
            pieces.truncate(first);
        }
    }

    fn push(&mut self, X: Vector3, weight: f64, region: u16) {
        self.out.positions.push(X);
        self.out.weights.push(weight);
        self.out.regions.push(region);
    }

    fn region_at(&self, X: &Vector3) -> Result<u16, Error> {
        let found = owner(self.regions, X);
        found.map(|index| index as u16).ok_or(Error::PointWithoutRegion { position: *X })
    }

    /// Whether a border between regions may pass a cell.
    fn may_be_mixed(&self, cell: &Cell) -> bool {
        self.regions.len() > 1 && self.borders().may_pass(cell)
    }

    fn borders(&self) -> Borders<'_> {
        let edge = self.subdivision.largest_edge();
        Borders::new(self.body, self.regions, self.components, edge)
    }

    fn volume(&self, cell: &Cell) -> f64 {
        cell.edge.powi(self.components as i32) * self.thickness
    }
}
