//! The POINTS of a legacy VTK file, ASCII or binary (big-endian).

use super::rows::from_stated;
use crate::files::bytes::{ByteOrder, Scalar, start_of};
use crate::files::error::Mistake;
use mtled::algebra::tensor::Vector3;

pub fn parse(bytes: &[u8]) -> Result<Vec<Vector3>, Mistake> {
    if !bytes.starts_with(b"# vtk DataFile") {
        let format = "a legacy VTK file (# vtk DataFile Version)";
        return Err(Mistake::WrongFormat { format, start: start_of(bytes) });
    }
    let mut rest = bytes;
    let mut binary = None;
    for number in 1.. {
        let line = next_line(&mut rest).ok_or(Mistake::MissingField { field: "POINTS" })?;
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["BINARY"] if binary.is_none() => binary = Some(true),
            ["ASCII"] if binary.is_none() => binary = Some(false),
            ["POINTS", count, kind] => {
                let (points, scalar) = match (count.parse::<usize>(), kind) {
                    (Ok(points), "float") => (points, Scalar::F32),
                    (Ok(points), "double") => (points, Scalar::F64),
                    _ => {
                        let expected = "POINTS, a count, and float or double";
                        return Err(Mistake::BadLine { line: number, text: line, expected });
                    }
                };
                let values = match binary {
                    Some(true) => big_endian(rest, points, scalar)?,
                    _ => ascii(rest),
                };
                return from_stated(&values, points);
            }
            _ => {}
        }
    }
    Err(Mistake::NoPoints)
}

/// Removes the first line.
fn next_line(rest: &mut &[u8]) -> Option<String> {
    if rest.is_empty() {
        return None;
    }
    let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len() - 1);
    let line = String::from_utf8_lossy(&rest[..=end]).trim().to_string();
    *rest = &rest[end + 1..];
    Some(line)
}

/// As many numbers as stated; only a keyword may follow.
fn big_endian(bytes: &[u8], points: usize, scalar: Scalar) -> Result<Vec<f64>, Mistake> {
    let expected = points.saturating_mul(3).saturating_mul(scalar.size());
    let found = bytes.len();
    let (data, rest) =
        bytes.split_at_checked(expected).ok_or(Mistake::Truncated { expected, found })?;
    if rest.trim_ascii_start().first().is_some_and(|next| !next.is_ascii_alphabetic()) {
        return Err(Mistake::Excess { expected });
    }
    Ok(data.chunks_exact(scalar.size()).map(|word| scalar.read(word, ByteOrder::Big)).collect())
}

/// All numbers up to the next keyword.
fn ascii(bytes: &[u8]) -> Vec<f64> {
    let text = String::from_utf8_lossy(bytes);
    text.split_whitespace().map_while(|word| word.parse::<f64>().ok()).collect()
}
