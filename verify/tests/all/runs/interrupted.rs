//! Programs that are killed, that share a store, and that cannot write: whatever lies in
//! their folders is whole, and the next run succeeds.

use super::folder::{self, Calm, assert_whole};
use crate::common::program::{ended, mtled, program};
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime};

const BLOCK: &str = include_str!("../common/pulled_block.toml");

/// Arguments of a study of a few short runs.
const STUDY: [&str; 8] = [
    "study",
    "convergence",
    "case.toml",
    "--spacing",
    "x1.6,x1.4",
    "--reference",
    "own",
    "--quiet",
];

/// A case of a tenth of a second with a load of its own.
fn case(load: f64, frames: usize) -> String {
    let block = BLOCK.replace("spacing = 0.02", "spacing = 0.025");
    let block = block.replace("[0.0, 0.0, 1.0]\n\n", &format!("[0.0, 0.0, {load:?}]\n\n"));
    let probe = "[[probe]]\nname = \"top\"\npoint = [0.05, 0.05, 0.1]\n";
    format!(
        "{block}[time]\nmethod = \"static\"\nsolver = \"relaxation\"\ntolerance = 1e-3\n{probe}[output]\nframes = {frames}\n"
    )
}

fn quiet(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = program(folder, arguments);
    command.args(["--threads", "1"]).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn succeeds(command: Command) {
    let shown = format!("{command:?}");
    let (code, _, err) = ended(command);
    // Studies of two spacings show no order, which is inconclusive.
    assert!([0, 3].contains(&code), "{shown}: {code}: {err}");
}

/// Numbers from 0 to 1 that follow from the first one.
struct Moments(u64);

impl Moments {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }
}

fn kill(mut child: Child) {
    child.kill().unwrap();
    child.wait().unwrap();
}

/// Latest change in a folder.
fn changed(folder: &Path) -> Option<SystemTime> {
    let entries = std::fs::read_dir(folder).ok()?;
    let times = entries.flatten().filter_map(|entry| entry.metadata().ok()?.modified().ok());
    times.chain(std::fs::metadata(folder).and_then(|data| data.modified())).max()
}

/// Waits until a program begins to write.
fn wait_for_writing(child: &mut Child, out: &Path, before: Option<SystemTime>) {
    while child.try_wait().unwrap().is_none() && changed(out) == before {
        std::thread::sleep(Duration::from_micros(200));
    }
}

/// Time that an undisturbed program takes to write \[s\].
fn writing_time(mut command: Command, out: &Path) -> f64 {
    let before = changed(out);
    let mut child = command.spawn().unwrap();
    wait_for_writing(&mut child, out, before);
    let start = Instant::now();
    assert!(child.wait().unwrap().success());
    start.elapsed().as_secs_f64()
}

#[test]
fn a_killed_solve_leaves_files_of_one_run_and_no_half_result() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let out = folder.join("out");
    let solve = || quiet(folder, &["solve", "case.toml", "--out", "out", "--quiet"]);
    let mut calm = Vec::new();
    let mut writing = 0.0;
    for (load, frames) in [(1.0, 4), (2.0, 9)] {
        let text = case(load, frames);
        std::fs::write(folder.join("case.toml"), &text).unwrap();
        writing = writing_time(solve(), &out);
        let kept = folder.join(format!("calm_{frames}"));
        std::fs::rename(&out, &kept).unwrap();
        calm.push(Calm::read(&kept, &text));
    }
    let mut moments = Moments(7);
    for n in 0..24 {
        std::fs::write(folder.join("case.toml"), &calm[n % 2].case).unwrap();
        let before = changed(&out);
        let mut child = solve().spawn().unwrap();
        // Every sixth one anywhere, the others while it writes.
        match n % 6 {
            5 => std::thread::sleep(Duration::from_secs_f64(0.2 * moments.next())),
            _ => {
                wait_for_writing(&mut child, &out, before);
                std::thread::sleep(Duration::from_secs_f64(writing * moments.next()));
            }
        }
        kill(child);
        assert_whole(&out, &calm);
    }
    succeeds(solve());
    assert_whole(&out, &calm);
    assert!(out.join("result.json").exists());
}

/// Every record of a store without its times; a corrupt one would end with another code.
fn records(folder: &Path, store: &str) -> Vec<Value> {
    let (code, out, err) = mtled(folder, &["runs", "list", "--format", "json", "--store", store]);
    assert_eq!(code, 0, "{err}");
    let mut all: Vec<Value> = serde_json::from_str(&out).unwrap();
    all.iter_mut().for_each(|record| record["timings"] = Value::Null);
    all
}

#[test]
fn a_killed_search_or_verification_leaves_whole_files_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("case.toml"), case(1.0, 1)).unwrap();
    let tune = [
        "tune",
        "case.toml",
        "--target-error",
        "30%",
        "--clouds",
        "1",
        "--dilation",
        "1.8",
        "--quiet",
    ];
    let verify = ["verify", "--only", "references", "--quiet"];
    let mut moments = Moments(3);
    for arguments in [&tune[..], &verify] {
        for n in 0..4 {
            let child = quiet(folder, arguments).spawn().unwrap();
            std::thread::sleep(Duration::from_secs_f64(0.2 * (f64::from(n) + moments.next())));
            kill(child);
            assert_whole(&folder.join("reports"), &[]);
            records(folder, "reports/runs");
        }
        succeeds(quiet(folder, arguments));
        assert_whole(&folder.join("reports"), &[]);
    }
    assert!(folder.join("reports/tune/case/case.tuned.toml").exists());
    assert!(folder.join("reports/verify/results.json").exists());
    // What was killed a moment ago might still be written, so that it stays for a while.
    let long_ago = SystemTime::now() - Duration::from_secs(200_000);
    for path in folder::files(&folder.join("reports/runs")) {
        let file = std::fs::OpenOptions::new().write(true).open(path).unwrap();
        file.set_modified(long_ago).unwrap();
    }
    succeeds(quiet(folder, &["runs", "prune"]));
    let left = folder::files(&folder.join("reports/runs"));
    assert!(left.iter().all(|path| !path.to_string_lossy().ends_with(".tmp")), "{left:?}");
}

#[test]
fn two_studies_on_one_store_at_once_both_succeed() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("case.toml"), case(1.0, 1)).unwrap();
    let study = |store: &str, out: &str| {
        quiet(folder, &[&STUDY[..], &["--store", store, "--out", out]].concat())
    };
    succeeds(study("calm", "calm_report"));
    let children = ["one", "two"].map(|out| study("shared", out).spawn().unwrap());
    for mut child in children {
        assert!(matches!(child.wait().unwrap().code(), Some(0 | 3)));
    }
    assert_eq!(records(folder, "shared"), records(folder, "calm"));
    assert_whole(folder, &[]);
}

/// The program where no file may grow beyond some blocks of 512 bytes, as on a full disk.
fn with_little_space(folder: &Path, blocks: u32, arguments: &[&str]) -> Output {
    let mut shell = Command::new("sh");
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
    shell.args(["-c", &script]).arg(program(folder, &[]).get_program()).args(arguments);
    shell.args(["--threads", "1"]).current_dir(folder).output().unwrap()
}

/// Code 2 and the path in the message.
fn assert_refused(output: &Output, path: &str) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains(path), "{message} does not name {path}");
    assert!(!message.contains("panicked"), "{message}");
}

#[test]
fn a_full_disk_ends_with_the_path_and_without_half_files() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("case.toml"), case(1.0, 1)).unwrap();
    let solve = ["solve", "case.toml", "--out", "out", "--quiet"];
    assert_refused(&with_little_space(folder, 4, &solve), "out/nodes_0000.vtu");
    assert!(!folder.join("out/result.json").exists());
    let study = [&STUDY[..], &["--store", "store", "--out", "report"]].concat();
    assert_refused(&with_little_space(folder, 1, &study), "store/");
    assert_refused(
        &with_little_space(folder, 4, &["verify", "--only", "references"]),
        "reports/verify/",
    );
    for file in folder::files(folder) {
        assert!(!file.to_string_lossy().ends_with(".tmp"), "{} was left", file.display());
    }
    assert_whole(folder, &[]);
    succeeds(quiet(folder, &solve));
    succeeds(quiet(folder, &study));
}

#[test]
fn a_folder_that_cannot_be_made_is_named_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // A run of this case would take minutes.
    std::fs::write(folder.join("case.toml"), case(1.0, 1).replace("0.025", "0.0025")).unwrap();
    std::fs::write(folder.join("file"), "").unwrap();
    let commands: [&[&str]; 6] = [
        &["solve", "case.toml", "--out", "file/out"],
        &[&STUDY[..], &["--out", "file/out"]].concat(),
        &[&STUDY[..], &["--store", "file/store"]].concat(),
        &["tune", "case.toml", "--out", "file/out"],
        &["budget", "case.toml", "--out", "file/out"],
        &["verify", "--only", "energy", "--out", "file/out"],
    ];
    for arguments in commands {
        let start = Instant::now();
        let mut child = quiet(folder, arguments);
        let mut child = child.stderr(Stdio::piped()).spawn().unwrap();
        while child.try_wait().unwrap().is_none() {
            if start.elapsed() > Duration::from_secs(10) {
                kill(child);
                panic!("{arguments:?} did not find out before the run");
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        assert_refused(&child.wait_with_output().unwrap(), "file/");
        assert!(!folder.join("reports/runs").exists(), "{arguments:?}");
    }
}
