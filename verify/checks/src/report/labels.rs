//! Phrases that all kinds of report share.

use super::number::{bound_text, four_digits};
use crate::study::{Check, Report, Study, Verdict};

/// «48 of 50 checks passed», with the studies that could not run and the checks that
/// got worse.
pub(super) fn result_line(report: &Report) -> String {
    let (passed, all) = counts(report.checks().map(Check::passed));
    let broken = report.studies.iter().filter(|study| study.failure.is_some()).count();
    let mut line = match all {
        0 => "Figures only".to_string(),
        _ => format!("{passed} of {all} {} passed", plural(all, "check", "checks")),
    };
    if broken > 0 {
        line += &format!(", {broken} {} could not run", plural(broken, "study", "studies"));
    }
    let new = report.checks().filter(|check| !check.is_judged()).count();
    if new > 0 {
        line += &format!(", {new} new and not judged");
    }
    let open = report.studies.iter().map(|study| study.undecided.len()).sum::<usize>();
    if open > 0 {
        line += &format!(", {open} {} inconclusive", plural(open, "question", "questions"));
    }
    for (verdict, label) in [(Verdict::Worse, "got worse"), (Verdict::Missing, "missing")] {
        match report.comparison.as_ref().map_or(0, |comparison| comparison.count(verdict)) {
            0 => {}
            count => line += &format!(", {count} {label}"),
        }
    }
    line
}

/// Number of passes, and of all.
pub(super) fn counts(passes: impl Iterator<Item = bool>) -> (usize, usize) {
    passes.fold((0, 0), |(passed, all), pass| (passed + usize::from(pass), all + 1))
}

/// Checks passed and all checks of one study.
pub(super) fn study_counts(study: &Study) -> (usize, usize) {
    counts(study.checks.iter().map(Check::passed))
}

/// A pure number has no unit to show.
pub(super) fn unit_text(unit: &str) -> &str {
    if unit.is_empty() || unit == "1" { "–" } else { unit }
}

/// The unit after a value, with its space; empty for a pure number.
pub(super) fn unit_suffix(unit: &str) -> String {
    match unit_text(unit) {
        "–" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// `shift is 0.0312 mm, must be ≤ 0.02 mm`.
pub(super) fn failure_text(check: &Check) -> String {
    let (value, bound) = (four_digits(check.value), bound_text(&check.bound));
    let unit = unit_suffix(&check.unit);
    format!("{} is {value}{unit}, must be {bound}{unit}", check.quantity)
}

/// `12 s`, `3 min 05 s`, `80 ms`.
pub(super) fn duration(seconds: f64) -> String {
    if !seconds.is_finite() || seconds < 0.0 {
        "–".to_string()
    } else if seconds < 0.9995 {
        format!("{:.0} ms", seconds * 1e3)
    } else if seconds < 9.95 {
        format!("{seconds:.1} s")
    } else if seconds < 59.5 {
        format!("{seconds:.0} s")
    } else {
        let whole = seconds.round() as u64;
        format!("{} min {:02} s", whole / 60, whole % 60)
    }
}

/// The word for a count.
pub(super) fn plural(count: usize, one: &'static str, many: &'static str) -> &'static str {
    if count == 1 { one } else { many }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn the_verdict_counts_checks_and_names_broken_studies() {
        let report = sample::report();
        assert_eq!(result_line(&report), "9 of 11 checks passed, 1 study could not run");
        assert_eq!(result_line(&sample::empty()), "Figures only");
        assert!(result_line(&sample::compared()).ends_with(", 1 got worse, 1 missing"));
    }

    #[test]
    fn durations_are_rounded() {
        let labels = [0.0801, 0.9999, 3.123, 59.4, 59.7, 185.2, f64::NAN].map(duration);
        assert_eq!(labels, ["80 ms", "1.0 s", "3.1 s", "59 s", "1 min 00 s", "3 min 05 s", "–"]);
    }
}
