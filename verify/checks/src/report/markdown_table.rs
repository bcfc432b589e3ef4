//! Tables in Markdown.

use super::change::{band_text, figure_text, ratio};
use super::labels::unit_text;
use crate::escape::printable;
use crate::study::Change;
use std::fmt::Write;

/// A text on one line that Markdown shows as it is: no HTML, no code, no link.
pub(super) fn inline(text: &str) -> String {
    let text = one_line(text).replace('\\', "\\\\").replace('`', "\\`");
    text.replace('<', "&lt;").replace("](", "]\\(")
}

/// The same for a cell of a table.
pub(super) fn cell(text: &str) -> String {
    inline(text).replace('|', "\\|")
}

/// A text as code.
pub(super) fn code(text: &str) -> String {
    format!("`{}`", one_line(text).replace('`', "'"))
}

/// The same for a cell of a table.
pub(super) fn code_cell(text: &str) -> String {
    code(text).replace('|', "\\|")
}

fn one_line(text: &str) -> String {
    printable(&text.replace(['\r', '\n'], " "))
}

/// Changes, a row each.
pub(super) fn change_table<'a>(text: &mut String, changes: impl Iterator<Item = &'a Change>) {
    text.push_str("| Verdict | Check | Before | Now | Ratio | Unit | Counts as the same |\n");
    text.push_str("|---|---|--:|--:|--:|---|---|\n");
    for change in changes {
        let remark = change.remark.as_ref().map_or(String::new(), |r| format!(" ({})", cell(r)));
        let _ = writeln!(
            text,
            "| {}{remark} | {} | {} | {} | {} | {} | {} |",
            change.verdict.name(),
            code_cell(&change.id),
            figure_text(change.before),
            figure_text(change.now),
            figure_text(ratio(change.before, change.now)),
            cell(unit_text(&change.unit)),
            band_text(&change.band),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_a_file_cannot_leave_their_cell_or_become_markup() {
        assert_eq!(cell("a|b\\|c\n`d` <b>"), "a\\|b\\\\\\|c \\`d\\` &lt;b>");
        assert_eq!(inline("[x](http://y)"), "[x]\\(http://y)");
        assert_eq!(code_cell("a`|\u{1b}"), "`a'\\|\\u{1b}`");
        assert_eq!(inline("|F − (I + H)| [m²]"), "|F − (I + H)| [m²]");
    }
}
