//! Pseudo-random numbers that are the same in every run.

use crate::algebra::tensor::Vector3;

/// SplitMix64 (Steele, Lea, Flood 2014), made from its seed, on which alone the
/// numbers depend.
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// Uniform in −1 ≤ r < 1.
    pub fn symmetric(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A vector of such numbers, 0 beyond the first `components`.
    pub fn vector(&mut self, components: usize) -> Vector3 {
        Vector3::from_fn(|k, _| if k < components { self.symmetric() } else { 0.0 })
    }
}

/// Uniform numbers in −½ ≤ r < ½, the same ones in every run, for the starting
/// vectors of eigensolvers.
pub(crate) fn noise() -> impl FnMut() -> f64 {
    let mut next = xorshift(0x9E37_79B9_7F4A_7C15);
    move || (next() >> 11) as f64 / (1u64 << 53) as f64 - 0.5
}

/// Xorshift (Marsaglia 2003) from a nonzero state.
pub(crate) fn xorshift(mut state: u64) -> impl FnMut() -> u64 {
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    }
}
