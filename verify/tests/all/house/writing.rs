//! What the program writes: streams that fail, folders that cannot be written, files of
//! earlier runs, texts that would steer a terminal or a spreadsheet, and JSON.

use crate::common::program::{mtled, program};
use serde_json::Value;
use std::fs::{File, OpenOptions};
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use tempfile::TempDir;

/// A block that is pulled: a few hundred points, a fraction of a second.
const BLOCK: &str = include_str!("../common/pulled_block.toml");
const DYNAMIC: &str = "[time]\nmethod = \"dynamic\"\nend = 0.2\n";
const STATIC: &str = "[time]\nmethod = \"static\"\n";
const PROBE: &str = "[[probe]]\nname = \"top\"\npoint = [0.05, 0.05, 0.1]\n";

/// A folder with `case.toml` in it.
fn folder_with(parts: &[&str]) -> (TempDir, PathBuf) {
    let dir = TempDir::new().unwrap();
    let path = dir.path().to_path_buf();
    std::fs::write(path.join("case.toml"), parts.concat()).unwrap();
    (dir, path)
}

/// Number of frames of the nodes; those of the body are as many.
fn frames(out: &Path) -> usize {
    let count = |kind: &str| {
        let names = std::fs::read_dir(out).unwrap().map(|entry| entry.unwrap().file_name());
        let numbered = |name: &str| name.ends_with(".vtu") && !name.contains("of_mine");
        let own = names.filter(|name| name.to_str().unwrap().starts_with(kind));
        own.filter(|name| numbered(name.to_str().unwrap())).count()
    };
    assert_eq!(count("nodes_"), count("body_"));
    count("nodes_")
}

#[cfg(target_os = "linux")]
fn with_streams(folder: &Path, arguments: &[&str], out: Stdio, err: Stdio) -> Output {
    program(folder, arguments).stdout(out).stderr(err).output().unwrap()
}

#[cfg(target_os = "linux")]
fn full() -> File {
    OpenOptions::new().write(true).open("/dev/full").unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn messages_that_nobody_can_read_lose_no_result() {
    let poor = BLOCK.replace("spacing = 0.02", "spacing = 0.02\ndilation = 1.1");
    let (_dir, folder) = folder_with(&[&poor, DYNAMIC]);
    let solve = ["solve", "case.toml", "--out", "out"];
    let output = with_streams(&folder, &solve, Stdio::piped(), full().into());
    assert_eq!(output.status.code(), Some(0));
    assert!(folder.join("out/result.json").exists() && !output.stdout.is_empty());
    let mistake = ["solve", "no_case.toml"];
    let output = with_streams(&folder, &mistake, Stdio::piped(), full().into());
    assert_eq!(output.status.code(), Some(2));
    let progress = ["verify", "--only", "set_up", "--out", "report"];
    let output = with_streams(&folder, &progress, Stdio::piped(), full().into());
    assert_eq!(output.status.code(), Some(0));
    assert!(folder.join("report/index.html").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn data_that_cannot_be_written_end_with_code_2_after_the_files() {
    let (_dir, folder) = folder_with(&[BLOCK, DYNAMIC]);
    for arguments in [&["solve", "case.toml", "--out", "out"][..], &["--help"], &["case", "list"]] {
        let output = with_streams(&folder, arguments, full().into(), Stdio::piped());
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {err}");
        assert!(err.contains("cannot write to standard output"), "{arguments:?}: {err}");
    }
    assert!(folder.join("out/result.json").exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_named_before_the_run() {
    let (_dir, folder) = folder_with(&[BLOCK, DYNAMIC, PROBE]);
    std::fs::write(folder.join("file"), "").unwrap();
    let commands: [&[&str]; 7] = [
        &["solve", "case.toml"],
        &["verify", "--only", "manufactured"],
        &["budget", "case.toml"],
        &["tune", "case.toml"],
        &["tune", "case.toml", "uniaxial_bar"],
        &["study", "convergence", "case.toml"],
        &["contest", "race", "bonded_block"],
    ];
    for command in commands {
        let (code, out, err) = mtled(&folder, &[command, &["--out", "file/inside"]].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{command:?}: {err}");
        assert!(err.contains("cannot write into the folder file/inside"), "{command:?}: {err}");
        let (_, out, _) = mtled(&folder, &["runs", "list", "--format", "json"]);
        assert_eq!(out, "[]\n", "{command:?}");
    }
    let update = ["verify", "--only", "manufactured", "--update-baseline", "--reason", "a test"];
    let (code, _, err) = mtled(&folder, &[&update[..], &["--baseline", "file/base.json"]].concat());
    assert!(code == 2 && err.contains("file"), "{err}");
    assert!(!folder.join("reports/verify").exists());
}

#[test]
fn the_frames_of_a_longer_run_before_are_taken_away() {
    let (_dir, folder) = folder_with(&[BLOCK, DYNAMIC, "[output]\nframes = 5\n"]);
    assert_eq!(mtled(&folder, &["solve", "case.toml", "--out", "out"]).0, 0);
    assert_eq!(frames(&folder.join("out")), 6);
    let shorter = [BLOCK, DYNAMIC, "[output]\nframes = 2\n"].concat();
    std::fs::write(folder.join("other.toml"), shorter).unwrap();
    std::fs::write(folder.join("out/nodes_of_mine.vtu"), "").unwrap();
    assert_eq!(mtled(&folder, &["solve", "other.toml", "--out", "out"]).0, 0);
    assert_eq!(frames(&folder.join("out")), 3);
    assert!(folder.join("out/nodes_of_mine.vtu").exists());
    assert!(folder.join("out/other.pvd").exists() && !folder.join("out/case.pvd").exists());
}

#[test]
fn files_that_cannot_be_completed_have_no_index() {
    let (_dir, folder) = folder_with(&[BLOCK, DYNAMIC]);
    let solve = ["solve", "case.toml", "--out", "out"];
    assert_eq!(mtled(&folder, &solve).0, 0);
    // Stands in for a program that is killed while it writes.
    std::fs::remove_file(folder.join("out/history.csv")).unwrap();
    std::fs::create_dir(folder.join("out/history.csv")).unwrap();
    let (code, _, err) = mtled(&folder, &solve);
    assert!(code == 2 && err.contains("history.csv"), "{err}");
    for name in ["case.pvd", "case_nodes.pvd", "index.html", "result.json"] {
        assert!(!folder.join("out").join(name).exists(), "{name} is there");
    }
}

#[test]
fn frames_and_samples_are_taken_exactly_at_the_times_of_a_case() {
    let outputs = "[output]\ntimes = [0.0123, 0.1, 0.1001]\nhistory = 4\n";
    let (_dir, folder) = folder_with(&[BLOCK, DYNAMIC, outputs, PROBE]);
    assert_eq!(mtled(&folder, &["solve", "case.toml", "--out", "out"]).0, 0);
    let collection = std::fs::read_to_string(folder.join("out/case.pvd")).unwrap();
    let framed: Vec<f64> = (collection.split("timestep=\"").skip(1))
        .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
        .collect();
    let history = std::fs::read_to_string(folder.join("out/history.csv")).unwrap();
    let rows = history.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    let sampled: Vec<f64> =
        rows.map(|row| row.split(',').nth(1).unwrap().parse().unwrap()).collect();
    let all_near = |found: &[f64], expected: &[f64]| {
        found.len() == expected.len()
            && found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-12)
    };
    assert!(all_near(&framed, &[0.0, 0.0123, 0.1, 0.1001, 0.2]), "{framed:?}");
    // Besides these the histories have their equal parts, some of them a step late.
    let at = |time: f64| sampled.iter().any(|sample| (sample - time).abs() <= 1e-12);
    assert!([0.0, 0.0123, 0.1, 0.1001, 0.2].into_iter().all(at), "{sampled:?}");
    assert!(sampled.len() >= 7, "{sampled:?}");
}

#[test]
fn the_frames_of_a_static_run_are_numbered_and_at_most_as_many_as_requested() {
    let (_dir, folder) = folder_with(&[BLOCK, STATIC]);
    assert_eq!(mtled(&folder, &["solve", "case.toml", "--out", "out"]).0, 0);
    let text = std::fs::read_to_string(folder.join("out/case.pvd")).unwrap();
    let steps: Vec<&str> = text.split("timestep=\"").skip(1).collect();
    let numbers = steps.iter().map(|part| part.split('"').next().unwrap().parse::<usize>());
    let count = frames(&folder.join("out"));
    assert!((2..=21).contains(&count), "{count}");
    assert!(numbers.map(Result::unwrap).eq(0..count), "{text}");
    assert!(text.contains("timestep: number of the frame"), "{text}");
    let frame = std::fs::read(folder.join("out/nodes_0001.vtu")).unwrap();
    let has = |name: &str| frame.windows(name.len()).any(|bytes| bytes == name.as_bytes());
    assert!(has("\"load_fraction\"") && has("\"step\"") && !has("TimeValue"));
}

#[test]
fn texts_of_a_case_neither_steer_the_terminal_nor_calculate_in_a_spreadsheet() {
    let evil = BLOCK.replace("Pulled block", "\\u001b[2JPulled\\nblock");
    let probe = PROBE.replace("top", "=1+1\\u001b[2J");
    let (_dir, folder) = folder_with(&[&evil, DYNAMIC, &probe]);
    for arguments in [&["solve", "case.toml", "--out", "out"][..], &["inspect", "case.toml"]] {
        let (code, out, err) = mtled(&folder, arguments);
        assert_eq!(code, 0, "{err}");
        assert!(out.contains("\\u{1b}[2JPulled"), "{arguments:?}: {out}");
        assert!(!(out + &err).contains('\u{1b}'), "{arguments:?}");
    }
    let history = std::fs::read_to_string(folder.join("out/history.csv")).unwrap();
    let header = history.lines().next().unwrap();
    assert!(header.contains(",'=1+1\\u{1b}[2J.ux_m,"), "{header}");
    assert!(!history.contains("'-"), "numbers must stay numbers: {history}");
    std::fs::write(folder.join("bad.toml"), "\"\u{7f}\\u001b[2J\" = 1\n").unwrap();
    let (code, _, err) = mtled(&folder, &["case", "check", "bad.toml"]);
    assert!(code == 2 && !err.contains(['\u{1b}', '\u{7f}']), "{err:?}");
}

#[test]
fn a_report_from_elsewhere_writes_into_its_folder_only() {
    let (_dir, folder) = folder_with(&[BLOCK, STATIC]);
    let sweep = ["study", "consistency", "case.toml", "--dilation", "1.8,2", "--out", "report"];
    let (code, _, err) = mtled(&folder, &[&sweep[..], &["--cells-per-spacing", "1.26"]].concat());
    assert_eq!(code, 0, "{err}");
    let text = std::fs::read_to_string(folder.join("report/results.json")).unwrap();
    let evil = text.replace("\"id\":\"consistency\"", "\"id\":\"../../consistency\"");
    assert!(evil != text && text.contains("\"plot\""), "nothing to lead astray");
    std::fs::create_dir(folder.join("deep")).unwrap();
    std::fs::write(folder.join("deep/results.json"), evil).unwrap();
    let before = std::fs::read_dir(&folder).unwrap().count();
    let (code, _, err) = mtled(&folder, &["report", "deep/results.json", "--out", "deep/out"]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), before);
    assert_eq!(std::fs::read_dir(folder.join("deep")).unwrap().count(), 2);
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

#[test]
fn mistakes_are_data_where_json_is_asked_for() {
    let wrong = BLOCK.replace("density", "densty");
    let (_dir, folder) = folder_with(&[&wrong, STATIC]);
    let line = 1 + wrong.lines().position(|line| line.starts_with("densty")).unwrap();
    let at_key = |mistake: &Value| {
        assert_eq!(mistake["file"], "case.toml", "{mistake}");
        assert_eq!((&mistake["line"], &mistake["column"]), (&line.into(), &1.into()), "{mistake}");
        assert_eq!(mistake["key"], "material.tissue.densty", "{mistake}");
        assert!(mistake["message"].as_str().unwrap().contains("did you mean `density`"));
    };
    let (code, out, err) = mtled(&folder, &["case", "check", "case.toml", "--format", "json"]);
    assert_eq!((code, err.as_str()), (2, ""));
    let checked = json(&out)["cases"][0].clone();
    assert_eq!(checked["valid"], false);
    at_key(&checked["mistakes"][0]);
    for command in [&["solve"][..], &["inspect"], &["budget"], &["tune"], &["study", "patch"]] {
        let (code, out, err) =
            mtled(&folder, &[command, &["case.toml", "--format", "json"]].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{command:?}");
        at_key(&json(&err));
    }
    for arguments in [&["slove", "--format", "json"][..], &["runs", "show", "x", "--format=json"]] {
        let (code, out, err) = mtled(&folder, arguments);
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}");
        assert_eq!(json(&err)["severity"], "error", "{arguments:?}");
    }
}

#[test]
fn every_command_prints_one_json_document_where_json_is_asked_for() {
    let (_dir, folder) = folder_with(&[BLOCK, STATIC]);
    std::fs::create_dir(folder.join("store")).unwrap();
    let shard = ["study", "consistency", "case.toml", "--dilation", "2", "--shard", "1/1"];
    let commands: [(&[&str], &str); 7] = [
        (&["case", "list"], "/0"),
        (&["case", "show", "uniaxial_bar"], "/text"),
        (&["case", "check", "case.toml", "uniaxial_bar"], "/cases/1/valid"),
        (&shard, "/stored"),
        (&["runs", "list"], "/0/key"),
        (&["runs", "prune"], "/removed/records"),
        (&["merge", "store"], "/added"),
    ];
    for (command, pointer) in commands {
        let (code, out, err) = mtled(&folder, &[command, &["--format", "json"]].concat());
        assert_eq!(code, 0, "{command:?}: {err}");
        assert!(json(&out).pointer(pointer).is_some(), "{command:?}: {out}");
        assert!(err.lines().all(|line| json(line)["severity"] != "error"), "{command:?}: {err}");
    }
}

#[test]
fn a_bundled_case_is_found_by_its_name() {
    let (_dir, folder) = folder_with(&[]);
    // A folder of that name, such as that of its results, is no case.
    std::fs::create_dir(folder.join("uniaxial_bar")).unwrap();
    assert_eq!(mtled(&folder, &["case", "check", "uniaxial_bar"]).0, 0);
    assert_eq!(mtled(&folder, &["case", "check", "brain_slice"]).0, 0);
    let (code, out, err) = mtled(&folder, &["inspect", "uniaxial_bar", "--format", "json"]);
    assert_eq!((code, json(&out)["case"].as_str()), (0, Some("uniaxial_bar")), "{err}");
    assert_eq!(mtled(&folder, &["solve", "uniaxial_bar"]).0, 0);
    assert!(folder.join("reports/uniaxial_bar/uniaxial_bar.pvd").exists());
    let (code, _, err) = mtled(&folder, &["solve", "uniaxial_ball"]);
    assert!(code == 2 && err.contains("mtled case list"), "{err}");
}
