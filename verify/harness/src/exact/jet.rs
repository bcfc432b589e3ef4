//! Functions of the reference position with their first and second derivatives,
//! exact to round-off (forward differentiation; Griewank and Walther 2008,
//! chapter 13).
#![allow(non_snake_case)]

use mtled::algebra::tensor::{Matrix3, Vector3};
use std::ops::{Add, Mul};

/// The value of a function at a point, its gradient and its Hessian.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Jet {
    /// f
    pub value: f64,
    /// ∂f/∂X_i
    pub gradient: Vector3,
    /// ∂²f/∂X_i∂X_j
    pub hessian: Matrix3,
}

impl Jet {
    /// The coordinates x, y, z themselves.
    pub(crate) fn coordinates(X: &Vector3) -> [Jet; 3] {
        [0, 1, 2].map(|k| Jet {
            value: X[k],
            gradient: Vector3::ith(k, 1.0),
            hessian: Matrix3::zeros(),
        })
    }

    /// sin f.
    pub(crate) fn sin(self) -> Jet {
        let (sine, cosine) = self.value.sin_cos();
        self.chain(sine, cosine, -sine)
    }

    /// ln f.
    pub(crate) fn ln(self) -> Jet {
        let f = self.value;
        self.chain(f.ln(), 1.0 / f, -1.0 / (f * f))
    }

    /// g(f) from g, g' and g'' at f: Grad g(f) = g' Grad f and
    /// Hess g(f) = g' Hess f + g'' Grad f ⊗ Grad f.
    fn chain(self, value: f64, first: f64, second: f64) -> Jet {
        let outer = self.gradient * self.gradient.transpose();
        Jet {
            value,
            gradient: self.gradient * first,
            hessian: self.hessian * first + outer * second,
        }
    }
}

impl Add for Jet {
    type Output = Jet;
    fn add(self, other: Jet) -> Jet {
        Jet {
            value: self.value + other.value,
            gradient: self.gradient + other.gradient,
            hessian: self.hessian + other.hessian,
        }
    }
}

impl Add<f64> for Jet {
    type Output = Jet;
    fn add(self, constant: f64) -> Jet {
        Jet { value: self.value + constant, ..self }
    }
}

impl Mul for Jet {
    type Output = Jet;
    fn mul(self, other: Jet) -> Jet {
        let mixed = self.gradient * other.gradient.transpose();
        Jet {
            value: self.value * other.value,
            gradient: self.gradient * other.value + other.gradient * self.value,
            hessian: self.hessian * other.value
                + other.hessian * self.value
                + mixed
                + mixed.transpose(),
        }
    }
}

impl Mul<f64> for Jet {
    type Output = Jet;
    fn mul(self, factor: f64) -> Jet {
        self.chain(self.value * factor, factor, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_limits_of_differences() {
        let f = |X: &Vector3| {
            let [x, y, z] = Jet::coordinates(X);
            (x * y * 3.0).sin() * (z * z + y + 1.0).ln() + x * x * z
        };
        let X = Vector3::new(0.3, 0.7, 0.9);
        let at = f(&X);
        for k in 0..3 {
            let step = Vector3::ith(k, 1e-6);
            let (after, before) = (f(&(X + step)), f(&(X - step)));
            assert!((at.gradient[k] - (after.value - before.value) / 2e-6).abs() < 1e-8);
            let slope = (after.gradient - before.gradient) / 2e-6;
            assert!((at.hessian.column(k) - slope).norm() < 1e-8);
        }
        assert!((at.hessian - at.hessian.transpose()).norm() < 1e-14);
    }
}
