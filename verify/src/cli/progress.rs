//! Progress of many runs: a bar with the time left on a terminal, a line now and then
//! elsewhere.

use crate::cli::Common;
use crate::cli::sweep::stopped;
use crate::explore::store::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Lines of a log come no closer than this.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

pub struct ManyRuns {
    bar: ProgressBar,
    /// When the last line was written; none where nothing is.
    lines: Option<Mutex<Instant>>,
}

impl ManyRuns {
    pub fn new(common: &Common) -> ManyRuns {
        let bar = match common.draws() {
            false => ProgressBar::hidden(),
            true => ProgressBar::with_draw_target(Some(1), ProgressDrawTarget::stderr_with_hz(10)),
        };
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} runs  {eta} left  {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        let lines = (!common.quiet && !common.draws()).then(|| Mutex::new(Instant::now()));
        ManyRuns { bar, lines }
    }

    pub fn show(&self, progress: Progress) {
        self.bar.set_length(progress.of as u64);
        if progress.known {
            // What was on record takes no time and must not count for the time left.
            self.bar.set_position(progress.done as u64);
            self.bar.reset_eta();
        } else {
            self.bar.set_position(progress.done as u64);
        }
        self.bar.set_message(progress.words.to_string());
        let Some(Ok(mut last)) = self.lines.as_ref().map(Mutex::lock) else { return };
        if last.elapsed() > BETWEEN_LINES {
            eprintln!("{} of {} runs: {}", progress.done, progress.of, progress.words);
            *last = Instant::now();
        }
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Clears the bar; the exit code of what was stopped, or the error.
    pub fn give_up(&self, error: anyhow::Error) -> anyhow::Result<u8> {
        self.finish();
        stopped(error)
    }
}
