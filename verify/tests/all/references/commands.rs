//! `mtled reference` from the outside, with a made-up reference and a made-up Python.

use crate::common::program::{interrupt, mtled, program};
use crate::common::{BLOCK, block, json, synthetic};
use mtled_case::reference::Values;
use serde_json::Value;
use std::time::{Duration, Instant};
use tempfile::TempDir;

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

const FROM_DISK: [&str; 4] = ["--cases", "reference/cases", "--data", "reference/data"];

#[test]
fn a_changed_digit_makes_the_check_fail_and_names_the_case() {
    let dir = checkout();
    let check = || mtled(&dir, &[&["reference", "check"][..], &FROM_DISK].concat());
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
    let (code, out, _) = mtled(&dir, &show);
    assert_eq!(code, 0);
    for text in ["displacement/top", "force/bottom", "strain_energy", "scikit-fem", "2.00"] {
        assert!(out.contains(text), "{text} in {out}");
    }
    let (code, out, _) = mtled(&dir, &[&show[..], &["--format", "json"]].concat());
    let value: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(code, 0);
    assert_eq!(value["cases"][0]["sound"], true);
    assert_eq!(value["cases"][0]["quantities"].as_array().unwrap().len(), 6);
    let (code, _, err) = mtled(&dir, &["reference", "show", "blok"]);
    assert!(code == 2 && err.contains("blok"), "{err}");
}

#[test]
fn solving_needs_a_checkout_and_known_names() {
    let dir = TempDir::new().unwrap();
    let (code, out, err) = mtled(&dir, &["reference", "solve"]);
    assert!(code == 2 && out.is_empty() && err.contains("--reference"), "{err}");
    let dir = checkout();
    let (code, _, err) = mtled(&dir, &["reference", "solve", "blok"]);
    assert!(code == 2 && err.contains("blok"), "{err}");
    let some = ["reference", "solve", "--mesh", "0", "--code", "scikit-fem"];
    let (code, _, err) = mtled(&dir, &some);
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
        mtled(&dir, &arguments)
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
fn the_message_of_a_python_that_fails_is_passed_on() {
    let dir = with_python("echo 'Newton did not converge' >&2; exit 2");
    let arguments = ["reference", "solve", "block", "--code", "scikit-fem"];
    let (code, _, err) = mtled(&dir, &arguments);
    assert_eq!(code, 2);
    assert!(err.contains("block with scikit-fem") && err.contains("did not converge"), "{err}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_python_and_its_children() {
    // A child of the script writes to a file as long as it runs.
    let dir = with_python(
        "beat=\"$(dirname \"$0\")/beat\"\n(while :; do echo x >> \"$beat\"; sleep 0.02; done) &\nwait",
    );
    let solve = ["reference", "solve", "block", "--code", "scikit-fem", "--quiet"];
    let mut child = program(&dir, &solve).spawn().unwrap();
    let beats =
        || std::fs::read(dir.path().join("reference/.venv/bin/beat")).map_or(0, |b| b.len());
    let start = Instant::now();
    while beats() < 4 {
        assert!(start.elapsed() < Duration::from_secs(30), "Python was not started");
        std::thread::sleep(Duration::from_millis(20));
    }
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    std::thread::sleep(Duration::from_millis(200));
    let before = beats();
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(beats(), before, "a child of Python still runs");
}
