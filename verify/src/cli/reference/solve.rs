//! `mtled reference solve`: runs the Python side.

use super::stored::case_names;
use crate::cli::common::{Common, Format, STOPPED};
use crate::cli::progress::progress_bar;
use crate::cli::python::{Python, checkout, python_for};
use crate::cli::streams::{print_json, print_text};
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use indicatif::ProgressBar;
use mtled_case::reference::compare::{TOLERANCE, compare};
use mtled_case::reference::{CODES, ReferenceFile, read_reference};
use mtled_case::scene::{one_error, read_case};
use mtled_checks::input::read_text;
use mtled_checks::report::ensure_writable;
use mtled_run::run::interrupted;
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

#[derive(Debug, Args)]
pub(crate) struct SolveReferenceArgs {
    /// Names of cases [default: all].
    cases: Vec<String>,
    /// The code to solve with [default: both].
    #[arg(long, value_parser = CODES)]
    code: Option<String>,
    /// Solve this mesh only, 0 being the coarsest; may be repeated. The solution is written to
    /// OUT/CASE.CODE.json and not merged.
    #[arg(long = "mesh", value_name = "N", value_parser = clap::value_parser!(u8).range(0..=2))]
    meshes: Vec<u8>,
    /// Folder of the references [default: `data` in the folder `reference`].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write nothing and compare with the stored values, by default on the coarsest mesh. Exit
    /// code 1 if a number has changed by more than 1e-6.
    #[arg(long)]
    compare: bool,
    /// The folder `reference` of a checkout [default: searched from the working directory
    /// upward].
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,
}

/// A line of progress that Python writes.
#[derive(Debug, Deserialize)]
struct Progress {
    progress: f64,
    #[serde(default)]
    message: String,
}

/// How a run of Python ended.
enum Ended {
    Well,
    Stopped,
}

pub(crate) fn solve(arguments: &SolveReferenceArgs, common: &Common) -> Result<u8> {
    let reference = match &arguments.reference {
        Some(folder) => folder.clone(),
        None => checkout()?,
    };
    let known = case_names(&reference.join("cases"))?;
    if let Some(name) = arguments.cases.iter().find(|name| !known.contains(name)) {
        bail!("there is no case \"{name}\"; there are {}", known.join(", "));
    }
    let cases = if arguments.cases.is_empty() { known } else { arguments.cases.clone() };
    let partial = !arguments.meshes.is_empty();
    if partial && !arguments.compare && arguments.out.is_none() {
        bail!("--mesh needs --out DIR or --compare, since single meshes are not a reference");
    }
    let out = arguments.out.clone().unwrap_or_else(|| reference.join("data"));
    if !arguments.compare {
        ensure_writable(&out)?;
    }
    let (mut code, mut done) = (0, Vec::new());
    for name in CODES.iter().filter(|c| arguments.code.as_deref().is_none_or(|code| code == **c)) {
        let python = python_for(name, &reference, &|text| common.note(text))?;
        for case in &cases {
            let reference = &reference;
            let job =
                Job { arguments, common, reference, out: &out, python: &python, case, code: name };
            match job.run(&mut done)? {
                None => return Ok(STOPPED),
                Some(other) => code = code.max(other),
            }
        }
    }
    if common.format == Format::Json {
        print_json(&format!("{:#}\n", json!({ "schema_version": 1, "solutions": done })))?;
    }
    Ok(code)
}

/// One case with one code.
struct Job<'a> {
    arguments: &'a SolveReferenceArgs,
    common: &'a Common,
    reference: &'a Path,
    out: &'a Path,
    python: &'a Python,
    case: &'a str,
    code: &'a str,
}

impl Job<'_> {
    /// The exit code; none if the user stopped it. What it has done is added to `done`.
    fn run(&self, done: &mut Vec<Value>) -> Result<Option<u8>> {
        let scratch = tempfile::tempdir()?;
        let solution = scratch.path().join("solution.json");
        let bar = progress_bar(self.common);
        let ended = self.solve(&solution, &bar);
        bar.finish_and_clear();
        if let Ended::Stopped = ended? {
            return Ok(None);
        }
        if self.arguments.compare {
            return self.compared(&solution, done).map(Some);
        }
        if self.arguments.meshes.is_empty() {
            let mut merge = self.python.module(self.reference);
            merge.arg("merge").arg(self.case_file()).arg("--data").arg(self.out).arg(&solution);
            run(merge, &mut |_| {}).with_context(|| self.label())?;
        } else {
            std::fs::copy(&solution, self.out.join(format!("{}.{}.json", self.case, self.code)))?;
        }
        done.push(
            json!({ "case": self.case, "code": self.code, "out": self.out.display().to_string() }),
        );
        self.print(&format!("{}: written to {}\n", self.label(), self.out.display()))?;
        Ok(Some(0))
    }

    fn print(&self, text: &str) -> Result<()> {
        if self.common.format == Format::Human && !self.common.quiet {
            print_text(text)?;
        }
        Ok(())
    }

    fn label(&self) -> String {
        format!("{} with {}", self.case, self.code)
    }

    fn case_file(&self) -> PathBuf {
        self.reference.join("cases").join(format!("{}.toml", self.case))
    }

    fn solve(&self, solution: &Path, bar: &ProgressBar) -> Result<Ended> {
        let mut command = self.python.module(self.reference);
        command.arg("solve").arg(self.case_file()).args(["--code", self.code]);
        let coarsest: &[u8] = if self.arguments.compare { &[0] } else { &[] };
        let named = &self.arguments.meshes[..];
        for mesh in if named.is_empty() { coarsest } else { named } {
            command.args(["--mesh", &mesh.to_string()]);
        }
        command.arg("--out").arg(solution);
        bar.set_message(self.label());
        let mut show = |line: &str| {
            if let Ok(report) = serde_json::from_str::<Progress>(line) {
                bar.set_position((1000.0 * report.progress) as u64);
                bar.set_message(format!("{}: {}", self.label(), report.message));
            }
        };
        run(command, &mut show).with_context(|| self.label())
    }

    /// Compares a solution with the stored one; the exit code is 0 if they are the same, else 1.
    fn compared(&self, solution: &Path, done: &mut Vec<Value>) -> Result<u8> {
        let case = read_case(&self.case_file()).map_err(one_error)?;
        let path = self.out.join(format!("{}.json", self.case));
        let text = read_text(&path)
            .with_context(|| format!("{}: cannot read {}", self.case, path.display()))?;
        let stored = match read_reference(&case, &text) {
            Ok(stored) => stored,
            Err(error) => {
                self.common.complain(error);
                return Ok(1);
            }
        };
        let again: ReferenceFile = serde_json::from_str(&std::fs::read_to_string(solution)?)?;
        let mut code = 0;
        for change in compare(&case, &stored, &again).map_err(|reason| anyhow!(reason))? {
            let text = format!(
                "{}, {} elements: largest change {:.1e}, in {}",
                self.label(),
                change.elements,
                change.relative,
                change.quantity
            );
            let same = change.relative <= TOLERANCE;
            if same {
                self.print(&format!("{text}\n"))?;
            } else {
                self.common.complain(format!("{text}; more than {TOLERANCE:.0e}"));
                code = 1;
            }
            done.push(json!({
                "case": self.case,
                "code": self.code,
                "elements": change.elements,
                "quantity": change.quantity,
                "largest_change": change.relative,
                "same": same,
            }));
        }
        Ok(code)
    }
}

/// Runs a command to its end and passes every line of its output to `read_line`; ends it with
/// its children when the user stops the program.
fn run(mut command: Command, read_line: &mut dyn FnMut(&str)) -> Result<Ended> {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let command = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().context("cannot start Python")?;
    let (stdout, stderr) = (child.stdout.take(), child.stderr.take());
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        for line in stdout.into_iter().flat_map(|out| BufReader::new(out).lines()) {
            let Ok(line) = line else { break };
            if sender.send(line).is_err() {
                break;
            }
        }
    });
    let message = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stderr {
            // What was read before a failure is still useful.
            let _ = stream.read_to_end(&mut bytes);
        }
        String::from_utf8_lossy(&bytes).trim().to_string()
    });
    loop {
        if interrupted() {
            stop(&mut child)?;
            return Ok(Ended::Stopped);
        }
        match receiver.recv_timeout(Duration::from_millis(100)) {
            Ok(line) => read_line(&line),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    let status: ExitStatus = child.wait()?;
    if !status.success() {
        let message = message.join().unwrap_or_default();
        bail!("Python ended with {status}\n{message}");
    }
    Ok(Ended::Well)
}

/// Ends a process and its group.
fn stop(child: &mut Child) -> Result<()> {
    if cfg!(unix) {
        let group = format!("-{}", child.id());
        Command::new("kill").args(["-TERM", "--", &group]).stderr(Stdio::null()).status()?;
    } else {
        child.kill()?;
    }
    child.wait()?;
    Ok(())
}
