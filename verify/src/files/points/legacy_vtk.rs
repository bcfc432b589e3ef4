//! The POINTS of a legacy VTK file, ASCII or binary (big-endian).

use super::rows::from_rows;
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
                let (count, scalar) = match (count.parse::<usize>(), kind) {
                    (Ok(count), "float") => (count, Scalar::F32),
                    (Ok(count), "double") => (count, Scalar::F64),
                    _ => {
                        let expected = "POINTS, a count, and float or double";
                        return Err(Mistake::BadLine { line: number, text: line, expected });
                    }
                };
                let count = 3 * count;
                let values = match binary {
                    Some(true) => big_endian(rest, count, scalar)?,
                    _ => ascii(rest, count)?,
                };
                return Ok(from_rows(&values, 3));
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

fn big_endian(bytes: &[u8], count: usize, scalar: Scalar) -> Result<Vec<f64>, Mistake> {
    let expected = count.saturating_mul(scalar.size());
    let data = bytes.get(..expected);
    let data = data.ok_or(Mistake::Truncated { expected, found: bytes.len() })?;
    Ok(data.chunks_exact(scalar.size()).map(|word| scalar.read(word, ByteOrder::Big)).collect())
}

fn ascii(bytes: &[u8], count: usize) -> Result<Vec<f64>, Mistake> {
    let text = String::from_utf8_lossy(bytes);
    let words = text.split_whitespace().map_while(|word| word.parse::<f64>().ok());
    let values: Vec<f64> = words.take(count).collect();
    if values.len() < count {
        let reason = format!("there are {} coordinates of {count}", values.len());
        return Err(Mistake::Undecodable { encoding: "ASCII", reason });
    }
    Ok(values)
}
