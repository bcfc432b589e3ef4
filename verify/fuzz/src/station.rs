//! One place where inputs are tried: a sandbox with its workers.

use crate::child::{LEFT_OUT, variable};
use crate::finding::{Finding, Kind, Outcome};
use crate::judge;
use crate::mutate::Input;
use crate::process::{End, Limits, command, tail, wait};
use crate::sandbox::Sandbox;
use crate::target::{Step, Target};
use crate::worker::Worker;
use anyhow::Result;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;

/// What became of an input.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// How it ended; None where there is a finding.
    pub outcome: Option<Outcome>,
    /// What must not have happened.
    pub findings: Vec<Finding>,
    /// Longest call \[s\].
    pub seconds: f64,
    /// Largest memory \[byte\].
    pub peak: u64,
}

/// A sandbox with a worker for each target of the library.
#[derive(Debug)]
pub(crate) struct Station {
    sandbox: Sandbox,
    limits: Limits,
    workers: BTreeMap<Target, Worker>,
}

impl Station {
    /// A station whose inputs lie beside `companions`, names and contents.
    pub(crate) fn new(companions: Vec<(String, Vec<u8>)>, limits: Limits) -> Result<Station> {
        Ok(Station { sandbox: Sandbox::new(companions)?, limits, workers: BTreeMap::new() })
    }

    /// Tries one input.
    pub(crate) fn try_input(&mut self, target: Target, input: &Input) -> Result<Trial> {
        let place = self.sandbox.place(target, input)?;
        match target.steps() {
            None => self.in_library(target, &place),
            Some(steps) => self.in_program(steps, &place),
        }
    }

    fn in_library(&mut self, target: Target, place: &str) -> Result<Trial> {
        let before = self.sandbox.listing("out")?;
        let start = std::time::Instant::now();
        let answer = {
            let stderr = self.sandbox.messages();
            let cpu_s = target.calls() * self.limits.cpu_s;
            let limits = &Limits { cpu_s, ..self.limits };
            let worker = match self.workers.entry(target) {
                std::collections::btree_map::Entry::Occupied(entry) => entry.into_mut(),
                std::collections::btree_map::Entry::Vacant(entry) => {
                    entry.insert(Worker::start(target, &stderr, limits)?)
                }
            };
            worker.ask(&self.sandbox.work().join(case_of(target, place)), limits)?
        };
        let seconds = start.elapsed().as_secs_f64();
        let mut trial = Trial { outcome: None, findings: Vec::new(), seconds, peak: 0 };
        match answer {
            Err(finding) => {
                self.workers.remove(&target);
                trial.findings.push(finding);
            }
            Ok(answer) => {
                trial.peak = answer.peak;
                trial.outcome = Some(answer.outcome);
                let message = answer.message.as_deref().unwrap_or_default();
                if answer.outcome == Outcome::Refused {
                    trial.findings.extend(judge::unlocated(message, "input"));
                }
                let broken = answer.broken.iter();
                trial.findings.extend(broken.map(|what| Finding::new(Kind::Relation, what)));
            }
        }
        self.compare(&before, "out", &mut trial)?;
        Ok(trial)
    }

    fn in_program(&self, steps: &[Step], place: &str) -> Result<Trial> {
        let mut whole = Trial {
            outcome: Some(Outcome::Succeeded),
            findings: Vec::new(),
            seconds: 0.0,
            peak: 0,
        };
        for step in steps {
            let trial = self.step(step, place)?;
            whole.seconds = whole.seconds.max(trial.seconds);
            whole.peak = whole.peak.max(trial.peak);
            whole.outcome = whole.outcome.max(trial.outcome);
            whole.findings.extend(trial.findings);
        }
        if !whole.findings.is_empty() {
            whole.outcome = None;
        }
        Ok(whole)
    }

    fn step(&self, step: &Step, place: &str) -> Result<Trial> {
        let before = self.sandbox.listing(step.writes)?;
        let logs = self.sandbox.logs();
        let [stdout, stderr, peak] = ["stdout", "stderr", "peak"].map(|name| logs.join(name));
        let mut command = command("program", &self.limits)?;
        command.args(step.arguments).current_dir(self.sandbox.work());
        command.stdout(File::create(&stdout)?).stderr(File::create(&stderr)?);
        command.env(variable::PEAK, &peak).env("TMPDIR", &logs);
        if let Some(largest) = step.largest {
            command.env(variable::LARGEST, largest.to_string());
        }
        let end = wait(&mut command.spawn()?, &self.limits)?;
        let peak = tail(&peak).parse().unwrap_or(0);
        let mut trial = Trial { outcome: None, findings: Vec::new(), seconds: end.seconds, peak };
        let printed = [std::fs::read(&stdout)?, std::fs::read(&stderr)?];
        trial.outcome = judge_end(&end, step, place, &printed, &mut trial.findings);
        if trial.findings.is_empty() {
            trial.findings.extend(judge::control_character("standard output", &printed[0]));
            trial.findings.extend(judge::control_character("standard error", &printed[1]));
            trial.findings.extend(judge::files(&self.sandbox.work().join("out")));
            trial.findings.extend(result_that_contradicts(&end, &self.sandbox.work()));
        }
        self.compare(&before, step.writes, &mut trial)?;
        Ok(trial)
    }

    /// A finding where anything else than `writes` has changed.
    fn compare(
        &self,
        before: &crate::sandbox::Listing,
        writes: &str,
        trial: &mut Trial,
    ) -> Result<()> {
        let difference = self.sandbox.difference(before, &self.sandbox.listing(writes)?);
        trial.findings.extend(difference.map(|what| Finding::new(Kind::Outside, what)));
        if !trial.findings.is_empty() {
            trial.outcome = None;
        }
        Ok(())
    }
}

/// The case that is read: the input itself, or one that names it.
fn case_of(target: Target, place: &str) -> String {
    match target {
        Target::LabelMap | Target::Surface | Target::Points => {
            format!("with_{}_{}.toml", target.name(), place.replace('.', "_"))
        }
        _ => place.to_string(),
    }
}

/// The outcome of a call by its exit code.
fn judge_end(
    end: &End,
    step: &Step,
    place: &str,
    printed: &[Vec<u8>; 2],
    findings: &mut Vec<Finding>,
) -> Option<Outcome> {
    let [stdout, stderr] = [&printed[0], &printed[1]].map(|bytes| String::from_utf8_lossy(bytes));
    if end.status.is_none() {
        let what = if end.asked { "asked to stop, and " } else { "" };
        let detail = format!("`mtled {}` was {what}still there", step.arguments.join(" "));
        findings.push(Finding::new(Kind::Hang, detail));
        return None;
    }
    match end.code() {
        Some(0) => {
            if step.arguments.contains(&"json") {
                findings.extend(judge::json("standard output", &stdout));
            }
            Some(Outcome::Succeeded)
        }
        Some(1 | 3)
            if matches!(step.arguments[0], "report" | "reference" | "study" | "protocol") =>
        {
            Some(Outcome::Succeeded)
        }
        Some(3) if step.arguments[0] == "solve" && stderr.contains("doubtful: ") => {
            Some(Outcome::Doubtful)
        }
        Some(2) => {
            let name = Path::new(place).file_stem().unwrap_or_default().to_string_lossy();
            // A plan may be at fault only together with its cases.
            let name = if step.arguments[0] == "study" { "error: " } else { &name };
            findings.extend(judge::unlocated(&stderr, name));
            let diverged = stderr.contains(": time: ") || stderr.contains(": time.solver: newton");
            Some(if diverged { Outcome::Diverged } else { Outcome::Refused })
        }
        Some(130) if end.asked => Some(Outcome::Stopped),
        Some(code) if code == i32::from(LEFT_OUT) => Some(Outcome::LeftOut),
        // The request to stop came before the program listened.
        None if end.asked && end.signal() == Some(2) => Some(Outcome::Stopped),
        Some(code) if !stderr.contains("panicked at ") => {
            let detail = format!("exit code {code}: {}", stderr.trim_end());
            findings.push(Finding::new(Kind::ExitCode, detail));
            None
        }
        _ => {
            findings.push(judge::death(&stderr, end.signal()));
            None
        }
    }
}

/// A result.json that says otherwise than the exit code how the run ended.
fn result_that_contradicts(end: &End, work: &Path) -> Option<Finding> {
    let text = std::fs::read_to_string(work.join("out/result.json")).ok()?;
    let result: serde_json::Value = serde_json::from_str(&text).ok()?;
    let outcome = result["motion"]["outcome"].as_str().unwrap_or("nothing");
    let expected: &[&str] = match end.code() {
        Some(0 | 3) => &["completed", "converged"],
        Some(2) => &["not_converged", "diverged", "failed"],
        Some(130) => &["stopped"],
        _ => return None,
    };
    let detail = format!("exit code {:?}, and result.json says {outcome}", end.code());
    (!expected.contains(&outcome)).then(|| Finding::new(Kind::BadFile, detail))
}
