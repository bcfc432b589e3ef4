//! An error bar on every answer of a run: the same case on coarser clouds, and what the
//! answers change by. How the factors were set, and how often they hold, is the study
//! `error_bars`.

mod bars;
mod coarser;
mod doubts;
mod estimate;
mod no_error_bar;
mod report;

pub use bars::{ErrorBar, ErrorBars, Estimated, Indicator};
pub use coarser::CoarserCloud;
pub use estimate::error_bars;
pub use no_error_bar::NoErrorBar;
pub use report::{error_bars_json, error_bars_text, no_bars_text, plus_minus};
