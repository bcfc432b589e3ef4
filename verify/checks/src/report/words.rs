//! The few phrases that every kind of report shares.

use crate::study::{Kind, Report, Study, Verdict};

/// «48 of 50 checks passed», with the studies that could not run and what got
/// worse.
pub(super) fn verdict(report: &Report) -> String {
    let (passed, all) = counts(report.checks().map(|check| check.pass));
    let broken = report.studies.iter().filter(|study| study.failure.is_some()).count();
    let mut words = match all {
        0 => "Figures only".to_string(),
        _ => format!("{passed} of {all} {} passed", plural(all, "check", "checks")),
    };
    if broken > 0 {
        words += &format!(", {broken} {} could not run", plural(broken, "study", "studies"));
    }
    for (verdict, told) in [(Verdict::Worse, "got worse"), (Verdict::Missing, "missing")] {
        match report.comparison.as_ref().map_or(0, |comparison| comparison.count(verdict)) {
            0 => {}
            count => words += &format!(", {count} {told}"),
        }
    }
    words
}

/// How many hold, out of how many.
pub(super) fn counts(passes: impl Iterator<Item = bool>) -> (usize, usize) {
    passes.fold((0, 0), |(passed, all), pass| (passed + usize::from(pass), all + 1))
}

/// Checks passed and all checks of one study.
pub(super) fn study_counts(study: &Study) -> (usize, usize) {
    counts(study.checks.iter().map(|check| check.pass))
}

/// Whether the study ran and all its checks passed.
pub(super) fn study_passed(study: &Study) -> bool {
    study.failure.is_none() && study.checks.iter().all(|check| check.pass)
}

pub(super) fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Exact => "exact",
        Kind::Reference => "reference",
        Kind::Regression => "regression",
    }
}

/// A pure number has no unit to show.
pub(super) fn unit_text(unit: &str) -> &str {
    if unit.is_empty() || unit == "1" { "–" } else { unit }
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
        assert_eq!(verdict(&report), "9 of 11 checks passed, 1 study could not run");
        assert_eq!(verdict(&sample::empty()), "Figures only");
        assert!(verdict(&sample::compared()).ends_with(", 1 got worse, 1 missing"));
    }

    #[test]
    fn durations_are_rounded_to_what_one_reads() {
        let spoken = [0.0801, 0.9999, 3.123, 59.4, 59.7, 185.2, f64::NAN].map(duration);
        assert_eq!(spoken, ["80 ms", "1.0 s", "3.1 s", "59 s", "1 min 00 s", "3 min 05 s", "–"]);
    }
}
