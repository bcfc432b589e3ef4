//! Every program on every case at every resolution.

use super::doubt::{Doubt, about_series, wrong_units};
use super::entrant::Entrant;
use super::outcome::{Fault, Outcome, SolverRun};
use super::process::run_child;
use crate::accuracy::{Difference, Group, ReferenceSolution};
use crate::lab::store::Source;
use crate::protocol::{Answered, Job, Resolution, read_reply};
use crate::reference::quantities;
use crate::scene::{Case, one_error, parse_case, with_absolute_paths};
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

/// What to run.
#[derive(Debug)]
pub struct Contest {
    /// The programs.
    pub entrants: Vec<Entrant>,
    /// The cases.
    pub cases: Vec<ContestCase>,
    /// Of a run, on the clock \[s\].
    pub time_limit_s: f64,
    /// The command that runs this again.
    pub command: String,
}

/// A case with its reference solution.
#[derive(Debug)]
pub struct ContestCase {
    /// The case file.
    pub source: Arc<Source>,
    /// What answers are compared with.
    pub reference: ReferenceSolution,
    /// What is compared first.
    pub group: Group,
    /// Distances of nodes, from coarse to fine \[m\].
    pub spacings_m: Vec<f64>,
}

/// A distance of neighbouring nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spacing {
    /// Times that of the case \[–\].
    Factor(f64),
    /// \[m\]
    Metres(f64),
}

/// Why a text is no distance of nodes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a length in metres or a factor such as x1.4")]
pub struct NotASpacing(String);

impl FromStr for Spacing {
    type Err = NotASpacing;

    fn from_str(text: &str) -> Result<Spacing, NotASpacing> {
        let number = text.strip_prefix('x').unwrap_or(text);
        let value = number.parse::<f64>().ok().filter(|value| *value > 0.0 && value.is_finite());
        match (value, text.starts_with('x')) {
            (Some(value), true) => Ok(Spacing::Factor(value)),
            (Some(value), false) => Ok(Spacing::Metres(value)),
            (None, _) => Err(NotASpacing(text.to_string())),
        }
    }
}

/// All runs of a case.
#[derive(Debug)]
pub struct CaseRuns<'a> {
    /// The case.
    pub of: &'a ContestCase,
    /// \[program\]\[resolution\]
    pub runs: Vec<Vec<SolverRun>>,
}

impl ContestCase {
    /// A case with the reference solution that belongs to its problem: one of `files` (name,
    /// text), or the bundled one.
    pub fn new(
        source: Arc<Source>,
        files: &[(String, String)],
        spacings: &[Spacing],
    ) -> Result<ContestCase> {
        let case = &source.case;
        let own = files.iter().find(|(_, text)| text.contains(&case.problem_hash));
        let reference = match own {
            Some((name, text)) => Some(ReferenceSolution::from_file(case, text, name)?),
            None => ReferenceSolution::bundled(case),
        };
        let Some(reference) = reference else {
            bail!(
                "{}: there is no reference of this problem; name its file with --reference FILE",
                source.file.display()
            );
        };
        let group = reference.group(case);
        let group = group.with_context(|| format!("{} has nothing to compare", case.name))?;
        let spacings_m = ladder(&source, spacings)?;
        Ok(ContestCase { source, reference, group, spacings_m })
    }

    /// The error of an answer in a group; None where the answer or the reference lacks it.
    pub fn error(&self, group: Group, answered: &Answered) -> Option<Difference> {
        let case = &self.source.case;
        let all = quantities(case).into_iter().zip(&answered.values);
        let complete = all.filter(|(quantity, _)| group.holds(case, quantity));
        if complete.map(|(_, values)| values.is_some()).any(|given| !given) {
            return None;
        }
        let values: Vec<Vec<f64>> =
            answered.values.iter().map(|values| values.clone().unwrap_or_default()).collect();
        self.reference.difference(case, group, &values)
    }
}

/// Distances of nodes \[m\] of a case, which must go from coarse to fine.
fn ladder(source: &Source, spacings: &[Spacing]) -> Result<Vec<f64>> {
    let own = source.case.problem.recipe.spacing();
    let metres = spacings.iter().map(|spacing| match (spacing, own) {
        (Spacing::Metres(metres), _) => Ok(*metres),
        (Spacing::Factor(factor), Some(own)) => Ok(factor * own),
        (Spacing::Factor(_), None) => {
            bail!("{} has no spacing; give spacings in metres", source.file.display())
        }
    });
    let metres: Vec<f64> = metres.collect::<Result<_>>()?;
    if metres.windows(2).all(|pair| pair[0] > pair[1]) {
        Ok(metres)
    } else {
        bail!("spacings must go from coarse to fine")
    }
}

impl CaseRuns<'_> {
    /// The error of a run in the group that is compared first.
    pub fn error(&self, run: &SolverRun) -> Option<Difference> {
        self.of.error(self.of.group, run.outcome.answered()?)
    }

    /// What makes the answers of a program doubtful, each once.
    pub fn doubts(&self, entrant: usize) -> Vec<Doubt> {
        let runs = &self.runs[entrant];
        let answers = runs.iter().filter_map(|run| run.outcome.answered());
        let units = answers.map(|answer| wrong_units(answer, &self.of.reference.quantities));
        let mut errors = runs.iter().filter_map(|run| self.error(run));
        let differs = errors.any(|error| error.rms > error.bar);
        units.flatten().take(1).chain(about_series(runs, differs)).collect()
    }

    /// CPU time \[s\] and error \[–\] of the runs of a program, from coarse to fine; none where
    /// its answers are doubtful.
    pub fn costs(&self, entrant: usize) -> Vec<(f64, f64)> {
        if !self.doubts(entrant).is_empty() {
            return Vec::new();
        }
        let runs = self.runs[entrant].iter();
        runs.filter_map(|run| Some((run.cpu_s()?, self.error(run)?.rms))).collect()
    }
}

impl Contest {
    /// Runs everything, the programs in turn; `notify` is called before every run. None where
    /// the user has stopped it.
    pub fn run(&self, notify: &dyn Fn(&str)) -> Result<Option<Vec<CaseRuns<'_>>>> {
        let mut broken: Vec<Option<Outcome>> = vec![None; self.entrants.len()];
        let mut all = Vec::new();
        for case in &self.cases {
            let mut runs: Vec<Vec<SolverRun>> = vec![Vec::new(); self.entrants.len()];
            for (level, &spacing_m) in case.spacings_m.iter().enumerate() {
                let (levels, time_limit_s) = (case.spacings_m.len(), self.time_limit_s);
                let resolution = Resolution { spacing_m, level, levels, time_limit_s };
                for (n, entrant) in self.entrants.iter().enumerate() {
                    let label = &case.source.name;
                    notify(&format!("{label}, level {level}: {}", entrant.name));
                    let (outcome, usage) = match &broken[n] {
                        Some(outcome) => (outcome.clone(), None),
                        None => match one_run(case, entrant, resolution)? {
                            Some(ended) => ended,
                            None => return Ok(None),
                        },
                    };
                    if matches!(outcome, Outcome::Faulty(Fault::NotStarted { .. })) {
                        broken[n] = Some(outcome.clone());
                    }
                    runs[n].push(SolverRun { level, spacing_m, outcome, usage });
                }
            }
            all.push(CaseRuns { of: case, runs });
        }
        Ok(Some(all))
    }
}

type EndedRun = (Outcome, Option<super::process::Usage>);

/// One job in a folder of its own. None where the user has stopped it.
fn one_run(case: &ContestCase, entrant: &Entrant, at: Resolution) -> Result<Option<EndedRun>> {
    let folder = tempfile::tempdir().context("cannot make a folder for a run")?;
    let instants = &case.reference.times;
    let job = write_job(&case.source, folder.path(), at, instants)?;
    let answer = folder.path().join("answer.json");
    let limit = Duration::from_secs_f64(at.time_limit_s);
    let run = match run_child(&entrant.words(&job, &answer), limit) {
        Ok(run) => run,
        Err(error) => return Ok(Some((Outcome::not_started(&error), None))),
    };
    let reply = || read_reply(&answer, &case.source.case, instants.len());
    Ok(Outcome::of(&run, reply).map(|outcome| (outcome, Some(run.usage))))
}

/// Writes a job with its case file into a folder; returns its path.
fn write_job(
    source: &Source,
    folder: &Path,
    at: Resolution,
    instants: &[f64],
) -> Result<std::path::PathBuf> {
    let (case, case_file) = absolute(source, folder)?;
    let job = job_of(&case, &case_file, at, instants)?;
    let path = folder.join("job.json");
    std::fs::write(&path, serde_json::to_string_pretty(&job)? + "\n")?;
    Ok(path)
}

fn job_of(case: &Case, file: &Path, at: Resolution, instants: &[f64]) -> Result<Job> {
    Job::new(case, file, at, instants).map_err(|mistake| one_error(vec![mistake]))
}

/// The case with absolute names of other files, in a file of a folder.
pub fn absolute(source: &Source, folder: &Path) -> Result<(Case, std::path::PathBuf)> {
    let base = source.file.parent().unwrap_or(Path::new("."));
    let text = with_absolute_paths(source.case.text(), base)?;
    let case_file = folder.join(format!("{}.toml", source.name));
    std::fs::write(&case_file, &text)?;
    let case = parse_case(&text, &case_file.display().to_string(), folder).map_err(one_error)?;
    Ok((case, case_file))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spacing_is_a_length_or_a_factor() {
        assert_eq!("x1.4".parse(), Ok(Spacing::Factor(1.4)));
        assert_eq!("0.02".parse(), Ok(Spacing::Metres(0.02)));
        for text in ["", "x", "-1", "xnan", "0", "inf"] {
            assert!(text.parse::<Spacing>().is_err(), "{text}");
        }
    }
}
