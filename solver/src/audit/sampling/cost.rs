//! What a look at a shape costs.

use crate::geometry::{Selector, Shape};

/// Cost of a signed distance of a shape that is no primitive, over that of one that is \[–\].
const OF_LABELS: usize = 1;
const OF_TRIANGLES: usize = 40;
const OF_COSTLY: usize = 8;
/// The same of a part without distances, which is asked at many places of a cell.
const OF_PLACES: usize = 4;

/// Signed distances of a primitive that take as long as one of a shape.
pub(super) fn cost(shape: &Shape) -> usize {
    match shape {
        Shape::Union(members) | Shape::Intersection(members) => members.iter().map(cost).sum(),
        Shape::Difference(body, hole) => cost(body) + cost(hole),
        Shape::Labels(_) => OF_LABELS,
        Shape::Surface(_) | Shape::Function(_) => OF_TRIANGLES,
        _ => 1,
    }
}

/// What may be spent on a body over what is spent on a primitive \[–\]: its set-up takes longer by more.
pub(super) fn times(shape: &Shape) -> usize {
    if cost(shape) >= OF_TRIANGLES { OF_COSTLY } else { 1 }
}

/// The same of a part.
pub(super) fn cost_of(part: &Selector) -> usize {
    match part {
        Selector::Inside { shape, .. } => cost(shape),
        Selector::Union(parts) | Selector::Intersection(parts) => parts.iter().map(cost_of).sum(),
        Selector::Not(part) => cost_of(part),
        Selector::All | Selector::Plane { .. } => 0,
        Selector::Label { .. } => OF_PLACES,
        Selector::Facing { .. } => 1,
    }
}
