//! How benchmarks are measured.

use crate::notes::{Note, PAIRS, Pair, write_note};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use std::time::Duration;

/// Whether every benchmark is run once only, as a test.
pub fn smoke() -> bool {
    std::env::args().any(|argument| argument == "--test")
}

/// Settings of all benchmarks.
pub fn settings() -> Criterion {
    Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(3))
}

/// A pool of one thread.
pub fn one_thread() -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started")
}

/// A pool of all threads.
pub fn all_threads() -> ThreadPool {
    ThreadPoolBuilder::new().build().expect("threads can be started")
}

/// A group of benchmarks with their notes.
pub struct Group<'a> {
    tmp: &'static str,
    name: &'static str,
    criterion: BenchmarkGroup<'a, WallTime>,
    pairs: Vec<Pair>,
}

impl<'a> Group<'a> {
    /// A group of this name; `tmp` is the temporary folder that Cargo provides.
    pub fn new(criterion: &'a mut Criterion, tmp: &'static str, name: &'static str) -> Group<'a> {
        Group { tmp, name, criterion: criterion.benchmark_group(name), pairs: Vec::new() }
    }

    /// Takes fewer samples of calls that take long.
    pub fn of_long_calls(mut self) -> Group<'a> {
        self.criterion.sample_size(10);
        self
    }

    /// Measures calls of `work` from inside a pool, so that no call wakes its threads.
    pub fn measure<N: Note>(
        &mut self,
        name: &str,
        note: &N,
        pool: &ThreadPool,
        mut work: impl FnMut() + Send,
    ) {
        self.write(&[self.name, name], N::FILE, note);
        self.criterion.throughput(note.throughput());
        self.criterion.bench_function(name, |bencher| pool.install(|| bencher.iter(&mut work)));
    }

    /// States that two benchmarks that were measured one after the other are to be compared.
    pub fn pair(&mut self, label: &str, first: &str, second: &str) {
        let [label, first, second] = [label, first, second].map(str::to_string);
        self.pairs.push(Pair { label, first, second });
    }

    /// Ends the group.
    pub fn finish(self) {
        self.write(&[self.name], PAIRS, &self.pairs);
        self.criterion.finish();
    }

    /// Writes a note, but none on the small bodies of a smoke test beside what was measured.
    fn write(&self, benchmark: &[&str], file: &str, note: &impl Serialize) {
        if !smoke() {
            write_note(self.tmp, benchmark, file, note);
        }
    }
}
