//! Points from CSV: columns x, y and optionally z, with or without a header.

use crate::files::error::Mistake;
use mtled::algebra::tensor::Vector3;

const EXPECTED: &str = "two or three finite numbers x, y, z, as many in every line";

pub(crate) fn parse(bytes: &[u8]) -> Result<Vec<Vector3>, Mistake> {
    let mut reader = reader(bytes, false);
    let mut columns = None;
    let mut width = None;
    let mut points = Vec::new();
    for row in reader.records() {
        let row = row.map_err(undecodable)?;
        let bad = || bad_line(&row, EXPECTED);
        // Empty cells, as of a comma at the end of a line, are no column.
        let width = *width.get_or_insert(row.len());
        if row.iter().skip(width).any(|cell| !cell.is_empty()) {
            return Err(bad());
        }
        let columns: &mut Vec<usize> = match &mut columns {
            Some(columns) => columns,
            empty => {
                let header = row.iter().any(|cell| cell.parse::<f64>().is_err());
                let found = if header { named(&row) } else { Some((0..row.len()).collect()) };
                let found = found.filter(|found| (2..=3).contains(&found.len()));
                let columns = empty.insert(found.ok_or_else(bad)?);
                if header {
                    continue;
                }
                columns
            }
        };
        let cell = |column: &usize| row.get(*column).and_then(finite);
        let values: Vec<f64> = columns.iter().map(cell).collect::<Option<_>>().ok_or_else(bad)?;
        points.push(Vector3::new(values[0], values[1], values.get(2).copied().unwrap_or(0.0)));
    }
    Ok(points)
}

/// Rows of cells, with comments after # and blanks around cells left out.
pub(crate) fn reader(bytes: &[u8], has_headers: bool) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new()
        .has_headers(has_headers)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(bytes)
}

/// A file that is no text.
pub(crate) fn undecodable(error: csv::Error) -> Mistake {
    Mistake::Undecodable { encoding: "CSV", reason: error.to_string() }
}

/// A row that is not what was expected.
pub(crate) fn bad_line(row: &csv::StringRecord, expected: &'static str) -> Mistake {
    let line = row.position().map_or(1, |position| position.line() as usize);
    let text = row.iter().collect::<Vec<_>>().join(",");
    Mistake::bad_line(line, &text, expected)
}

fn finite(cell: &str) -> Option<f64> {
    cell.parse::<f64>().ok().filter(|number| number.is_finite())
}

/// Columns of x, y and optionally z in a header.
fn named(row: &csv::StringRecord) -> Option<Vec<usize>> {
    let find = |name: &str| row.iter().position(|cell| cell.eq_ignore_ascii_case(name));
    Some([Some(find("x")?), Some(find("y")?), find("z")].into_iter().flatten().collect())
}
