//! `mtled frequencies`: natural frequencies of the bodies of cases.

use crate::common::program::{json, mtled};
use serde_json::Value;

fn frequencies(arguments: &[&str]) -> (i32, String, String) {
    mtled(".", &[&["frequencies"], arguments].concat())
}

fn found(arguments: &[&str]) -> Value {
    json(&[&["frequencies"], arguments].concat())
}

fn values(found: &Value) -> Vec<f64> {
    let modes = found["modes"].as_array().unwrap();
    modes.iter().map(|mode| mode["frequency_hz"].as_f64().unwrap()).collect()
}

#[test]
fn frequencies_grow_as_the_root_of_the_stiffness_and_fall_as_that_of_the_density() {
    let body = ["cube_shear", "--modes", "4", "--set", "discretisation.spacing=0.02"];
    let own = values(&found(&body));
    for (key, factor) in [("young_modulus=12000.0", 2.0), ("density=4000.0", 0.5)] {
        let set = format!("material.tissue.{key}");
        let other = values(&found(&[&body[..], &["--set", &set]].concat()));
        for (own, other) in own.iter().zip(other) {
            assert!((other / own / factor - 1.0).abs() < 1e-9, "{key}: {own} {other}");
        }
    }
}

#[test]
fn a_body_that_nothing_holds_has_six_rigid_motions_and_as_many_frequencies_as_are_asked_for() {
    let free = found(&["cube_shear", "--modes", "5", "--set", "prescribe=[]"]);
    assert_eq!(free["rigid_motions"], 6);
    let values = values(&free);
    assert!(values.len() == 5 && values[0] > 1.0, "{values:?}");
    assert!((values[1] / values[0] - 1.0).abs() < 1e-9, "{values:?}");
    assert_eq!(free["converged"], true);
}

#[test]
fn what_is_left_out_is_said() {
    for (case, text) in [
        ("sphere_gravity", "loads are left out"),
        ("brain_shift", "obstacles and contact with them are left out"),
        ("cube_shear", "about the undeformed body, undamped, with consistent masses"),
    ] {
        let (code, out, err) = frequencies(&[case, "--modes", "1"]);
        assert!(code == 0 && out.contains(text), "{case}: {out} {err}");
    }
}

#[test]
fn modes_are_written_with_a_largest_displacement_of_1() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    let printed = found(&["cube_shear", "--modes", "2", "--out", out]);
    let stored = std::fs::read_to_string(folder.path().join("frequencies.json")).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&stored).unwrap(), printed);
    for file in ["body_modes.vtu", "nodes_modes.vtu"] {
        let bytes = std::fs::read(folder.path().join(file)).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("Name=\"mode_01\"") && text.contains("Name=\"mode_02\""), "{file}");
        assert!(!text.contains("mode_03"), "{file}");
    }
}

#[test]
fn numbers_of_modes_that_are_not_there_are_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("modes");
    let none = ["cube_shear", "--modes", "0"];
    let many = ["cube_shear", "--modes", "900", "--set", "discretisation.spacing=0.05"];
    let absent = ["cube_shere"];
    for (arguments, message) in [
        (&none[..], "0 is not in 1..=1000"),
        (&many, "900 frequencies are asked for, and the body has 27: its nodes have 81 components"),
        (&absent, "there is no such file, and no bundled case of that name"),
    ] {
        let arguments = [arguments, &["--out", out.to_str().unwrap()]].concat();
        let (code, printed, err) = frequencies(&arguments);
        assert_eq!(code, 2, "{arguments:?}: {err}");
        assert!(err.contains(message) && printed.is_empty(), "{arguments:?}: {err}");
        assert!(!out.exists());
    }
}
