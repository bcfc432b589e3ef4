//! Panels of plane curves; their areas are lengths.

use crate::algebra::tensor::Vector3;
use crate::geometry::boundary::panel::{Panel, pieces};
use crate::geometry::boundary::patch::{Chart, Patch};
use std::f64::consts::TAU;

/// Along a closed polyline with the solid to its left.
pub(super) fn line_patches(points: &[[f64; 2]], size: f64, z: f64) -> Vec<Patch> {
    (0..points.len())
        .flat_map(|n| segment_patches(points[n], points[(n + 1) % points.len()], size, z))
        .collect()
}

pub(super) fn segment_patches(
    a: [f64; 2],
    b: [f64; 2],
    size: f64,
    z: f64,
) -> impl Iterator<Item = Patch> {
    let edge = Vector3::new(b[0] - a[0], b[1] - a[1], 0.0);
    let length = edge.norm();
    let normal = Vector3::new(edge.y, -edge.x, 0.0) / length;
    let count = if length > 0.0 { pieces(length, size) } else { 0 };
    (0..count).map(move |piece| {
        let t = (piece as f64 + 0.5) / count as f64;
        let start = Vector3::new(a[0], a[1], z);
        let panel = Panel::flat(start + t * edge, length / count as f64, normal);
        let from = start + piece as f64 / count as f64 * edge;
        Patch::square(panel, Chart::Line { from, edge: edge / count as f64 })
    })
}

pub(super) fn ellipse_patches(centre: &Vector3, radii: &Vector3, size: f64, z: f64) -> Vec<Patch> {
    let count = pieces(TAU * radii.x.max(radii.y), size).max(8);
    let step = TAU / count as f64;
    (0..count)
        .map(|n| {
            let (sin, cos) = ((n as f64 + 0.5) * step).sin_cos();
            let weighted = Vector3::new(radii.y * cos, radii.x * sin, 0.0);
            let at = Vector3::new(centre.x + radii.x * cos, centre.y + radii.y * sin, z);
            let centre = Vector3::new(centre.x, centre.y, z);
            let angle = (n as f64 * step, (n as f64 + 1.0) * step);
            Patch::square(
                Panel::flat(at, weighted.norm() * step, weighted.normalize()),
                Chart::Arc { centre, radii: *radii, angle },
            )
        })
        .collect()
}
