//! Surfaces and plane curves over parameters.

use crate::algebra::tensor::Vector3;
use std::sync::Arc;

/// A position (s, t) on a chart \[–\]; curves ignore t.
pub type Place = [f64; 2];

/// A piece of a face over (s, t), or of a plane curve over s, each in \[0, 1\].
#[derive(Debug, Clone)]
pub enum Chart {
    /// corner + s u + t v; u × v points out of the solid.
    Flat { corner: Vector3, u: Vector3, v: Vector3 },
    /// Of a disc: centre + r (cos α u + sin α v), with `side` u × v out of the solid.
    Sector {
        centre: Vector3,
        across: [Vector3; 2],
        radius: (f64, f64),
        angle: (f64, f64),
        side: f64,
    },
    /// Flat triangles, the n-th of places (2 n, 0), (2 n + 1, 0) and (2 n, 1): corner, u, v.
    Facets(Arc<[[Vector3; 3]]>),
    /// Of the side of a cylinder: base + radius (cos α u + sin α v) + s axis.
    Side {
        base: Vector3,
        axis: Vector3,
        across: [Vector3; 2],
        radius: f64,
        angle: (f64, f64),
        along: (f64, f64),
    },
    /// Of an ellipsoid, between polar angles and longitudes.
    Ellipsoid { centre: Vector3, radii: Vector3, polar: (f64, f64), angle: (f64, f64) },
    /// Of a straight line in a plane, the solid to its left.
    Line { from: Vector3, edge: Vector3 },
    /// Of an ellipse in a plane, anticlockwise.
    Arc { centre: Vector3, radii: Vector3, angle: (f64, f64) },
}

/// The value at `s` between two ends.
fn between((from, to): (f64, f64), s: f64) -> f64 {
    from + s * (to - from)
}

fn length((from, to): (f64, f64)) -> f64 {
    to - from
}

/// The facet of a place with its number.
fn facet(facets: &[[Vector3; 3]], s: f64) -> (f64, &[Vector3; 3]) {
    // Round-off of the first corner belongs to its facet.
    let n = ((0.5 * (s + 0.5)) as usize).min(facets.len() - 1);
    (n as f64, &facets[n])
}

impl Chart {
    /// Whether it is a curve in a plane.
    pub fn is_curve(&self) -> bool {
        matches!(self, Chart::Line { .. } | Chart::Arc { .. })
    }

    /// Whether its normal is the same everywhere.
    pub fn is_flat(&self) -> bool {
        matches!(self, Chart::Flat { .. } | Chart::Sector { .. } | Chart::Line { .. })
    }

    /// \[m\]
    pub fn at(&self, [s, t]: Place) -> Vector3 {
        match self {
            Chart::Flat { corner, u, v } => corner + s * u + t * v,
            Chart::Facets(facets) => {
                let (n, [corner, u, v]) = facet(facets, s);
                corner + (s - 2.0 * n) * u + t * v
            }
            Chart::Sector { centre, across: [u, v], radius, angle, .. } => {
                let (sin, cos) = between(*angle, t).sin_cos();
                centre + between(*radius, s) * (cos * u + sin * v)
            }
            Chart::Side { base, axis, across: [u, v], radius, angle, along } => {
                let (sin, cos) = between(*angle, s).sin_cos();
                base + *radius * (cos * u + sin * v) + between(*along, t) * axis
            }
            Chart::Ellipsoid { centre, radii, .. } => {
                centre + radii.component_mul(&self.on_unit_sphere([s, t]))
            }
            Chart::Line { from, edge } => from + s * edge,
            Chart::Arc { centre, radii, angle } => {
                let (sin, cos) = between(*angle, s).sin_cos();
                centre + Vector3::new(radii.x * cos, radii.y * sin, 0.0)
            }
        }
    }

    /// ∂X/∂s × ∂X/∂t, out of the solid \[m²\]; of a curve the length along its normal \[m\].
    pub fn area_vector(&self, [s, t]: Place) -> Vector3 {
        match self {
            Chart::Flat { u, v, .. } => u.cross(v),
            Chart::Facets(facets) => {
                let (_, [_, u, v]) = facet(facets, s);
                u.cross(v)
            }
            Chart::Sector { across: [u, v], radius, angle, side, .. } => {
                let size = between(*radius, s) * length(*radius) * length(*angle);
                *side * size * u.cross(v)
            }
            Chart::Side { across: [u, v], radius, angle, along, .. } => {
                let (sin, cos) = between(*angle, s).sin_cos();
                *radius * length(*angle) * length(*along) * (cos * u + sin * v)
            }
            Chart::Ellipsoid { radii, polar, angle, .. } => {
                let size = between(*polar, s).sin() * length(*polar) * length(*angle);
                let cofactor = Vector3::repeat(radii.product()).component_div(radii);
                size * cofactor.component_mul(&self.on_unit_sphere([s, t]))
            }
            Chart::Line { edge, .. } => Vector3::new(edge.y, -edge.x, 0.0),
            Chart::Arc { radii, angle, .. } => {
                let (sin, cos) = between(*angle, s).sin_cos();
                length(*angle) * Vector3::new(radii.y * cos, radii.x * sin, 0.0)
            }
        }
    }

    /// Unit vector.
    pub fn normal(&self, [s, t]: Place) -> Vector3 {
        // At the centre of a disc and at a pole areas vanish.
        let normal = match self {
            Chart::Sector { across: [u, v], side, .. } => *side * u.cross(v),
            Chart::Ellipsoid { radii, .. } => self.on_unit_sphere([s, t]).component_div(radii),
            _ => self.area_vector([s, t]),
        };
        normal.normalize()
    }

    fn on_unit_sphere(&self, [s, t]: Place) -> Vector3 {
        match self {
            Chart::Ellipsoid { polar, angle, .. } => {
                let ((sin, cos), (y, x)) =
                    (between(*polar, s).sin_cos(), between(*angle, t).sin_cos());
                Vector3::new(sin * x, sin * y, cos)
            }
            _ => Vector3::zeros(),
        }
    }
}
