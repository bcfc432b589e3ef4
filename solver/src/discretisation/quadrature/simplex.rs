//! Tetrahedra, in a plane triangles, cut where a level changes its sign.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};
use crate::discretisation::quadrature::cell::Cell;

/// Corners \[m\]; in a plane the first three count.
#[derive(Clone, Copy)]
pub(super) struct Simplex {
    corners: [Vector3; 4],
    /// 3 or 4.
    count: usize,
}

/// Corner 0, two or one between, and the corner across: bit n of a corner is axis n.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];
const TRIANGLES: [[usize; 4]; 2] = [[0, 1, 3, 3], [0, 3, 2, 2]];

impl Simplex {
    /// Those that make up a cell.
    pub fn of_cell(cell: &Cell, components: usize) -> Vec<Simplex> {
        Simplex::of_box(&cell.centre, &Vector3::repeat(cell.edge), components)
    }

    /// Those that make up a box.
    pub fn of_box(centre: &Vector3, edges: &Vector3, components: usize) -> Vec<Simplex> {
        let unit = Cell { centre: Vector3::zeros(), edge: 1.0 };
        let corners: Vec<Vector3> =
            unit.corners(components).map(|corner| centre + corner.component_mul(edges)).collect();
        let numbers: &[[usize; 4]] = if components == 3 { &TETRAHEDRA } else { &TRIANGLES };
        let simplex = |numbers: &[usize; 4]| Simplex {
            corners: numbers.map(|n| corners[n]),
            count: components + 1,
        };
        numbers.iter().map(simplex).collect()
    }

    /// The parts where the level is at most 0, and where it is more, if it is linear.
    pub fn split(
        self,
        level: &impl Fn(&Vector3) -> f64,
        low: &mut Vec<Simplex>,
        high: &mut Vec<Simplex>,
    ) {
        let values = self.corners.map(|X| level(&X));
        self.split_by(values, low, high);
    }

    fn split_by(self, values: [f64; 4], low: &mut Vec<Simplex>, high: &mut Vec<Simplex>) {
        let own = &values[..self.count];
        let below = own.iter().position(|&value| value < 0.0);
        let above = own.iter().position(|&value| value > 0.0);
        let (Some(i), Some(j)) = (below, above) else {
            if above.is_none() {
                low.push(self)
            } else {
                high.push(self)
            }
            return;
        };
        let s = values[i] / (values[i] - values[j]);
        let crossing = self.corners[i] + s * (self.corners[j] - self.corners[i]);
        for corner in [i, j] {
            let (mut part, mut values) = (self, values);
            (part.corners[corner], values[corner]) = (crossing, 0.0);
            part.split_by(values, low, high);
        }
    }

    /// Volume \[m³\], in a plane area \[m²\].
    pub fn size(&self) -> f64 {
        let [a, b, c, d] = self.corners;
        let base = (b - a).cross(&(c - a));
        if self.count == 4 { base.dot(&(d - a)).abs() / 6.0 } else { 0.5 * base.norm() }
    }

    /// Centroid \[m\] and second moments about it over the size \[m²\].
    pub fn moments(&self) -> (Vector3, Matrix3) {
        let corners = &self.corners[..self.count];
        let n = self.count as f64;
        let centroid = corners.iter().sum::<Vector3>() / n;
        let square = |X: &Vector3| (X - centroid) * (X - centroid).transpose();
        (centroid, corners.iter().map(square).sum::<Matrix3>() / (n * (n + 1.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discretisation::quadrature::cut::cut;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_parts_of_a_cut_cube_have_the_volume_and_centroid_of_the_cut(
            slope in prop::array::uniform3(-1.0..1.0f64),
            level in -1.0..1.0f64,
        ) {
            let slope = Vector3::from(slope);
            let cell = Cell { centre: Vector3::zeros(), edge: 1.0 };
            let (mut low, mut high) = (Vec::new(), Vec::new());
            for simplex in Simplex::of_cell(&cell, 3) {
                simplex.split(&|X: &Vector3| level + slope.dot(X), &mut low, &mut high);
            }
            let size = |parts: &[Simplex]| parts.iter().map(Simplex::size).sum::<f64>();
            let (volume, centroid) = cut(level, &slope);
            prop_assert!((size(&low) - volume).abs() < 1e-12);
            prop_assert!((size(&low) + size(&high) - 1.0).abs() < 1e-12);
            let first = low.iter().map(|part| part.size() * part.moments().0).sum::<Vector3>();
            prop_assert!((first - volume * centroid).norm() < 1e-12);
        }
    }

    #[test]
    fn the_parts_of_a_square_have_its_second_moments() {
        let cell = Cell { centre: Vector3::new(0.3, 0.2, 0.1), edge: 2.0 };
        let parts = Simplex::of_cell(&cell, 2);
        let second = parts.iter().map(|part| {
            let (X, own) = part.moments();
            let offset = X - cell.centre;
            part.size() * (own + offset * offset.transpose())
        });
        let expected = Matrix3::from_diagonal(&Vector3::new(4.0, 4.0, 0.0)) / 3.0;
        assert!((second.sum::<Matrix3>() - expected).norm() < 1e-12);
    }
}
