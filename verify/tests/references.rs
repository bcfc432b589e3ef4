//! References: what is accepted, what is refused and in which words, and what
//! the commands make of it.

use assert_cmd::Command;
use mtled_verify::cases::{CASES, REFERENCES};
use mtled_verify::reference::compare::compare;
use mtled_verify::reference::{
    Basis, Family, Mesh, ReferenceFile, Solution, Values, agree, quantities, read_reference,
};
use mtled_verify::scene::{Case, parse_case, problem_hash, read_case};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::TempDir;

const BLOCK: &str = r#"
title = "Pulled block"

[geometry]
shape = { box = { min = [0.0, 0.0, 0.0], max = [0.1, 0.1, 0.1] } }

[material.tissue]
law = "neo_hookean_log_j"
density = 1000.0
young_modulus = 3000.0
poisson_ratio = 0.3

[discretisation]
cloud = "regular"
spacing = 0.02

[[prescribe]]
name = "bottom"
of = "surface"
where = { plane = { point = [0.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] } }
displacement = { x = 0.0, y = 0.0, z = 0.0 }

[[body_force]]
acceleration = [0.0, 0.0, 1.0]

[time]
method = "static"
load_end = 1.0

[[probe]]
name = "top"
point = [0.05, 0.05, 0.1]

[[probe]]
name = "middle"
centre_of_mass = "body"
"#;

fn block() -> Case {
    parse_case(BLOCK, "block.toml", Path::new(".")).unwrap()
}

/// f₀ + a hᵖ for every number, with a slope of its own per code.
fn synthetic(case: &Case) -> ReferenceFile {
    let values = |slope: f64, h: f64| -> BTreeMap<String, Values> {
        let value = |n: usize| 0.01 * (1 + n) as f64 * (1.0 + slope * h.powi(2));
        let named = quantities(case).into_iter().map(|quantity| {
            let list: Vec<f64> = (0..quantity.width).map(value).collect();
            let values =
                if quantity.changes { Values::History(vec![list]) } else { Values::Once(list) };
            (quantity.name, values)
        });
        named.collect()
    };
    let solution = |code: &str, slope: f64| Solution {
        code: code.into(),
        version: "1.0".into(),
        date: "2026-11-21".into(),
        formulation: "displacement".into(),
        element: "Q2".into(),
        mesh_family: "hexahedra".into(),
        solver: "Newton".into(),
        time_scheme: None,
        packages: BTreeMap::from([("python".into(), "3.11".into())]),
        meshes: [0.04, 0.02, 0.01]
            .map(|h: f64| Mesh {
                size_m: h,
                elements: (0.1 / h).powi(3) as u64,
                unknowns: 100,
                cpu_s: 1.0,
                peak_memory_bytes: 1_000_000,
                time_step_s: None,
                load_steps: Some(1),
                newton_iterations: Some(4),
                values: values(slope, h),
            })
            .into(),
    };
    ReferenceFile {
        schema_version: 1,
        case: case.name.clone(),
        problem_hash: case.problem_hash.clone(),
        times_s: vec![1.0],
        solutions: vec![solution("fenicsx", 50.0), solution("scikit-fem", -80.0)],
    }
}

fn json(file: &ReferenceFile) -> Value {
    serde_json::to_value(file).unwrap()
}

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
    for agreement in agree(&case, &file) {
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
    let apart: Vec<_> = agree(&case, &file).into_iter().filter(|a| !a.agrees()).collect();
    assert_eq!(apart.len(), 1);
    assert_eq!(apart[0].quantity.family, Family::Force);
    // The bar of what is kept covers the other code.
    let reference = apart[0].reference();
    assert!(reference.error >= apart[0].difference && apart[0].ratio() > 1.0);
}

/// Where in the JSON, what to put there (nothing: remove it), what is said.
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
    let mut carried: Vec<&str> = REFERENCES.iter().map(|(name, _)| *name).collect();
    carried.sort_unstable();
    assert_eq!(stored, carried);
    for (name, text) in REFERENCES {
        assert!(CASES.iter().any(|(case, _)| case == name), "{name}");
        assert!(text.len() < 1_000_000, "{name} has {} bytes", text.len());
        let case = repository().join(format!("reference/cases/{name}.toml"));
        read_reference(&read_case(&case).unwrap(), text).unwrap();
    }
}

/// A folder with `reference/cases/block.toml`, `reference/data/block.json` and
/// the mark of a checkout.
fn checkout() -> TempDir {
    let dir = TempDir::new().unwrap();
    let reference = dir.path().join("reference");
    std::fs::create_dir_all(reference.join("cases")).unwrap();
    std::fs::create_dir_all(reference.join("data")).unwrap();
    std::fs::write(reference.join("pyproject.toml"), "").unwrap();
    std::fs::write(reference.join("cases/block.toml"), BLOCK).unwrap();
    let text = json(&synthetic(&block())).to_string();
    std::fs::write(reference.join("data/block.json"), text).unwrap();
    dir
}

fn mtled(dir: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mtled"));
    let output =
        command.current_dir(dir).args(arguments).timeout(Duration::from_secs(60)).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

const FROM_DISK: [&str; 4] = ["--cases", "reference/cases", "--data", "reference/data"];

#[test]
fn a_changed_digit_makes_the_check_fail_and_names_the_case() {
    let dir = checkout();
    let check = || mtled(dir.path(), &[&["reference", "check"][..], &FROM_DISK].concat());
    let (code, out, err) = check();
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.contains("block") && out.contains("agree"), "{out}");
    let path = dir.path().join("reference/cases/block.toml");
    std::fs::write(&path, BLOCK.replace("poisson_ratio = 0.3", "poisson_ratio = 0.4")).unwrap();
    let (code, _, err) = check();
    assert_eq!(code, 1);
    assert!(err.starts_with("block: ") && err.contains("another problem"), "{err}");
    std::fs::remove_file(dir.path().join("reference/data/block.json")).unwrap();
    let (code, _, err) = check();
    assert!(code == 1 && err.contains("block: there is no stored reference"), "{err}");
}

#[test]
fn values_can_be_shown_and_read_by_programs() {
    let dir = checkout();
    let show = [&["reference", "show", "block"][..], &FROM_DISK].concat();
    let (code, out, _) = mtled(dir.path(), &show);
    assert_eq!(code, 0);
    for text in ["displacement/top", "force/bottom", "strain_energy", "scikit-fem", "2.00"] {
        assert!(out.contains(text), "{text} in {out}");
    }
    let (code, out, _) = mtled(dir.path(), &[&show[..], &["--format", "json"]].concat());
    let value: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(code, 0);
    assert_eq!(value["cases"][0]["sound"], true);
    assert_eq!(value["cases"][0]["quantities"].as_array().unwrap().len(), 6);
    let (code, _, err) = mtled(dir.path(), &["reference", "show", "blok"]);
    assert!(code == 2 && err.contains("blok"), "{err}");
}

#[test]
fn solving_needs_a_checkout_and_known_names() {
    let dir = TempDir::new().unwrap();
    let (code, out, err) = mtled(dir.path(), &["reference", "solve"]);
    assert!(code == 2 && out.is_empty() && err.contains("--reference"), "{err}");
    let dir = checkout();
    let (code, _, err) = mtled(dir.path(), &["reference", "solve", "blok"]);
    assert!(code == 2 && err.contains("blok"), "{err}");
    let some = ["reference", "solve", "--mesh", "0", "--code", "scikit-fem"];
    let (code, _, err) = mtled(dir.path(), &some);
    assert!(code == 2 && err.contains("--compare"), "{err}");
}

/// A checkout whose Python is a shell script: it imports everything, and runs
/// `solve` and `merge` as `body` says, with the output file in `$out`.
#[cfg(unix)]
fn with_python(body: &str) -> TempDir {
    use std::os::unix::fs::PermissionsExt;
    let dir = checkout();
    let bin = dir.path().join("reference/.venv/bin");
    std::fs::create_dir_all(&bin).unwrap();
    let script = format!(
        "#!/bin/sh\n[ \"$1\" = -c ] && exit 0\nshift 2\ncommand=$1\n\
         while [ $# -gt 0 ]; do [ \"$1\" = --out ] && out=$2; shift; done\n{body}\n"
    );
    std::fs::write(bin.join("python"), script).unwrap();
    std::fs::set_permissions(bin.join("python"), std::fs::Permissions::from_mode(0o755)).unwrap();
    dir
}

#[cfg(unix)]
#[test]
fn a_coarse_mesh_is_solved_again_and_compared() {
    let dir = with_python(
        "echo '{\"progress\": 0.5, \"message\": \"half\"}'\ncp \"$(dirname \"$0\")/again.json\" \"$out\"",
    );
    let compare = || {
        let arguments = ["reference", "solve", "block", "--code", "scikit-fem", "--compare"];
        mtled(dir.path(), &arguments)
    };
    let again = dir.path().join("reference/.venv/bin/again.json");
    let mut file = synthetic(&block());
    file.solutions.remove(0);
    file.solutions[0].meshes.truncate(1);
    std::fs::write(&again, json(&file).to_string()).unwrap();
    let (code, out, err) = compare();
    assert!(code == 0 && out.contains("largest change 0.0e0"), "{out}{err}");
    let values = &mut file.solutions[0].meshes[0].values;
    let Some(Values::History(lists)) = values.get_mut("force/bottom") else { panic!() };
    lists[0][2] *= 1.001;
    std::fs::write(&again, json(&file).to_string()).unwrap();
    let (code, _, err) = compare();
    assert_eq!(code, 1);
    assert!(err.starts_with("block with scikit-fem") && err.contains("force/bottom"), "{err}");
}

#[cfg(unix)]
#[test]
fn what_python_says_when_it_fails_is_passed_on() {
    let dir = with_python("echo 'Newton did not converge' >&2; exit 2");
    let arguments = ["reference", "solve", "block", "--code", "scikit-fem"];
    let (code, _, err) = mtled(dir.path(), &arguments);
    assert_eq!(code, 2);
    assert!(err.contains("block with scikit-fem") && err.contains("did not converge"), "{err}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_python_and_its_children() {
    // A child of the script writes a beat as long as it lives.
    let dir = with_python(
        "beat=\"$(dirname \"$0\")/beat\"\n(while :; do echo x >> \"$beat\"; sleep 0.02; done) &\nwait",
    );
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_mtled"))
        .current_dir(dir.path())
        .args(["reference", "solve", "block", "--code", "scikit-fem", "--quiet"])
        .spawn()
        .unwrap();
    let beats =
        || std::fs::read(dir.path().join("reference/.venv/bin/beat")).map_or(0, |b| b.len());
    let start = Instant::now();
    while beats() < 4 {
        assert!(start.elapsed() < Duration::from_secs(30), "Python was not started");
        std::thread::sleep(Duration::from_millis(20));
    }
    let id = child.id().to_string();
    let killed = std::process::Command::new("kill").args(["-INT", &id]).status().unwrap();
    assert!(killed.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    std::thread::sleep(Duration::from_millis(200));
    let before = beats();
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(beats(), before, "a child of Python lives on");
}
