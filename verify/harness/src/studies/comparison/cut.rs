//! A plane cut through a body, before and after its deformation.
#![allow(non_snake_case)]

use mtled::algebra::tensor::{Matrix3, Vector3};
use mtled::geometry::{DistanceFunction, Selector, Shape};
use mtled::problem::Problem;
use mtled_run::warp::{DisplacementField, source_of};
use rayon::prelude::*;

/// A vertical plane; a point of it is (across, up) \[m\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane {
    /// The point (0, 0) \[m\].
    origin: Vector3,
    across: Vector3,
}

/// What a plane is laid through.
#[derive(Debug, Clone)]
pub(crate) enum Through {
    /// A part of the surface whose displacement is prescribed.
    Patch(Selector),
    /// The level of a body force.
    Level(Shape),
}

impl Plane {
    /// The vertical plane through the first spherical patch whose displacement is prescribed, or
    /// else through the first half-space that has a body force, along their normal.
    pub(crate) fn of(problem: &Problem) -> Option<(Plane, Through)> {
        let patch = problem.conditions.iter().find_map(|condition| match &condition.part {
            Selector::Inside { shape: Shape::Sphere { centre, .. }, .. } => {
                let through = Through::Patch(condition.part.clone());
                Some((*centre, problem.body.gradient(centre), through))
            }
            _ => None,
        });
        let level = || {
            problem.loads.body_forces.iter().find_map(|force| match &force.part {
                Selector::Inside { shape: shape @ Shape::HalfSpace { point, normal }, .. } => {
                    Some((*point, *normal, Through::Level(shape.clone())))
                }
                _ => None,
            })
        };
        let (point, normal, through) = patch.or_else(level)?;
        let mut across = Vector3::new(normal.x, normal.y, 0.0).try_normalize(1e-6)?;
        // Right stays on the right, whichever way the normal points.
        if across.x < 0.0 {
            across = -across;
        }
        let beside = across.cross(&Vector3::z());
        Some((Plane { origin: beside * point.dot(&beside), across }, through))
    }

    /// A point of the plane in space \[m\].
    pub(crate) fn point(&self, across: f64, up: f64) -> Vector3 {
        self.origin + self.across * across + Vector3::z() * up
    }

    /// Lower and upper corner of the rectangle around the shadow of a box on the plane \[m\].
    fn shadow(&self, (lower, upper): &(Vector3, Vector3)) -> ([f64; 2], [f64; 2]) {
        let corners = (0..4).map(|n| {
            let x = if n & 1 == 0 { lower.x } else { upper.x };
            let y = if n & 2 == 0 { lower.y } else { upper.y };
            self.across.x * x + self.across.y * y
        });
        let (low, high) = corners
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), a| (low.min(a), high.max(a)));
        ([low, lower.z], [high, upper.z])
    }

    /// Outlines of what is inside of a function of the position, between the corners of a
    /// rectangle, from pixels of `step` \[m\].
    fn outlines(
        (lower, upper): &([f64; 2], [f64; 2]),
        step: f64,
        inside: impl Fn(f64, f64) -> f64 + Send + Sync + 'static,
    ) -> Vec<Vec<[f64; 2]>> {
        let corner = |corner: &[f64; 2], z: f64| Vector3::new(corner[0], corner[1], z);
        let function =
            DistanceFunction::new(corner(lower, -step), corner(upper, step), move |p: &Vector3| {
                inside(p.x, p.y)
            });
        Shape::Function(function).outline(0.0, step)
    }
}

/// Where the points of a grid on a plane were before the deformation.
#[derive(Debug, Clone)]
pub(crate) struct Cut {
    plane: Plane,
    bounds: ([f64; 2], [f64; 2]),
    /// Edge of a pixel \[m\].
    step: f64,
    size: [usize; 2],
    /// X − x of each point, the first index fastest \[m\].
    sources: Vec<Vector3>,
}

impl Cut {
    /// The cut of a body that stays within `reach` \[m\] of its reference shape.
    pub(crate) fn new(
        field: &DisplacementField,
        body: &Shape,
        plane: Plane,
        reach: f64,
        step: f64,
    ) -> Option<Cut> {
        let (lower, upper) = plane.shadow(&body.bounding_box()?);
        let margin = reach + 2.0 * step;
        let bounds = (lower.map(|c| c - margin), upper.map(|c| c + margin));
        let size = [0, 1].map(|k| ((bounds.1[k] - bounds.0[k]) / step).ceil() as usize + 1);
        let row = |j: usize| {
            let (mut start, mut inverse) = (Vector3::zeros(), Matrix3::identity());
            let source = |i: usize| {
                let [a, b] = [(0, i), (1, j)].map(|(k, n)| bounds.0[k] + n as f64 * step);
                let x = plane.point(a, b);
                // Nothing moves where the body cannot be.
                if body.signed_distance(&x) > margin {
                    return Vector3::zeros();
                }
                let source = source_of(field, &x, &start, inverse);
                (start, inverse) = (source.vector, source.inverse);
                start
            };
            (0..size[0]).map(source).collect::<Vec<Vector3>>()
        };
        let rows: Vec<Vec<Vector3>> = (0..size[1]).into_par_iter().map(row).collect();
        Some(Cut { plane, bounds, step, size, sources: rows.concat() })
    }

    /// A point of the plane in space \[m\].
    pub(crate) fn point(&self, across: f64, up: f64) -> Vector3 {
        self.plane.point(across, up)
    }

    /// Outlines of a shape before the deformation, grown by `offset` \[m\].
    pub(crate) fn before(&self, shape: &Shape, offset: f64) -> Vec<Vec<[f64; 2]>> {
        let (shape, plane) = (shape.clone(), self.plane);
        Plane::outlines(&self.bounds, self.step, move |a, b| {
            shape.signed_distance(&plane.point(a, b)) - offset
        })
    }

    /// Outlines of a shape after the deformation.
    pub(crate) fn after(&self, shape: &Shape) -> Vec<Vec<[f64; 2]>> {
        self.level(self.distances(shape))
    }

    /// Outlines of where, after the deformation, a shape has moved by more than each of several
    /// distances \[m\].
    pub(crate) fn moved(&self, shape: &Shape, distances: &[f64]) -> Vec<Vec<Vec<[f64; 2]>>> {
        let inside = self.distances(shape);
        let further = |&distance: &f64| {
            let values = inside.iter().zip(&self.sources);
            self.level(values.map(|(d, source)| d.max(distance - source.norm())).collect())
        };
        distances.iter().map(further).collect()
    }

    /// The largest displacement in a shape \[m\].
    pub(crate) fn largest_displacement(&self, shape: &Shape) -> f64 {
        let inside = self.distances(shape);
        let moved = inside.iter().zip(&self.sources).filter(|(d, _)| **d < 0.0);
        moved.map(|(_, source)| source.norm()).fold(0.0, f64::max)
    }

    /// Signed distance of the places where the points were \[m\].
    fn distances(&self, shape: &Shape) -> Vec<f64> {
        let source = |(n, source): (usize, &Vector3)| {
            let [i, j] = [n % self.size[0], n / self.size[0]];
            let [a, b] = [(0, i), (1, j)].map(|(k, n)| self.bounds.0[k] + n as f64 * self.step);
            shape.signed_distance(&(self.plane.point(a, b) + source))
        };
        self.sources.iter().enumerate().map(source).collect()
    }

    /// Outlines around the values below zero.
    fn level(&self, values: Vec<f64>) -> Vec<Vec<[f64; 2]>> {
        let (low, step, size) = (self.bounds.0, self.step, self.size);
        Plane::outlines(&self.bounds, step, move |a, b| {
            let [a, b] = [(a - low[0]) / step, (b - low[1]) / step];
            let cell = |x: f64, n: usize| (x.max(0.0) as usize).min(n - 2);
            let (i, j) = (cell(a, size[0]), cell(b, size[1]));
            let (s, t) = ((a - i as f64).clamp(0.0, 1.0), (b - j as f64).clamp(0.0, 1.0));
            let at = |i: usize, j: usize| values[i + size[0] * j];
            let along = |j: usize| (1.0 - s) * at(i, j) + s * at(i + 1, j);
            (1.0 - t) * along(j) + t * along(j + 1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mtled_case::bundled::unpack;
    use mtled_case::scene::read_case;

    const UPRIGHT: Plane =
        Plane { origin: Vector3::new(0.0, 0.3, 0.0), across: Vector3::new(1.0, 0.0, 0.0) };

    /// A cut through a space that has moved by `u` \[m\], from pixels of 2 cm.
    fn moved_by(u: Vector3) -> Cut {
        let bounds = ([-1.0, -1.0], [1.0, 1.0]);
        let sources = vec![-u; 101 * 101];
        Cut { plane: UPRIGHT, bounds, step: 0.02, size: [101, 101], sources }
    }

    /// Middle and largest distance from it of the points of the only line.
    fn circle(lines: &[Vec<[f64; 2]>]) -> ([f64; 2], f64) {
        assert_eq!(lines.len(), 1);
        let sum = lines[0].iter().fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
        let middle = sum.map(|x| x / lines[0].len() as f64);
        let distance = |p: &[f64; 2]| (p[0] - middle[0]).hypot(p[1] - middle[1]);
        (middle, lines[0].iter().map(distance).fold(0.0, f64::max))
    }

    #[test]
    fn outlines_after_the_deformation_are_where_the_shape_has_moved() {
        // The plane cuts the ball 0.3 m beside its centre before and in its centre after.
        let ball = Shape::Sphere { centre: Vector3::zeros(), radius: 0.5 };
        let cut = moved_by(Vector3::new(0.2, 0.3, -0.1));
        let (middle, radius) = circle(&cut.before(&ball, 0.0));
        assert!(middle.iter().all(|x| x.abs() < 5e-3) && (radius - 0.4).abs() < 5e-3, "{radius}");
        let (middle, radius) = circle(&cut.after(&ball));
        assert!((middle[0] - 0.2).abs() < 5e-3 && (middle[1] + 0.1).abs() < 5e-3, "{middle:?}");
        assert!((radius - 0.5).abs() < 5e-3, "{radius}");
    }

    #[test]
    fn what_has_moved_further_than_everything_is_empty() {
        let ball = Shape::Sphere { centre: Vector3::zeros(), radius: 0.5 };
        let cut = moved_by(Vector3::new(0.0, 0.3, 0.0));
        let moved = cut.moved(&ball, &[0.0, 0.2, 0.4]);
        assert_eq!(moved.iter().map(Vec::len).collect::<Vec<_>>(), [1, 1, 0]);
        assert!((cut.largest_displacement(&ball) - 0.3).abs() < 1e-12);
    }

    #[test]
    fn the_planes_of_both_whole_brains_go_through_the_tumour() {
        let folder = tempfile::tempdir().unwrap();
        let cases = unpack(folder.path()).unwrap();
        for name in ["brain_shift", "brain_gravity"] {
            let case = read_case(&cases.join(format!("{name}.toml"))).unwrap();
            let (plane, _) = Plane::of(&case.problem).unwrap();
            let tumour = Vector3::new(0.0285, 0.0165, 0.0225);
            let beside = plane.across.cross(&Vector3::z());
            let distance = (tumour - plane.origin).dot(&beside).abs();
            assert!(distance < 2e-3, "{name}: {distance} m");
        }
    }
}
