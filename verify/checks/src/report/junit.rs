//! junit.xml: a test suite per study, a test case per check.

use super::change::{band_text, change_text, verdict_name};
use super::number::{bound_text, four_digits};
use super::words::{kind_name, unit_text};
use crate::study::{Check, Comparison, Report, Study, Verdict};
use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestSuite};
use std::time::Duration;

/// The report as JUnit XML; a study that could not run is an error.
pub fn to_junit(report: &Report) -> anyhow::Result<String> {
    let mut junit = quick_junit::Report::new(format!("mtled {}", report.suite));
    if let Some(time) = duration(report.wall_seconds) {
        junit.set_time(time);
    }
    junit.add_test_suites(report.studies.iter().map(suite));
    junit.add_test_suites(report.comparison.iter().map(compared));
    Ok(junit.to_string()?)
}

fn suite(study: &Study) -> TestSuite {
    let mut suite = TestSuite::new(study.id.as_str());
    if let Some(time) = duration(study.wall_seconds) {
        suite.set_time(time);
    }
    if let Some(reason) = &study.failure {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
        status.set_message(format!("could not run: {reason}")).set_type("study");
        let mut case = TestCase::new(format!("{}/runs", study.id), status);
        case.set_classname(study.id.as_str());
        suite.add_test_case(case);
    }
    suite.add_test_cases(study.checks.iter().map(case));
    suite
}

fn case(check: &Check) -> TestCase {
    let status = if check.pass {
        TestCaseStatus::success()
    } else {
        let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
        status.set_message(failure_message(check)).set_type(kind_name(check.kind));
        let case = check
            .failure_file()
            .map_or(String::new(), |file| format!("\nthe smallest case that shows it: {file}"));
        let (quantity, source) = (&check.quantity, &check.source);
        status.set_description(format!("{quantity}\nbound from: {source}{case}"));
        status
    };
    let mut case = TestCase::new(check.id.as_str(), status);
    case.set_classname(check.study.as_str());
    case
}

/// A test case per check that has a baseline: nothing got worse.
fn compared(comparison: &Comparison) -> TestSuite {
    let mut suite = TestSuite::new("baseline");
    let known = comparison.changes.iter().filter(|change| change.verdict != Verdict::New);
    suite.add_test_cases(known.map(|change| {
        let status = match change.verdict {
            Verdict::Worse | Verdict::Missing => {
                let name = verdict_name(change.verdict);
                let remark = change.remark.as_ref().map_or(String::new(), |r| format!("; {r}"));
                let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
                let message = format!("{name}: {}{remark}", change_text(change));
                status.set_message(message).set_type(name);
                let band = band_text(&change.band);
                status.set_description(format!("counts as the same: {band}"));
                status
            }
            _ => TestCaseStatus::success(),
        };
        let mut case = TestCase::new(format!("baseline/{}", change.id), status);
        case.set_classname("baseline");
        case
    }));
    suite
}

fn failure_message(check: &Check) -> String {
    let (value, bound) = (four_digits(check.value), bound_text(&check.bound));
    match unit_text(&check.unit) {
        "–" => format!("{}: {value} breaks {bound}", check.quantity),
        unit => format!("{}: {value} {unit} breaks {bound} {unit}", check.quantity),
    }
}

fn duration(seconds: f64) -> Option<Duration> {
    Duration::try_from_secs_f64(seconds).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn failures_carry_value_and_bound_and_a_broken_study_is_an_error() {
        let xml = to_junit(&sample::report()).unwrap();
        let back = quick_junit::Report::deserialize_from_str(&xml).unwrap();
        assert_eq!((back.tests, back.failures, back.errors), (12, 2, 1));
        assert!(xml.contains("breaks ≤ 0.02"), "{xml}");
        assert!(xml.contains("could not run: reference/cook.csv: no such file"), "{xml}");
        assert!(xml.contains("tumour&apos;s"), "a quantity must be escaped: {xml}");
    }

    #[test]
    fn what_got_worse_or_is_missing_is_a_failed_test_of_the_baseline() {
        let xml = to_junit(&sample::compared()).unwrap();
        let back = quick_junit::Report::deserialize_from_str(&xml).unwrap();
        assert_eq!((back.tests, back.failures, back.errors), (16, 4, 1));
        assert!(xml.contains("worse: 0.01010 mm → 0.03120 mm; its bound was loosened"), "{xml}");
    }
}
