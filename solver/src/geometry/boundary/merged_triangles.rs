//! Panels of surfaces whose triangles are small beside the panels (method book, section 4).
#![allow(non_snake_case)]

use crate::algebra::tensor::{Vector3, bounding_box};
use crate::geometry::boundary::patch::Patch;
use crate::geometry::triangles::{Triangle, area_vector, subdivide};

/// Triangles within one panel enclose less than some 30° with its largest: the cosine.
const ALIKE: f64 = 0.866;

/// One patch for the triangles in each cube of edge `size` \[m\] that face about the same way.
/// Vector areas and the volume that they enclose are those of the triangles.
pub(super) fn merged_patches<T: From<Patch>>(
    triangles: impl Iterator<Item = Triangle>,
    size: f64,
) -> Vec<T> {
    let mut pieces: Vec<Triangle> = Vec::new();
    triangles.for_each(|triangle| subdivide(triangle, size, &mut |t| pieces.push(t)));
    let vertices: Vec<Vector3> = pieces.iter().flatten().copied().collect();
    let (lower, _) = bounding_box(&vertices);
    let cube = |t: &Triangle| {
        let middle = (t[0] + t[1] + t[2]) / 3.0 - lower;
        let index = |k: usize| (middle[k] / size) as u32;
        [index(2), index(1), index(0)]
    };
    let mut sorted: Vec<([u32; 3], u32)> = pieces.iter().map(cube).zip(0..).collect();
    sorted.sort_unstable();
    let mut patches = Vec::new();
    for chunk in sorted.chunk_by(|a, b| a.0 == b.0) {
        let mut rest: Vec<(f64, Vector3, Triangle)> =
            chunk.iter().filter_map(|(_, n)| sized(pieces[*n as usize])).collect();
        // Stable, so that equal ones keep their order.
        rest.sort_by(|a, b| b.0.total_cmp(&a.0));
        while let Some(&(_, first, _)) = rest.first() {
            let alike = |(_, normal, _): &(f64, Vector3, Triangle)| normal.dot(&first) > ALIKE;
            let (own, others): (Vec<_>, Vec<_>) = rest.into_iter().partition(alike);
            let facets: Vec<Triangle> = own.into_iter().map(|(_, _, t)| t).collect();
            patches.push(Patch::facets(&facets).into());
            rest = others;
        }
    }
    patches
}

/// A triangle with its area \[m²\] and normal, if it has any.
fn sized(triangle: Triangle) -> Option<(f64, Vector3, Triangle)> {
    let vector = area_vector(&triangle);
    let normal = vector.try_normalize(0.0)?;
    Some((vector.norm(), normal, triangle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Panel;
    use std::f64::consts::{PI, TAU};

    /// A ball of radius 1 of bands of latitude.
    fn ball(bands: usize) -> Vec<Triangle> {
        let at = |i: usize, j: usize| {
            let (polar, angle) = (PI * i as f64 / bands as f64, TAU * j as f64 / bands as f64);
            let ring = polar.sin();
            Vector3::new(ring * angle.cos(), ring * angle.sin(), polar.cos())
        };
        let squares = (0..bands).flat_map(|i| (0..bands).map(move |j| (i, j)));
        let halves = squares.flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        halves.collect()
    }

    #[test]
    fn merged_panels_have_the_vector_area_and_the_volume_of_their_triangles() {
        let triangles = ball(100);
        let volume: f64 = triangles.iter().map(|[a, b, c]| a.dot(&b.cross(c)) / 6.0).sum();
        let area: f64 = triangles.iter().map(|t| area_vector(t).norm()).sum();
        for size in [0.1, 0.3] {
            let panels: Vec<Panel> = merged_patches(triangles.iter().copied(), size);
            assert!((panels.len() as f64) < 6.0 * area / (size * size), "{}", panels.len());
            let sum = |f: &dyn Fn(&Panel) -> f64| panels.iter().map(f).sum::<f64>();
            assert!((sum(&|p| p.area) / area - 1.0).abs() < 1e-12);
            let enclosed = sum(&|p| p.area * p.mean_normal().dot(&p.centre) / 3.0);
            assert!((enclosed / volume - 1.0).abs() < 1e-12, "{enclosed} of {volume}");
            let closed: Vector3 = panels.iter().map(|p| p.area * p.mean_normal()).sum();
            assert!(closed.norm() < 1e-12 * area, "{closed}");
        }
    }
}
