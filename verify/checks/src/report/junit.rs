//! junit.xml: a test suite per study, a test case per check.

use super::change::{band_text, change_text, remark_text};
use super::labels::unit_suffix;
use super::number::{bound_text, four_digits};
use super::svg::escape;
use crate::study::{Check, Comparison, Report, Study, Verdict};
use std::fmt::Write;

/// A test case with what went wrong, if anything did.
struct Case {
    name: String,
    failure: Option<Failure>,
}

/// The element inside a test case that did not pass.
struct Failure {
    element: &'static str,
    kind: &'static str,
    message: String,
    description: String,
}

/// A test suite: name, time \[s\], test cases.
type Suite<'a> = (&'a str, f64, Vec<Case>);

/// The report as JUnit XML; a study that could not run is an error.
pub(crate) fn to_junit(report: &Report) -> String {
    let studies = report.studies.iter();
    let mut suites: Vec<Suite> =
        studies.map(|study| (study.id.as_str(), study.wall_seconds, cases(study))).collect();
    suites.extend(report.comparison.iter().map(|c| ("baseline", f64::NAN, compared(c))));
    let all = || suites.iter().flat_map(|(_, _, cases)| cases);
    let mut xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_string();
    let _ = writeln!(
        xml,
        r#"<testsuites name="mtled {}" tests="{}" skipped="{}" failures="{}" errors="{}"{}>"#,
        escape(&report.suite),
        all().count(),
        count(all(), "skipped"),
        count(all(), "failure"),
        count(all(), "error"),
        time(report.wall_seconds)
    );
    suites.iter().for_each(|suite| write_suite(&mut xml, suite));
    xml + "</testsuites>\n"
}

fn cases(study: &Study) -> Vec<Case> {
    let broken = study.failure.iter().map(|reason| Case {
        name: format!("{}/runs", study.id),
        failure: Some(Failure {
            element: "error",
            kind: "study",
            message: format!("could not run: {reason}"),
            description: String::new(),
        }),
    });
    let open = study.undecided.iter().enumerate().map(|(number, question)| Case {
        name: format!("{}/inconclusive/{}", study.id, number + 1),
        failure: Some(Failure {
            element: "skipped",
            kind: "inconclusive",
            message: format!("inconclusive: {question}"),
            description: String::new(),
        }),
    });
    let checks =
        study.checks.iter().map(|check| Case { name: check.id.clone(), failure: failure(check) });
    broken.chain(open).chain(checks).collect()
}

/// What is wrong with a check: that it breaks its bound, or that nothing judges it.
fn failure(check: &Check) -> Option<Failure> {
    if check.passed() {
        return None;
    }
    let (value, bound) = (four_digits(check.value), bound_text(&check.bound));
    let (unit, quantity) = (unit_suffix(&check.unit), &check.quantity);
    let mut description = format!("{quantity}\nbound from: {}", check.source);
    if let Some(file) = check.failure_file() {
        description += &format!("\nthe smallest case that shows it: {file}");
    }
    let (element, message) = if check.pass {
        ("skipped", format!("{quantity}: {value}{unit} is new, and nothing judges it"))
    } else {
        ("failure", format!("{quantity}: {value}{unit} breaks {bound}{unit}"))
    };
    Some(Failure { element, kind: check.kind.name(), message, description })
}

/// A test case per check that has a baseline: nothing got worse.
fn compared(comparison: &Comparison) -> Vec<Case> {
    let known = comparison.changes.iter().filter(|change| change.verdict != Verdict::New);
    let case = known.map(|change| {
        let kind = change.verdict.name();
        let bad = matches!(change.verdict, Verdict::Worse | Verdict::Missing);
        let failure = bad.then(|| Failure {
            element: "failure",
            kind,
            message: format!("{kind}: {}{}", change_text(change), remark_text(change)),
            description: format!("counts as the same: {}", band_text(&change.band)),
        });
        Case { name: format!("baseline/{}", change.id), failure }
    });
    case.collect()
}

fn count<'a>(cases: impl Iterator<Item = &'a Case>, element: &str) -> usize {
    cases.filter_map(|case| case.failure.as_ref()).filter(|f| f.element == element).count()
}

fn write_suite(xml: &mut String, (name, seconds, cases): &Suite) {
    let name = escape(name);
    let _ = writeln!(
        xml,
        r#"    <testsuite name="{name}" tests="{}" skipped="{}" errors="{}" failures="{}"{}>"#,
        cases.len(),
        count(cases.iter(), "skipped"),
        count(cases.iter(), "error"),
        count(cases.iter(), "failure"),
        time(*seconds)
    );
    for case in cases {
        let head = format!(r#"        <testcase name="{}" classname="{name}""#, escape(&case.name));
        let Some(Failure { element, kind, message, description }) = &case.failure else {
            let _ = writeln!(xml, "{head}/>");
            continue;
        };
        let message = escape(message);
        // Lines of the description are kept; in attributes they would be joined anyway.
        let lines: Vec<String> = description.split('\n').map(escape).collect();
        let _ = writeln!(
            xml,
            "{head}>\n            <{element} message=\"{message}\" type=\"{kind}\">{}</{element}>\n        </testcase>",
            lines.join("\n")
        );
    }
    let _ = writeln!(xml, "    </testsuite>");
}

/// The attribute for a time \[s\], empty where it is not known.
fn time(seconds: f64) -> String {
    let known = seconds.is_finite() && seconds >= 0.0;
    if known { format!(r#" time="{seconds:.3}""#) } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    /// Numbers of test cases, failures and errors in the text, which must be XML.
    fn elements(xml: &str) -> [usize; 3] {
        let mut reader = quick_xml::Reader::from_str(xml);
        while reader.read_event().unwrap() != quick_xml::events::Event::Eof {}
        ["<testcase ", "<failure ", "<error "].map(|element| xml.matches(element).count())
    }

    #[test]
    fn failures_show_value_and_bound_and_a_broken_study_is_an_error() {
        let xml = to_junit(&sample::report());
        assert_eq!(elements(&xml), [12, 2, 1]);
        let totals = r#"<testsuites name="mtled quick" tests="12" skipped="0" failures="2" errors="1" time="191.300">"#;
        assert!(xml.contains(totals), "{xml}");
        assert!(xml.contains("breaks ≤ 0.02"), "{xml}");
        assert!(xml.contains("could not run: reference/cook.csv: no such file"), "{xml}");
        assert!(xml.contains("tumour&#39;s"), "a quantity must be escaped: {xml}");
    }

    #[test]
    fn a_worse_or_missing_check_is_a_failed_test_of_the_baseline() {
        let xml = to_junit(&sample::compared());
        assert_eq!(elements(&xml), [16, 4, 1]);
        assert!(xml.contains("worse: 0.01010 mm → 0.03120 mm; its bound was loosened"), "{xml}");
    }
}
