//! results.json: the whole report, one check and one study per line.

use crate::escape::printable_json;
use crate::study::{Comparison, Figure, Outcome, Report, Study, Table};
use serde::Serialize;

/// Version of the file, stored in every [`Report`].
pub const SCHEMA_VERSION: u32 = 1;

/// A study without its checks, which have a list of their own.
#[derive(Serialize)]
struct StudyLine<'a> {
    id: &'a str,
    title: &'a str,
    claim: &'a str,
    command: &'a str,
    passed: bool,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    undecided: &'a [String],
    failure: &'a Option<String>,
    wall_seconds: f64,
    notes: &'a [String],
    tables: &'a [Table],
    figures: &'a [Figure],
    leading: usize,
}

/// The report as JSON; what is not finite becomes `null`.
pub fn to_json(report: &Report) -> String {
    let studies: Vec<String> = report.studies.iter().map(|s| value(&line(s))).collect();
    let checks: Vec<String> = report.checks().map(value).collect();
    let mut fields = vec![
        ("schema_version", value(&report.schema_version)),
        ("suite", value(&report.suite)),
        ("provenance", value(&report.provenance)),
        ("passed", value(&report.passed())),
        ("outcome", value(&report.outcome().word().to_lowercase())),
        ("wall_seconds", value(&report.wall_seconds)),
        ("checks", list(&checks)),
        ("studies", list(&studies)),
    ];
    if let Some(comparison) = &report.comparison {
        fields.push(("comparison", comparison_text(comparison)));
    }
    let body: Vec<String> =
        fields.iter().map(|(name, text)| format!("  \"{name}\": {text}")).collect();
    printable_json(&format!("{{\n{}\n}}\n", body.join(",\n")))
}

/// One change per line.
fn comparison_text(comparison: &Comparison) -> String {
    let changes: Vec<String> = comparison.changes.iter().map(value).collect();
    format!("{{\"with\": {}, \"changes\": {}}}", value(&comparison.with), list(&changes))
}

fn line(study: &Study) -> StudyLine<'_> {
    StudyLine {
        id: &study.id,
        title: &study.title,
        claim: &study.claim,
        command: &study.command,
        passed: study.outcome() == Outcome::Passed,
        undecided: &study.undecided,
        failure: &study.failure,
        wall_seconds: study.wall_seconds,
        notes: &study.notes,
        tables: &study.tables,
        figures: &study.figures,
        leading: study.leading,
    }
}

fn list(lines: &[String]) -> String {
    if lines.is_empty() {
        "[]".to_string()
    } else {
        format!("[\n    {}\n  ]", lines.join(",\n    "))
    }
}

/// serde_json writes every non-finite number as `null`.
fn value<T: Serialize>(item: &T) -> String {
    serde_json::to_string(item).expect("plain data with string keys always serialises")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;
    use serde_json::Value;

    #[test]
    fn the_file_parses_and_nan_is_null() {
        let text = to_json(&sample::report());
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        let parsed: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(parsed["schema_version"], 1);
        assert_eq!(parsed["passed"], false);
        assert_eq!(parsed["checks"].as_array().unwrap().len(), 11);
        let none = parsed["checks"].as_array().unwrap().iter().find(|c| c["value"].is_null());
        assert_eq!(none.unwrap()["pass"], false);
        assert_eq!(parsed["checks"][0]["bound"]["at_most"], 1e-12);
        assert_eq!(parsed["checks"][0]["kind"], "exact");
        assert!(parsed["studies"][0].get("checks").is_none());
        assert_eq!(parsed["studies"][1]["figures"][0]["plot"]["x"]["log"], true);
    }

    #[test]
    fn a_report_without_studies_is_still_json() {
        let parsed: Value = serde_json::from_str(&to_json(&sample::empty())).unwrap();
        assert_eq!(parsed["studies"], Value::Array(vec![]));
        assert_eq!(parsed["passed"], true);
    }
}
