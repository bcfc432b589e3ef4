//! Bytes of files and the numbers stored in them.

use super::error::{FileError, Mistake};
use flate2::read::MultiGzDecoder;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// The bytes of a file.
pub fn bytes_of(path: &Path) -> Result<Vec<u8>, FileError> {
    std::fs::read(path).map_err(|error| Mistake::Unreadable(error).of(path))
}

/// The first characters of a file for a message.
pub fn start_of(bytes: &[u8]) -> String {
    let start = &bytes[..bytes.len().min(12)];
    String::from_utf8_lossy(start).escape_default().to_string()
}

/// At most `limit` bytes of gzip data, fewer where the data are cut short.
pub fn inflate(data: &[u8], limit: usize) -> Result<Vec<u8>, Mistake> {
    let mut bytes = Vec::new();
    match MultiGzDecoder::new(data).take(limit as u64).read_to_end(&mut bytes) {
        Err(error) if error.kind() != ErrorKind::UnexpectedEof => {
            Err(Mistake::Undecodable { encoding: "gzip", reason: error.to_string() })
        }
        _ => Ok(bytes),
    }
}

/// Type of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Order of the bytes of a stored number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// The least significant byte first.
    Little,
    /// The most significant byte first.
    Big,
}

impl ByteOrder {
    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            ByteOrder::Little => "little",
            ByteOrder::Big => "big",
        }
    }
}

impl Scalar {
    /// Size \[byte\].
    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::I64 | Scalar::U64 | Scalar::F64 => 8,
        }
    }

    /// The number stored in the first bytes, which must be enough.
    pub fn read(self, bytes: &[u8], order: ByteOrder) -> f64 {
        let mut word = [0u8; 8];
        let n = self.size();
        word[..n].copy_from_slice(&bytes[..n]);
        if order == ByteOrder::Big {
            word[..n].reverse();
        }
        let whole = u64::from_le_bytes(word);
        match self {
            Scalar::U8 | Scalar::U16 | Scalar::U32 | Scalar::U64 => whole as f64,
            Scalar::I8 => f64::from(whole as i8),
            Scalar::I16 => f64::from(whole as i16),
            Scalar::I32 => f64::from(whole as i32),
            Scalar::I64 => whole as i64 as f64,
            Scalar::F32 => f64::from(f32::from_bits(whole as u32)),
            Scalar::F64 => f64::from_bits(whole),
        }
    }
}
