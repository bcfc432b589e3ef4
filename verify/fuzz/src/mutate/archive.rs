//! Mutations inside gzip data, and data that inflate to far more than they are.

use fastrand::Rng;
use flate2::{Compression, read::GzDecoder, write::GzEncoder};
use std::io::{Read, Write};

/// First bytes of gzip data.
const MAGIC: &[u8] = &[0x1f, 0x8b, 8];
/// Inflated data are cut here \[byte\].
const MOST_INFLATED: u64 = 1 << 20;
/// Zeros in one member of a bomb \[byte\], and the most members.
const MEMBER: usize = 8 << 20;
const MOST_MEMBERS: usize = 400;

/// Where gzip data begin.
pub(crate) fn start(bytes: &[u8]) -> Option<usize> {
    bytes.windows(MAGIC.len()).position(|window| window == MAGIC)
}

/// Gzip data of some bytes.
pub(crate) fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).unwrap_or_default()
}

/// The inflated data changed by `change`, or followed by members of zeros.
pub(crate) fn mutated(
    data: &[u8],
    rng: &mut Rng,
    change: impl Fn(&[u8], &mut Rng) -> Vec<u8>,
) -> Vec<u8> {
    if rng.usize(..40) == 0 {
        let member = compressed(&vec![0; MEMBER]);
        return [data, &member.repeat(1 + rng.usize(..MOST_MEMBERS))].concat();
    }
    let mut inner = Vec::new();
    // Damaged data are changed as far as they can be read.
    let _ = GzDecoder::new(data).take(MOST_INFLATED).read_to_end(&mut inner);
    compressed(&change(&inner, rng))
}
