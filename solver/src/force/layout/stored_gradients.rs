//! Grad φ in the precision in which it is stored.

use super::local_vectors::QUAD;
use fearless_simd::{Simd, f64x4, prelude::*};

/// Grad φ, one quad of numbers for each component of a slot \[1/m\].
#[derive(Debug, Clone)]
pub enum StoredGradients {
    Double(Vec<DoubleQuad>),
    Single(Vec<SingleQuad>),
}

/// Runs `$body` with `$gradients` bound to the quads of `$stored`.
macro_rules! with_gradients {
    ($stored:expr, $gradients:ident => $body:expr) => {
        match $stored {
            $crate::force::StoredGradients::Double($gradients) => $body,
            $crate::force::StoredGradients::Single($gradients) => $body,
        }
    };
}
pub(crate) use with_gradients;

/// One component of Grad φ at four points, which never lies in two lines of a cache.
pub trait GradientQuad: Copy {
    /// Rounds to what is stored.
    fn new(numbers: [f64; QUAD]) -> Self;
    /// The component at one point.
    fn at(&self, lane: usize) -> f64;
    /// All four, in double precision.
    fn widen<S: Simd>(&self, simd: S) -> f64x4<S>;
}

/// In double precision.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct DoubleQuad([f64; QUAD]);

impl GradientQuad for DoubleQuad {
    fn new(numbers: [f64; QUAD]) -> DoubleQuad {
        DoubleQuad(numbers)
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> f64 {
        self.0[lane]
    }

    #[inline(always)]
    fn widen<S: Simd>(&self, simd: S) -> f64x4<S> {
        self.0.simd_into(simd)
    }
}

/// In single precision.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
pub struct SingleQuad([f32; QUAD]);

impl GradientQuad for SingleQuad {
    fn new(numbers: [f64; QUAD]) -> SingleQuad {
        SingleQuad(numbers.map(|x| x as f32))
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> f64 {
        self.0[lane] as f64
    }

    #[inline(always)]
    fn widen<S: Simd>(&self, simd: S) -> f64x4<S> {
        // Not `map`: its closure would be a call where it is not inlined.
        let mut wide = [0.0; QUAD];
        for (wide, stored) in wide.iter_mut().zip(self.0) {
            *wide = stored as f64;
        }
        wide.simd_into(simd)
    }
}
