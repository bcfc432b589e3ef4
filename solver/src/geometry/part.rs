//! The part of a boundary that a selection covers, cut at the outline of the selection.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::{Level, Panel, Patch};
use crate::geometry::dimension::Dimension;
use crate::geometry::error::GeometryError;
use crate::geometry::selection::Selector;
use crate::geometry::shape::Shape;
use rayon::prelude::*;

/// What a selection covers of one panel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CoveredPanel {
    /// The panel among those of the whole boundary.
    pub index: usize,
    /// \[–\]; 1 where all of it is covered.
    pub fraction: f64,
    /// What is covered, with its true resultant.
    pub panel: Panel,
}

/// Halvings of a panel that the outline of a selection cuts: at first, those added while the
/// part is too small for them, and at most.
const HALVINGS: usize = 7;
const MORE: usize = 4;
const DEEPEST: usize = 15;
/// The smallest pieces, at corners of an outline, are at most this fraction of a part \[–\].
const RESOLVED: f64 = 5e-4;
/// A smaller fraction of a panel is not covered \[–\].
const NOTHING: f64 = 1e-9;
/// Tolerances up to this fraction of a panel are there for round-off \[–\].
const THIN: f64 = 0.01;

impl Shape {
    /// The panels, of at most `size` \[m\], that a selection covers, as far as it does.
    pub(crate) fn covered_panels(
        &self,
        part: &Selector,
        size: f64,
        dimension: &Dimension,
    ) -> Result<Vec<CoveredPanel>, GeometryError> {
        let patches = self.boundary_patches(size, dimension)?;
        let thickness = dimension.thickness();
        let mut halvings = HALVINGS;
        loop {
            let cover = |(index, patch): (usize, &Patch)| {
                let at = |X: &Vector3, normal: &dyn Fn() -> Vector3| {
                    part.level(X, Some(&normal()), THIN * size)
                };
                let level = Level { at: &at, steepness: part.steepness(patch.is_flat()) };
                let (piece, fraction) = patch.cut(&level, halvings, NOTHING)?;
                let panel = piece.exact().panel;
                let panel = Panel { area: panel.area * thickness, ..panel };
                Some(CoveredPanel { index, fraction, panel })
            };
            let found: Vec<CoveredPanel> =
                patches.par_iter().enumerate().filter_map(cover).collect();
            let area: f64 = found.iter().map(|covered| covered.panel.area).sum();
            let edge = size / f64::powi(2.0, halvings as i32);
            let smallest = thickness * edge.powi(dimension.components() as i32 - 1);
            let is_steady = part.steepness(true).is_finite();
            if smallest <= RESOLVED * area || halvings >= DEEPEST || !is_steady {
                return Ok(found);
            }
            halvings += MORE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const SPACE: Dimension = Dimension::Three;

    fn inside(shape: Shape) -> Selector {
        Selector::Inside { shape, tolerance: 5e-5 }
    }

    fn area(covered: &[CoveredPanel]) -> f64 {
        covered.iter().map(|covered| covered.panel.area).sum()
    }

    fn resultant(covered: &[CoveredPanel]) -> Vector3 {
        covered.iter().map(|covered| covered.panel.area * covered.panel.mean_normal()).sum()
    }

    fn assert_close(found: f64, exact: f64, tolerance: f64, what: &str) {
        assert!((found / exact - 1.0).abs() < tolerance, "{what}: {found} of {exact}");
    }

    #[test]
    fn squares_and_discs_of_any_size_on_a_face_have_their_area() {
        let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(1.0) };
        let size = 0.05;
        for edge in [0.5, 0.21, 0.1, 0.06, 0.04, 0.01, 0.002, 1e-4] {
            for middle in [[0.5, 0.5], [0.513, 0.472], [0.55, 0.461]] {
                let centre = Vector3::new(middle[0], middle[1], 1.0);
                let reach = Vector3::repeat(0.5 * edge);
                let square = Shape::Box { min: centre - reach, max: centre + reach };
                let covered = body.covered_panels(&inside(square), size, &SPACE).unwrap();
                assert_close(area(&covered), edge * edge, 1e-3, "square");
                let ball = Shape::Sphere { centre, radius: 0.5 * edge };
                let covered = body.covered_panels(&inside(ball), size, &SPACE).unwrap();
                assert_close(area(&covered), 0.25 * PI * edge * edge, 1e-3, "disc");
            }
        }
    }

    #[test]
    fn a_face_is_covered_in_whole_panels_and_its_neighbours_not_at_all() {
        let body = Shape::Box { min: Vector3::zeros(), max: Vector3::repeat(1.0) };
        let face =
            Selector::Plane { point: Vector3::zeros(), normal: Vector3::z(), tolerance: 5e-5 };
        let covered = body.covered_panels(&face, 0.05, &SPACE).unwrap();
        assert!(covered.len() == 400 && covered.iter().all(|covered| covered.fraction == 1.0));
        let others = Selector::Not(Box::new(face));
        let covered = body.covered_panels(&others, 0.05, &SPACE).unwrap();
        assert!(covered.len() == 2000 && covered.iter().all(|covered| covered.fraction == 1.0));
    }

    #[test]
    fn half_a_hollow_ball_has_the_resultants_of_its_rims_at_every_size() {
        let ball = |radius: f64| Shape::Sphere { centre: Vector3::zeros(), radius };
        let plane = Shape::HalfSpace { point: Vector3::zeros(), normal: -Vector3::z() };
        let half = Shape::Intersection(vec![ball(1.0), plane]);
        let body = Shape::Difference(Box::new(half), Box::new(ball(0.5)));
        let cut =
            Selector::Plane { point: Vector3::zeros(), normal: Vector3::z(), tolerance: 5e-5 };
        for size in [0.25, 0.125, 0.06] {
            let hole = Selector::Inside { shape: ball(0.5), tolerance: 0.05 };
            let wall = Selector::Intersection(vec![hole, Selector::Not(Box::new(cut.clone()))]);
            let covered = body.covered_panels(&wall, size, &SPACE).unwrap();
            assert_close(-resultant(&covered).z, 0.25 * PI, 1e-3, "wall");
            assert_close(area(&covered), 0.5 * PI, 2e-3, "area of the wall");
            let covered = body.covered_panels(&cut, size, &SPACE).unwrap();
            assert_close(-resultant(&covered).z, 0.75 * PI, 1e-3, "cut");
        }
    }

    #[test]
    fn a_cap_that_faces_a_direction_has_its_area_and_resultant() {
        let body = Shape::Sphere { centre: Vector3::zeros(), radius: 1.0 };
        let direction = Vector3::new(1.0, 2.0, -2.0) / 3.0;
        let whole = Box::new(body.clone());
        for angle in [0.2, 0.5, 0.5 * PI] {
            let cap = Selector::Facing { body: whole.clone(), direction, angle };
            let covered = body.covered_panels(&cap, 0.25, &SPACE).unwrap();
            assert_close(area(&covered), 2.0 * PI * (1.0 - angle.cos()), 2e-3, "cap");
            let exact = PI * angle.sin().powi(2);
            assert_close(resultant(&covered).dot(&direction), exact, 2e-3, "resultant");
        }
    }

    #[test]
    fn a_part_of_an_outline_has_its_length() {
        let plane = Dimension::PlaneStrain { thickness: 0.5, z: 0.0 };
        let disc = Shape::Ellipsoid {
            centre: Vector3::zeros(),
            radii: Vector3::new(1.0, 1.0, f64::INFINITY),
        };
        for x in [-0.9, 0.0, 0.37, 0.99] {
            let side = Shape::HalfSpace { point: Vector3::x() * x, normal: -Vector3::x() };
            let covered = disc.covered_panels(&inside(side), 0.2, &plane).unwrap();
            assert_close(area(&covered), f64::acos(x), 1e-3, "arc");
            assert_close(resultant(&covered).x, (1.0 - x * x).sqrt(), 1e-3, "resultant");
        }
    }
}
