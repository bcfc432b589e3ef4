//! Progress bars on a terminal, and a line of progress now and then elsewhere.

use super::common::{Common, STOPPED};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use mtled_checks::escape::printable;
use mtled_lab::lab::store::{Planned, Progress, Stopped};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Shortest time between lines of progress.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// A bar of `length` parts; hidden where standard error is not a terminal.
fn bar(common: &Common, length: u64, template: &str) -> ProgressBar {
    if !common.draws() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr_with_hz(10));
    let style = ProgressStyle::with_template(template);
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar
}

/// The bar of a single run, of a thousand parts.
pub(crate) fn progress_bar(common: &Common) -> ProgressBar {
    bar(common, 1000, "{bar:40} {percent:>3} %  {msg}  {eta} left")
}

/// Progress of many runs.
pub(crate) struct ManyRuns {
    common: Common,
    bar: ProgressBar,
    /// When the last line was written; none where no lines are.
    lines: Option<Mutex<Instant>>,
}

impl ManyRuns {
    pub(crate) fn new(common: &Common) -> ManyRuns {
        let bar = bar(common, 1, "{bar:30} {pos}/{len} runs  {eta} left  {msg}");
        let lines = (!common.quiet && !common.draws()).then(|| Mutex::new(Instant::now()));
        ManyRuns { common: *common, bar, lines }
    }

    pub(crate) fn show(&self, progress: Progress) {
        self.bar.set_length(progress.of as u64);
        self.bar.set_position(progress.done as u64);
        if progress.stored {
            // A stored run takes no time and must not count for the time left.
            self.bar.reset_eta();
        }
        self.bar.set_message(printable(progress.label));
        let Some(Ok(mut last)) = self.lines.as_ref().map(Mutex::lock) else { return };
        if last.elapsed() > BETWEEN_LINES {
            let label = printable(progress.label);
            self.common.note(&format!("{} of {} runs: {label}", progress.done, progress.of));
            *last = Instant::now();
        }
    }

    /// Clears the bar. Ok(Err(exit code)) where the user stopped the runs, or where they are
    /// planned for other machines.
    pub(crate) fn finish<T>(&self, result: anyhow::Result<T>) -> anyhow::Result<Result<T, u8>> {
        self.bar.finish_and_clear();
        match result {
            Ok(result) => Ok(Ok(result)),
            Err(error) if error.is::<Stopped>() => {
                self.common.complain(error);
                Ok(Err(STOPPED))
            }
            // What was asked for: the workflow goes on from here.
            Err(error) if error.is::<Planned>() => {
                self.common.note(&error.to_string());
                Ok(Err(0))
            }
            Err(error) => Err(error),
        }
    }
}
