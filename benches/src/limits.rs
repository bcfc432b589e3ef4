//! Limits of the machine: memory bandwidth, multiply-adds, sizes of the caches.

use fearless_simd::{Level, Simd, dispatch, prelude::*};
use rayon::prelude::*;
use std::hint::black_box;

/// a = b + s c over arrays that exceed every cache (McCalpin 1995, STREAM).
pub struct Triad {
    a: Vec<f64>,
    b: Vec<f64>,
    c: Vec<f64>,
}

impl Triad {
    /// Arrays of `bytes` each.
    pub fn new(bytes: usize) -> Triad {
        let count = bytes / size_of::<f64>();
        Triad { a: vec![0.0; count], b: vec![1.0; count], c: vec![2.0; count] }
    }

    /// Bytes of one pass: two reads and a write, as STREAM counts them.
    pub fn bytes(&self) -> usize {
        3 * size_of::<f64>() * self.a.len()
    }

    /// One pass on this thread.
    pub fn pass(&mut self) {
        triad(&mut self.a, &self.b, &self.c);
    }

    /// One pass on all threads of the current pool.
    pub fn parallel_pass(&mut self) {
        let part = self.a.len().div_ceil(rayon::current_num_threads()).max(1);
        let Triad { a, b, c } = self;
        a.par_chunks_mut(part)
            .zip(b.par_chunks(part))
            .zip(c.par_chunks(part))
            .for_each(|((a, b), c)| triad(a, b, c));
    }
}

fn triad(a: &mut [f64], b: &[f64], c: &[f64]) {
    let factor = black_box(3.0);
    dispatch!(Level::new(), simd => triad_with(simd, a, b, c, factor));
    black_box(a);
}

#[inline(always)]
fn triad_with<S: Simd>(_: S, a: &mut [f64], b: &[f64], c: &[f64], factor: f64) {
    for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
        *a = b + factor * c;
    }
}

/// Independent chains of multiply-adds: enough to hide the latency, and few enough for the
/// registers.
const CHAINS: usize = 12;

/// Sum of the chains, and numbers per SIMD vector.
#[inline(always)]
fn chains<S: Simd>(simd: S, rounds: usize) -> (f64, usize) {
    let factor = S::f64s::splat(simd, black_box(0.999));
    let shift = S::f64s::splat(simd, black_box(0.001));
    let mut chains = [S::f64s::splat(simd, black_box(2.0)); CHAINS];
    for _ in 0..rounds {
        for chain in &mut chains {
            *chain = chain.mul_add(factor, shift);
        }
    }
    (chains.iter().map(|chain| chain.reduce_sum()).sum(), S::f64s::LEN)
}

/// Performs `rounds` multiply-adds per chain; returns the numbers per SIMD vector.
pub fn multiply_adds(rounds: usize) -> usize {
    let (sum, lanes) = dispatch!(Level::new(), simd => chains(simd, rounds));
    black_box(sum);
    lanes
}

/// Floating-point operations of [`multiply_adds`], two per multiply-add.
pub fn operations(rounds: usize, lanes: usize) -> f64 {
    (2 * CHAINS * rounds * lanes) as f64
}

/// Sizes of the second cache of a core and of the last cache \[bytes\]; those
/// of a common processor where they are not known.
pub fn caches() -> (usize, usize) {
    let second = cache(2).unwrap_or(1 << 20);
    (second, cache(3).unwrap_or(32 << 20).max(second))
}

/// Size \[bytes\] of the first processor's data cache of a level.
fn cache(level: u8) -> Option<usize> {
    let folder = std::path::Path::new("/sys/devices/system/cpu/cpu0/cache");
    let read = |index: usize, name: &str| {
        let file = folder.join(format!("index{index}")).join(name);
        std::fs::read_to_string(file).ok().map(|text| text.trim().to_string())
    };
    let holds_data = |index: &usize| {
        read(*index, "level").as_deref() == Some(&level.to_string())
            && read(*index, "type").is_some_and(|kind| kind != "Instruction")
    };
    let size = read((0..8).find(holds_data)?, "size")?;
    let number: usize = size.trim_end_matches(['K', 'M']).parse().ok()?;
    Some(number << if size.ends_with('M') { 20 } else { 10 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triad_is_the_same_on_one_thread_and_on_all() {
        let mut triad = Triad::new(8 * 1001);
        triad.pass();
        assert!(triad.a.iter().all(|a| *a == 7.0));
        triad.a.fill(0.0);
        triad.parallel_pass();
        assert!(triad.a.iter().all(|a| *a == 7.0));
        assert_eq!(triad.bytes(), 24 * 1001);
    }
}
