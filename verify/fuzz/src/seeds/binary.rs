//! Small files in the binary variants of the formats that are read.

use crate::mutate::{Input, compressed};
use anyhow::Result;
use mtled_run::run::vtu::{PointArray, VtuFrame, to_vtu};
use std::fmt::Write;

/// Labels of 4 × 4 × 4 voxels.
pub(crate) const VOXELS: [u8; 64] = {
    let mut voxels = [1; 64];
    voxels[21] = 2;
    voxels[22] = 2;
    voxels[41] = 3;
    voxels
};

const HEADER: &str = "NRRD0005\n# a comment\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 4 4\n\
                      space directions: (10,0,0) (0,10,0) (0,0,10)\nkinds: domain domain domain\nendian: little\n\
                      space origin: (0,0,0)\nsource:=made up\n";

/// NRRD of every encoding, NIfTI plain and compressed.
pub(crate) fn label_maps() -> Vec<Input> {
    let text = VOXELS.map(|voxel| voxel.to_string()).join(" ");
    let nrrd = |encoding: &str, data: &[u8]| {
        Input::new([format!("{HEADER}encoding: {encoding}\n\n").as_bytes(), data].concat(), "nrrd")
    };
    let nifti = nifti();
    vec![
        nrrd("raw", &VOXELS),
        nrrd("gzip", &compressed(&VOXELS)),
        nrrd("ascii", text.as_bytes()),
        Input::new(
            format!("{HEADER}encoding: raw\nbyte skip: -1\ndata file: voxels.raw\n"),
            "nhdr",
        ),
        Input::new(compressed(&nifti), "nii.gz"),
        Input::new(nifti, "nii"),
    ]
}

/// 16-bit labels with an sform of 10 mm.
fn nifti() -> Vec<u8> {
    let mut bytes = vec![0u8; 352];
    let mut put = |at: usize, data: &[u8]| bytes[at..at + data.len()].copy_from_slice(data);
    put(0, &348i32.to_le_bytes());
    for (n, size) in [3i16, 4, 4, 4, 1, 1, 1, 1].into_iter().enumerate() {
        put(40 + 2 * n, &size.to_le_bytes());
    }
    put(70, &4i16.to_le_bytes());
    put(72, &16i16.to_le_bytes());
    for (n, step) in [1.0f32, 10.0, 10.0, 10.0].into_iter().enumerate() {
        put(76 + 4 * n, &step.to_le_bytes());
    }
    put(108, &352.0f32.to_le_bytes());
    put(112, &1.0f32.to_le_bytes());
    put(123, &[2]);
    put(254, &1i16.to_le_bytes());
    for n in 0..3 {
        put(280 + 20 * n, &10.0f32.to_le_bytes());
    }
    put(344, b"n+1\0");
    bytes.extend(VOXELS.iter().flat_map(|voxel| i16::from(*voxel).to_le_bytes()));
    bytes
}

/// The companion surface in every format.
pub(crate) fn surfaces(companions: &[(String, Vec<u8>)]) -> Vec<Input> {
    let ascii = companions.iter().find(|(name, _)| name == "ball.stl");
    let Some((_, ascii)) = ascii else { return Vec::new() };
    let text = String::from_utf8_lossy(ascii).into_owned();
    let numbers = text.lines().filter_map(|line| line.trim().strip_prefix("vertex "));
    let values: Vec<f32> =
        numbers.flat_map(str::split_whitespace).filter_map(|number| number.parse().ok()).collect();
    let mut bytes = vec![b' '; 80];
    bytes.extend((values.len() as u32 / 9).to_le_bytes());
    for triangle in values.chunks(9) {
        let with_normal = [0.0; 3].iter().chain(triangle);
        bytes.extend(with_normal.flat_map(|value| value.to_le_bytes()));
        bytes.extend([0, 0]);
    }
    let mut all = vec![Input::new(text, "stl"), Input::new(bytes, "stl")];
    all.extend(other_surfaces(&values));
    all
}

/// Triangles of nine coordinates each as OBJ, PLY, VTK and VTP, without shared points.
fn other_surfaces(values: &[f32]) -> Vec<Input> {
    let count = values.len() / 3;
    let rows = |before: &str| {
        values.chunks(3).fold(String::new(), |mut text, p| {
            let _ = writeln!(text, "{before}{} {} {}", p[0], p[1], p[2]);
            text
        })
    };
    let faces = |before: &str, first: usize| {
        (0..count / 3).fold(String::new(), |mut text, n| {
            let n = 3 * n + first;
            let _ = writeln!(text, "{before}{} {} {}", n, n + 1, n + 2);
            text
        })
    };
    let triangles = count / 3;
    let ply = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
             property float z\nelement face {triangles}\nproperty list uchar int vertex_indices\n\
             end_header\n"
        )
    };
    let mut binary = ply("binary_little_endian").into_bytes();
    binary.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    for n in 0..triangles as u32 {
        binary.push(3);
        binary.extend([3 * n, 3 * n + 1, 3 * n + 2].into_iter().flat_map(u32::to_le_bytes));
    }
    let array = |name: &str, kind: &str, text: String| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{text}</DataArray>\n")
    };
    let ends: Vec<String> = (1..=triangles).map(|n| (3 * n).to_string()).collect();
    let vtp = format!(
        "<VTKFile type=\"PolyData\">\n<PolyData>\n<Piece NumberOfPoints=\"{count}\">\n<Points>\n{}</Points>\n\
         <Polys>\n{}{}</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n",
        array("Points", "Float32", rows("")),
        array("connectivity", "Int64", faces("", 0)),
        array("offsets", "Int64", ends.join(" ")),
    );
    let vtk = format!(
        "# vtk DataFile Version 3.0\nball\nASCII\nDATASET POLYDATA\nPOINTS {count} float\n{}POLYGONS \
         {triangles} {}\n{}",
        rows(""),
        4 * triangles,
        faces("3 ", 0)
    );
    vec![
        Input::new(rows("v ") + &faces("f ", 1), "obj"),
        Input::new(ply("ascii") + &rows("") + &faces("3 ", 0), "ply"),
        Input::new(binary, "ply"),
        Input::new(vtp, "vtp"),
        Input::new(vtk, "vtk"),
    ]
}

/// A lattice of 5 × 5 × 5 nodes in every format.
pub(crate) fn points() -> Result<Vec<Input>> {
    let at = |n: usize| [n % 5, n / 5 % 5, n / 25].map(|index| 0.01 * index as f64);
    let points: Vec<[f64; 3]> = (0..125).map(at).collect();
    let lines = |separator: &str| {
        points.iter().fold(String::new(), |mut text, [x, y, z]| {
            let _ = writeln!(text, "{x}{separator}{y}{separator}{z}");
            text
        })
    };
    let reals = || points.iter().flatten();
    let frame = VtuFrame {
        numbers: Vec::new(),
        points: &points,
        cells: None,
        point_data: vec![PointArray::new("J", 1, vec![1.0; points.len()])],
    };
    let legacy = |kind: &str| {
        format!(
            "# vtk DataFile Version 3.0\nnodes\n{kind}\nDATASET UNSTRUCTURED_GRID\nPOINTS 125 double\n"
        )
    };
    let inline = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
         <UnstructuredGrid>\n<Piece NumberOfPoints=\"125\" NumberOfCells=\"0\">\n<Points>\n<DataArray type=\"Float64\" \
         Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n{}</DataArray>\n</Points>\n</Piece>\n\
         </UnstructuredGrid>\n</VTKFile>\n",
        lines(" ")
    );
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (125, 3), }";
    let header = format!("{header:<117}\n");
    let values: Vec<u8> = reals().flat_map(|value| value.to_le_bytes()).collect();
    let npy = [b"\x93NUMPY\x01\x00".as_slice(), &118u16.to_le_bytes(), header.as_bytes(), &values];
    let binary: Vec<u8> = reals().flat_map(|value| value.to_be_bytes()).collect();
    Ok(vec![
        Input::new(format!("x,y,z\n{}", lines(",")), "csv"),
        Input::new(format!("# nodes\n{}", lines(", ")), "csv"),
        Input::new(npy.concat(), "npy"),
        Input::new(to_vtu(&frame)?, "vtu"),
        Input::new(inline, "vtu"),
        Input::new(legacy("ASCII") + &lines(" "), "vtk"),
        Input::new([legacy("BINARY").as_bytes(), &binary].concat(), "vtk"),
    ])
}
