//! The table for the terminal.

use super::change::{band_text, change_text, remark_text, verdict_counts};
use super::labels::{duration, result_line, unit_text};
use super::number::{bound_text, four_digits};
use crate::escape::printable;
use crate::study::{Check, Comparison, Report, Study, Verdict};
use comfy_table::{
    Attribute, Cell, CellAlignment, Color, ContentArrangement, LineStyle, Table, presets,
};
use std::fmt::Write;

/// All checks grouped by study, then failures, changes and the result.
pub fn to_table(report: &Report, colour: bool) -> String {
    render(report, colour, None)
}

/// `width` in characters replaces that of the terminal.
fn render(report: &Report, colour: bool, width: Option<u16>) -> String {
    let mut text = String::new();
    for study in &report.studies {
        let heading = format!("{} ({})", printable(&study.title), duration(study.wall_seconds));
        let _ = writeln!(text, "{}", paint(&heading, colour.then_some("1")));
        if let Some(reason) = &study.failure {
            let line = format!("  COULD NOT RUN: {}", printable(reason));
            let _ = writeln!(text, "{}", paint(&line, colour.then_some("1;31")));
        }
        if !study.checks.is_empty() {
            let _ = writeln!(text, "{}", table(study, colour, width));
        }
        text.push('\n');
    }
    text += &attention(report, colour);
    let code = if report.passed() { "1;32" } else { "1;31" };
    let _ = writeln!(text, "{}", paint(&result_line(report), colour.then_some(code)));
    text
}

/// Failures with their cases, and changes, repeated below the tables.
fn attention(report: &Report, colour: bool) -> String {
    let mut text = String::new();
    for check in report.checks().filter(|check| !check.pass) {
        let (value, bound) = (four_digits(check.value), bound_text(&check.bound));
        let (id, quantity) = (printable(&check.id), printable(&check.quantity));
        let line = format!("FAIL {id}: {value}, must be {bound}: {quantity}");
        let _ = writeln!(text, "{}", paint(&line, colour.then_some("1;31")));
        if let Some(file) = check.failure_file() {
            let _ = writeln!(text, "     the smallest case that shows it: {file}");
        }
    }
    let Some(comparison) = &report.comparison else { return text };
    text += &changed_lines(comparison, colour);
    let _ = writeln!(text, "{}", compared_with(comparison));
    text
}

/// `beside the baseline of …: 1 worse, 454 the same`.
pub fn compared_with(comparison: &Comparison) -> String {
    format!("beside {}: {}", printable(&comparison.with), verdict_counts(comparison))
}

/// A line per check that is not the same, the most urgent first.
pub fn changed_lines(comparison: &Comparison, colour: bool) -> String {
    let mut text = String::new();
    for change in comparison.changes.iter().filter(|c| c.verdict != Verdict::Same) {
        let code = match change.verdict {
            Verdict::Worse | Verdict::Missing => "1;31",
            Verdict::Improved => "32",
            _ => "2",
        };
        let name = change.verdict.name();
        let (values, band) = (change_text(change), band_text(&change.band));
        let (id, remark) = (&change.id, remark_text(change));
        let line = printable(&format!("{name:8} {id}: {values} (same: {band}){remark}"));
        let _ = writeln!(text, "{}", paint(&line, colour.then_some(code)));
    }
    text
}

fn table(study: &Study, colour: bool, width: Option<u16>) -> Table {
    let mut table = Table::new();
    let style = presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none());
    table.load_style(style);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    if let Some(width) = width {
        table.set_width(width);
    }
    if colour {
        table.enforce_styling();
    }
    table.set_header(["check", "quantity", "kind", "value", "bound", "unit", "verdict"]);
    table.add_rows(study.checks.iter().map(|check| row(check, colour)));
    for index in [3, 4] {
        if let Some(column) = table.column_mut(index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

fn row(check: &Check, colour: bool) -> Vec<Cell> {
    let mut verdict = Cell::new(if check.pass { "pass" } else { "FAIL" });
    if colour {
        let shade = if check.pass { Color::Green } else { Color::Red };
        verdict = verdict.fg(shade).add_attribute(Attribute::Bold);
    }
    vec![
        Cell::new(printable(&check.id)),
        Cell::new(printable(&check.quantity)),
        Cell::new(check.kind.name()),
        Cell::new(four_digits(check.value)),
        Cell::new(bound_text(&check.bound)),
        Cell::new(printable(unit_text(&check.unit))),
        verdict,
    ]
}

/// ANSI escape around a text.
fn paint(text: &str, code: Option<&str>) -> String {
    code.map_or(text.to_string(), |code| format!("\u{1b}[{code}m{text}\u{1b}[0m"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::sample;

    #[test]
    fn the_verdict_is_the_last_line_and_colour_comes_only_when_asked() {
        let plain = render(&sample::report(), false, Some(200));
        assert_eq!(plain.lines().last(), Some("9 of 11 checks passed, 1 study could not run"));
        assert!(plain.contains("FAIL") && plain.contains("COULD NOT RUN"), "{plain}");
        assert!(!plain.contains('\u{1b}'));
        assert!(to_table(&sample::report(), true).contains("\u{1b}["));
    }

    #[test]
    fn the_quantity_is_beside_its_value_and_bound() {
        let plain = render(&sample::report(), false, Some(200));
        let line = plain.lines().find(|line| line.contains("brain/step")).unwrap();
        for text in ["critical time step", "regression", "12.34×10⁻⁶", "≥ 12×10⁻⁶", "pass"]
        {
            assert!(line.contains(text), "{text} in {line}");
        }
    }

    #[test]
    fn failures_and_what_got_worse_are_repeated_below_the_tables() {
        let plain = render(&sample::compared(), false, Some(200));
        let at = |part: &str| plain.find(part).unwrap_or_else(|| panic!("{part}: {plain}"));
        assert!(
            at("failures/brain-tumour-shift.toml") < at("worse    brain/tumour/shift: 0.01010 mm")
        );
        assert!(at("worse    ") < at("missing  brain/none"));
        assert!(!plain.contains("\nsame     "));
    }

    #[test]
    fn a_text_of_a_report_cannot_steer_the_terminal() {
        let mut report = sample::compared();
        let evil = "x\u{1b}[2J\nall checks passed";
        for study in &mut report.studies {
            study.title = evil.into();
            study.failure = study.failure.as_ref().map(|_| evil.into());
            for check in &mut study.checks {
                (check.id, check.quantity, check.unit) = (evil.into(), evil.into(), evil.into());
            }
        }
        let comparison = report.comparison.as_mut().unwrap();
        comparison.with = evil.into();
        for change in &mut comparison.changes {
            (change.id, change.unit, change.remark) = (evil.into(), evil.into(), Some(evil.into()));
        }
        let plain = render(&report, false, Some(200));
        assert!(plain.contains("x\\u{1b}[2J\\nall checks passed"), "{plain}");
        assert!(!plain.contains('\u{1b}') && !plain.contains("\nall checks passed"), "{plain}");
    }

    #[test]
    fn an_empty_report_is_one_line() {
        assert_eq!(to_table(&sample::empty(), false), "Figures only\n");
    }
}
