//! The POINTS of a legacy VTK file, ASCII or binary (big-endian).

use super::rows::from_stated;
use crate::files::bytes::{ByteOrder, Scalar, start_of, take_line, take_numbers};
use crate::files::error::Mistake;
use mtled::algebra::tensor::Vector3;

pub(crate) fn parse(bytes: &[u8]) -> Result<Vec<Vector3>, Mistake> {
    if !bytes.starts_with(b"# vtk DataFile") {
        let format = "a legacy VTK file (# vtk DataFile Version)";
        return Err(Mistake::WrongFormat { format, start: start_of(bytes) });
    }
    let mut rest = bytes;
    let mut binary = None;
    for number in 1.. {
        let line = take_line(&mut rest).ok_or(Mistake::MissingField { field: "POINTS" })?;
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
                        return Err(Mistake::bad_line(number, &line, expected));
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

/// As many numbers as stated; only a keyword may follow.
fn big_endian(mut bytes: &[u8], points: usize, scalar: Scalar) -> Result<Vec<f64>, Mistake> {
    let values = take_numbers(&mut bytes, points.saturating_mul(3), scalar, ByteOrder::Big)?;
    match bytes.trim_ascii_start().first() {
        Some(next) if !next.is_ascii_alphabetic() => {
            Err(Mistake::Excess { expected: values.len() * scalar.size() })
        }
        _ => Ok(values),
    }
}

/// All numbers up to the next keyword.
fn ascii(bytes: &[u8]) -> Vec<f64> {
    let text = String::from_utf8_lossy(bytes);
    text.split_whitespace().map_while(|word| word.parse::<f64>().ok()).collect()
}
