//! Functions of a symmetric tensor by way of its eigenvalues, with their exact
//! derivatives, for one number or for eight side by side.
#![allow(non_snake_case)]

use fearless_simd::{Simd, f64x8, prelude::*};
use std::ops::{Add, Div, Mul, Sub};

/// A function of one number that is applied to the eigenvalues of a tensor.
pub trait Scalar {
    /// g(x).
    fn at(&self, x: f64) -> f64;
    /// (g(a) − g(b))/(a − b), and g'(a) for a = b, to round-off for all a and b.
    fn divided_difference(&self, a: f64, b: f64) -> f64;
}

/// A number without a derivative, or several side by side.
pub trait Plain:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// √x.
    fn square_root(self) -> Self;
    /// |x| with the sign of another number, also of a zero.
    fn with_sign_of(self, sign: Self) -> Self;
    /// f of every pair of numbers, one after the other.
    fn each(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self;
    /// How many stand side by side.
    const COUNT: usize;
    /// One of them.
    fn get(&self, lane: usize) -> f64;
    /// Changes one of them.
    fn set(&mut self, lane: usize, value: f64);
}

impl Plain for f64 {
    #[inline(always)]
    fn square_root(self) -> f64 {
        self.sqrt()
    }

    #[inline(always)]
    fn with_sign_of(self, sign: f64) -> f64 {
        self.copysign(sign)
    }

    #[inline(always)]
    fn each(self, other: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
        f(self, other)
    }

    const COUNT: usize = 1;

    #[inline(always)]
    fn get(&self, _: usize) -> f64 {
        *self
    }

    #[inline(always)]
    fn set(&mut self, _: usize, value: f64) {
        *self = value;
    }
}

impl<S: Simd> Plain for f64x8<S> {
    #[inline(always)]
    fn square_root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn with_sign_of(self, sign: Self) -> Self {
        self.copysign(sign)
    }

    #[inline(always)]
    fn each(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        f64x8::from_fn(
            self.simd,
            #[inline(always)]
            |lane| f(self[lane], other[lane]),
        )
    }

    const COUNT: usize = 8;

    #[inline(always)]
    fn get(&self, lane: usize) -> f64 {
        self[lane]
    }

    #[inline(always)]
    fn set(&mut self, lane: usize, value: f64) {
        self[lane] = value;
    }
}

/// Rotations about each axis in turn; after four no deformation of the tests has an entry
/// beside the diagonal above 1e-16 of the largest. A fixed number, so that a number does not
/// depend on those beside it.
const SWEEPS: usize = 4;

/// Eigenvalues of a symmetric tensor and the columns of their unit vectors, by cyclic rotations (Jacobi
/// 1846; method book, eq. 3.17): as exact where eigenvalues are equal as where they are not.
#[inline(always)]
pub fn eigen<R: Plain>(a: &[[R; 3]; 3]) -> ([R; 3], [[R; 3]; 3]) {
    let zero = a[0][0] * 0.0;
    let one = zero + 1.0;
    let mut values = [a[0][0], a[1][1], a[2][2]];
    // Entry k stands in the plane that axis k is normal to.
    let mut beside = [a[1][2], a[0][2], a[0][1]];
    let mut vectors = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
    for _ in 0..SWEEPS {
        for (r, p, q) in [(0, 1, 2), (1, 0, 2), (2, 0, 1)] {
            let (d, twice) = (values[q] - values[p], beside[r] * 2.0);
            let root = (d * d + twice * twice).square_root();
            // The smallest number keeps 0/0 away; it does not change any other quotient.
            let size = d.with_sign_of(one) + root + f64::MIN_POSITIVE;
            let tangent = twice * one.with_sign_of(d) / size;
            let cosine = one / (tangent * tangent + 1.0).square_root();
            let angle = (cosine, tangent * cosine);
            let shift = tangent * beside[r];
            values[p] = values[p] - shift;
            values[q] = values[q] + shift;
            beside[r] = zero;
            (beside[q], beside[p]) = turned(angle, beside[q], beside[p]);
            for row in &mut vectors {
                (row[p], row[q]) = turned(angle, row[p], row[q]);
            }
        }
    }
    (values, vectors)
}

#[inline(always)]
fn turned<R: Plain>((cosine, sine): (R, R), x: R, y: R) -> (R, R) {
    (cosine * x - sine * y, sine * x + cosine * y)
}

/// g(A) = Σ_k g(a_k) n_k ⊗ n_k of a symmetric A (method book, eq. 3.17).
#[inline(always)]
pub fn isotropic<R: Plain>(a: &[[R; 3]; 3], g: &impl Scalar) -> [[R; 3]; 3] {
    let (values, vectors) = eigen(a);
    let zero = values[0] * 0.0;
    let mut inner = [[zero; 3]; 3];
    for k in 0..3 {
        inner[k][k] = values[k].each(
            values[k],
            #[inline(always)]
            |x, _| g.at(x),
        );
    }
    turned_back(&inner, &vectors)
}

/// g(A) and its derivative along `da` (Daleckii, Krein 1965; method book, eq. 3.18):
/// Σ_kl g[a_k, a_l] (n_k · dA n_l) n_k ⊗ n_l with divided differences g[a, b].
#[inline(always)]
pub fn isotropic_with_slope<R: Plain>(
    a: &[[R; 3]; 3],
    da: &[[R; 3]; 3],
    g: &impl Scalar,
) -> ([[R; 3]; 3], [[R; 3]; 3]) {
    let (values, vectors) = eigen(a);
    let zero = values[0] * 0.0;
    let (mut inner, mut slope) = ([[zero; 3]; 3], [[zero; 3]; 3]);
    for k in 0..3 {
        inner[k][k] = values[k].each(
            values[k],
            #[inline(always)]
            |x, _| g.at(x),
        );
        let turned: [R; 3] = [0, 1, 2].map(
            #[inline(always)]
            |i| product(&da[i], &column(&vectors, k)),
        );
        for l in 0..=k {
            let factor = values[k].each(
                values[l],
                #[inline(always)]
                |x, y| g.divided_difference(x, y),
            );
            slope[k][l] = factor * product(&turned, &column(&vectors, l));
            slope[l][k] = slope[k][l];
        }
    }
    (turned_back(&inner, &vectors), turned_back(&slope, &vectors))
}

#[inline(always)]
fn column<R: Plain>(a: &[[R; 3]; 3], k: usize) -> [R; 3] {
    [a[0][k], a[1][k], a[2][k]]
}

/// Σ_kl m_kl n_k ⊗ n_l of a symmetric m and the columns n_k.
#[inline(always)]
fn turned_back<R: Plain>(m: &[[R; 3]; 3], n: &[[R; 3]; 3]) -> [[R; 3]; 3] {
    let zero = m[0][0] * 0.0;
    let mut result = [[zero; 3]; 3];
    for i in 0..3 {
        let row: [R; 3] = [0, 1, 2].map(
            #[inline(always)]
            |k| product(&m[k], &n[i]),
        );
        for j in 0..=i {
            result[i][j] = product(&row, &n[j]);
            result[j][i] = result[i][j];
        }
    }
    result
}

#[inline(always)]
fn product<R: Plain>(x: &[R; 3], y: &[R; 3]) -> R {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::random::Random;
    use crate::algebra::tensor::{Matrix3, Vector3, rotation, tensor};
    use fearless_simd::{Level, dispatch};

    /// g(x) = x³, with which everything can be written without eigenvalues.
    struct Cube;

    impl Scalar for Cube {
        fn at(&self, x: f64) -> f64 {
            x * x * x
        }

        fn divided_difference(&self, a: f64, b: f64) -> f64 {
            a * a + a * b + b * b
        }
    }

    fn matrix(a: &[[f64; 3]; 3]) -> Matrix3 {
        Matrix3::from_fn(|i, j| a[i][j])
    }

    /// Tensors with eigenvalues apart, close, twice and three times equal, and far apart.
    fn samples() -> Vec<Matrix3> {
        let mut random = Random(5);
        let mut next = || random.symmetric();
        let mut samples = vec![Matrix3::identity(), Matrix3::zeros()];
        for values in [
            [1.0, 1.0, 1.0],
            [1.0, 1.0, 1.0 + 1e-15],
            [1.0, 1.0 + 1e-9, 1.0 - 1e-9],
            [2.0, 2.0, 0.25],
            [2.0, 2.0 + 1e-8, 0.25],
            [0.5, 1.0, 2.0],
            [1e-4, 1.0, 1e4],
            [1e-6, 1e-6, 1e6],
        ] {
            for _ in 0..40 {
                let axis = Vector3::new(next(), next(), next());
                let Q = rotation(&axis, 3.0 * next());
                let a = Q * Matrix3::from_diagonal(&values.into()) * Q.transpose();
                samples.push((a + a.transpose()) * 0.5);
            }
        }
        samples.extend((0..300).map(|_| {
            let a = Matrix3::from_fn(|_, _| next());
            a + a.transpose()
        }));
        samples
    }

    #[test]
    fn a_tensor_is_put_together_again_from_its_eigenvalues() {
        for a in samples() {
            let (values, vectors) = eigen(&tensor(&a));
            let Q = matrix(&vectors);
            assert!((Q.transpose() * Q - Matrix3::identity()).norm() < 1e-14, "{a}");
            let again = Q * Matrix3::from_diagonal(&values.into()) * Q.transpose();
            assert!((again - a).norm() <= 1e-14 * a.norm(), "{a} {again}");
        }
    }

    #[test]
    fn cubes_and_their_derivatives_are_those_of_products() {
        let direction = Matrix3::new(0.3, -0.2, 0.5, -0.2, 0.7, 0.1, 0.5, 0.1, -0.4);
        for a in samples() {
            let (cube, slope) = isotropic_with_slope(&tensor(&a), &tensor(&direction), &Cube);
            let expected = direction * a * a + a * direction * a + a * a * direction;
            assert!((matrix(&cube) - a * a * a).norm() <= 2e-14 * a.norm().powi(3), "{a}");
            assert!((matrix(&slope) - expected).norm() <= 2e-14 * a.norm().powi(2), "{a}");
            assert_eq!(cube, isotropic(&tensor(&a), &Cube));
        }
    }

    #[test]
    fn eight_lanes_give_the_bits_of_one() {
        let samples = samples();
        let direction = Matrix3::new(0.3, -0.2, 0.5, -0.2, 0.7, 0.1, 0.5, 0.1, -0.4);
        for block in samples.as_chunks::<8>().0 {
            let (values, slopes) = dispatch!(Level::new(), simd => {
                let lanes = |entry: &dyn Fn(&Matrix3) -> f64| {
                    f64x8::simd_from(simd, std::array::from_fn::<f64, 8, _>(|l| entry(&block[l])))
                };
                let load = |of: &dyn Fn(&Matrix3) -> Matrix3| -> [[_; 3]; 3] {
                    [0, 1, 2].map(|i| [0, 1, 2].map(|j| lanes(&|a| of(a)[(i, j)])))
                };
                let (value, slope) =
                    isotropic_with_slope(&load(&|a| *a), &load(&|_| direction), &Cube);
                let store = |m: [[f64x8<_>; 3]; 3]| m.map(|row| row.map(<[f64; 8]>::from));
                (store(value), store(slope))
            });
            for (lane, a) in block.iter().enumerate() {
                let one = isotropic_with_slope(&tensor(a), &tensor(&direction), &Cube);
                let of = |m: [[[f64; 8]; 3]; 3]| m.map(|row| row.map(|entry| entry[lane]));
                assert_eq!((of(values), of(slopes)), one, "{a}");
            }
        }
    }
}
