//! Progress of `mtled verify`: a bar with the time left on a terminal, otherwise a line per
//! study.

use crate::cli::common::Common;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mtled_checks::study::{Report, Study};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Largest fraction of a study that counts as done while it runs \[–\].
const LARGEST_FRACTION: f64 = 0.95;

pub(crate) struct Progress {
    common: Common,
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
    /// `earlier` is a report with the time that each study took.
    pub(crate) fn new(studies: &[&str], earlier: Option<&Report>, common: &Common) -> Progress {
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
        Progress { common: *common, bar, lines, count: studies.len(), state }
    }

    pub(crate) fn begin(&self, id: &str) {
        self.lock().running.insert(id.to_string(), Instant::now());
    }

    pub(crate) fn end(&self, study: &Study) {
        let mut state = self.lock();
        state.running.remove(&study.id);
        state.done += state.weights.get(&study.id).copied().unwrap_or(0.0);
        state.finished += 1;
        let finished = state.finished;
        drop(state);
        let line =
            format!("[{finished}/{}] {} ({:.1} s)", self.count, study.title, study.wall_seconds);
        if self.lines {
            self.common.note(&line);
        } else {
            self.bar.println(line);
        }
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, State> {
        lock(&self.state)
    }
}

/// A bar of a thousand parts that is redrawn regularly.
fn drawn(state: &Arc<Mutex<State>>) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr_with_hz(5));
    let template = "{bar:40} {percent_done:>5}  {msg}  {left}";
    let (done, left) = (state.clone(), state.clone());
    let style = ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key(
            "percent_done",
            move |_: &indicatif::ProgressState, out: &mut dyn std::fmt::Write| {
                let _ = write!(out, "{:.0} %", 100.0 * lock(&done).fraction());
            },
        )
        .with_key("left", move |_: &indicatif::ProgressState, out: &mut dyn std::fmt::Write| {
            if let Some(seconds) = lock(&left).seconds_left() {
                let _ = write!(out, "{seconds:.0} s left");
            }
        });
    bar.set_style(style);
    let (weak, state) = (bar.downgrade(), state.clone());
    std::thread::spawn(move || {
        while let Some(bar) = weak.upgrade().filter(|bar| !bar.is_finished()) {
            let state = lock(&state);
            let fraction = state.fraction();
            let running = state.running.keys().cloned().collect::<Vec<_>>().join(", ");
            // Drawing locks the state again.
            drop(state);
            bar.set_position((1000.0 * fraction) as u64);
            bar.set_message(running);
            std::thread::sleep(Duration::from_millis(250));
        }
    });
    bar
}

/// The state is valid even if a study has panicked, which ends the run.
fn lock(state: &Mutex<State>) -> std::sync::MutexGuard<'_, State> {
    state.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

impl State {
    /// Fraction that is done; running studies count by their expected time \[–\].
    fn fraction(&self) -> f64 {
        let total: f64 = self.weights.values().sum();
        let part = |(id, since): (&String, &Instant)| {
            let weight = self.weights.get(id).copied().unwrap_or(0.0);
            if self.known {
                since.elapsed().as_secs_f64().min(LARGEST_FRACTION * weight)
            } else {
                0.0
            }
        };
        let running: f64 = self.running.iter().map(part).sum();
        if total > 0.0 { ((self.done + running) / total).min(1.0) } else { 1.0 }
    }

    /// Expected time left \[s\]; none before anything is done.
    fn seconds_left(&self) -> Option<f64> {
        let fraction = self.fraction();
        let elapsed = self.start.elapsed().as_secs_f64();
        (fraction > 0.0).then(|| elapsed * (1.0 - fraction) / fraction)
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
        let fraction = state(true).fraction();
        assert!((fraction - (30.0 + 9.5) / 40.0).abs() < 1e-12, "{fraction}");
        assert_eq!(state(false).fraction(), 0.75);
    }

    #[test]
    fn the_time_left_follows_from_the_time_taken() {
        let left = state(false).seconds_left().unwrap();
        assert!((left - 20.0 / 3.0).abs() < 0.1, "{left}");
        assert!(State { done: 0.0, ..state(false) }.seconds_left().is_none());
    }
}
