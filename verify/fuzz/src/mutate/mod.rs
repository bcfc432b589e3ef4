//! Inputs that are nearly valid.
//!
//! Files are texts with tokens, lines and paragraphs, or binary with a text in front;
//! compressed parts are mutated inside. Everything follows from the random numbers.

mod archive;
mod binary;
mod input;
mod scene;
mod text;
mod token;

pub(crate) use archive::compressed;
pub use input::Input;
pub(crate) use scene::{drawn_scene, smaller_scenes};

use fastrand::Rng;

/// Larger inputs are cut.
const LARGEST: usize = 4 << 20;

/// A changed copy of `input`; parts of `other` may be taken over. `extensions` are those that
/// the name may have.
pub(crate) fn mutated(input: &Input, other: &Input, extensions: &[&str], rng: &mut Rng) -> Input {
    let mut new = input.clone();
    // One change is most often accepted.
    for _ in 0..1 + rng.usize(..6).saturating_sub(3) {
        new.bytes = once(&new.bytes, &other.bytes, rng);
    }
    new.bytes.truncate(LARGEST);
    if rng.usize(..100) == 0 {
        new.extension = extensions[rng.usize(..extensions.len())].to_string();
    }
    new
}

fn once(bytes: &[u8], other: &[u8], rng: &mut Rng) -> Vec<u8> {
    if rng.usize(..3) > 0
        && let Some(start) = archive::start(bytes)
    {
        let (head, data) = bytes.split_at(start);
        return if head.is_empty() || rng.bool() {
            [head, &archive::mutated(data, rng, |inner, rng| once(inner, other, rng))].concat()
        } else {
            [&plain(head, other, rng)[..], data].concat()
        };
    }
    plain(bytes, other, rng)
}

/// The text in front, or the rest, or the borders between them.
fn plain(bytes: &[u8], other: &[u8], rng: &mut Rng) -> Vec<u8> {
    let (start, end) = text_part(bytes);
    match rng.usize(..20) {
        0..16 if end > start + 8 => {
            let middle = String::from_utf8_lossy(&bytes[start..end]).into_owned();
            let donor = String::from_utf8_lossy(&other[..text_part(other).1]).into_owned();
            let middle = text::mutated(&middle, &donor, rng);
            [&bytes[..start], middle.as_bytes(), &bytes[end..]].concat()
        }
        16 => binary::spliced(bytes, other, rng),
        _ => binary::mutated(bytes, rng),
    }
}

/// The longest part of the first 64 kB that is text.
fn text_part(bytes: &[u8]) -> (usize, usize) {
    let bytes = &bytes[..bytes.len().min(1 << 16)];
    let is_text =
        |byte: &u8| *byte >= 0x20 && *byte != 0x7f || matches!(byte, b'\n' | b'\r' | b'\t');
    let (mut best, mut start) = ((0, 0), 0);
    for end in 0..=bytes.len() {
        if end == bytes.len() || !is_text(&bytes[end]) {
            if end - start > best.1 - best.0 {
                best = (start, end);
            }
            start = end + 1;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream(seed: u64) -> Vec<Vec<u8>> {
        let case = Input::new("spacing = 0.1\nname = \"a\"\n\n[time]\nend = 1\n", "toml");
        let map = Input::new([b"NRRD0004\n\n".to_vec(), compressed(&[7; 100])].concat(), "nrrd");
        let mut rng = Rng::with_seed(seed);
        let mut one = |n: usize| {
            let inputs = [&case, &map];
            mutated(inputs[n % 2], inputs[(n + 1) % 2], &["toml"], &mut rng).bytes
        };
        (0..400).map(&mut one).collect()
    }

    #[test]
    fn the_same_number_gives_the_same_inputs_and_another_gives_others() {
        assert_eq!(stream(1), stream(1));
        assert_ne!(stream(1), stream(2));
    }

    #[test]
    fn most_mutations_change_something() {
        let distinct: std::collections::BTreeSet<_> = stream(3).into_iter().collect();
        assert!(distinct.len() > 300, "{}", distinct.len());
    }

    #[test]
    fn the_text_of_a_binary_file_is_found() {
        assert_eq!(text_part(b"\x93NUMPY\x01\x00abcdefgh ijk\n\x00\x00ab"), (8, 21));
        assert_eq!(text_part(b""), (0, 0));
    }
}
