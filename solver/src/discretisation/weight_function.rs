//! Weight functions of the moving least squares.

use crate::problem::WeightFunction;
use std::ops::{Add, Mul, Sub};

impl WeightFunction {
    /// Every weight function, for tests and studies that loop over them.
    pub const ALL: [WeightFunction; 3] =
        [WeightFunction::CubicSpline, WeightFunction::QuarticSpline, WeightFunction::Exponential];

    /// W(q) and dW/dq for q = |X − X_a|/r_a ≥ 0; both vanish for q ≥ 1, and
    /// dW/dq vanishes at q = 0 (Belytschko, Lu, Gu 1994; Liu 2009, section 3.2).
    #[inline]
    pub fn value_and_derivative(self, q: f64) -> (f64, f64) {
        if q >= 1.0 {
            return (0.0, 0.0);
        }
        match self {
            WeightFunction::CubicSpline if q <= 0.5 => {
                (2.0 / 3.0 + q * q * (4.0 * q - 4.0), q * (12.0 * q - 8.0))
            }
            WeightFunction::CubicSpline => {
                let p = 1.0 - q;
                (4.0 / 3.0 * p * p * p, -4.0 * p * p)
            }
            WeightFunction::QuarticSpline => quartic_spline(q, |x| x),
            WeightFunction::Exponential => {
                // Width 0.4 of the radius; shifted so that W(1) = 0.
                let sharpness: f64 = 1.0 / (0.4 * 0.4);
                let edge = (-sharpness).exp();
                let bell = (-sharpness * q * q).exp();
                let scale = 1.0 / (1.0 - edge);
                ((bell - edge) * scale, -2.0 * sharpness * q * bell * scale)
            }
        }
    }
}

/// W(q) and dW/dq of the quartic spline for q ≤ 1, of one number or of several side by side, with
/// constants from `constant`.
#[inline(always)]
pub(super) fn quartic_spline<T>(q: T, constant: impl Fn(f64) -> T) -> (T, T)
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let value = q * q * (q * (constant(8.0) - q * constant(3.0)) - constant(6.0)) + constant(1.0);
    (value, q * (q * (constant(24.0) - q * constant(12.0)) - constant(12.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivative_is_that_of_the_value() {
        for weight_function in WeightFunction::ALL {
            for i in 1..100 {
                let (q, step) = (i as f64 * 0.01, 1e-6);
                let plus = weight_function.value_and_derivative(q + step).0;
                let minus = weight_function.value_and_derivative(q - step).0;
                let slope = weight_function.value_and_derivative(q).1;
                // The exponential meets its edge with a small kink.
                assert!(
                    ((plus - minus) / (2.0 * step) - slope).abs()
                        < 2e-2 * (q > 0.985) as u8 as f64 + 1e-5
                );
            }
        }
    }

    #[test]
    fn weights_fall_from_the_node_to_zero_at_the_radius() {
        for weight_function in WeightFunction::ALL {
            let mut last = weight_function.value_and_derivative(0.0).0;
            for i in 1..=100 {
                let value = weight_function.value_and_derivative(i as f64 * 0.01).0;
                assert!(value < last && value >= 0.0);
                last = value;
            }
            assert_eq!(last, 0.0);
        }
    }
}
