//! Mutations of bytes.

use crate::dictionary::{FLOATS, INTEGERS};
use fastrand::Rng;

/// Headers of the formats that are read lie in so many bytes.
const HEADER: usize = 400;

/// A changed copy.
pub(crate) fn mutated(bytes: &[u8], rng: &mut Rng) -> Vec<u8> {
    let mut new = bytes.to_vec();
    if new.is_empty() {
        return vec![rng.u8(..)];
    }
    let at = place(new.len(), rng);
    match rng.usize(..12) {
        0..3 => new[at] ^= 1 << rng.usize(..8),
        3..8 => overwrite(&mut new, at, &number(rng)),
        8 => new.truncate(at),
        9 => drop(new.splice(at..at, [rng.u8(..), 0, 0xff][..rng.usize(1..4)].iter().copied())),
        10 => drop(new.drain(at..(at + 1 + rng.usize(..64)).min(bytes.len()))),
        _ => {
            let end = (at + 1 + rng.usize(..256)).min(new.len());
            let chunk = new[at..end].to_vec();
            new.splice(at..at, chunk);
        }
    }
    new
}

/// The front of one file and the rest of another.
pub(crate) fn spliced(bytes: &[u8], other: &[u8], rng: &mut Rng) -> Vec<u8> {
    let cut = |bytes: &[u8], rng: &mut Rng| rng.usize(..=bytes.len());
    let (first, second) = (cut(bytes, rng), cut(other, rng));
    [&bytes[..first], &other[second..]].concat()
}

/// Half of the time in the header, half of that on a border of four bytes.
fn place(length: usize, rng: &mut Rng) -> usize {
    let end = if rng.bool() { length.min(HEADER) } else { length };
    let at = rng.usize(..end);
    if rng.bool() { at & !3 } else { at }
}

fn overwrite(bytes: &mut [u8], at: usize, new: &[u8]) {
    let end = (at + new.len()).min(bytes.len());
    bytes[at..end].copy_from_slice(&new[..end - at]);
}

/// A number of 1 to 8 bytes in either order.
fn number(rng: &mut Rng) -> Vec<u8> {
    let integer = INTEGERS[rng.usize(..INTEGERS.len())].to_le_bytes();
    let float = FLOATS[rng.usize(..FLOATS.len())];
    let mut bytes = match rng.usize(..6) {
        0 => integer[..1].to_vec(),
        1 => integer[..2].to_vec(),
        2 => integer[..4].to_vec(),
        3 => integer.to_vec(),
        4 => (float as f32).to_le_bytes().to_vec(),
        _ => float.to_le_bytes().to_vec(),
    };
    if rng.usize(..3) == 0 {
        bytes.reverse();
    }
    bytes
}
