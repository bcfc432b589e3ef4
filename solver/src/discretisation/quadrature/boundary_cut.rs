//! Cells that the boundary cuts as a plane (method book, eqs. 7.3 and 7.4).
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::quadrature::cell::{Cell, in_plane};
use crate::discretisation::quadrature::cut::{NEARLY_FLAT, cut, spread};
use crate::geometry::Shape;

/// The boundary is flat in a cell where the signed distance differs by less than this
/// fraction of its edge from that of a plane \[–\].
const FLAT: f64 = 1e-9;
/// Components of a normal that differ by less are equal: it comes from differences \[–\].
const TIE: f64 = 1e-3;

/// The middle of what lies behind a plane is half its depth inside; behind a face without an inside
/// it is as much outside, and counts as that from here on \[depth\].
const MIRRORED: f64 = 0.25;

/// The part of a cell inside of a body.
pub(super) struct BoundaryCut<'a> {
    pub body: &'a Shape,
    /// 2 or 3.
    pub components: usize,
    /// Whether the spread of a cut cell is needed, since points are moved afterwards.
    pub has_spread: bool,
}

impl BoundaryCut<'_> {
    /// Inside fraction of a cell, the shift of its centroid and its spread where the
    /// boundary is nearly flat, judged by the signed distance at centre and corners (method
    /// book, eq. 7.3).
    pub fn flat(&self, cell: &Cell, distance: f64) -> Option<(f64, Vector3, Matrix3)> {
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
            let spread = if self.has_spread {
                spread(level, &(2.0 * slope)) * cell.edge.powi(2)
            } else {
                Matrix3::zeros()
            };
            (fraction, shift * cell.edge, in_plane(spread, self.components))
        })
    }

    /// Inside fraction of a small cell, the shift of its centroid and its spread, as if
    /// the boundary were a plane whose normal is the nearest axis: exact for
    /// boundaries along the grid, second order in the cell for others (method
    /// book, eq. 7.4).
    pub fn along_axes(&self, cell: &Cell, distance: f64) -> (f64, Vector3, Matrix3) {
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
        // Where a hole ends in a face of its body, neither side of the face is inside.
        let beyond = self.body.signed_distance(&(cell.centre + shift));
        if beyond > MIRRORED * fraction * cell.edge && self.is_outside(cell) {
            return (0.0, Vector3::zeros(), spread);
        }
        (fraction, shift, spread)
    }

    /// Whether all corners of a cell are: at an edge of the body one is not.
    fn is_outside(&self, cell: &Cell) -> bool {
        let mut corners = cell.corners(self.components);
        corners.all(|X| self.body.signed_distance(&X) > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_at_an_edge_counts_and_one_in_the_mouth_of_a_hole_does_not() {
        let box_of = |min: [f64; 3], max: [f64; 3]| Shape::Box { min: min.into(), max: max.into() };
        let plate = box_of([-9.0, -9.0, -2.0], [9.0, 9.0, 0.0]);
        let hole = box_of([-5.0, -5.0, -2.0], [5.0, 5.0, 0.0]);
        let bored = Shape::Difference(Box::new(plate.clone()), Box::new(hole));
        let fraction = |body: &Shape, centre: [f64; 3]| {
            let cell = Cell { centre: centre.into(), edge: 1.0 };
            let cut = BoundaryCut { body, components: 3, has_spread: false };
            cut.along_axes(&cell, body.signed_distance(&cell.centre)).0
        };
        let at_edge = fraction(&plate, [9.2, 3.0, 0.19]);
        assert!((at_edge - (0.5 - 0.2f64.hypot(0.19))).abs() < 1e-12, "{at_edge}");
        assert_eq!(fraction(&bored, [9.2, 3.0, 0.19]), at_edge);
        for z in [-0.3, -0.1, 0.1, 0.3] {
            assert_eq!(fraction(&bored, [1.0, -2.0, z]), 0.0, "{z}");
        }
    }
}
