//! Results of a solver on a problem, as they are stored: raw answers with what they cost, on which
//! machine. All that is said of them is judged again from this file.

use super::process::Usage;
use mtled_checks::input::read_text;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Version of the layout.
pub const RESULTS: u32 = 1;

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
    #[error("runs: there are none")]
    NoRuns,
    #[error(
        "runs[{run}].spacing_m is {spacing_m} m; spacings must be positive and go from coarse to fine"
    )]
    Order { run: usize, spacing_m: f64 },
    #[error("runs[{run}].usage: {reason}")]
    Usage { run: usize, reason: &'static str },
    #[error("runs[{run}].ended.reply.solver: {found} answers, and {first} before it")]
    Solver { run: usize, first: String, found: String },
}

impl Results {
    /// Reads a file; its replies are not looked at.
    pub fn read(path: &Path) -> Result<Results, ResultsFault> {
        let unreadable = |reason: String| ResultsFault::Unreadable(reason);
        let text = read_text(path).map_err(|error| unreadable(error.to_string()))?;
        let value: Value =
            serde_json::from_str(&text).map_err(|error| unreadable(error.to_string()))?;
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
        let mut coarser = f64::INFINITY;
        for (run, stored) in self.runs.iter().enumerate() {
            let spacing_m = stored.spacing_m;
            if !(spacing_m > 0.0 && spacing_m < coarser) {
                return Err(ResultsFault::Order { run, spacing_m });
            }
            coarser = spacing_m;
            let replied = matches!(stored.ended, StoredEnd::Reply(_));
            let reason = match stored.usage {
                None if replied => Some("is missing; a run that replies has taken time"),
                Some(usage) if !(usage.cpu_s > 0.0 && usage.wall_s > 0.0) => {
                    Some("times must be more than 0")
                }
                Some(usage) if replied && usage.wall_s > self.time_limit_s + GRACE_S => {
                    Some("wall_s is beyond the time limit, and yet there is a reply")
                }
                _ => None,
            };
            if let Some(reason) = reason {
                return Err(ResultsFault::Usage { run, reason });
            }
        }
        self.check_solver()
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

/// What a process may take to be killed beyond its time limit \[s\].
const GRACE_S: f64 = 5.0;

/// The files `*.json` in a folder and those below, in the order of their names; a file itself.
pub fn result_files(path: &Path) -> std::io::Result<Vec<PathBuf>> {
    if !path.is_dir() {
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
