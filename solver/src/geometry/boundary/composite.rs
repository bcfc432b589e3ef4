//! Panels of unions, intersections and differences from those of their members.

use crate::geometry::boundary::panel::Panel;
use crate::geometry::error::GeometryError;
use crate::geometry::shape::Shape;

type PanelsOf<'a> = &'a dyn Fn(&Shape) -> Result<Vec<Panel>, GeometryError>;

/// Which panels of one member remain, depending on where they lie on another.
#[derive(Clone, Copy, PartialEq)]
enum Keep {
    /// Outside the other; on a face of it, if the normals agree.
    OutsideOrAlong,
    /// Outside the other; on a face of it, if the normals are opposite.
    OutsideOrAgainst,
    Outside,
    /// Inside the other; on a face of it, if the normals agree.
    InsideOrAlong,
    Inside,
}

/// The fraction of a panel of given `width` \[m\] that remains: all, nothing, or,
/// where the other member cuts it, clamp(½ + d/(b g), 0, 1) (method book, eq. 4.5).
fn fraction_kept(panel: &Panel, width: f64, other: &Shape, keep: Keep, tolerance: f64) -> f64 {
    let inside = matches!(keep, Keep::Inside | Keep::InsideOrAlong);
    let sign = if inside { -1.0 } else { 1.0 };
    let distance = sign * other.signed_distance(&panel.centre);
    if distance.abs() > width {
        return if distance > 0.0 { 1.0 } else { 0.0 };
    }
    let gradient = other.gradient(&panel.centre);
    let along = gradient.dot(&panel.normal);
    let steepness = (gradient - along * panel.normal).norm();
    if steepness > 1e-3 {
        return (0.5 + distance / (width * steepness)).clamp(0.0, 1.0);
    }
    let remains = match keep {
        _ if distance.abs() > tolerance => distance > 0.0,
        Keep::OutsideOrAlong | Keep::InsideOrAlong => along > 0.0,
        Keep::OutsideOrAgainst => along < 0.0,
        Keep::Outside | Keep::Inside => false,
    };
    if remains { 1.0 } else { 0.0 }
}

/// Panels of the members that lie on the boundary of the composite, cut in
/// proportion where members meet. Of coinciding faces at most one remains.
/// `width` gives the edge of a panel \[m\].
pub(super) fn composite_panels(
    shape: &Shape,
    width: impl Fn(&Panel) -> f64,
    of: PanelsOf,
) -> Result<Vec<Panel>, GeometryError> {
    let tolerance = 1e-9 * shape.size();
    let mut kept = Vec::new();
    let mut cut = |panel: Panel, others: &mut dyn Iterator<Item = (&Shape, Keep)>, flip: f64| {
        let fraction: f64 = others
            .map(|(other, keep)| fraction_kept(&panel, width(&panel), other, keep, tolerance))
            .product();
        if fraction > 1e-6 {
            kept.push(Panel { area: fraction * panel.area, normal: flip * panel.normal, ..panel });
        }
    };
    match shape {
        Shape::Union(members) | Shape::Intersection(members) => {
            let [first, later] = match shape {
                Shape::Union(_) => [Keep::OutsideOrAlong, Keep::Outside],
                _ => [Keep::InsideOrAlong, Keep::Inside],
            };
            for (n, member) in members.iter().enumerate() {
                for panel in of(member)? {
                    let others = members.iter().enumerate().filter(|(other, _)| *other != n);
                    let rule = |other| if n < other { first } else { later };
                    cut(panel, &mut others.map(|(other, shape)| (shape, rule(other))), 1.0);
                }
            }
        }
        Shape::Difference(body, hole) => {
            for panel in of(body)? {
                cut(panel, &mut std::iter::once((&**hole, Keep::OutsideOrAgainst)), 1.0);
            }
            for panel in of(hole)? {
                cut(panel, &mut std::iter::once((&**body, Keep::Inside)), -1.0);
            }
        }
        _ => {}
    }
    Ok(kept)
}
