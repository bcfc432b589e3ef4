//! The table of studies from a `results.json` of `mtled verify`.

use anyhow::{Context, Result};
use mtled_verify::report::{bound_text, four_digits};
use mtled_verify::study::{Check, Provenance};
use serde::Deserialize;
use std::fmt::Write;
use std::path::Path;

#[derive(Deserialize)]
struct Results {
    suite: String,
    provenance: Provenance,
    passed: bool,
    wall_seconds: f64,
    checks: Vec<Check>,
    studies: Vec<StudyLine>,
}

#[derive(Deserialize)]
struct StudyLine {
    id: String,
    title: String,
    failure: Option<String>,
}

/// So many figures of a study are shown: the first it gives, failures before
/// all others.
const KEY_FIGURES: usize = 2;

/// A Markdown table, one row per study.
pub fn table(path: &Path) -> Result<String> {
    let context = || format!("cannot use {}", path.display());
    let text = std::fs::read_to_string(path).with_context(context)?;
    // A value that was not finite is null in the file.
    let mut value: serde_json::Value = serde_json::from_str(&text).with_context(context)?;
    restore_lost_values(&mut value);
    let results: Results = serde_json::from_value(value).with_context(context)?;
    Ok(to_markdown(&results))
}

fn restore_lost_values(value: &mut serde_json::Value) {
    let checks = value.get_mut("checks").and_then(|checks| checks.as_array_mut());
    for check in checks.into_iter().flatten() {
        if check["value"].is_null() {
            check["value"] = serde_json::json!(f64::MAX);
        }
    }
}

fn to_markdown(results: &Results) -> String {
    let mut text = String::from("| study | checks passed | key figures |\n|---|--:|---|\n");
    for study in &results.studies {
        let checks: Vec<&Check> = results.checks.iter().filter(|c| c.study == study.id).collect();
        let passed = checks.iter().filter(|check| check.pass).count();
        let figures = match &study.failure {
            Some(reason) => format!("could not run: {}", cell(reason)),
            None => key_figures(&checks),
        };
        let title = cell(&study.title);
        let _ = writeln!(text, "| {title} | {passed} of {} | {figures} |", checks.len());
    }
    let p = &results.provenance;
    let _ = writeln!(
        text,
        "\nSuite {}: {}, in {:.0} s on {} with {} threads, mtled {} ({}), {}.",
        results.suite,
        if results.passed { "passed" } else { "failed" },
        results.wall_seconds,
        p.processor,
        p.threads,
        p.version,
        p.commit,
        p.date
    );
    text
}

fn key_figures(checks: &[&Check]) -> String {
    let mut ordered = checks.to_vec();
    ordered.sort_by_key(|check| check.pass);
    let shown: Vec<String> = ordered.iter().take(KEY_FIGURES).map(|check| figure(check)).collect();
    shown.join("; ")
}

fn figure(check: &Check) -> String {
    let unit = if check.unit == "1" { String::new() } else { format!(" {}", check.unit) };
    let bound = bound_text(&check.bound);
    let value =
        if check.value == f64::MAX { "not finite".into() } else { four_digits(check.value) };
    let verdict = if check.pass { "" } else { "FAILED: " };
    cell(&format!("{verdict}{} {value}{unit} ({bound})", check.quantity))
}

/// Keeps a text inside its cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace(['\r', '\n'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn check(id: &str, value: Option<f64>, pass: bool) -> serde_json::Value {
        json!({
            "id": id, "study": "patch", "quantity": "error", "kind": "exact", "value": value,
            "bound": { "at_most": 0.05 }, "unit": "m", "pass": pass, "source": ""
        })
    }

    #[test]
    fn failures_come_first_and_lost_values_are_said() {
        let mut value = json!({
            "suite": "quick", "passed": false, "wall_seconds": 12.0,
            "provenance": {
                "version": "0", "commit": "c", "compiler": "r", "processor": "p",
                "processor_features": "", "threads": 2, "date": "d"
            },
            "checks": [
                check("patch/a/error", Some(0.01), true),
                check("patch/b/error", Some(0.02), true),
                check("patch/c/error", None, false),
            ],
            "studies": [{ "id": "patch", "title": "Patch | test", "failure": null }],
        });
        restore_lost_values(&mut value);
        let text = to_markdown(&serde_json::from_value(value).unwrap());
        let row = "| Patch \\| test | 2 of 3 | FAILED: error not finite m (≤ 0.05); \
                   error 0.01000 m (≤ 0.05) |";
        assert!(text.contains(row), "{text}");
        assert!(text.contains("Suite quick: failed, in 12 s on p with 2 threads"), "{text}");
    }
}
