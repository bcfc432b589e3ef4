//! Runs the tasks of a study and builds its report.

use super::axis::refuse_too_many_runs;
use super::convergence::add_convergence;
use super::definition::{MeasuredCase, Sweep};
use super::reference::find_reference;
use super::subject::Subject;
use super::tables::{add_tables, timings};
use crate::lab::store::{Job, Task, TaskRunner};
use anyhow::{Result, bail};
use mtled_checks::study::Study;

impl Sweep {
    /// Runs only part `part` (from 1) of `parts`, without a report; returns the number of
    /// its runs.
    pub fn run_part(&self, runner: &TaskRunner, (part, parts): (usize, usize)) -> Result<usize> {
        refuse_too_many_runs(&self.axes, self.clouds)?;
        let tasks = self.all_tasks()?;
        let own: Vec<Task> = tasks.into_iter().skip(part - 1).step_by(parts).collect();
        runner.records(&own)?;
        Ok(own.len())
    }

    /// Every run of the study, those of its reference included.
    fn all_tasks(&self) -> Result<Vec<Task>> {
        let mut tasks = Vec::new();
        for source in &self.sources {
            let times = match self.subject.job() {
                Job::Solve => {
                    tasks.extend(self.reference.tasks(source, &self.axes));
                    self.reference.times(source)?
                }
                _ => Vec::new(),
            };
            tasks.extend(self.tasks(source, &times));
        }
        Ok(tasks)
    }

    /// Runs what is not stored yet and builds the study.
    pub fn run(&self, runner: &TaskRunner) -> Result<Study> {
        refuse_too_many_runs(&self.axes, self.clouds)?;
        if runner.plan.is_some() {
            // All at once, and not those of each case one after the other.
            runner.records(&self.all_tasks()?)?;
        }
        let mut cases = Vec::new();
        for source in &self.sources {
            let reference = match self.subject.job() {
                Job::Solve => Some(find_reference(&self.reference, source, &self.axes, runner)?),
                _ => None,
            };
            let times = reference.as_ref().map_or(Vec::new(), |known| known.times.clone());
            let records = runner.records(&self.tasks(source, &times))?;
            let reference = reference.and_then(|known| {
                let group = self.group.or_else(|| known.group(&source.case))?;
                Some((known, group))
            });
            if self.subject == Subject::Convergence && reference.is_none() {
                bail!("{}: has no probe and no support whose error can be measured", source.name);
            }
            cases.push(MeasuredCase { source: source.clone(), records, reference });
        }
        Ok(self.study(&cases))
    }

    fn study(&self, cases: &[MeasuredCase]) -> Study {
        let mut study = Study {
            id: self.subject.name().to_string(),
            title: self.subject.title().to_string(),
            claim: self.subject.claim().to_string(),
            command: self.command.clone(),
            ..Study::default()
        };
        for case in cases {
            match self.subject {
                Subject::Convergence => add_convergence(&mut study, self, case),
                _ => add_tables(&mut study, self, case),
            }
            study.tables.push(timings(self, case));
        }
        study.notes.push(format!(
            "{} per combination; cloud 0 is the case's own. Another cloud is made of a lattice by a \
             jitter of a tenth of the spacing, of a jittered cloud by another random seed, and of a \
             graded cloud by shifting the lattices from which its nodes are selected.",
            if self.clouds == 1 { "One cloud".into() } else { format!("{} clouds", self.clouds) }
        ));
        study
    }
}
