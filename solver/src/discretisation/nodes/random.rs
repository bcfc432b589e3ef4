//! Random numbers that depend on the seed alone.

use crate::algebra::tensor::Vector3;

/// SplitMix64 (Steele, Lea & Flood 2014).
pub(super) struct SplitMix64(pub u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Three numbers, each uniform in −1 ≤ r < 1.
    pub fn vector(&mut self) -> Vector3 {
        Vector3::from_fn(|_, _| (self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    }
}
