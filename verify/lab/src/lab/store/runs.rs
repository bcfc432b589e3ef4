//! Many runs, several at a time, each on one thread.

use super::disk::Store;
use super::jobs::JobPlan;
use super::perform::{Performed, perform};
use super::record::RunRecord;
use super::task::Task;
use anyhow::{Context, Result};
use mtled_run::run::interrupted;
use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How many of several runs are done.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    /// Runs that are done.
    pub done: usize,
    /// All runs.
    pub of: usize,
    /// Whether the last one was stored already.
    pub stored: bool,
    /// Case and settings of the last one.
    pub label: &'a str,
}

/// The user has stopped a series of runs; those that are done are stored.
#[derive(Debug, thiserror::Error)]
#[error(
    "stopped after {done} of {of} runs; these are stored, and the same command continues there"
)]
pub struct Stopped {
    /// Runs that are done.
    pub done: usize,
    /// All runs.
    pub of: usize,
}

/// Runs tasks that are not stored yet.
#[derive(Clone, Copy)]
pub struct TaskRunner<'a> {
    /// Where records are read and written.
    pub store: &'a Store,
    /// Called after each run.
    pub notify: &'a (dyn Fn(Progress) + Sync),
    /// Where runs are planned instead of being performed here.
    pub plan: Option<&'a JobPlan>,
}

impl TaskRunner<'_> {
    /// The records of `tasks`, in their order. Tasks that are not in the store are run, as
    /// many at a time as there are threads, each on one thread so that its CPU time is its
    /// own. Equal tasks are run once. With a plan, tasks that are not in the store are planned,
    /// and the error is [`Planned`](super::Planned).
    pub fn records(&self, tasks: &[Task]) -> Result<Vec<RunRecord>> {
        let (mut different, mut places) = (Vec::new(), HashMap::new());
        let mut order = Vec::with_capacity(tasks.len());
        for task in tasks {
            if interrupted() {
                return Err(Stopped { done: 0, of: tasks.len() }.into());
            }
            let key = task.key().with_context(|| task.label())?;
            order.push(*places.entry(key.clone()).or_insert_with(|| {
                different.push((key, task));
                different.len() - 1
            }));
        }
        if let Some(plan) = self.plan {
            self.plan_missing(plan, &different)?;
        }
        let records = self.different(&different)?;
        // A record may have been made for a case of another name, or for other words that
        // mean the same.
        let label = |(place, task): (usize, &Task)| RunRecord {
            case: task.source.name.clone(),
            overrides: task.source.case.overrides().to_vec(),
            settings: task.settings.clone(),
            ..records[place].clone()
        };
        Ok(order.into_iter().zip(tasks).map(label).collect())
    }

    fn plan_missing(&self, plan: &JobPlan, tasks: &[(String, &Task)]) -> Result<()> {
        let mut missing = Vec::new();
        for (key, task) in tasks {
            if self.store.find(key)?.is_none() {
                missing.push((key.clone(), *task));
            }
        }
        if missing.is_empty() {
            plan.clear()
        } else {
            Err(plan.write(&missing, self.store)?.into())
        }
    }

    /// The records of tasks with different keys.
    fn different(&self, tasks: &[(String, &Task)]) -> Result<Vec<RunRecord>> {
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let slots: Vec<Mutex<Option<RunRecord>>> = tasks.iter().map(|_| Mutex::default()).collect();
        let work = || -> Result<()> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let next = tasks.get(index).filter(|_| !interrupted());
                let Some((key, task)) = next else { return Ok(()) };
                let label = task.label();
                let result = pool.install(|| record(self.store, key, task));
                let Some((record, stored)) = result.with_context(|| label.clone())? else {
                    return Ok(());
                };
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                (self.notify)(Progress { done, of: tasks.len(), stored, label: &label });
                if let Ok(mut slot) = slots[index].lock() {
                    *slot = Some(record);
                }
            }
        };
        let results: Vec<Result<()>> = std::thread::scope(|scope| {
            let workers: Vec<_> =
                (0..rayon::current_num_threads()).map(|_| scope.spawn(work)).collect();
            let joined = workers.into_iter().map(|worker| worker.join());
            joined.map(|end| end.unwrap_or_else(|p| std::panic::resume_unwind(p))).collect()
        });
        results.into_iter().collect::<Result<()>>()?;
        let records: Vec<RunRecord> =
            slots.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect();
        if records.len() < tasks.len() {
            return Err(Stopped { done: records.len(), of: tasks.len() }.into());
        }
        Ok(records)
    }
}

/// The record of a task and whether it was stored before; none where the user has
/// stopped the run.
fn record(store: &Store, key: &str, task: &Task) -> Result<Option<(RunRecord, bool)>> {
    if let Some(record) = store.find(key)? {
        return Ok(Some((record, true)));
    }
    let Some(Performed { mut record, lasts }) = perform(task)? else { return Ok(None) };
    record.key = key.to_string();
    if lasts {
        store.write(&record)?;
    }
    Ok(Some((record, false)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::store::{Job, Source};
    use mtled_case::scene::{Knob, Setting};

    #[test]
    fn equal_tasks_are_run_once_and_each_gets_the_record() {
        let folder = tempfile::tempdir().unwrap();
        let source = Source::find("uniaxial_bar", folder.path(), &[]).unwrap();
        let task = |spacing: &str| Task {
            job: Job::Consistency,
            source: source.clone(),
            settings: vec![Setting::word(Knob::Spacing, spacing)],
            times: Vec::new(),
        };
        let store = Store::new(&folder.path().join("runs"));
        let counted = Mutex::new(Vec::new());
        let notify = |progress: Progress| {
            counted.lock().unwrap().push((progress.of, progress.stored));
        };
        let runner = TaskRunner { store: &store, notify: &notify, plan: None };
        let tasks = [task("x2"), task("x1.6"), task("x2"), task("x2.0"), task("x2")];
        let records = runner.records(&tasks).unwrap();
        assert_eq!(*counted.lock().unwrap(), [(2, false); 2]);
        assert_eq!(records.len(), 5);
        assert!([2, 3, 4].iter().all(|&n| records[n].outcome == records[0].outcome));
        assert!(records[0].outcome != records[1].outcome);
        let settings = |record: &RunRecord| record.settings.clone();
        assert!(records.iter().map(settings).eq(tasks.iter().map(|task| task.settings.clone())));
    }
}
