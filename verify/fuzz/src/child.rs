//! What runs in a child process, which is this program with another task: the program
//! `mtled` itself, or one reader of the library for input after input.

use crate::finding::Outcome;
use crate::target::Target;
use anyhow::Result;
use clap::ValueEnum;
use mtled::Simulation;
use mtled::discretisation::Footprint;
use mtled::problem::Problem;
use mtled_case::scene::read_case;
use mtled_metamorphic::hunt::examine;
use mtled_metamorphic::scene::Scene;
use mtled_run::machine::peak_memory;
use mtled_run::run::refuse_beyond_memory;
use rustix::process::{Resource, Rlimit, setrlimit};
use serde::{Deserialize, Serialize};
use std::io::{BufRead, Write};
use std::path::Path;
use std::process::ExitCode;

/// Environment variables by which the parent asks for a task and its limits.
pub mod variable {
    /// `program` or the name of a target.
    pub(crate) const TASK: &str = "MTLED_FUZZ_TASK";
    /// Address space \[byte\].
    pub(crate) const ADDRESS_SPACE: &str = "MTLED_FUZZ_ADDRESS_SPACE";
    /// Pairs of points and nodes beyond which a case is left out.
    pub(crate) const LARGEST: &str = "MTLED_FUZZ_LARGEST";
    /// File for the peak memory \[byte\].
    pub(crate) const PEAK: &str = "MTLED_FUZZ_PEAK";
}

/// Exit code of a case that is left out; the program has no such code.
pub(crate) const LEFT_OUT: u8 = 77;
/// Pairs of points and nodes that are discretised by the library targets at most.
const LARGEST_IN_LIBRARY: f64 = 3e5;
/// File that a program with a case as its input reads.
const CASE: &str = "input.toml";

/// What a worker says of an input.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Answer {
    /// How it ended.
    pub outcome: Outcome,
    /// The refusal.
    pub message: Option<String>,
    /// Relations that do not hold.
    pub broken: Vec<String>,
    /// Peak memory \[byte\].
    pub peak: u64,
}

/// Does the task that the environment asks for, if any.
pub fn run_task() -> Option<ExitCode> {
    let task = std::env::var(variable::TASK).ok()?;
    if let Some(bytes) = number(variable::ADDRESS_SPACE) {
        let limit = Some(bytes as u64);
        let _ = setrlimit(Resource::As, Rlimit { current: limit, maximum: limit });
        let _ = setrlimit(Resource::Core, Rlimit { current: Some(0), maximum: Some(0) });
    }
    Some(match task.as_str() {
        "program" => program(),
        task => match Target::from_str(task, false).map(work) {
            Ok(Ok(())) => ExitCode::SUCCESS,
            _ => ExitCode::FAILURE,
        },
    })
}

fn number(variable: &str) -> Option<f64> {
    std::env::var(variable).ok()?.parse().ok()
}

/// The program `mtled` with the arguments of this process.
fn program() -> ExitCode {
    if number(variable::LARGEST).is_some_and(|largest| is_larger(Path::new(CASE), largest)) {
        return ExitCode::from(LEFT_OUT);
    }
    let code = mtled_verify::cli::run();
    if let Ok(file) = std::env::var(variable::PEAK) {
        let _ = std::fs::write(file, peak_memory().unwrap_or(0).to_string());
    }
    code
}

fn is_larger(case: &Path, largest: f64) -> bool {
    read_case(case).is_ok_and(|case| pairs(&case.problem) > largest)
}

/// Estimated pairs of quadrature points and nodes; 0 where there is no estimate.
fn pairs(problem: &Problem) -> f64 {
    Footprint::of(problem).map_or(0.0, |size| (size.points * size.neighbours).max(size.nodes))
}

/// Answers each line of standard input, the path of a file, by a line.
fn work(target: Target) -> Result<()> {
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        reset_peak();
        let line = line?;
        let file = Path::new(&line);
        let mut broken = Vec::new();
        let (outcome, message) = match target {
            Target::Trap => trap(file),
            Target::Scene => scene(file, &mut broken),
            _ => check(file),
        };
        let answer = Answer { outcome, message, broken, peak: peak_memory().unwrap_or(0) };
        writeln!(out, "{}", serde_json::to_string(&answer)?)?;
        out.flush()?;
    }
    Ok(())
}

/// Begins a new maximum, where the system can.
fn reset_peak() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// As `mtled case check`.
fn check(file: &Path) -> (Outcome, Option<String>) {
    let refused = |message: String| (Outcome::Refused, Some(message));
    let case = match read_case(file) {
        Ok(case) => case,
        Err(mistakes) => {
            let lines: Vec<String> = mistakes.iter().map(|mistake| mistake.to_string()).collect();
            return refused(lines.join("\n"));
        }
    };
    let located = |message: String| refused(case.diagnostic("discretisation", message).to_string());
    if let Err(shortage) = refuse_beyond_memory(&case) {
        return located(shortage.to_string());
    }
    if pairs(&case.problem) > LARGEST_IN_LIBRARY {
        return (Outcome::LeftOut, None);
    }
    match Simulation::new(&case.problem) {
        Err(error) => located(error.to_string()),
        Ok(simulation) => {
            if simulation.discretisation.worst_condition.is_finite() {
                (Outcome::Succeeded, None)
            } else {
                located("the condition is not finite, without an error".into())
            }
        }
    }
}

/// Holds all relations against a scene.
fn scene(file: &Path, broken: &mut Vec<String>) -> (Outcome, Option<String>) {
    let text = std::fs::read_to_string(file).unwrap_or_default();
    let scene = match Scene::from_text(&text) {
        Ok(scene) => scene,
        Err(error) => return (Outcome::Refused, Some(format!("input.toml: {error}"))),
    };
    match examine(&scene, &|_| true) {
        // It has no answer, and relations say nothing.
        Err(_) => (Outcome::Diverged, None),
        Ok(verdicts) => {
            let findings = verdicts.iter().filter(|verdict| verdict.is_finding());
            broken.extend(findings.map(|v| format!("{}: {}", v.relation.name, v.text())));
            (Outcome::Succeeded, None)
        }
    }
}

/// Misbehaves as the file says, so that the harness can be tested.
fn trap(file: &Path) -> (Outcome, Option<String>) {
    let text = std::fs::read_to_string(file).unwrap_or_default();
    let said = |message: &str| (Outcome::Refused, Some(message.to_string()));
    match text.trim() {
        "panic" => panic!("a trap"),
        "abort" => std::process::abort(),
        "hang" => loop {
            std::hint::black_box(0);
        },
        "memory" => drop(std::hint::black_box(vec![1u8; 1 << 40])),
        "stack-overflow" => return said(&deep(1).to_string()),
        "unlocated" => return said("no"),
        "outside" => drop(std::fs::write(file.with_file_name("x.json"), "changed")),
        _ => return said("input.txt: is no trap"),
    }
    (Outcome::Succeeded, None)
}

/// Recursion without end.
#[allow(unconditional_recursion)]
fn deep(n: u64) -> u64 {
    std::hint::black_box(deep(n + 1)) + std::hint::black_box(n)
}
