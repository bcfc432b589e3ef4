//! A summary in Markdown, made for the step summary of a CI job.

use super::number::{bound_text, four_digits};
use super::words::{duration, kind_name, study_counts, study_passed, unit_text, verdict};
use crate::study::{Cell, Check, Provenance, Report, Study};
use std::fmt::Write;

/// Verdict, failures, one line per study, and all checks folded away.
pub fn to_markdown(report: &Report) -> String {
    let mut text = String::new();
    let mark = mark(report.passed());
    let _ = writeln!(text, "## {mark} mtled {}: {}\n", report.suite, verdict(report));
    failures(&mut text, report);
    studies(&mut text, report);
    if report.checks().next().is_some() {
        text.push_str("<details><summary>All checks</summary>\n\n");
        checks(&mut text, report.checks());
        text.push_str("\n</details>\n\n");
    }
    let p = &report.provenance;
    let _ = writeln!(
        text,
        "mtled {} ({}), {}, {} on {} threads, {}, {}.",
        p.version,
        p.commit,
        p.compiler,
        p.processor,
        p.threads,
        duration(report.wall_seconds),
        p.date
    );
    text
}

fn failures(text: &mut String, report: &Report) {
    for study in &report.studies {
        if let Some(reason) = &study.failure {
            let _ = writeln!(text, "- ❌ **{}** could not run: {}", cell(&study.id), cell(reason));
        }
    }
    for check in report.checks().filter(|check| !check.pass) {
        let (value, bound) = (four_digits(check.value), bound_text(&check.bound));
        let unit = if check.unit == "1" { String::new() } else { format!(" {}", check.unit) };
        let quantity = cell(&check.quantity);
        let _ = writeln!(
            text,
            "- ❌ `{}`: {quantity} is {value}{unit}, must be {bound}{unit}",
            check.id
        );
    }
    if !report.passed() {
        text.push('\n');
    }
}

fn studies(text: &mut String, report: &Report) {
    text.push_str("| | Study | Checks passed | Time |\n|---|---|--:|--:|\n");
    for study in &report.studies {
        let (passed, all) = study_counts(study);
        let _ = writeln!(
            text,
            "| {} | {} | {passed} of {all} | {} |",
            mark(study_passed(study)),
            cell(&study.title),
            duration(study.wall_seconds)
        );
    }
    text.push('\n');
}

fn checks<'a>(text: &mut String, checks: impl Iterator<Item = &'a Check>) {
    text.push_str("| | Check | Quantity | Kind | Value | Bound | Unit |\n");
    text.push_str("|---|---|---|---|--:|--:|---|\n");
    for check in checks {
        let _ = writeln!(
            text,
            "| {} | `{}` | {} | {} | {} | {} | {} |",
            mark(check.pass),
            check.id,
            cell(&check.quantity),
            kind_name(check.kind),
            four_digits(check.value),
            bound_text(&check.bound),
            cell(unit_text(&check.unit)),
        );
    }
}

fn mark(pass: bool) -> &'static str {
    if pass { "✅" } else { "❌" }
}

/// The tables and notes of a study.
pub fn markdown_tables(study: &Study, provenance: &Provenance) -> String {
    let mut text = format!("# {}\n\n{}\n", study.title, study.claim);
    for table in &study.tables {
        let _ = write!(text, "\n## {}\n\n", table.title);
        let headings = table.columns.iter().map(|column| match column.unit.as_str() {
            "" | "1" => cell(&column.name),
            unit => format!("{} [{unit}]", cell(&column.name)),
        });
        let _ = writeln!(text, "| {} |", headings.collect::<Vec<_>>().join(" | "));
        let _ = writeln!(text, "|{}", "---|".repeat(table.columns.len()));
        for row in &table.rows {
            let cells = row.iter().map(|content| match content {
                Cell::Number(number) if number.is_nan() => "–".to_string(),
                Cell::Number(number) => four_digits(*number),
                Cell::Text(words) => cell(words),
            });
            let _ = writeln!(text, "| {} |", cells.collect::<Vec<_>>().join(" | "));
        }
    }
    text.push('\n');
    for note in &study.notes {
        let _ = writeln!(text, "- {note}");
    }
    let Provenance { version, commit, processor, date, .. } = provenance;
    let _ = writeln!(text, "\nmtled {version} ({commit}), {processor}, {date}.");
    text
}

/// Keeps a text inside its cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "&lt;").replace(['\r', '\n'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn the_summary_leads_with_the_verdict_and_lists_what_failed() {
        let text = to_markdown(&sample::report());
        assert!(text.starts_with("## ❌ mtled quick: 9 of 11 checks passed"), "{text}");
        assert!(text.contains("- ❌ **cook** could not run"), "{text}");
        assert!(text.contains("must be ≤ 0.02"), "{text}");
    }

    #[test]
    fn every_row_of_a_table_has_as_many_cells_as_its_heading() {
        let text = to_markdown(&sample::report());
        let bars = |line: &str| line.replace("\\|", "").matches('|').count();
        for line in text.lines().filter(|line| line.starts_with("| ")) {
            assert!([5, 8].contains(&bars(line)), "{line}");
        }
    }
}
