//! Results of a solver on a problem, as they are stored: raw answers with what they cost, on which
//! machine. All that is said of them is judged again from this file.

use super::entrant::{NAME_RULE, is_name};
use super::process::Usage;
use mtled_checks::input::read_text;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Version of the layout.
pub(crate) const RESULTS: u32 = 1;

/// The runs of a solver on a problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Results {
    /// Version of this layout, 1.
    pub results: u32,
    /// Identity of the problem, such as `cube_shear-v1`.
    pub problem: String,
    /// Fingerprint of its inputs.
    pub inputs: String,
    /// Name in tables.
    pub solver: String,
    /// How it was started.
    pub command: String,
    /// Where.
    pub machine: Machine,
    /// Of a run, on the clock \[s\].
    pub time_limit_s: f64,
    /// From coarse to fine.
    pub runs: Vec<StoredRun>,
}

/// A machine at a time.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Machine {
    /// Model of the processor.
    pub processor: String,
    /// Such as `linux x86_64`.
    pub system: String,
    /// Day of the runs.
    pub date: String,
}

/// One job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoredRun {
    /// Distance of nodes that was asked for \[m\].
    pub spacing_m: f64,
    /// How it ended.
    pub ended: StoredEnd,
    /// What it took; left out where it did not start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub usage: Option<Usage>,
}

/// How a job ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StoredEnd {
    /// With a JSON file: an answer, a refusal, or neither.
    Reply(Value),
    /// Killed at the time limit.
    TimedOut,
    /// Without a file that could be read: what was wrong.
    Fault(String),
}

/// Why results are not believed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ResultsFault {
    #[error("cannot be read: {0}")]
    Unreadable(String),
    #[error("{key}: {reason}")]
    Layout { key: String, reason: String },
    #[error("results is {0}; this program reads version {RESULTS}")]
    Version(Value),
    #[error(
        "problem: there is no `{0}`; `mtled contest list` has the names, --case and --reference take a case of your own"
    )]
    Problem(String),
    #[error(
        "inputs: the results are of another problem than {problem} is; its fingerprint is {expected}"
    )]
    Inputs { problem: String, expected: String },
    #[error("solver: {NAME_RULE}")]
    Name,
    #[error("solver is `{OWN}`, but {found} answers")]
    Impersonation { found: String },
    #[error("{key} {reason}")]
    Field { key: &'static str, reason: &'static str },
    #[error("{solver} has results of {problem} in another file too: one of them must go")]
    Twice { solver: String, problem: String },
    #[error("runs: there are none")]
    NoRuns,
    #[error(
        "runs[{run}].spacing_m is {spacing_m:e} m; spacings must be lengths from 1e-9 to 1e9 m that go from coarse to fine"
    )]
    Order { run: usize, spacing_m: f64 },
    #[error("runs[{run}].usage: {reason}")]
    Usage { run: usize, reason: &'static str },
    #[error("runs[{run}].ended.reply.solver: {found} answers, and {first} before it")]
    Solver { run: usize, first: String, found: String },
}

impl StoredRun {
    /// The name under which a program replies.
    pub(crate) fn program(&self) -> Option<&str> {
        let StoredEnd::Reply(reply) = &self.ended else { return None };
        reply["solver"]["name"].as_str()
    }
}

impl Results {
    /// Reads a file; its replies are not looked at.
    pub fn read(path: &Path) -> Result<Results, ResultsFault> {
        let unreadable = |reason: String| ResultsFault::Unreadable(reason);
        let bytes = std::fs::metadata(path).map_err(|error| unreadable(error.to_string()))?.len();
        if bytes > LONGEST {
            return Err(unreadable(format!("it has more than {LONGEST} bytes")));
        }
        let text = read_text(path).map_err(|error| unreadable(error.to_string()))?;
        let value: Value =
            serde_json::from_str(&text).map_err(|error| unreadable(error.to_string()))?;
        // Lists would be read as the keys in their order.
        let mut runs = value["runs"].as_array().into_iter().flatten();
        if !value.is_object() || !runs.all(Value::is_object) {
            return Err(unreadable("results and each of their runs must be JSON objects".into()));
        }
        match value.get("results") {
            Some(version) if version.as_u64() != Some(RESULTS.into()) => {
                return Err(ResultsFault::Version(version.clone()));
            }
            _ => {}
        }
        let results: Results = serde_path_to_error::deserialize(value).map_err(|error| {
            let (key, reason) = (error.path().to_string(), error.inner().to_string());
            ResultsFault::Layout { key, reason }
        })?;
        results.check()?;
        Ok(results)
    }

    fn check(&self) -> Result<(), ResultsFault> {
        if self.runs.is_empty() {
            return Err(ResultsFault::NoRuns);
        }
        self.check_labels()?;
        let mut coarser = f64::INFINITY;
        for (run, stored) in self.runs.iter().enumerate() {
            let spacing_m = stored.spacing_m;
            if !(LENGTHS_M.contains(&spacing_m) && spacing_m < coarser) {
                return Err(ResultsFault::Order { run, spacing_m });
            }
            coarser = spacing_m;
            if let Some(reason) = self.fault_of_usage(stored) {
                return Err(ResultsFault::Usage { run, reason });
            }
        }
        self.check_solver()
    }

    fn fault_of_usage(&self, run: &StoredRun) -> Option<&'static str> {
        let (limit_s, replied) = (self.time_limit_s, matches!(run.ended, StoredEnd::Reply(_)));
        let Some(usage) = run.usage else {
            let started = !matches!(run.ended, StoredEnd::Fault(_));
            return started.then_some("is missing; a run that started has taken time");
        };
        if !(usage.cpu_s.is_finite() && usage.wall_s.is_finite()) {
            Some("times must be finite")
        } else if usage.cpu_s < LEAST_CPU_S || usage.wall_s <= 0.0 {
            Some("no process starts, reads and writes within 0.1 ms")
        } else if usage.cpu_s > MOST_THREADS * usage.wall_s + GRACE_S {
            Some("cpu_s is more than a thousand threads take in wall_s")
        } else if replied && usage.wall_s > limit_s + GRACE_S {
            Some("wall_s is more than 5 s beyond the time limit, and yet there is a reply")
        } else if run.ended == StoredEnd::TimedOut && usage.wall_s < limit_s {
            Some("wall_s is within the time limit, and yet the run has timed out")
        } else {
            None
        }
    }

    /// What is not a number.
    fn check_labels(&self) -> Result<(), ResultsFault> {
        if !is_name(&self.solver) {
            return Err(ResultsFault::Name);
        }
        let field = |key, reason| Err(ResultsFault::Field { key, reason });
        if !(self.time_limit_s > 0.0 && self.time_limit_s <= LONGEST_RUN_S) {
            return field("time_limit_s", "must be more than 0 and at most a week");
        }
        if self.command.trim().is_empty() {
            return field("command", "is empty");
        }
        if self.machine.processor.trim().is_empty() || self.machine.system.trim().is_empty() {
            return field("machine", "must name processor and system");
        }
        if !is_date(&self.machine.date) {
            return field("machine.date", "is not a day such as 2026-11-29");
        }
        Ok(())
    }

    /// One program in one version has made all replies.
    fn check_solver(&self) -> Result<(), ResultsFault> {
        let mut first: Option<String> = None;
        for (run, stored) in self.runs.iter().enumerate() {
            let StoredEnd::Reply(reply) = &stored.ended else { continue };
            let part = |key: &str| reply["solver"][key].as_str().map(str::to_string);
            let (Some(name), Some(version)) = (part("name"), part("version")) else { continue };
            let found = format!("{name} {version}");
            match &first {
                Some(first) if *first != found => {
                    return Err(ResultsFault::Solver { run, first: first.clone(), found });
                }
                _ if self.solver == OWN && name != OWN => {
                    return Err(ResultsFault::Impersonation { found });
                }
                _ => first = Some(found),
            }
        }
        Ok(())
    }

    /// Its place below a folder of results.
    pub fn path(&self) -> PathBuf {
        use mtled_checks::escape::file_name;
        Path::new(&file_name(&self.solver)).join(format!("{}.json", file_name(&self.problem)))
    }
}

/// Name of this program among the solvers.
pub(crate) const OWN: &str = "mtled";
/// The longest time limit \[s\]: a week.
pub const LONGEST_RUN_S: f64 = 604_800.0;
/// What a process may take to be killed beyond its time limit \[s\].
const GRACE_S: f64 = 5.0;
/// Less than any process takes \[s\].
const LEAST_CPU_S: f64 = 1e-4;
/// Threads beyond which a processor time is a mistake.
const MOST_THREADS: f64 = 1000.0;
/// Spacings that mean something \[m\].
const LENGTHS_M: std::ops::RangeInclusive<f64> = 1e-9..=1e9;
/// The longest file of results that is read \[byte\].
const LONGEST: u64 = 1 << 27;

/// Whether a text is a day, YYYY-MM-DD.
pub(crate) fn is_date(text: &str) -> bool {
    let parts: Vec<&str> = text.split('-').collect();
    let number = |part: &str, digits: usize| {
        let whole = part.len() == digits && part.bytes().all(|byte| byte.is_ascii_digit());
        whole.then(|| part.parse::<u32>().ok()).flatten()
    };
    let [year, month, day] = parts[..] else { return false };
    number(year, 4).is_some()
        && number(month, 2).is_some_and(|month| (1..=12).contains(&month))
        && number(day, 2).is_some_and(|day| (1..=31).contains(&day))
}

/// Of which solvers on which problems there are results.
#[derive(Debug, Default)]
pub struct Seen(BTreeSet<(String, String)>);

impl Seen {
    /// Refuses results of a solver on a problem that there are results of.
    pub fn add(&mut self, results: &Results) -> Result<(), ResultsFault> {
        let (solver, problem) = (results.solver.clone(), results.problem.clone());
        // Folders may not tell capitals from small letters.
        match self.0.insert((solver.to_lowercase(), problem.clone())) {
            true => Ok(()),
            false => Err(ResultsFault::Twice { solver, problem }),
        }
    }
}

/// The files `*.json` in a folder and those below, in the order of their names; a file itself.
pub fn result_files(path: &Path) -> std::io::Result<Vec<PathBuf>> {
    if !std::fs::metadata(path)?.is_dir() {
        return Ok(vec![path.to_path_buf()]);
    }
    let entries = std::fs::read_dir(path)?.map(|entry| entry.map(|entry| entry.path()));
    let mut entries: Vec<PathBuf> = entries.collect::<std::io::Result<_>>()?;
    entries.sort();
    let mut files = Vec::new();
    for entry in entries {
        if entry.is_dir() {
            files.extend(result_files(&entry)?);
        } else if entry.extension().is_some_and(|extension| extension == "json") {
            files.push(entry);
        }
    }
    Ok(files)
}
