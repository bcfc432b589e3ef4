//! Seams: faces in which members of a body touch. The distance is 0 there, with material on both
//! sides.

use super::simplex::vector_area;
use super::surface::Facet;
use crate::algebra::tensor::Vector3;
use crate::geometry::Shape;

/// Looks beside a facet, and what of a distance there is round-off, over its size \[–\].
const BESIDE: f64 = 1e-3;
const ROUND_OFF: f64 = 1e-6;

/// Whether members of a body may touch.
pub(super) fn may_have_seams(shape: &Shape) -> bool {
    match shape {
        Shape::Union(members) => members.len() > 1 || members.iter().any(may_have_seams),
        Shape::Intersection(members) => members.iter().any(may_have_seams),
        Shape::Difference(body, _) => may_have_seams(body),
        _ => false,
    }
}

/// Whether a facet lies in a seam, by the signed distance \[m\] at a place \[m\].
pub(super) fn is_seam(facet: &Facet, distance: impl Fn(&Vector3) -> f64) -> bool {
    let area = vector_area(&facet.corners);
    let size = area.norm().sqrt();
    let Some(normal) = area.try_normalize(0.0) else { return false };
    let at = |way: f64| distance(&(facet.centre() + way * size * normal));
    at(0.0).abs() <= ROUND_OFF * size && at(BESIDE) < 0.0 && at(-BESIDE) < 0.0
}
