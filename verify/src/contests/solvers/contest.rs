//! Every program on every case at every resolution.

use super::entrant::Entrant;
use super::problem::ContestCase;
use super::process::{Usage, run_child};
use super::results::{Machine, RESULTS, Results, StoredEnd, StoredRun};
use crate::lab::store::Source;
use crate::machine::provenance;
use crate::protocol::{Job, Resolution};
use crate::scene::{Case, one_error, parse_case, with_absolute_paths};
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What to run.
#[derive(Debug)]
pub struct Contest {
    /// The programs.
    pub entrants: Vec<Entrant>,
    /// The cases, each with distances of nodes from coarse to fine \[m\].
    pub cases: Vec<(ContestCase, Vec<f64>)>,
    /// Of a run, on the clock \[s\].
    pub time_limit_s: f64,
}

impl Contest {
    /// Runs everything, the programs in turn; `notify` is called before every run, `keep` with
    /// the results of a program on a case. False where the user has stopped it.
    pub fn run(
        &self,
        notify: &dyn Fn(&str),
        keep: &mut dyn FnMut(Results) -> Result<()>,
    ) -> Result<bool> {
        let mut not_started: Vec<Option<StoredEnd>> = vec![None; self.entrants.len()];
        for (case, spacings_m) in &self.cases {
            let mut runs: Vec<Vec<StoredRun>> = vec![Vec::new(); self.entrants.len()];
            for (level, &spacing_m) in spacings_m.iter().enumerate() {
                let (levels, time_limit_s) = (spacings_m.len(), self.time_limit_s);
                let resolution = Resolution { spacing_m, level, levels, time_limit_s };
                for (n, entrant) in self.entrants.iter().enumerate() {
                    notify(&format!("{}, level {level}: {}", case.id, entrant.name));
                    let ended = match &not_started[n] {
                        Some(ended) => Some((ended.clone(), None)),
                        None => one_run(case, entrant, resolution)?,
                    };
                    let Some((ended, usage)) = ended else { return Ok(false) };
                    if usage.is_none() {
                        not_started[n] = Some(ended.clone());
                    }
                    runs[n].push(StoredRun { spacing_m, ended, usage });
                }
            }
            for (entrant, runs) in self.entrants.iter().zip(runs) {
                keep(self.results(case, entrant, runs))?;
            }
        }
        Ok(true)
    }

    fn results(&self, case: &ContestCase, entrant: &Entrant, runs: Vec<StoredRun>) -> Results {
        let here = provenance();
        Results {
            results: RESULTS,
            problem: case.id.clone(),
            inputs: case.source.case.problem_hash.clone(),
            solver: entrant.name.clone(),
            command: entrant.shown.clone(),
            machine: Machine {
                processor: here.processor,
                system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
                date: here.date,
            },
            time_limit_s: self.time_limit_s,
            runs,
        }
    }
}

/// One job in a folder of its own, without usage where the program does not start. None where the
/// user has stopped it.
fn one_run(
    case: &ContestCase,
    entrant: &Entrant,
    at: Resolution,
) -> Result<Option<(StoredEnd, Option<Usage>)>> {
    let folder = tempfile::tempdir().context("cannot make a folder for a run")?;
    let job = write_job(&case.source, folder.path(), at, &case.reference.times)?;
    let answer = folder.path().join("answer.json");
    let limit = Duration::from_secs_f64(at.time_limit_s);
    Ok(match run_child(&entrant.words(&job, &answer), limit) {
        Err(error) => Some((StoredEnd::not_started(&error), None)),
        Ok(run) => StoredEnd::of(&run, &answer).map(|ended| (ended, Some(run.usage))),
    })
}

/// Writes a job with its case file into a folder; returns its path.
fn write_job(source: &Source, folder: &Path, at: Resolution, instants: &[f64]) -> Result<PathBuf> {
    let (case, case_file) = absolute(source, folder)?;
    let job = Job::new(&case, &case_file, at, instants);
    let job = job.map_err(|mistake| one_error(vec![mistake]))?;
    let path = folder.join("job.json");
    std::fs::write(&path, serde_json::to_string_pretty(&job)? + "\n")?;
    Ok(path)
}

/// The case with absolute names of other files, in a file of a folder.
pub fn absolute(source: &Source, folder: &Path) -> Result<(Case, PathBuf)> {
    let base = source.file.parent().unwrap_or(Path::new("."));
    let text = with_absolute_paths(source.case.text(), base)?;
    let case_file = folder.join(format!("{}.toml", source.name));
    std::fs::write(&case_file, &text)?;
    let case = parse_case(&text, &case_file.display().to_string(), folder).map_err(one_error)?;
    Ok((case, case_file))
}
