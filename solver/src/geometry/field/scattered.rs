//! A vector field through scattered data.
#![allow(non_snake_case)]

use crate::algebra::pseudo_inverse::pseudo_inverse;
use crate::algebra::tensor::{Matrix3, Vector3, bounding_box};
use crate::geometry::point_hash::PointHash;

/// Data points that the value at a position comes from.
const NEAREST: usize = 16;
/// Directions in which these points extend less than this fraction of their extent, squared,
/// have no slope \[–\]: data on a flat surface say nothing of what happens off it.
const FLAT: f64 = 1e-8;
/// Square of the distance over that of the farthest point below which a point is met
/// almost exactly \[–\].
const CLOSE: f64 = 1e-6;

/// Vectors at scattered points, such as measured displacements \[m\], continued by moving
/// least squares: the linear function that fits the 16 nearest points best, with weights
/// (1 − q²)²/(q² + 10⁻⁶) of the distance q over that of the farthest. Linear fields are
/// reproduced, and data are met to 10⁻⁶ (method book, eq. 15.6).
pub struct Scattered {
    positions: Vec<Vector3>,
    values: Vec<Vector3>,
    reach: f64,
    search: PointHash,
}

/// Fewer than four data points, from which no linear function can be made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("has {points} points; at least 4 are needed")]
pub struct TooFewData {
    /// Number of points.
    pub points: usize,
}

impl Scattered {
    /// From points \[m\] with a vector each; the field is meant for positions that are no
    /// farther than `reach` \[m\] from a point.
    pub fn new(data: &[(Vector3, Vector3)], reach: f64) -> Result<Scattered, TooFewData> {
        if data.len() < 4 {
            return Err(TooFewData { points: data.len() });
        }
        let (positions, values): (Vec<Vector3>, Vec<Vector3>) = data.iter().copied().unzip();
        let (lower, upper) = bounding_box(&positions);
        let extent = (upper - lower).norm().max(reach).max(f64::MIN_POSITIVE);
        // Measured points lie on surfaces, or in volumes with room between them.
        let spacing = extent / (positions.len() as f64).sqrt();
        let mut search = PointHash::new(spacing, extent);
        positions.iter().for_each(|X| search.insert(*X));
        Ok(Scattered { positions, values, reach, search })
    }

    /// Largest distance from the data \[m\] at which the field is meant to be used.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Lower and upper corner of the box around all positions within reach \[m\].
    pub fn bounds(&self) -> (Vector3, Vector3) {
        let (lower, upper) = bounding_box(&self.positions);
        (lower.add_scalar(-self.reach), upper.add_scalar(self.reach))
    }

    /// Distance from the nearest data point \[m\].
    pub fn distance(&self, X: &Vector3) -> f64 {
        self.search.nearest(X, usize::MAX, 1).first().map_or(f64::INFINITY, |near| near.0)
    }

    /// The vector at the position `X` \[m\].
    pub fn at(&self, X: &Vector3) -> Vector3 {
        self.fitted(X, |index| self.values[index])
    }

    /// The axis at the position `X` \[m\], of data whose lengths and signs do not count, such as
    /// directions of fibres: the data around are turned to the side of the nearest. 0 out of reach.
    pub fn axis_at(&self, X: &Vector3) -> Vector3 {
        let nearest = self.search.nearest(X, usize::MAX, 1);
        let Some(&(_, nearest)) = nearest.first().filter(|near| near.0 <= self.reach) else {
            return Vector3::zeros();
        };
        let side = self.values[nearest];
        self.fitted(X, |index| {
            let axis = self.values[index].try_normalize(0.0).unwrap_or_default();
            if axis.dot(&side) < 0.0 { -axis } else { axis }
        })
    }

    fn fitted(&self, X: &Vector3, datum: impl Fn(usize) -> Vector3) -> Vector3 {
        let near = self.search.nearest(X, usize::MAX, NEAREST);
        let farthest = near.last().map_or(0.0, |near| near.0);
        if farthest == 0.0 {
            return near.first().map_or(Vector3::zeros(), |near| datum(near.1));
        }
        // The farthest point counts a little, or four points would be three.
        let weight = |distance: f64| {
            let q = (0.99 * distance / farthest).powi(2);
            (1.0 - q).powi(2) / (q + CLOSE)
        };
        let (mut total, mut offset, mut value) = (0.0, Vector3::zeros(), Vector3::zeros());
        for &(distance, index) in &near {
            let w = weight(distance);
            total += w;
            offset += w * (self.positions[index] - X);
            value += w * datum(index);
        }
        let (offset, value) = (offset / total, value / total);
        let (mut scatter, mut slope) = (Matrix3::zeros(), Matrix3::zeros());
        for &(distance, index) in &near {
            let w = weight(distance) / total;
            let t = self.positions[index] - X - offset;
            scatter += w * t * t.transpose();
            slope += w * (datum(index) - value) * t.transpose();
        }
        value - slope * pseudo_inverse(scatter, FLAT * scatter.trace()) * offset
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::random::Random;

    fn linear(X: &Vector3) -> Vector3 {
        Vector3::new(0.3, -0.1, 2.0)
            + Matrix3::new(1.0, 2.0, 0.5, 0.0, -1.0, 0.3, 0.2, 0.1, 0.4) * X
    }

    fn cloud(count: usize, flat: bool) -> Vec<Vector3> {
        let mut random = Random(7);
        let point = |mut X: Vector3| {
            if flat {
                X.z = 0.2;
            }
            X
        };
        (0..count).map(|_| point(random.vector(3))).collect()
    }

    #[test]
    fn linear_fields_are_reproduced_in_space_and_on_a_flat_surface() {
        for (count, flat) in [(12, false), (400, false), (400, true)] {
            let points = cloud(count, flat);
            let data: Vec<_> = points.iter().map(|X| (*X, linear(X))).collect();
            let field = Scattered::new(&data, 0.1).unwrap();
            for X in cloud(30, flat) {
                assert!((field.at(&X) - linear(&X)).norm() < 1e-8, "{count} {flat}");
            }
        }
    }

    #[test]
    fn data_are_met_and_smooth_fields_followed() {
        let smooth = |X: &Vector3| Vector3::new(X.x.sin() * X.y, X.y * X.y, X.z.cos());
        let points = cloud(4000, false);
        let data: Vec<_> = points.iter().map(|X| (*X, smooth(X))).collect();
        let field = Scattered::new(&data, 0.1).unwrap();
        for (X, value) in data.iter().take(50) {
            assert!((field.at(X) - value).norm() < 1e-5);
            assert_eq!(field.distance(X), 0.0);
        }
        for X in cloud(50, false).iter().map(|X| 0.8 * X) {
            assert!((field.at(&X) - smooth(&X)).norm() < 0.03);
        }
    }

    #[test]
    fn axes_do_not_depend_on_lengths_and_signs_and_end_out_of_reach() {
        let axis = |X: &Vector3| Vector3::new(X.x.cos(), X.x.sin(), 0.0);
        let mut random = Random(3);
        let points = cloud(3000, false);
        let any = |X: &Vector3| (*X, axis(X) * (random.vector(1).x + 0.1));
        let data: Vec<_> = points.iter().map(any).collect();
        let field = Scattered::new(&data, 0.5).unwrap();
        for X in cloud(50, false).iter().map(|X| 0.8 * X) {
            assert!(field.axis_at(&X).cross(&axis(&X)).norm() < 0.03, "{X}");
            assert!((field.axis_at(&X).norm() - 1.0).abs() < 0.03, "{X}");
        }
        assert_eq!(field.axis_at(&Vector3::repeat(3.0)), Vector3::zeros());
    }

    #[test]
    fn distances_are_those_of_the_nearest_point_however_far() {
        let data: Vec<_> = cloud(50, false).into_iter().map(|X| (X, X)).collect();
        let field = Scattered::new(&data, 0.1).unwrap();
        for X in [Vector3::new(0.3, 0.1, 0.0), Vector3::new(-40.0, 3.0, 9.0)] {
            let nearest = data.iter().map(|(Y, _)| (X - Y).norm()).fold(f64::INFINITY, f64::min);
            assert_eq!(field.distance(&X), nearest);
        }
        assert_eq!(Scattered::new(&data[..3], 0.1).err(), Some(TooFewData { points: 3 }));
    }
}
