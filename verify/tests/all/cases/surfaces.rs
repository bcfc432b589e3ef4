//! Bodies from surface files of every format, and those that a run cannot be made of, from the outside.

use crate::common::program::printed;
use tempfile::TempDir;

const CASE: &str = r#"
title = "A body from a surface"

[geometry]
shape = { stl = { file = "body.stl", unit = "mm" } }

[material.tissue]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.3

[discretisation]
cloud = "regular"
spacing = 0.01

[[prescribe]]
name = "all"
of = "surface"
where = "all"
displacement = { x = 0.0, y = 0.0, z = 0.001 }

[time]
method = "static"
"#;

/// A solid of text: a cube of edge `high` - `low` along the diagonal \[mm\].
fn cube(low: f64, high: f64) -> String {
    const FACES: [[usize; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let vertex = |n: usize| {
        let [x, y, z] = [0, 1, 2].map(|k| if n >> k & 1 == 1 { high } else { low });
        format!("vertex {x} {y} {z}\n")
    };
    let facet = |corners: [usize; 3]| {
        let vertices = corners.map(vertex).concat();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    let faces = FACES.map(|[a, b, c, d]| facet([a, b, c]) + &facet([a, c, d]));
    format!("solid cube\n{}endsolid cube\n", faces.concat())
}

/// A folder with a case whose surface has this name and content.
fn case_with(name: &str, content: &[u8], case: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("case.toml"), case.replace("body.stl", name)).unwrap();
    std::fs::write(folder.path().join(name), content).unwrap();
    folder
}

fn case_of(surface: &str) -> TempDir {
    case_with("body.stl", surface.as_bytes(), CASE)
}

fn result_in(folder: &TempDir) -> serde_json::Value {
    let text = std::fs::read_to_string(folder.path().join("run/result.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_run_has_the_mass_of_all_solids_of_a_file() {
    let folder = case_of(&(cube(0.0, 40.0) + &cube(60.0, 100.0)));
    let arguments = ["solve", "case.toml", "--out", "run", "--no-error-bar", "-q"];
    let (code, text) = printed(&folder, &arguments);
    assert_eq!(code, 0, "{text}");
    let mass = result_in(&folder)["discretisation"]["mass_kg"].as_f64().unwrap();
    assert!((mass / 0.128 - 1.0).abs() < 0.01, "{mass}");
}

#[test]
fn solids_that_lie_in_each_other_count_once_and_the_run_says_so() {
    let shells = [
        (cube(0.0, 40.0) + &cube(10.0, 30.0), 0.064, "shell 2 of 2", "lies inside shell 1"),
        (cube(0.0, 40.0) + &cube(20.0, 60.0), 0.12, "shells 1 and 2 of 2", "is their union"),
    ];
    for (surface, right, which, what) in shells {
        let folder = case_of(&surface);
        let arguments = ["solve", "case.toml", "--out", "run", "--no-error-bar"];
        let (code, text) = printed(&folder, &arguments);
        assert_eq!(code, 0, "{text}");
        assert!(text.contains(which) && text.contains(what), "{text}");
        let mass = result_in(&folder)["discretisation"]["mass_kg"].as_f64().unwrap();
        assert!((mass / right - 1.0).abs() < 0.005, "{mass} of {right} kg");
    }
}

#[test]
fn a_centre_of_mass_of_a_region_without_points_is_refused_with_its_name() {
    let folder = case_of(&cube(0.0, 40.0));
    let regions = "[[region]]\nname = \"speck\"\nmaterial = \"tissue\"\nwhere = { sphere = { centre = [0.02, \
                   0.02, 0.02], radius = 1e-7 } }\n\n[[region]]\nname = \"rest\"\nmaterial = \"tissue\"\nwhere = \
                   \"all\"\n\n[[probe]]\nname = \"centre\"\ncentre_of_mass = \"speck\"\n";
    std::fs::write(folder.path().join("case.toml"), CASE.to_string() + regions).unwrap();
    let (code, text) = printed(&folder, &["solve", "case.toml", "--out", "run"]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("region \"speck\" has no quadrature point"), "{text}");
}

#[test]
fn a_body_without_volume_is_refused() {
    let folder = case_of("");
    let ball = "{ sphere = { centre = [0.0, 0.0, 0.0], radius = 0.04 } }";
    let nothing = format!("{{ difference = [{ball}, {ball}] }}");
    let case = CASE.replace("{ stl = { file = \"body.stl\", unit = \"mm\" } }", &nothing);
    std::fs::write(folder.path().join("case.toml"), case).unwrap();
    for command in ["inspect", "solve"] {
        let (code, text) = printed(&folder, &[command, "case.toml"]);
        assert!(code == 2 && text.contains("the body encloses no volume"), "{code} {text}");
    }
}

/// An edge of 40 mm, one corner pulled out: no two faces are alike.
const POINTS: [[f64; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [40.0, 0.0, 0.0],
    [0.0, 40.0, 0.0],
    [40.0, 40.0, 0.0],
    [0.0, 0.0, 40.0],
    [40.0, 0.0, 40.0],
    [0.0, 40.0, 40.0],
    [44.0, 42.0, 41.0],
];
const TRIANGLES: [[usize; 3]; 12] = [
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
];

fn rows<const N: usize, T: std::fmt::Display>(rows: &[[T; N]], before: &str) -> String {
    let row = |row: &[T; N]| {
        let numbers: Vec<String> = row.iter().map(T::to_string).collect();
        format!("{before}{}\n", numbers.join(" "))
    };
    rows.iter().map(row).collect()
}

fn stl() -> String {
    let facet = |t: &[usize; 3]| {
        let vertices = rows(&t.map(|n| POINTS[n]), "vertex ");
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    format!("solid body\n{}endsolid body\n", TRIANGLES.iter().map(facet).collect::<String>())
}

fn obj() -> String {
    rows(&POINTS, "v ") + &rows(&TRIANGLES.map(|t| t.map(|n| n + 1)), "f ")
}

fn ply() -> Vec<u8> {
    let header = "ply\nformat binary_big_endian 1.0\nelement vertex 8\nproperty double x\nproperty double \
                  y\nproperty double z\nelement face 12\nproperty list uchar ushort vertex_index\nend_header\n";
    let points = POINTS.iter().flatten().flat_map(|c| c.to_be_bytes());
    let corners = |t: &[usize; 3]| t.map(|n| (n as u16).to_be_bytes()).concat();
    let faces = TRIANGLES.iter().flat_map(|t| [vec![3], corners(t)].concat());
    header.bytes().chain(points).chain(faces).collect()
}

fn vtk() -> String {
    let head = "# vtk DataFile Version 3.0\nbody\nASCII\nDATASET POLYDATA\n";
    let faces = rows(&TRIANGLES, "3 ");
    format!("{head}POINTS 8 double\n{}POLYGONS 12 48\n{faces}", rows(&POINTS, ""))
}

fn vtp() -> String {
    let array = |name: &str, kind: &str, text: String| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{text}</DataArray>\n")
    };
    let ends: Vec<String> = (1..13).map(|n| (3 * n).to_string()).collect();
    format!(
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"8\"><Points>{}</Points><Polys>{}{}\
         </Polys></Piece></PolyData></VTKFile>\n",
        array("Points", "Float64", rows(&POINTS, "")),
        array("connectivity", "Int32", rows(&TRIANGLES, "")),
        array("offsets", "Int32", ends.join(" ")),
    )
}

/// The case on its flat foot, under its weight, on nodes that no lattice orders.
fn under_its_weight() -> String {
    let foot = "where = { plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] } }";
    let more = "[[body_force]]\nwhere = \"all\"\nacceleration = [0.0, 0.0, -9.81]\n\n[[probe]]\nname = \
                \"top\"\npoint = [0.02, 0.02, 0.039]\n";
    let changed = [
        ("cloud = \"regular\"", "cloud = \"jittered\"\njitter = 0.2"),
        ("where = \"all\"", foot),
        ("z = 0.001", "z = 0.0"),
    ];
    changed.iter().fold(CASE.to_string(), |case, (from, to)| {
        assert!(case.contains(from), "{from}");
        case.replace(from, to)
    }) + more
}

#[test]
fn a_body_gives_the_same_bits_from_every_format() {
    let answer = |name: &str, content: &[u8]| {
        let folder = case_with(name, content, &under_its_weight());
        let arguments = ["solve", "case.toml", "--out", "run", "--no-error-bar", "-q"];
        let (code, text) = printed(&folder, &arguments);
        assert_eq!(code, 0, "{name}: {text}");
        let result = result_in(&folder);
        let parts = ["nodes", "mass_kg"].map(|key| result["discretisation"][key].clone());
        (result["probes"].clone(), parts)
    };
    let first = answer("body.stl", stl().as_bytes());
    assert!(!first.0.is_null() && first.1.iter().all(|part| !part.is_null()), "{first:?}");
    assert_eq!(answer("body.obj", obj().as_bytes()), first);
    assert_eq!(answer("BODY.PLY", &ply()), first);
    assert_eq!(answer("body.vtk", vtk().as_bytes()), first);
    assert_eq!(answer("body.vtp", vtp().as_bytes()), first);
}

#[test]
fn a_surface_of_another_format_than_its_name_says_is_refused_at_its_key() {
    let folder = case_of(&obj());
    let (code, text) = printed(&folder, &["case", "check", "case.toml"]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("case.toml:5") && text.contains("that of a .obj file"), "{text}");
}

#[test]
fn a_face_with_a_point_that_is_missing_is_refused_with_its_line() {
    let folder = case_with("body.obj", obj().replace("f 1 3 4", "f 1 3 44").as_bytes(), CASE);
    let (code, text) = printed(&folder, &["case", "check", "case.toml"]);
    assert_eq!(code, 2, "{text}");
    assert!(text.contains("line 9 is `f 1 3 44`, which uses point 44"), "{text}");
}

#[test]
fn lines_in_a_surface_are_left_out_with_a_warning() {
    let folder = case_with("body.obj", (obj() + "l 1 2\n").as_bytes(), CASE);
    let (code, text) = printed(&folder, &["case", "check", "case.toml"]);
    assert!(code == 0 && text.contains("1 lines or points are left out"), "{code} {text}");
}
