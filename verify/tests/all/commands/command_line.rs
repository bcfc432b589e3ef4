//! The program from the outside: exit codes, output streams and files.

use crate::common::program::{interrupt, mtled, program};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A block that is pulled: a few hundred points, a fraction of a second.
const CASE: &str = concat!(
    "\n",
    include_str!("../common/pulled_block.toml"),
    r#"[time]
method = "dynamic"
end = 0.2

[[probe]]
name = "top"
point = [0.05, 0.05, 0.1]

[output]
frames = 3
history = 5
"#
);

/// A folder with `case.toml` in it, one part of the text replaced.
fn case_with(from: &str, to: &str) -> (TempDir, PathBuf) {
    assert!(from.is_empty() || CASE.contains(from), "{from} is not in the case");
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("case.toml");
    std::fs::write(&path, CASE.replacen(from, to, if from.is_empty() { 0 } else { 1 })).unwrap();
    (dir, path)
}

fn solve(case: &Path, out: &Path, more: &[&str]) -> (i32, String, String) {
    let mut arguments = vec!["solve", case.to_str().unwrap(), "--out", out.to_str().unwrap()];
    arguments.extend(more);
    mtled(".", &arguments)
}

fn result(out: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(out.join("result.json")).unwrap()).unwrap()
}

#[test]
fn help_and_version_are_data() {
    for arguments in [
        &["--version"][..],
        &["--help"],
        &["solve", "--help"],
        &["verify", "--help"],
        &["inspect", "--help"],
    ] {
        let (code, out, err) = mtled(".", arguments);
        assert_eq!((code, err.as_str()), (0, ""), "{arguments:?}");
        assert!(!out.is_empty(), "{arguments:?}");
    }
    assert_eq!(mtled(".", &["--version"]).1, format!("mtled {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn wrong_usage_ends_with_code_2_and_a_message_on_standard_error() {
    let wrong: [&[&str]; 10] = [
        &[],
        &["slove"],
        &["solve", "--nodes", "3"],
        &["solve", "no_such_case.toml"],
        &["case", "check", "no_such_case.toml"],
        &["case", "show", "no_such_case"],
        &["inspect"],
        &["inspect", "no_such_case.toml"],
        &["inspect", "no_such_case.toml", "--modes", "sometimes"],
        &["verify", "--only", "no_such_study"],
    ];
    for arguments in wrong {
        let (code, out, err) = mtled(".", arguments);
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}: {err}");
        assert!(!err.is_empty(), "{arguments:?}");
    }
    assert!(mtled(".", &["solve", "no_such_case.toml"]).2.contains("no_such_case.toml"));
    assert_eq!(mtled(".", &["--threads", "0", "case", "list"]).0, 2);
}

#[test]
fn the_schema_is_json_and_bundled_cases_can_be_shown_and_checked() {
    let schema: Value = serde_json::from_str(&mtled(".", &["case", "schema"]).1).unwrap();
    assert_eq!(schema["type"], "object");
    let (code, list, _) = mtled(".", &["case", "list"]);
    assert!(code == 0 && list.lines().any(|name| name == "cube_compression"), "{list}");
    let dir = TempDir::new().unwrap();
    let path = dir.path().join("shown.toml");
    std::fs::write(&path, mtled(".", &["case", "show", "cube_compression"]).1).unwrap();
    let (code, out, err) = mtled(".", &["case", "check", path.to_str().unwrap()]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.ends_with("no mistakes\n"), "{out}");
}

#[test]
fn a_run_writes_its_files_and_only_data_to_standard_output() {
    let (dir, case) = case_with("", "");
    let (code, out, err) = solve(&case, dir.path(), &["--format", "json"]);
    assert_eq!((code, err.as_str()), (0, ""));
    let printed: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(printed, result(dir.path()));
    assert_eq!(printed["schema_version"], 1);
    assert_eq!(printed["motion"]["complete"], true);
    let history = std::fs::read_to_string(dir.path().join("history.csv")).unwrap();
    assert!(history.starts_with("step,time_s,"), "{history}");
    assert!(history.lines().count() >= 5, "{history}");
    let files = [
        "nodes_0000.vtu",
        "nodes_0002.vtu",
        "body_0002.vtu",
        "case.pvd",
        "case_nodes.pvd",
        "index.html",
    ];
    for name in files {
        assert!(dir.path().join(name).exists(), "{name} is missing");
    }
    let (code, out, err) = solve(&case, dir.path(), &["--quiet"]);
    assert_eq!((code, out.as_str(), err.as_str()), (0, "", ""));
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    // Enough points for several blocks.
    let (dir, case) = case_with("spacing = 0.02", "spacing = 0.006");
    let results = ["1", "2", "4"].map(|threads| {
        let out = dir.path().join(threads);
        assert_eq!(solve(&case, &out, &["--threads", threads, "-q"]).0, 0);
        let mut result = result(&out);
        assert!(result.as_object_mut().unwrap().remove("timings").is_some());
        let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
        (serde_json::to_string(&result).unwrap(), history)
    });
    assert!(results[0] == results[1] && results[0] == results[2]);
}

#[test]
fn a_wrong_key_is_located() {
    let (dir, case) = case_with("density = 1000.0", "densty = 1000.0");
    for arguments in [&["solve"][..], &["case", "check"]] {
        let (code, out, err) = mtled(".", &[arguments, &[case.to_str().unwrap()]].concat());
        assert_eq!((code, out.as_str()), (2, ""));
        assert!(err.contains("case.toml:9") && err.contains("did you mean `density`?"), "{err}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1, "something was written");
}

#[test]
fn a_condition_that_selects_nothing_is_located() {
    let (dir, case) =
        case_with("plane = { point = [0.0, 0.0, 0.0]", "plane = { point = [0.0, 0.0, 0.5]");
    let line = 1 + CASE.lines().position(|line| line.starts_with("where")).unwrap();
    for arguments in [&["solve"][..], &["case", "check"]] {
        let (code, out, err) = mtled(&dir, &[arguments, &[case.to_str().unwrap()]].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.contains(&format!("case.toml:{line}")), "{err}");
        assert!(err.contains("prescribe[0].where") || err.contains("prescribe.bottom"), "{err}");
        assert!(
            err.contains("between (0.0000, 0.0000, 0.0000) and (0.1000, 0.1000, 0.1000) m"),
            "{err}"
        );
    }
}

#[test]
fn poor_supports_are_warned_about_on_standard_error_and_in_the_result() {
    let (dir, case) = case_with("spacing = 0.02", "spacing = 0.02\ndilation = 1.1");
    let (code, out, err) = solve(&case, dir.path(), &["--format", "json"]);
    let warning: Value = serde_json::from_str(&err).unwrap();
    assert_eq!((code, &warning["severity"]), (0, &"warning".into()), "{err}");
    assert!(warning["message"].as_str().unwrap().contains("enlarged"), "{err}");
    let warnings = serde_json::from_str::<Value>(&out).unwrap()["warnings"].clone();
    assert!(warnings[0].as_str().unwrap().contains("enlarged"), "{warnings}");
}

#[test]
fn a_recipe_with_zero_energy_modes_is_refused_before_the_first_step() {
    // Too few strains at all, and enough strains that miss some motions.
    for (cells, words) in [("0.8", "cannot resolve all motions"), ("1.0", "hardly any strain")] {
        let grid = format!("spacing = 0.02\ngrid = {{ cells_per_spacing = {cells} }}");
        let (dir, case) = case_with("spacing = 0.02", &grid);
        let (code, out, err) = solve(&case, dir.path(), &[]);
        assert_eq!((code, out.as_str()), (2, ""));
        assert!(err.contains("discretisation.grid") && err.contains("case.toml:"), "{err}");
        assert!(err.contains(words) && err.contains("1.26"), "{err}");
        assert_eq!(mtled(".", &["case", "check", case.to_str().unwrap()]).0, 2);
    }
}

fn inspected(from: &str, to: &str, more: &[&str]) -> Value {
    let (_dir, case) = case_with(from, to);
    let arguments = [&["inspect", case.to_str().unwrap(), "--format", "json"], more].concat();
    let (code, out, err) = mtled(".", &arguments);
    assert_eq!((code, err.as_str()), (0, ""), "{arguments:?}");
    serde_json::from_str(&out).unwrap()
}

#[test]
fn an_inspection_of_a_valid_case_reports_its_size_and_its_critical_step() {
    let seen = inspected("", "", &[]);
    assert_eq!(seen["zero_energy_modes"]["count"], 0);
    assert_eq!(seen["zero_energy_modes"]["free_rigid_motions"], 0);
    assert_eq!(seen["extent_m"], serde_json::json!([[0.0, 0.0, 0.0], [0.1, 0.1, 0.1]]));
    assert!(seen["points_per_node"].as_f64().unwrap() > 1.0, "{seen}");
    assert!(seen["critical_time_step_s"].as_f64() > seen["per_point_bound_s"].as_f64());
    assert_eq!(
        seen["advice"],
        serde_json::json!(["No reason against running this case was found."])
    );
    let (_dir, case) = case_with("", "");
    let (code, out, err) = mtled(".", &["inspect", case.to_str().unwrap()]);
    assert_eq!((code, err.as_str()), (0, ""));
    for words in ["points per node", "zero-energy modes   0", "critical step", "worst conditions"] {
        let found = out.contains(words) || words == "points per node" && out.contains("per node");
        assert!(found, "{words}: {out}");
    }
}

#[test]
fn an_inspection_counts_and_locates_zero_energy_modes() {
    let grid = "spacing = 0.02\ngrid = { cells_per_spacing = 1.0 }";
    let seen = inspected("spacing = 0.02", grid, &[]);
    let modes = &seen["zero_energy_modes"];
    assert!(modes["count"].as_u64().unwrap() > 0, "{seen}");
    assert!(modes["softest"][0]["share"].as_f64() < modes["threshold"].as_f64());
    assert_eq!(modes["softest"][0]["position_m"].as_array().unwrap().len(), 3);
    assert!(seen["advice"][0].as_str().unwrap().contains("1.26"), "{seen}");
    let unsearched = inspected("spacing = 0.02", grid, &["--modes", "never"]);
    assert_eq!(unsearched["zero_energy_modes"], Value::Null);
    assert!(unsearched["advice"][0].as_str().unwrap().contains("hourglassing"), "{unsearched}");
}

#[test]
fn the_case_in_the_readme_is_valid_and_its_message_is_that_of_the_program() {
    let readme = include_str!("../../../../README.md");
    let block = |opening: &str| {
        let (_, rest) = readme.split_once(opening).unwrap();
        rest.split_once("```").unwrap().0
    };
    let dir = TempDir::new().unwrap();
    let case = block("```toml\n");
    let check = |text: &str| {
        std::fs::write(dir.path().join("block.toml"), text).unwrap();
        let (code, _, err) = mtled(&dir, &["case", "check", "block.toml"]);
        (code, err)
    };
    assert_eq!(check(case), (0, String::new()));
    let (code, message) = check(&case.replace("density", "densty"));
    assert_eq!((code, message.trim_end()), (2, block("```text\n").trim_end()));
}

#[test]
fn a_reader_that_ends_early_is_no_error() {
    let mut schema = program(".", &["case", "schema"]);
    let mut schema = schema.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(schema.stdout.take());
    let output = schema.wait_with_output().unwrap();
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(!err.contains("panicked"), "{err}");
}

#[test]
fn the_summary_counts_positions_of_a_lattice_that_lie_outside_the_body() {
    let lattice = "lattice = { min = [0.0, 0.0, 0.0], max = [0.1, 0.1, 0.3], counts = [2, 2, 4] }";
    let (dir, case) = case_with("point = [0.05, 0.05, 0.1]", lattice);
    let (code, summary, message) = solve(&case, &dir.path().join("out"), &["--no-error-bar"]);
    assert_eq!(code, 0, "{message}");
    assert!(summary.contains("lattice \"top\": 8 of 16 positions are recorded"), "{summary}");
    assert_eq!(result(&dir.path().join("out"))["probes"][0]["left_out"], 8);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_complete_files() {
    let (dir, _) = case_with("end = 0.2", "end = 1e6");
    let out = dir.path().join("out");
    let mut solve = program(&dir, &["solve", "case.toml", "--out", "out"]);
    let mut child = solve.stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    // The folder is created when the case has been read, before the first step.
    let start = Instant::now();
    while !out.exists() && start.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(700));
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let result = result(&out);
    assert_eq!(result["motion"]["complete"], false);
    assert!(result["motion"]["steps"].as_u64().unwrap() > 0);
    let history = std::fs::read_to_string(out.join("history.csv")).unwrap();
    assert!(history.ends_with('\n') && history.lines().count() >= 2, "{history}");
    let columns = |line: &str| line.split(',').count();
    assert!(history.lines().all(|line| columns(line) == columns(history.lines().next().unwrap())));
    assert!(out.join("nodes_0000.vtu").exists() && out.join("case.pvd").exists());
}

#[test]
fn points_of_a_file_are_probes_as_if_each_were_written_out() {
    let one = "[[probe]]\nname = \"top\"\npoint = [0.05, 0.05, 0.1]\n";
    let file = "[[probe]]\nname = \"marks\"\npoints = { file = \"marks.csv\" }\n";
    let (folder, path) = case_with(one, file);
    let marks = "name,x_mm,y_mm,z_mm\ntop,50,50,100\nside,0,50,50\n";
    std::fs::write(folder.path().join("marks.csv"), marks).unwrap();
    let (code, _, err) = solve(&path, &folder.path().join("marks"), &["--no-error-bar"]);
    assert_eq!(code, 0, "{err}");
    let (other, path) = case_with("", "");
    assert_eq!(solve(&path, &other.path().join("top"), &["--no-error-bar"]).0, 0);
    let (marks, top) = (result(&folder.path().join("marks")), result(&other.path().join("top")));
    let names = |result: &Value| -> Vec<String> {
        let probes = result["probes"].as_array().unwrap();
        probes.iter().map(|probe| probe["name"].as_str().unwrap().to_string()).collect()
    };
    assert_eq!(names(&marks), ["marks.top", "marks.side"]);
    for what in ["kind", "reference_m", "displacement_m"] {
        assert_eq!(marks["probes"][0][what], top["probes"][0][what]);
    }
}
