//! Background grid → quadrature points. The grid need not conform to the body.
#![allow(non_snake_case)]

mod cut;

use crate::algebra::tensor::Vector3;
use crate::error::Error;
use crate::geometry::Shape;
use crate::problem::{BackgroundGrid, Dimension, InsideRule, Region};
use rayon::prelude::*;

/// Quadrature points of the whole body.
#[derive(Debug, Clone, Default)]
pub struct Quadrature {
    /// \[point\] \[m\]
    pub positions: Vec<Vector3>,
    /// `quadrature_weight`, a reference volume \[point\] \[m³\].
    pub weights: Vec<f64>,
    /// Index of the region that each point belongs to \[point\].
    pub regions: Vec<u16>,
    /// Cells that gave points.
    pub cells: usize,
    /// Cells cut by the boundary or by a border between regions.
    pub cut_cells: usize,
}

/// Halvings below a sub-cell when its inside volume is measured.
const FRACTION_DEPTH: usize = 4;
const FRACTION_DEPTH_PLANE: usize = 5;
/// The boundary is flat in a cell where the signed distance differs by less than this
/// share of its edge from that of a plane \[–\].
const FLAT: f64 = 1e-9;
/// Parts of a cell smaller than this share of it are dropped \[–\].
const SMALLEST_FRACTION: f64 = 1e-4;

/// A square or cube of the grid.
#[derive(Clone, Copy)]
struct Cell {
    centre: Vector3,
    edge: f64,
}

impl Cell {
    /// n parts per direction.
    fn divide(self, n: usize, components: usize) -> impl Iterator<Item = Cell> {
        let edge = self.edge / n as f64;
        let at = move |i: usize| (i as f64 + 0.5 - 0.5 * n as f64) * edge;
        let (layers, solid) = if components == 3 { (n, 1.0) } else { (1, 0.0) };
        (0..n * n * layers).map(move |part| {
            let shift = Vector3::new(at(part % n), at(part / n % n), solid * at(part / (n * n)));
            Cell { centre: self.centre + shift, edge }
        })
    }
}

struct Builder<'a> {
    body: &'a Shape,
    regions: &'a [Region],
    grid: &'a BackgroundGrid,
    /// 2 or 3.
    components: usize,
    /// Volume of a cell is edge^components × thickness.
    thickness: f64,
    out: Quadrature,
}

/// Lays the grid over the body and collects its points: the seed's "centre
/// inside" rule (section 2.3) or volume fractions with the centroid of the
/// inside part (one point for each region in the cell).
pub fn quadrature(
    body: &Shape,
    regions: &[Region],
    grid: &BackgroundGrid,
    dimension: &Dimension,
) -> Result<Quadrature, Error> {
    let (min, max) = body.bounding_box().ok_or(Error::NoQuadraturePoints)?;
    let (thickness, z) = match *dimension {
        Dimension::Three => (1.0, 0.0),
        Dimension::PlaneStrain { thickness, z } => (thickness, z),
    };
    let components = dimension.components();
    let counts = [0, 1, 2].map(|k| match k < components {
        // A grid that fits exactly must not gain a layer from round-off.
        true => ((max[k] - min[k]) / grid.cell - 1e-9).ceil().max(1.0) as usize,
        false => 1,
    });
    let middle = (min + max) * 0.5;
    let row_of_cells = |row: usize| {
        let mut builder =
            Builder { body, regions, grid, components, thickness, out: Quadrature::default() };
        for i in 0..counts[0] {
            let mut centre = middle;
            for (axis, index) in [i, row % counts[1], row / counts[1]].into_iter().enumerate() {
                centre[axis] += grid.cell * (index as f64 + 0.5 - 0.5 * counts[axis] as f64);
            }
            if components == 2 {
                centre.z = z;
            }
            builder.visit(Cell { centre, edge: grid.cell })?;
        }
        Ok(builder.out)
    };
    let rows: Vec<Result<Quadrature, Error>> =
        (0..counts[1] * counts[2]).into_par_iter().map(row_of_cells).collect();
    let all = join(rows.into_iter().collect::<Result<_, _>>()?);
    if all.positions.is_empty() { Err(Error::NoQuadraturePoints) } else { Ok(all) }
}

/// All parts in their order.
fn join(parts: Vec<Quadrature>) -> Quadrature {
    let mut all = Quadrature::default();
    for part in parts {
        all.positions.extend(part.positions);
        all.weights.extend(part.weights);
        all.regions.extend(part.regions);
        all.cells += part.cells;
        all.cut_cells += part.cut_cells;
    }
    all
}

impl Builder<'_> {
    /// Splits a cell where the grid asks for smaller ones, drops it outside.
    fn visit(&mut self, cell: Cell) -> Result<(), Error> {
        let distance = self.body.signed_distance(&cell.centre);
        let reach = self.half_diagonal(&cell);
        if distance > reach {
            return Ok(());
        }
        let meets_boundary = distance > -reach;
        let too_large = |limit: f64| cell.edge > limit * (1.0 + 1e-9);
        let split = (meets_boundary && self.grid.boundary_cell.is_some_and(too_large))
            || self.grid.refinements.iter().any(|refinement| {
                too_large(refinement.size)
                    && self.samples(&cell).any(|X| refinement.part.contains(&X))
            });
        if split {
            for child in self.children(&cell) {
                self.visit(child)?;
            }
            return Ok(());
        }
        self.leaf(cell, meets_boundary)
    }

    fn leaf(&mut self, cell: Cell, meets_boundary: bool) -> Result<(), Error> {
        let mixed = self.regions.len() > 1 && self.is_mixed(&cell);
        let before = self.out.positions.len();
        match self.grid.inside {
            InsideRule::Centre => {
                if self.body.signed_distance(&cell.centre) > 0.0 {
                    return Ok(());
                }
                self.whole(&cell)?;
            }
            InsideRule::VolumeFraction if meets_boundary || mixed => self.parts(&cell)?,
            InsideRule::VolumeFraction => self.whole(&cell)?,
        }
        if self.out.positions.len() > before {
            self.out.cells += 1;
            self.out.cut_cells += (meets_boundary || mixed) as usize;
        }
        Ok(())
    }

    /// Gauss–Legendre points of a cell that is kept whole.
    fn whole(&mut self, cell: &Cell) -> Result<(), Error> {
        let rule = gauss_legendre(self.grid.gauss_points);
        let layers: &[(f64, f64)] = if self.components == 3 { &rule } else { &[(0.0, 1.0)] };
        for &(z, wz) in layers {
            for &(y, wy) in &rule {
                for &(x, wx) in &rule {
                    let X = cell.centre + Vector3::new(x, y, z) * cell.edge;
                    let weight = self.volume(cell) * wx * wy * wz;
                    self.push(X, weight, self.region_at(&X)?);
                }
            }
        }
        Ok(())
    }

    /// One point per sub-box and region at the centroid of what lies inside.
    fn parts(&mut self, cell: &Cell) -> Result<(), Error> {
        let depth = if self.components == 2 { FRACTION_DEPTH_PLANE } else { FRACTION_DEPTH };
        for part in cell.divide(self.grid.gauss_points, self.components) {
            let mut moments = vec![(0.0, Vector3::zeros()); self.regions.len()];
            self.measure(&part, depth, &mut moments)?;
            for (region, (volume, moment)) in moments.into_iter().enumerate() {
                if volume > SMALLEST_FRACTION * self.volume(&part) {
                    self.push(moment / volume, volume, region as u16);
                }
            }
        }
        Ok(())
    }

    /// Adds the inside volume of a cell and its first moment, by region: halves it
    /// where the boundary is not flat, and at last takes it for flat.
    fn measure(
        &self,
        cell: &Cell,
        depth: usize,
        moments: &mut [(f64, Vector3)],
    ) -> Result<(), Error> {
        let distance = self.body.signed_distance(&cell.centre);
        let reach = self.half_diagonal(cell);
        if distance > reach {
            return Ok(());
        }
        let cut = distance > -reach;
        let mixed = depth > 0 && self.regions.len() > 1 && self.is_mixed(cell);
        let one_plane = match (cut, mixed) {
            (false, false) => Some((1.0, Vector3::zeros())),
            (true, false) if depth > 0 => self.flat_cut(cell, distance),
            _ => None,
        };
        let (fraction, shift) = match one_plane {
            Some(part) => part,
            None if depth > 0 => {
                return self
                    .children(cell)
                    .try_for_each(|child| self.measure(&child, depth - 1, moments));
            }
            None => self.axis_cut(cell, distance),
        };
        if fraction > 0.0 {
            let volume = fraction * self.volume(cell);
            let centroid = cell.centre + shift;
            let region = self.region_at(&centroid)? as usize;
            moments[region].0 += volume;
            moments[region].1 += centroid * volume;
        }
        Ok(())
    }

    /// Inside fraction of a cell and the shift of its centroid where the boundary is
    /// flat, as far as the signed distance at centre and corners tells.
    fn flat_cut(&self, cell: &Cell, distance: f64) -> Option<(f64, Vector3)> {
        let near = |value: f64| value.abs() <= FLAT * cell.edge;
        let half = 0.5 * cell.edge;
        let ends: &[[f64; 3]] = match self.components {
            2 => &[[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]],
            _ => &[[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [1.0, -1.0, -1.0]],
        };
        let mut rises = [0.0; 4];
        let mut slope = Vector3::zeros();
        for (rise, end) in rises.iter_mut().zip(ends) {
            let end = Vector3::from(*end);
            let ahead = self.body.signed_distance(&(cell.centre + half * end));
            let behind = self.body.signed_distance(&(cell.centre - half * end));
            if !near(ahead + behind - 2.0 * distance) {
                return None;
            }
            *rise = 0.5 * (ahead - behind);
            slope += end * *rise;
        }
        // Half the change of the distance along each edge.
        slope /= ends.len() as f64;
        let straight =
            rises.iter().zip(ends).all(|(rise, end)| near(slope.dot(&Vector3::from(*end)) - rise));
        straight.then(|| {
            let (fraction, shift) = cut::cut(distance, &(2.0 * slope));
            (fraction, shift * cell.edge)
        })
    }

    /// Inside fraction of a small cell and the shift of its centroid, as if
    /// the boundary were a plane whose normal is the nearest axis: exact for
    /// boundaries along the grid, second order in the sub-cell for others.
    fn axis_cut(&self, cell: &Cell, distance: f64) -> (f64, Vector3) {
        let fraction = (0.5 - distance / cell.edge).clamp(0.0, 1.0);
        if fraction == 0.0 || fraction == 1.0 {
            return (fraction, Vector3::zeros());
        }
        let mut normal = self.body.gradient(&cell.centre);
        if self.components == 2 {
            normal.z = 0.0;
        }
        let axis = normal.iamax();
        let mut shift = Vector3::zeros();
        shift[axis] = -normal[axis].signum() * 0.5 * (1.0 - fraction) * cell.edge;
        (fraction, shift)
    }

    fn push(&mut self, X: Vector3, weight: f64, region: u16) {
        self.out.positions.push(X);
        self.out.weights.push(weight);
        self.out.regions.push(region);
    }

    fn region_at(&self, X: &Vector3) -> Result<u16, Error> {
        let found = self.regions.iter().position(|region| region.part.contains(X));
        found.map(|index| index as u16).ok_or(Error::PointWithoutRegion { position: *X })
    }

    /// Whether the sample points of a cell belong to more than one region.
    fn is_mixed(&self, cell: &Cell) -> bool {
        let owner = |X: &Vector3| self.regions.iter().position(|region| region.part.contains(X));
        let at_centre = owner(&cell.centre);
        self.samples(cell).any(|X| owner(&X) != at_centre)
    }

    /// Centre and corners, the corners drawn in by a hair so that neighbours
    /// along a shared face do not claim each other's region.
    fn samples(&self, cell: &Cell) -> impl Iterator<Item = Vector3> + use<> {
        let corner = Cell { centre: cell.centre, edge: 2.0 * cell.edge * (1.0 - 1e-6) };
        self.children(&corner).map(|child| child.centre).chain([cell.centre])
    }

    fn children(&self, cell: &Cell) -> impl Iterator<Item = Cell> + use<> {
        cell.divide(2, self.components)
    }

    fn half_diagonal(&self, cell: &Cell) -> f64 {
        0.5 * cell.edge * (self.components as f64).sqrt()
    }

    fn volume(&self, cell: &Cell) -> f64 {
        cell.edge.powi(self.components as i32) * self.thickness
    }
}

/// Points in (−½, ½) and weights that sum to 1, for 1 to 5 points.
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let half: &[(f64, f64)] = match n {
        1 => &[(0.0, 2.0)],
        2 => &[(0.577_350_269_189_625_8, 1.0)],
        3 => &[(0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)],
        4 => &[
            (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
            (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
        ],
        _ => &[
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
            (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        ],
    };
    let mut rule = Vec::new();
    for &(x, weight) in half {
        if x > 0.0 {
            rule.push((-0.5 * x, 0.5 * weight));
        }
        rule.push((0.5 * x, 0.5 * weight));
    }
    rule
}

#[cfg(test)]
mod tests;
