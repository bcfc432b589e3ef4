//! From the background grid to quadrature points.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::quadrature::borders::{Borders, owner};
use crate::discretisation::quadrature::boundary_cut::BoundaryCut;
use crate::discretisation::quadrature::cell::{Cell, Cells};
use crate::discretisation::quadrature::gauss::gauss_legendre;
use crate::discretisation::quadrature::pieces::{Leaf, Moments, pieces, pieces_by_sight};
use crate::discretisation::quadrature::rule::Quadrature;
use crate::discretisation::quadrature::second_order::{Moves, Piece};
use crate::discretisation::quadrature::simplex::Simplex;
use crate::discretisation::quadrature::subdivision::{NodalSpacing, Subdivision};
use crate::discretisation::quadrature::voxel_cuts::{VoxelBox, VoxelCuts};
use crate::error::Error;
use crate::geometry::{POINTS, Shape, indices};
use crate::problem::{BackgroundGrid, Dimension, InsideRule, Region};
use rayon::prelude::*;

/// Halvings below a sub-cell when its inside volume is measured.
const FRACTION_DEPTH: usize = 4;
const FRACTION_DEPTH_PLANE: usize = 5;
/// Parts of a cell smaller than this fraction of it are dropped \[–\].
const SMALLEST_FRACTION: f64 = 1e-4;
/// Where on both sides of the middle of a cell it is looked whether a gap lies between \[edge\].
const ACROSS: f64 = 0.4;
/// Halvings of a sub-box in which a point would lie in another region than its own.
const HALVINGS: usize = 2;

struct PointCollector<'a> {
    body: &'a Shape,
    regions: &'a [Region],
    /// Where voxels alone tell regions apart.
    voxels: Option<VoxelCuts<'a>>,
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
    let cells = Cells::over((min, max), subdivision.largest_edge(), components, z);
    subdivision.refuse_too_many(cells.counts, indices(cells.size()).map(|i| cells.at(i)))?;
    let size = cells.size();
    let voxels = VoxelCuts::of(regions, components);
    let row_of_cells = |row: usize| {
        let mut collector = PointCollector {
            body,
            regions,
            voxels,
            grid,
            subdivision,
            components,
            thickness,
            out: Quadrature::default(),
            pieces: moves.map(|_| Vec::new()),
        };
        for i in 0..size[0] {
            collector.visit(cells.at([i, row % size[1], row / size[1]]))?;
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
            self.part(&part, depth, HALVINGS)?;
        }
        Ok(())
    }

    /// Halves a sub-box where a point would lie in a region other than its own.
    fn part(&mut self, part: &Cell, depth: usize, halvings: usize) -> Result<(), Error> {
        let moments = self.moments(part, depth)?;
        if halvings > 0 && !self.are_home(&moments, part) {
            return part
                .children(self.components)
                .try_for_each(|child| self.part(&child, depth - 1, halvings - 1));
        }
        for (own, Moments { volume, first, second }) in moments.into_iter().enumerate() {
            if volume > self.least(part) {
                let centroid = first / volume;
                self.push(centroid, volume, (own % self.regions.len()) as u16);
                let offset = centroid - part.centre;
                self.add_piece(part.edge, second / volume - offset * offset.transpose());
            }
        }
        Ok(())
    }

    /// Volume of a part of a cell that counts \[m³\].
    fn least(&self, cell: &Cell) -> f64 {
        SMALLEST_FRACTION * self.volume(cell)
    }

    /// Whether the centroids of parts by piece and region lie in their regions.
    fn are_home(&self, moments: &[Moments], part: &Cell) -> bool {
        let (count, least) = (self.regions.len(), self.least(part));
        let is_home = |(own, all): (usize, &Moments)| {
            let region = Some(own % count);
            all.volume <= least || owner(self.regions, &(all.first / all.volume)) == region
        };
        count == 1 || moments.iter().enumerate().all(is_home)
    }

    /// Of what lies inside, by piece and region.
    fn moments(&self, part: &Cell, depth: usize) -> Result<Vec<Moments>, Error> {
        let (origin, count) = (self.pieces.is_some().then_some(part.centre), self.regions.len());
        let beside_gap = (self.subdivision.spacing.beside_gap)(&part.centre);
        if !beside_gap {
            let mut moments = vec![Moments::default(); count];
            let add = &mut |leaf: Leaf| moments[leaf.region].add(&leaf, origin.as_ref());
            self.measure(part, depth, add)?;
            if self.are_home(&moments, part) {
                return Ok(moments);
            }
        }
        let mut leaves = Vec::new();
        self.measure(part, depth, &mut |leaf| leaves.push(leaf))?;
        let piece = if beside_gap {
            pieces(self.body, part, &leaves, self.components)
        } else {
            pieces_by_sight(self.regions, &leaves)
        };
        let last = piece.iter().max().map_or(0, |&last| last);
        let mut moments = vec![Moments::default(); (last + 1) * count];
        for (leaf, piece) in leaves.iter().zip(piece) {
            moments[piece * count + leaf.region].add(leaf, origin.as_ref());
        }
        Ok(moments)
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
        if let (true, Some(voxels)) = (mixed, &self.voxels)
            && let Some(boxes) = voxels.boxes(cell)
        {
            if !is_cut {
                return self.keep_boxes(cell, boxes, keep);
            }
            if let Some(parts) = self.borders().split_boxes(cell, &boxes, depth == 0) {
                self.keep_parts(cell, &parts, keep);
                return Ok(());
            }
        }
        let mixed = mixed && depth > 0;
        let one_plane = match (is_cut, mixed) {
            (false, false) => Some((1.0, Vector3::zeros(), cell.spread(self.components))),
            (true, false) if depth > 0 => self.flat(cell, distance),
            _ => None,
        };
        let (fraction, shift, spread) = match one_plane {
            Some(part) => part,
            None if depth > 0 => {
                return cell
                    .children(self.components)
                    .try_for_each(|child| self.measure(&child, depth - 1, keep));
            }
            None => self.boundary_cut().along_axes(cell, distance),
        };
        if fraction > 0.0 {
            let centroid = cell.centre + shift;
            let region = self.region_at(&centroid)? as usize;
            let volume = fraction * self.volume(cell);
            keep(Leaf { cell: *cell, region, centroid, volume, spread });
        }
        Ok(())
    }

    /// What of a cell lies behind a boundary that is flat there and no gap divides.
    fn flat(&self, cell: &Cell, distance: f64) -> Option<(f64, Vector3, Matrix3)> {
        let found = self.boundary_cut().flat(cell, distance)?;
        let middle = self.body.place(&(cell.centre + found.1));
        if found.0 == 0.0 || !(self.subdivision.spacing.beside_gap)(&middle.X) {
            return Some(found);
        }
        // Another face may be nearer to corners and centre than the gap.
        let is_across = |n: usize| {
            let (axis, side) = (n / 2, if n.is_multiple_of(2) { -ACROSS } else { ACROSS });
            let mut X = middle.X;
            X[axis] = cell.centre[axis] + side * cell.edge;
            let end = self.body.place(&X);
            end.distance <= 0.0 && self.body.parts(&middle, &end, cell.edge)
        };
        let is_torn = middle.distance > 0.0 || (0..2 * self.components).any(is_across);
        (!is_torn).then_some(found)
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

    /// Visits the parts of a cell by voxel.
    fn keep_boxes(
        &self,
        cell: &Cell,
        boxes: Vec<VoxelBox>,
        keep: &mut impl FnMut(Leaf),
    ) -> Result<(), Error> {
        for VoxelBox { centre, size, spread, .. } in boxes {
            let (region, volume) = (self.region_at(&centre)? as usize, size * self.thickness);
            keep(Leaf { cell: *cell, region, centroid: centre, volume, spread });
        }
        Ok(())
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

    fn boundary_cut(&self) -> BoundaryCut<'_> {
        let (body, components) = (self.body, self.components);
        BoundaryCut { body, components, has_spread: self.pieces.is_some() }
    }

    fn borders(&self) -> Borders<'_> {
        let edge = self.subdivision.largest_edge();
        Borders::new(self.body, self.regions, self.components, edge)
    }

    fn volume(&self, cell: &Cell) -> f64 {
        cell.edge.powi(self.components as i32) * self.thickness
    }
}
