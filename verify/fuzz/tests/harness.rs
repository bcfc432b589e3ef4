//! The corpus has no findings left, valid inputs are accepted, and every kind of misbehaviour is
//! noticed.
#![cfg(unix)]

use mtled_fuzz::mutate::Input;
use mtled_fuzz::target::Target;
use mtled_fuzz::{corpus, finding::Kind, seeds};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Exit code and results of trying a corpus.
fn replay(folder: &Path, more: &[&str]) -> (i32, Value) {
    let scratch = tempfile::tempdir().unwrap();
    let out = scratch.path().join("results.json");
    let mut command = Command::new(env!("CARGO_BIN_EXE_mtled-fuzz"));
    command.args(["--seconds", "0", "--corpus"]).arg(folder).arg("--out").arg(&out).args(more);
    let output = command.output().unwrap();
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    eprintln!("{messages}");
    let text = std::fs::read_to_string(&out).unwrap_or_else(|error| panic!("{error}: {messages}"));
    (output.status.code().unwrap(), serde_json::from_str(&text).unwrap())
}

#[test]
fn nothing_that_was_found_before_is_found_again() {
    let (code, results) = replay(&seeds::folder().join("corpus"), &[]);
    assert_eq!(code, 0, "{:#}", results["findings"]);
}

#[test]
fn every_valid_input_is_accepted() {
    let folder = tempfile::tempdir().unwrap();
    for target in Target::ALL {
        for input in seeds::inputs(target).unwrap() {
            corpus::save(folder.path(), target, Kind::Panic, &input).unwrap();
        }
    }
    let (code, results) = replay(folder.path(), &["--limit", "5"]);
    assert_eq!(code, 0, "{:#}", results["findings"]);
    for target in Target::ALL {
        let tally = &results["targets"][target.name()];
        let count = |outcome: &str| tally["outcomes"][outcome].as_u64().unwrap_or(0);
        let ended = count("succeeded") + count("doubtful");
        let accepted = ended + count("left_out") + count("stopped");
        assert!(
            accepted > 0 && Some(accepted) == tally["inputs"].as_u64(),
            "{target:?}: {tally:#}"
        );
        assert!(count("succeeded") > 0, "{target:?}: {tally:#}");
    }
}

#[test]
fn every_kind_of_misbehaviour_is_a_finding() {
    let traps = [
        ("panic", "panic"),
        ("abort", "signal"),
        ("hang", "hang"),
        ("memory", "memory"),
        ("stack-overflow", "stack-overflow"),
        ("unlocated", "unlocated"),
        ("outside", "outside"),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (text, _) in traps {
        corpus::save(folder.path(), Target::Trap, Kind::Panic, &Input::new(text, "txt")).unwrap();
    }
    let (code, results) = replay(folder.path(), &["--only", "trap", "--limit", "0.5"]);
    assert_eq!(code, 1);
    let mut found: Vec<&str> = results["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["kind"].as_str().unwrap())
        .collect();
    let mut expected = traps.map(|(_, kind)| kind).to_vec();
    found.sort();
    expected.sort();
    assert_eq!(found, expected);
}
