//! Points with a displacement each, from CSV, NPY and VTU files.
#![allow(non_snake_case)]

use super::csv::{bad_line, reader, undecodable};
use super::{npy, vtu};
use crate::files::bytes::bytes_of;
use crate::files::error::{FileError, Mistake};
use mtled::algebra::tensor::Vector3;
use std::path::Path;

/// Columns of a CSV file, in any order among others.
const COLUMNS: [&str; 6] = ["x", "y", "z", "ux", "uy", "uz"];
const HEADER: &str = "a header that names x, y, z, ux, uy and uz";
const ROW: &str = "finite numbers below x, y, z, ux, uy and uz";

/// Points and displacements in the unit of the file, with the format given by the extension
/// of the name: CSV with a header x, y, z, ux, uy, uz; NPY of shape (n, 6); the points of a
/// VTU file with its point data called `name`.
pub fn read_displacements(path: &Path, name: &str) -> Result<Vec<(Vector3, Vector3)>, FileError> {
    let kind = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let parse = |bytes: &[u8]| match kind.as_str() {
        "csv" | "txt" => from_csv(bytes),
        "npy" => {
            let (values, _) = npy::numbers(bytes, &[6], "(n, 6)")?;
            Ok(values.chunks_exact(6).map(pair).collect())
        }
        "vtu" => from_vtu(bytes, name),
        _ => Err(Mistake::UnknownExtension {
            known: ".csv, .npy, .vtu, .nrrd, .nhdr, .nii, .nii.gz",
        }),
    };
    let bytes = bytes_of(path)?;
    parse(&bytes).and_then(finite).map_err(|mistake| mistake.of(path))
}

fn pair(row: &[f64]) -> (Vector3, Vector3) {
    (Vector3::new(row[0], row[1], row[2]), Vector3::new(row[3], row[4], row[5]))
}

fn finite(data: Vec<(Vector3, Vector3)>) -> Result<Vec<(Vector3, Vector3)>, Mistake> {
    let is_finite = |(X, u): &(Vector3, Vector3)| X.iter().chain(u).all(|c| c.is_finite());
    match data.iter().position(|row| !is_finite(row)) {
        None => Ok(data),
        Some(point) => Err(Mistake::NotFinite { point: point + 1 }),
    }
}

fn from_vtu(bytes: &[u8], name: &str) -> Result<Vec<(Vector3, Vector3)>, Mistake> {
    let (points, values) = (vtu::parse(bytes)?, vtu::point_data(bytes, name)?);
    if points.len() == values.len() {
        Ok(points.into_iter().zip(values).collect())
    } else {
        Err(Mistake::VectorCount {
            name: name.to_string(),
            points: points.len(),
            values: values.len(),
        })
    }
}

fn from_csv(bytes: &[u8]) -> Result<Vec<(Vector3, Vector3)>, Mistake> {
    let mut reader = reader(bytes, true);
    let header = reader.headers().map_err(undecodable)?.clone();
    let column = |name: &str| header.iter().position(|cell| cell.eq_ignore_ascii_case(name));
    let columns: Option<Vec<usize>> = COLUMNS.into_iter().map(column).collect();
    let columns = columns.ok_or_else(|| bad_line(&header, HEADER))?;
    let rows = reader.records().map(|row| {
        let row = row.map_err(undecodable)?;
        let cell = |&column: &usize| row.get(column).and_then(|cell| cell.parse::<f64>().ok());
        let values: Option<Vec<f64>> = columns.iter().map(cell).collect();
        let values = values.filter(|values| values.iter().all(|value| value.is_finite()));
        values.map(|values| pair(&values)).ok_or_else(|| bad_line(&row, ROW))
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const EXPECTED: (Vector3, Vector3) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.1, 0.2, 0.3));

    fn read(name: &str, bytes: &[u8]) -> Result<Vec<(Vector3, Vector3)>, FileError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        read_displacements(&path, "displacement")
    }

    #[test]
    fn columns_of_a_csv_file_are_told_by_its_header() {
        let text = "# measured\nuz,name,x,y,z,ux,uy\n0.3,a,1,2,3,0.1,0.2\n";
        assert_eq!(read("shift.csv", text.as_bytes()).unwrap(), [EXPECTED]);
        let text = "x,y,z,ux,uy,uz\n1,2,3,0.1,0.2,0.3\n1,2,3,0.1,,0.3\n";
        let message = read("shift.csv", text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains("line 3 is `1,2,3,0.1,,0.3`"), "{message}");
    }

    #[test]
    fn an_array_has_six_columns() {
        let array = |columns: usize| {
            let header =
                format!("{{'descr': '<f8', 'fortran_order': False, 'shape': (1, {columns}), }}\n");
            let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
            bytes.extend((header.len() as u16).to_le_bytes());
            bytes.extend(header.as_bytes());
            let row = [1.0f64, 2.0, 3.0, 0.1, 0.2, 0.3];
            row[..columns].iter().for_each(|value| bytes.extend(value.to_le_bytes()));
            bytes
        };
        assert_eq!(read("shift.npy", &array(6)).unwrap(), [EXPECTED]);
        let message = read("shift.npy", &array(3)).unwrap_err().to_string();
        assert!(message.contains("expected (n, 6) of floats"), "{message}");
    }

    #[test]
    fn point_data_of_a_vtu_file_are_found_by_name() {
        let file = |name: &str| {
            format!(
                r#"<VTKFile><UnstructuredGrid><Piece NumberOfPoints="1"><PointData>
                <DataArray type="Float64" Name="velocity" NumberOfComponents="3" format="ascii">9 9 9</DataArray>
                <DataArray type="Float64" Name="{name}" NumberOfComponents="3" format="ascii">0.1 0.2 0.3</DataArray>
                </PointData><Points>
                <DataArray type="Float64" NumberOfComponents="3" format="ascii">1 2 3</DataArray>
                </Points></Piece></UnstructuredGrid></VTKFile>"#
            )
        };
        assert_eq!(read("shift.vtu", file("displacement").as_bytes()).unwrap(), [EXPECTED]);
        let message = read("shift.vtu", file("u").as_bytes()).unwrap_err().to_string();
        assert!(message.contains("the file has velocity, u"), "{message}");
    }
}
