use super::{csv, legacy_vtk, npy, read, vtu};
use crate::files::Mistake;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, write::ZlibEncoder};
use mtled::algebra::tensor::Vector3;
use std::io::Write;

const COORDINATES: [f64; 6] = [0.0, 0.5, 1.0, -2.0, 0.25, 3.5];

fn expected() -> Vec<Vector3> {
    vec![Vector3::new(0.0, 0.5, 1.0), Vector3::new(-2.0, 0.25, 3.5)]
}

#[test]
fn csv_is_read_with_and_without_a_header() {
    assert_eq!(csv::parse(b"0,0.5,1\n-2, 0.25 ,3.5\n").unwrap(), expected());
    assert_eq!(csv::parse(b"# nodes\nid,z,x,y\n1,1,0,0.5\n2,3.5,-2,0.25\n").unwrap(), expected());
    assert_eq!(csv::parse(b"x,y\n1,2\n").unwrap(), [Vector3::new(1.0, 2.0, 0.0)]);
}

#[test]
fn a_bad_line_of_csv_is_named() {
    let message = csv::parse(b"x,y,z\n1,2,3\n1,two,3\n").unwrap_err().to_string();
    assert!(message.contains("line 3 is `1,two,3`"), "{message}");
    assert!(csv::parse(b"a,b,c\n1,2,3\n").is_err());
    assert!(csv::parse(b"1,2,3,4\n").is_err());
}

/// A NumPy array as numpy.save writes it; `order` says whether it is stored by columns.
fn npy_bytes(kind: &str, shape: &str, order: &str, data: &[u8]) -> Vec<u8> {
    let header =
        format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}      \n");
    let length = (header.len() as u16).to_le_bytes();
    [&b"\x93NUMPY\x01\x00"[..], &length, header.as_bytes(), data].concat()
}

#[test]
fn numpy_arrays_are_read_in_both_orders_and_precisions() {
    let by_rows = npy_bytes("<f8", "(2, 3)", "False", &little());
    assert_eq!(npy::parse(&by_rows).unwrap(), expected());
    let by_columns = [0.0, -2.0, 0.5, 0.25, 1.0, 3.5].map(f64::to_le_bytes).concat();
    let by_columns = npy_bytes("<f8", "(2, 3)", "True", &by_columns);
    assert_eq!(npy::parse(&by_columns).unwrap(), expected());
    let single = COORDINATES.map(|x| (x as f32).to_be_bytes()).concat();
    let single = npy_bytes(">f4", "(2, 3)", "False", &single);
    assert_eq!(npy::parse(&single).unwrap(), expected());
    let plane = [1.0, 2.0].map(f64::to_le_bytes).concat();
    let plane = npy_bytes("<f8", "(1, 2)", "False", &plane);
    assert_eq!(npy::parse(&plane).unwrap(), [Vector3::new(1.0, 2.0, 0.0)]);
}

#[test]
fn numpy_arrays_of_another_shape_or_type_are_refused() {
    let wide = npy_bytes("<f8", "(1, 6)", "False", &little());
    assert!(npy::parse(&wide).unwrap_err().to_string().contains("shape [1, 6]"));
    let whole = npy_bytes("<i4", "(1, 3)", "False", &[0; 12]);
    assert!(npy::parse(&whole).unwrap_err().to_string().contains("type '<i4'; expected (n, 2)"));
    let line = npy_bytes("<f8", "(6,)", "False", &little());
    assert!(npy::parse(&line).unwrap_err().to_string().contains("shape [6]"));
    let endless = npy_bytes("<f8", "(9223372036854775808, 3)", "False", &little());
    assert!(npy::parse(&endless).unwrap_err().to_string().contains("truncated"));
    assert!(npy::parse(b"PK\x03\x04").unwrap_err().to_string().contains("NPY"));
}

#[test]
fn legacy_vtk_is_read_as_text_and_binary() {
    let header = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n";
    let text = format!("{header}0 0.5 1\n-2 0.25 3.5\nVERTICES 0 0\n");
    assert_eq!(legacy_vtk::parse(text.as_bytes()).unwrap(), expected());
    let header = header.replace("ASCII", "BINARY").replace("float", "double");
    let data = COORDINATES.map(f64::to_be_bytes).concat();
    let bytes = [header.as_bytes(), &data].concat();
    assert_eq!(legacy_vtk::parse(&bytes).unwrap(), expected());
    assert!(legacy_vtk::parse(&bytes[..bytes.len() - 8]).is_err());
}

fn vtu_text(attributes: &str, array: &str, content: &str, appended: &str) -> Vec<u8> {
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" {attributes}>\n\
         <UnstructuredGrid><Piece NumberOfPoints=\"2\" NumberOfCells=\"0\">\n\
         <PointData><DataArray type=\"Float64\" Name=\"u\" format=\"ascii\">9 9</DataArray></PointData>\n\
         <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" {array}>{content}</DataArray>\
         </Points></Piece></UnstructuredGrid>{appended}</VTKFile>\n"
    )
    .into_bytes()
}

fn little() -> Vec<u8> {
    COORDINATES.map(f64::to_le_bytes).concat()
}

#[test]
fn vtu_is_read_as_text_and_inline_binary() {
    let text = vtu_text("", "format=\"ascii\"", "0 0.5 1\n-2 0.25 3.5", "");
    assert_eq!(vtu::parse(&text).unwrap(), expected());
    let short = STANDARD.encode([&48u32.to_le_bytes()[..], &little()].concat());
    let inline = vtu_text("byte_order=\"LittleEndian\"", "format=\"binary\"", &short, "");
    assert_eq!(vtu::parse(&inline).unwrap(), expected());
    let big = COORDINATES.map(f64::to_be_bytes).concat();
    let long = STANDARD.encode([&48u64.to_be_bytes()[..], &big].concat());
    let attributes = "byte_order=\"BigEndian\" header_type=\"UInt64\"";
    let inline = vtu_text(attributes, "format=\"binary\"", &long, "");
    assert_eq!(vtu::parse(&inline).unwrap(), expected());
}

/// The coordinates in two compressed blocks with their header, in base64.
fn compressed() -> String {
    let blocks: Vec<Vec<u8>> = (little().chunks(32))
        .map(|block| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
            encoder.write_all(block).unwrap();
            encoder.finish().unwrap()
        })
        .collect();
    let lengths = [2, 32, 16, blocks[0].len() as u32, blocks[1].len() as u32];
    let header: Vec<u8> = lengths.iter().flat_map(|n| n.to_le_bytes()).collect();
    STANDARD.encode(header) + &STANDARD.encode(blocks.concat())
}

#[test]
fn vtu_is_read_compressed_and_appended() {
    let attributes = "header_type=\"UInt32\" compressor=\"vtkZLibDataCompressor\"";
    let inline = vtu_text(attributes, "format=\"binary\"", &compressed(), "");
    assert_eq!(vtu::parse(&inline).unwrap(), expected());
    let tail = format!("<AppendedData encoding=\"base64\">\n_AAAA{}</AppendedData>", compressed());
    let appended = vtu_text(attributes, "format=\"appended\" offset=\"4\"", "", &tail);
    assert_eq!(vtu::parse(&appended).unwrap(), expected());
    let mut raw = vtu_text("", "format=\"appended\" offset=\"0\"", "", "");
    raw.truncate(raw.len() - "</VTKFile>\n".len());
    raw.extend(b"<AppendedData encoding=\"raw\">_");
    raw.extend([&48u32.to_le_bytes()[..], &little()].concat());
    raw.extend(b"</AppendedData></VTKFile>");
    assert_eq!(vtu::parse(&raw).unwrap(), expected());
}

#[test]
fn damaged_vtu_files_are_refused_with_a_reason() {
    let short = STANDARD.encode([&99u32.to_le_bytes()[..], &little()].concat());
    let truncated = vtu_text("", "format=\"binary\"", &short, "");
    let message = vtu::parse(&truncated).unwrap_err().to_string();
    assert!(message.contains("states 99 bytes of data, there are 48"), "{message}");
    assert!(vtu::parse(b"<html></html>").unwrap_err().to_string().contains("not a VTU file"));
    let lz4 = vtu_text("compressor=\"vtkLZ4DataCompressor\"", "format=\"binary\"", &short, "");
    assert!(vtu::parse(&lz4).unwrap_err().to_string().contains("vtkZLibDataCompressor or none"));
}

#[test]
fn files_without_usable_points_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nodes.csv");
    std::fs::write(&path, "x,y,z\n").unwrap();
    assert!(read(&path).unwrap_err().to_string().contains("no points"));
    std::fs::write(&path, "1,2,inf\n").unwrap();
    assert!(read(&path).unwrap_err().to_string().contains("finite numbers"));
    let nan = vtu_text("", "format=\"ascii\"", "0 0.5 1 -2 nan 3.5", "");
    let path = folder.path().join("nodes.vtu");
    std::fs::write(&path, nan).unwrap();
    assert!(read(&path).unwrap_err().to_string().contains("point 2 has a coordinate"));
    assert!(read(&folder.path().join("nodes.xyz")).is_err());
}

#[test]
fn binary_points_cut_short_anywhere_are_refused_or_read_but_never_panic() {
    let data = COORDINATES.map(f64::to_be_bytes).concat();
    let header = b"# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS 2 double\n";
    let vtk = [&header[..], &data].concat();
    assert!((0..vtk.len()).all(|end| legacy_vtk::parse(&vtk[..end]).is_err()));
    let attributes = "compressor=\"vtkZLibDataCompressor\"";
    let tail = format!("<AppendedData encoding=\"base64\">\n_AAAA{}</AppendedData>", compressed());
    let vtu = vtu_text(attributes, "format=\"appended\" offset=\"4\"", "", &tail);
    (0..vtu.len()).for_each(|end| drop(vtu::parse(&vtu[..end])));
    let npy = npy_bytes("<f8", "(2, 3)", "False", &little());
    assert!((0..npy.len()).all(|end| npy::parse(&npy[..end]).is_err()));
}

#[test]
fn rows_of_csv_with_another_number_of_columns_or_no_numbers_are_refused() {
    for (text, line) in [
        ("x,y,z\n1,2,3\n4,5,6,7\n", "line 3 is `4,5,6,7`"),
        ("1,2\n4,5,6\n", "line 2 is `4,5,6`"),
        ("1,2,3\n4,5,nan\n", "line 2 is `4,5,nan`"),
        ("1,2,3\n4,1e999,6\n", "line 2 is `4,1e999,6`"),
    ] {
        let message = csv::parse(text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains(line), "{message}");
    }
    assert_eq!(csv::parse(b"x,y,z\n0,0.5,1,\n-2,0.25,3.5,\n").unwrap(), expected());
}

#[test]
fn points_of_another_number_than_stated_are_refused() {
    let message = |error: Mistake| error.to_string();
    let vtk = |count: usize, numbers: &str| {
        let header = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET POLYDATA\n";
        legacy_vtk::parse(format!("{header}POINTS {count} float\n{numbers}\n").as_bytes())
    };
    for (count, found) in [(1, "0 0 0 1 1 1"), (2, "0 0 0 1 1"), (usize::MAX / 2, "0 0 0")] {
        assert!(message(vtk(count, found).unwrap_err()).contains("coordinates, and has"));
    }
    let data = COORDINATES.map(f64::to_be_bytes).concat();
    let header = b"# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET POLYDATA\nPOINTS 2 float\n";
    let error = legacy_vtk::parse(&[&header[..], &data].concat()).unwrap_err();
    assert!(matches!(error, Mistake::Excess { expected: 24 }), "{error}");
    let text = vtu_text("", "format=\"ascii\"", "0 0.5 1 -2 0.25 3.5 7 7 7", "");
    assert!(message(vtu::parse(&text).unwrap_err()).contains("states 2 points"));
    let npy = npy_bytes("<f8", "(1, 3)", "False", &little());
    assert!(matches!(npy::parse(&npy).unwrap_err(), Mistake::Excess { expected: 24 }));
}

#[test]
fn points_of_two_components_or_several_pieces_are_refused() {
    let text = String::from_utf8(vtu_text("", "format=\"ascii\"", "0 1 2 3", "")).unwrap();
    let flat = text.replace("NumberOfComponents=\"3\"", "NumberOfComponents=\"2\"");
    let message = vtu::parse(flat.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("`NumberOfComponents` is `2`; expected 3"), "{message}");
    let text = text.replace("0 1 2 3", "0 0.5 1 -2 0.25 3.5");
    let two = text.replace("</Piece>", "</Piece><Piece NumberOfPoints=\"0\"></Piece>");
    let message = vtu::parse(two.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("2 pieces; merge them"), "{message}");
}

#[test]
fn texts_inside_the_array_of_a_vtu_file_are_no_coordinates() {
    let range = "0 0.5 1 -2 0.25 3.5\
                 <InformationKey name=\"L2_NORM_RANGE\"><Value index=\"0\">1</Value>\
                 <Value index=\"1\">4</Value><Value index=\"2\">4</Value></InformationKey>";
    let text = vtu_text("", "format=\"ascii\"", range, "");
    assert_eq!(vtu::parse(&text).unwrap(), expected());
}

#[test]
fn a_compressed_block_longer_than_stated_is_refused() {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&[0; 1 << 20]).unwrap();
    let block = encoder.finish().unwrap();
    let header = [1, 48, 0, block.len() as u32].map(u32::to_le_bytes).concat();
    let content = STANDARD.encode(header) + &STANDARD.encode(block);
    let text = vtu_text("compressor=\"vtkZLibDataCompressor\"", "format=\"binary\"", &content, "");
    let message = vtu::parse(&text).unwrap_err().to_string();
    assert!(message.contains("has not the 48 bytes that are stated"), "{message}");
}

#[test]
fn more_compressed_numbers_than_there_are_points_are_refused_before_they_are_inflated() {
    // A mebibyte of zeros, as its block states, for the 48 bytes of two points.
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(&[0; 1 << 20]).unwrap();
    let block = encoder.finish().unwrap();
    let header = [1, 1 << 20, 0, block.len() as u32].map(u32::to_le_bytes).concat();
    let content = STANDARD.encode(header) + &STANDARD.encode(block);
    let text = vtu_text("compressor=\"vtkZLibDataCompressor\"", "format=\"binary\"", &content, "");
    let message = vtu::parse(&text).unwrap_err().to_string();
    assert!(message.contains("state 1048576 bytes, its points 48 at most"), "{message}");
}
