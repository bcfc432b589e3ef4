//! Surface files and regions that a run cannot be made of, from the outside.

use assert_cmd::Command;
use std::path::Path;
use std::time::Duration;
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

/// Exit code and what is printed of `mtled` in a folder.
fn run(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mtled"));
    command.current_dir(folder).args(arguments).timeout(Duration::from_secs(120));
    let output = command.output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    (output.status.code().unwrap(), String::from_utf8(text).unwrap())
}

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

fn case_of(surface: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("case.toml"), CASE).unwrap();
    std::fs::write(folder.path().join("body.stl"), surface).unwrap();
    folder
}

#[test]
fn a_run_has_the_mass_of_all_solids_of_a_file() {
    let folder = case_of(&(cube(0.0, 40.0) + &cube(60.0, 100.0)));
    let arguments = ["solve", "case.toml", "--out", "run", "--no-error-bar", "-q"];
    let (code, text) = run(folder.path(), &arguments);
    assert_eq!(code, 0, "{text}");
    let result = std::fs::read_to_string(folder.path().join("run/result.json")).unwrap();
    let result: serde_json::Value = serde_json::from_str(&result).unwrap();
    let mass = result["discretisation"]["mass_kg"].as_f64().unwrap();
    assert!((mass / 0.128 - 1.0).abs() < 0.01, "{mass}");
}

#[test]
fn solids_that_would_count_twice_are_refused_by_their_numbers() {
    let shells = [
        (cube(0.0, 40.0) + &cube(10.0, 30.0), "shell 2 of the 2 that", "lies inside shell 1"),
        (cube(0.0, 40.0) + &cube(20.0, 60.0), "shells 1 and 2 of the 2 that", "cross or coincide"),
    ];
    for (surface, which, what) in shells {
        let folder = case_of(&surface);
        let (code, text) = run(folder.path(), &["inspect", "case.toml"]);
        assert_eq!(code, 2, "{text}");
        assert!(text.contains(which) && text.contains(what), "{text}");
        assert!(text.contains("geometry.shape.stl.file"), "{text}");
    }
}

#[test]
fn a_centre_of_mass_of_a_region_without_points_is_refused_with_its_name() {
    let folder = case_of(&cube(0.0, 40.0));
    let regions = "[[region]]\nname = \"speck\"\nmaterial = \"tissue\"\nwhere = { sphere = { centre = [0.02, \
                   0.02, 0.02], radius = 1e-7 } }\n\n[[region]]\nname = \"rest\"\nmaterial = \"tissue\"\nwhere = \
                   \"all\"\n\n[[probe]]\nname = \"centre\"\ncentre_of_mass = \"speck\"\n";
    std::fs::write(folder.path().join("case.toml"), CASE.to_string() + regions).unwrap();
    let (code, text) = run(folder.path(), &["solve", "case.toml", "--out", "run"]);
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
        let (code, text) = run(folder.path(), &[command, "case.toml"]);
        assert!(code == 2 && text.contains("the body encloses no volume"), "{code} {text}");
    }
}
