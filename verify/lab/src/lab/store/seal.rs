//! The checksum of a record: it comes first in the file and is that of all bytes behind it, so
//! that a digit that was changed or damaged is noticed.

use sha2::{Digest, Sha256};

const BEFORE: &str = "{\"checksum\":\"";
const AFTER: &str = "\",";
/// Hexadecimal digits of a checksum.
const DIGITS: usize = 32;

/// What the checksum of a file says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Seal {
    /// The content is as it was written.
    Whole,
    /// The content is another.
    Broken,
    /// There is none: an earlier version wrote the file.
    Missing,
}

/// A JSON object of one line with its checksum in front.
pub fn sealed(object: &str) -> String {
    let content = object.trim_end().strip_prefix('{').unwrap_or(object);
    format!("{BEFORE}{}{AFTER}{content}\n", checksum(content))
}

/// What the checksum of such an object says.
pub(crate) fn seal_of(text: &str) -> Seal {
    let Some(rest) = text.strip_prefix(BEFORE) else { return Seal::Missing };
    let content = rest.get(DIGITS..).and_then(|rest| rest.strip_prefix(AFTER));
    match content {
        Some(content) if rest[..DIGITS] == checksum(content.trim_end()) => Seal::Whole,
        _ => Seal::Broken,
    }
}

fn checksum(content: &str) -> String {
    let digest = Sha256::digest(content.as_bytes());
    digest.iter().take(DIGITS / 2).map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_changed_character_is_noticed() {
        let text = sealed("{\"key\":\"ab\",\"value\":[1.25,-3e-7]}\n");
        assert_eq!(seal_of(&text), Seal::Whole);
        assert!(serde_json::from_str::<serde_json::Value>(&text).unwrap()["value"].is_array());
        for at in 0..text.trim_end().len() {
            let mut bytes = text.clone().into_bytes();
            bytes[at] ^= 1;
            let other = String::from_utf8(bytes).unwrap();
            assert_ne!(seal_of(&other), Seal::Whole, "{other}");
        }
        assert_eq!(seal_of("{\"key\":\"ab\"}"), Seal::Missing);
    }
}
