//! An error bar on every answer of a run: the same case on coarser clouds, and what the
//! answers change by. How the factors were set, and how often they hold, is the study
//! `error_bars`.

mod bars;
mod coarser;
mod doubts;
mod estimate;
mod no_error_bar;
mod report;

pub(crate) use bars::Indicator;
pub use bars::{ErrorBar, Estimated};
pub use estimate::error_bars;
pub use no_error_bar::NoErrorBar;
pub(crate) use report::{error_bars_json, error_bars_text, no_bars_text, plus_minus};
