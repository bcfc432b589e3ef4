//! The table for the terminal.

use super::change::{band_text, change_text, remark_text, verdict_counts};
use super::labels::{duration, failure_text, result_line, study_counts, unit_text};
use super::number::{bound_text, four_digits};
use crate::escape::printable;
use crate::study::{Check, Comparison, Outcome, Report, Study, Verdict};
use comfy_table::{
    Attribute, Cell, CellAlignment, Color, ContentArrangement, LineStyle, Table, presets,
};
use std::fmt::Write;

/// Characters in a line, where the terminal has not fewer.
const WIDTH: u16 = 100;

/// A row per study, then failures, changes and the result; `verbose` adds all checks, grouped by
/// study.
pub fn to_table(report: &Report, colour: bool, verbose: bool) -> String {
    let width = Table::new().width().map_or(WIDTH, |width| width.min(WIDTH));
    render(report, colour, verbose, width)
}

/// `width` in characters.
fn render(report: &Report, colour: bool, verbose: bool, width: u16) -> String {
    let mut text = String::new();
    if verbose {
        for study in report.studies.iter().filter(|study| !study.checks.is_empty()) {
            let heading = format!("{} ({})", printable(&study.title), duration(study.wall_seconds));
            paragraph(&mut text, &heading, width, colour.then_some("1"));
            let _ = writeln!(text, "{}\n", check_table(study, colour, width));
        }
    }
    if !report.studies.is_empty() {
        let _ = writeln!(text, "{}\n", study_table(report, colour, width));
    }
    text += &attention(report, colour, width);
    let code = colour_of(report.outcome()).1;
    let _ = writeln!(text, "{}", paint(&result_line(report), colour.then_some(code)));
    text
}

/// Studies that could not run, failures with their cases, and changes, below the tables.
fn attention(report: &Report, colour: bool, width: u16) -> String {
    let mut text = String::new();
    let red = colour.then_some("1;31");
    for study in &report.studies {
        if let Some(reason) = &study.failure {
            let line = format!("COULD NOT RUN {}: {reason}", study.id);
            paragraph(&mut text, &printable(&line), width, red);
        }
    }
    for (study, question) in
        report.studies.iter().flat_map(|s| s.questions().into_iter().map(move |q| (s, q)))
    {
        let line = format!("INCONCLUSIVE {}: {question}", study.id);
        let amber = colour_of(Outcome::Inconclusive).1;
        paragraph(&mut text, &printable(&line), width, colour.then_some(amber));
    }
    for check in report.checks().filter(|check| !check.pass) {
        let line = format!("FAIL {}: {}", check.id, failure_text(check));
        paragraph(&mut text, &printable(&line), width, red);
        if let Some(file) = check.failure_file() {
            let _ = writeln!(text, "     the smallest case that shows it: {file}");
        }
    }
    let Some(comparison) = &report.comparison else { return text };
    text += &changed_lines(comparison, colour);
    paragraph(&mut text, &compared_with(comparison), width, None);
    text
}

/// A text broken between words, with all lines but the first indented; a longer word, such as a
/// path, stays whole.
fn paragraph(text: &mut String, words: &str, width: u16, code: Option<&str>) {
    let mut line = String::new();
    for word in words.split(' ') {
        let long = line.chars().count() + 1 + word.chars().count() > usize::from(width);
        if long && !line.trim().is_empty() {
            let _ = writeln!(text, "{}", paint(&line, code));
            line = "    ".to_string();
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line += word;
    }
    let _ = writeln!(text, "{}", paint(&line, code));
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
        let line = format!("{name:8} {id}: {values} (same: {band}){remark}");
        paragraph(&mut text, &printable(&line), WIDTH, colour.then_some(code));
    }
    text
}

/// A table with these columns, some of which are of numbers.
fn table(
    width: u16,
    colour: bool,
    columns: &[&str],
    rows: Vec<Vec<Cell>>,
    numbers: &[usize],
) -> Table {
    let mut table = Table::new();
    let style = presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none());
    table.load_style(style);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(width);
    if colour {
        table.enforce_styling();
    }
    table.set_header(columns);
    table.add_rows(rows);
    for &index in numbers {
        if let Some(column) = table.column_mut(index) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

/// A row per study.
fn study_table(report: &Report, colour: bool, width: u16) -> Table {
    let row = |study: &Study| {
        let (passed, all) = study_counts(study);
        let counts = if all == 0 { "–".to_string() } else { format!("{passed} of {all}") };
        vec![
            Cell::new(printable(&study.title)),
            Cell::new(counts),
            Cell::new(duration(study.wall_seconds)),
            verdict(study.outcome(), colour),
        ]
    };
    let rows = report.studies.iter().map(row).collect();
    table(width, colour, &["study", "checks passed", "time", "verdict"], rows, &[1, 2])
}

/// All checks of a study.
fn check_table(study: &Study, colour: bool, width: u16) -> Table {
    let rows = study.checks.iter().map(|check| row(check, colour)).collect();
    let columns = ["check", "quantity", "kind", "value", "bound", "unit", "verdict"];
    table(width, colour, &columns, rows, &[3, 4])
}

fn verdict(outcome: Outcome, colour: bool) -> Cell {
    let cell = Cell::new(outcome.word());
    if colour { cell.fg(colour_of(outcome).0).add_attribute(Attribute::Bold) } else { cell }
}

/// Colour in tables, and its ANSI code.
fn colour_of(outcome: Outcome) -> (Color, &'static str) {
    match outcome {
        Outcome::Passed => (Color::Green, "1;32"),
        Outcome::Inconclusive => (Color::Yellow, "1;33"),
        Outcome::Failed | Outcome::CouldNotRun => (Color::Red, "1;31"),
    }
}

fn row(check: &Check, colour: bool) -> Vec<Cell> {
    vec![
        Cell::new(printable(&check.id)),
        Cell::new(printable(&check.quantity)),
        Cell::new(check.kind.name()),
        Cell::new(four_digits(check.value)),
        Cell::new(bound_text(&check.bound)),
        Cell::new(printable(unit_text(&check.unit))),
        verdict(check.outcome(), colour),
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
        let plain = render(&sample::report(), false, false, 200);
        assert_eq!(plain.lines().last(), Some("9 of 11 checks passed, 1 study could not run"));
        assert!(plain.contains("FAIL") && plain.contains("COULD NOT RUN"), "{plain}");
        assert!(!plain.contains('\u{1b}'));
        assert!(to_table(&sample::report(), true, false).contains("\u{1b}["));
    }

    #[test]
    fn there_is_a_row_per_study_and_no_check_that_passes() {
        let plain = render(&sample::report(), false, false, 100);
        let row = |text: &str| plain.lines().find(|line| line.contains(text));
        assert!(row("Affine patch test").unwrap().contains("3 of 3"), "{plain}");
        assert!(row("Cook's membrane").unwrap().contains("COULD NOT RUN"), "{plain}");
        assert!(row("FAIL brain/tumour/shift").is_some() && row("patch/cube").is_none(), "{plain}");
    }

    #[test]
    fn on_request_the_quantity_of_each_check_is_beside_its_value_and_bound() {
        let plain = render(&sample::report(), false, true, 200);
        let line = plain.lines().find(|line| line.contains("brain/step")).unwrap();
        for text in ["critical time step", "regression", "12.34×10⁻⁶", "≥ 12×10⁻⁶", "pass"]
        {
            assert!(line.contains(text), "{text} in {line}");
        }
    }

    #[test]
    fn no_line_has_more_than_100_characters() {
        let mut report = sample::compared();
        report.studies[0].title = "a title of many words ".repeat(9);
        report.studies[4].failure = Some("a reason of many words ".repeat(9));
        report.studies[3].checks[0].quantity = "a quantity of many words ".repeat(9);
        for verbose in [false, true] {
            let plain = render(&report, false, verbose, WIDTH);
            let longest = plain.lines().max_by_key(|line| line.chars().count()).unwrap();
            assert!(longest.chars().count() <= 100, "{longest}");
        }
    }

    #[test]
    fn failures_and_what_got_worse_are_below_the_tables() {
        let plain = render(&sample::compared(), false, false, 100);
        let at = |part: &str| plain.find(part).unwrap_or_else(|| panic!("{part}: {plain}"));
        assert!(
            at("failures/brain-tumour-shift.toml") < at("worse    brain/tumour/shift: 0.01010 mm")
        );
        assert!(at("Indentation of a brain slice") < at("FAIL brain/tumour/shift"));
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
        let plain = render(&report, false, true, 200);
        assert!(plain.contains("x\\u{1b}[2J\\nall checks passed"), "{plain}");
        assert!(!plain.contains('\u{1b}') && !plain.contains("\nall checks passed"), "{plain}");
    }

    #[test]
    fn an_empty_report_is_one_line() {
        assert_eq!(to_table(&sample::empty(), false, false), "Figures only\n");
    }
}
