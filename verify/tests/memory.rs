//! Memory as users meet it: estimated before a run, and refused where there is
//! too little.

use assert_cmd::Command;
use serde_json::Value;
use std::time::Duration;
use tempfile::TempDir;

/// A block with a fixed and a free face; its spacing is a placeholder.
const CASE: &str = concat!(
    "\n",
    include_str!("common/pulled_block.toml"),
    "[time]\nmethod = \"dynamic\"\nend = 1e-4\n"
);
const SPACING: &str = "spacing = 0.02";

fn solve(discretisation: &str) -> (i32, String, String) {
    assert!(CASE.contains(SPACING), "the spacing of the block has changed");
    let dir = TempDir::new().unwrap();
    let case = dir.path().join("case.toml");
    std::fs::write(&case, CASE.replace(SPACING, discretisation)).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_mtled"));
    command.args(["solve", "--format", "json", "--quiet", "--out"]).arg(dir.path().join("out"));
    let output = command.arg(&case).timeout(Duration::from_secs(120)).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_body_larger_than_the_memory_is_refused_at_its_discretisation() {
    let (code, _, err) = solve("spacing = 1e-5");
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("discretisation: about ") && err.contains("are available"), "{err}");
    assert!(err.contains("use a larger spacing"), "{err}");
}

/// Neither a refusal where there is enough memory nor a crash where there is not.
#[test]
fn the_memory_of_a_run_is_estimated_at_0_9_to_1_25_of_what_it_takes() {
    for discretisation in [
        "spacing = 0.01",
        "spacing = 0.005",
        "spacing = 0.004",
        "spacing = 0.005\ngrid = { cells_per_spacing = 1.8 }",
        "spacing = 0.007\ndilation = 2.6",
        "spacing = 0.0035\ngradient_storage = \"single\"",
    ] {
        let (code, result, err) = solve(discretisation);
        assert_eq!(code, 0, "{err}");
        let result: Value = serde_json::from_str(&result).unwrap();
        // The peak is not known on every system.
        let Some(peak) = result["timings"]["peak_memory_bytes"].as_f64() else { return };
        let estimate = result["timings"]["estimated_memory_bytes"].as_f64().unwrap();
        let ratio = estimate / peak;
        let err = format!("{discretisation}: {estimate} bytes estimated, {peak} used");
        assert!((0.9..1.25).contains(&ratio), "{err}");
    }
}

#[test]
fn gradients_asked_for_in_single_precision_are_read_as_such() {
    let streamed = |storage: &str| {
        let (code, result, err) =
            solve(&format!("spacing = 0.02\ngradient_storage = \"{storage}\""));
        assert_eq!(code, 0, "{err}");
        let work = &serde_json::from_str::<Value>(&result).unwrap()["work_counters"];
        let each = |name: &str| work[name].as_f64().unwrap();
        each("bytes_streamed") / each("force_evaluations")
    };
    assert_eq!(16.0 * streamed("double"), 28.0 * streamed("single"));
}
