//! Panels of label maps whose voxels are small beside the panels (method book, section 4).
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::marching::isosurface_by_cubes;
use crate::geometry::boundary::panel::Panel;
use crate::geometry::boundary::patch::{Chart, Patch};
use crate::geometry::error::GeometryError;
use crate::geometry::primitives::perpendicular;
use crate::geometry::shape::Shape;
use crate::geometry::triangles::{Triangle, area_vector};
use crate::geometry::voxels::{LabelField, SurfacePiece};
use std::sync::Arc;

/// Panels may be shifted along their normal by this much to keep the volume \[size\].
const LARGEST_SHIFT: f64 = 0.5;
/// Cubes whose middle lies on a border of larger ones, but for round-off, belong to the lower.
const ROUND_OFF: f64 = 1e-9;

/// Whether panels of edge `size` \[m\] are made of the pieces of the surface in the voxels: these
/// are smaller than the triangles would be.
pub(crate) fn merges_voxels(field: &LabelField, size: f64) -> bool {
    field.voxel() < size / 3_f64.sqrt()
}

/// One panel for the surface in each cube of edge `size` \[m\] that faces the same way along the
/// same axis. Vector areas and the volume that they enclose are those of the surface, so that the
/// banks of a fold, which face each other, stay apart.
pub(super) fn voxel_patches(
    shape: &Shape,
    field: &LabelField,
    size: f64,
) -> Result<Vec<Patch>, GeometryError> {
    let pieces = match field.surface().get() {
        Some(pieces) => pieces.clone(),
        None => {
            let pieces = Arc::new(pieces_in_voxels(shape, field)?);
            field.surface().get_or_init(|| pieces).clone()
        }
    };
    let larger =
        |cube: u32| ((f64::from(cube) + 0.5) * field.voxel() / size * (1.0 - ROUND_OFF)) as u32;
    let key = |piece: &SurfacePiece| {
        let [i, j, k] = piece.cube.map(larger);
        (k, j, i, piece.facing)
    };
    // In the order of the pieces within each cube, whatever the number of threads.
    let mut sorted: Vec<(_, u32)> = pieces.iter().map(key).zip(0..).collect();
    sorted.sort_unstable();
    let (lower, _) = field.bounding_box();
    let merged = sorted.chunk_by(|a, b| a.0 == b.0).map(|chunk| {
        let own = chunk.iter().map(|(_, at)| pieces[*at as usize]);
        patch(own.reduce(SurfacePiece::joined)?, size, &lower)
    });
    Ok(merged.flatten().collect())
}

/// The surface within each voxel, by the way that it faces; positions from the lower corner of
/// the bounding box.
fn pieces_in_voxels(shape: &Shape, field: &LabelField) -> Result<Vec<SurfacePiece>, GeometryError> {
    let (lower, _) = field.bounding_box();
    let see = |cube: [usize; 3], triangles: &mut Vec<Triangle>, out: &mut Vec<SurfacePiece>| {
        let first = out.len();
        for triangle in triangles.drain(..) {
            let piece = piece(cube, &triangle, &lower);
            match out[first..].iter_mut().find(|known| known.facing == piece.facing) {
                Some(known) => *known = known.joined(piece),
                None => out.push(piece),
            }
        }
    };
    Ok(isosurface_by_cubes(shape, field.voxel(), see)?.concat())
}

fn piece(cube: [usize; 3], triangle: &Triangle, lower: &Vector3) -> SurfacePiece {
    let vector_area = area_vector(triangle);
    let (area, axis) = (vector_area.norm(), vector_area.iamax());
    let centre = (triangle[0] + triangle[1] + triangle[2]) / 3.0 - lower;
    SurfacePiece {
        cube: cube.map(|index| index as u32),
        facing: 2 * axis as u8 + u8::from(vector_area[axis] > 0.0),
        vector_area,
        area,
        first_moment: area * centre,
        threefold_volume: centre.dot(&vector_area),
    }
}

/// At the centroid but for a shift along the normal, with which X·N A is that of the piece. A
/// load ends within it as within a square of its resultant.
fn patch(piece: SurfacePiece, size: f64, lower: &Vector3) -> Option<Patch> {
    let length = piece.vector_area.norm();
    let normal = piece.vector_area.try_normalize(0.0)?;
    let centroid = piece.first_moment / piece.area;
    let most = LARGEST_SHIFT * size;
    let shift = (piece.threefold_volume / length - centroid.dot(&normal)).clamp(-most, most);
    let centre = lower + centroid + shift * normal;
    let (u, v) = perpendicular(&normal);
    let edge = length.sqrt();
    let corner = centre - 0.5 * edge * (u + v);
    let panel = Panel { centre, area: piece.area, normal, flatness: length / piece.area };
    Some(Patch::square(panel, Chart::Flat { corner, u: edge * u, v: edge * v }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::tensor::Matrix3;
    use crate::geometry::Dimension;
    use crate::geometry::voxels::LabelMap;

    /// The solid of the voxels of 1 mm whose centres \[mm\] from the middle satisfy `is_in`.
    fn solid(half: i64, is_in: impl Fn([f64; 3]) -> bool) -> Shape {
        let n = (2 * half + 1) as usize;
        let at = |index: usize| index as f64 - half as f64;
        let label = |v: usize| u32::from(is_in([at(v % n), at(v / n % n), at(v / (n * n))]));
        let labels = (0..n * n * n).map(label).collect();
        let origin = Vector3::repeat(-1e-3 * half as f64);
        let directions = Matrix3::from_diagonal_element(1e-3);
        let map = Arc::new(LabelMap::new([n; 3], origin, directions, labels).unwrap());
        Shape::Labels(Arc::new(LabelField::new(map, &[1], LabelField::SMOOTHING).unwrap()))
    }

    fn panels(shape: &Shape, size: f64) -> Vec<Panel> {
        shape.boundary_panels(size, &Dimension::Three).unwrap()
    }

    #[test]
    fn the_panels_of_a_ball_of_small_voxels_close_and_enclose_its_volume_at_any_size() {
        let radius = 20.0;
        let ball = solid(24, |[x, y, z]| x * x + y * y + z * z < radius * radius);
        let area = 4.0 * std::f64::consts::PI * (1e-3 * radius).powi(2);
        let volume = area * 1e-3 * radius / 3.0;
        for size in [2e-3, 4e-3, 8e-3] {
            let panels = panels(&ball, size);
            let vector: Vector3 = panels.iter().map(|p| p.area * p.mean_normal()).sum();
            assert!(vector.norm() < 1e-12 * area, "{size}: {vector}");
            let enclosed: f64 =
                panels.iter().map(|p| p.area * p.mean_normal().dot(&p.centre) / 3.0).sum();
            // Triangles between voxels are chords of the ball: 0.6 % are missing.
            assert!((enclosed / volume - 1.0).abs() < 0.01, "{size}: {enclosed} of {volume}");
            let sum: f64 = panels.iter().map(|p| p.area).sum();
            assert!((0.93..1.03).contains(&(sum / area)), "{size}: {sum} of {area}");
            let most = 6.0 * area / (size * size);
            assert!((panels.len() as f64) < most, "{size}: {} of {most}", panels.len());
        }
    }

    #[test]
    fn banks_of_a_fold_within_one_panel_keep_their_areas() {
        // Two plates with a gap of 3 mm, which panels of 10 mm have on both sides.
        let plates = solid(16, |[x, y, z]| {
            x.abs() < 12.0 && y.abs() < 12.0 && (2.0..7.0).contains(&z.abs())
        });
        let area = |size: f64, facing: f64| -> f64 {
            let along = |p: &Panel| (facing * p.area * p.mean_normal().z).max(0.0);
            panels(&plates, size).iter().map(along).sum()
        };
        for facing in [-1.0, 1.0] {
            let (fine, coarse) = (area(1.8e-3, facing), area(10e-3, facing));
            // Half of the rounded edges belongs to panels of the sides.
            assert!((coarse / fine - 1.0).abs() < 0.06, "{facing}: {coarse} of {fine}");
        }
    }

    #[test]
    fn a_label_map_at_another_place_has_the_same_boundary_points_though_spacings_divide_it() {
        let block = |origin: Vector3| {
            let labels = (0..44 * 36 * 28).map(|v| {
                let [i, j, k] = [v % 44, v / 44 % 36, v / (44 * 36)];
                let is_in = (2..42).contains(&i) && (2..34).contains(&j) && (2..26).contains(&k);
                u32::from(is_in)
            });
            let directions = Matrix3::from_diagonal_element(1e-3);
            let map = LabelMap::new([44, 36, 28], origin, directions, labels.collect()).unwrap();
            let field = LabelField::new(Arc::new(map), &[1], LabelField::SMOOTHING).unwrap();
            let points = Shape::Labels(Arc::new(field)).boundary_points(8e-3, &Dimension::Three);
            points.unwrap()
        };
        let first = block(Vector3::zeros());
        for shift in [0.1, 1.0 / 3.0, -7.77] {
            let shift = Vector3::new(shift, 0.3 * shift, -2.0 * shift);
            let second = block(shift);
            assert_eq!(first.len(), second.len(), "{shift}");
            for (X, Y) in first.iter().zip(&second) {
                assert!((Y - shift - X).norm() < 1e-9, "{X} {Y}");
            }
        }
    }
}
