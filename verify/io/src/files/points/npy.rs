//! Rows of numbers from a NumPy array, such as points of shape (n, 2) or (n, 3)
//! (format: numpy.org/doc/stable/reference/generated/numpy.lib.format.html).

use super::rows::from_rows;
use crate::files::bytes::{self, ByteOrder, Scalar};
use crate::files::error::Mistake;
use mtled::algebra::tensor::Vector3;

/// What the header of an array states.
struct Header {
    /// Type of the numbers, such as `<f8`.
    kind: String,
    by_columns: bool,
    shape: Vec<u64>,
}

pub(crate) fn parse(bytes: &[u8]) -> Result<Vec<Vector3>, Mistake> {
    let (values, columns) = numbers(bytes, &[2, 3], "(n, 2) or (n, 3)")?;
    Ok(from_rows(&values, columns))
}

/// The numbers of an array row by row, with the number of columns, which is one of `allowed`.
pub fn numbers(
    bytes: &[u8],
    allowed: &[u64],
    expected: &'static str,
) -> Result<(Vec<f64>, usize), Mistake> {
    let bad_array = |header: Header| Mistake::BadArray {
        shape: header.shape,
        kind: format!("'{}'", header.kind),
        expected,
    };
    let (text, data) = split(bytes)?;
    let header = header(&text)?;
    let columns = match header.shape[..] {
        [_, columns] if allowed.contains(&columns) => columns as usize,
        _ => return Err(bad_array(header)),
    };
    let (order, scalar) = match header.kind.as_str() {
        "<f8" => (ByteOrder::Little, Scalar::F64),
        ">f8" => (ByteOrder::Big, Scalar::F64),
        "<f4" => (ByteOrder::Little, Scalar::F32),
        ">f4" => (ByteOrder::Big, Scalar::F32),
        _ => return Err(bad_array(header)),
    };
    let count = usize::try_from(header.shape[0]).unwrap_or(usize::MAX);
    let expected = count.saturating_mul(columns).saturating_mul(scalar.size());
    let found = data.len();
    if found != expected {
        return Err(if found < expected {
            Mistake::Truncated { expected, found }
        } else {
            Mistake::Excess { expected }
        });
    }
    let values: Vec<f64> = bytes::numbers(data, scalar, order).collect();
    if !header.by_columns {
        return Ok((values, columns));
    }
    let by_rows = (0..values.len()).map(|n| values[n % columns * count + n / columns]);
    Ok((by_rows.collect(), columns))
}

/// The text of the header and the data behind it.
fn split(bytes: &[u8]) -> Result<(String, &[u8]), Mistake> {
    let Some(rest) = bytes.strip_prefix(b"\x93NUMPY") else {
        return Err(damaged("it does not start with `\\x93NUMPY`"));
    };
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        _ => return Err(damaged("its version is not 1, 2 or 3")),
    };
    let (text, data) = rest.split_at_checked(length).ok_or(damaged("its header is truncated"))?;
    Ok((String::from_utf8_lossy(text).replace('"', "'"), data))
}

/// The entries of the header, a dictionary of Python such as
/// `{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }`.
fn header(text: &str) -> Result<Header, Mistake> {
    let entry = |name: &str| {
        let (_, rest) = text.split_once(&format!("'{name}':"))?;
        Some(rest.trim_start())
    };
    let read = || {
        let kind = entry("descr")?;
        let kind = match kind.strip_prefix('\'') {
            Some(kind) => kind.split('\'').next()?,
            None => kind.split(']').next()?,
        };
        let by_columns = match entry("fortran_order")? {
            order if order.starts_with("True") => true,
            order if order.starts_with("False") => false,
            _ => return None,
        };
        let (shape, _) = entry("shape")?.strip_prefix('(')?.split_once(')')?;
        let lengths = shape.split(',').map(str::trim).filter(|length| !length.is_empty());
        let shape = lengths.map(|length| length.parse().ok()).collect::<Option<_>>()?;
        Some(Header { kind: kind.to_string(), by_columns, shape })
    };
    read().ok_or(damaged("its header has no descr, fortran_order or shape"))
}

fn damaged(reason: &str) -> Mistake {
    Mistake::Undecodable { encoding: "NPY", reason: reason.to_string() }
}
