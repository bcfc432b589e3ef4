//! Error bars as users meet them: beside every answer, or words why there is none.

use crate::common::program::mtled;
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// A block that is pushed between bonded faces, in a moment.
const BLOCK: &str = r#"
title = "Pushed block"

[geometry]
shape = { box = { min = [0.0, 0.0, 0.0], max = [0.1, 0.1, 0.1] } }

[material.tissue]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.3

[discretisation]
cloud = "regular"
spacing = 0.0125

[[prescribe]]
name = "bottom"
of = "surface"
where = { plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] } }
displacement = { x = 0.0, y = 0.0, z = 0.0 }

[[prescribe]]
name = "top"
of = "surface"
where = { plane = { point = [0.0, 0.0, 0.1], normal = [0.0, 0.0, 1.0] } }
displacement = { x = 0.0, y = 0.0, z = -0.01 }
amplitude = { smooth = { duration = 1.0 } }

[time]
method = "static"

[[probe]]
name = "bulge"
point = [0.1, 0.05, 0.05]

[[probe]]
name = "whole"
centre_of_mass = "body"

[output]
frames = 2
"#;

const TOP: &str = "{ plane = { point = [0.0, 0.0, 0.1], normal = [0.0, 0.0, 1.0] } }";

/// What is printed of a solution in a folder.
fn solved_in(dir: &Path, text: &str, more: &[&str]) -> String {
    std::fs::write(dir.join("case.toml"), text).unwrap();
    let (code, out, err) = mtled(dir, &[&["solve", "case.toml", "--out", "out"], more].concat());
    assert_eq!(code, 0, "{err}");
    out
}

fn result(dir: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(dir.join("out/result.json")).unwrap()).unwrap()
}

fn solved(text: &str, more: &[&str]) -> (Value, String) {
    let dir = TempDir::new().unwrap();
    let printed = solved_in(dir.path(), text, more);
    (result(dir.path()), printed)
}

#[test]
fn every_answer_of_a_smooth_problem_has_an_error_bar_in_its_unit() {
    let (result, text) = solved(BLOCK, &[]);
    let bars = &result["error_bars"];
    for (list, name, key) in [
        ("probes", "probe", "displacement_m"),
        ("forces", "condition", "force_n"),
        ("moments", "condition", "moment_n_m"),
        ("energies", "energy", "energy_j"),
    ] {
        let entries = bars[list].as_array().unwrap();
        assert!(!entries.is_empty(), "{bars}");
        for entry in entries {
            assert!(entry[name].is_string() && entry[key].as_f64().unwrap() > 0.0, "{entry}");
        }
    }
    let bulge = result["probes"][0]["displacement_m"][0][0].as_f64().unwrap();
    let bar = bars["probes"][0]["displacement_m"].as_f64().unwrap();
    assert!(bar < 0.1 * bulge, "{bar} of {bulge} m");
    assert!(text.contains(") m ± ") && text.contains(") N ± "), "{text}");
    assert!(bars["coarser_clouds"].as_array().unwrap().len() >= 2);
}

#[test]
fn error_bars_can_be_left_out_and_change_no_other_figure() {
    let (mut with, _) = solved(BLOCK, &[]);
    let (mut without, text) = solved(BLOCK, &["--no-error-bar"]);
    assert!(without.get("error_bars").is_none() && !text.contains('±'), "{text}");
    for result in [&mut with, &mut without] {
        let result = result.as_object_mut().unwrap();
        result.remove("error_bars");
        result.remove("timings");
    }
    assert_eq!(with, without);
}

#[test]
fn error_bars_and_their_field_are_the_same_on_any_number_of_threads() {
    let run = |threads: &str| {
        let dir = TempDir::new().unwrap();
        solved_in(dir.path(), BLOCK, &["--threads", threads]);
        let frame = std::fs::read(dir.path().join("out/nodes_0001.vtu")).unwrap();
        (result(dir.path())["error_bars"].clone(), frame)
    };
    let (bars, frame) = run("1");
    assert!(String::from_utf8_lossy(&frame).contains("displacement_error_bar"));
    assert_eq!((bars, frame), run("4"));
}

#[test]
fn a_disc_that_is_held_within_a_face_has_bars_of_its_force_too() {
    let disc = "{ intersection = [{ plane = { point = [0.0, 0.0, 0.1], normal = [0.0, 0.0, 1.0] } }, \
                { sphere = { centre = [0.05, 0.05, 0.1], radius = 0.031 } }] }";
    let (result, text) = solved(&BLOCK.replace(TOP, disc), &[]);
    let bars = &result["error_bars"];
    assert!(bars["probes"][1]["displacement_m"].is_number(), "{bars}");
    for entry in bars["forces"].as_array().unwrap() {
        assert!(entry["force_n"].is_number(), "{bars}");
    }
    assert!(!text.contains("no error bar"), "{text}");
}

#[test]
fn a_cloud_that_cannot_be_coarser_leaves_the_run_as_it_is_and_says_why() {
    let coarse = BLOCK.replace("spacing = 0.0125", "spacing = 0.05");
    let (result, text) = solved(&coarse, &[]);
    assert_eq!(result["motion"]["outcome"], "converged");
    let words = result["error_bars"]["unknown"].as_str();
    let few = result["error_bars"]["coarser_clouds"].as_array().map(Vec::len);
    assert!(words.is_some() || few.is_some(), "{result}");
    assert!(text.contains("error bar") || text.contains('±'), "{text}");
}

#[test]
fn nodes_given_one_by_one_have_no_coarser_cloud() {
    let dir = TempDir::new().unwrap();
    let mut points = String::new();
    for n in 0..6 * 6 * 6 {
        let at = |index: usize| 0.02 * index as f64;
        points += &format!("{},{},{}\n", at(n % 6), at(n / 6 % 6), at(n / 36));
    }
    std::fs::write(dir.path().join("nodes.csv"), format!("x,y,z\n{points}")).unwrap();
    let given = BLOCK.replace(
        "cloud = \"regular\"\nspacing = 0.0125",
        "cloud = \"file\"\nfile = \"nodes.csv\"\n[discretisation.grid]\ncell = 0.0158",
    );
    solved_in(dir.path(), &given, &[]);
    let words = result(dir.path())["error_bars"]["unknown"].clone();
    assert_eq!(words, "nodes given one by one have no coarser cloud");
}
