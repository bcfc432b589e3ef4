//! Fields at points as VTK XML, readable by ParaView, PyVista and meshio.

use anyhow::{Result, ensure};
use mtled_checks::report::write_atomically;
use std::fmt::Write;
use std::path::Path;

/// Points at one instant, with cells between them or each for itself.
#[derive(Debug, Clone, PartialEq)]
pub struct VtuFrame<'a> {
    /// Numbers of the whole frame by name; `TimeValue` is its time \[s\].
    pub numbers: Vec<(&'static str, f64)>,
    /// \[m\]
    pub points: &'a [[f64; 3]],
    /// Cells between the points; without them every point becomes a vertex cell.
    pub cells: Option<VtuCells<'a>>,
    /// Fields at the points.
    pub point_data: Vec<PointArray>,
}

/// Cells with the same number of corners.
#[derive(Debug, Clone, PartialEq)]
pub struct VtuCells<'a> {
    /// 4 of a tetrahedron, 3 of a triangle.
    pub corners: usize,
    /// Points of the cells, one cell after the other.
    pub points: &'a [u32],
    /// Fields in the cells.
    pub data: Vec<PointArray>,
    /// What the file is for, in a comment.
    pub purpose: &'static str,
}

impl VtuCells<'_> {
    fn count(&self) -> usize {
        self.points.len() / self.corners
    }
}

/// VTK's number of a cell by its corners: vertex, triangle, tetrahedron.
fn vtk_type(corners: usize) -> u8 {
    match corners {
        4 => 10,
        3 => 5,
        _ => 1,
    }
}

/// A field at the points, or in the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct PointArray {
    /// Name of the field.
    pub name: String,
    /// 1 for a scalar, 3 for a vector, 9 for a tensor by rows.
    pub components: usize,
    /// \[point\]\[component\], in the unit of the field.
    pub values: Vec<f64>,
    /// How the values are stored.
    pub stored: Stored,
}

/// How numbers are stored in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// Bit for bit.
    Double,
    /// To seven digits.
    Single,
    /// Whole numbers of 32 bits.
    Integer,
}

/// What the frames of a collection are ordered by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// Time \[s\].
    Time,
    /// Their number: a static run has no time.
    Number,
}

impl Order {
    fn meaning(self) -> &'static str {
        match self {
            Order::Time => "time in seconds",
            Order::Number => "number of the frame, since a static run has no time",
        }
    }
}

impl PointArray {
    /// A field from its values.
    pub fn new(name: &str, components: usize, values: Vec<f64>) -> PointArray {
        PointArray { name: name.to_string(), components, values, stored: Stored::Double }
    }

    /// The same field, stored otherwise.
    pub(crate) fn stored(self, stored: Stored) -> PointArray {
        PointArray { stored, ..self }
    }
}

/// Header and raw blocks of the appended data, grown side by side.
#[derive(Default)]
struct Blocks {
    bytes: Vec<u8>,
}

impl Blocks {
    /// Appends a block with its UInt64 length and returns its `DataArray`.
    fn array(&mut self, kind: &str, attributes: &str, data: impl Iterator<Item = u8>) -> String {
        let offset = self.bytes.len();
        self.bytes.extend([0; 8]);
        self.bytes.extend(data);
        let length = (self.bytes.len() - offset - 8) as u64;
        self.bytes[offset..offset + 8].copy_from_slice(&length.to_le_bytes());
        format!(
            "<DataArray type=\"{kind}\" {attributes} format=\"appended\" offset=\"{offset}\"/>\n"
        )
    }

    fn reals<'a>(&mut self, attributes: &str, values: impl Iterator<Item = &'a f64>) -> String {
        self.array("Float64", attributes, values.flat_map(|v| v.to_le_bytes()))
    }

    fn field(&mut self, array: &PointArray) -> String {
        let attributes =
            format!("{} NumberOfComponents=\"{}\"", named(&array.name), array.components);
        let values = array.values.iter();
        match array.stored {
            Stored::Double => self.reals(&attributes, values),
            Stored::Single => {
                self.array("Float32", &attributes, values.flat_map(|v| single(*v).to_le_bytes()))
            }
            Stored::Integer => {
                self.array("Int32", &attributes, values.flat_map(|v| (*v as i32).to_le_bytes()))
            }
        }
    }

    /// Fields from the last to the first, and their headers in order.
    fn fields(&mut self, arrays: &[PointArray]) -> String {
        let mut headers: Vec<String> = arrays.iter().rev().map(|array| self.field(array)).collect();
        headers.reverse();
        headers.concat()
    }

    fn short_integers(&mut self, name: &str, values: impl Iterator<Item = u32>) -> String {
        self.array("Int32", &named(name), values.flat_map(|n| (n as i32).to_le_bytes()))
    }

    fn integers(&mut self, name: &str, values: impl Iterator<Item = i64>) -> String {
        self.array("Int64", &named(name), values.flat_map(i64::to_le_bytes))
    }
}

/// The bytes of an UnstructuredGrid 1.0, little endian, raw appended data; the
/// same frame gives the same bytes. Refuses arrays of the wrong length.
pub fn to_vtu(frame: &VtuFrame) -> Result<Vec<u8>> {
    let count = frame.points.len();
    let cells = frame.cells.iter().flat_map(|cells| {
        cells.data.iter().map(|array| (array, "cell data", "cells", cells.count()))
    });
    let points = frame.point_data.iter().map(|array| (array, "point data", "points", count));
    for (array, kind, places, count) in points.chain(cells) {
        let expected = count * array.components;
        ensure!(
            array.values.len() == expected && array.components > 0,
            "{kind} {} has {} values, {count} {places} with {} components need {expected}",
            array.name,
            array.values.len(),
            array.components
        );
    }
    let mut blocks = Blocks::default();
    let xml = header(frame, &mut blocks);
    let mut bytes = xml.into_bytes();
    bytes.extend(blocks.bytes);
    // meshio looks for the closing tag at the start of a line.
    bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
    Ok(bytes)
}

/// The last array of the header comes first in the data: meshio, which looks for arrays by their
/// offsets and changes these one by one, could take one for another otherwise.
fn header(frame: &VtuFrame, blocks: &mut Blocks) -> String {
    let count = frame.points.len();
    let (corners, cell_count) = match &frame.cells {
        Some(cells) => (cells.corners, cells.count()),
        None => (1, count),
    };
    let kinds = std::iter::repeat_n(vtk_type(corners), cell_count);
    let types = blocks.array("UInt8", &named("types"), kinds);
    let offsets = match &frame.cells {
        Some(_) => {
            let ends = (1..=cell_count).map(|cell| (cell * corners) as u32);
            blocks.short_integers("offsets", ends)
        }
        None => blocks.integers("offsets", 1..=count as i64),
    };
    let connectivity = match &frame.cells {
        Some(cells) => blocks.short_integers("connectivity", cells.points.iter().copied()),
        None => blocks.integers("connectivity", 0..count as i64),
    };
    let places =
        blocks.reals("Name=\"Points\" NumberOfComponents=\"3\"", frame.points.iter().flatten());
    let (mut cell_fields, mut purpose) = (String::new(), String::new());
    if let Some(cells) = &frame.cells {
        cell_fields = format!("<CellData>\n{}</CellData>\n", blocks.fields(&cells.data));
        purpose = format!("<!-- {} -->\n", cells.purpose);
    }
    let fields = blocks.fields(&frame.point_data);
    let mut numbers = Vec::new();
    for (name, number) in frame.numbers.iter().rev() {
        let attributes = format!("{} NumberOfTuples=\"1\"", named(name));
        numbers.push(blocks.reals(&attributes, [number].into_iter()));
    }
    numbers.reverse();
    let numbers = numbers.concat();
    format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n{purpose}<UnstructuredGrid>\n<FieldData>\n{numbers}</FieldData>\n\
         <Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{cell_count}\">\n\
         <PointData>\n{fields}</PointData>\n{cell_fields}<Points>\n{places}</Points>\n\
         <Cells>\n{connectivity}{offsets}{types}</Cells>\n</Piece>\n</UnstructuredGrid>\n\
         <AppendedData encoding=\"raw\">\n_"
    )
}

/// The nearest number of single precision that is not infinite.
fn single(value: f64) -> f32 {
    (value as f32).clamp(f32::MIN, f32::MAX)
}

fn named(name: &str) -> String {
    format!("Name=\"{}\"", mtled_checks::report::svg::escape(name))
}

/// Writes a frame to `path` at once.
pub(crate) fn write_vtu(path: &Path, frame: &VtuFrame) -> Result<()> {
    write_atomically(path, &to_vtu(frame)?)
}

/// Writes a collection of frames: what orders them and file names relative to `path`.
pub(crate) fn write_pvd(path: &Path, order: Order, frames: &[(f64, String)]) -> Result<()> {
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- timestep: {} -->\n<VTKFile type=\"Collection\" version=\"1.0\" \
         byte_order=\"LittleEndian\">\n<Collection>\n",
        order.meaning()
    );
    for (at, file) in frames {
        let file = mtled_checks::report::svg::escape(file);
        let _ = writeln!(text, "<DataSet timestep=\"{at}\" part=\"0\" file=\"{file}\"/>");
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    write_atomically(path, text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [[f64; 3]; 2] = [[0.0, 0.5, 1.0], [2.0, -1.0, 0.25]];

    fn frame(time: f64) -> VtuFrame<'static> {
        let tensor = (0..18).map(|i| 100.0 * f64::from(i) * time).collect();
        let point_data = vec![
            PointArray::new("displacement", 3, vec![0.1, 0.2, 0.3, 0.4, 0.5, time]),
            PointArray::new("J", 1, vec![1.0, 0.98]),
            PointArray::new("cauchy_stress", 9, tensor),
        ];
        VtuFrame { numbers: vec![("TimeValue", time)], points: &POINTS, cells: None, point_data }
    }

    /// The reals of the array called `name`, found the way a reader finds them.
    fn read_back(bytes: &[u8], name: &str) -> Vec<f64> {
        let start = bytes.windows(2).position(|pair| pair == b"\n_").unwrap();
        let header = std::str::from_utf8(&bytes[..start]).unwrap();
        let line = header.lines().find(|l| l.contains(&format!("Name=\"{name}\""))).unwrap();
        let offset = line.split("offset=\"").nth(1).unwrap().split('"').next().unwrap();
        let block = &bytes[start + 2 + offset.parse::<usize>().unwrap()..];
        let length = u64::from_le_bytes(block[..8].try_into().unwrap()) as usize;
        let real = |b: &[u8]| f64::from_le_bytes(b.try_into().unwrap());
        block[8..8 + length].chunks(8).map(real).collect()
    }

    #[test]
    fn a_frame_is_read_back_bit_for_bit() {
        let bytes = to_vtu(&frame(0.75)).unwrap();
        assert_eq!(read_back(&bytes, "Points"), POINTS.concat());
        assert_eq!(read_back(&bytes, "TimeValue"), [0.75]);
        assert_eq!(read_back(&bytes, "J"), [1.0, 0.98]);
        assert_eq!(read_back(&bytes, "cauchy_stress"), frame(0.75).point_data[2].values);
        assert_eq!(bytes, to_vtu(&frame(0.75)).unwrap());
        assert!(bytes.ends_with(b"\n</AppendedData>\n</VTKFile>\n"));
    }

    #[test]
    fn an_array_of_the_wrong_length_is_refused_with_the_numbers() {
        let mut short = frame(0.0);
        short.point_data[1].values.pop();
        let error = to_vtu(&short).unwrap_err().to_string();
        assert_eq!(error, "point data J has 1 values, 2 points with 1 components need 2");
    }

    #[test]
    fn cells_and_their_fields_stand_in_the_file() {
        let data = vec![PointArray::new("region", 1, vec![2.0]).stored(Stored::Integer)];
        let cells = VtuCells { corners: 3, points: &[0, 1, 1], data, purpose: "to look at" };
        let mut body = frame(0.0);
        body.cells = Some(cells.clone());
        let bytes = to_vtu(&body).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        for part in ["NumberOfCells=\"1\"", "<CellData>", "Name=\"region\"", "<!-- to look at -->"]
        {
            assert!(text.contains(part), "{part}");
        }
        body.cells = Some(VtuCells { points: &[0, 1, 1, 1, 0, 0], ..cells });
        let error = to_vtu(&body).unwrap_err().to_string();
        assert_eq!(error, "cell data region has 1 values, 2 cells with 1 components need 2");
    }

    /// Set MTLED_SAMPLE_VTU to a folder to try other readers on the files.
    #[test]
    fn a_collection_names_every_frame_with_its_time() {
        let scratch = tempfile::tempdir().unwrap();
        let kept = std::env::var_os("MTLED_SAMPLE_VTU").map(std::path::PathBuf::from);
        let folder = kept.unwrap_or(scratch.path().to_path_buf());
        let mut frames = Vec::new();
        for (index, time) in [0.0, 0.5, 1.0].into_iter().enumerate() {
            let name = format!("frame_{index:04}.vtu");
            write_vtu(&folder.join(&name), &frame(time)).unwrap();
            frames.push((time, name));
        }
        let collection = folder.join("frames.pvd");
        write_pvd(&collection, Order::Time, &frames).unwrap();
        let text = std::fs::read_to_string(collection).unwrap();
        assert!(text.contains("<!-- timestep: time in seconds -->"), "{text}");
        assert!(text.contains("timestep=\"0.5\" part=\"0\" file=\"frame_0001.vtu\""), "{text}");
    }
}
