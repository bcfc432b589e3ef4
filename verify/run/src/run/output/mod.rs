//! Files of a run: VTU frames with their collections, histories as CSV, the displacement field,
//! `result.json`, a page for people.

mod body;
mod earlier;
mod frames;
mod history;
mod modes;
mod node_fields;
mod unloaded;
pub mod vtu;

use super::error_bar::Indicator;
use super::page::run_page;
use super::record::Recording;
use super::result::failed_json;
use super::saved_state::write_states;
use super::solved::Solved;
use super::stored_field::StoredField;
use crate::picture::Body;
use anyhow::Result;
use earlier::remove_earlier_run;
use mtled_case::scene::Case;

pub use earlier::PAGE_FILE;
pub(crate) use frames::body_at_end;
pub use frames::last_body_frame;
pub use history::history;
pub(crate) use modes::write_modes;
pub use node_fields::field_at_nodes;
pub use unloaded::write_unloaded;

use frames::write_frames;
use history::history_csv;
use mtled::Simulation;
use mtled::error::Error;
use mtled_checks::escape::printable_json;
use mtled_checks::report::write_atomically;
use serde_json::Value;
use std::path::Path;

/// Writes all files of a run with this `result.json` to `dir`, and returns its text.
pub(crate) fn write_outputs(
    case: &Case,
    solved: &Solved,
    record: &Recording,
    indicator: Option<&Indicator>,
    result: &Value,
    dir: &Path,
) -> Result<String> {
    let body = write_recorded(case, &solved.simulation, record, indicator, dir)?;
    let (u, stopped) = (&solved.simulation.state.displacement, solved.summary.stopped);
    StoredField::new(case, &solved.simulation, u, stopped).write(dir)?;
    write_result(case, record, body.as_ref(), result, dir)
}

/// Writes what a run had recorded when it ended with an error.
pub(crate) fn write_failed(
    case: &Case,
    simulation: &Simulation,
    record: &Recording,
    error: &Error,
    dir: &Path,
) -> Result<String> {
    let body = write_recorded(case, simulation, record, None, dir)?;
    write_result(case, record, body.as_ref(), &failed_json(case, simulation, record, error), dir)
}

/// Writes the page and `result.json`, and returns the text of the latter.
fn write_result(
    case: &Case,
    record: &Recording,
    body: Option<&Body>,
    result: &Value,
    dir: &Path,
) -> Result<String> {
    let page = run_page(case, record, body, result)?;
    write_atomically(&dir.join(PAGE_FILE), page.as_bytes())?;
    let text = printable_json(&serde_json::to_string_pretty(result)?) + "\n";
    write_atomically(&dir.join("result.json"), text.as_bytes())?;
    Ok(text)
}

/// Writes the recording, which a failed run has too. The files of an earlier run are taken
/// away first and the collections are written last, so that they never name frames of two runs.
/// Returns the body at the end.
fn write_recorded(
    case: &Case,
    simulation: &Simulation,
    record: &Recording,
    indicator: Option<&Indicator>,
    dir: &Path,
) -> Result<Option<Body>> {
    remove_earlier_run(dir)?;
    let frames = write_frames(case, simulation, record, indicator, dir)?;
    write_atomically(&dir.join("history.csv"), history_csv(case, record)?.as_bytes())?;
    write_states(&record.states, dir)?;
    frames.write_collections(case, dir)?;
    Ok(frames.last)
}
