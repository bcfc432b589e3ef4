//! The part of the unit cube or square in a half-space.
#![allow(non_snake_case)]

use crate::algebra::tensor::{Matrix3, Vector3};

/// A level that differs by less than this fraction of the edge of a cell from a linear one is cut
/// as a linear one of the same mean; not round, so that round-off seldom chooses \[–\].
pub(super) const NEARLY_FLAT: f64 = 0.030_7;

/// Volume of {x in [−½, ½]³ with level + slope·x ≤ 0} and its centroid, exact but
/// for round-off; the centre where the volume is 0. A square has no slope along z
/// (method book, eq. 7.3).
pub(super) fn cut(level: f64, slope: &Vector3) -> (f64, Vector3) {
    let mirrored = Mirrored::new(level, slope);
    let Some([volume, moments @ ..]) = mirrored.moments(&TWO_POINTS) else {
        return (if level > 0.0 { 0.0 } else { 1.0 }, Vector3::zeros());
    };
    if volume <= 0.0 {
        return (0.0, Vector3::zeros());
    }
    let mut centroid = Vector3::zeros();
    for (axis, moment) in mirrored.axes.into_iter().zip(moments) {
        centroid[axis] = (moment / volume - 0.5) * if slope[axis] < 0.0 { -1.0 } else { 1.0 };
    }
    (volume.min(1.0), centroid)
}

/// Second moments of the same about its centroid over its volume; where there is no
/// volume, those of the whole.
pub(super) fn spread(level: f64, slope: &Vector3) -> Matrix3 {
    let mirrored = Mirrored::new(level, slope);
    match mirrored.moments(&THREE_POINTS) {
        Some([volume, x, y, z, xx, yy, zz, xy, xz, yz]) if volume > 0.0 => {
            let mean = Vector3::new(x, y, z) / volume;
            let squares = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) / volume;
            let own = squares - mean * mean.transpose();
            let sign = |axis: usize| if slope[axis] < 0.0 { -1.0 } else { 1.0 };
            let place = mirrored.places();
            Matrix3::from_fn(|i, j| own[(place[i], place[j])] * sign(i) * sign(j))
        }
        _ => Matrix3::from_diagonal_element(1.0 / 12.0),
    }
}

/// {n·x ≤ alpha} in [0, 1]³: axes by falling slope, mirrored so that none is negative.
struct Mirrored {
    axes: [usize; 3],
    n: [f64; 3],
    alpha: f64,
}

impl Mirrored {
    fn new(level: f64, slope: &Vector3) -> Mirrored {
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| slope[b].abs().total_cmp(&slope[a].abs()));
        let n = axes.map(|axis| slope[axis].abs());
        Mirrored { axes, n, alpha: 0.5 * (n[0] + n[1] + n[2]) - level }
    }

    /// None without any slope.
    fn moments(&self, rule: &[(f64, f64)]) -> Option<Moments> {
        (self.n[0] > 0.0).then(|| cube(self.n, self.alpha, rule))
    }

    /// Which of the sorted axes x, y and z are.
    fn places(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.axes.iter().position(|&own| own == axis).unwrap_or(axis))
    }
}

/// Volume and moments: x, y, z, xx, yy, zz, xy, xz, yz.
type Moments = [f64; 10];

/// Gauss points on [0, 1] and their weights: for volumes and first moments, cubic between
/// the kinks, and for second moments, of degree 5.
const TWO_POINTS: [(f64, f64); 2] =
    [(0.5 - 0.288_675_134_594_812_9, 0.5), (0.5 + 0.288_675_134_594_812_9, 0.5)];
const THREE_POINTS: [(f64, f64); 3] = [
    (0.5 - 0.387_298_334_620_741_7, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.5 + 0.387_298_334_620_741_7, 5.0 / 18.0),
];

/// Of {n·x ≤ alpha}, over layers of constant z.
fn cube(n: [f64; 3], alpha: f64, rule: &[(f64, f64)]) -> Moments {
    let kink = |offset: f64| place(alpha - offset, n[2]);
    let kinks = [0.0, n[0], n[1], n[0] + n[1]].map(kink);
    integral(kinks, rule, |z| {
        let [area, x, y, _, xx, yy, _, xy, ..] = square(n, alpha - n[2] * z, rule);
        [area, x, y, z * area, xx, yy, z * z * area, xy, x * z, y * z]
    })
}

/// Of a layer, over lines of constant y.
fn square(n: [f64; 3], alpha: f64, rule: &[(f64, f64)]) -> Moments {
    integral([place(alpha, n[1]), place(alpha - n[0], n[1])], rule, |y| {
        let length = ((alpha - n[1] * y) / n[0]).clamp(0.0, 1.0);
        let x = 0.5 * length * length;
        let xx = length * length * length / 3.0;
        [length, x, y * length, 0.0, xx, y * y * length, 0.0, x * y, 0.0, 0.0]
    })
}

/// Where slope·x = level in [0, 1], or the end next to it.
fn place(level: f64, slope: f64) -> f64 {
    if level <= 0.0 { 0.0 } else { (level / slope).min(1.0) }
}

/// Over [0, 1], by the rule between the kinks.
fn integral<const K: usize>(
    mut kinks: [f64; K],
    rule: &[(f64, f64)],
    f: impl Fn(f64) -> Moments,
) -> Moments {
    kinks.sort_by(f64::total_cmp);
    let mut sum = Moments::default();
    let mut from = 0.0;
    for to in kinks.into_iter().chain([1.0]) {
        let width = to - from;
        if width > 0.0 {
            for (at, weight) in rule {
                let values = f(from + at * width);
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * width * value);
            }
        }
        from = to;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Fraction, centroid and spread of n³ sample points.
    fn counted(level: f64, slope: &Vector3) -> (f64, Vector3, Matrix3) {
        let n = 60;
        let at = |i: usize| (i as f64 + 0.5) / n as f64 - 0.5;
        let all = (0..n * n * n).map(|i| Vector3::new(at(i % n), at(i / n % n), at(i / (n * n))));
        let inside: Vec<Vector3> = all.filter(|x| level + slope.dot(x) <= 0.0).collect();
        let count = inside.len() as f64;
        let middle = inside.iter().sum::<Vector3>() / count.max(1.0);
        let square = |x: &Vector3| (x - middle) * (x - middle).transpose();
        let spread = inside.iter().map(square).sum::<Matrix3>() / count.max(1.0);
        (count / (n * n * n) as f64, middle, spread)
    }

    proptest! {
        #[test]
        fn a_cut_cube_has_the_volume_and_moments_that_counting_finds(
            slope in prop::array::uniform3(-1.0..1.0f64),
            level in -1.0..1.0f64,
        ) {
            let slope = Vector3::from(slope);
            let (volume, centroid) = cut(level, &slope);
            let (fraction, middle, counted) = counted(level, &slope);
            prop_assert!((volume - fraction).abs() < 0.02, "{volume} against {fraction}");
            prop_assert!((centroid * volume - middle * fraction).norm() < 0.02);
            let spread = spread(level, &slope);
            prop_assert!((spread * volume - counted * fraction).norm() < 0.01, "{spread}");
        }

        #[test]
        fn both_sides_of_a_cut_make_up_the_cube(
            slope in prop::array::uniform3(prop::sample::select(vec![-1.0, -1e-9, 0.0, 1e-13, 0.3, 1.0])),
            level in -1.0..1.0f64,
        ) {
            let slope = Vector3::from(slope);
            let (low, high) = (cut(level, &slope), cut(-level, &-slope));
            prop_assert!((low.0 + high.0 - 1.0).abs() < 1e-12);
            prop_assert!((low.0 * low.1 + high.0 * high.1).norm() < 1e-12);
        }
    }

    #[test]
    fn a_corner_cut_off_is_a_tetrahedron() {
        let (volume, centroid) = cut(1.0, &Vector3::new(1.0, -1.0, 1.0));
        assert!((volume - 1.0 / 48.0).abs() < 1e-15, "{volume}");
        let expected = Vector3::new(-0.375, 0.375, -0.375);
        assert!((centroid - expected).norm() < 1e-14, "{centroid}");
        // 3/80 of the squared edge ½, and 1/80 between axes, mirrored along y.
        let expected = Matrix3::new(3.0, 1.0, -1.0, 1.0, 3.0, 1.0, -1.0, 1.0, 3.0) / 320.0;
        let spread = spread(1.0, &Vector3::new(1.0, -1.0, 1.0));
        assert!((spread - expected).norm() < 1e-14, "{spread}");
    }
}
