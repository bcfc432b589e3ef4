//! The number types of the hot loop: one `f64`, eight of them side by side, or
//! either with its derivative in one direction.

use crate::algebra::spectral::{Plain, Scalar, isotropic, isotropic_with_slope};
use fearless_simd::{Simd, f64x8, prelude::*};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The operations that constitutive laws and the volumetric projection need.
pub trait Real:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// self · a + b, rounded once where the processor can.
    fn times_plus(self, a: Self, b: Self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Exponential function.
    fn exp(self) -> Self;
    /// Another number where this one is not negative, else 0.
    fn where_not_negative(self, other: Self) -> Self;
    /// |x|^(−2/3).
    fn power_minus_two_thirds(self) -> Self;
    /// g(A) = Σ_k g(a_k) n_k ⊗ n_k of a symmetric tensor (method book, eq. 3.17).
    fn isotropic(a: &[[Self; 3]; 3], g: &impl Scalar) -> [[Self; 3]; 3];
    /// A function of a tensor that takes one number after the other, with its derivative.
    fn one_by_one(a: &[[Self; 3]; 3], f: &impl Fn(&Single) -> Single) -> [[Self; 3]; 3];
}

/// A tensor at one point with its derivative in one direction.
pub type Single = [[Dual<f64>; 3]; 3];

impl Real for f64 {
    #[inline(always)]
    fn times_plus(self, a: f64, b: f64) -> f64 {
        // Not f64::mul_add: a call into the C library where the target has none.
        self * a + b
    }

    #[inline(always)]
    fn ln(self) -> f64 {
        f64::ln(self)
    }

    #[inline(always)]
    fn exp(self) -> f64 {
        f64::exp(self)
    }

    #[inline(always)]
    fn where_not_negative(self, other: f64) -> f64 {
        if self >= 0.0 { other } else { 0.0 }
    }

    #[inline(always)]
    fn power_minus_two_thirds(self) -> f64 {
        let root = self.cbrt();
        1.0 / (root * root)
    }

    #[inline(always)]
    fn isotropic(a: &[[f64; 3]; 3], g: &impl Scalar) -> [[f64; 3]; 3] {
        isotropic(a, g)
    }

    fn one_by_one(a: &[[f64; 3]; 3], f: &impl Fn(&Single) -> Single) -> [[f64; 3]; 3] {
        without_slopes(a, f)
    }
}

impl<S: Simd> Real for f64x8<S> {
    #[inline(always)]
    fn times_plus(self, a: Self, b: Self) -> Self {
        self.mul_add(a, b)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        f64x8::from_fn(
            self.simd,
            #[inline(always)]
            |lane| self[lane].ln(),
        )
    }

    #[inline(always)]
    fn exp(self) -> Self {
        f64x8::from_fn(
            self.simd,
            #[inline(always)]
            |lane| self[lane].exp(),
        )
    }

    #[inline(always)]
    fn where_not_negative(self, other: Self) -> Self {
        let zero = f64x8::splat(self.simd, 0.0);
        self.simd_ge(zero).select(other, zero)
    }

    /// y = x^(−1/3) from a third of the exponent, which is right to 3.5 %, then two
    /// corrections of fourth order (method book, eq. 11.3).
    #[inline(always)]
    fn power_minus_two_thirds(self) -> Self {
        const START: u64 = 0x553E_F000_0000_0000;
        let x = self.abs();
        let mut y = f64x8::from_fn(
            self.simd,
            #[inline(always)]
            |lane| f64::from_bits(START.wrapping_sub(x[lane].to_bits() / 3)),
        );
        for _ in 0..2 {
            let e = (-x * y).times_plus(y * y, f64x8::splat(self.simd, 1.0));
            let series = (e * (14.0 / 81.0) + 2.0 / 9.0) * e + 1.0 / 3.0;
            y = (y * e).times_plus(series, y);
        }
        y * y
    }

    #[inline(always)]
    fn isotropic(a: &[[Self; 3]; 3], g: &impl Scalar) -> [[Self; 3]; 3] {
        isotropic(a, g)
    }

    #[inline(always)]
    fn one_by_one(a: &[[Self; 3]; 3], f: &impl Fn(&Single) -> Single) -> [[Self; 3]; 3] {
        without_slopes(a, f)
    }
}

/// A value and its exact derivative in one direction (Griewank, Walther 2008).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<R> {
    /// The value.
    pub value: R,
    /// The derivative.
    pub slope: R,
}

impl<R: Real + Plain> Real for Dual<R> {
    #[inline(always)]
    fn times_plus(self, a: Self, b: Self) -> Self {
        Dual {
            value: self.value.times_plus(a.value, b.value),
            slope: self.value.times_plus(a.slope, self.slope.times_plus(a.value, b.slope)),
        }
    }

    #[inline(always)]
    fn ln(self) -> Self {
        Dual { value: self.value.ln(), slope: self.slope / self.value }
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        Dual { value, slope: value * self.slope }
    }

    #[inline(always)]
    fn where_not_negative(self, other: Self) -> Self {
        Dual {
            value: self.value.where_not_negative(other.value),
            slope: self.value.where_not_negative(other.slope),
        }
    }

    #[inline(always)]
    fn power_minus_two_thirds(self) -> Self {
        let power = self.value.power_minus_two_thirds();
        Dual { value: power, slope: power * self.slope / self.value * (-2.0 / 3.0) }
    }

    #[inline(always)]
    fn isotropic(a: &[[Self; 3]; 3], g: &impl Scalar) -> [[Self; 3]; 3] {
        let (zero, mut result) = (a[0][0].value * 0.0, *a);
        let (mut values, mut slopes) = ([[zero; 3]; 3], [[zero; 3]; 3]);
        for i in 0..3 {
            for j in 0..3 {
                (values[i][j], slopes[i][j]) = (a[i][j].value, a[i][j].slope);
            }
        }
        (values, slopes) = isotropic_with_slope(&values, &slopes, g);
        for i in 0..3 {
            for j in 0..3 {
                result[i][j] = Dual { value: values[i][j], slope: slopes[i][j] };
            }
        }
        result
    }

    #[inline(always)]
    fn one_by_one(a: &[[Self; 3]; 3], f: &impl Fn(&Single) -> Single) -> [[Self; 3]; 3] {
        one_by_one(a, f)
    }
}

/// A function of a tensor, point after point.
#[inline(always)]
fn one_by_one<R: Plain>(
    a: &[[Dual<R>; 3]; 3],
    f: &impl Fn(&Single) -> Single,
) -> [[Dual<R>; 3]; 3] {
    let mut result = *a;
    for lane in 0..R::COUNT {
        let at = |x: Dual<R>| Dual { value: x.value.get(lane), slope: x.slope.get(lane) };
        let own = f(&a.map(|row| row.map(at)));
        for (entry, own) in result.iter_mut().flatten().zip(own.iter().flatten()) {
            entry.value.set(lane, own.value);
            entry.slope.set(lane, own.slope);
        }
    }
    result
}

#[inline(always)]
fn without_slopes<R: Plain>(a: &[[R; 3]; 3], f: &impl Fn(&Single) -> Single) -> [[R; 3]; 3] {
    one_by_one(&a.map(|row| row.map(|value| Dual { value, slope: value * 0.0 })), f)
        .map(|row| row.map(|x| x.value))
}

impl From<f64> for Dual<Dual<f64>> {
    fn from(value: f64) -> Self {
        let fixed = |value| Dual { value, slope: 0.0 };
        Dual { value: fixed(value), slope: fixed(0.0) }
    }
}

impl Dual<Dual<f64>> {
    /// g(x), from g, g' and g'' there.
    fn with(self, [g, first, second]: [f64; 3]) -> Self {
        let Dual { value: x, slope } = self;
        let outer = Dual { value: first, slope: second * x.slope };
        Dual { value: Dual { value: g, slope: first * x.slope }, slope: outer * slope }
    }

    /// Exponential function.
    pub fn exp(self) -> Self {
        let g = self.value.value.exp();
        self.with([g, g, g])
    }

    /// Natural logarithm.
    pub fn ln(self) -> Self {
        let x = self.value.value;
        self.with([x.ln(), 1.0 / x, -1.0 / (x * x)])
    }

    /// x to a power.
    pub fn powf(self, power: f64) -> Self {
        let x = self.value.value;
        let first = power * x.powf(power - 1.0);
        self.with([x.powf(power), first, power * (power - 1.0) * x.powf(power - 2.0)])
    }
}

impl<R: Real> Neg for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual { value: -self.value, slope: -self.slope }
    }
}

impl<R: Real> Add for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Dual { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<R: Real> Sub for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Dual { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<R: Real> Mul for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let slope = self.value.times_plus(other.slope, self.slope * other.value);
        Dual { value: self.value * other.value, slope }
    }
}

impl<R: Real> Div for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Dual { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl<R: Real> Add<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, constant: f64) -> Self {
        Dual { value: self.value + constant, slope: self.slope }
    }
}

impl<R: Real> Sub<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, constant: f64) -> Self {
        Dual { value: self.value - constant, slope: self.slope }
    }
}

impl<R: Real> Mul<f64> for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Dual { value: self.value * factor, slope: self.slope * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    const SAMPLES: [f64; 8] = [1e-9, 0.03, 0.7, 0.999, 1.0, 1.3, 27.0, 4e5];

    #[test]
    fn eight_lanes_give_the_powers_of_one() {
        for chunk in [SAMPLES] {
            let powers: [f64; 8] = dispatch!(Level::new(), simd => {
                f64x8::simd_from(simd, chunk).power_minus_two_thirds().into()
            });
            for (x, power) in chunk.iter().zip(powers) {
                approx::assert_relative_eq!(power, x.powf(-2.0 / 3.0), max_relative = 1e-15);
            }
        }
    }

    #[test]
    fn mixed_slopes_are_derivatives_of_slopes() {
        type Function = fn(Dual<Dual<f64>>) -> Dual<Dual<f64>>;
        let functions: [Function; 3] = [|x| (x * x).exp(), |x| (x * 3.0).ln(), |x| x.powf(-1.7)];
        for function in functions {
            let at = |x: f64| {
                let value = Dual { value: x, slope: 1.0 };
                function(Dual { value, slope: Dual { value: 1.0, slope: 0.0 } })
            };
            for x in [0.4, 1.0, 1.5] {
                let [less, same, more] = [x - 1e-5, x, x + 1e-5].map(at);
                let first = (more.value.value - less.value.value) / 2e-5;
                let second = (more.slope.value - less.slope.value) / 2e-5;
                approx::assert_relative_eq!(same.slope.value, first, max_relative = 1e-7);
                approx::assert_relative_eq!(same.value.slope, first, max_relative = 1e-7);
                approx::assert_relative_eq!(same.slope.slope, second, max_relative = 1e-7);
            }
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        let function = |x: Dual<f64>| {
            let rational = (x * x + 2.0) / (x * 3.0 - 0.5);
            rational.times_plus(x.ln(), -x.power_minus_two_thirds())
        };
        let at = |x: f64| function(Dual { value: x, slope: 1.0 });
        for x in [0.4, 1.0, 2.5] {
            let difference = (at(x + 1e-6).value - at(x - 1e-6).value) / 2e-6;
            approx::assert_relative_eq!(at(x).slope, difference, max_relative = 1e-8);
        }
    }
}
