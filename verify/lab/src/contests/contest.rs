//! Every program on every case at every resolution.

use super::entrant::Entrant;
use super::problem::ContestCase;
use super::process::{Usage, run_child};
use super::results::{Machine, RESULTS, Results, StoredEnd, StoredRun};
use crate::lab::store::Source;
use anyhow::{Context, Result};
use mtled_case::protocol::{Job, Resolution};
use mtled_case::scene::{Case, one_error, parse_case, with_absolute_paths};
use mtled_run::machine::provenance;
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
    /// How often every run is made, with the median of its times.
    pub repetitions: usize,
}

/// How a run ended, and what it took if it has started.
type Run = (StoredEnd, Option<Usage>);

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
                let at = Resolution { spacing_m, level, levels, time_limit_s };
                let Some(ended) = self.at_resolution(case, at, &mut not_started, notify)? else {
                    return Ok(false);
                };
                for (runs, (ended, usage)) in runs.iter_mut().zip(ended) {
                    runs.push(StoredRun { spacing_m, ended, usage });
                }
            }
            for (entrant, runs) in self.entrants.iter().zip(runs) {
                keep(self.results(case, entrant, runs))?;
            }
        }
        Ok(true)
    }

    /// The run of every program, each of several by its time, the programs in turn. None where the
    /// user has stopped them.
    fn at_resolution(
        &self,
        case: &ContestCase,
        at: Resolution,
        not_started: &mut [Option<StoredEnd>],
        notify: &dyn Fn(&str),
    ) -> Result<Option<Vec<Run>>> {
        let mut rounds: Vec<Vec<Run>> = vec![Vec::new(); self.entrants.len()];
        for _ in 0..self.repetitions {
            for (n, entrant) in self.entrants.iter().enumerate() {
                if rounds[n].iter().any(|run| !is_reply(run)) {
                    continue;
                }
                notify(&format!("{}, level {}: {}", case.id, at.level, entrant.name));
                let run = match &not_started[n] {
                    Some(ended) => (ended.clone(), None),
                    None => match one_run(case, entrant, at)? {
                        Some(run) => run,
                        None => return Ok(None),
                    },
                };
                if run.1.is_none() {
                    not_started[n] = Some(run.0.clone());
                }
                rounds[n].push(run);
            }
        }
        Ok(Some(rounds.into_iter().filter_map(median).collect()))
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

/// Whether a run has ended with a file.
fn is_reply(run: &Run) -> bool {
    matches!(run.0, StoredEnd::Reply(_))
}

/// The run with the median CPU time, without what the program tells apart; one that has ended without
/// a file if there is one.
fn median(mut rounds: Vec<Run>) -> Option<Run> {
    if let Some(failed) = rounds.iter().position(|run| !is_reply(run)) {
        return Some(rounds.swap_remove(failed));
    }
    let spent = |run: &Run| {
        let apart = match &run.0 {
            StoredEnd::Reply(reply) => reply["apart_cpu_s"].as_f64(),
            _ => None,
        };
        run.1.map_or(0.0, |usage| usage.cpu_s) - apart.unwrap_or(0.0)
    };
    rounds.sort_by(|a, b| spent(a).total_cmp(&spent(b)));
    (!rounds.is_empty()).then(|| rounds.swap_remove((rounds.len() - 1) / 2))
}

/// One job in a folder of its own, without usage where the program does not start. None where the
/// user has stopped it.
fn one_run(case: &ContestCase, entrant: &Entrant, at: Resolution) -> Result<Option<Run>> {
    let folder = tempfile::tempdir().context("cannot make a folder for a run")?;
    let job = write_job(&case.source, folder.path(), at, &case.reference.times)?;
    let answer = folder.path().join("answer.json");
    let limit = Duration::from_secs_f64(at.time_limit_s);
    Ok(match run_child(&entrant.words(&job, &answer), limit) {
        Err(error) => Some((StoredEnd::not_started(&error), None)),
        Ok(run) => StoredEnd::of(&run, &answer).map(|ended| (ended, Some(run.usage))),
    })
}

/// Writes a job into a folder; returns its path.
fn write_job(source: &Source, folder: &Path, at: Resolution, instants: &[f64]) -> Result<PathBuf> {
    let job = Job::new(&absolute(source)?, at, instants);
    let job = job.map_err(|mistake| one_error(vec![mistake]))?;
    let path = folder.join("job.json");
    std::fs::write(&path, serde_json::to_string_pretty(&job)? + "\n")?;
    Ok(path)
}

/// The case with absolute names of other files.
pub fn absolute(source: &Source) -> Result<Case> {
    let base = source.file.parent().unwrap_or(Path::new("."));
    let text = with_absolute_paths(source.case.text(), base)?;
    parse_case(&text, &source.file.display().to_string(), base).map_err(one_error)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reply(cpu_s: f64, apart_cpu_s: f64) -> Run {
        let reply = serde_json::json!({"apart_cpu_s": apart_cpu_s});
        let usage = Usage { cpu_s, wall_s: cpu_s, peak_memory_bytes: 2, least_memory_bytes: 1 };
        (StoredEnd::Reply(reply), Some(usage))
    }

    #[test]
    fn of_several_runs_the_one_with_the_median_time_of_the_solution_counts() {
        let rounds = vec![reply(9.0, 8.5), reply(3.0, 1.0), reply(2.0, 1.0)];
        assert_eq!(median(rounds), Some(reply(2.0, 1.0)));
    }

    #[test]
    fn a_run_that_has_failed_once_has_failed() {
        let late = (StoredEnd::TimedOut, None);
        assert_eq!(median(vec![reply(1.0, 0.0), late.clone()]), Some(late));
    }
}
