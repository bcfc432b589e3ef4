//! Landmarks with names, from CSV.

use super::csv::{bad_line, reader, undecodable};
use crate::files::bytes::bytes_of;
use crate::files::error::{FileError, Mistake};
use crate::files::unit::LengthUnit;
use csv::StringRecord;
use mtled::algebra::tensor::Vector3;
use std::path::Path;

/// A named point, and where it was found after the deformation. RAS.
#[derive(Debug, Clone, PartialEq)]
pub struct Landmark {
    /// Its name.
    pub name: String,
    /// Before the deformation \[m\].
    pub position: Vector3,
    /// After the deformation \[m\].
    pub found: Option<Vector3>,
}

const BEFORE: [&str; 3] = ["x", "y", "z"];
const AFTER: [&str; 3] = ["x2", "y2", "z2"];
const UNITS: [(&str, LengthUnit); 3] =
    [("_m", LengthUnit::Metre), ("_mm", LengthUnit::Millimetre), ("_um", LengthUnit::Micrometre)];
const HEADER: &str = "a header that names name, x, y, z and, where they were found again, x2, y2, z2, either plainly, \
                      with their unit stated by --unit, or all with it, as in x_mm or x_m";
const HEADER_OF_POINTS: &str = "a header that names name, x, y, z, either plainly, with `unit` in the case file, or all \
                                with their unit, as in x_mm or x_m";
const ROW: &str = "finite numbers below x, y, z, and below x2, y2, z2 three or none";

/// Columns of the header, and the unit that it states.
struct Columns {
    name: usize,
    before: [usize; 3],
    after: Option<[usize; 3]>,
    stated: Option<LengthUnit>,
}

/// Reads landmarks from a CSV file with a header; `unit` overrides what that states.
pub fn read_landmarks(path: &Path, unit: Option<LengthUnit>) -> Result<Vec<Landmark>, FileError> {
    read_csv(path, unit, HEADER)
}

/// Reads named points for a case file from a CSV file with a header; `unit` overrides what that
/// states.
pub fn read_named_points(
    path: &Path,
    unit: Option<LengthUnit>,
) -> Result<Vec<Landmark>, FileError> {
    read_csv(path, unit, HEADER_OF_POINTS)
}

fn read_csv(
    path: &Path,
    unit: Option<LengthUnit>,
    header: &'static str,
) -> Result<Vec<Landmark>, FileError> {
    let kind = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if kind != "csv" {
        return Err(Mistake::UnknownExtension { known: ".csv" }.of(path));
    }
    bytes_of(path).and_then(|bytes| parse(&bytes, unit, header).map_err(|mistake| mistake.of(path)))
}

fn parse(
    bytes: &[u8],
    unit: Option<LengthUnit>,
    expected: &'static str,
) -> Result<Vec<Landmark>, Mistake> {
    let mut reader = reader(bytes, true);
    let header = reader.headers().map_err(undecodable)?.clone();
    let columns = columns(&header).ok_or_else(|| bad_line(&header, expected))?;
    let unit = unit.or(columns.stated).ok_or_else(|| bad_line(&header, expected))?;
    let rows = reader.records().map(|row| {
        let row = row.map_err(undecodable)?;
        landmark(&row, &columns, unit.in_metres()).ok_or_else(|| bad_line(&row, ROW))
    });
    let landmarks: Vec<Landmark> = rows.collect::<Result<_, _>>()?;
    if landmarks.is_empty() { Err(Mistake::NoPoints) } else { Ok(landmarks) }
}

fn columns(header: &StringRecord) -> Option<Columns> {
    let column = |name: &str| header.iter().position(|cell| cell.eq_ignore_ascii_case(name));
    let three = |names: [&str; 3], suffix: &str| -> Option<[usize; 3]> {
        let found = names.map(|name| column(&format!("{name}{suffix}")));
        Some([found[0]?, found[1]?, found[2]?])
    };
    let name = column("name")?;
    let stated = UNITS.into_iter().map(|(suffix, unit)| (suffix, Some(unit)));
    let (suffix, stated) =
        stated.chain([("", None)]).find(|(suffix, _)| three(BEFORE, suffix).is_some())?;
    Some(Columns { name, before: three(BEFORE, suffix)?, after: three(AFTER, suffix), stated })
}

fn landmark(row: &StringRecord, columns: &Columns, metres: f64) -> Option<Landmark> {
    let cell = |column: usize| row.get(column).unwrap_or_default();
    let number = |column: usize| cell(column).parse().ok().filter(|value: &f64| value.is_finite());
    let point = |[x, y, z]: [usize; 3]| -> Option<Vector3> {
        Some(Vector3::new(number(x)?, number(y)?, number(z)?) * metres)
    };
    let found = match columns.after {
        Some(after) if after.iter().any(|&column| !cell(column).is_empty()) => Some(point(after)?),
        _ => None,
    };
    Some(Landmark { name: cell(columns.name).to_string(), position: point(columns.before)?, found })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, unit: Option<LengthUnit>) -> Result<Vec<Landmark>, Mistake> {
        parse(text.as_bytes(), unit, HEADER)
    }

    #[test]
    fn a_unit_is_stated_by_the_header_or_by_the_caller_and_never_guessed() {
        let expected = Landmark {
            name: "tip".into(),
            position: Vector3::new(0.001, 0.002, 0.003),
            found: Some(Vector3::new(0.002, 0.002, 0.003)),
        };
        let of_header = "name,x_mm,y_mm,z_mm,x2_mm,y2_mm,z2_mm\ntip,1,2,3,2,2,3\n";
        assert_eq!(read(of_header, None).unwrap(), vec![expected.clone()]);
        let plain = "# found twice\nname,x,y,z,x2,y2,z2\ntip,1,2,3,2,2,3\n";
        assert_eq!(read(plain, Some(LengthUnit::Millimetre)).unwrap(), [expected]);
        let message = read(plain, None).unwrap_err().to_string();
        assert!(message.contains("--unit"), "{message}");
    }

    #[test]
    fn a_landmark_need_not_be_found_again_but_its_numbers_must_be_whole() {
        let text = "name,x_m,y_m,z_m,x2_m,y2_m,z2_m\na,1,2,3,,,\nb,1,2,3,4,5,6\n";
        let found: Vec<bool> =
            read(text, None).unwrap().iter().map(|mark| mark.found.is_some()).collect();
        assert_eq!(found, [false, true]);
        for row in ["c,1,2,nan", "c,1,2", "c,1,2,3,4,,6"] {
            let message = read(&format!("{text}{row}\n"), None).unwrap_err().to_string();
            assert!(message.contains(&format!("line 4 is `{row}`")), "{message}");
        }
    }
}
