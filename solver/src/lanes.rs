//! Four numbers side by side in memory, and their way into the processor.

use crate::real::{Dual, Real};
use fearless_simd::{Simd, f64x4, prelude::*};

/// Four numbers on their own boundary of 32 bytes: the displacement or the force
/// of a node, the fourth being padding, or one number at four points.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(32))]
pub struct Four(pub [f64; 4]);

/// Runs `$body` with `$simd` bound to the vector instructions of `$level`. On
/// x86-64 these are AVX2 with fused products, on processors with AVX-512 too
/// (four numbers are four numbers), or what every such processor has.
macro_rules! with_vectors {
    ($level:expr, $simd:ident => $body:expr) => {{
        #[cfg(target_arch = "x86_64")]
        match ($level.as_avx2(), $level.as_sse2()) {
            (Some($simd), _) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || $body,
            ),
            (None, Some($simd)) => $body,
            (None, None) => unreachable!("x86-64 has SSE2"),
        }
        #[cfg(not(target_arch = "x86_64"))]
        fearless_simd::dispatch!($level, $simd => $body)
    }};
}
pub(crate) use with_vectors;

/// Numbers at points, four to an entry, and their derivatives in one direction
/// where these are wanted.
#[derive(Debug, Clone, Default)]
pub struct Parts {
    pub values: Vec<Four>,
    pub slopes: Vec<Four>,
}

impl Parts {
    pub fn new(count: usize) -> Parts {
        Parts { values: vec![Four::default(); count], slopes: vec![Four::default(); count] }
    }
}

/// Four [`Real`] numbers that [`Parts`] hold.
pub trait Lanes<S: Simd>: Real {
    const SLOPES: bool;
    fn load(simd: S, parts: &Parts, entry: usize) -> Self;
    fn store(self, parts: &mut Parts, entry: usize);
    /// From a function of values or of slopes and of the lane.
    fn from_parts(simd: S, parts: &Parts, number: impl Fn(&[Four], usize) -> f64) -> Self;
    /// Each lane to an entry and a place in it.
    fn spread(self, parts: &mut Parts, place: impl Fn(usize) -> (usize, usize));
}

#[inline(always)]
fn spread<S: Simd>(numbers: f64x4<S>, fours: &mut [Four], place: impl Fn(usize) -> (usize, usize)) {
    for lane in 0..4 {
        let (entry, k) = place(lane);
        fours[entry].0[k] = numbers[lane];
    }
}

impl<S: Simd> Lanes<S> for f64x4<S> {
    const SLOPES: bool = false;

    #[inline(always)]
    fn load(simd: S, parts: &Parts, entry: usize) -> Self {
        parts.values[entry].0.simd_into(simd)
    }

    #[inline(always)]
    fn store(self, parts: &mut Parts, entry: usize) {
        parts.values[entry].0 = self.into();
    }

    #[inline(always)]
    fn from_parts(simd: S, parts: &Parts, number: impl Fn(&[Four], usize) -> f64) -> Self {
        f64x4::from_fn(
            simd,
            #[inline(always)]
            |lane| number(&parts.values, lane),
        )
    }

    #[inline(always)]
    fn spread(self, parts: &mut Parts, place: impl Fn(usize) -> (usize, usize)) {
        spread(self, &mut parts.values, place);
    }
}

impl<S: Simd> Lanes<S> for Dual<f64x4<S>> {
    const SLOPES: bool = true;

    #[inline(always)]
    fn load(simd: S, parts: &Parts, entry: usize) -> Self {
        Dual {
            value: parts.values[entry].0.simd_into(simd),
            slope: parts.slopes[entry].0.simd_into(simd),
        }
    }

    #[inline(always)]
    fn store(self, parts: &mut Parts, entry: usize) {
        parts.values[entry].0 = self.value.into();
        parts.slopes[entry].0 = self.slope.into();
    }

    #[inline(always)]
    fn from_parts(simd: S, parts: &Parts, number: impl Fn(&[Four], usize) -> f64) -> Self {
        Dual {
            value: f64x4::from_fn(
                simd,
                #[inline(always)]
                |lane| number(&parts.values, lane),
            ),
            slope: f64x4::from_fn(
                simd,
                #[inline(always)]
                |lane| number(&parts.slopes, lane),
            ),
        }
    }

    #[inline(always)]
    fn spread(self, parts: &mut Parts, place: impl Fn(usize) -> (usize, usize)) {
        spread(self.value, &mut parts.values, &place);
        spread(self.slope, &mut parts.slopes, &place);
    }
}
