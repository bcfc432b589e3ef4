//! Bytes of files and the numbers stored in them.

use super::error::{FileError, Mistake};
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, sink};
use std::path::Path;

/// The longest file that is read as a whole \[byte\].
pub(crate) const LONGEST: u64 = 1 << 32;

/// A regular file and its length \[byte\]. Devices and pipes, which need not end, are refused.
pub(crate) fn open(path: &Path) -> Result<(BufReader<File>, u64), FileError> {
    let unreadable = |error| Mistake::Unreadable(error).of(path);
    let found = std::fs::metadata(path).map_err(unreadable)?;
    if !found.is_file() {
        return Err(Mistake::NotAFile.of(path));
    }
    Ok((BufReader::new(File::open(path).map_err(unreadable)?), found.len()))
}

/// The bytes of a file.
pub(crate) fn bytes_of(path: &Path) -> Result<Vec<u8>, FileError> {
    let (file, length) = open(path)?;
    if length > LONGEST {
        return Err(Mistake::TooLong { length, longest: LONGEST }.of(path));
    }
    at_most(file, length).map_err(|mistake| mistake.of(path))
}

/// Passes the bytes of a file to `see`, piece by piece.
pub fn visit_bytes(path: &Path, mut see: impl FnMut(&[u8])) -> Result<(), FileError> {
    let (mut file, _) = open(path)?;
    let mut piece = vec![0; 1 << 16];
    loop {
        match file.read(&mut piece).map_err(|error| Mistake::Unreadable(error).of(path))? {
            0 => return Ok(()),
            length => see(&piece[..length]),
        }
    }
}

/// The next bytes of a stream, fewer than `count` where it ends before. Memory is taken
/// as they come, not as a header promises them.
pub(crate) fn at_most(stream: impl Read, count: u64) -> Result<Vec<u8>, Mistake> {
    let mut bytes = Vec::new();
    readable(stream.take(count).read_to_end(&mut bytes))?;
    Ok(bytes)
}

/// The next `expected` bytes of a stream, and a few behind them.
pub(crate) fn voxel_bytes(
    mut stream: impl Read,
    expected: usize,
) -> Result<(Vec<u8>, Vec<u8>), Mistake> {
    const A_FEW: u64 = 8;
    let bytes = at_most(&mut stream, expected as u64)?;
    if bytes.len() < expected {
        return Err(Mistake::Truncated { expected, found: bytes.len() });
    }
    match at_most(&mut stream, A_FEW) {
        // Compressed data end with their check sum.
        Err(Mistake::Undecodable { reason, .. }) if !reason.contains("checksum") => {
            Ok((bytes, Vec::new()))
        }
        rest => Ok((bytes, rest?)),
    }
}

/// Reads past the next `count` bytes of a stream, or to its end.
pub(crate) fn skip(stream: impl Read, count: u64) -> Result<(), Mistake> {
    readable(std::io::copy(&mut stream.take(count), &mut sink()).map(drop))
}

/// Compressed data that are cut short are no error here: their end is missing.
fn readable<T: Default>(read: std::io::Result<T>) -> Result<T, Mistake> {
    match read {
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(T::default()),
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::InvalidData) => {
            Err(Mistake::Undecodable { encoding: "gzip", reason: error.to_string() })
        }
        read => read.map_err(Mistake::Unreadable),
    }
}

/// Removes the first line, and gives it without the spaces around it.
pub(crate) fn take_line(rest: &mut &[u8]) -> Option<String> {
    if rest.is_empty() {
        return None;
    }
    let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len() - 1);
    let line = String::from_utf8_lossy(&rest[..=end]).trim().to_string();
    *rest = &rest[end + 1..];
    Some(line)
}

/// Removes the first numbers.
pub(crate) fn take_numbers(
    rest: &mut &[u8],
    count: usize,
    scalar: Scalar,
    order: ByteOrder,
) -> Result<Vec<f64>, Mistake> {
    let (expected, found) = (count.saturating_mul(scalar.size()), rest.len());
    let split = rest.split_at_checked(expected);
    let (data, behind) = split.ok_or(Mistake::Truncated { expected, found })?;
    *rest = behind;
    Ok(numbers(data, scalar, order).collect())
}

/// Numbers that lie one behind the other.
pub fn numbers(bytes: &[u8], scalar: Scalar, order: ByteOrder) -> impl Iterator<Item = f64> {
    bytes.chunks_exact(scalar.size()).map(move |word| scalar.read(word, order))
}

/// The first characters of a file for a message.
pub(crate) fn start_of(bytes: &[u8]) -> String {
    let start = &bytes[..bytes.len().min(12)];
    String::from_utf8_lossy(start).escape_default().to_string()
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
    pub(crate) fn name(self) -> &'static str {
        match self {
            ByteOrder::Little => "little",
            ByteOrder::Big => "big",
        }
    }
}

impl Scalar {
    /// Size \[byte\].
    pub(crate) fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::I64 | Scalar::U64 | Scalar::F64 => 8,
        }
    }

    /// The number stored in the first bytes, which must be enough.
    pub(crate) fn read(self, bytes: &[u8], order: ByteOrder) -> f64 {
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

    /// Appends a number; one that the type cannot hold becomes the nearest that it can.
    pub(crate) fn write(self, value: f64, order: ByteOrder, out: &mut Vec<u8>) {
        let word = match self {
            Scalar::U8 => u64::from(value.round() as u8),
            Scalar::I8 => value.round() as i8 as u64,
            Scalar::U16 => u64::from(value.round() as u16),
            Scalar::I16 => value.round() as i16 as u64,
            Scalar::U32 => u64::from(value.round() as u32),
            Scalar::I32 => value.round() as i32 as u64,
            Scalar::U64 => value.round() as u64,
            Scalar::I64 => value.round() as i64 as u64,
            Scalar::F32 => u64::from((value as f32).to_bits()),
            Scalar::F64 => value.to_bits(),
        };
        let bytes = word.to_le_bytes();
        match order {
            ByteOrder::Little => out.extend(&bytes[..self.size()]),
            ByteOrder::Big => out.extend(bytes[..self.size()].iter().rev()),
        }
    }
}
