//! A summary in Markdown, for the step summary of a CI job.

use super::change::verdict_counts;
use super::labels::{duration, failure_text, result_line, study_counts, unit_text};
use super::markdown_table::{cell, change_table, code, code_cell, inline};
use super::number::{bound_text, four_digits};
use crate::study::{Cell, Check, Comparison, Outcome, Provenance, Report, Study, Verdict};
use std::fmt::Write;

const DETAILS: &str = "<details>";
const DETAILS_END: &str = "</details>";

/// Result, failures, changes, one line per study, and all checks in a folded block.
pub(crate) fn to_markdown(report: &Report) -> String {
    let mut text = String::new();
    let mark = mark(report.outcome());
    let _ = writeln!(text, "## {mark} mtled {}: {}\n", inline(&report.suite), result_line(report));
    failures(&mut text, report);
    if let Some(comparison) = &report.comparison {
        compared(&mut text, comparison);
    }
    studies(&mut text, report);
    if report.checks().next().is_some() {
        let _ = writeln!(text, "{DETAILS}<summary>All checks</summary>\n");
        checks(&mut text, report.checks());
        let _ = writeln!(text, "\n{DETAILS_END}\n");
    }
    let p = &report.provenance;
    let _ = writeln!(
        text,
        "mtled {} ({}), {}, {} on {} threads, {}, {}.",
        inline(&p.version),
        inline(&p.commit),
        inline(&p.compiler),
        inline(&p.processor),
        p.threads,
        duration(report.wall_seconds),
        inline(&p.date)
    );
    text
}

/// A summary without its folded block.
pub(super) fn without_details(text: &str) -> String {
    let Some((before, rest)) = text.split_once(DETAILS) else { return text.to_string() };
    let after = rest.split_once(DETAILS_END).map_or("", |(_, after)| after.trim_start());
    format!("{before}{after}")
}

/// Changes compared with a baseline, the most urgent first.
fn compared(text: &mut String, comparison: &Comparison) {
    let mark = mark(if comparison.holds() { Outcome::Passed } else { Outcome::Failed });
    let (with, counts) = (inline(&comparison.with), verdict_counts(comparison));
    let _ = writeln!(text, "### {mark} Beside {with}: {counts}\n");
    let changes = || comparison.changes.iter().filter(|c| c.verdict != Verdict::Same);
    if changes().next().is_some() {
        change_table(text, changes());
        text.push('\n');
    }
}

fn failures(text: &mut String, report: &Report) {
    for study in &report.studies {
        if let Some(reason) = &study.failure {
            let _ =
                writeln!(text, "- ❌ **{}** could not run: {}", inline(&study.id), inline(reason));
        }
    }
    for study in &report.studies {
        for question in &study.questions() {
            let _ = writeln!(
                text,
                "- ❔ **{}** is inconclusive: {}",
                inline(&study.id),
                inline(question)
            );
        }
    }
    for check in report.checks().filter(|check| !check.pass) {
        let _ = writeln!(text, "- ❌ {}: {}", code(&check.id), inline(&failure_text(check)));
        if let Some(file) = check.failure_file() {
            let _ = writeln!(
                text,
                "  The smallest case that shows it: [{}]({})",
                code(&file),
                link(&file)
            );
        }
    }
    if report.studies.iter().any(|study| study.outcome() != Outcome::Passed) {
        text.push('\n');
    }
}

/// A path as the target of a link.
fn link(path: &str) -> String {
    path.replace('%', "%25").replace(' ', "%20").replace('(', "%28").replace(')', "%29")
}

fn studies(text: &mut String, report: &Report) {
    text.push_str("| | Study | Checks passed | Time |\n|---|---|--:|--:|\n");
    for study in &report.studies {
        let (passed, all) = study_counts(study);
        let _ = writeln!(
            text,
            "| {} | {} | {passed} of {all} | {} |",
            mark(study.outcome()),
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
            "| {} | {} | {} | {} | {} | {} | {} |",
            mark(check.outcome()),
            code_cell(&check.id),
            cell(&check.quantity),
            check.kind.name(),
            four_digits(check.value),
            bound_text(&check.bound),
            cell(unit_text(&check.unit)),
        );
    }
}

fn mark(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Passed => "✅",
        Outcome::Inconclusive => "❔",
        Outcome::Failed | Outcome::CouldNotRun => "❌",
    }
}

/// The tables and notes of a study.
pub fn markdown_tables(study: &Study, provenance: &Provenance) -> String {
    let mut text = format!("# {}\n\n{}\n", inline(&study.title), inline(&study.claim));
    for question in &study.questions() {
        let _ = write!(text, "\n**Inconclusive:** {}\n", inline(question));
    }
    for table in &study.tables {
        let _ = write!(text, "\n## {}\n\n", inline(&table.title));
        let headings = table.columns.iter().map(|column| match column.unit.as_str() {
            "" | "1" => cell(&column.name),
            unit => format!("{} [{}]", cell(&column.name), cell(unit)),
        });
        let _ = writeln!(text, "| {} |", headings.collect::<Vec<_>>().join(" | "));
        let _ = writeln!(text, "|{}", "---|".repeat(table.columns.len()));
        for row in &table.rows {
            let cells = row.iter().map(|content| match content {
                Cell::Number(number) if number.is_nan() => "–".to_string(),
                Cell::Number(number) => four_digits(*number),
                Cell::Text(text) => cell(text),
            });
            let _ = writeln!(text, "| {} |", cells.collect::<Vec<_>>().join(" | "));
        }
    }
    text.push('\n');
    for note in &study.notes {
        let _ = writeln!(text, "- {}", inline(note));
    }
    let Provenance { version, commit, processor, date, .. } = provenance;
    let _ = writeln!(text, "\nmtled {version} ({commit}), {processor}, {date}.");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn the_summary_starts_with_the_result_and_lists_failures() {
        let text = to_markdown(&sample::report());
        assert!(text.starts_with("## ❌ mtled quick: 9 of 11 checks passed"), "{text}");
        assert!(text.contains("- ❌ **cook** could not run"), "{text}");
        assert!(text.contains("must be ≤ 0.02"), "{text}");
    }

    #[test]
    fn changes_come_before_the_studies() {
        let text = to_markdown(&sample::compared());
        let at = |part: &str| text.find(part).unwrap_or_else(|| panic!("{part}: {text}"));
        assert!(at("[`failures/brain-tumour-shift.toml`]") < at("### ❌ Beside the baseline"));
        assert!(at("| worse (its bound was loosened) |") < at("| missing |"));
        assert!(at("| improved |") < at("| | Study |"));
        assert!(!text.contains("| same |"));
    }

    #[test]
    fn every_row_of_a_table_has_as_many_cells_as_its_heading() {
        let text = to_markdown(&sample::compared());
        let bars = |line: &str| line.replace("\\|", "").matches('|').count();
        for line in text.lines().filter(|line| line.starts_with("| ")) {
            assert!([5, 8].contains(&bars(line)), "{line}");
        }
    }
}
