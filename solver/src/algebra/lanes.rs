//! Numbers at eight quadrature points side by side, for vector instructions.

use crate::algebra::real::{Dual, Real};
use crate::algebra::spectral::Plain;
use fearless_simd::{Simd, f64x8, prelude::*};
use std::marker::PhantomData;

/// One number at eight quadrature points.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[repr(C, align(64))]
pub struct SimdBlock(pub [f64; 8]);

/// Quadrature points in a [`SimdBlock`].
pub const LANES: usize = 8;

#[inline(always)]
pub fn load_block<S: Simd>(simd: S, block: &SimdBlock) -> f64x8<S> {
    block.0.simd_into(simd)
}

/// Prefetches an entry that will be read soon; does nothing where there is no such
/// entry or no such instruction.
#[inline(always)]
pub fn prefetch<T>(entries: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if let Some(entry) = entries.get(index) {
        use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
        // SAFETY: a hint at the address of an entry, which reads and writes nothing.
        #[allow(unsafe_code)]
        unsafe {
            _mm_prefetch::<_MM_HINT_T1>(std::ptr::from_ref(entry).cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (entries, index);
}

/// Runs `$body` with `$simd` bound to the vector instructions of `$level`, and
/// `$numbers` to the numbers that constitutive laws are evaluated in. On x86-64 these
/// are AVX2 with fused products and eight points at a time, also on processors with
/// AVX-512; older processors, for which a second copy of every law would be compiled
/// into four times the code, take one point at a time.
macro_rules! with_vectors {
    ($level:expr, ($simd:ident, $numbers:ident) => $body:expr) => {{
        #[cfg(target_arch = "x86_64")]
        match ($level.as_avx2(), $level.as_sse2()) {
            (Some($simd), _) => fearless_simd::Simd::vectorize(
                $simd,
                #[inline(always)]
                || {
                    let $numbers = $crate::algebra::lanes::eight_points($simd);
                    $body
                },
            ),
            (None, Some($simd)) => {
                let $numbers = std::marker::PhantomData::<f64>;
                $body
            }
            (None, None) => unreachable!("x86-64 has SSE2"),
        }
        #[cfg(not(target_arch = "x86_64"))]
        fearless_simd::dispatch!($level, $simd => {
            let $numbers = $crate::algebra::lanes::eight_points($simd);
            $body
        })
    }};
}
pub(crate) use with_vectors;

/// The type of a number at eight points, without a value.
#[inline(always)]
pub fn eight_points<S: Simd>(_: S) -> PhantomData<f64x8<S>> {
    PhantomData
}

/// The type of a number with its derivative, without a value.
#[inline(always)]
pub fn with_slopes<N>(_: PhantomData<N>) -> PhantomData<Dual<N>> {
    PhantomData
}

/// Values and, where these are computed, their derivatives in one direction.
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

/// A number at all points of a [`SimdBlock`], or at one of them.
pub trait Number<S: Simd>: Real + Plain {
    /// Numbers of this type in a block; `piece` counts them.
    const PER_BLOCK: usize;
    fn read(simd: S, block: &SimdBlock, piece: usize) -> Self;
    fn write(self, block: &mut SimdBlock, piece: usize);
}

impl<S: Simd> Number<S> for f64x8<S> {
    const PER_BLOCK: usize = 1;

    #[inline(always)]
    fn read(simd: S, block: &SimdBlock, _piece: usize) -> Self {
        load_block(simd, block)
    }

    #[inline(always)]
    fn write(self, block: &mut SimdBlock, _piece: usize) {
        block.0 = self.into();
    }
}

impl<S: Simd> Number<S> for f64 {
    const PER_BLOCK: usize = LANES;

    #[inline(always)]
    fn read(_simd: S, block: &SimdBlock, piece: usize) -> Self {
        block.0[piece]
    }

    #[inline(always)]
    fn write(self, block: &mut SimdBlock, piece: usize) {
        block.0[piece] = self;
    }
}

/// A [`Number`], with or without its derivative.
pub trait Lanes<S: Simd>: Real {
    /// Whether it has a derivative.
    const SLOPES: bool;
    /// As [`Number::PER_BLOCK`].
    const PER_BLOCK: usize;
    fn load(simd: S, parts: &Parts<SimdBlock>, entry: usize, piece: usize) -> Self;
    /// A number that does not change.
    fn fixed(simd: S, block: &SimdBlock, piece: usize) -> Self;
    fn store(self, parts: &mut Parts<SimdBlock>, entry: usize, piece: usize);
    /// Writes the value alone.
    fn write(self, simd: S, block: &mut SimdBlock, piece: usize);
}

/// Implements [`Lanes`] for a [`Number`].
macro_rules! lanes_of_values {
    ($number:ty) => {
        impl<S: Simd> Lanes<S> for $number {
            const SLOPES: bool = false;
            const PER_BLOCK: usize = <Self as Number<S>>::PER_BLOCK;

            #[inline(always)]
            fn load(simd: S, parts: &Parts<SimdBlock>, entry: usize, piece: usize) -> Self {
                Number::read(simd, &parts.values[entry], piece)
            }

            #[inline(always)]
            fn fixed(simd: S, block: &SimdBlock, piece: usize) -> Self {
                Number::read(simd, block, piece)
            }

            #[inline(always)]
            fn store(self, parts: &mut Parts<SimdBlock>, entry: usize, piece: usize) {
                Number::<S>::write(self, &mut parts.values[entry], piece);
            }

            #[inline(always)]
            fn write(self, _simd: S, block: &mut SimdBlock, piece: usize) {
                Number::<S>::write(self, block, piece);
            }
        }
    };
}
lanes_of_values!(f64);
lanes_of_values!(f64x8<S>);

impl<S: Simd, N: Number<S>> Lanes<S> for Dual<N> {
    const SLOPES: bool = true;
    const PER_BLOCK: usize = N::PER_BLOCK;

    #[inline(always)]
    fn load(simd: S, parts: &Parts<SimdBlock>, entry: usize, piece: usize) -> Self {
        Dual {
            value: N::read(simd, &parts.values[entry], piece),
            slope: N::read(simd, &parts.slopes[entry], piece),
        }
    }

    #[inline(always)]
    fn fixed(simd: S, block: &SimdBlock, piece: usize) -> Self {
        let value = N::read(simd, block, piece);
        Dual { value, slope: value * 0.0 }
    }

    #[inline(always)]
    fn store(self, parts: &mut Parts<SimdBlock>, entry: usize, piece: usize) {
        self.value.write(&mut parts.values[entry], piece);
        self.slope.write(&mut parts.slopes[entry], piece);
    }

    #[inline(always)]
    fn write(self, _simd: S, block: &mut SimdBlock, piece: usize) {
        self.value.write(block, piece);
    }
}
