//! `mtled sensitivity`: which numbers of a case matter, against solutions on both sides of them.

use crate::common::program::{json, mtled};
use serde_json::Value;

/// The bound of the study of sensitivities; the error of the two solutions is a part of it \[–\].
const AGREEMENT: f64 = 1e-4;

fn sensitivity(arguments: &[&str]) -> (i32, String, String) {
    mtled(".", &[&["sensitivity"], arguments].concat())
}

fn found(arguments: &[&str]) -> Value {
    json(&[&["sensitivity"], arguments].concat())
}

/// Per cent per per cent of an answer by the number with a key that ends like this.
fn of(found: &Value, answer: &str, key: &str) -> f64 {
    let answers = found["answers"].as_array().unwrap();
    let column = answers.iter().position(|own| own["name"] == answer);
    let column = column.unwrap_or_else(|| panic!("{answer} is not in {answers:?}"));
    let rows = found["numbers"].as_array().unwrap();
    let row = rows.iter().find(|row| row["key"].as_str().unwrap().ends_with(key));
    let row = row.unwrap_or_else(|| panic!("{key} is not in {rows:?}"));
    row["per_cent_per_per_cent"][column].as_f64().unwrap()
}

#[test]
fn sensitivities_are_those_of_solutions_on_both_sides_of_each_number() {
    for case in ["cube_compression", "cube_shear", "indented_block", "sphere_gravity"] {
        let found = found(&[case, "--check"]);
        let rows = found["numbers"].as_array().unwrap();
        assert!(rows.len() >= 2, "{case}: {rows:?}");
        for row in rows {
            let difference = row["largest_difference"].as_f64().unwrap();
            assert!(difference < AGREEMENT, "{case}: {row}");
        }
    }
}

#[test]
fn forces_grow_as_the_stiffness_where_displacements_are_prescribed() {
    let found = found(&["cube_shear", "--of", "force/top", "--of", "strain_energy"]);
    for answer in ["force/top", "strain_energy"] {
        let own = of(&found, answer, "young_modulus");
        assert!((own - 1.0).abs() < 1e-7, "{answer}: {own}");
    }
    let without = found["without_effect"].as_array().unwrap();
    assert!(without.iter().any(|key| key.as_str().unwrap().ends_with("density")), "{without:?}");
}

#[test]
fn what_was_set_on_the_command_line_counts() {
    let ratio = "material.tissue.poisson_ratio=0.3";
    let set = found(&["cube_shear", "--set", ratio, "--of", "force/top"]);
    let rows = set["numbers"].as_array().unwrap();
    let own = rows.iter().find(|row| row["key"] == "material.tissue.poisson_ratio").unwrap();
    assert_eq!(own["value"], 0.3);
}

#[test]
fn what_matters_most_comes_first_in_the_table() {
    let (code, out, err) = sensitivity(&["cube_shear"]);
    assert_eq!(code, 0, "{err}");
    let line = |key: &str| out.lines().position(|line| line.contains(key));
    assert!(line("prescribe.top") < line("young_modulus"), "{out}");
    assert!(out.contains("without effect: material.tissue.density"), "{out}");
}

#[test]
fn motions_obstacles_that_hold_and_unknown_answers_are_refused() {
    let dynamic = ["cube_shear", "--set", "time={ method = \"dynamic\", end = 0.1 }"];
    let held = ["brain_shift", "--set", "obstacle.skull.friction=\"no_slip\""];
    let unknown = ["cube_shear", "--of", "force/bottm"];
    for (arguments, message) in [
        (&dynamic[..], "time.method: is \"dynamic\"; sensitivities are those of a static solution"),
        (
            &held,
            "obstacle[0].friction: is not \"frictionless\": a solution then depends on the way to it",
        ),
        (&unknown, "there is no answer `force/bottm`; those of this case are"),
    ] {
        let (code, out, err) = sensitivity(arguments);
        assert_eq!(code, 2, "{arguments:?}: {err}");
        assert!(err.contains(message) && out.is_empty(), "{arguments:?}: {err}");
    }
}
