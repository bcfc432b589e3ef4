//! Comparison of a run with a baseline or with another run.

use super::band::{HALF_THE_DIGITS, without_scatter};
use super::baseline::{Baseline, GateError, Stored};
use crate::study::{Band, Better, Bound, Change, Check, Comparison, Kind, Report, Verdict};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// Judges every check of the studies that were run; `whole` if those were all
/// studies of the suite, so that absent checks count as missing.
pub fn compare(report: &Report, baseline: &Baseline, whole: bool) -> Result<Comparison, GateError> {
    baseline.check_suite(&report.suite)?;
    let with = match baseline.history.last() {
        Some(last) => format!("the baseline of {} (commit {})", last.date, last.commit),
        None => "a baseline without a history".to_string(),
    };
    Ok(Comparison { with, changes: changes(report, &baseline.checks, whole) })
}

/// Gives the checks that have no bound of their own the bands of their stored figures.
pub fn settle(report: &mut Report, baseline: &Baseline) {
    for check in report.studies.iter_mut().flat_map(|study| &mut study.checks) {
        if matches!(check.bound, Bound::Baseline(_)) {
            check.band = baseline.check(&check.id).map(|stored| stored.band);
        }
    }
}

/// Judges the run `now` by the figures of `before`, without a baseline: the scatter
/// over clouds is not known, so that everything beyond round-off and the error bars
/// of references is a change.
pub fn compare_runs(before: &Report, now: &Report) -> Comparison {
    let mut stored: Vec<Stored> =
        before.checks().map(|check| stored(check, run_band(check))).collect();
    stored.sort_by(|a, b| a.id.cmp(&b.id));
    let p = &before.provenance;
    let with = format!("the {} run of {} (commit {})", before.suite, p.date, p.commit);
    Comparison { with, changes: changes(now, &stored, false) }
}

/// Between two limits no figure is better than another.
fn run_band(check: &Check) -> Band {
    match check.bound {
        Bound::Between(low, high) if check.pass => Band { low, high, ..without_scatter(check) },
        _ => without_scatter(check),
    }
}

/// The line of a baseline for a check.
pub(crate) fn stored(check: &Check, band: Band) -> Stored {
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
    // A run of a few studies says nothing about the others.
    let missing = known.values().filter(|stored| {
        let study = stored.id.split('/').next().unwrap_or(&stored.id);
        !checks.contains_key(stored.id.as_str()) && (whole || run.contains(study))
    });
    let mut changes: Vec<Change> = missing.map(|stored| missing_change(stored)).collect();
    changes.extend(report.checks().map(|check| match known.get(check.id.as_str()) {
        Some(stored) => judged(check, stored),
        None => new_change(check),
    }));
    changes.sort_by(order);
    changes
}

fn missing_change(stored: &Stored) -> Change {
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

fn new_change(check: &Check) -> Change {
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
    } else if stored.kind != Kind::Regression && check.kind == Kind::Regression {
        verdict = Verdict::Worse;
        remark = Some(format!(
            "it was judged by its {} bound, now by our own figure",
            stored.kind.name()
        ));
    } else if loosened(stored.bound, check.bound) {
        verdict = Verdict::Worse;
        remark = Some("its bound was loosened".to_string());
    }
    let (before, band) = (stored.value, Some(stored.band));
    Change { verdict, before, band, remark, ..new_change(check) }
}

/// On which side of its band a figure lies. Leaving a band between two limits
/// is worse in either direction.
pub(crate) fn verdict(check: &Check, band: &Band) -> Verdict {
    let now = check.value;
    if now >= band.low && now <= band.high {
        return Verdict::Same;
    }
    match check.bound {
        Bound::AtMost(_) | Bound::Baseline(Better::Lower) if now < band.low => Verdict::Improved,
        Bound::AtLeast(_) if now > band.high => Verdict::Improved,
        _ => Verdict::Worse,
    }
}

/// Whether a bound allows more values than before; a different relation counts as
/// loosened.
pub(crate) fn loosened(before: Bound, now: Bound) -> bool {
    // Computed bounds may differ by round-off.
    let above = |now: f64, before: f64| now > before + HALF_THE_DIGITS * before.abs();
    match (before, now) {
        (Bound::AtMost(before), Bound::AtMost(now)) => above(now, before),
        (Bound::AtLeast(before), Bound::AtLeast(now)) => above(-now, -before),
        (Bound::Between(low, high), Bound::Between(now_low, now_high)) => {
            above(now_high, high) || above(-now_low, -low)
        }
        (Bound::Baseline(before), Bound::Baseline(now)) => before != now,
        // Where there was none, any bound is tighter.
        (Bound::Baseline(_), _) => false,
        _ => true,
    }
}

/// By verdict, then by distance from the band, then by id.
fn order(a: &Change, b: &Change) -> Ordering {
    let excess = |change: &Change| beyond(change).unwrap_or(f64::INFINITY);
    let by_excess = || excess(b).total_cmp(&excess(a));
    a.verdict.cmp(&b.verdict).then_with(by_excess).then_with(|| a.id.cmp(&b.id))
}

/// Distance of a figure from the middle of its band, in half-widths; None where it is
/// not finite.
pub(crate) fn beyond(change: &Change) -> Option<f64> {
    let Band { low, high, .. } = change.band?;
    let (middle, half_width) = (0.5 * (low + high), 0.5 * (high - low));
    let beyond = (change.now - middle).abs() / half_width;
    beyond.is_finite().then_some(beyond)
}
