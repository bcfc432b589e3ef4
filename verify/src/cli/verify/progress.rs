//! How far `mtled verify` is: a bar with the time left on a terminal, else a
//! line per study.

use crate::cli::Common;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mtled_checks::study::{Report, Study};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Share of a study that is believed done for as long as it runs \[–\].
const ALMOST: f64 = 0.95;

pub struct Progress {
    bar: ProgressBar,
    lines: bool,
    count: usize,
    state: Arc<Mutex<State>>,
}

struct State {
    start: Instant,
    /// Expected seconds of every study, or 1 for each where none is known.
    weights: BTreeMap<String, f64>,
    known: bool,
    running: BTreeMap<String, Instant>,
    done: f64,
    finished: usize,
}

impl Progress {
    /// `earlier` tells how long each study took.
    pub fn new(studies: &[&str], earlier: Option<&Report>, common: &Common) -> Progress {
        let of = |id: &str| {
            let study = earlier?.studies.iter().find(|study| study.id == id)?;
            Some(study.wall_seconds).filter(|seconds| *seconds > 0.0)
        };
        let known = studies.iter().all(|id| of(id).is_some());
        let weight = |id: &&str| (id.to_string(), of(id).filter(|_| known).unwrap_or(1.0));
        let state = Arc::new(Mutex::new(State {
            start: Instant::now(),
            weights: studies.iter().map(weight).collect(),
            known,
            running: BTreeMap::new(),
            done: 0.0,
            finished: 0,
        }));
        let bar = if common.draws() { drawn(&state) } else { ProgressBar::hidden() };
        let lines = !common.quiet && !common.draws();
        Progress { bar, lines, count: studies.len(), state }
    }

    pub fn begin(&self, id: &str) {
        self.lock().running.insert(id.to_string(), Instant::now());
    }

    pub fn end(&self, study: &Study) {
        let mut state = self.lock();
        state.running.remove(&study.id);
        state.done += state.weights.get(&study.id).copied().unwrap_or(0.0);
        state.finished += 1;
        let finished = state.finished;
        drop(state);
        let line =
            format!("[{finished}/{}] {} ({:.1} s)", self.count, study.title, study.wall_seconds);
        if self.lines {
            eprintln!("{line}");
        } else {
            self.bar.println(line);
        }
    }

    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        peek(&self.state)
    }
}

/// A bar of a thousand parts that is redrawn as time passes.
fn drawn(state: &Arc<Mutex<State>>) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(5));
    let template = "{bar:40} {share:>5}  {msg}  {left}";
    let share = state.clone();
    let left = state.clone();
    let style = ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("share", move |_: &indicatif::ProgressState, out: &mut dyn std::fmt::Write| {
            let _ = write!(out, "{:.0} %", 100.0 * peek(&share).share());
        })
        .with_key("left", move |_: &indicatif::ProgressState, out: &mut dyn std::fmt::Write| {
            if let Some(seconds) = peek(&left).seconds_left() {
                let _ = write!(out, "{seconds:.0} s left");
            }
        });
    bar.set_style(style);
    let (weak, seen) = (bar.downgrade(), state.clone());
    std::thread::spawn(move || {
        while let Some(bar) = weak.upgrade().filter(|bar| !bar.is_finished()) {
            let state = peek(&seen);
            let share = state.share();
            let running = state.running.keys().cloned().collect::<Vec<_>>().join(", ");
            // Drawing asks for the state again.
            drop(state);
            bar.set_position((1000.0 * share) as u64);
            bar.set_message(running);
            std::thread::sleep(Duration::from_millis(250));
        }
    });
    bar
}

/// A study that panics ends the run; what it left of the bar is sound.
fn peek(state: &Mutex<State>) -> std::sync::MutexGuard<'_, State> {
    state.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl State {
    /// Done, and of what runs as much as its expected time says.
    fn share(&self) -> f64 {
        let total: f64 = self.weights.values().sum();
        let part = |(id, since): (&String, &Instant)| {
            let weight = self.weights.get(id).copied().unwrap_or(0.0);
            if self.known { since.elapsed().as_secs_f64().min(ALMOST * weight) } else { 0.0 }
        };
        let running: f64 = self.running.iter().map(part).sum();
        if total > 0.0 { ((self.done + running) / total).min(1.0) } else { 1.0 }
    }

    /// None before anything is done.
    fn seconds_left(&self) -> Option<f64> {
        let share = self.share();
        let elapsed = self.start.elapsed().as_secs_f64();
        (share > 0.0).then(|| elapsed * (1.0 - share) / share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(known: bool) -> State {
        let weights = [("a".to_string(), 30.0), ("b".to_string(), 10.0)].into();
        let start = Instant::now() - Duration::from_secs(20);
        let running = [("b".to_string(), start)].into();
        State { start, weights, known, running, done: 30.0, finished: 1 }
    }

    #[test]
    fn a_running_study_counts_by_its_expected_time_but_never_as_done() {
        let share = state(true).share();
        assert!((share - (30.0 + 9.5) / 40.0).abs() < 1e-12, "{share}");
        assert_eq!(state(false).share(), 0.75);
    }

    #[test]
    fn the_time_left_follows_from_the_time_taken() {
        let left = state(false).seconds_left().unwrap();
        assert!((left - 20.0 / 3.0).abs() < 0.1, "{left}");
        assert!(State { done: 0.0, ..state(false) }.seconds_left().is_none());
    }
}
