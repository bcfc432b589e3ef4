//! A run beside a baseline or beside another run.

use super::band::{HALF_THE_DIGITS, still};
use super::baseline::{Baseline, GateError, Stored};
use crate::study::{Band, Bound, Change, Check, Comparison, Report, Verdict};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Judges every check of the studies that were run; `whole` if those were all
/// studies of the suite, so that what is not there is missing.
pub fn compare(report: &Report, baseline: &Baseline, whole: bool) -> Result<Comparison, GateError> {
    if baseline.suite != report.suite {
        let (baseline, run) = (baseline.suite.clone(), report.suite.clone());
        return Err(GateError::Suite { baseline, run });
    }
    let with = match baseline.history.last() {
        Some(last) => format!("the baseline of {} (commit {})", last.date, last.commit),
        None => "a baseline without a history".to_string(),
    };
    Ok(Comparison { with, changes: changes(report, &baseline.checks, whole) })
}

/// Judges the run `now` by the figures of `before`, which need no baseline:
/// without one nothing is known of the scatter over clouds, and what is beyond
/// round-off and the error bars of references is called a change.
pub fn compare_runs(before: &Report, now: &Report) -> Comparison {
    let mut stored: Vec<Stored> =
        before.checks().map(|check| stored(check, loose(check))).collect();
    stored.sort_by(|a, b| a.id.cmp(&b.id));
    let p = &before.provenance;
    let with = format!("the {} run of {} (commit {})", before.suite, p.date, p.commit);
    Comparison { with, changes: changes(now, &stored, false) }
}

/// Inside its two bounds a figure is neither better nor worse than another.
fn loose(check: &Check) -> Band {
    match check.bound {
        Bound::Between(low, high) if check.pass => Band { low, high, ..still(check) },
        _ => still(check),
    }
}

pub fn stored(check: &Check, band: Band) -> Stored {
    Stored {
        id: check.id.clone(),
        value: check.value,
        unit: check.unit.clone(),
        kind: check.kind,
        bound: check.bound,
        band,
    }
}

fn changes(report: &Report, stored: &[Stored], whole: bool) -> Vec<Change> {
    let checks: BTreeMap<&str, &Check> = report.checks().map(|c| (c.id.as_str(), c)).collect();
    let known: BTreeMap<&str, &Stored> = stored.iter().map(|s| (s.id.as_str(), s)).collect();
    let run: BTreeSet<&str> = report.studies.iter().map(|study| study.id.as_str()).collect();
    // Of a run of a few studies nothing can be said about the others.
    let missing = known.values().filter(|stored| {
        let study = stored.id.split('/').next().unwrap_or(&stored.id);
        !checks.contains_key(stored.id.as_str()) && (whole || run.contains(study))
    });
    let mut changes: Vec<Change> = missing.map(|stored| gone(stored)).collect();
    changes.extend(report.checks().map(|check| match known.get(check.id.as_str()) {
        Some(stored) => judged(check, stored),
        None => new(check),
    }));
    changes.sort_by(order);
    changes
}

fn gone(stored: &Stored) -> Change {
    Change {
        id: stored.id.clone(),
        quantity: String::new(),
        unit: stored.unit.clone(),
        verdict: Verdict::Missing,
        before: stored.value,
        now: f64::NAN,
        band: Some(stored.band),
        remark: None,
    }
}

fn new(check: &Check) -> Change {
    Change {
        id: check.id.clone(),
        quantity: check.quantity.clone(),
        unit: check.unit.clone(),
        verdict: Verdict::New,
        before: f64::NAN,
        now: check.value,
        band: None,
        remark: None,
    }
}

fn judged(check: &Check, stored: &Stored) -> Change {
    let (mut verdict, mut remark) = (verdict(check, &stored.band), None);
    if check.unit != stored.unit {
        verdict = Verdict::Worse;
        remark = Some(format!("its unit was {}", stored.unit));
    } else if loosened(stored.bound, check.bound) {
        verdict = Verdict::Worse;
        remark = Some("its bound was loosened".to_string());
    }
    let mut change = new(check);
    change.verdict = verdict;
    change.before = stored.value;
    change.band = Some(stored.band);
    change.remark = remark;
    change
}

/// On which side of its band a figure lies. Leaving a target between two bounds
/// is for the worse in either direction.
pub fn verdict(check: &Check, band: &Band) -> Verdict {
    let now = check.value;
    if now >= band.low && now <= band.high {
        return Verdict::Same;
    }
    match check.bound {
        Bound::AtMost(_) if now < band.low => Verdict::Improved,
        Bound::AtLeast(_) if now > band.high => Verdict::Improved,
        _ => Verdict::Worse,
    }
}

/// Whether a bound holds for more values than it did; another relation cannot
/// be compared and counts as loosened.
pub fn loosened(before: Bound, now: Bound) -> bool {
    // Bounds that are computed may differ by round-off.
    let above = |now: f64, before: f64| now > before + HALF_THE_DIGITS * before.abs();
    match (before, now) {
        (Bound::AtMost(before), Bound::AtMost(now)) => above(now, before),
        (Bound::AtLeast(before), Bound::AtLeast(now)) => above(-now, -before),
        (Bound::Between(low, high), Bound::Between(now_low, now_high)) => {
            above(now_high, high) || above(-now_low, -low)
        }
        _ => true,
    }
}

/// The worst first: by verdict, by how many half-widths beyond the band, by id.
fn order(a: &Change, b: &Change) -> Ordering {
    let excess = |change: &Change| beyond(change).unwrap_or(f64::INFINITY);
    let by_excess = || excess(b).total_cmp(&excess(a));
    a.verdict.cmp(&b.verdict).then_with(by_excess).then_with(|| a.id.cmp(&b.id))
}

/// How far a figure is from the middle of its band, in half-widths; None for
/// what is not a number.
pub fn beyond(change: &Change) -> Option<f64> {
    let Band { low, high, .. } = change.band?;
    let (middle, half_width) = (0.5 * (low + high), 0.5 * (high - low));
    let beyond = (change.now - middle).abs() / half_width;
    beyond.is_finite().then_some(beyond)
}
