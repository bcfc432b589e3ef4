//! Grad φ in the precision in which it is stored.

/// Grad φ, `components` numbers per support entry \[1/m\].
#[derive(Debug, Clone)]
pub enum StoredGradients {
    Double(Vec<f64>),
    Single(Vec<f32>),
}

/// Runs `$body` with `$gradients` bound to the numbers of `$stored`.
macro_rules! with_gradients {
    ($stored:expr, $gradients:ident => $body:expr) => {
        match $stored {
            $crate::model::blocks::StoredGradients::Double($gradients) => $body,
            $crate::model::blocks::StoredGradients::Single($gradients) => $body,
        }
    };
}
pub(crate) use with_gradients;

/// A number type in which gradients are stored.
pub trait StoredNumber: Copy + Into<f64> {
    /// Four gradients in double precision, in `buffer` if stored in another one:
    /// a copy of doubles would have to be completed before forces are written.
    fn widen<'a, const D: usize>(
        four: &'a [[Self; D]; 4],
        buffer: &'a mut [[f64; D]; 4],
    ) -> &'a [[f64; D]; 4];
}

impl StoredNumber for f64 {
    #[inline(always)]
    fn widen<'a, const D: usize>(
        four: &'a [[f64; D]; 4],
        _buffer: &'a mut [[f64; D]; 4],
    ) -> &'a [[f64; D]; 4] {
        four
    }
}

impl StoredNumber for f32 {
    #[inline(always)]
    fn widen<'a, const D: usize>(
        four: &'a [[f32; D]; 4],
        buffer: &'a mut [[f64; D]; 4],
    ) -> &'a [[f64; D]; 4] {
        // Not `map`: its closure would be a call where it is not inlined.
        for (wide, stored) in buffer.iter_mut().zip(four) {
            for j in 0..D {
                wide[j] = stored[j] as f64;
            }
        }
        buffer
    }
}
