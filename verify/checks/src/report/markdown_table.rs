//! Tables in Markdown.

use super::change::{band_text, figure_text, ratio};
use super::labels::unit_text;
use crate::study::Change;
use std::fmt::Write;

/// Escapes a text for a cell of a table.
pub(super) fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "&lt;").replace(['\r', '\n'], " ")
}

/// Changes, a row each.
pub(super) fn change_table<'a>(text: &mut String, changes: impl Iterator<Item = &'a Change>) {
    text.push_str("| Verdict | Check | Before | Now | Ratio | Unit | Counts as the same |\n");
    text.push_str("|---|---|--:|--:|--:|---|---|\n");
    for change in changes {
        let remark = change.remark.as_ref().map_or(String::new(), |r| format!(" ({})", cell(r)));
        let _ = writeln!(
            text,
            "| {}{remark} | `{}` | {} | {} | {} | {} | {} |",
            change.verdict.name(),
            change.id,
            figure_text(change.before),
            figure_text(change.now),
            figure_text(ratio(change.before, change.now)),
            cell(unit_text(&change.unit)),
            band_text(&change.band),
        );
    }
}
