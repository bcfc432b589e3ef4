//! Many runs, several at a time, each on one thread.

use super::disk::Store;
use super::jobs::perform;
use super::record::Record;
use super::task::Task;
use crate::run::interrupted;
use anyhow::{Context, Result};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How far many runs have come.
#[derive(Debug, Clone, Copy)]
pub struct Progress<'a> {
    pub done: usize,
    pub of: usize,
    /// Whether the last one was on record already.
    pub known: bool,
    /// The last one, in words.
    pub words: &'a str,
}

/// The user has stopped many runs; what was done is on record.
#[derive(Debug, thiserror::Error)]
#[error(
    "stopped after {done} of {of} runs; they are on record, and the same command goes on from there"
)]
pub struct Stopped {
    pub done: usize,
    pub of: usize,
}

/// The records of `tasks`, in their order; those that are not in the store yet are
/// run, as many at a time as there are threads, each on one thread so that its CPU
/// time can be told.
pub fn perform_all(
    store: &Store,
    tasks: &[Task],
    say: &(dyn Fn(Progress) + Sync),
) -> Result<Vec<Record>> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let slots: Vec<Mutex<Option<Record>>> = tasks.iter().map(|_| Mutex::default()).collect();
    let work = || -> Result<()> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(task) = tasks.get(index).filter(|_| !interrupted()) else { return Ok(()) };
            let words = task.words();
            let found = pool.install(|| one(store, task)).with_context(|| words.clone())?;
            let Some((record, known)) = found else { return Ok(()) };
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            say(Progress { done, of: tasks.len(), known, words: &words });
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
    let records: Vec<Record> =
        slots.into_iter().filter_map(|slot| slot.into_inner().ok().flatten()).collect();
    if records.len() < tasks.len() {
        return Err(Stopped { done: records.len(), of: tasks.len() }.into());
    }
    Ok(records)
}

/// The record of a task and whether it was there before; none where the user has
/// stopped the run.
fn one(store: &Store, task: &Task) -> Result<Option<(Record, bool)>> {
    let key = task.key()?;
    if let Some(record) = store.find(&key)? {
        return Ok(Some((record, true)));
    }
    let Some(mut record) = perform(task)? else { return Ok(None) };
    record.key = key;
    store.keep(&record)?;
    Ok(Some((record, false)))
}
