//! Runs of the cases of a suite over clouds of nodes.

use super::read::{Suite, SuiteCase};
use super::study::{CaseRuns, case_study};
use crate::lab::store::{Job, RunRecord, Task, TaskRunner};
use anyhow::Result;
use mtled_case::scene::{Knob, Setting};
use mtled_checks::study::Study;

impl Suite {
    /// A study per case whose name contains `only`, on each cloud \[cloud\]\[case\]; cloud 0 is
    /// that of the case file.
    pub fn studies(
        &self,
        only: &str,
        clouds: std::ops::Range<u64>,
        runner: &TaskRunner,
    ) -> Result<Vec<Vec<Study>>> {
        let cases: Vec<&SuiteCase> =
            self.cases.iter().filter(|case| case.source.name.contains(only)).collect();
        let mut tasks = Vec::new();
        for cloud in clouds.clone() {
            for case in &cases {
                tasks.extend(case.tasks(cloud)?);
            }
        }
        let mut records = runner.records(&tasks)?.into_iter();
        let mut next = |case: &SuiteCase| -> Option<Study> {
            let solve: RunRecord = records.next()?;
            let patch = if case.patch { records.next() } else { None };
            Some(case_study(self, case, &CaseRuns { solve, patch }))
        };
        Ok(clouds.map(|_| cases.iter().filter_map(|case| next(case)).collect()).collect())
    }
}

impl SuiteCase {
    /// The run of the case on a cloud and, if it is wanted, the affine patch test there.
    fn tasks(&self, cloud: u64) -> Result<Vec<Task>> {
        let settings: Vec<Setting> = match cloud {
            0 => Vec::new(),
            cloud => vec![Setting::number(Knob::Cloud, cloud as f64)],
        };
        let task = |job: Job, times: Vec<f64>| {
            let (source, settings) = (self.source.clone(), settings.clone());
            Task { job, source, settings, times }
        };
        let mut tasks = vec![task(Job::Solve, self.times()?)];
        if self.patch {
            tasks.push(task(Job::Patch, Vec::new()));
        }
        Ok(tasks)
    }
}
