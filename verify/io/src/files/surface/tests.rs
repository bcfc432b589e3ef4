use super::*;

/// A cube of edge 2 mm with one corner pulled out, as points and as quadrangles seen from outside.
const POINTS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [2.0, 0.0, 0.0],
    [0.0, 2.0, 0.0],
    [2.0, 2.0, 0.0],
    [0.0, 0.0, 2.0],
    [2.0, 0.0, 2.0],
    [0.0, 2.0, 2.0],
    [2.5, 2.5, 2.5],
];
const FACES: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn lines<const N: usize>(rows: &[[u32; N]], before: &str, first: u32) -> String {
    let row = |row: &[u32; N]| {
        let numbers = row.map(|n| (n + first).to_string()).join(" ");
        format!("{before}{numbers}\n")
    };
    rows.iter().map(row).collect()
}

fn places(before: &str) -> String {
    POINTS.iter().map(|[x, y, z]| format!("{before}{x} {y} {z}\n")).collect()
}

fn obj() -> String {
    let mut faces = lines(&FACES, "f ", 1);
    faces = faces.replace("f 1 3 4 2", "g side\nusemtl skin\nf 1/1 -6//2 4 \\\n2");
    format!("# a cube\no cube\n{}vn 0 0 1\n{faces}", places("v "))
}

const PLY: &str = "ply\nformat ascii 1.0\ncomment a cube\nelement vertex 8\nproperty float x\nproperty \
                   float y\nproperty float z\nelement face 6\nproperty list uchar int \
                   vertex_indices\nend_header\n";

fn ply() -> String {
    PLY.to_string() + &places("") + &lines(&FACES, "4 ", 0)
}

fn binary_ply(big: bool) -> Vec<u8> {
    let name = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = PLY.replace("ascii", name).into_bytes();
    let mut put =
        |word: [u8; 4]| if big { bytes.extend(word) } else { bytes.extend(word.iter().rev()) };
    POINTS.iter().flatten().for_each(|c| put(c.to_be_bytes()));
    for face in FACES {
        bytes.push(4);
        for n in face {
            let word = n.to_be_bytes();
            if big { bytes.extend(word) } else { bytes.extend(word.iter().rev()) }
        }
    }
    bytes
}

fn vtk() -> String {
    let head = "# vtk DataFile Version 3.0\na cube\nASCII\nDATASET POLYDATA\n";
    let faces = lines(&FACES, "4 ", 0);
    format!("{head}POINTS 8 float\n{}POLYGONS 6 30\n{faces}CELL_DATA 6\n", places(""))
}

fn binary_vtk(version_5: bool) -> Vec<u8> {
    let mut bytes =
        b"# vtk DataFile Version 5.1\na cube\nBINARY\nDATASET POLYDATA\nPOINTS 8 float\n".to_vec();
    bytes.extend(POINTS.iter().flatten().flat_map(|c| c.to_be_bytes()));
    if version_5 {
        bytes.extend(b"\nMETADATA\nINFORMATION 0\n\nPOLYGONS 7 24\nOFFSETS vtktypeint64\n");
        bytes.extend((0..7u64).flat_map(|n| (4 * n).to_be_bytes()));
        bytes.extend(b"\nCONNECTIVITY vtktypeint64\n");
        bytes.extend(FACES.iter().flatten().flat_map(|n| u64::from(*n).to_be_bytes()));
    } else {
        bytes.extend(b"\nPOLYGONS 6 30\n");
        let cell = |face: &[u32; 4]| [4].into_iter().chain(*face).flat_map(u32::to_be_bytes);
        bytes.extend(FACES.iter().flat_map(cell));
    }
    bytes.push(b'\n');
    bytes
}

fn vtp() -> String {
    let array = |name: &str, kind: &str, text: &str| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{text}</DataArray>\n")
    };
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\">\n<PolyData>\n<Piece \
         NumberOfPoints=\"8\" NumberOfPolys=\"6\">\n<Points>\n{}</Points>\n<Polys>\n{}{}</Polys>\n\
         </Piece>\n</PolyData>\n</VTKFile>\n",
        array("Points", "Float32", &places("")),
        array("connectivity", "Int64", &lines(&FACES, "", 0)),
        array("offsets", "Int64", "4 8 12 16 20 24"),
    )
}

/// The same cube in every format and variant but STL.
fn all() -> Vec<(Kind, Vec<u8>)> {
    vec![
        (Kind::Obj, obj().into_bytes()),
        (Kind::Obj, obj().replace('\n', "\r\n").into_bytes()),
        (Kind::Ply, ply().into_bytes()),
        (Kind::Ply, ply().replace('\n', "\r").into_bytes()),
        (Kind::Ply, binary_ply(false)),
        (Kind::Ply, binary_ply(true)),
        (Kind::Vtk, vtk().into_bytes()),
        (Kind::Vtk, binary_vtk(false)),
        (Kind::Vtk, binary_vtk(true)),
        (Kind::Vtp, vtp().into_bytes()),
    ]
}

fn read_as(kind: Kind, bytes: &[u8]) -> Result<SurfaceFile, Mistake> {
    parse(bytes, kind, LengthUnit::Millimetre)
}

#[test]
fn a_body_is_the_same_in_every_format() {
    let first = read_as(Kind::Obj, obj().as_bytes()).unwrap();
    assert_eq!((first.surface.vertices.len(), first.surface.triangles.len()), (8, 12));
    for (kind, bytes) in all() {
        assert_eq!(read_as(kind, &bytes).unwrap(), first, "{kind:?}");
    }
    let facet = |t: &[u32; 3]| {
        let vertex = |n: &u32| POINTS[*n as usize].map(|c| c.to_string()).join(" ");
        let vertices: String = t.iter().map(|n| format!("vertex {}\n", vertex(n))).collect();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    let stl: String = first.surface.triangles.iter().map(facet).collect();
    let stl = read_as(Kind::Stl, format!("solid cube\n{stl}endsolid\n").as_bytes()).unwrap();
    let corners = |surface: &Triangles| -> Vec<[mtled::algebra::tensor::Vector3; 3]> {
        surface.triangles.iter().map(|t| t.map(|n| surface.vertices[n as usize])).collect()
    };
    assert_eq!(corners(&stl.surface), corners(&first.surface));
}

#[test]
fn a_file_cut_short_anywhere_is_refused_or_open_but_ends_no_program() {
    for (kind, bytes) in all() {
        for end in 0..bytes.len() {
            if let Ok(read) = read_as(kind, &bytes[..end]) {
                // What was cut off is a comment, the last line end, or whole faces at the end.
                let count = read.surface.triangles.len();
                assert!(count == 12 || kind == Kind::Obj, "{kind:?} {end}: {count} triangles");
            }
        }
    }
}

#[test]
fn a_file_with_any_byte_changed_ends_no_program() {
    for (kind, bytes) in all() {
        for at in 0..bytes.len() {
            for other in [0, b'\n', b' ', b'-', b'9', 0xff] {
                let mut changed = bytes.clone();
                changed[at] = other;
                let _ = read_as(kind, &changed);
            }
        }
    }
}

#[test]
fn a_stated_space_turns_the_coordinates() {
    let space = "<FieldData><Array type=\"String\" Name=\"SPACE\" format=\"ascii\">76 80 83 0</Array>\
                 </FieldData><Piece";
    let plain = read_as(Kind::Obj, obj().as_bytes()).unwrap().surface;
    for (kind, text) in [
        (Kind::Obj, obj().replace("a cube", "SPACE=LPS")),
        (Kind::Ply, ply().replace("a cube", "SPACE=LPS")),
        (Kind::Vtk, vtk().replace("a cube", "3D Slicer output. SPACE=LPS")),
        (Kind::Vtp, vtp().replace("<Piece", space)),
    ] {
        let turned = read_as(kind, text.as_bytes()).unwrap().surface;
        for (a, b) in turned.vertices.iter().zip(&plain.vertices) {
            assert_eq!([a.x, a.y, a.z], [-b.x, -b.y, b.z], "{kind:?}");
        }
    }
}

#[test]
fn lines_and_points_are_left_out_and_the_note_counts_them() {
    let lines = "<Lines><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1</DataArray>\
                 <DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">2</DataArray></Lines><Polys>";
    for (kind, text) in [
        (Kind::Obj, obj() + "l 1 2 3\n"),
        (Kind::Ply, ply().replace("face 6", "face 7") + "2 0 1\n"),
        (Kind::Vtk, vtk().replace("POLYGONS", "LINES 1 3\n2 0 1\nPOLYGONS")),
        (Kind::Vtp, vtp().replace("<Polys>", lines)),
    ] {
        let read = read_as(kind, text.as_bytes()).unwrap();
        assert_eq!(read.surface.triangles.len(), 12);
        assert!(read.notes[0].starts_with("1 lines or points are left out"), "{:?}", read.notes);
    }
}

#[test]
fn strips_become_triangles_that_face_the_same_way() {
    let text = "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 \
                0\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\n";
    let read = read_as(Kind::Vtk, text.as_bytes()).unwrap();
    assert_eq!(read.surface.triangles, [[0, 1, 2], [2, 1, 3]]);
}

#[test]
fn a_name_that_does_not_fit_the_content_is_refused_with_the_right_one() {
    let refused = |kind: Kind, bytes: &[u8]| read_as(kind, bytes).unwrap_err().to_string();
    let message = refused(Kind::Stl, ply().as_bytes());
    assert!(message.contains("ends in .stl") && message.contains(".ply file"), "{message}");
    let message = refused(Kind::Vtp, obj().as_bytes());
    assert!(message.contains("that of a .obj file"), "{message}");
    let message = refused(Kind::Obj, b"\x1f\x8b\x08\x00rest");
    assert!(message.contains("gzip") && message.contains("unpack"), "{message}");
    let message = refused(Kind::Vtp, vtp().replace("PolyData", "UnstructuredGrid").as_bytes());
    assert!(message.contains("extract its surface"), "{message}");
    let message = refused(Kind::Vtk, vtk().replace("POLYDATA", "UNSTRUCTURED_GRID").as_bytes());
    assert!(message.contains("line 4") && message.contains("extract the surface"), "{message}");
}

#[test]
fn damaged_text_is_refused_with_its_place() {
    let (o, p, v, x) = (Kind::Obj, Kind::Ply, Kind::Vtk, Kind::Vtp);
    for (kind, text, expected) in [
        (o, obj().replace("v 2 0 0", "v 2 0"), "line 4 is `v 2 0`; expected `v` and three numbers"),
        (o, obj().replace("v 2 0 0", "v 2 0 nix"), "line 4 is `v 2 0 nix`"),
        (o, obj().replace("v 2 0 0", "v 2 0 0 0.5"), "the weight 1 or a colour"),
        (o, obj().replace("f 5 6 8 7", "f 5 6 99 7"), "which uses point 99, and the file has 8"),
        (o, obj().replace("f 5 6 8 7", "f 5 6 -99 7"), "back from -1"),
        (o, obj().replace("f 5 6 8 7", "f 5 6 0 7"), "`f 5 6 0 7`"),
        (o, obj().replace("f 5 6 8 7", "f 5 6"), "at least three corners"),
        (o, obj().replace("f 5 6 8 7", "surf 0 1 0 1"), "cut into polygons where they come from"),
        (o, obj().replace("f 5 6 8 7", "hello"), "`hello`; expected a line of an OBJ file"),
        (o, obj().replace("v 2 0 0", "v 2 0 inf"), "point 2 has a coordinate that is not finite"),
        (p, ply().replace("2 0 0\n", "2 0\n"), "Line 12"),
        (p, ply().replace("4 4 5 7 6", "4 4 5 99 6"), "face 2 uses point 100, and the file has 8"),
        (p, ply().replace("vertex 8", "vertex 9999999999"), "`element` is `vertex 9999999999`"),
        (p, ply().replace("property float y\n", ""), "no `property y`"),
        (p, ply().replace("vertex_indices", "corners"), "no `property list vertex_indices`"),
        (p, ply().replace("face 6", "face 5"), "9 bytes follow"),
        (p, ply().replace("face 6", "face 7"), "expected 7, got 6"),
        (v, vtk().replace("4 4 5 7 6", "4 4 5 x 6"), "line 15 is `x`; expected a number"),
        (v, vtk().replace("4 4 5 7 6", "9 4 5 7 6"), "counts of the cells do not match"),
        (v, vtk().replace("POINTS 8", "POINTS 7"), "line 13 is `2.5 2.5 2.5`"),
        (v, vtk().replace("ASCII", "TEXT"), "line 3"),
        (x, vtp().replace("4 8 12", "4 8 99"), "offsets of the cells do not match"),
        (x, vtp().replace("4 5 7 6", "4 5 77 6"), "face 2 uses point 78, and the file has 8"),
        (x, vtp().replace("</Polys>", ""), "XML"),
    ] {
        let message = read_as(kind, text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}\nlacks {expected}");
    }
}

#[test]
fn a_kind_that_is_not_read_says_what_to_export() {
    let error = read(Path::new("brain.gii"), LengthUnit::Metre).unwrap_err().to_string();
    assert!(error.contains("export it as one of these"), "{error}");
}

#[test]
fn fields_in_front_of_the_points_are_passed_over_as_vtk_writes_them() {
    let ascii = "FIELD FieldData 2\nTime 1 1 double\n0.5\nnote 1 1 string\n{\"shape\": 1}\nPOINTS";
    let text = vtk().replacen("POINTS", ascii, 1);
    let first = read_as(Kind::Obj, obj().as_bytes()).unwrap();
    assert_eq!(read_as(Kind::Vtk, text.as_bytes()).unwrap(), first);
    // A string in binary stands behind its length.
    let field =
        [b"FIELD FieldData 1\nnote 1 1 string\n\xc5".as_slice(), b"a\nb\nc\nPOINTS"].concat();
    let bytes = binary_vtk(true);
    let at = bytes.windows(6).position(|window| window == b"POINTS").unwrap();
    let bytes = [&bytes[..at], &field, &bytes[at + 6..]].concat();
    assert_eq!(read_as(Kind::Vtk, &bytes).unwrap(), first);
}

#[test]
fn numbers_of_points_of_the_type_of_vtk_itself_have_four_bytes() {
    let bytes = binary_vtk(true);
    let at = bytes.windows(8).position(|window| window == b"POLYGONS").unwrap();
    let mut narrow = [&bytes[..at], b"POLYGONS 7 24\nOFFSETS vtkIdType\n"].concat();
    narrow.extend((0..7u32).flat_map(|n| (4 * n).to_be_bytes()));
    narrow.extend(b"\nCONNECTIVITY vtkIdType\n");
    narrow.extend(FACES.iter().flatten().flat_map(|n| n.to_be_bytes()));
    assert_eq!(read_as(Kind::Vtk, &narrow).unwrap(), read_as(Kind::Vtk, &bytes).unwrap());
}

#[test]
fn keys_inside_an_array_are_none_of_its_numbers() {
    let key =
        "<InformationKey name=\"L2_NORM_RANGE\"><Value index=\"0\">0.03</Value></InformationKey>";
    let text = vtp().replacen("</DataArray>", &format!("{key}</DataArray>"), 1);
    let first = read_as(Kind::Obj, obj().as_bytes()).unwrap();
    assert_eq!(read_as(Kind::Vtp, text.as_bytes()).unwrap(), first);
}
