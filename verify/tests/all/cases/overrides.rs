//! `--set KEY=VALUE`: what it changes, where its mistakes are shown, what results say of it.

use crate::common::program::mtled;
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

const CASE: &str = concat!(
    "\n",
    include_str!("../common/pulled_block.toml"),
    r#"
[[prescribe]]
name = "top"
of = "surface"
where = { plane = { point = [0.0, 0.0, 0.1], normal = [0.0, 0.0, 1.0] } }
displacement = { x = 0.0, y = 0.0, z = 0.02 }

[time]
method = "static"
load_end = 1.0

[output]
frames = 0
history = 2
"#
);
const SOFTER: [&str; 4] =
    ["--set", "material.tissue.young_modulus=1500.0", "--set", "prescribe.top.displacement.z=0.01"];

/// A folder with the case in it.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("case.toml"), CASE).unwrap();
    folder
}

fn solve(folder: &Path, case: &str, out: &str, more: &[&str]) -> Value {
    let arguments = [&["solve", case, "--out", out, "--no-error-bar", "-q"], more].concat();
    let (code, _, err) = mtled(folder, &arguments);
    assert_eq!(code, 0, "{err}");
    let text = std::fs::read_to_string(folder.join(out).join("result.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn a_run_with_overrides_is_that_of_a_file_with_these_values_and_says_so() {
    let folder = folder();
    let edited = CASE.replace("young_modulus = 3000.0", "young_modulus = 1500.0");
    let edited = edited.replace("z = 0.02", "z = 0.01");
    assert_ne!(edited, CASE);
    std::fs::create_dir(folder.path().join("edited")).unwrap();
    std::fs::write(folder.path().join("edited/case.toml"), edited).unwrap();
    let mut expected = solve(folder.path(), "edited/case.toml", "one", &[]);
    let mut result = solve(folder.path(), "case.toml", "two", &SOFTER);
    let plain = solve(folder.path(), "case.toml", "three", &[]);
    assert_ne!(plain["case"]["hash"], result["case"]["hash"]);
    assert_eq!(plain["case"]["overrides"], Value::Array(Vec::new()));
    let overrides = [SOFTER[1], SOFTER[3]].map(Value::from);
    assert_eq!(result["case"]["overrides"].as_array().unwrap(), &overrides);
    for result in [&mut expected, &mut result] {
        result["case"]["overrides"] = Value::Null;
        result["timings"] = Value::Null;
    }
    assert_eq!(result, expected);
}

#[test]
fn the_field_of_a_run_with_overrides_is_used_with_them_and_refused_where_the_file_has_changed() {
    let folder = folder();
    solve(folder.path(), "case.toml", "run", &SOFTER);
    std::fs::write(folder.path().join("marks.csv"), "name,x,y,z\ntop,50,50,90\n").unwrap();
    let warp = ["warp", "run", "--points", "marks.csv", "--unit", "mm", "--format", "json"];
    let (code, out, err) = mtled(&folder, &warp);
    assert_eq!(code, 0, "{err}");
    let summary: Value = serde_json::from_str(&out).unwrap();
    let moved = summary["landmarks"][0]["moved_mm"][2].as_f64().unwrap() - 90.0;
    assert!((moved - 9.0).abs() < 0.5, "{moved}");
    let other = CASE.replace("density = 1000.0", "density = 1001.0");
    assert_ne!(other, CASE);
    std::fs::write(folder.path().join("case.toml"), other).unwrap();
    let (code, _, err) = mtled(&folder, &warp);
    assert!(code == 2 && err.contains("was changed since"), "{err}");
}

#[test]
fn a_mistake_in_an_override_is_shown_on_the_command_line() {
    let folder = folder();
    for (given, shown) in [
        (
            "discretisation.spacng=0.01",
            "7: discretisation.spacng: is not a key that is known here; did you mean `spacing`?",
        ),
        ("discretisation.spacing=-1", "30: discretisation.spacing: is -1; it must be positive"),
        (
            "discretisation.spacing=fine",
            "30: discretisation.spacing: invalid type: string \"fine\"",
        ),
        (
            "discretisation.spacing=nan",
            "30: discretisation.spacing: is NaN; it must be a finite number",
        ),
        (
            "discretisation.basis=quadratc",
            "28: discretisation.basis: `quadratc` is not a choice that is known here; did you mean `quadratic`?",
        ),
        ("prescribe.tpo.release=1", "7: prescribe: has no entry `tpo`; did you mean `top`?"),
        ("prescribe.top.release=-1", "29: prescribe[1].release: is -1; it must be positive"),
        (
            "sovler.method=newton",
            "7: sovler: is not a key that is known here; expected one of title",
        ),
        (
            "material.skin.density=1000",
            "7: material.skin: is not a table of this case, which has tissue",
        ),
        (
            "prescribe.top.displacement={ z = 0.1, w = 1 }",
            "34: prescribe[1].displacement.w: is not a key",
        ),
    ] {
        for command in [
            &["case", "check"][..],
            &["solve"],
            &["inspect"],
            &["budget"],
            &["study", "patch"],
            &["tune"],
        ] {
            let set = ["case.toml", "--set", "title=x", "--set", given];
            let (code, _, err) = mtled(&folder, &[command, &set].concat());
            assert_eq!(code, 2, "{command:?} {given}: {err}");
            assert!(err.contains(&format!("command line:2:{shown}")), "{command:?} {given}: {err}");
            assert!(err.contains(&format!("\n2 | --set {given}\n")), "{command:?} {given}: {err}");
        }
    }
    let (code, _, err) = mtled(&folder, &["solve", "case.toml", "--set", "spacing"]);
    assert!(code == 2 && err.contains("`spacing` is not a key with its value"), "{err}");
    let (_, _, err) = mtled(
        &folder,
        &["solve", "case.toml", "--set", "discretisation.spacing=9", "--format", "json"],
    );
    let message: Value = serde_json::from_str(err.lines().next().unwrap()).unwrap();
    assert_eq!(
        (message["file"].as_str(), message["line"].as_u64()),
        (Some("command line"), Some(1))
    );
}

#[test]
fn other_mistakes_stay_where_they_are_in_the_file_although_overrides_add_lines() {
    let folder = folder();
    let wrong = CASE.replace("poisson_ratio", "poison_ratio");
    let line = wrong.lines().position(|line| line.contains("poison_ratio")).unwrap() + 1;
    std::fs::write(folder.path().join("case.toml"), &wrong).unwrap();
    let set = ["--set", "material.tissue.volumetric=x", "--set", "discretisation.dilation=1.9"];
    let (code, _, err) = mtled(&folder, &[&["case", "check", "case.toml"], &set[2..]].concat());
    assert!(code == 2 && err.contains(&format!("case.toml:{line}:1: ")), "{err}");
    let (code, _, err) = mtled(&folder, &[&["case", "check", "case.toml"], &set[..]].concat());
    assert_eq!(code, 2, "{err}");
    let empty = CASE.replace("name = \"top\"\n", "name = \"top\"\nrelease = -2\n");
    let line = empty.lines().position(|line| line == "release = -2").unwrap() + 1;
    std::fs::write(folder.path().join("case.toml"), &empty).unwrap();
    let before =
        ["case", "check", "case.toml", "--set", "title=x", "--set", "material.tissue.density=5"];
    let (_, _, err) = mtled(&folder, &before);
    assert!(err.contains(&format!("case.toml:{line}:11: prescribe[1].release")), "{err}");
}

#[test]
fn records_of_runs_with_overrides_name_them_and_are_runs_of_their_own() {
    let folder = folder();
    let study = |more: &[&str]| {
        let arguments = ["study", "consistency", "case.toml", "--dilation", "1.8", "--store", "s"];
        let (code, _, err) = mtled(&folder, &[&arguments[..], more].concat());
        assert_eq!(code, 0, "{err}");
    };
    let spacing = ["--set", "discretisation.spacing=0.025"];
    study(&[]);
    study(&spacing);
    study(&spacing);
    let (_, list, _) = mtled(&folder, &["runs", "list", "--store", "s"]);
    assert!(list.contains("2 records"), "{list}");
    assert!(list.contains("discretisation.spacing=0.025, dilation 1.8"), "{list}");
    let filter = ["runs", "export", "--store", "s", "--where", "discretisation.spacing=0.0250"];
    let (_, table, _) = mtled(&folder, &filter);
    let mut lines = table.lines().skip(1).peekable();
    assert!(lines.peek().is_some());
    assert!(lines.all(|line| line.contains(",discretisation.spacing=0.025,done,")), "{table}");
}
