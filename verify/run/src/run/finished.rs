//! A run with all that its files are written from.

use super::audit::{audit_json, audit_line};
use super::error_bar::{Estimated, error_bars};
use super::output::{body_at_end, write_failed, write_outputs};
use super::record::{Recorder, Recording};
use super::result::{outcome_of, result_json, summary_text};
use super::solved::Solved;
use crate::machine::cpu_seconds;
use crate::picture::Body;
use anyhow::Result;
use mtled::Simulation;
use mtled::audit::Audit;
use mtled::error::Error;
use mtled::model::contact::ContactResult;
use mtled::motion::observe::Continue;
use mtled_case::scene::Case;
use serde_json::{Value, json};
use std::path::Path;

/// A run that came to its end, or that the user has stopped.
#[derive(Debug)]
pub struct Finished {
    /// The model and the state at the end.
    pub solved: Solved,
    /// Samples and frames.
    pub record: Recording,
    /// What each obstacle does at the end.
    pub contacts: Vec<ContactResult>,
    /// Error bars, unless they were left out.
    pub bars: Option<Estimated>,
    /// What was asked beside what was done; nothing of a run that the user has stopped.
    pub audit: Option<Audit>,
    /// Processor time of the audit \[s\].
    pub audit_seconds: f64,
}

/// A run that ended with an error.
#[derive(Debug)]
pub struct Failed {
    /// Why.
    pub error: Error,
    /// The model, and the last state that it reached.
    pub simulation: Simulation,
    /// Samples and frames up to the last good one.
    pub record: Recording,
}

/// Runs a case as `mtled solve` does; `report(progress, step)` can end it.
pub fn solve_recorded(
    case: &Case,
    simulation: Simulation,
    with_bars: bool,
    report: &dyn Fn(f64, usize) -> Continue,
) -> Result<Finished, Box<Failed>> {
    let failed = |error, simulation, record| Box::new(Failed { error, simulation, record });
    // Coarser clouds have no state to go on from.
    let with_bars = with_bars && !simulation.is_continued();
    let mut recorder = match Recorder::new(case, &simulation, case.outputs.frames) {
        Ok(recorder) => recorder.with_progress(report),
        Err(error) => return Err(failed(error, simulation, Recording::default())),
    };
    let solution = Solved::of(simulation, &mut recorder);
    let mut record = recorder.finish();
    record.unstable_mode = match &solution {
        Ok(solved) => solved.summary.instability.as_ref(),
        Err(ended) => ended.0.instability(),
    }
    .map(|found| found.mode.clone());
    let solved = match solution {
        Ok(solved) => solved,
        Err(ended) => return Err(failed(ended.0, ended.1, record)),
    };
    let (contacts, audit, audit_seconds) = match compared(&solved) {
        Ok(compared) => compared,
        Err(error) => return Err(failed(error, solved.simulation, record)),
    };
    let bars = with_bars.then(|| error_bars(case, &solved, &record, !record.frames.is_empty()));
    Ok(Finished { solved, record, contacts, bars, audit, audit_seconds })
}

/// What obstacles do, the audit, unless the user stopped the run before its end, and the processor
/// time of the audit \[s\].
fn compared(solved: &Solved) -> Result<(Vec<ContactResult>, Option<Audit>, f64), Error> {
    let contacts = solved.simulation.contact_results()?;
    let cpu = cpu_seconds();
    let audit = (!solved.summary.stopped).then(|| solved.simulation.audit()).transpose()?;
    Ok((contacts, audit, cpu_seconds() - cpu))
}

impl Finished {
    /// `result.json`.
    pub fn json(&self, case: &Case) -> Value {
        let bars = self.bars.as_ref();
        let mut result = result_json(case, &self.solved, &self.record, &self.contacts, bars);
        if let Some(audit) = &self.audit {
            result["audit"] = audit_json(audit);
            result["timings"]["audit_cpu_s"] = json!(self.audit_seconds);
        }
        result
    }

    /// The main results, a line each.
    pub fn text(&self, case: &Case) -> String {
        let bars = self.bars.as_ref();
        let text = summary_text(case, &self.solved, &self.record, &self.contacts, bars);
        match &self.audit {
            Some(audit) => format!("{text}\n{}", audit_line(audit)),
            None => text,
        }
    }

    /// The body at the end with its fields, if the case has frames.
    pub fn body(&self, case: &Case) -> Result<Option<Body>> {
        let indicator = self.bars.as_ref().and_then(|bars| bars.as_ref().ok()?.indicator.as_ref());
        body_at_end(case, &self.solved.simulation, &self.record, indicator)
    }

    /// Writes all files of the run to `dir` and returns the text of `result.json`.
    pub fn write(&self, case: &Case, dir: &Path) -> Result<String> {
        let indicator = self.bars.as_ref().and_then(|bars| bars.as_ref().ok()?.indicator.as_ref());
        write_outputs(case, &self.solved, &self.record, indicator, &self.json(case), dir)
    }
}

impl Failed {
    /// Whether the run was refused before its first step.
    pub fn has_not_begun(&self) -> bool {
        let refused = matches!(self.error, Error::UnstableStep { .. } | Error::NoTimeStep { .. });
        refused || self.record.samples.is_empty()
    }

    /// How it ended, as in `result.json`: not_converged, diverged or failed.
    pub fn outcome(&self) -> &'static str {
        outcome_of(&self.error)
    }

    /// Writes what the run had recorded to `dir` and returns the text of `result.json`.
    pub fn write(&self, case: &Case, dir: &Path) -> Result<String> {
        write_failed(case, &self.simulation, &self.record, &self.error, dir)
    }
}
