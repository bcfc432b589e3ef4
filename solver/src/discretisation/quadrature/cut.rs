//! The part of the unit cube or square in a half-space.
#![allow(non_snake_case)]

use crate::algebra::tensor::Vector3;

/// Volume of {x in [−½, ½]³ with level + slope·x ≤ 0} and its centroid, exact but
/// for round-off; the centre where the volume is 0. A square has no slope along z
/// (method book, eq. 7.3).
pub(super) fn cut(level: f64, slope: &Vector3) -> (f64, Vector3) {
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| slope[b].abs().total_cmp(&slope[a].abs()));
    let n = axes.map(|axis| slope[axis].abs());
    if n[0] == 0.0 {
        return (if level > 0.0 { 0.0 } else { 1.0 }, Vector3::zeros());
    }
    // In [0, 1]³ mirrored so that the slopes are not negative: n·x ≤ alpha.
    let alpha = 0.5 * (n[0] + n[1] + n[2]) - level;
    let [volume, moments @ ..] = cube(n, alpha);
    if volume <= 0.0 {
        return (0.0, Vector3::zeros());
    }
    let mut centroid = Vector3::zeros();
    for (axis, moment) in axes.into_iter().zip(moments) {
        centroid[axis] = (moment / volume - 0.5) * if slope[axis] < 0.0 { -1.0 } else { 1.0 };
    }
    (volume.min(1.0), centroid)
}

/// Volume and first moments along x, y, z.
type Moments = [f64; 4];

/// Of {n·x ≤ alpha}, over layers of constant z.
fn cube(n: [f64; 3], alpha: f64) -> Moments {
    let kink = |offset: f64| place(alpha - offset, n[2]);
    let kinks = [0.0, n[0], n[1], n[0] + n[1]].map(kink);
    integral(kinks, |z| {
        let [area, x, y, _] = square(n, alpha - n[2] * z);
        [area, x, y, z * area]
    })
}

/// Of a layer, over lines of constant y.
fn square(n: [f64; 3], alpha: f64) -> Moments {
    integral([place(alpha, n[1]), place(alpha - n[0], n[1])], |y| {
        let length = ((alpha - n[1] * y) / n[0]).clamp(0.0, 1.0);
        [length, 0.5 * length * length, y * length, 0.0]
    })
}

/// Where slope·x = level in [0, 1], or the end next to it.
fn place(level: f64, slope: f64) -> f64 {
    if level <= 0.0 { 0.0 } else { (level / slope).min(1.0) }
}

/// Over [0, 1] of a function that is cubic between the kinks, by two Gauss points each.
fn integral<const K: usize>(mut kinks: [f64; K], f: impl Fn(f64) -> Moments) -> Moments {
    const HALF_DISTANCE: f64 = 0.288_675_134_594_812_9;
    kinks.sort_by(f64::total_cmp);
    let mut sum = [0.0; 4];
    let mut from = 0.0;
    for to in kinks.into_iter().chain([1.0]) {
        let width = to - from;
        if width > 0.0 {
            for at in [0.5 - HALF_DISTANCE, 0.5 + HALF_DISTANCE] {
                let values = f(from + at * width);
                sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += 0.5 * width * value);
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

    /// Fraction and centroid of n³ sample points.
    fn counted(level: f64, slope: &Vector3) -> (f64, Vector3) {
        let n = 60;
        let at = |i: usize| (i as f64 + 0.5) / n as f64 - 0.5;
        let all = (0..n * n * n).map(|i| Vector3::new(at(i % n), at(i / n % n), at(i / (n * n))));
        let inside: Vec<Vector3> = all.filter(|x| level + slope.dot(x) <= 0.0).collect();
        let count = inside.len() as f64;
        (count / (n * n * n) as f64, inside.iter().sum::<Vector3>() / count.max(1.0))
    }

    proptest! {
        #[test]
        fn a_cut_cube_has_the_volume_and_centroid_that_counting_finds(
            slope in prop::array::uniform3(-1.0..1.0f64),
            level in -1.0..1.0f64,
        ) {
            let slope = Vector3::from(slope);
            let (volume, centroid) = cut(level, &slope);
            let (fraction, middle) = counted(level, &slope);
            prop_assert!((volume - fraction).abs() < 0.02, "{volume} against {fraction}");
            prop_assert!((centroid * volume - middle * fraction).norm() < 0.02);
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
    }
}
