//! A run with all that its files are written from.

use super::audit::{audit_json, audit_line};
use super::contact::contact_results;
use super::error_bar::{Estimated, error_bars};
use super::output::{body_at_end, write_failed, write_outputs};
use super::prepare::Prepared;
use super::record::{Recorder, Recording};
use super::result::{outcome_of, result_json, summary_text};
use super::solve::{Solved, integrate_prepared};
use crate::machine::cpu_seconds;
use crate::picture::Body;
use anyhow::Result;
use mtled::audit::{Audit, audit};
use mtled::error::Error;
use mtled::model::contact::ContactResult;
use mtled::motion::observe::Continue;
use mtled::problem::Problem;
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
    /// The model.
    pub prepared: Prepared,
    /// Samples and frames up to the last good one.
    pub record: Recording,
}

/// Runs a prepared case as `mtled solve` does; `report(progress, step)` can end it.
pub fn solve_recorded(
    case: &Case,
    prepared: Prepared,
    with_bars: bool,
    report: &dyn Fn(f64, usize) -> Continue,
) -> Result<Finished, Box<Failed>> {
    let failed = |error, prepared, record| Box::new(Failed { error, prepared, record });
    let mut recorder = match Recorder::new(case, &prepared, case.outputs.frames) {
        Ok(recorder) => recorder.with_progress(report),
        Err(error) => return Err(failed(error, prepared, Recording::default())),
    };
    let solution = integrate_prepared(&case.problem, &prepared, &mut recorder);
    let mut record = recorder.finish();
    record.unstable_mode = match &solution {
        Ok(solution) => solution.summary.instability.as_ref(),
        Err(error) => error.instability(),
    }
    .map(|found| found.mode.clone());
    let solved = match solution {
        Ok(solution) => Solved::new(prepared, solution),
        Err(error) => return Err(failed(error, prepared, record)),
    };
    let contacts = match contact_results(&case.problem, &solved.prepared, &solved.state) {
        Ok(contacts) => contacts,
        Err(error) => return Err(failed(error, solved.prepared, record)),
    };
    let cpu = cpu_seconds();
    let audit = match audited(&case.problem, &solved) {
        Ok(audit) => audit,
        Err(error) => return Err(failed(error, solved.prepared, record)),
    };
    let audit_seconds = cpu_seconds() - cpu;
    // Coarser clouds have no state to go on from.
    let with_bars = with_bars && solved.prepared.start.is_none();
    let bars = with_bars.then(|| error_bars(case, &solved, &record, !record.frames.is_empty()));
    Ok(Finished { solved, record, contacts, bars, audit, audit_seconds })
}

/// What was asked beside what was done, unless the user stopped the run before its end.
fn audited(problem: &Problem, solved: &Solved) -> Result<Option<Audit>, Error> {
    let Solved { prepared, state, summary, .. } = solved;
    if summary.stopped {
        Ok(None)
    } else {
        audit(problem, &prepared.discretisation, &prepared.model, state).map(Some)
    }
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
        body_at_end(case, &self.solved.prepared, &self.record, indicator)
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
        write_failed(case, &self.prepared, &self.record, &self.error, dir)
    }
}
