//! junit.xml: a test suite per study, a test case per check.

use super::number::{bound_text, four_digits};
use super::words::{kind_name, unit_text};
use crate::study::{Check, Report, Study};
use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestSuite};
use std::time::Duration;

/// The report as JUnit XML; a study that could not run is an error.
pub fn to_junit(report: &Report) -> anyhow::Result<String> {
    let mut junit = quick_junit::Report::new(format!("mtled {}", report.suite));
    if let Some(time) = duration(report.wall_seconds) {
        junit.set_time(time);
    }
    junit.add_test_suites(report.studies.iter().map(suite));
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
        status.set_description(format!("{}\nbound from: {}", check.quantity, check.source));
        status
    };
    let mut case = TestCase::new(check.id.as_str(), status);
    case.set_classname(check.study.as_str());
    case
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
}
