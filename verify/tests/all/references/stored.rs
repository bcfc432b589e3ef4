//! References: which are accepted, and the messages of those that are refused.

use crate::common::{BLOCK, block, json, synthetic};
use mtled_case::bundled::{CASES, REFERENCES};
use mtled_case::reference::compare::compare;
use mtled_case::reference::{Basis, Family, Values, agreements, read_reference};
use mtled_case::scene::{parse_case, problem_hash, read_case};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn the_problem_hash_has_the_answers_that_python_has() {
    let path = repository().join("reference/tests/problem_hash.json");
    let rows: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    assert!(rows.as_array().unwrap().len() >= 4);
    for row in rows.as_array().unwrap() {
        let found = problem_hash(row["toml"].as_str().unwrap(), Path::new(".")).unwrap();
        assert_eq!(found, row["hash"].as_str().unwrap(), "{}", row["what"]);
    }
}

#[test]
fn the_problem_hash_sees_the_problem_and_nothing_else() {
    let hash = |text: &str| parse_case(text, "block.toml", Path::new(".")).unwrap().problem_hash;
    let same = [
        ("spacing = 0.02", "spacing = 0.025 # coarser"),
        ("title = \"Pulled block\"", "title = \"Another title\""),
        ("load_end = 1.0", "load_end = 1\ntolerance = 1e-3"),
        ("density = 1000.0\nyoung_modulus = 3000.0", "young_modulus = 3e3\ndensity = 1000"),
        ("acceleration = [0.0, 0.0, 1.0]", "acceleration = [-0.0, 0, 1]"),
    ];
    for (from, to) in same {
        assert!(BLOCK.contains(from));
        assert_eq!(hash(&BLOCK.replace(from, to)), hash(BLOCK), "{to}");
    }
    let other = [
        ("poisson_ratio = 0.3", "poisson_ratio = 0.31"),
        ("load_end = 1.0", "load_end = 2.0"),
        ("point = [0.05, 0.05, 0.1]", "point = [0.05, 0.05, 0.09]"),
        ("displacement = { x = 0.0, y = 0.0, z = 0.0 }", "displacement = { x = 0.0, y = 0.0 }"),
    ];
    for (from, to) in other {
        assert!(BLOCK.contains(from));
        assert_ne!(hash(&BLOCK.replace(from, to)), hash(BLOCK), "{to}");
    }
}

#[test]
fn the_problem_hash_sees_the_bytes_of_files() {
    let dir = TempDir::new().unwrap();
    let text = "[geometry]\nshape = { label_map = { file = \"map.nrrd\" } }\n";
    std::fs::write(dir.path().join("map.nrrd"), b"one").unwrap();
    let before = problem_hash(text, dir.path()).unwrap();
    std::fs::write(dir.path().join("map.nrrd"), b"two").unwrap();
    assert_ne!(problem_hash(text, dir.path()).unwrap(), before);
    std::fs::remove_file(dir.path().join("map.nrrd")).unwrap();
    assert!(problem_hash(text, dir.path()).unwrap_err().contains("map.nrrd"));
}

#[test]
fn a_sound_reference_is_read_and_both_codes_find_the_limit() {
    let case = block();
    let file = read_reference(&case, &json(&synthetic(&case)).to_string()).unwrap();
    for agreement in agreements(&case, &file) {
        assert!(agreement.agrees(), "{}", agreement.quantity.name);
        for estimate in &agreement.estimates {
            let Basis::Order(order) = estimate.basis else { panic!("{estimate:?}") };
            assert!((order - 2.0).abs() < 1e-9, "{order}");
        }
        // The code with the shorter bar is the first one; its slope is smaller.
        assert_eq!(agreement.better(), 0);
        let reference = agreement.reference();
        assert!(reference.error >= agreement.difference);
        for (n, value) in reference.values.iter().enumerate() {
            assert!((value - 0.01 * (1 + n % 3) as f64).abs() < 1e-12, "{value}");
        }
    }
}

#[test]
fn codes_that_find_different_limits_do_not_agree() {
    let case = block();
    let mut file = synthetic(&case);
    for mesh in &mut file.solutions[1].meshes {
        let Some(Values::History(lists)) = mesh.values.get_mut("force/bottom") else { panic!() };
        lists[0].iter_mut().for_each(|number| *number *= 1.05);
    }
    let different: Vec<_> = agreements(&case, &file).into_iter().filter(|a| !a.agrees()).collect();
    assert_eq!(different.len(), 1);
    assert_eq!(different[0].quantity.family, Family::Force);
    // The bar of what is kept covers the other code.
    let reference = different[0].reference();
    assert!(reference.error >= different[0].difference && different[0].ratio() > 1.0);
}

/// Where in the JSON, the new value (none: removed), part of the message.
type Fault = (&'static str, Option<&'static str>, &'static str);

#[test]
fn what_is_no_reference_is_refused_by_the_name_of_the_case() {
    let faults: [Fault; 25] = [
        ("/schema_version", Some("2"), "schema_version 2"),
        ("/case", Some("\"cube\""), "belongs to the case cube"),
        ("/problem_hash", Some("\"00\""), "made for another problem"),
        ("/times_s", Some("[]"), "end of loading"),
        ("/times_s", Some("[2.0]"), "end of loading"),
        ("/solutions", Some("[]"), "0 solutions of fenicsx"),
        ("/solutions/1/code", Some("\"fenicsx\""), "2 solutions of fenicsx"),
        ("/solutions/1/code", Some("\"abaqus\""), "abaqus is not a code"),
        ("/solutions/0/version", Some("\"\""), "fenicsx: no provenance: version is empty"),
        ("/solutions/0/version", None, "version"),
        ("/solutions/1/date", Some("\"yesterday\""), "scikit-fem: no provenance: date"),
        ("/solutions/1/element", Some("\" \""), "element is empty"),
        ("/solutions/1/mesh_family", Some("\"\""), "mesh_family is empty"),
        ("/solutions/1/formulation", Some("\"\""), "formulation is empty"),
        ("/solutions/1/solver", Some("\"\""), "solver is empty"),
        ("/solutions/0/packages", Some("{}"), "packages is empty"),
        ("/solutions/0/meshes/1/cpu_s", Some("0.0"), "lack a positive"),
        ("/solutions/0/meshes/1/size_m", Some("0.05"), "from coarse to fine"),
        ("/solutions/0/meshes", Some("[]"), "0 meshes"),
        ("/solutions/0/meshes/2/values/strain_energy", None, "mesh 2: strain_energy is missing"),
        ("/solutions/0/meshes/0/values/force~1top", Some("[[0.0]]"), "no quantity force/top"),
        ("/solutions/0/meshes/0/values/displacement~1top", Some("[[0.0, 1.0]]"), "has 2 numbers"),
        ("/solutions/0/meshes/0/values/force~1bottom", Some("[]"), "0 lists"),
        ("/solutions/0/meshes/0/values/strain_energy", Some("[[null]]"), "cannot be read"),
        ("/solutions/0/meshes/0/values/centre~1middle", Some("[[0.0,0.0,0.0]]"), "lists"),
    ];
    let case = block();
    for (pointer, replacement, message) in faults {
        let mut value = json(&synthetic(&case));
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let key = key.replace("~1", "/");
        let parent = value.pointer_mut(parent).unwrap().as_object_mut().unwrap();
        match replacement {
            Some(text) => parent.insert(key, serde_json::from_str(text).unwrap()),
            None => parent.remove(&key),
        };
        let error = read_reference(&case, &value.to_string()).unwrap_err().to_string();
        assert!(error.starts_with("block: "), "{pointer}: {error}");
        assert!(error.contains(message), "{pointer}: {error}");
    }
    let text = json(&synthetic(&case)).to_string().replacen("0.01", "1e999", 1);
    assert!(read_reference(&case, &text).unwrap_err().to_string().starts_with("block: "));
}

#[test]
fn a_mesh_that_is_solved_again_shows_what_moved() {
    let case = block();
    let stored = synthetic(&case);
    let mut again = stored.clone();
    again.solutions.truncate(1);
    again.solutions[0].meshes.truncate(1);
    assert_eq!(compare(&case, &stored, &again).unwrap()[0].relative, 0.0);
    let values = &mut again.solutions[0].meshes[0].values;
    let Some(Values::History(lists)) = values.get_mut("strain_energy") else { panic!() };
    lists[0][0] *= 1.0 + 3e-6;
    let change = &compare(&case, &stored, &again).unwrap()[0];
    assert_eq!(change.quantity, "strain_energy");
    assert!((1e-6..4e-6).contains(&change.relative), "{change:?}");
    again.solutions[0].meshes[0].elements += 1;
    assert!(compare(&case, &stored, &again).unwrap_err().starts_with("block: "));
}

#[test]
fn every_stored_reference_is_carried_and_belongs_to_a_case() {
    let folder = repository().join("reference/data");
    let mut stored: Vec<String> = std::fs::read_dir(folder).map_or_else(
        |_| Vec::new(),
        |entries| {
            let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
            names.filter_map(|name| name.strip_suffix(".json").map(str::to_string)).collect()
        },
    );
    stored.sort();
    let mut bundled: Vec<&str> = REFERENCES.iter().map(|(name, _)| *name).collect();
    bundled.sort_unstable();
    assert_eq!(stored, bundled);
    for (name, text) in REFERENCES {
        assert!(CASES.iter().any(|(case, _)| case == name), "{name}");
        assert!(text.len() < 1_000_000, "{name} has {} bytes", text.len());
        let case = repository().join(format!("reference/cases/{name}.toml"));
        read_reference(&read_case(&case).unwrap(), text).unwrap();
    }
}
