//! A new baseline, with the reason for it.

use super::band::{FALSE_ALARMS, around_mean, around_value, tail, without_scatter};
use super::baseline::{Baseline, Entry, GateError, SCHEMA_VERSION, Stored};
use super::clouds::Clouds;
use super::judge::{compare, stored};
use crate::study::{Band, Check, Comparison, Report, Scatter, Verdict};
use std::collections::BTreeMap;

/// Why a baseline is written; never empty.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reason(String);

impl Reason {
    /// The reason as one line.
    pub fn new(text: &str) -> Result<Reason, GateError> {
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        if text.is_empty() { Err(GateError::NoReason) } else { Ok(Reason(text)) }
    }
}

/// The baseline after this run. A figure inside its band keeps its line, so that many
/// small deteriorations cannot add up unnoticed; with `clouds` every line of the run is
/// replaced. `whole` as in [`compare`].
pub fn update(
    report: &Report,
    old: Option<&Baseline>,
    clouds: &Clouds,
    reason: &Reason,
    whole: bool,
) -> Result<Baseline, GateError> {
    refuse_failures(report)?;
    let before = old.cloned().unwrap_or_else(|| empty(report));
    let comparison = compare(report, &before, whole)?;
    let verdict = |id: &str| comparison.changes.iter().find(|c| c.id == id).map(|c| c.verdict);
    let kept = before.checks.into_iter().filter(|s| verdict(&s.id) != Some(Verdict::Missing));
    let mut lines: BTreeMap<String, Stored> = kept.map(|s| (s.id.clone(), s)).collect();
    let moved = report.checks().filter(|check| clouds.mean_and_scatter(check).is_some()).count();
    let known = lines.values().filter(|line| line.band.scatter.is_some()).count();
    let tail = tail(moved.max(known));
    for check in report.checks() {
        let line = lines.get(&check.id);
        let same = verdict(&check.id) == Some(Verdict::Same);
        let bound = line.is_some_and(|line| line.bound == check.bound);
        if same && bound && clouds.is_empty() {
            continue;
        }
        let known = line.and_then(|line| line.band.scatter);
        let line = stored(check, band_of(check, clouds, known, tail));
        lines.insert(check.id.clone(), line);
    }
    let p = &report.provenance;
    let mut history = before.history;
    history.push(Entry {
        date: p.date.clone(),
        commit: p.commit.clone(),
        processor: p.processor.clone(),
        reason: reason.0.clone(),
        changes: summary(&comparison, clouds),
    });
    Ok(Baseline { history, checks: lines.into_values().collect(), ..empty(report) })
}

fn refuse_failures(report: &Report) -> Result<(), GateError> {
    if report.bounds_hold() {
        return Ok(());
    }
    let failed = report.checks().filter(|check| !check.pass).count();
    let broken = report.studies.iter().filter(|study| study.failure.is_some()).count();
    Err(GateError::RunFails { failed, broken })
}

fn empty(report: &Report) -> Baseline {
    Baseline {
        schema_version: SCHEMA_VERSION,
        suite: report.suite.clone(),
        false_alarms: FALSE_ALARMS,
        history: Vec::new(),
        checks: Vec::new(),
    }
}

/// From other clouds, else from its known scatter, else from theory.
fn band_of(check: &Check, clouds: &Clouds, known: Option<Scatter>, tail: f64) -> Band {
    if clouds.is_empty() {
        return known
            .map_or_else(|| without_scatter(check), |scatter| around_value(check, scatter, tail));
    }
    match clouds.mean_and_scatter(check) {
        Some((mean, scatter)) => around_mean(check, mean, scatter, tail),
        None => without_scatter(check),
    }
}

fn summary(comparison: &Comparison, clouds: &Clouds) -> String {
    let named = [
        (Verdict::Worse, "worse"),
        (Verdict::Missing, "missing"),
        (Verdict::New, "new"),
        (Verdict::Improved, "improved"),
        (Verdict::Same, "the same"),
    ];
    let counts = named.map(|(verdict, word)| (comparison.count(verdict), word));
    let present = counts.iter().filter(|(count, _)| *count > 0);
    let mut parts: Vec<String> = present.map(|(count, word)| format!("{count} {word}")).collect();
    if !clouds.is_empty() {
        parts.push(format!("bands of {} other clouds", clouds.runs()));
    }
    parts.join(", ")
}

/// A line per check that was added, removed or changed.
pub fn difference(old: Option<&Baseline>, new: &Baseline) -> Vec<String> {
    let before = |id: &str| old.and_then(|old| old.check(id));
    let removed = old.iter().flat_map(|old| &old.checks).filter(|s| new.check(&s.id).is_none());
    let mut lines: Vec<String> = removed.map(|s| format!("- {} ({})", s.id, s.value)).collect();
    for now in &new.checks {
        match before(&now.id) {
            None => lines.push(format!("+ {} {}{}", now.id, now.value, within(&now.band))),
            Some(old) if old == now => {}
            Some(old) if old.value == now.value && old.bound == now.bound => {
                lines.push(format!("~ {} {}{}", now.id, now.value, within(&now.band)));
            }
            Some(old) => {
                let bound = if old.bound == now.bound {
                    String::new()
                } else {
                    format!(", bound {:?}, was {:?}", now.bound, old.bound)
                };
                let (from, to) = (old.value, now.value);
                lines.push(format!("~ {} {from} → {to}{}{bound}", now.id, within(&now.band)));
            }
        }
    }
    lines
}

fn within(band: &Band) -> String {
    let source = format!("{:?}", band.source).to_lowercase();
    let samples = band.scatter.map_or(String::new(), |s| format!(" of {} clouds", s.samples));
    format!(" in {:.6e} … {:.6e} ({source}{samples})", band.low, band.high)
}
