//! Many runs, several at a time, each on one thread.

use super::disk::Store;
use super::perform::perform;
use super::record::RunRecord;
use super::task::Task;
use crate::run::interrupted;
use anyhow::{Context, Result};
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
}

impl TaskRunner<'_> {
    /// The records of `tasks`, in their order. Tasks that are not in the store are run, as
    /// many at a time as there are threads, each on one thread so that its CPU time is its
    /// own.
    pub fn records(&self, tasks: &[Task]) -> Result<Vec<RunRecord>> {
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let slots: Vec<Mutex<Option<RunRecord>>> = tasks.iter().map(|_| Mutex::default()).collect();
        let work = || -> Result<()> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(task) = tasks.get(index).filter(|_| !interrupted()) else { return Ok(()) };
                let label = task.label();
                let result = pool.install(|| record(self.store, task));
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
fn record(store: &Store, task: &Task) -> Result<Option<(RunRecord, bool)>> {
    let key = task.key()?;
    if let Some(record) = store.find(&key)? {
        return Ok(Some((record, true)));
    }
    let Some(mut record) = perform(task)? else { return Ok(None) };
    record.key = key;
    store.write(&record)?;
    Ok(Some((record, false)))
}
