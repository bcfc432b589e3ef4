//! Studies with stored runs: killed, split, merged.

use crate::common::program::{mtled, program};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

const STUDY: [&str; 10] = [
    "study",
    "convergence",
    "uniaxial_bar",
    "--spacing",
    "x1.6,x1.4,x1.2,x1",
    "--clouds",
    "3",
    "--threads",
    "2",
    "--quiet",
];

fn study(folder: &Path, store: &str, out: &str, more: &[&str]) -> Command {
    let arguments = [&STUDY[..], &["--store", store, "--out", out], more].concat();
    let mut command = program(folder, &arguments);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// A report without timings and other parts that may differ from one time to the next.
fn reproducible(folder: &Path, out: &str) -> Value {
    let text = std::fs::read_to_string(folder.join(out).join("results.json")).unwrap();
    let mut report: Value = serde_json::from_str(&text).unwrap();
    report["provenance"] = Value::Null;
    report["wall_seconds"] = Value::Null;
    for study in report["studies"].as_array_mut().unwrap() {
        study["wall_seconds"] = Value::Null;
        study["command"] = Value::Null;
        let tables = study["tables"].as_array_mut().unwrap();
        tables.retain(|table| !table["title"].as_str().unwrap().ends_with("timings"));
    }
    report
}

/// Records with their timings.
fn listed(folder: &Path, store: &str) -> Vec<Value> {
    let (_, out, _) = mtled(folder, &["runs", "list", "--format", "json", "--store", store]);
    serde_json::from_str(&out).unwrap()
}

/// Records without their timings.
fn records(folder: &Path, store: &str) -> Vec<Value> {
    let mut all = listed(folder, store);
    all.iter_mut().for_each(|record| record["timings"] = Value::Null);
    all
}

/// Runs a study to its end; that it may be inconclusive does not matter here.
fn ends(mut study: Command) {
    assert!(matches!(study.status().unwrap().code(), Some(0 | 3)));
}

#[test]
fn a_study_that_was_killed_ten_times_gives_the_results_of_an_undisturbed_one() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ends(study(folder, "calm", "calm_report", &[]));
    for n in 0..10 {
        let mut child = study(folder, "killed", "killed_report", &[]).spawn().unwrap();
        // From the very beginning to where some runs are done.
        std::thread::sleep(Duration::from_millis(7 + 23 * n));
        child.kill().unwrap();
        child.wait().unwrap();
        // Whatever is there can be read: whole records or none.
        records(folder, "killed");
    }
    ends(study(folder, "killed", "killed_report", &[]));
    assert_eq!(records(folder, "killed"), records(folder, "calm"));
    assert_eq!(reproducible(folder, "killed_report"), reproducible(folder, "calm_report"));
}

#[test]
fn four_merged_parts_are_the_whole_study_and_no_run_is_repeated() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    ends(study(folder, "whole", "whole_report", &[]));
    let mut merge = program(folder, &["merge", "--into", "merged"]);
    for part in 1..=4 {
        let store = format!("part{part}");
        let shard = ["--shard", &format!("{part}/4")];
        assert!(study(folder, &store, "no_report", &shard).status().unwrap().success());
        merge.arg(&store);
    }
    assert!(!folder.join("no_report").exists());
    assert!(merge.stdout(Stdio::null()).status().unwrap().success());
    assert_eq!(records(folder, "merged"), records(folder, "whole"));
    let before = listed(folder, "merged");
    ends(study(folder, "merged", "merged_report", &[]));
    assert_eq!(listed(folder, "merged"), before);
    assert_eq!(reproducible(folder, "merged_report"), reproducible(folder, "whole_report"));
}

#[test]
fn records_of_other_versions_and_temporary_files_are_pruned() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (text, file) = store_of_one(folder, "runs");
    let record = &records(folder, "runs")[0];
    let solver = record["solver"].as_str().unwrap();
    std::fs::write(&file, sealed(&text.replace(solver, "0.0.0+other"))).unwrap();
    let (old, young) = (file.with_file_name(".abc.tmp"), file.with_file_name(".1-abc.tmp"));
    std::fs::write(&old, "half").unwrap();
    let days_ago = std::time::SystemTime::now() - Duration::from_secs(200_000);
    std::fs::OpenOptions::new().write(true).open(&old).unwrap().set_modified(days_ago).unwrap();
    std::fs::write(&young, "half").unwrap();
    let (_, output, _) = mtled(folder, &["runs", "prune", "--store", "runs"]);
    assert!(output.contains("1 records removed, 1 temporary files"), "{output}");
    assert!(records(folder, "runs").is_empty());
    assert!(young.exists() && !old.exists(), "somebody may be writing what is young");
}

/// The text of a record after a change, with the checksum of what it has now.
fn sealed(text: &str) -> String {
    use sha2::{Digest, Sha256};
    let (_, content) = text.trim_end().split_once("\",").unwrap();
    let digest = Sha256::digest(content.as_bytes());
    let sum: String = digest.iter().take(16).map(|byte| format!("{byte:02x}")).collect();
    format!("{{\"checksum\":\"{sum}\",{content}\n")
}

#[test]
fn a_changed_digit_and_a_record_without_a_checksum_are_named_and_not_used() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (text, file) = store_of_one(folder, "runs");
    let again = [&ONE[..], &["--store", "runs"]].concat();
    assert_eq!(mtled(folder, &again).0, 0);
    let at = text.find("\"figures\"").unwrap();
    let digit = at + text[at..].find(|c: char| c.is_ascii_digit()).unwrap();
    let other = if text[digit..].starts_with('1') { "2" } else { "1" };
    let mut changed = text.clone();
    changed.replace_range(digit..digit + 1, other);
    std::fs::write(&file, &changed).unwrap();
    let (code, _, err) = mtled(folder, &again);
    assert!(code == 2 && err.contains("checksum") && err.contains("prune --corrupt"), "{err}");
    let (_, content) = text.split_once("\",").unwrap();
    std::fs::write(&file, format!("{{{content}")).unwrap();
    let (code, _, err) = mtled(folder, &again);
    assert!(code == 2 && err.contains("has no checksum"), "{err}");
    let (code, out, _) = mtled(folder, &["runs", "prune", "--store", "runs"]);
    assert!(code == 0 && out.contains("1 records removed") && !file.exists(), "{out}");
}

/// Arguments of a study of one short run.
const ONE: [&str; 8] = [
    "study",
    "consistency",
    "cube_compression",
    "--quiet",
    "--dilation",
    "1.8",
    "--cells-per-spacing",
    "1.26",
];

/// A store with one record, the text of the record and its file.
fn store_of_one(folder: &Path, store: &str) -> (String, std::path::PathBuf) {
    assert_eq!(mtled(folder, &[&ONE[..], &["--store", store]].concat()).0, 0);
    let key = records(folder, store)[0]["key"].as_str().unwrap().to_string();
    let file = folder.join(store).join(&key[..2]).join(format!("{key}.json"));
    (std::fs::read_to_string(&file).unwrap(), file)
}

#[test]
fn records_that_are_not_what_their_names_say_are_named_and_lead_nowhere() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (text, good) = store_of_one(folder, "runs");
    let key = good.file_stem().unwrap().to_str().unwrap();
    let solver = "0.0.0+other";
    let this =
        serde_json::from_str::<Value>(&text).unwrap()["solver"].as_str().unwrap().to_string();
    let with_key = |other: &str| text.replace(key, other).replace(&this, solver);
    std::fs::write(folder.join("outside.json"), "mine").unwrap();
    let bad = folder.join("runs/ff");
    std::fs::create_dir_all(&bad).unwrap();
    let contents =
        [with_key("../../outside"), with_key("ééééééééé"), text[..text.len() / 2].into()];
    for (n, content) in contents.iter().enumerate() {
        std::fs::write(bad.join(format!("ff{n:030}.json")), content).unwrap();
    }
    std::fs::write(bad.join("notes.json"), "mine").unwrap();
    let check = |(code, out, err): (i32, String, String), bad: usize| {
        assert_eq!((code, err.lines().count()), (2, bad), "{out}{err}");
        assert!(err.lines().all(|line| line.contains("is not a record of a run")), "{err}");
        out
    };
    let list = ["runs", "list", "--store", "runs"];
    let out = check(mtled(folder, &list), 4);
    assert!(out.contains(&key[..12]) && out.contains("1 records in runs"), "{out}");
    let out = check(mtled(folder, &["merge", "runs", "--into", "into/deep"]), 4);
    assert!(out.starts_with("1 records added"), "{out}");
    check(mtled(folder, &["runs", "prune", "--store", "runs"]), 4);
    check(mtled(folder, &["runs", "prune", "--corrupt", "--store", "runs"]), 1);
    assert!(good.exists() && bad.join("notes.json").exists());
    check(mtled(folder, &["runs", "prune", "--all", "--store", "runs"]), 1);
    assert!(!good.exists() && bad.join("notes.json").exists());
    assert_eq!(std::fs::read_to_string(folder.join("outside.json")).unwrap(), "mine");
    assert_eq!(std::fs::read_dir(folder.join("into")).unwrap().count(), 1);
}

#[test]
fn a_range_that_cannot_be_read_and_a_case_that_is_not_there_end_with_code_2() {
    for (arguments, words) in [
        (vec!["study", "patch", "cube_compression", "--dilation", "1.4..2"], "1.4..2.6:0.2"),
        (
            vec!["study", "patch", "no_such_case"],
            "no_such_case cannot be read: there is no such file",
        ),
        (vec!["tune", "no_such_case"], "no_such_case cannot be read: there is no such file"),
        (vec!["study", "patch", "--plan", "plan.toml"], "plan.toml: no case is named"),
        (vec!["tune", "cube_compression", "--target-error", "2"], "not a fraction"),
        (vec!["budget", "cube_compression", "--reference", "no_file.json"], "no_file.json"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("plan.toml"), "cases = []\n").unwrap();
        let (code, _, err) = mtled(&folder, &arguments);
        assert!(code == 2 && err.contains(words), "{arguments:?}: {err}");
    }
}

#[test]
fn an_exported_table_has_every_number_of_the_records_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let arguments = ["convergence", "uniaxial_bar", "--spacing", "x2,x1.6", "--clouds", "1"];
    let files = ["--store", "runs", "--out", "report", "--quiet"];
    // One cloud shows no order, which is inconclusive.
    assert_eq!(mtled(folder, &[&["study"], &arguments[..], &files[..]].concat()).0, 3);
    let (code, table, _) = mtled(folder, &["runs", "export", "--store", "runs"]);
    assert_eq!(code, 0);
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let names = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let cell = |row: &csv::StringRecord, name: &str| {
        row[names.iter().position(|n| n == name).unwrap()].to_string()
    };
    for record in listed(folder, "runs") {
        let done = &record["outcome"]["done"];
        let own: Vec<_> = rows.iter().filter(|row| cell(row, "key") == record["key"]).collect();
        for (quantity, values) in
            done["quantities"].as_array().unwrap().iter().zip(done["values"].as_array().unwrap())
        {
            let name = quantity["name"].as_str().unwrap();
            let given: Vec<f64> = (own.iter().filter(|row| cell(row, "quantity") == name))
                .map(|row| cell(row, "value").parse().unwrap())
                .collect();
            let stored: Vec<f64> =
                values.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
            assert_eq!(given, stored, "{name}");
        }
        let nodes = done["figures"]["nodes"].as_f64().unwrap();
        assert!(own.iter().all(|row| cell(row, "nodes") == nodes.to_string()));
        let reaction = own.iter().find(|row| cell(row, "quantity") == "force/left").unwrap();
        assert_eq!((cell(reaction, "unit"), cell(reaction, "component")), ("N".into(), "x".into()));
    }
}

#[test]
fn list_and_export_take_the_same_filters_and_say_what_does_not_fit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    store_of_one(folder, "runs");
    let filtered = |command: &str, more: &[&str]| {
        mtled(folder, &[&["runs", command, "--store", "runs"], more].concat())
    };
    for fitting in [
        &["--case", "cube_compression.toml", "--run", "consistency"][..],
        &["--where", "dilation=1.4..2.2:0.2", "--where", "cells-per-spacing=1.26"],
        &["--since", "2000-01-01"],
    ] {
        let (code, out, err) = filtered("list", fitting);
        assert!(code == 0 && out.ends_with("1 records in runs\n") && err.is_empty(), "{out}{err}");
        let (code, out, err) = filtered("export", fitting);
        assert!(code == 0 && out.lines().count() > 5 && err.is_empty(), "{out}{err}");
    }
    for other in [["--case", "cube"], ["--where", "dilation=1.6"], ["--since", "2999-01-01"]] {
        for command in ["list", "export"] {
            let (code, _, err) = filtered(command, &other);
            assert!(code == 0 && err.contains("none of 1 records in runs fits"), "{err}");
        }
    }
    for (wrong, message) in [
        (&["--where", "dilatoin=1.6"][..], "did you mean `dilation`?"),
        (&["--since", "yesterday"], "is not a day such as 2026-01-31"),
        (&["-o", "runs.parquet"], "name a file that ends in .csv"),
    ] {
        let (code, _, err) = filtered("export", wrong);
        assert!(code == 2 && err.contains(message), "{wrong:?}: {err}");
    }
}
