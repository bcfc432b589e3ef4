//! What is mutated.

/// A file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// Its content.
    pub bytes: Vec<u8>,
    /// Of its name, without the dot.
    pub extension: String,
}

impl Input {
    /// A file of some bytes.
    pub fn new(bytes: impl Into<Vec<u8>>, extension: &str) -> Input {
        Input { bytes: bytes.into(), extension: extension.to_string() }
    }
}
