//! The table of studies from a `results.json` of `mtled verify`.

use anyhow::Result;
use mtled_checks::report::{bound_text, four_digits, read_report};
use mtled_checks::study::{Check, Outcome, Report};
use std::fmt::Write;
use std::path::Path;

/// Number of figures per study: the first ones, failures before all others.
const KEY_FIGURES: usize = 2;

/// A Markdown table, one row per study.
pub fn table(path: &Path) -> Result<String> {
    Ok(to_markdown(&read_report(path)?))
}

fn to_markdown(report: &Report) -> String {
    let mut text = String::from("| study | checks passed | key figures |\n|---|--:|---|\n");
    for study in &report.studies {
        let checks = &study.checks;
        let passed = checks.iter().filter(|check| check.pass).count();
        let figures = match &study.failure {
            Some(reason) => format!("could not run: {}", cell(reason)),
            None => key_figures(checks),
        };
        let title = cell(&study.title);
        let _ = writeln!(text, "| {title} | {passed} of {} | {figures} |", checks.len());
    }
    let p = &report.provenance;
    let _ = writeln!(
        text,
        "\nSuite {}: {}, in {:.0} s on {} with {} threads, mtled {} ({}), {}.",
        report.suite,
        match report.outcome() {
            Outcome::Passed => "passed",
            Outcome::Inconclusive => "inconclusive",
            Outcome::Failed | Outcome::CouldNotRun => "failed",
        },
        report.wall_seconds,
        p.processor,
        p.threads,
        p.version,
        p.commit,
        p.date
    );
    text
}

fn key_figures(checks: &[Check]) -> String {
    let mut ordered: Vec<&Check> = checks.iter().collect();
    ordered.sort_by_key(|check| check.pass);
    let shown: Vec<String> = ordered.iter().take(KEY_FIGURES).map(|check| figure(check)).collect();
    shown.join("; ")
}

fn figure(check: &Check) -> String {
    let unit = if check.unit == "1" { String::new() } else { format!(" {}", check.unit) };
    let bound = bound_text(&check.bound);
    let value =
        if check.value.is_finite() { four_digits(check.value) } else { "not finite".into() };
    let verdict = if check.pass { "" } else { "FAILED: " };
    cell(&format!("{verdict}{} {value}{unit} ({bound})", check.quantity))
}

/// Escapes a text for a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace(['\r', '\n'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use mtled_checks::study::{Bound, Kind, Provenance, Study};

    fn check(id: &str, value: f64) -> Check {
        Check::new(id, "error", Kind::Exact, value, Bound::AtMost(0.05), "m", "theory")
    }

    #[test]
    fn failures_come_first_and_nan_is_reported() {
        let checks =
            vec![check("patch/a", 0.01), check("patch/b", 0.02), check("patch/c", f64::NAN)];
        let (id, title) = ("patch".to_string(), "Patch | test".to_string());
        let report = Report {
            schema_version: 1,
            suite: "quick".into(),
            provenance: Provenance {
                version: "0".into(),
                commit: "c".into(),
                compiler: "r".into(),
                processor: "p".into(),
                processor_features: String::new(),
                threads: 2,
                date: "d".into(),
            },
            studies: vec![Study { id, title, checks, ..Study::default() }],
            wall_seconds: 12.0,
            comparison: None,
        };
        let text = to_markdown(&report);
        let row = "| Patch \\| test | 2 of 3 | FAILED: error not finite m (≤ 0.05); \
                   error 0.01000 m (≤ 0.05) |";
        assert!(text.contains(row), "{text}");
        assert!(text.contains("Suite quick: failed, in 12 s on p with 2 threads"), "{text}");
    }
}
