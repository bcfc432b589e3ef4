//! Numbers side by side in memory, and their way into the processor: four for a
//! node, eight for as many points.

use crate::algebra::real::{Dual, Real};
use fearless_simd::{Simd, f64x4, f64x8, prelude::*};

/// Four numbers on their own boundary of 32 bytes: the displacement of a node, the
/// force on it or a column of a tensor; the fourth is padding.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(32))]
pub struct Four(pub [f64; 4]);

/// One number at eight points.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Eight(pub [f64; 8]);

#[inline(always)]
pub fn four<S: Simd>(simd: S, numbers: &Four) -> f64x4<S> {
    numbers.0.simd_into(simd)
}

#[inline(always)]
pub fn eight<S: Simd>(simd: S, numbers: &Eight) -> f64x8<S> {
    numbers.0.simd_into(simd)
}

/// Has the processor fetch an entry that will be read soon; nothing if there is
/// none or the processor cannot be told.
#[inline(always)]
pub fn prefetch<T>(entries: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(entry) = entries.get(index) {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // A hint: the address is that of an entry, and nothing is read or written.
        #[allow(unsafe_code)]
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(entry).cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (entries, index);
}

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

/// Values, and their derivatives in one direction where these are wanted.
#[derive(Debug, Clone, Default)]
pub struct Parts<T> {
    pub values: Vec<T>,
    pub slopes: Vec<T>,
}

impl<T: Clone + Default> Parts<T> {
    pub fn new(count: usize) -> Parts<T> {
        Parts { values: vec![T::default(); count], slopes: vec![T::default(); count] }
    }
}

/// A [`Real`] at eight points. Eight rather than four, so that one half need not
/// wait for the other.
pub trait Lanes<S: Simd>: Real {
    const SLOPES: bool;
    fn constant(simd: S, value: f64) -> Self;
    fn load(simd: S, parts: &Parts<Eight>, entry: usize) -> Self;
    fn store(self, parts: &mut Parts<Eight>, entry: usize);
    /// Component `place(lane).1` of column `place(lane).0` \[lane\].
    fn gather(simd: S, parts: &Parts<Four>, place: impl Fn(usize) -> (usize, usize)) -> Self;
    /// The opposite of [`Lanes::gather`].
    fn spread(self, parts: &mut Parts<Four>, place: impl Fn(usize) -> (usize, usize));
}

impl<S: Simd> Lanes<S> for f64x8<S> {
    const SLOPES: bool = false;

    #[inline(always)]
    fn constant(simd: S, value: f64) -> Self {
        f64x8::splat(simd, value)
    }

    #[inline(always)]
    fn load(simd: S, parts: &Parts<Eight>, entry: usize) -> Self {
        eight(simd, &parts.values[entry])
    }

    #[inline(always)]
    fn store(self, parts: &mut Parts<Eight>, entry: usize) {
        parts.values[entry].0 = self.into();
    }

    #[inline(always)]
    fn gather(simd: S, parts: &Parts<Four>, place: impl Fn(usize) -> (usize, usize)) -> Self {
        gather(simd, &parts.values, place)
    }

    #[inline(always)]
    fn spread(self, parts: &mut Parts<Four>, place: impl Fn(usize) -> (usize, usize)) {
        spread(self, &mut parts.values, place);
    }
}

impl<S: Simd> Lanes<S> for Dual<f64x8<S>> {
    const SLOPES: bool = true;

    #[inline(always)]
    fn constant(simd: S, value: f64) -> Self {
        Dual { value: f64x8::splat(simd, value), slope: f64x8::splat(simd, 0.0) }
    }

    #[inline(always)]
    fn load(simd: S, parts: &Parts<Eight>, entry: usize) -> Self {
        Dual { value: eight(simd, &parts.values[entry]), slope: eight(simd, &parts.slopes[entry]) }
    }

    #[inline(always)]
    fn store(self, parts: &mut Parts<Eight>, entry: usize) {
        parts.values[entry].0 = self.value.into();
        parts.slopes[entry].0 = self.slope.into();
    }

    #[inline(always)]
    fn gather(simd: S, parts: &Parts<Four>, place: impl Fn(usize) -> (usize, usize)) -> Self {
        Dual {
            value: gather(simd, &parts.values, &place),
            slope: gather(simd, &parts.slopes, &place),
        }
    }

    #[inline(always)]
    fn spread(self, parts: &mut Parts<Four>, place: impl Fn(usize) -> (usize, usize)) {
        spread(self.value, &mut parts.values, &place);
        spread(self.slope, &mut parts.slopes, &place);
    }
}

#[inline(always)]
fn gather<S: Simd>(simd: S, fours: &[Four], place: impl Fn(usize) -> (usize, usize)) -> f64x8<S> {
    f64x8::from_fn(
        simd,
        #[inline(always)]
        |lane| fours[place(lane).0].0[place(lane).1],
    )
}

#[inline(always)]
fn spread<S: Simd>(numbers: f64x8<S>, fours: &mut [Four], place: impl Fn(usize) -> (usize, usize)) {
    for lane in 0..8 {
        let (entry, k) = place(lane);
        fours[entry].0[k] = numbers[lane];
    }
}
