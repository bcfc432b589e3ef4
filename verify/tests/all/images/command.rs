//! `mtled warp` from the outside: files, exit codes, refusals.
#![allow(non_snake_case)]

use super::image::{Kind, around, nifti};
use crate::common::program::mtled;
use mtled::algebra::tensor::Vector3;
use mtled_io::files::{LengthUnit, surface};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

const CASE: &str = concat!(
    "\n",
    include_str!("../common/pulled_block.toml"),
    "[time]\nmethod = \"static\"\nload_end = 1.0\n\n[output]\nframes = 0\nhistory = 2\n"
);
const POINTS: &str = "name,x_mm,y_mm,z_mm,x2_mm,y2_mm,z2_mm\ntop,50,50,90,50,50,94\n\
                      free,20,30,40,,,\noutside,50,50,130,,,\n";

/// A solved block in `run`, an image of it, one of another space, and landmarks.
fn solved() -> TempDir {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("case.toml", CASE.as_bytes());
    let value = |[i, j, k]: [usize; 3]| (i + 2 * j + 3 * k) as f64;
    write("t1.nii", &nifti(&around(Vector3::repeat(50.0)), Kind::F32, value));
    write("far.nii", &nifti(&around(Vector3::repeat(5000.0)), Kind::F32, value));
    write("marks.csv", POINTS.as_bytes());
    write("plain.csv", b"name,x,y,z\ntop,50,50,90\n");
    let (code, _, err) =
        mtled(&folder, &["solve", "case.toml", "--out", "run", "--no-error-bar", "-q"]);
    assert_eq!(code, 0, "{err}");
    folder
}

/// Names of all files below a folder.
fn listing(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            names.extend(listing(&path))
        } else {
            names.push(path.display().to_string())
        }
    }
    names.sort();
    names
}

#[test]
fn an_image_its_fields_and_landmarks_are_written_and_told() {
    let folder = solved();
    let arguments = [
        "warp",
        "run",
        "--image",
        "t1.nii",
        "--out",
        "new/t1.nii.gz",
        "--field",
        "u.nii.gz",
        "--inverse-field",
        "back.nrrd",
        "--points",
        "marks.csv",
        "--format",
        "json",
    ];
    let (code, out, err) = mtled(&folder, &arguments);
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("1 of 3 landmarks lie outside of the body"), "{err}");
    let summary: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(summary["image"]["voxels"], 16 * 12 * 14);
    assert_eq!(summary["image"]["unconverged"], 0);
    for file in ["new/t1.nii.gz", "u.nii.gz", "back.nrrd", "run/landmarks.csv"] {
        assert!(folder.path().join(file).is_file(), "{file}");
    }
    let top = &summary["landmarks"][0];
    let moved = top["moved_mm"][2].as_f64().unwrap() - 90.0;
    let (before, after) = (&top["error_before_mm"], &top["error_after_mm"]);
    assert!(moved > 0.1 && (before.as_f64().unwrap() - 4.0).abs() < 1e-9, "{top}");
    assert!((after.as_f64().unwrap() - (4.0 - moved).abs()).abs() < 0.01, "{top}");
    assert!(summary["landmarks"][1]["error_after_mm"].is_null());
    let csv = std::fs::read_to_string(folder.path().join("run/landmarks.csv")).unwrap();
    assert!(csv.starts_with("name,x_mm,y_mm,z_mm,moved_x_mm") && csv.lines().count() == 4, "{csv}");
}

#[test]
fn a_landmark_moves_as_a_probe_in_its_place() {
    let folder = TempDir::new().unwrap();
    let probe = "\n[[probe]]\nname = \"top\"\npoint = [0.05, 0.05, 0.09]\n";
    std::fs::write(folder.path().join("case.toml"), format!("{CASE}{probe}")).unwrap();
    std::fs::write(folder.path().join("plain.csv"), "name,x,y,z\ntop,0.05,0.05,0.09\n").unwrap();
    let solve = ["solve", "case.toml", "--out", "run", "--no-error-bar", "-q"];
    assert_eq!(mtled(&folder, &solve).0, 0);
    let warp = ["warp", "run", "--points", "plain.csv", "--unit", "m", "--format", "json"];
    let (code, out, err) = mtled(&folder, &warp);
    assert_eq!(code, 0, "{err}");
    let summary: Value = serde_json::from_str(&out).unwrap();
    let history = std::fs::read_to_string(folder.path().join("run/history.csv")).unwrap();
    let cells = |line: &str| line.split(',').map(String::from).collect::<Vec<_>>();
    let header = cells(history.lines().next().unwrap());
    let last = cells(history.lines().last().unwrap());
    for (axis, name) in ["top.ux_m", "top.uy_m", "top.uz_m"].into_iter().enumerate() {
        let column = header.iter().position(|cell| cell == name).unwrap();
        let expected = 1e3 * last[column].parse::<f64>().unwrap();
        let mark = &summary["landmarks"][0];
        let moved = mark["moved_mm"][axis].as_f64().unwrap() - [50.0, 50.0, 90.0][axis];
        assert!((moved - expected).abs() < 1e-9, "{name}: {moved} mm, {expected} mm");
    }
}

#[test]
fn what_cannot_be_warped_is_refused_with_code_2_and_nothing_is_written() {
    let folder = solved();
    let before = listing(folder.path());
    let refused = |arguments: &[&str], expected: &[&str]| {
        let (code, out, err) = mtled(&folder, &[&["warp"], arguments].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}: {err}");
        for part in expected {
            assert!(err.contains(part), "{arguments:?}: {part} is not in {err}");
        }
        assert_eq!(listing(folder.path()), before, "{arguments:?}");
    };
    refused(&["run"], &["--image"]);
    refused(&["nowhere", "--image", "t1.nii"], &["displacement_field.json", "solve again"]);
    refused(&["run", "--image", "none.nii"], &["none.nii", "cannot be read"]);
    refused(&["run", "--image", "far.nii"], &["far.nii", "another space", "4975.8"]);
    refused(&["run", "--image", "t1.nii", "--image-unit", "m"], &["t1.nii", "another space"]);
    refused(&["run", "--image", "case.toml"], &["case.toml", ".nii.gz"]);
    let image = ["run", "--image", "t1.nii"];
    refused(&[&image[..], &["--out", "a.dcm"]].concat(), &["a.dcm", ".nii, .nii.gz, .nrrd"]);
    refused(&[&image[..], &["--field", "u.mha"]].concat(), &["u.mha", ".nii, .nii.gz, .nrrd"]);
    refused(&[&image[..], &["--out", "t1.nii"]].concat(), &["t1.nii", "named twice"]);
    let twice = ["--field", "u.nii", "--inverse-field", "./u.nii"];
    refused(&[&image[..], &twice].concat(), &["u.nii", "named twice"]);
    refused(&[&image[..], &["--decay", "-1"]].concat(), &["--decay"]);
    refused(&["run", "--points", "plain.csv"], &["plain.csv", "line 1", "--unit"]);
    refused(&["run", "--points", "t1.nii"], &["t1.nii", ".csv"]);
    std::fs::write(folder.path().join("case.toml"), CASE.replace("3000.0", "3001.0")).unwrap();
    let changed = ["displacement_field.json", "case.toml", "was changed since"];
    refused(&image, &changed);
    std::fs::remove_file(folder.path().join("case.toml")).unwrap();
    let before: Vec<String> =
        before.iter().filter(|name| !name.ends_with("case.toml")).cloned().collect();
    let (code, _, err) = mtled(&folder, &["warp", "run", "--image", "t1.nii"]);
    assert!(code == 2 && err.contains("name it with --case"), "{err}");
    assert_eq!(listing(folder.path()), before);
    std::fs::write(folder.path().join("moved.toml"), CASE).unwrap();
    let (code, _, err) =
        mtled(&folder, &[&["warp"], &image[..], &["--case", "moved.toml"]].concat());
    assert_eq!(code, 0, "{err}");
}

#[test]
fn a_damaged_field_is_refused() {
    let folder = solved();
    let file = folder.path().join("run/displacement_field.json");
    let text = std::fs::read_to_string(&file).unwrap();
    let mut field: Value = serde_json::from_str(&text).unwrap();
    field["influence_radius_m"].as_array_mut().unwrap().pop();
    let layouts = [text[..text.len() / 2].to_string(), field.to_string()];
    for (damaged, expected) in layouts.into_iter().zip(["cannot be read", "the file is damaged"]) {
        std::fs::write(&file, damaged).unwrap();
        let (code, _, err) = mtled(&folder, &["warp", "run", "--image", "t1.nii"]);
        assert!(code == 2 && err.contains("displacement_field.json"), "{err}");
        assert!(err.contains(expected), "{err}");
    }
}

/// Volume that a surface file in mm along L, P and S encloses \[m³\], and its highest point \[m\].
fn enclosed(path: &Path) -> (f64, f64) {
    assert!(std::fs::read(path).unwrap().starts_with(b"SPACE=LPS"), "{}", path.display());
    let surface = surface::read(path, LengthUnit::Millimetre).unwrap().surface;
    let volume = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|n| surface.vertices[n as usize]);
        a.cross(&b).dot(&c) / 6.0
    };
    let top = surface.vertices.iter().map(|X| X.z).fold(f64::NEG_INFINITY, f64::max);
    (surface.triangles.iter().map(volume).sum(), top)
}

#[test]
fn surfaces_of_the_body_and_its_regions_are_closed_and_move_with_it() {
    let folder = TempDir::new().unwrap();
    let regions = "[[region]]\nname = \"core/1\"\nmaterial = \"tissue\"\nwhere = { sphere = { centre = \
                   [0.05, 0.05, 0.1], radius = 0.03 } }\n\n[[region]]\nname = \"rest\"\nwhere = \"all\"\n\
                   material = \"tissue\"\n\n[[prescribe]]";
    let case = CASE.replacen("[[prescribe]]", regions, 1);
    std::fs::write(folder.path().join("case.toml"), &case).unwrap();
    let (code, _, err) =
        mtled(&folder, &["solve", "case.toml", "--out", "run", "--no-error-bar", "-q"]);
    assert_eq!(code, 0, "{err}");
    let (code, out, err) = mtled(&folder, &["warp", "run", "--surfaces", "stl", "-q"]);
    assert_eq!(code, 0, "{out}{err}");
    let names: Vec<String> = listing(&folder.path().join("stl"));
    assert_eq!(names.len(), 6, "{names:?}");
    let of = |name: &str| enclosed(&folder.path().join(format!("stl/{name}.stl")));
    let (body, core, rest) = (of("body"), of("region_core-1"), of("region_rest"));
    // Half of the ball lies in the block; edges are cut off by less than a cube.
    let half_ball = 2.0 / 3.0 * std::f64::consts::PI * 0.03f64.powi(3);
    assert!((core.0 / half_ball - 1.0).abs() < 0.05, "{core:?}");
    assert!((body.0 / 1e-3 - 1.0).abs() < 0.02 && (body.1 - 0.1).abs() < 1e-6, "{body:?}");
    assert!(((core.0 + rest.0) / body.0 - 1.0).abs() < 0.02, "{core:?} {rest:?}");
    // Pulled upwards, it is higher and larger.
    let after = of("body_deformed");
    assert!(after.1 > body.1 + 1e-4 && after.0 > body.0, "{body:?} {after:?}");
}
